//! What may be missing from a shop, as candidates over the blocks of its log.

use super::super::constants::{BROKEN, FASTEST, OVERRIDDEN, SAVED};
use super::super::{Candidate, EffectId, search};
use super::action::Action;
use super::block::Block;
use super::figure::Figure;
use super::model::ShopModel;
use super::nominal::Shop;
use super::scopes::parts;
use super::visit::{Visit, Visits};
use toolroom_scenario::Scope;
use toolroom_scenario::effects::SHOP_EFFECTS;

/// How far beyond the land at which the file changes them edges may be used, m: until they count as broken. That of the
/// machine whose edges are changed first; no bound where the file wears out none.
fn later(shop: &Shop) -> f64 {
    let lands = shop.stations.iter().filter_map(|station| Some(station.edge_life?.land));
    lands.map(|land| (BROKEN - land).max(0.0)).reduce(f64::max).unwrap_or(f64::INFINITY)
}

impl ShopModel {
    /// Every effect that the log can show, with the parts of it on which one may act alone.
    pub(super) fn catalogue(&mut self, shop: &Shop, visits: &Visits) {
        let blocks = &self.blocks.list;
        let has = |figure: Figure| self.place(figure).len() == 1;
        let scopes = parts(shop, visits, blocks);
        let mut list: Vec<(EffectId, Scope, f64, Action)> = Vec::new();
        if has(Figure::CuttingTime) {
            let everywhere = vec![1.0; blocks.len()];
            list.push((EffectId::FEED_OVERRIDE, Scope::default(), OVERRIDDEN, Action::Slower(everywhere)));
            for (scope, on) in &scopes {
                list.push((EffectId::FEED_OVERRIDE, scope.clone(), OVERRIDDEN, Action::Slower(on.clone())));
            }
            if visits.overridden {
                let full = |visit: &Visit| visit.cutting / (1.0 + visit.override_excess);
                let time: f64 = visits.list.iter().map(full).sum();
                let lost: f64 = visits.list.iter().map(|visit| visit.cutting - full(visit)).sum();
                if lost > 0.0 {
                    list.push((EffectId::FEED_OVERRIDE, Scope::default(), 1.0, Action::Overridden(lost / time)));
                }
            }
            let speeds: Vec<f64> = visits
                .programs
                .iter()
                .map(|name| shop.programs.get(name).map_or(0.0, |program| program.feed_speeds))
                .collect();
            let of_block = |block: &Block| block.program.map_or(0.0, |program| speeds[program]);
            list.push((
                EffectId::AXIS_ACCELERATION,
                Scope::default(),
                1.0,
                Action::Acceleration(blocks.iter().map(of_block).collect()),
            ));
        }
        if has(Figure::CuttingTail) {
            list.push((EffectId::MICRO_STOPS, Scope::default(), 1.0 / 3600.0, Action::Stops(vec![1.0; blocks.len()])));
            for (scope, on) in &scopes {
                list.push((EffectId::MICRO_STOPS, scope.clone(), 1.0 / 3600.0, Action::Stops(on.clone())));
            }
        }
        if has(Figure::StopCount) {
            list.push((EffectId::MICRO_STOPS, Scope::default(), 1.0 / 3600.0, Action::Booked));
        }
        if has(Figure::HandlingTime) {
            list.push((EffectId::OPERATOR_DELAY, Scope::default(), 20.0, Action::Delay(vec![1.0; blocks.len()])));
            for (scope, on) in &scopes {
                list.push((EffectId::OPERATOR_DELAY, scope.clone(), 20.0, Action::Delay(on.clone())));
            }
        }
        if has(Figure::ToolChangeTime) {
            list.push((EffectId::TOOL_CHANGE_DELAY, Scope::default(), 20.0, Action::Change(vec![1.0; blocks.len()])));
            // A change belongs to no program.
            for (scope, on) in scopes.iter().filter(|(scope, _)| scope.names.iter().all(|(key, _)| *key != "part")) {
                list.push((EffectId::TOOL_CHANGE_DELAY, scope.clone(), 20.0, Action::Change(on.clone())));
            }
        }
        if has(Figure::FeedHoldTime) {
            let holds: usize = visits.list.iter().map(|visit| visit.holds.len()).sum();
            let share = holds as f64 / visits.list.len().max(1) as f64;
            list.push((EffectId::FEED_HOLD, Scope::default(), 10.0, Action::Hold(share)));
        }
        if has(Figure::EdgeLife) {
            list.push((EffectId::TOOL_CHANGE_POLICY, Scope::default(), 0.1e-3, Action::Policy));
        }
        if has(Figure::FailureInterval) {
            list.push((EffectId::BREAKDOWN_SHAPE, Scope::default(), 2.0, Action::Breakdowns));
        }
        // What is added may be saved as well, as far as there is something to be saved.
        let shortest = |figure: Figure| {
            let nominal = self.nominal.iter().map(|of_block| of_block[figure]).filter(|time| time.is_finite());
            nominal.reduce(f64::min).unwrap_or(0.0)
        };
        for (id, scope, typical, action) in list {
            let greatest = id.entry().size.max;
            let greatest = if matches!(action, Action::Policy) { greatest.min(later(shop)) } else { greatest };
            let least = match action {
                Action::Slower(_) => FASTEST,
                Action::Delay(_) => -SAVED * shortest(Figure::HandlingTime),
                Action::Change(_) => -SAVED * shortest(Figure::ToolChangeTime),
                Action::Overridden(_)
                | Action::Acceleration(_)
                | Action::Stops(_)
                | Action::Booked
                | Action::Hold(_)
                | Action::Policy
                | Action::Breakdowns => 0.0,
            };
            let shape = action.shape(&scope);
            self.frame.candidates.push(Candidate { id, shape, typical, greatest, least, onset: 0.0 });
            self.actions.push(action);
            self.scopes.push(scope);
        }
        self.frame.untried = search::missing(SHOP_EFFECTS, &self.frame.candidates);
    }
}
