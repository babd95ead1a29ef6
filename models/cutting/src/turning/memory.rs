//! Steps that remember what the step before worked out.

use super::equations::{Angles, Engagement, Kept};
use super::{ACCURACY, STATES, Turning, TurningInput, TurningOutput, TurningState, lost_at};
use std::cell::OnceCell;
use toolroom_process::ode::{self, Autonomous, Tolerance};
use toolroom_process::{Advance, ModelError, Process, Record};
use toolroom_wear::WEAR_EVENTS;

/// What a step under held input works out and the next one under the same input need not work out
/// again. Forgetting it changes no result, to the bit; it holds for one process only and has to be
/// forgotten where a parameter of that changes.
#[derive(Clone, Debug, Default)]
pub struct TurningMemory {
    known: Option<LastEngagement>,
}

/// An input as numbers, in the order of its fields; the cutting speed is the first.
type Numbers = [f64; TurningInput::<f64>::LEN];

/// The numbers of an input.
#[inline]
fn numbers(u: &TurningInput) -> Numbers {
    let mut input = [0.0; TurningInput::<f64>::LEN];
    u.write_to(&mut input);
    input
}

/// Whether all numbers are equal: compared side by side, without a branch for each.
#[inline]
fn same(one: &[f64], other: &[f64]) -> bool {
    one.iter().zip(other).fold(true, |equal, (one, other)| equal & (one == other))
}

/// Place of an output, worked out when this is compiled.
const fn place(name: &str) -> usize {
    let (fields, name) = (TurningOutput::<f64>::FIELDS, name.as_bytes());
    let mut output = 0;
    while output < fields.len() {
        let field = fields[output].name.as_bytes();
        let mut equal = 0;
        while equal < name.len() && equal < field.len() && field[equal] == name[equal] {
            equal += 1;
        }
        if equal == name.len() && equal == field.len() {
            return output;
        }
        output += 1;
    }
    panic!("no output has this name")
}

const FLANK_WEAR: usize = place("flank_wear");
const WEAR_RATIO: usize = place("wear_ratio");
const TEMPERATURE: usize = place("temperature");
const MECHANICAL_WEAR: usize = place("mechanical_wear_per_path");
const THERMAL_WEAR: usize = place("thermal_wear_rate");
const WEAR_INTENSITY: usize = place("wear_intensity");
const WEAR_BALANCE: usize = place("wear_balance");
const THERMO_EMF: usize = place("thermo_emf");
const PEAK_FORCE: usize = place("peak_cutting_force");
const CUTTING_FORCE: usize = place("cutting_force");
const FEED_FORCE: usize = place("feed_force");
const PASSIVE_FORCE: usize = place("passive_force");
const SPINDLE_POWER: usize = place("spindle_power");
const SPINDLE_SPEED: usize = place("spindle_speed");
const REMOVAL_RATE: usize = place("material_removal_rate");
const ROUGHNESS: usize = place("roughness_ra");
const SIZE_ERROR: usize = place("size_error");

#[derive(Clone, Debug)]
struct LastEngagement {
    input: Numbers,
    engagement: Kept,
    /// Worked out with the first outputs.
    angles: OnceCell<Angles<f64>>,
    tolerance: Tolerance<STATES>,
    last: Option<Last>,
}

impl LastEngagement {
    /// Whether an input differs in nothing but the cutting speed, or not at all. Speeds on either side of 0 have nothing in
    /// common.
    fn differs_in_speed_at_most(&self, input: &Numbers) -> bool {
        let ([kept_speed, kept @ ..], [speed, others @ ..]) = (&self.input, input);
        (kept_speed == speed || *kept_speed > 0.0 && *speed > 0.0) && same(kept, others)
    }
}

/// Where the last step ended.
#[derive(Clone, Copy, Debug)]
struct Last {
    state: TurningState,
    indicators: [f64; 3],
}

impl Autonomous<STATES> for Engagement<'_> {
    #[inline(always)]
    fn slope(&self, y: &[f64; STATES]) -> [f64; STATES] {
        array(&self.rates(&TurningState::from_slice(y)))
    }
}

/// The numbers of a state.
#[inline(always)]
fn array(x: &TurningState) -> [f64; STATES] {
    let mut y = [0.0; STATES];
    x.write_to(&mut y);
    y
}

impl Turning {
    /// [`Process::advance`] with a memory of the step before:
    /// coefficients of the input and the event functions at the end of the step.
    ///
    /// # Errors
    /// As [`Process::advance`].
    ///
    /// # Examples
    /// ```
    /// use toolroom_cutting::{Turning, TurningInput, TurningMemory};
    /// use toolroom_process::Process;
    /// let (turning, u) = (Turning::default(), TurningInput::default());
    /// let (mut x, mut y, mut memory) = (turning.initial(), turning.initial(), TurningMemory::default());
    /// for _ in 0..100 {
    ///     turning.step(&mut x, &u, 0.1, &mut memory).unwrap();
    ///     turning.advance(&mut y, &u, 0.1).unwrap();
    /// }
    /// assert_eq!(x, y);
    /// ```
    pub fn step(
        &self,
        x: &mut TurningState,
        u: &TurningInput,
        dt: f64,
        memory: &mut TurningMemory,
    ) -> Result<Advance, ModelError> {
        if !(self.keeps_still(u) && dt >= 0.0 && dt.is_finite()) {
            return self.integrate(x, u, dt, &[], &mut |_, _, _| ());
        }
        let input = numbers(u);
        let known = match &mut memory.known {
            Some(known) if known.differs_in_speed_at_most(&input) => {
                // A policy that commands another speed changes nothing else.
                if known.input[0] != input[0] {
                    TurningInput::FIELDS[0].check(u.cutting_speed)?;
                    known.engagement.change_speed(&self.pair, u.cutting_speed);
                    known.input = input;
                    known.last = None;
                }
                known
            }
            known => {
                u.check()?;
                let tolerance = Tolerance { relative: ACCURACY, absolute: self.scales(ACCURACY) };
                let engagement = self.engagement(x, u).keep();
                known.insert(LastEngagement { input, engagement, angles: OnceCell::new(), tolerance, last: None })
            }
        };
        let engagement = self.engagement_of(&known.engagement);
        let last = match &mut known.last {
            Some(last) if last.state == *x => last,
            last => {
                let indicators = engagement.event_indicators(x, u.chipping_resistance);
                if let Some(event) = lost_at(&indicators, u) {
                    return Ok(Advance { elapsed: 0.0, event: Some(event) });
                }
                last.insert(Last { state: *x, indicators })
            }
        };
        let y = array(x);
        if let Some(end) = ode::short_step(&engagement, &y, dt, &known.tolerance) {
            let state = TurningState::from_slice(&end);
            let indicators = engagement.event_indicators(&state, u.chipping_resistance);
            // An edge that may not go on is refused at the start of the next step.
            if !(0..WEAR_EVENTS.len()).any(|i| last.indicators[i] < 0.0 && indicators[i] >= 0.0) {
                *x = state;
                *last = Last { state, indicators };
                return Ok(Advance { elapsed: dt, event: None });
            }
        }
        let mut state = *x;
        let advance = self.integrate_unwatched(&mut state, u, Some(engagement), dt, &[], &mut |_, _, _| ())?;
        *x = state;
        Ok(advance)
    }

    /// [`Process::output`] with the memory of a step: coefficients of the input. The result is the same to the bit.
    ///
    /// # Examples
    /// ```
    /// use toolroom_cutting::{Turning, TurningInput, TurningMemory};
    /// use toolroom_process::Process;
    /// let (turning, u) = (Turning::default(), TurningInput::default());
    /// let (mut x, mut memory) = (turning.initial(), TurningMemory::default());
    /// turning.step(&mut x, &u, 0.1, &mut memory).unwrap();
    /// assert_eq!(turning.output_after(&x, &u, &memory), turning.output(&x, &u));
    /// ```
    #[inline]
    pub fn output_after(&self, x: &TurningState, u: &TurningInput, memory: &TurningMemory) -> TurningOutput {
        match &memory.known {
            Some(known) if same(&known.input, &numbers(u)) => {
                let engagement = self.engagement_of(&known.engagement);
                let angles = known.angles.get_or_init(|| self.angles(&engagement));
                self.observe_at(&engagement, angles, x, u)
            }
            _ => self.output(x, u),
        }
    }

    /// One of the outputs that cost little by themselves, by its place among the fields: what the motion decides, forces with
    /// what they press, power, temperature, thermo-EMF and wear, the same to the bit as [`Turning::output_after`] has them. `None`
    /// for what vibrates, for what effects or a structure change, and for forces and wear where the memory is not of this input.
    ///
    /// # Examples
    /// ```
    /// use toolroom_cutting::{Turning, TurningInput, TurningMemory, TurningOutput};
    /// use toolroom_process::{Process, Record};
    /// let (turning, u) = (Turning::default(), TurningInput::default());
    /// let (mut x, mut memory) = (turning.initial(), TurningMemory::default());
    /// turning.step(&mut x, &u, 0.1, &mut memory).unwrap();
    /// let alone = |name| turning.one_output_after(TurningOutput::<f64>::index_of(name)?, &x, &u, &memory);
    /// assert_eq!(alone("feed_force"), Some(turning.output(&x, &u).feed_force));
    /// assert_eq!(alone("vibration_rms"), None);
    /// ```
    #[inline]
    pub fn one_output_after(
        &self,
        output: usize,
        x: &TurningState,
        u: &TurningInput,
        memory: &TurningMemory,
    ) -> Option<f64> {
        // Nothing is kept of a cut that vibrates or of one under effects, see `keeps_still`.
        let calm = || (self.structure.is_none() && self.effects.is_empty()).then_some(self);
        let engaged = || {
            let known = memory.known.as_ref().filter(|known| same(&known.input, &numbers(u)))?;
            Some((known, self.engagement_of(&known.engagement)))
        };
        let sensed = || engaged().map(|(_, engagement)| engagement.sensed(x, u));
        let wear = || engaged().map(|(_, engagement)| engagement.wear(x));
        let motion = || calm().map(|turning| turning.motion(u));
        let pressed = || {
            let (known, engagement) = engaged()?;
            let angles = known.angles.get_or_init(|| self.angles(&engagement));
            let [_, feed_force] = engagement.true_forces(x);
            Some(self.pressed(&engagement, angles, x.flank_wear, feed_force))
        };
        match output {
            FLANK_WEAR => Some(x.flank_wear),
            WEAR_RATIO => Some(self.wear_ratio(x)),
            SPINDLE_SPEED => Some(motion()?.spindle_speed),
            REMOVAL_RATE => Some(motion()?.material_removal_rate),
            ROUGHNESS => Some(motion()?.marks),
            CUTTING_FORCE => Some(sensed()?.cutting_force),
            FEED_FORCE => Some(sensed()?.feed_force),
            SPINDLE_POWER => Some(sensed()?.spindle_power),
            TEMPERATURE => Some(sensed()?.temperature),
            PASSIVE_FORCE => Some(pressed()?.passive_force),
            SIZE_ERROR => Some(pressed()?.size_error),
            MECHANICAL_WEAR => Some(wear()?.mechanical_per_path),
            THERMAL_WEAR => Some(wear()?.thermal_rate),
            WEAR_INTENSITY => Some(engaged()?.1.wear_intensity(x)),
            WEAR_BALANCE => Some(engaged()?.1.wear_balance(x)),
            THERMO_EMF => {
                let (known, engagement) = engaged()?;
                Some(engagement.thermo_emf(x, known.angles.get_or_init(|| self.angles(&engagement))))
            }
            // Without effects the edge runs true.
            PEAK_FORCE => Some(engaged()?.1.true_forces(x)[0]),
            _ => None,
        }
    }

    /// Whether nothing but the edge's wear changes in a step: no ramp, no effect, no chatter, no
    /// variation of speed.
    fn keeps_still(&self, u: &TurningInput) -> bool {
        u.cutting_acceleration == 0.0
            && u.engaged > 0.0
            && u.speed_variation <= 0.0
            && self.effects.is_empty()
            && self.structure.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_after_a_change_of_speed_are_those_without_memory_to_the_bit() {
        let turning = Turning::default();
        let (mut x, mut y, mut memory) = (turning.initial(), turning.initial(), TurningMemory::default());
        for i in 0..200 {
            let u = TurningInput { cutting_speed: 0.5 + 0.001 * f64::from(i), ..TurningInput::default() };
            turning.step(&mut x, &u, 0.1, &mut memory).unwrap();
            turning.advance(&mut y, &u, 0.1).unwrap();
            assert_eq!(x, y);
            let output = turning.output(&y, &u);
            assert_eq!(turning.output_after(&x, &u, &memory), output);
            let alone = |i: usize| Some((i, turning.one_output_after(i, &x, &u, &memory)?));
            let alone: Vec<(usize, f64)> = (0..TurningOutput::<f64>::LEN).filter_map(alone).collect();
            assert_eq!(alone.len(), 17, "{alone:?}");
            for (i, value) in alone {
                assert_eq!(Some(value), output.get(i), "{}", TurningOutput::<f64>::FIELDS[i].name);
            }
        }
    }
}
