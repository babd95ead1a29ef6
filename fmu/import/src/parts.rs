//! Communication steps that a unit discards as a whole, taken in parts.
//!
//! After `fmi2Discard` a unit goes on from a state that was saved before the step only; after `fmi3Discard` it is where it
//! was before the step, and a shorter one may be tried at once.

use crate::instance::{Action, Answer, CallError, Instance, Place, StepResult};
use crate::unit::{Steps, Unit};

/// Halvings of one part before it is given up (assumption: 2⁻³⁰ of a step is no step).
const HALVINGS: u32 = 30;

/// Discarded tries of one step before it is given up (assumption: a unit that needs more is not driven, it is fought).
const TRIES: u32 = 10_000;

/// Where the state before a step is saved.
const START: Place = Place::MAX;

/// The lengths in which a step is tried.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Parts {
    /// The whole step, s.
    length: f64,
    /// What is taken of it, s.
    pub done: f64,
    /// What is tried next, s.
    pub part: f64,
    halvings: u32,
    tries: u32,
}

impl Parts {
    /// A step of `length` seconds, first tried as a whole.
    pub fn of(length: f64) -> Self {
        Self { length, done: 0.0, part: length, halvings: 0, tries: 0 }
    }

    /// Whether anything is left.
    pub fn left(&self) -> bool {
        self.done < self.length
    }

    /// The part was taken; the next one is twice as long at most.
    pub fn taken(&mut self) {
        self.done = if self.part == self.length - self.done { self.length } else { self.done + self.part };
        self.part = (self.length - self.done).min(2.0 * self.part);
        self.halvings = 0;
    }

    /// The part was discarded, after `reached` seconds of it: the next one is so long, or else half as long. False where
    /// there is no use in another try.
    pub fn discarded(&mut self, reached: f64) -> bool {
        let told = reached > 0.0 && reached < self.part;
        self.part = if told { reached } else { 0.5 * self.part };
        self.halvings += 1;
        self.tries += 1;
        self.halvings <= HALVINGS && self.tries <= TRIES
    }
}

/// Communication steps of an instance, those in parts that the unit discards.
#[derive(Clone, Copy, Debug)]
pub struct Retaking {
    /// Whether a discarded step can be taken again.
    possible: bool,
    /// Whether the state before each step is saved for that.
    saves: bool,
}

impl Retaking {
    /// Of instances of `unit`.
    pub fn from_unit(unit: &Unit) -> Self {
        let (free, two) = (unit.steps() == Steps::Any, unit.description().major == 2);
        let saves = free && two && unit.interface().saves_state();
        Self { possible: free && (saves || !two), saves }
    }

    /// Does `actions` with a step from `time` to `goal` (s) before the others of `after`; how the step ended, which is in
    /// parts where it had to be. What is `after` it is done where it was whole.
    ///
    /// # Errors
    /// [`CallError`] of the first action that failed.
    pub fn act(
        &mut self,
        instance: &mut Instance,
        before: &[Action<'_>],
        (time, goal): (f64, f64),
        after: &[Action<'_>],
        answer: &mut Answer,
    ) -> Result<StepResult, CallError> {
        let step = [Action::Step { time, duration: goal - time }];
        let plain = || before.iter().chain(&step).chain(after).copied();
        if self.saves {
            let saved: Vec<Action<'_>> = [Action::Save(START)].into_iter().chain(plain()).collect();
            match instance.act(&saved, answer) {
                // A unit that cannot save its state although it says so is driven without.
                Err(error) if error.function == "fmi2GetFMUstate" && instance.alive() => {
                    *self = Self { possible: false, saves: false };
                    instance.act(&plain().collect::<Vec<_>>(), answer)?;
                }
                acted => acted?,
            }
        } else {
            instance.act(&plain().collect::<Vec<_>>(), answer)?;
        }
        let StepResult::Part(mut reached) = answer.stepped else { return Ok(answer.stepped) };
        let mut parts = Parts::of(goal - time);
        while self.possible && parts.discarded(reached - time - parts.done) {
            let back = self.saves.then_some(Action::Restore(START));
            let mut actions: Vec<Action<'_>> = back.into_iter().chain(before.iter().copied()).collect();
            loop {
                let from = time + parts.done;
                actions.extend(self.saves.then_some(Action::Save(START)));
                actions.push(Action::Step { time: from, duration: parts.part });
                instance.act(&actions, answer)?;
                match answer.stepped {
                    StepResult::Whole => parts.taken(),
                    StepResult::Part(time) => {
                        reached = time;
                        break;
                    }
                    StepResult::Ended(_) => return Ok(answer.stepped),
                }
                if !parts.left() {
                    instance.act(after, answer)?;
                    return Ok(StepResult::Whole);
                }
                actions.clear();
            }
        }
        Ok(StepResult::Part(reached))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_in_parts_ends_at_its_end_whatever_the_parts() {
        // A unit that takes up to 7 s, tells how far it came or not, and never takes a whole step at once.
        for told in [true, false] {
            let (mut parts, mut steps) = (Parts::of(1000.1), 0);
            while parts.left() {
                if parts.part > 7.0 {
                    assert!(parts.discarded(if told { 7.0 } else { 0.0 }), "{parts:?}");
                } else {
                    parts.taken();
                    steps += 1;
                }
            }
            assert_eq!(parts.done, 1000.1);
            assert!((143..600).contains(&steps), "{steps}");
        }
        let mut never = Parts::of(1.0);
        assert_eq!((0..100).take_while(|_| never.discarded(0.0)).count(), HALVINGS as usize);
    }
}
