//! Effects of grinding that the diagnosis tries.

use super::Grinding;
use crate::parts::{MOST, parts};
use crate::search::{self, Rows, SearchContext, Shape, Way};
use crate::stated::Declarations;
use crate::{Candidate, EffectId, Untried};
use toolroom_effects::{Definition, Effect};
use toolroom_infeed::Infeed;
use toolroom_process::Process;
use toolroom_records::Records;
use toolroom_scenario::Scope;

/// How a candidate acts.
pub(super) enum Action {
    /// By the process; what the wheel has worn may be missing from the infeed of later parts.
    Effect { effect: Effect, by_command: bool },
    /// By the process, on a part of the trials: 1 on its rows.
    Scoped { effect: Effect, scope: Scope, rows: Vec<f64> },
    /// By the process, on the rows of one coolant.
    Coolant(Vec<f64>),
}

impl Action {
    /// Whether infeed is positioned by command since the dressing.
    pub fn is_by_command(&self) -> bool {
        matches!(self, Self::Effect { by_command: true, .. })
    }
}

impl Grinding {
    pub(super) fn catalogue(&mut self, records: &Records, defined: &[&'static Definition]) {
        self.frame.defined = defined.to_vec();
        let latest = self.conditions.latest();
        let greatest = |quantity: &str| match quantity {
            "machine_time" => (latest > 0.0).then_some(latest),
            column => search::greatest(records, column),
        };
        let ways = &[Way::Coolants, Way::WheelPosition];
        let sought = SearchContext { process: Infeed::NAME, records, greatest: &greatest, ways };
        for effect in search::effects_of(Infeed::NAME, defined) {
            let id = EffectId::from(&effect);
            let shapes = match sought.shapes(effect) {
                Ok(shapes) => shapes,
                Err(reason) => {
                    self.frame.untried.push(Untried { id, reason });
                    continue;
                }
            };
            for Shape { name, effect, typical, greatest, rows } in shapes {
                self.frame.candidates.push(Candidate {
                    id,
                    shape: name,
                    typical,
                    greatest,
                    least: effect.entry().size.min.min(0.0),
                    onset: 0.0,
                });
                self.actions.push(match rows {
                    Rows::Coolant(rows) => Action::Coolant(rows),
                    Rows::SinceDressing => Action::Effect { effect, by_command: true },
                    Rows::All => Action::Effect { effect, by_command: false },
                    Rows::Lot(..) => unreachable!("the way of lots is not offered"),
                });
            }
        }
    }

    /// Adds the effects that are to be split, on every part of the trials that two dressings at least lie in.
    pub(super) fn split(&mut self, records: &Records, stated: &Declarations) {
        if !stated.is_split() {
            return;
        }
        let effects = self.frame.candidates.clone();
        for (index, part) in stated.tried(&effects, &parts(records, &self.frame.measured.group_of_row)) {
            // Where a wheel is positioned by command, and what another coolant does, is reported by rows already.
            let Action::Effect { effect, by_command: false } = &self.actions[index] else { continue };
            if self.actions.len() >= effects.len() + MOST {
                continue;
            }
            let action = Action::Scoped { effect: *effect, scope: part.scope.clone(), rows: part.rows.clone() };
            let base = effects[index].clone();
            self.frame.candidates.push(Candidate { shape: part.words(&base.shape), ..base });
            self.actions.push(action);
        }
    }
}
