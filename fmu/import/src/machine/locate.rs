//! Where in a step an event happens.

use super::{EVENT_TIME, START, Try, UnitProcess};
use crate::instance::{Action, Answer, StepResult};
use crate::keeping::{KeepingError, Turn};
use toolroom_process::ProcessEvent;

impl UnitProcess {
    /// Finds the earliest event of a step of `length` by halving it, from the state saved at its start; the
    /// instance is left at the event.
    #[allow(clippy::too_many_arguments)] // a step, its start and what was seen there
    pub(super) fn locate(
        &self,
        turn: &mut Turn<'_>,
        answer: &mut Answer,
        u: &[f64],
        start: f64,
        length: f64,
        before: &[bool],
        seen: &mut [f64],
    ) -> Result<(f64, Option<ProcessEvent>), KeepingError> {
        let wear = seen[0];
        let (mut quiet, mut loud) = (0.0, length);
        let mut last = None;
        while loud - quiet > EVENT_TIME * length {
            let middle = 0.5 * (quiet + loud);
            let event = self.again(turn, answer, u, start, middle, before, seen)?;
            if event.is_some() {
                loud = middle
            } else {
                quiet = middle
            }
            last = Some(middle);
        }
        if last == Some(loud) {
            let flags = self.events.iter().zip(before.iter().zip(&seen[1..]));
            let rose =
                flags.map(|((event, _), (before, now))| (event, !*before && *now != 0.0)).find(|(_, rose)| *rose);
            return Ok((loud, rose.map(|(event, _)| *event)));
        }
        seen[0] = wear.min(seen[0]);
        Ok((loud, self.again(turn, answer, u, start, loud, before, seen)?))
    }

    /// The step again, from the state saved at its start.
    #[allow(clippy::too_many_arguments)] // as above
    fn again(
        &self,
        turn: &mut Turn<'_>,
        answer: &mut Answer,
        u: &[f64],
        start: f64,
        length: f64,
        before: &[bool],
        seen: &mut [f64],
    ) -> Result<Option<ProcessEvent>, KeepingError> {
        turn.act(&[Action::Restore(START)], false, answer)?;
        seen[0] = f64::NEG_INFINITY; // the state is an earlier one
        let step = Try { from: start, length, save: false, check: false };
        match self.attempt(turn, answer, u, &step, before, seen)? {
            (StepResult::Whole, event) => Ok(event),
            (stepped, _) => Err(KeepingError::Impossible(format!(
                "at {start} s it took a step that holds an event, and then not one of {length} s ({stepped:?})"
            ))),
        }
    }
}
