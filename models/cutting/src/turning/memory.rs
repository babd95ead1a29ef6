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

#[derive(Clone, Debug)]
struct LastEngagement {
    input: TurningInput,
    engagement: Kept,
    /// Worked out with the first outputs.
    angles: OnceCell<Angles<f64>>,
    tolerance: Tolerance<STATES>,
    last: Option<Last>,
}

impl LastEngagement {
    /// Whether an input differs in nothing but the cutting speed, or not at all. Speeds on either side of 0 have nothing in
    /// common.
    fn differs_in_speed_at_most(&self, u: &TurningInput) -> bool {
        let at_speed = TurningInput { cutting_speed: u.cutting_speed, ..self.input };
        let (kept_speed, speed) = (self.input.cutting_speed, u.cutting_speed);
        (kept_speed == speed || kept_speed > 0.0 && speed > 0.0) && at_speed == *u
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
        let known = match &mut memory.known {
            Some(known) if known.differs_in_speed_at_most(u) => {
                // A policy that commands another speed changes nothing else.
                if known.input.cutting_speed != u.cutting_speed {
                    TurningInput::FIELDS[0].check(u.cutting_speed)?;
                    known.engagement.change_speed(&self.pair, u.cutting_speed);
                    known.input.cutting_speed = u.cutting_speed;
                    known.last = None;
                }
                known
            }
            known => {
                u.check()?;
                let tolerance = Tolerance { relative: ACCURACY, absolute: self.scales(ACCURACY) };
                let engagement = self.engagement(x, u).keep();
                known.insert(LastEngagement { input: *u, engagement, angles: OnceCell::new(), tolerance, last: None })
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
    pub fn output_after(&self, x: &TurningState, u: &TurningInput, memory: &TurningMemory) -> TurningOutput {
        match &memory.known {
            Some(known) if known.input == *u => {
                let engagement = self.engagement_of(&known.engagement);
                let angles = known.angles.get_or_init(|| self.angles(&engagement));
                self.observe_at(&engagement, angles, x, u)
            }
            _ => self.output(x, u),
        }
    }

    /// One of the outputs that cost little by themselves, by its name: flank wear, forces, power and temperature, the same to
    /// the bit as [`Turning::output_after`] has them. `None` for the others, and for all but flank wear where the memory is
    /// not of this input.
    ///
    /// # Examples
    /// ```
    /// use toolroom_cutting::{Turning, TurningInput, TurningMemory};
    /// use toolroom_process::Process;
    /// let (turning, u) = (Turning::default(), TurningInput::default());
    /// let (mut x, mut memory) = (turning.initial(), TurningMemory::default());
    /// turning.step(&mut x, &u, 0.1, &mut memory).unwrap();
    /// assert_eq!(turning.one_output_after("feed_force", &x, &u, &memory), Some(turning.output(&x, &u).feed_force));
    /// assert_eq!(turning.one_output_after("roughness_ra", &x, &u, &memory), None);
    /// ```
    pub fn one_output_after(
        &self,
        name: &str,
        x: &TurningState,
        u: &TurningInput,
        memory: &TurningMemory,
    ) -> Option<f64> {
        if name == "flank_wear" {
            return Some(x.flank_wear);
        }
        if !matches!(name, "cutting_force" | "feed_force" | "spindle_power" | "temperature") {
            return None;
        }
        let known = memory.known.as_ref().filter(|known| known.input == *u)?;
        let sensed = self.engagement_of(&known.engagement).sensed(x, u);
        match name {
            "cutting_force" => Some(sensed.cutting_force),
            "feed_force" => Some(sensed.feed_force),
            "spindle_power" => Some(sensed.spindle_power),
            "temperature" => Some(sensed.temperature),
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
    use toolroom_process::Field;

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
            let alone = |field: &Field| Some((field.name, turning.one_output_after(field.name, &x, &u, &memory)?));
            let alone: Vec<(&str, f64)> = TurningOutput::<f64>::FIELDS.iter().filter_map(alone).collect();
            assert_eq!(alone.len(), 5, "{alone:?}");
            for (name, value) in alone {
                let index = TurningOutput::<f64>::index_of(name).expect("a field");
                assert_eq!(Some(value), output.get(index), "{name}");
            }
        }
    }
}
