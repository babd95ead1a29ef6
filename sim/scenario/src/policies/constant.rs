//! One constant speed.

use super::tool_change::wear_after;
use super::{Believed, Conditions};
use crate::SpeedChoice;
use toolroom_wear::{Objective, Pair};

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

/// The speed of a choice, worked out on the believed model, m/s; one that an edge survives which
/// reaches its wear limit in the middle of a pass. Without a model (milling) only a given speed can be had.
pub(super) fn speed(choice: SpeedChoice, believed: Option<&Believed>, cost: &ChangeCost) -> Option<f64> {
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
    let limit = pair.limits.wear_limit;
    pair.limits.highest_speed = believed
        .safe_speed(|speed| wear_after(believed, limit, 1.0, 0.5 * believed.path, &Conditions::constant(speed)));
    Some(pair.best_constant_speed(&believed.cut, objective).cutting_speed)
}
