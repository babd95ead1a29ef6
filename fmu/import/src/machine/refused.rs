//! Calls that failed and are told of again. A study makes the replication that stopped once more for its logs; a call that
//! hung is not waited for a second time then, and a unit that fails by chance fails there as it did.

use std::sync::{Mutex, PoisonError};

/// Refusals kept (assumption: more than there are threads whose replications stop at one time).
const KEPT: usize = 256;

/// How often a refusal is told again before the unit is asked once more (assumption: replications that run side by side
/// may meet the same step before the one that stopped is made again).
const TOLD: u32 = 16;

/// A step as numbers, to the bit: the state that it began in, its inputs, its length.
type Step = Vec<u64>;

/// Steps that the unit refused, with the reasons.
#[derive(Debug, Default)]
pub(super) struct Refused(Mutex<Vec<Refusal>>);

#[derive(Debug)]
struct Refusal {
    step: Step,
    reason: String,
    told: u32,
}

/// The key of a step of `dt` seconds from a state, with what was seen there, under inputs.
pub(super) fn step(state: &[f64], seen: &[f64], inputs: &[f64], dt: f64) -> Step {
    state.iter().chain(seen).chain(inputs).chain([&dt]).map(|number| number.to_bits()).collect()
}

impl Refused {
    /// Keeps why `step` was refused.
    pub fn keep(&self, step: Step, reason: &str) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.len() == KEPT {
            kept.remove(0);
        }
        kept.push(Refusal { step, reason: reason.to_owned(), told: 0 });
    }

    /// Why the unit refused `step`, where it did and was not yet asked for it too often.
    pub fn tell(&self, step: &Step) -> Option<String> {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let at = kept.iter().position(|refusal| refusal.step == *step)?;
        kept[at].told += 1;
        let reason = kept[at].reason.clone();
        if kept[at].told == TOLD {
            kept.remove(at);
        }
        Some(reason)
    }

    /// Whether nothing was refused.
    pub fn is_empty(&self) -> bool {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_refusal_is_told_again_of_the_same_step_only_and_not_for_ever() {
        let (refused, hung) = (Refused::default(), step(&[1.0, 2.0], &[], &[0.5], 3.0));
        assert!(refused.is_empty());
        refused.keep(hung.clone(), "it hung");
        assert_eq!(refused.tell(&step(&[1.0, 2.0], &[], &[0.5], 3.5)), None);
        for _ in 0..TOLD {
            assert_eq!(refused.tell(&hung), Some("it hung".to_owned()));
        }
        assert_eq!(refused.tell(&hung), None);
        (0..=KEPT).for_each(|i| refused.keep(step(&[], &[], &[], i as f64), "late"));
        assert_eq!(refused.tell(&step(&[], &[], &[], 0.0)), None);
        assert!(refused.tell(&step(&[], &[], &[], 1.0)).is_some());
    }
}
