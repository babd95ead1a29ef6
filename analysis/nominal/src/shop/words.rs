//! What a scenario calls the numbers of this model, and what it states of them.

use super::action::Action;
use super::model::ShopModel;
use super::visit::Visits;
use crate::stated::Declarations;
use crate::{Candidate, EffectId, Words, WrittenEffect};
use toolroom_scenario::{Calibration, Occasion, Scope, ShopEffect};

impl ShopModel {
    /// Takes over what the file states about these blocks.
    pub(super) fn state(&mut self, visits: &Visits, stated: &mut Declarations) {
        for deviation in stated.deviations.clone() {
            let same = |index: usize| {
                let written = self.written_effect(index);
                self.frame.candidates[index].id == deviation.effect.into()
                    && written.scope == deviation.scope
                    && (deviation.effect == ShopEffect::FeedHold
                        || written.recorded.is_some() == deviation.recorded.is_some())
                    && !matches!(self.actions[index], Action::Booked)
            };
            let index = match (0..self.actions.len()).find(|index| same(*index)) {
                Some(index) => index,
                None => match self.scoped(visits, deviation.effect, &deviation.scope) {
                    Some(action) => {
                        let id = EffectId::from(deviation.effect);
                        let typical = if deviation.size == 0.0 { 1.0 } else { deviation.size.abs() };
                        let shape = action.shape(&deviation.scope);
                        self.frame.candidates.push(Candidate {
                            id,
                            shape,
                            typical,
                            greatest: f64::INFINITY,
                            least: 0.0,
                            onset: 0.0,
                        });
                        self.actions.push(action);
                        self.scopes.push(deviation.scope.clone());
                        self.actions.len() - 1
                    }
                    None => {
                        let (id, words) = (deviation.effect.word(), deviation.scope.words());
                        self.frame
                            .notes
                            .push(format!("[[deviation]] {id} {words} is not predicted in blocks of a log"));
                        continue;
                    }
                },
            };
            self.frame.words.effects.push((index, deviation.size));
        }
        // Constants of tools are in the processes behind the lives of edges already, those of breakdowns in the stations.
        let of_breakdowns = |own: &Calibration| {
            matches!(own.parameter.as_str(), "time_between_failures" | "time_to_repair") && own.scope.is_everywhere()
        };
        stated.calibrations.retain(|own| own.constant().is_none() && !of_breakdowns(own));
        Words::settle(&mut self.frame, stated);
    }

    /// What a deviation with a scope does to the blocks; `None` where blocks do not tell.
    fn scoped(&self, visits: &Visits, effect: ShopEffect, scope: &Scope) -> Option<Action> {
        let weight = |block: &super::block::Block| {
            let mut occasion = Occasion::at(block.time);
            occasion.set("machine", visits.machines[block.machine].clone());
            occasion.set("shift", block.shift.clone());
            if let Some((part, operation)) = block.program.and_then(|program| visits.programs[program].split_once('/'))
            {
                occasion.set("part", part.to_owned());
                occasion.set("operation", operation.to_owned());
            }
            f64::from(u8::from(scope.holds(&occasion)))
        };
        let weights: Vec<f64> = self.blocks.list.iter().map(weight).collect();
        match effect {
            ShopEffect::FeedOverride => Some(Action::Slower(weights)),
            ShopEffect::OperatorDelay => Some(Action::Delay(weights)),
            ShopEffect::ToolChangeDelay => Some(Action::Change(weights)),
            ShopEffect::MicroStops => Some(Action::Stops(weights)),
            ShopEffect::FeedHold | ShopEffect::ToolChangePolicy | ShopEffect::BreakdownShape => None,
        }
    }

    /// How a scenario says a candidate.
    pub(super) fn written_effect(&self, candidate: usize) -> WrittenEffect {
        let recorded = match &self.actions[candidate] {
            Action::Overridden(mean) | Action::Hold(mean) => Some(*mean),
            Action::Slower(_)
            | Action::Delay(_)
            | Action::Change(_)
            | Action::Stops(_)
            | Action::Booked
            | Action::Acceleration(_)
            | Action::Policy
            | Action::Breakdowns => None,
        };
        WrittenEffect { scope: self.scopes[candidate].clone(), recorded, ..WrittenEffect::default() }
    }
}
