//! What a study says: each policy with intervals, each difference to the baseline, what a faster
//! cell is worth to the shop, and a decision.
//!
//! # Cell gain and shop gain
//! The cell is the lathes, the machines whose speed the policy sets.
//!
//! - **cell gain** = cell time per programmed cutting minute of good operations under the baseline
//!   over the same under the policy, cell time being cutting and tool change. It is the ratio of
//!   the parts that the cell alone would make: no waiting, no handling, no other machine.
//! - **shop gain** = ratio of parts per shift.
//! - **Amdahl limit**, of capacity alone: a station (machines that can do the same operations) whose share `f` of
//!   occupied time is cell time would be occupied `(1 − f) + f / cell_gain` of it. The shop speeds
//!   up at most until the most occupied station is as loaded as it can be (fully; in a shop with
//!   constant work in process as loaded as the bottleneck was before) and never beyond the parts
//!   that are offered. Fewer scrapped parts or less waiting can carry the shop beyond it, which is then said.
//!
//! # Source
//! G. M. Amdahl, AFIPS Conference Proceedings 30 (1967) 483, applied to stations in series.

mod break_even;
mod decision;
mod drawn;
mod station;

pub(crate) use break_even::SWING;
pub use break_even::{BreakEven, Crossing};
pub use decision::{Decision, Outcome, Role, role};
pub use drawn::DrawnDifference;
pub use station::{Station, stations};

use crate::study::Study;
use toolroom_scenario::Scenario;
use toolroom_statistics::{CONFIDENCE, Interval, Paired, paired, ratio, t_interval};

/// One policy.
#[derive(Clone, Debug)]
pub struct PolicyResult {
    /// Index into the scenario.
    pub policy: usize,
    /// Name.
    pub name: String,
    /// Part it plays in the decision.
    pub role: Role,
    /// Interval of each figure of [`Study::kpis`], SI.
    pub kpis: Vec<Interval>,
}

/// One policy against the baseline.
#[derive(Clone, Debug)]
pub struct Difference {
    /// Position in [`Comparison::policies`].
    pub policy: usize,
    /// Paired difference of each figure of [`Study::kpis`], SI.
    pub kpis: Vec<Paired>,
    /// Ratio of the parts that the cell alone would make.
    pub cell_gain: Interval,
    /// Ratio of parts per shift.
    pub shop_gain: Interval,
    /// The shop gain that Amdahl's law allows at this cell gain by capacity alone.
    pub amdahl_limit: f64,
    /// What carries the shop beyond that limit, where something does.
    pub beyond: Option<&'static str>,
    /// Prices at which the policy costs as much as the baseline.
    pub break_even: Vec<BreakEven>,
}

/// The result of a comparison.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Every policy; the first one is the baseline.
    pub policies: Vec<PolicyResult>,
    /// Every policy but the baseline.
    pub differences: Vec<Difference>,
    /// Stations under the baseline.
    pub stations: Vec<Station>,
    /// Index of the most occupied station; `None` if nothing ran.
    pub bottleneck: Option<usize>,
    /// Position in `differences` of the headline: the adaptive policy of least cost, otherwise the
    /// first difference.
    pub headline: Option<usize>,
    /// Whether adaptive speed pays, and against what.
    pub decision: Decision,
    /// Prices at which the two policies of the decision cost the same.
    pub break_even: Vec<BreakEven>,
}

impl Comparison {
    /// Compares the policies of a study.
    pub fn new(scenario: &Scenario, study: &Study) -> Self {
        let policies: Vec<PolicyResult> = study
            .policies
            .iter()
            .enumerate()
            .map(|(position, &policy)| PolicyResult {
                policy,
                name: scenario.policies[policy].name.clone(),
                role: role(&scenario.policies[policy], scenario),
                kpis: (0..study.kpis.len()).map(|kpi| t_interval(&study.samples(position, kpi), CONFIDENCE)).collect(),
            })
            .collect();
        let stations = stations(scenario, study);
        let bottleneck = station::bottleneck(&stations);
        let differences: Vec<Difference> =
            (1..policies.len()).map(|policy| difference(scenario, study, &stations, policy)).collect();
        let mut decision = Decision::new(scenario, study, &policies);
        decision.notes.extend(drawn::notes(scenario, study, &decision));
        let adaptive = decision.adaptive.and_then(|policy| policy.checked_sub(1));
        let headline = adaptive.or((!differences.is_empty()).then_some(0));
        let break_even = match (decision.adaptive, decision.rival, &decision.difference) {
            (Some(adaptive), Some(rival), Some(_)) => BreakEven::all(scenario, study, adaptive, rival),
            (Some(_) | None, _, _) => Vec::new(),
        };
        Self { policies, differences, stations, bottleneck, headline, decision, break_even }
    }

    /// Prices at which the decision turns; none where it is not resolved at the present ones.
    pub fn turning_prices(&self) -> &[BreakEven] {
        match self.decision.outcome {
            Outcome::Wins | Outcome::Loses => &self.break_even,
            Outcome::NoDifference | Outcome::Undecided => &[],
        }
    }

    /// The most occupied station under the baseline.
    pub fn bottleneck(&self) -> Option<&Station> {
        self.bottleneck.map(|index| &self.stations[index])
    }
}

fn difference(scenario: &Scenario, study: &Study, stations: &[Station], policy: usize) -> Difference {
    let values_of = |policy: usize, id: &str| study.index(id).map_or_else(Vec::new, |kpi| study.samples(policy, kpi));
    let gain = |id: &str, above: usize, below: usize| ratio(&values_of(above, id), &values_of(below, id), CONFIDENCE);
    let cell_gain = gain("cell_time_ratio", 0, policy);
    let offered = gain("parts_offered_per_shift", 0, 0).count > 0;
    let offered_over_made = if offered {
        let mean = |id| t_interval(&values_of(0, id), CONFIDENCE).mean;
        mean("parts_offered_per_shift") / mean("parts_per_shift")
    } else {
        f64::INFINITY
    };
    let shop_gain = gain("parts_per_shift", policy, 0);
    let amdahl_limit = station::amdahl_limit(scenario, stations, cell_gain.mean, offered_over_made);
    let good_share = |policy: usize| 1.0 - t_interval(&values_of(policy, "scrap_rate"), CONFIDENCE).mean;
    Difference {
        policy,
        kpis: (0..study.kpis.len())
            .map(|kpi| paired(&study.samples(policy, kpi), &study.samples(0, kpi), CONFIDENCE))
            .collect(),
        beyond: beyond(shop_gain.mean / amdahl_limit, good_share(policy) / good_share(0)),
        shop_gain,
        amdahl_limit,
        cell_gain,
        break_even: BreakEven::all(scenario, study, policy, 0),
    }
}

/// Excess of the shop gain over the limit that is reported: half of the last digit shown.
const TOLD: f64 = 0.005;

/// What carries a shop gain beyond the limit of capacity by the factor `excess`, of which fewer scrapped parts explain `good`.
fn beyond(excess: f64, good: f64) -> Option<&'static str> {
    let reason = if good - 1.0 >= 0.5 * (excess - 1.0) { "fewer scrapped parts" } else { "less waiting" };
    (excess > 1.0 + TOLD).then_some(reason)
}

#[cfg(test)]
mod tests;
