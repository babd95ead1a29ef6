//! Runs made elsewhere, for studies in shards.

use super::{EdgeLife, NamedLife, Run, StudyError, lives, resolve, stopped};
use crate::kpi;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;
use toolroom_scenario::Scenario;
use toolroom_shop::{RunLog, Shop};

/// One run without its log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StoredRun {
    /// Policy by index into the scenario.
    pub policy: usize,
    /// Replication, from 0.
    pub replication: u32,
    /// Digest of the run.
    pub digest: u64,
    /// Key figures as bits: what is not defined is no JSON number.
    values: Vec<u64>,
    /// Edges of the lathes.
    lives: Vec<NamedLife>,
}

/// Runs by replication and policy.
pub type KnownRuns = BTreeMap<(u32, usize), StoredRun>;

/// Runs replications `from..to` of some policies.
///
/// # Errors
/// As [`run_study`](super::run_study).
pub fn stored_runs(scenario: &Scenario, policies: &[usize], from: u32, to: u32) -> Result<Vec<StoredRun>, StudyError> {
    let resolved = resolve(scenario, policies)?;
    let lathes = kpi::cell(scenario);
    let tasks: Vec<(u32, usize)> =
        (from..to).flat_map(|replication| policies.iter().map(move |policy| (replication, *policy))).collect();
    let runs = tasks.into_par_iter().map(|(replication, policy)| {
        let shop = Shop::with_recorder(scenario, Arc::clone(&resolved[&policy]), replication, RunLog::default());
        let log = shop.and_then(Shop::run).map_err(|source| stopped(scenario, policy, replication, source))?;
        Ok(StoredRun {
            policy,
            replication,
            digest: log.digest,
            values: kpi::evaluate(scenario, &log).into_iter().map(f64::to_bits).collect(),
            lives: lives(&log, &lathes).iter().map(EdgeLife::named).collect(),
        })
    });
    runs.collect::<Vec<_>>().into_iter().collect()
}

impl StoredRun {
    /// The run as if it had been made here.
    pub(super) fn run(&self) -> Run {
        Run {
            values: self.values.iter().map(|bits| f64::from_bits(*bits)).collect(),
            digest: self.digest,
            lives: self.lives.iter().filter_map(EdgeLife::of_named).collect(),
            log: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{StudyOptions, run_study};
    use super::*;
    use crate::fixture;
    use std::sync::atomic::AtomicBool;

    #[test]
    fn runs_made_elsewhere_are_the_same_study() {
        let scenario = fixture::scenario();
        let options = StudyOptions { replications: 6, ..StudyOptions::of(&scenario) };
        let study = |options: &StudyOptions| {
            run_study(&scenario, options, None, &|_| {}, &AtomicBool::new(false)).expect("a study")
        };
        let here = study(&options);
        let policies = options.policies.clone();
        let mut known = KnownRuns::new();
        for (from, to) in [(3, 6), (0, 3)] {
            let runs = stored_runs(&scenario, &policies, from, to).expect("runs");
            let text = serde_json::to_string(&runs).unwrap();
            let runs: Vec<StoredRun> = serde_json::from_str(&text).unwrap();
            known.extend(runs.into_iter().map(|run| ((run.replication, run.policy), run)));
        }
        let there = study(&StudyOptions { known: Arc::new(known), ..options });
        assert_eq!((there.digest, &there.edge_lives), (here.digest, &here.edge_lives));
        let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        for policy in 0..policies.len() {
            for replication in 0..6 {
                assert_eq!(bits(there.replication(policy, replication)), bits(here.replication(policy, replication)));
            }
        }
    }
}
