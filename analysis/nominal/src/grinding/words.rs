//! What a scenario calls the numbers of this model, and what it states of them.

use super::catalogue::Action;
use super::{Change, Grinding};
use crate::stated::Declarations;
use crate::{Candidate, EffectId, Movable, Words, WrittenEffect};
use toolroom_records::Records;
use toolroom_scenario::{Scope, Target, move_constant};

impl Grinding {
    /// Takes over what the file states about these rows.
    pub(super) fn state(&mut self, records: &Records, stated: &mut Declarations) {
        let Some(tool) = stated.tool.clone() else { return };
        let tool = || Target::Tool(tool.clone());
        let mut list: Vec<(String, Movable)> = Vec::new();
        for (parameter, change) in self.frame.parameters.iter().zip(&self.changes) {
            let movable = match change {
                Change::ProcessStiffness => Movable::factor("infeed.process_stiffness", tool()),
                Change::SystemStiffness => Movable::factor("infeed.system_stiffness", tool()),
                Change::Scale => Movable::factor("gain.infeed_per_rev", tool()),
                Change::Machine(machine, _) => {
                    if stated.handling.iter().all(|(own, _)| own != machine) {
                        continue;
                    }
                    let scope = Scope { names: vec![("machine", vec![machine.clone()])], ..Scope::default() };
                    Movable { scope, ..Movable::factor("infeed.system_stiffness", tool()) }
                }
                Change::Exponent | Change::Ramp => continue,
            };
            list.push((parameter.name.clone(), movable));
        }
        for surface in self.frame.surfaces.iter().filter(|surface| !surface.role.is_allowance()) {
            let channel = surface.channels.first().map_or("", |index| self.frame.measured.channels[*index].id.word());
            list.push((surface.name.clone(), Movable::factor(format!("gain.{channel}"), tool())));
        }
        self.switch_on(records, stated);
        // Other constants of the process are moved and do not move further.
        for calibration in stated.calibrations.clone() {
            let known = list.iter().any(|(_, word)| word.parameter == calibration.parameter);
            let ours = calibration.target == tool() && calibration.scope.is_everywhere();
            if let (Some((group, field)), true, false) = (calibration.constant(), ours, known) {
                // A constant that the process lacks was refused with its file.
                let _ = move_constant(
                    toolroom_process::Process::parameters_mut(&mut self.process),
                    group,
                    field,
                    calibration.moved,
                );
                stated.calibrations.retain(|other| *other != calibration);
            }
        }
        self.frame.words.movable = list;
        Words::settle(&mut self.frame, stated);
    }

    /// Effects of the wheel: sizes of their candidates, which are added where the records requested none.
    fn switch_on(&mut self, records: &Records, stated: &Declarations) {
        for entry in &stated.effects {
            let (effect, scope) = (entry.effect, stated.normal(&entry.scope));
            let same = |index: usize| {
                let written = self.written_effect(index);
                self.frame.candidates[index].id == EffectId::from(&effect)
                    && written
                        == WrittenEffect { recorded: written.recorded, ..WrittenEffect::from_effect(&effect, &scope) }
            };
            let found = (0..self.actions.len()).find(|index| same(*index));
            let index = match found {
                Some(index) => index,
                None => {
                    let entry = effect.entry();
                    let typical = if effect.size() > 0.0 { effect.size() } else { 1e-3 * entry.size.max };
                    let everywhere = scope.is_everywhere();
                    self.frame.candidates.push(Candidate {
                        id: EffectId::from(&effect),
                        shape: if everywhere { "of the file".to_owned() } else { scope.words() },
                        typical,
                        greatest: entry.size.max,
                        least: entry.size.min.min(0.0),
                        onset: 0.0,
                    });
                    let effect = effect.with_size(0.0);
                    self.actions.push(if everywhere {
                        Action::Effect { effect, by_command: false }
                    } else {
                        let rows = stated.rows(records, &scope);
                        Action::Scoped { effect, scope, rows }
                    });
                    self.actions.len() - 1
                }
            };
            self.frame.words.effects.push((index, effect.size()));
        }
    }

    /// How a scenario says a candidate.
    pub(super) fn written_effect(&self, candidate: usize) -> WrittenEffect {
        match &self.actions[candidate] {
            Action::Effect { effect, by_command } => {
                let mut written = WrittenEffect::from_effect(effect, &Scope::default());
                if *by_command {
                    // No scenario has a word for it: an application refuses it rather than lose it.
                    written.shape.push(("positioned_since_dressing", 1.0, "1", "1"));
                }
                written
            }
            Action::Scoped { effect, scope, .. } => WrittenEffect::from_effect(effect, scope),
            Action::Coolant(_) => {
                let name = &self.frame.candidates[candidate].shape;
                let name = name.strip_prefix("coolant ").unwrap_or(name).to_owned();
                let scope = Scope { names: vec![("coolant", vec![name])], ..Scope::default() };
                WrittenEffect { scope, ..WrittenEffect::default() }
            }
        }
    }
}
