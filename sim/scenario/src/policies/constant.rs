//! One constant speed.

use super::tool_change::wear_after;
use super::{Believed, Conditions};
use crate::SpeedChoice;
use toolroom_wear::{Objective, Pair, Scatter};

/// What an edge change costs on a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ChangeCost {
    /// Time, the share of refilling the magazine included, s.
    pub time: f64,
    /// Price of an edge, currency.
    pub edge: f64,
    /// Price of the machine, currency per second.
    pub machine: f64,
}

impl ChangeCost {
    /// Objective of least cost; without a machine price only edges cost.
    fn cost(&self) -> Objective {
        if self.machine > 0.0 {
            Objective::Cost { change_time: self.time, edge_cost: self.edge, machine_cost: self.machine }
        } else {
            Objective::Path
        }
    }

    /// Time that a change is worth: its own and that which the price of the edge would buy, s.
    pub fn worth(&self) -> f64 {
        self.cost().change_time().unwrap_or(self.time)
    }
}

/// What edges do that are not nominal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edges<'a> {
    /// Flank wear at which they are changed, m.
    pub limit: f64,
    /// How they scatter.
    pub scatter: &'a Scatter,
}

/// The speed of a choice, worked out on the believed model, m/s; one that an edge survives which
/// reaches the limit of its change in the middle of a pass. The best speeds count lives to that limit, and
/// as many per change as edges last on average over their scatter. Without a model (milling) only a given
/// speed can be had.
pub(super) fn speed(
    choice: SpeedChoice,
    believed: Option<&Believed>,
    cost: &ChangeCost,
    edges: Edges<'_>,
) -> Option<f64> {
    let objective = match choice {
        SpeedChoice::Given(speed) => return Some(speed),
        SpeedChoice::Makarov(flank_wear) => {
            let believed = believed?;
            return Some(believed.pair.limits.clip(believed.pair.minimum_wear_speed(&believed.cut, flank_wear)));
        }
        SpeedChoice::BestPath => Objective::Path,
        SpeedChoice::BestLife => Objective::Life,
        SpeedChoice::BestRate => Objective::Rate { change_time: cost.time },
        SpeedChoice::BestCost => cost.cost(),
    };
    let believed = believed?;
    let mut pair = Pair::clone(&believed.pair);
    let limit = edges.limit;
    pair.limits.wear_limit = limit;
    pair.limits.highest_speed = believed
        .safe_speed(|speed| wear_after(believed, limit, 1.0, 0.5 * believed.path, &Conditions::constant(speed)));
    let best = |objective| pair.best_constant_speed(&believed.cut, objective).cutting_speed;
    let nominal = best(objective);
    let Some(change_time) = objective.change_time() else { return Some(nominal) };
    // Edges that last m times as long on average spread the time of a change over m lives: by renewal, path
    // per time is L/(T + change_time/m). The ratio hardly depends on speed.
    let cut = believed.cut.at_speed(nominal);
    let longer = edges.scatter.life_moments(&pair, &cut).mean / pair.life(&cut).cutting_time;
    Some(best(Objective::Rate { change_time: change_time / longer }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use toolroom_wear::{ExtendedTaylor, WearLaw};

    #[test]
    fn the_best_speed_of_taylors_law_is_the_textbook_one_and_knows_scatter_and_limit() {
        // T = 60 min (222 m/min / v)^5, an edge change of 1 min and 2.5 EUR at 60 EUR/h: T = 4·3.5 min.
        let mut pair = Pair::named("c45_t15k6").unwrap();
        pair.law = WearLaw::ExtendedTaylor(ExtendedTaylor::default());
        pair.limits.wear_limit = 0.3e-3;
        pair.temperature.collapse_temperature = 5000.0;
        let cut = toolroom_wear::Cut::nominal(3.0, 0.3e-3, 1.5e-3);
        let cost = ChangeCost { time: 60.0, edge: 2.5, machine: 60.0 / 3600.0 };
        let best = |limit: f64, common_wear: f64| {
            let believed = Believed { pair: Arc::new(pair.clone()), cut, path: 10.0, allowance: 0.0 };
            let scatter = Scatter { common_wear, ..Scatter::none() };
            60.0 * speed(SpeedChoice::BestCost, Some(&believed), &cost, Edges { limit, scatter: &scatter }).unwrap()
        };
        assert!((best(0.3e-3, 0.0) - 297.0008).abs() < 1e-3, "{}", best(0.3e-3, 0.0));
        assert!((best(0.3e-3, 0.28) - 299.3384).abs() < 1e-3, "{}", best(0.3e-3, 0.28));
        // An edge that is changed earlier is run slower.
        assert!(best(0.2e-3, 0.0) < 290.0, "{}", best(0.2e-3, 0.0));
    }
}
