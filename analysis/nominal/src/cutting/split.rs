//! Effects, and a rate of wear of its own, on parts of the records.

use super::{Action, Cutting, Nominal};
use crate::parts::{MOST, MOST_RATES, Part, parts, wear_rate};
use crate::stated::Declarations;
use crate::{Candidate, ChannelId, EffectId};
use toolroom_effects::{Effect, Search, UserEffect};
use toolroom_records::Records;

impl<P: Nominal> Cutting<P> {
    /// Adds the effects that are to be split, on every part of the records that two groups at least lie in.
    pub(super) fn split(&mut self, records: &Records, stated: &Declarations) {
        if !stated.is_split() {
            return;
        }
        let effects = self.frame.candidates.clone();
        let parts = parts(records, &self.frame.measured.group_of_row);
        self.rate(&parts, stated);
        let most = self.actions.iter().filter(|own| matches!(own, Action::Scoped(..))).count() + MOST;
        for (index, part) in stated.tried(&effects, &parts) {
            // What adds to a recorded time needs no rows of its own in the simulation.
            let full = self.actions.iter().filter(|own| matches!(own, Action::Scoped(..))).count() >= most;
            if full && matches!(self.actions[index], Action::Effect(_)) {
                continue;
            }
            if let Some(action) = self.on(index, part) {
                let base = effects[index].clone();
                self.frame.candidates.push(Candidate { shape: part.words(&base.shape), ..base });
                self.actions.push(action);
            }
        }
    }

    /// Adds a rate of wear that is another one on a part of the records, where wear is measured: first of all, since an effect
    /// on a part may only stand for that.
    fn rate(&mut self, parts: &[Part], stated: &Declarations) {
        let read = self.frame.measured.channels.iter().any(|channel| channel.id == ChannelId::FlankWear);
        let Some(definition) = wear_rate(&stated.defined).filter(|_| read) else { return };
        let entry = definition.entry();
        let Some(Search::Size(typical)) = entry.search(P::NAME) else { return };
        if !self.frame.defined.contains(&definition) {
            self.frame.defined.push(definition);
        }
        let effect = Effect::User(UserEffect::new(definition));
        // Dates first: the others are many where columns have many levels.
        let (dates, others): (Vec<&Part>, Vec<&Part>) = parts.iter().partition(|part| part.scope.from.is_some());
        for part in dates.into_iter().chain(others).take(MOST_RATES) {
            let shape = part.words("");
            let (greatest, least) = (entry.size.max, entry.size.min);
            self.frame.candidates.push(Candidate {
                id: EffectId::from(definition),
                shape,
                typical,
                greatest,
                least,
                onset: 0.0,
            });
            self.actions.push(Action::Scoped(effect, part.scope.clone(), part.rows.clone()));
        }
    }

    /// What a candidate does on a part of the records; nothing where it acts on a part already.
    fn on(&self, candidate: usize, part: &Part) -> Option<Action> {
        match &self.actions[candidate] {
            Action::Effect(effect) => Some(Action::Scoped(*effect, part.scope.clone(), part.rows.clone())),
            Action::Reading { channels, column, scope, recorded } if scope.is_everywhere() => {
                let column: Vec<f64> = column.iter().zip(&part.rows).map(|(value, on)| value * on).collect();
                // What is recorded is the mean over the rows of the part.
                let within = |of: &[f64]| of.iter().zip(&part.rows).map(|(value, on)| value * on).sum::<f64>();
                let rows: f64 = part.rows.iter().sum();
                let overridden = self.frame.candidates[candidate].id == EffectId::FEED_OVERRIDE;
                let whole = if overridden { within(&self.durations) } else { rows };
                let recorded = recorded.map(|_| within(&column) / whole);
                Some(Action::Reading { channels: channels.clone(), column, scope: part.scope.clone(), recorded })
            }
            Action::Reading { .. } | Action::Scoped(..) | Action::Lot(..) => None,
        }
    }
}
