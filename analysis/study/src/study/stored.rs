//! Runs made elsewhere, for studies in shards.

use super::{EdgeLife, NamedLife, Run, StudyError, resolve, stopped};
use crate::groups::width;
use crate::kpi::Counting;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;
use toolroom_scenario::Scenario;
use toolroom_shop::{RunLog, Shop};

/// One run without its log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StoredRun {
    /// The shop as it is, 0, or its variant, from 1.
    #[serde(default, skip_serializing_if = "is_as_it_is")]
    pub shop: u32,
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

fn is_as_it_is(shop: &u32) -> bool {
    *shop == 0
}

/// Runs by shop, replication and policy.
pub type KnownRuns = BTreeMap<(u32, u32, usize), StoredRun>;

/// Runs by what they are of.
pub fn known(runs: impl IntoIterator<Item = StoredRun>) -> KnownRuns {
    runs.into_iter().map(|run| ((run.shop, run.replication, run.policy), run)).collect()
}

/// The runs that belong to a study of `policies` and `shops`, the shop as it is first: those whose figures and edges are
/// those of their shop.
pub fn known_of(shops: &[&Scenario], policies: &[usize], runs: Vec<StoredRun>) -> KnownRuns {
    let figures: Vec<usize> = shops.iter().map(|shop| width(shop)).collect();
    let fits = |run: &StoredRun| {
        policies.contains(&run.policy)
            && figures.get(run.shop as usize) == Some(&run.values.len())
            && run.lives.iter().all(|life| EdgeLife::of_named(life).is_some())
    };
    known(runs.into_iter().filter(fits))
}

/// Runs replications `start..end` of some policies; `shop` is the place of the scenario among the shop as it is, 0, and
/// its variants.
///
/// # Errors
/// As [`run_study`](super::run_study).
pub fn stored_runs(
    (shop, scenario): (u32, &Scenario),
    policies: &[usize],
    start: u32,
    end: u32,
) -> Result<Vec<StoredRun>, StudyError> {
    let resolved = resolve(scenario, policies)?;
    let tasks: Vec<(u32, usize)> =
        (start..end).flat_map(|replication| policies.iter().map(move |policy| (replication, *policy))).collect();
    let runs = tasks.into_par_iter().map(|(replication, policy)| {
        let run = || {
            let world = scenario.drawn(replication)?;
            // What a planner asks is read from a log.
            let log = (!scenario.orders.is_empty()).then(RunLog::default);
            Shop::with_recorder(&world, Arc::clone(&resolved[&policy]), replication, (Counting::new(scenario), log))?
                .run()
        };
        let (counting, log) = run().map_err(|source| stopped(scenario, policy, replication, source))?;
        Ok(StoredRun::from_policy(shop, policy, replication, &Run::of(scenario, &counting, log)))
    });
    runs.collect::<Vec<_>>().into_iter().collect()
}

/// Digest of the runs of replications `from..to` in `shops`, one shop after the other as [`stored_runs`] leaves them.
///
/// # Errors
/// What is wrong with them, in words: a run that is missing, doubled, out of order, or not of these shops.
pub fn stored_digest(
    shops: &[&Scenario],
    policies: &[usize],
    (from, to): (u64, u64),
    runs: &[StoredRun],
) -> Result<u64, String> {
    let mut found = runs.iter();
    for (shop, scenario) in (0..).zip(shops) {
        let figures = width(scenario);
        let due = (from..to).flat_map(|replication| policies.iter().map(move |policy| (replication, *policy)));
        for (replication, policy) in due {
            let of = || {
                let variant = if shop == 0 { String::new() } else { format!(" in variant {shop}") };
                format!("replication {replication} of `{}`{variant}", scenario.policies[policy].name)
            };
            let here =
                |run: &&StoredRun| (run.shop, u64::from(run.replication), run.policy) == (shop, replication, policy);
            let run = found.next().filter(here).ok_or_else(|| format!("{} is not where it should be", of()))?;
            if run.values.len() != figures {
                return Err(format!("{} has {} key figures, not {figures}", of(), run.values.len()));
            }
            if run.lives.iter().any(|life| EdgeLife::of_named(life).is_none()) {
                return Err(format!("an edge of {} ended for no known reason", of()));
            }
        }
    }
    match found.next() {
        Some(run) => Err(format!("replication {} is one too many", run.replication)),
        None => Ok(runs.iter().fold(0, |digest: u64, run| digest.wrapping_add(run.digest))),
    }
}

impl StoredRun {
    pub(super) fn from_policy(shop: u32, policy: usize, replication: u32, run: &Run) -> Self {
        Self {
            shop,
            policy,
            replication,
            digest: run.digest,
            values: run.values.iter().map(|value| value.to_bits()).collect(),
            lives: run.lives.iter().map(EdgeLife::named).collect(),
        }
    }

    /// Key figures, then what a planner asks.
    pub(crate) fn figures(&self) -> Vec<f64> {
        self.values.iter().map(|bits| f64::from_bits(*bits)).collect()
    }

    /// The run as if it had been made here.
    pub(super) fn run(&self) -> Run {
        Run {
            values: self.figures(),
            digest: self.digest,
            lives: self.lives.iter().filter_map(EdgeLife::of_named).collect(),
            log: None,
            lead_times: None,
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
    fn runs_that_are_missing_doubled_or_short_are_told() {
        let scenario = fixture::scenario();
        let policies: Vec<usize> = (0..scenario.policies.len()).collect();
        let runs = stored_runs((0, &scenario), &policies, 1, 3).expect("runs");
        let said = |change: &dyn Fn(&mut Vec<StoredRun>)| {
            let mut runs = runs.clone();
            change(&mut runs);
            stored_digest(&[&scenario], &policies, (1, 3), &runs).expect_err("changed runs")
        };
        assert!(stored_digest(&[&scenario], &policies, (1, 3), &runs).is_ok());
        assert!(said(&|runs| runs[0].shop = 1).contains("replication 1"));
        assert!(said(&|runs| drop(runs.pop())).contains("is not where it should be"));
        assert!(said(&|runs| drop(runs.remove(0))).contains("replication 1"));
        assert!(said(&|runs| runs.swap(0, 1)).contains("is not where it should be"));
        assert!(said(&|runs| runs.push(runs[0].clone())).contains("one too many"));
        assert!(said(&|runs| runs[0].policy = usize::MAX).contains("replication 1"));
        assert!(said(&|runs| _ = runs[1].values.pop()).contains("key figures"));
        assert!(stored_digest(&[&scenario], &policies, (0, 2), &runs).is_err());
        // Those of a variant are due behind those of the shop as it is.
        let shops = [&scenario, &scenario];
        let said = stored_digest(&shops, &policies, (1, 3), &runs).expect_err("no runs of the variant");
        assert!(said.contains("in variant 1"), "{said}");
        let of_variant = stored_runs((1, &scenario), &policies, 1, 3).expect("runs");
        assert!(stored_digest(&shops, &policies, (1, 3), &[runs, of_variant].concat()).is_ok());
    }

    #[test]
    fn runs_made_elsewhere_are_the_same_study() {
        let scenario = fixture::scenario();
        let options = StudyOptions { replications: 6, ..StudyOptions::of(&scenario) };
        let study = |options: &StudyOptions| {
            run_study(&scenario, options, None, &|_| {}, &AtomicBool::new(false)).expect("a study")
        };
        let here = study(&options);
        let policies = options.policies.clone();
        let mut elsewhere = KnownRuns::new();
        for (from, to) in [(3, 6), (0, 3)] {
            let runs = stored_runs((0, &scenario), &policies, from, to).expect("runs");
            let text = serde_json::to_string(&runs).unwrap();
            elsewhere.extend(known(serde_json::from_str::<Vec<StoredRun>>(&text).unwrap()));
        }
        let there = study(&StudyOptions { known: Arc::new(elsewhere), ..options });
        assert_eq!(there.digest, here.digest);
        let bits = |values: Vec<f64>| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        for policy in 0..policies.len() {
            assert!(there.edge_lives(policy).eq(here.edge_lives(policy)));
            assert!(there.replications(policy).map(bits).eq(here.replications(policy).map(bits)));
        }
    }
}
