//! Effects of grinding that the diagnosis tries.

use super::Grinding;
use crate::Candidate;
use crate::features::{self, standardised};
use toolroom_effects::{Effect, Effects};
use toolroom_infeed::Infeed;
use toolroom_process::Process;
use toolroom_records::Records;

/// Share of its stiffness that a machine may lose by the last trial: what is left has to stay positive (assumption).
const MOST_LOST: f64 = 0.9;

/// How a candidate acts.
pub(super) enum Action {
    /// By the process; what the wheel has worn may be missing from the infeed of later parts.
    Effect { effect: Effect, by_command: bool },
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
    pub(super) fn catalogue(&mut self, records: &Records) {
        let latest = self.conditions.latest();
        let waits = records.numbers("wait_time").and_then(standardised).is_some();
        let mut add = |effect: Effect, shape: String, typical: f64, action: Action| {
            let entry = effect.entry();
            let greatest = match entry.id {
                "stiffness_drift" => entry.size.max.min(MOST_LOST / latest),
                _ => entry.size.max,
            };
            self.frame.candidates.push(Candidate { id: entry.id, shape, typical, greatest });
            self.actions.push(action);
        };
        let plain = |effect: Effect| Action::Effect { effect, by_command: false };
        for effect in Effects::every(Infeed::NAME).iter().copied() {
            match effect.entry().id {
                "wheel_dulling" => add(effect, String::new(), 0.3, plain(effect)),
                "wheel_wear" => {
                    add(effect, "each part finds contact".to_owned(), 0.1, plain(effect));
                    let by_command = Action::Effect { effect, by_command: true };
                    // It adds up over the parts.
                    add(effect, "positioned since dressing".to_owned(), 0.01, by_command);
                }
                "threshold_force" => add(effect, String::new(), 15.0, plain(effect)),
                "start_offset" => add(effect, String::new(), 3e-6, plain(effect)),
                "thermal_growth" => {
                    let times: &[f64] = if waits { &[15.0, 60.0, 240.0] } else { &[60.0] };
                    for time in times {
                        let mut shaped = effect;
                        shaped.parameters_mut().set_value(1, *time);
                        add(effect, format!("{time} s"), 5e-10, plain(shaped));
                    }
                }
                "stiffness_drift" if latest > 0.0 => add(effect, String::new(), 0.1 / latest, plain(effect)),
                "coolant_change" => {
                    for (_, coolant, rows) in features::indicators(records, &["coolant_id"]) {
                        add(effect, format!("coolant {coolant}"), 0.1, Action::Coolant(rows));
                    }
                }
                _ => {}
            }
        }
    }
}
