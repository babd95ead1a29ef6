//! One constant speed.

use super::tool_change::wear_after;
use super::{BelievedModel, Conditions};
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

/// What an edge that is lost in cut spoils.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Spoilage {
    /// Share of lost edges that spoil the part.
    pub risk: f64,
    /// Price of a blank, currency.
    pub blank: f64,
    /// Cutting path of a part with this tool, m.
    pub path: f64,
}

/// What edges do that are not nominal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edges<'a> {
    /// Flank wear at which they are changed, m.
    pub limit: f64,
    /// How they scatter.
    pub scatter: &'a Scatter,
    /// What is spoiled by those that are lost.
    pub spoilage: Spoilage,
}

/// The speed of a choice, worked out on the believed model, m/s.
///
/// The best speeds count lives to the limit at which edges are changed, over their scatter; of `best_rate` and `best_cost` also
/// the parts that lost edges spoil. Speeds at which a nominal edge collapses before it is changed are left out. Without a model
/// (milling) only a given speed can be had.
pub(super) fn speed(
    choice: SpeedChoice,
    believed: Option<&BelievedModel>,
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
    pair.limits.wear_limit = edges.limit;
    let worn = |speed: f64| {
        wear_after(believed, &believed.cut, edges.limit, 1.0, 0.5 * believed.path, &Conditions::constant(speed))
    };
    pair.limits.highest_speed = believed.safe_speed(worn);
    let best = |objective| pair.best_constant_speed(&believed.cut, objective).cutting_speed;
    let nominal = best(objective);
    let Some(change_time) = objective.change_time() else { return Some(nominal) };
    // Edges that last m times as long on average spread the time of a change over m lives: by renewal, path per time is
    // L/(T + change_time/m). The ratio hardly depends on speed.
    let cut = believed.cut.at_speed(nominal);
    let longer = edges.scatter.life_moments(&pair, &cut).mean / pair.life(&cut).cutting_time;
    let of_lives = best(Objective::Rate { change_time: change_time / longer });
    let price =
        if choice == SpeedChoice::BestCost && cost.machine > 0.0 { edges.spoilage.blank / cost.machine } else { 0.0 };
    let fleet = Fleet { believed, pair: &pair, edges, longer, change_time, blank_time: price };
    Some(fleet.best(of_lives))
}

/// Values of a standard normal number that stand for a sixth of its distribution each: its means over sixths.
const SIXTHS: [f64; 6] = [-1.4991, -0.6825, -0.2121, 0.2121, 0.6825, 1.4991];
/// Speeds of the search for the best, evenly on the scale of ratios (assumption: steps of about 1 % where they matter).
const SPEEDS: usize = 96;

/// Many edges at one speed.
struct Fleet<'a> {
    believed: &'a BelievedModel,
    /// With the limit at which edges are changed.
    pair: &'a Pair,
    edges: Edges<'a>,
    /// Mean life over the nominal one.
    longer: f64,
    /// Time that an edge is worth, its change included, s.
    change_time: f64,
    /// Time that a blank is worth, s.
    blank_time: f64,
}

impl Fleet<'_> {
    /// The speed of the most good path per time, m/s; `of_lives` is the best one where no part is spoiled.
    fn best(&self, of_lives: f64) -> f64 {
        if self.edges.spoilage.risk == 0.0 || self.lost(of_lives) == 0.0 {
            return of_lives;
        }
        let low = self.pair.limits.lowest_speed.max(0.3 * of_lives);
        let speed = |place: f64| low * (of_lives / low).powf(place / (SPEEDS - 1) as f64);
        let rates: Vec<f64> = (0..SPEEDS).map(|i| self.rate(speed(i as f64))).collect();
        let most = (0..SPEEDS).max_by(|&a, &b| rates[a].total_cmp(&rates[b])).unwrap_or(SPEEDS - 1);
        // The vertex of the parabola through the best and its neighbours.
        let (Some(below), Some(above)) = (most.checked_sub(1).map(|i| rates[i]), rates.get(most + 1)) else {
            return speed(most as f64);
        };
        let bend = below - 2.0 * rates[most] + above;
        let shift = if bend < 0.0 { (0.5 * (below - above) / bend).clamp(-0.5, 0.5) } else { 0.0 };
        speed(most as f64 + shift)
    }

    /// Good path per time, m/s.
    fn rate(&self, speed: f64) -> f64 {
        let life = self.pair.life(&self.believed.cut.at_speed(speed));
        let spoiled = self.edges.spoilage.risk * self.lost(speed);
        let path = self.longer * life.path - spoiled * self.edges.spoilage.path;
        let time = self.longer * life.cutting_time + self.change_time + spoiled * self.blank_time;
        path / time
    }

    /// Share of edges that are lost before they are changed: collapsed in the pass in which they pass the limit, or chipped.
    ///
    /// Edges wear faster and slower by their scatter and pass the limit anywhere in a pass. They collapse where the hardness of
    /// the work, which acts on the temperature rise by its square root, and the stresses of the land, which act on its part of
    /// the rise, let them. Wear grows evenly along the path towards the hazard of chipping. Approximations that only choose a
    /// speed.
    fn lost(&self, speed: f64) -> f64 {
        let Self { believed, pair, edges, .. } = self;
        let scatter = edges.scatter;
        let contact = pair.contact(&believed.cut.at_speed(speed));
        let (ambient, collapse) = (pair.temperature.ambient_temperature, pair.temperature.collapse_temperature);
        let hardness = 0.5 * scatter.batch_hardness.hypot(scatter.piece_hardness);
        let spread = scatter.common_wear.hypot(scatter.mechanical_wear.max(scatter.thermal_wear) / 2.0_f64.sqrt());
        let life = pair.life(&believed.cut.at_speed(speed));
        let sharp = contact.steady_temperature(0.0) - ambient;
        let chipping = &pair.chipping;
        let aged = 1.0 + (edges.limit / chipping.reference_land).powi(2) * chipping.shape / (chipping.shape + 2.0);
        let shares = SIXTHS.map(|z| {
            let factor = (spread * z).exp();
            let collapsed = (0..SIXTHS.len()).map(|i| {
                let path = (i as f64 + 0.5) / SIXTHS.len() as f64 * believed.path;
                let command = Conditions::constant(speed);
                let worn = wear_after(believed, &believed.cut, edges.limit, factor, path, &command);
                let rise = contact.steady_temperature(worn) - ambient;
                let uncertain = hardness.hypot(scatter.flank_stress * (1.0 - sharp / rise));
                let margin = (collapse - ambient) / rise - 1.0;
                let over = SIXTHS.iter().filter(|z| uncertain * **z >= margin).count();
                over as f64 / SIXTHS.len() as f64
            });
            let collapsed = collapsed.sum::<f64>() / SIXTHS.len() as f64;
            let chipped = -(-(chipping.rate * life.path / factor).powf(chipping.shape) * aged).exp_m1();
            1.0 - (1.0 - collapsed) * (1.0 - chipped)
        });
        shares.iter().sum::<f64>() / SIXTHS.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;
    use toolroom_wear::{ExtendedTaylor, WearLaw};

    fn taylor() -> (Pair, ChangeCost) {
        // T = 60 min (222 m/min / v)^5, an edge change of 1 min and 2.5 EUR at 60 EUR/h: T = 4·3.5 min.
        let mut pair = Pair::named("c45_t15k6").unwrap();
        pair.law = WearLaw::ExtendedTaylor(ExtendedTaylor::default());
        pair.limits.wear_limit = 0.3e-3;
        pair.temperature.collapse_temperature = 5000.0;
        (pair, ChangeCost { time: 60.0, edge: 2.5, machine: 60.0 / 3600.0 })
    }

    fn best(pair: &Pair, cost: &ChangeCost, limit: f64, common_wear: f64, spoilage: Spoilage) -> f64 {
        let cut = toolroom_wear::Cut::nominal(3.0, 0.3e-3, 1.5e-3);
        let believed =
            BelievedModel { pair: Arc::new(pair.clone()), cut, path: 10.0, allowance: 0.0, edge_scatter: common_wear };
        let scatter = Scatter { common_wear, ..Scatter::none() };
        let edges = Edges { limit, scatter: &scatter, spoilage };
        60.0 * speed(SpeedChoice::BestCost, Some(&believed), cost, edges).unwrap()
    }

    #[test]
    fn the_best_speed_of_taylors_law_is_the_textbook_one_and_knows_scatter_and_limit() {
        let (pair, cost) = taylor();
        let best = |limit: f64, common_wear: f64| best(&pair, &cost, limit, common_wear, Spoilage::default());
        assert!((best(0.3e-3, 0.0) - 297.0008).abs() < 1e-3, "{}", best(0.3e-3, 0.0));
        assert!((best(0.3e-3, 0.28) - 299.3384).abs() < 1e-3, "{}", best(0.3e-3, 0.28));
        // An edge that is changed earlier is run slower.
        assert!(best(0.2e-3, 0.0) < 290.0, "{}", best(0.2e-3, 0.0));
    }

    #[test]
    fn parts_that_lost_edges_spoil_make_the_best_speed_slower() {
        let (mut pair, cost) = taylor();
        // A worn edge comes close to collapse at the best speed.
        let contact = pair.contact(&toolroom_wear::Cut::nominal(300.0 / 60.0, 0.3e-3, 1.5e-3));
        pair.temperature.collapse_temperature = 1.02 * contact.steady_temperature(0.3e-3);
        let dear = Spoilage { risk: 0.5, blank: 100.0, path: 100.0 };
        pair.chipping.rate = 1e-4;
        let (cheap, dear) =
            (best(&pair, &cost, 0.3e-3, 0.28, Spoilage::default()), best(&pair, &cost, 0.3e-3, 0.28, dear));
        assert!(dear < cheap, "{dear} against {cheap} m/min");
    }
}
