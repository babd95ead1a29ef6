//! Directional and adjoint derivatives, exact by dual numbers.

use super::continuous::expect_length;
use super::{Instance, MOST};
use crate::fault::{Fault, Outcome};
use crate::log::Status;
use crate::mode::Mode;
use crate::unit::Unit;
use crate::variable::{Slot, ValueType};
use toolroom_process::Record;

/// Derivatives of everything along one direction.
struct Slopes<U: Unit> {
    rates: U::State,
    outputs: U::Output,
    indicators: [f64; MOST],
}

/// Step of the difference that stands for the derivative of event indicators, relative.
const DIFFERENCE: f64 = 1e-6;

impl<U: Unit> Instance<U> {
    pub(super) fn along(&mut self, unknowns: &[u32], knowns: &[u32], seed: &[f64], out: &mut [f64]) -> Outcome {
        self.expect_differentiable()?;
        expect_length(seed.len(), knowns.len())?;
        expect_length(out.len(), unknowns.len())?;
        let (mut dx, mut du) = (zero::<U::State>(), zero::<U::Input>());
        for (&known, &value) in knowns.iter().zip(seed) {
            self.seed(known, value, &mut dx, &mut du)?;
        }
        let slopes = self.slopes(&dx, &du)?;
        for (&unknown, value) in unknowns.iter().zip(out) {
            *value = self.slope_of(unknown, &slopes)?;
        }
        Ok(Status::Ok)
    }

    pub(super) fn back(&mut self, unknowns: &[u32], knowns: &[u32], seed: &[f64], out: &mut [f64]) -> Outcome {
        self.expect_differentiable()?;
        expect_length(seed.len(), unknowns.len())?;
        expect_length(out.len(), knowns.len())?;
        for (&known, value) in knowns.iter().zip(out) {
            let (mut dx, mut du) = (zero::<U::State>(), zero::<U::Input>());
            self.seed(known, 1.0, &mut dx, &mut du)?;
            let slopes = self.slopes(&dx, &du)?;
            *value = 0.0;
            for (&unknown, weight) in unknowns.iter().zip(seed) {
                *value += weight * self.slope_of(unknown, &slopes)?;
            }
        }
        Ok(Status::Ok)
    }

    /// Time derivative of an output: along the rates of the state.
    pub(super) fn rate_of(&mut self, reference: u32) -> Outcome<f64> {
        self.expect_differentiable()?;
        let Some(Slot::Output(_)) = Slot::of(reference) else {
            return Err(Fault::Reference { reference }.into());
        };
        let slopes = self.slopes(&self.rates()?, &zero::<U::Input>())?;
        self.slope_of(reference, &slopes)
    }

    fn expect_differentiable(&self) -> Outcome<()> {
        let modes = [Mode::Initialization, Mode::Event, Mode::Continuous, Mode::Step, Mode::Terminated];
        self.expect("a derivative", &modes)
    }

    /// Puts `value` into the direction of a known; inputs and states can be known.
    fn seed(&self, known: u32, value: f64, dx: &mut U::State, du: &mut U::Input) -> Outcome<()> {
        match self.find(ValueType::Real, known)? {
            (Slot::State(i), 1) => add(dx, self.state_offsets[i], value),
            (Slot::Input(i), 1) => {
                // The speed of the input does not count while the policy commands.
                if !(self.is_adaptive() && self.speed == Some(i)) {
                    add(du, i, value);
                }
            }
            _ => return Err(Fault::Reference { reference: known }.into()),
        }
        Ok(())
    }

    fn slopes(&self, dx: &U::State, du: &U::Input) -> Outcome<Slopes<U>> {
        let input = self.effective_input();
        let process = &self.core.model.process;
        let linear = process.linearise(&self.core.state, &input, dx, du);
        let (rates, outputs) = linear.ok_or(Fault::NotOffered { feature: "a derivative" })?;
        Ok(Slopes { rates, outputs, indicators: self.indicator_slopes(&input, dx, du) })
    }

    /// Derivatives of the indicators, which are no part of the dual equations: a central
    /// difference.
    fn indicator_slopes(&self, input: &U::Input, dx: &U::State, du: &U::Input) -> [f64; MOST] {
        let size = relative_size(&self.core.state, dx).max(relative_size(input, du));
        let h = DIFFERENCE / size.max(1e-300);
        let at = |h: f64| {
            let mut indicators = [0.0; MOST];
            let (x, u) = (moved(&self.core.state, dx, h), moved(input, du, h));
            self.core.model.process.event_indicators(&x, &u, &mut indicators[..U::EVENTS.len()]);
            indicators
        };
        let (low, high) = (at(-h), at(h));
        std::array::from_fn(|i| (high[i] - low[i]) / (2.0 * h))
    }

    fn slope_of(&self, unknown: u32, slopes: &Slopes<U>) -> Outcome<f64> {
        let value = match self.find(ValueType::Real, unknown)? {
            (Slot::Derivative(i), 1) => slopes.rates.get(self.state_offsets[i]),
            (Slot::Output(i), 1) => slopes.outputs.get(i),
            (Slot::Indicator(i), 1) => Some(slopes.indicators[i]),
            _ => None,
        };
        value.ok_or_else(|| Fault::Reference { reference: unknown }.into())
    }
}

/// A record of zeros.
fn zero<R: Record>() -> R {
    let mut record = R::default();
    for i in 0..R::LEN {
        record.set(i, 0.0);
    }
    record
}

fn add<R: Record>(record: &mut R, i: usize, value: f64) {
    let sum = record.get(i).unwrap_or(0.0) + value;
    record.set(i, sum);
}

/// Length of a direction against the nominal size of its elements.
fn relative_size<R: Record>(record: &R, direction: &R) -> f64 {
    let elements = R::FIELDS.iter().flat_map(|field| std::iter::repeat_n(field, field.len));
    let relative = elements.enumerate().map(|(i, field)| {
        let nominal = super::continuous::nominal_of(field.display, field.unit);
        direction.get(i).unwrap_or(0.0).abs() / record.get(i).unwrap_or(0.0).abs().max(nominal)
    });
    relative.fold(0.0, f64::max)
}

fn moved<R: Record>(record: &R, direction: &R, h: f64) -> R {
    let mut moved = *record;
    (0..R::LEN).for_each(|i| add(&mut moved, i, h * direction.get(i).unwrap_or(0.0)));
    moved
}
