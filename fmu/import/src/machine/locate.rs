//! Where in a step an event happens.

use super::{START, UnitProcess};
use crate::halving::{Halving, risen};
use crate::instance::{Action, Answer, StepResult};
use crate::keeping::{KeepingError, Turn};
use toolroom_process::ProcessEvent;

impl UnitProcess {
    /// Finds the earliest event of a step of `length` by halving it, from the state saved at its start; the
    /// instance is left at the event. The tries run where the instance lives, and every value of theirs is looked at here.
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
        let before: Vec<u8> = before.iter().map(|flag| u8::from(*flag)).collect();
        let mut inputs = Vec::new();
        self.set(u, &mut inputs);
        let mut reads = Vec::new();
        self.get_after_step(&mut reads);
        let locate = Action::Locate {
            place: START,
            time: start,
            length,
            before: &before,
            inputs: inputs.len() as u32,
            reads: reads.len() as u32,
        };
        let all: Vec<Action<'_>> = [locate].into_iter().chain(inputs).chain(reads.iter().copied()).collect();
        turn.act(&all, true, answer)?;
        let mut halving = Halving::of(length);
        let mut event = None;
        let mut tries = answer.values.chunks_exact(reads.len().max(1));
        while let Some(length) = halving.next() {
            let Some(values) = tries.next() else {
                let stepped = answer.stepped;
                let why = if stepped == StepResult::Whole { "no answer".to_owned() } else { format!("{stepped:?}") };
                return Err(KeepingError::Impossible(format!(
                    "at {start} s it took a step that holds an event, and then not one of {length} s ({why})"
                )));
            };
            let (flags, outputs) = values.split_at(self.events.len());
            // The state is an earlier one: its wear may be less.
            seen[0] = self.watch.check(&outputs[..self.watch.len()], start + length, f64::NEG_INFINITY)?;
            seen[1..].copy_from_slice(flags);
            event = risen(&before, flags).map(|i| self.events[i].0);
            halving.tried(length, event.is_some());
        }
        // What comes behind reads the values of the last try, as after any other step.
        let last = answer.values.len().saturating_sub(reads.len());
        answer.values.drain(..last);
        Ok((halving.found(), event))
    }
}
