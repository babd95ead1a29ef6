//! Steps that remember what the step before worked out.

use super::equations::{Engagement, Kept};
use super::{ACCURACY, STATES, Turning, TurningInput, TurningOutput, TurningState, lost_at_once};
use toolroom_process::ode::{self, Autonomous, Tolerance};
use toolroom_process::{Advance, ModelError, Process, Record};
use toolroom_wear::WEAR_EVENTS;

/// What a step under held input works out and the next one under the same input need not work out
/// again. Forgetting it changes no result, to the bit; it holds for one process only and has to be
/// forgotten where a parameter of that changes.
#[derive(Clone, Debug, Default)]
pub struct TurningMemory {
    known: Option<Known>,
}

#[derive(Clone, Debug)]
struct Known {
    input: TurningInput,
    engagement: Kept,
    tolerance: Tolerance<STATES>,
    last: Option<Last>,
}

impl Known {
    /// Whether an input differs in nothing but the cutting speed. Speeds on either side of 0 have nothing in common.
    fn changes_speed_only(&self, u: &TurningInput) -> bool {
        let at_speed = TurningInput { cutting_speed: u.cutting_speed, ..self.input };
        at_speed == *u && u.cutting_speed > 0.0 && self.input.cutting_speed > 0.0
    }
}

/// Where the last step ended.
#[derive(Clone, Copy, Debug)]
struct Last {
    state: TurningState,
    slope: [f64; STATES],
    indicators: [f64; 3],
}

impl Autonomous<STATES> for Engagement<'_> {
    #[inline(always)]
    fn slope(&self, y: &[f64; STATES]) -> [f64; STATES] {
        array(&self.rates(&TurningState::from_slice(y)))
    }
}

/// The right-hand side where no step before has left it.
#[cold]
fn first_slope(engagement: &Engagement<'_>, x: &TurningState) -> [f64; STATES] {
    engagement.slope(&array(x))
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
    /// coefficients of the input and the right-hand side at the end of the step.
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
            Some(known) if known.input == *u => known,
            // A policy that commands another speed changes nothing else.
            Some(known) if known.changes_speed_only(u) => {
                TurningInput::FIELDS[0].check(u.cutting_speed)?;
                let engagement = self.engagement_of(&known.engagement).at_speed(&self.pair, u.cutting_speed);
                (known.input, known.engagement, known.last) = (*u, engagement.keep(), None);
                known
            }
            known => {
                u.check()?;
                let tolerance = Tolerance { relative: ACCURACY, absolute: self.scales(ACCURACY) };
                known.insert(Known { input: *u, engagement: self.engagement(x, u).keep(), tolerance, last: None })
            }
        };
        let engagement = self.engagement_of(&known.engagement);
        let last = match &mut known.last {
            Some(last) if last.state == *x => last,
            last => {
                if let Some(event) = lost_at_once(&engagement, x, u) {
                    return Ok(Advance { elapsed: 0.0, event: Some(event) });
                }
                let indicators = engagement.event_indicators(x, u.chipping_resistance);
                last.insert(Last { state: *x, slope: first_slope(&engagement, x), indicators })
            }
        };
        let y = array(x);
        if let Some((end, slope)) = ode::short_step(&engagement, &y, &last.slope, dt, &known.tolerance) {
            let state = TurningState::from_slice(&end);
            let indicators = engagement.event_indicators(&state, u.chipping_resistance);
            // An edge that may not go on is refused at the start of the next step.
            if !(0..WEAR_EVENTS.len()).any(|i| last.indicators[i] < 0.0 && indicators[i] >= 0.0) {
                *x = state;
                *last = Last { state, slope, indicators };
                return Ok(Advance { elapsed: dt, event: None });
            }
        }
        self.integrate(x, u, dt, &[], &mut |_, _, _| ())
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
            Some(known) if known.input == *u => self.observe_in(&self.engagement_of(&known.engagement), x, u),
            _ => self.output(x, u),
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
            assert_eq!(turning.output_after(&x, &u, &memory), turning.output(&y, &u));
        }
    }
}
