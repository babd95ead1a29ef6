//! The mean lead time of one long run.

use crate::LeadTimes;
use serde_json::{Value, json};
use toolroom_scenario::Scenario;
use toolroom_statistics::{BATCHES, BatchMeans, CONFIDENCE, batch_means};

/// The mean lead time of one run, and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneRun(BatchMeans);

impl OneRun {
    /// A recorder for one long run: jobs one by one, as long as there are few. `None` for a shop that ends by itself:
    /// its run is one value, and what happens in it is not what happens in the long run.
    pub fn recorder(scenario: &Scenario) -> Option<LeadTimes> {
        (!scenario.is_terminating()).then(|| LeadTimes::from_scenario(scenario, 1))
    }

    /// What was recorded; `None` where fewer jobs than [`BATCHES`] left the shop.
    pub fn from_lead_times(recorded: &LeadTimes) -> Option<Self> {
        batch_means(recorded.times(), CONFIDENCE).map(Self)
    }

    /// The numbers, s.
    pub fn means(&self) -> &BatchMeans {
        &self.0
    }

    /// In words, with the policy where there are several.
    pub fn text(&self, policy: Option<&str>) -> String {
        let BatchMeans { interval, size, correlation } = &self.0;
        let of = policy.map_or_else(String::new, |policy| format!(" under {policy}"));
        let mut text = format!(
            "one long run{of}: lead time {:.4} ± {:.4} min (95 %), {BATCHES} batches of {size} jobs, lag-1 correlation {:.2}\n",
            interval.mean / 60.0,
            interval.half_width / 60.0,
            correlation
        );
        if self.0.correlated() {
            text.push_str(
                "warning: run longer: the batches depend on each other, and the interval is not to be trusted\n",
            );
        }
        text
    }

    /// For programs.
    pub fn json(&self, policy: &str) -> Value {
        let BatchMeans { interval, size, correlation } = &self.0;
        json!({
            "policy": policy,
            "figure": "lead_time",
            "mean [min]": interval.mean / 60.0,
            "half_width [min]": interval.half_width / 60.0,
            "batches": BATCHES,
            "jobs_per_batch": size,
            "lag1": correlation,
            "correlated": self.0.correlated(),
        })
    }
}
