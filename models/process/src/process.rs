//! The process contract: typed for those who write a model, by index for those who drive it.

use crate::{AnyRecord, Field, ModelError, Record};

/// Something that ends a step before its time and that a driver has to react to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ProcessEvent {
    /// Flank wear reached the wear limit (ISO 3685 VB criterion).
    WearLimit,
    /// The contact temperature passed what the tool material bears; the edge is lost.
    ThermalCollapse,
    /// The edge chipped: accumulated hazard reached the edge's resistance.
    Chipping,
    /// The grinding zone passed the burn temperature.
    Burn,
    /// The wheel has dulled to the point where it must be dressed.
    DressingDue,
}

impl ProcessEvent {
    /// Name in files and logs.
    pub fn name(self) -> &'static str {
        match self {
            Self::WearLimit => "wear_limit",
            Self::ThermalCollapse => "thermal_collapse",
            Self::Chipping => "chipping",
            Self::Burn => "burn",
            Self::DressingDue => "dressing_due",
        }
    }

    /// Whether nothing can be cut any more once it has happened. Past the others a cut may go on: a worn edge
    /// still cuts, a burnt part is still ground.
    pub fn ends_cut(self) -> bool {
        match self {
            Self::ThermalCollapse | Self::Chipping => true,
            Self::WearLimit | Self::Burn | Self::DressingDue => false,
        }
    }
}

/// How far a step came.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advance {
    /// Time taken, s; less than requested exactly when an event stopped the step.
    pub elapsed: f64,
    /// The event that stopped it.
    pub event: Option<ProcessEvent>,
}

/// A cutting process: an immutable value (parameters and effects) that maps a state and an
/// input to outputs and to the state a while later. All numbers are SI.
///
/// Whoever holds the state drives the process: the shop by events, an FMU by communication
/// steps, the gap diagnosis by recorded inputs.
pub trait Process: Send + Sync {
    /// What a driver commands and what surrounds the cut; held during a step.
    type Input: Record;
    /// Everything that changes.
    type State: Record;
    /// Everything that can be observed or logged.
    type Output: Record;

    /// Name in files (`turning`).
    const NAME: &'static str;
    /// Events that this process raises, in the order of [`Process::event_indicators`].
    const EVENTS: &'static [ProcessEvent];

    /// State of a new edge, or of a freshly dressed wheel.
    fn initial(&self) -> Self::State;

    /// Outputs at state `x` under input `u`, both inside their ranges.
    fn output(&self, x: &Self::State, u: &Self::Input) -> Self::Output;

    /// Moves `x` by `dt` seconds under held input, or up to the first event.
    ///
    /// An event that already holds at `x` and ends the cut ([`ProcessEvent::ends_cut`]) is reported at once, with
    /// no time elapsed. Past any other that holds at `x` the step goes on without telling it again.
    ///
    /// # Errors
    /// [`ModelError::OutOfRange`] for an input outside its range, [`ModelError::Step`] for a
    /// `dt` that is negative or not finite. `x` is left as it was.
    fn advance(&self, x: &mut Self::State, u: &Self::Input, dt: f64) -> Result<Advance, ModelError>;

    /// [`Process::advance`] with a look at input and output at each of `times` (s since the start
    /// of the step, ascending, at most `dt`) that comes before the event: `see(i, u, y)` at
    /// `times[i]`. A process that integrates an equation may look at its dense output; any other
    /// one stops there.
    ///
    /// # Errors
    /// As [`Process::advance`].
    #[allow(clippy::type_complexity)] // an alias could not say more
    fn advance_watched(
        &self,
        x: &mut Self::State,
        u: &Self::Input,
        dt: f64,
        times: &[f64],
        see: &mut dyn FnMut(usize, &Self::Input, &Self::Output),
    ) -> Result<Advance, ModelError> {
        let mut state = *x;
        let advance = stop_at(
            times,
            dt,
            &mut state,
            |x, from, dt| self.advance(x, &self.input_after(u, from), dt),
            |i, x| {
                let u = self.input_after(u, times[i]);
                see(i, &u, &self.output(x, &u));
            },
        )?;
        *x = state;
        Ok(advance)
    }

    /// [`Process::advance_watched`] with the outputs where it ends. A process that works out for the step what its outputs
    /// need, too, does so once; the numbers are those of both methods one after the other.
    ///
    /// # Errors
    /// As [`Process::advance`].
    #[allow(clippy::type_complexity)] // an alias could not say more
    fn advance_to_output(
        &self,
        x: &mut Self::State,
        u: &Self::Input,
        dt: f64,
        times: &[f64],
        see: &mut dyn FnMut(usize, &Self::Input, &Self::Output),
    ) -> Result<(Advance, Self::Output), ModelError> {
        let advance = self.advance_watched(x, u, dt, times, see)?;
        Ok((advance, self.output(x, &self.input_after(u, advance.elapsed))))
    }

    /// The input `elapsed` seconds later, where the input itself says that it changes (a
    /// speed ramp). Splitting a step in two uses this for the second half.
    fn input_after(&self, u: &Self::Input, _elapsed: f64) -> Self::Input {
        *u
    }

    /// Right-hand side of the state equation, or `None` where the process is no ordinary
    /// differential equation.
    fn derivative(&self, _x: &Self::State, _u: &Self::Input) -> Option<Self::State> {
        None
    }

    /// Event functions, one for each of [`Process::EVENTS`]: negative before the event, zero
    /// or positive from it on.
    ///
    /// # Shape
    /// `indicators` has the length of [`Process::EVENTS`].
    fn event_indicators(&self, x: &Self::State, u: &Self::Input, indicators: &mut [f64]);

    /// Whether `event` has happened by state `x` under input `u`: its event function is zero or positive. False for an event
    /// that the process does not know.
    fn holds(&self, event: ProcessEvent, x: &Self::State, u: &Self::Input) -> bool {
        let Some(index) = Self::EVENTS.iter().position(|each| *each == event) else { return false };
        let mut indicators = vec![0.0; Self::EVENTS.len()];
        self.event_indicators(x, u, &mut indicators);
        indicators[index] >= 0.0
    }

    /// Parameter groups by name, for files, FMI parameters and calibration.
    fn parameters_mut(&mut self) -> Vec<(&'static str, &mut dyn AnyRecord)>;
}

/// A [`Process`] seen by element index: what the shop drives, native or imported.
///
/// # Shape
/// States, inputs and outputs are slices with one SI number for every element of the fields.
pub trait MachineProcess: Send + Sync {
    /// Name in files.
    fn name(&self) -> &str;
    /// Input fields.
    fn inputs(&self) -> &[Field];
    /// State fields.
    fn states(&self) -> &[Field];
    /// Output fields.
    fn outputs(&self) -> &[Field];
    /// State of a new edge.
    fn initial(&self) -> Vec<f64>;
    /// Whether [`MachineProcess::advance`] may start from any earlier state again, as it has to
    /// where a pass is interrupted. Native processes always may; an imported unit without FMU
    /// state goes forward only.
    fn goes_back(&self) -> bool {
        true
    }
    /// The only step that the process takes, s; `None` where any will do, as native processes have it. A pass of such a
    /// process ends up to half a step before or after its time.
    fn fixed_step(&self) -> Option<f64> {
        None
    }
    /// That the edge goes on from `x`: none of its earlier states will be used again. A process that keeps
    /// states outside of `x`, as imported units do, frees them.
    fn settle(&self, _x: &[f64]) {}
    /// That the edge in state `x` is gone, and none of its states will be used again.
    fn retire(&self, _x: &[f64]) {}
    /// What went wrong so far without changing a result, and ought to be told: an imported unit whose process died has
    /// been asked again.
    fn notes(&self) -> Vec<String> {
        Vec::new()
    }
    /// Outputs at state `x` under input `u`, written to `y`.
    fn output(&self, x: &[f64], u: &[f64], y: &mut [f64]);
    /// Whether `event` has happened by state `x` under input `u`, even where no step has crossed it: an edge may be
    /// mounted past its wear limit. False for an event that the process does not know.
    fn holds(&self, event: ProcessEvent, x: &[f64], u: &[f64]) -> bool;
    /// Moves `x` by `dt` seconds or up to the first event, and `u` to the input at that time.
    ///
    /// # Errors
    /// As [`Process::advance`]; `x` and `u` are left as they were.
    fn advance(&self, x: &mut [f64], u: &mut [f64], dt: f64) -> Result<Advance, ModelError>;
    /// [`MachineProcess::advance`] with a look at input and output on the way, as
    /// [`Process::advance_watched`].
    ///
    /// # Errors
    /// As [`MachineProcess::advance`].
    #[allow(clippy::type_complexity)] // an alias could not say more
    fn advance_watched(
        &self,
        x: &mut [f64],
        u: &mut [f64],
        dt: f64,
        times: &[f64],
        see: &mut dyn FnMut(usize, &[f64], &[f64]),
    ) -> Result<Advance, ModelError> {
        let mut point = (x.to_vec(), u.to_vec());
        let mut y = vec![0.0; self.outputs().iter().map(|field| field.len).sum()];
        let advance = stop_at(
            times,
            dt,
            &mut point,
            |(x, u), _, dt| self.advance(x, u, dt),
            |i, (x, u)| {
                self.output(x, u, &mut y);
                see(i, u, &y);
            },
        )?;
        x.copy_from_slice(&point.0);
        u.copy_from_slice(&point.1);
        Ok(advance)
    }
    /// [`MachineProcess::advance_watched`], then the outputs where it ends into `y`, as
    /// [`Process::advance_to_output`].
    ///
    /// # Errors
    /// As [`MachineProcess::advance`].
    #[allow(clippy::type_complexity)] // an alias could not say more
    fn advance_to_output(
        &self,
        x: &mut [f64],
        u: &mut [f64],
        dt: f64,
        times: &[f64],
        see: &mut dyn FnMut(usize, &[f64], &[f64]),
        y: &mut [f64],
    ) -> Result<Advance, ModelError> {
        let advance = self.advance_watched(x, u, dt, times, see)?;
        self.output(x, u, y);
        Ok(advance)
    }
}

/// Advances by `dt`, stopping at each of `times` to `see`, or up to the first event;
/// `advance(at, from, dt)` moves `at` by `dt` from the time `from` on.
fn stop_at<S>(
    times: &[f64],
    dt: f64,
    at: &mut S,
    mut advance: impl FnMut(&mut S, f64, f64) -> Result<Advance, ModelError>,
    mut see: impl FnMut(usize, &S),
) -> Result<Advance, ModelError> {
    let mut elapsed = 0.0;
    for (i, &time) in times.iter().enumerate() {
        let step = advance(at, elapsed, time - elapsed)?;
        if step.event.is_some() {
            return Ok(Advance { elapsed: elapsed + step.elapsed, ..step });
        }
        elapsed = time;
        see(i, at);
    }
    let step = advance(at, elapsed, dt - elapsed)?;
    // A step that runs to its end takes the time requested, to the bit.
    Ok(Advance { elapsed: if step.event.is_some() { elapsed + step.elapsed } else { dt }, ..step })
}

impl<P: Process> MachineProcess for P {
    fn name(&self) -> &str {
        P::NAME
    }
    fn inputs(&self) -> &[Field] {
        P::Input::FIELDS
    }
    fn states(&self) -> &[Field] {
        P::State::FIELDS
    }
    fn outputs(&self) -> &[Field] {
        P::Output::FIELDS
    }
    fn initial(&self) -> Vec<f64> {
        let mut x = vec![0.0; P::State::LEN];
        Process::initial(self).write_to(&mut x);
        x
    }
    fn output(&self, x: &[f64], u: &[f64], y: &mut [f64]) {
        Process::output(self, &P::State::from_slice(x), &P::Input::from_slice(u)).write_to(y);
    }
    fn holds(&self, event: ProcessEvent, x: &[f64], u: &[f64]) -> bool {
        Process::holds(self, event, &P::State::from_slice(x), &P::Input::from_slice(u))
    }
    fn advance(&self, x: &mut [f64], u: &mut [f64], dt: f64) -> Result<Advance, ModelError> {
        let mut state = P::State::from_slice(x);
        let input = P::Input::from_slice(u);
        let advance = Process::advance(self, &mut state, &input, dt)?;
        state.write_to(x);
        self.input_after(&input, advance.elapsed).write_to(u);
        Ok(advance)
    }
    fn advance_watched(
        &self,
        x: &mut [f64],
        u: &mut [f64],
        dt: f64,
        times: &[f64],
        see: &mut dyn FnMut(usize, &[f64], &[f64]),
    ) -> Result<Advance, ModelError> {
        let (mut state, input) = (P::State::from_slice(x), P::Input::from_slice(u));
        let mut y = vec![0.0; if times.is_empty() { 0 } else { P::Output::LEN }];
        let advance = Process::advance_watched(self, &mut state, &input, dt, times, &mut |i, input, output| {
            // `u` serves as scratch.
            input.write_to(u);
            output.write_to(&mut y);
            see(i, u, &y);
        });
        state.write_to(x);
        let elapsed = advance.as_ref().map_or(0.0, |advance| advance.elapsed);
        self.input_after(&input, elapsed).write_to(u);
        advance
    }
    fn advance_to_output(
        &self,
        x: &mut [f64],
        u: &mut [f64],
        dt: f64,
        times: &[f64],
        see: &mut dyn FnMut(usize, &[f64], &[f64]),
        y: &mut [f64],
    ) -> Result<Advance, ModelError> {
        let (mut state, input) = (P::State::from_slice(x), P::Input::from_slice(u));
        let advance = Process::advance_to_output(self, &mut state, &input, dt, times, &mut |i, input, output| {
            // `u` and `y` serve as scratch.
            input.write_to(u);
            output.write_to(y);
            see(i, u, y);
        });
        state.write_to(x);
        let elapsed = advance.as_ref().map_or(0.0, |(advance, _)| advance.elapsed);
        self.input_after(&input, elapsed).write_to(u);
        advance.map(|(advance, output)| {
            output.write_to(y);
            advance
        })
    }
}
