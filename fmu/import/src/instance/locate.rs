//! A step taken again and again until its first event is located, where the instance lives: a try costs its calls and no
//! message.

use super::{Action, Answer, CallError, Local, StepResult};
use crate::halving::{Halving, risen};

impl Local {
    /// Runs [`Action::Locate`], the first of `actions`, with those behind it that belong to it; `begin` hears the number of
    /// each behind it, and 0 for the step itself. How many actions it was.
    pub(super) fn locate(
        &mut self,
        actions: &[Action<'_>],
        answer: &mut Answer,
        begin: &dyn Fn(usize),
    ) -> Result<usize, CallError> {
        let Some((Action::Locate { place, time, length, before, inputs, reads }, behind)) = actions.split_first()
        else {
            return Ok(1);
        };
        let inputs = (*inputs as usize).min(behind.len());
        let end = inputs.saturating_add(*reads as usize).min(behind.len());
        let mut halving = Halving::of(*length);
        while let Some(length) = halving.next() {
            begin(0);
            self.0.restore(*place)?;
            let start = answer.values.len();
            for (number, action) in behind[..inputs].iter().enumerate() {
                begin(1 + number);
                self.one(action, answer)?;
            }
            begin(0);
            answer.stepped = self.0.step(*time, length)?;
            if answer.stepped != StepResult::Whole {
                break;
            }
            for (number, action) in behind[inputs..end].iter().enumerate() {
                begin(1 + inputs + number);
                self.one(action, answer)?;
            }
            halving.tried(length, risen(before, &answer.values[start..]).is_some());
        }
        Ok(1 + end)
    }
}
