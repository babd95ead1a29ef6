//! The search for the best settings of one policy, with every rule of tool change that it may have.

use super::axis::{Axis, Reference};
use super::field::Field;
use super::trial::Search;
use super::{TuneError, TunedPolicy, given};
use toolroom_scenario::PolicyRule;

/// Rules of tool change that get what is left of the budget: the best one half of it, the next one the rest.
const LEFT: [u32; 2] = [2, 1];

impl Search<'_> {
    /// Equal shares of the budget of a policy: one where it keeps its rule of tool change, else one for each rule that it may
    /// have and one for the better ones.
    pub fn shares(rule: &PolicyRule) -> u32 {
        // A rule by time in cut may fall away where no life is known; the budget is reckoned with it all the same.
        let rules = rule.change_rules(Some(1.0)).len() as u32;
        if rules == 1 { 1 } else { rules + 1 }
    }

    /// The best settings of policy number `policy`.
    pub fn policy(&self, policy: usize) -> Result<TunedPolicy, TuneError> {
        let rule = self.scenario.policies[policy].clone();
        let Some(reference) = Reference::of(self.scenario) else {
            return Ok(given(&rule.name, "no turning operation follows a commanded speed".to_owned()));
        };
        let budget = self.request.budget / Self::shares(&rule);
        let field = |tool_change| {
            let rule = PolicyRule { tool_change, ..rule.clone() };
            let axes = Axis::all(&rule, reference);
            Field::new(self, rule, axes, budget)
        };
        let mut fields: Vec<Field<'_>> = rule.change_rules(reference.life).into_iter().map(field).collect();
        if let [only] = fields.as_mut_slice() {
            only.budget = self.request.budget;
            only.tune()?;
            return Ok(only.told());
        }
        for field in &mut fields {
            field.tune()?;
        }
        let left =
            |fields: &[Field<'_>]| self.request.budget - fields.iter().map(|field| field.runs_spent).sum::<u32>();
        let ranked = |fields: &mut [Field<'_>]| fields.sort_by(|a, b| a.least().total_cmp(&b.least()));
        // The better rules get what is left, the best of them the most.
        ranked(&mut fields);
        for (place, share) in LEFT.into_iter().enumerate() {
            let more = if place + 1 < LEFT.len() { left(&fields) / share } else { left(&fields) };
            fields[place].go_on(more)?;
        }
        ranked(&mut fields);
        let evaluations = fields.iter().map(|field| field.runs_spent).sum();
        let tool_changes = fields.iter().map(Field::tried).collect();
        Ok(TunedPolicy { evaluations, tool_changes, ..fields[0].told() })
    }
}
