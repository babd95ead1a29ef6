//! Effects on parts of the records.

use super::{Action, Cutting, Nominal};
use crate::Candidate;
use crate::parts::{MOST, Part, parts};
use crate::stated::Stated;
use toolroom_records::Records;

impl<P: Nominal> Cutting<P> {
    /// Adds the effects that are to be split, on every part of the records that two groups at least lie in.
    pub(super) fn split(&mut self, records: &Records, stated: &Stated) {
        if !stated.is_split() {
            return;
        }
        let effects = self.frame.candidates.len();
        for part in &parts(records, &self.frame.measured.group_of_row) {
            for index in 0..effects {
                let base = self.frame.candidates[index].clone();
                let full = self.actions.iter().filter(|own| matches!(own, Action::Scoped(..))).count() >= MOST;
                if !stated.tries(&base, part) || full {
                    continue;
                }
                if let Some(action) = self.on(index, part) {
                    self.frame.candidates.push(Candidate { shape: part.words(&base.shape), ..base });
                    self.actions.push(action);
                }
            }
        }
    }

    /// What a candidate does on a part of the records; nothing where it acts on a part already.
    fn on(&self, candidate: usize, part: &Part) -> Option<Action> {
        match &self.actions[candidate] {
            Action::Effect(effect) => Some(Action::Scoped(*effect, part.scope.clone(), part.rows.clone())),
            Action::Reading { channel, column, scope, recorded } if scope.is_everywhere() => {
                let column: Vec<f64> = column.iter().zip(&part.rows).map(|(value, on)| value * on).collect();
                // What is recorded is the mean over the rows of the part.
                let within = |of: &[f64]| of.iter().zip(&part.rows).map(|(value, on)| value * on).sum::<f64>();
                let rows: f64 = part.rows.iter().sum();
                let recorded = recorded.map(|_| match self.frame.candidates[candidate].id {
                    "feed_override" => within(&column) / within(&self.durations),
                    _ => within(&column) / rows,
                });
                Some(Action::Reading { channel: *channel, column, scope: part.scope.clone(), recorded })
            }
            Action::Reading { .. } | Action::Scoped(..) | Action::Lot(..) => None,
        }
    }
}
