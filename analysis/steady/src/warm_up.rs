//! The warm-up of a shop, from runs of its own.

use crate::LeadTimes;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use toolroom_kpi::unless_stopped;
use toolroom_scenario::Scenario;
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_shop::{Shop, ShopError};
use toolroom_statistics::{Batched, MSER_BATCH, mser};

/// Most replications from which a warm-up is found (assumption: beyond twenty averaged runs the end of the start moves by
/// less than the batches are long, and every run is made twice).
pub const MOST_RUNS: u32 = 20;

/// The warm-up that was found for shops that are compared, the same for all of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WarmUp {
    /// How long it lasts, s.
    pub time: f64,
    /// Replications from which it was found.
    pub replications: u32,
    /// What was found for each shop under each policy.
    pub cuts: Vec<Cut>,
}

/// What was found for a shop under a policy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cut {
    /// Name of the variant and the policy.
    pub name: String,
    /// Jobs that are left out.
    pub jobs: u64,
    /// Jobs that were looked at: those of the shortest run.
    pub of: u64,
    /// When in the latest of the runs the last of those jobs left, s.
    pub time: f64,
    /// Whether half of the jobs are left out, the most that may be.
    pub at_limit: bool,
}

/// A shop whose warm-up is sought.
#[derive(Clone, Copy, Debug)]
pub struct WarmUpSearch<'a> {
    /// Name of the variant; empty for the shop as it is.
    pub name: &'a str,
    /// The shop.
    pub scenario: &'a Scenario,
}

/// Why no warm-up was found.
#[derive(Debug, thiserror::Error)]
pub enum SteadyError {
    /// Too few jobs leave the shop.
    #[error("{name}: {jobs} jobs leave the shop until the horizon, too few to tell where its start ends")]
    TooShort {
        /// Variant and policy.
        name: String,
        /// Jobs of the shortest run.
        jobs: u64,
    },
    /// A run stopped.
    #[error("{name}, replication {replication}: {source}")]
    Shop {
        /// Variant and policy.
        name: String,
        /// Replication, from 0.
        replication: u32,
        /// What happened.
        source: Box<ShopError>,
    },
    /// The threads cannot be started.
    #[error("cannot start the threads: {source}")]
    Threads {
        /// What the thread pool said.
        source: rayon::ThreadPoolBuildError,
    },
    /// It was stopped from outside.
    #[error("interrupted while the warm-up was sought; nothing was written")]
    Stopped,
}

impl SteadyError {
    /// The way out.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::TooShort { .. } => "make the horizon longer, or give the warm-up as a time",
            Self::Shop { .. } | Self::Threads { .. } => {
                "the run itself would stop there too: toolroom explain tells more"
            }
            Self::Stopped => "the same command starts anew",
        }
    }
}

/// Finds the warm-up by MSER-5 from the lead times of at most [`MOST_RUNS`] replications of every shop under every policy.
///
/// The warm-up of shops that are compared is one time, the latest of all: every figure is counted over the same stretch.
/// The result does not depend on the number of threads (0: one per processor).
///
/// # Errors
/// See [`SteadyError`].
pub fn find(
    shops: &[WarmUpSearch<'_>],
    policies: &[usize],
    replications: u32,
    threads: usize,
    stop: &AtomicBool,
) -> Result<WarmUp, SteadyError> {
    let replications = replications.min(MOST_RUNS);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|source| SteadyError::Threads { source })?;
    let mut cuts = Vec::new();
    for shop in shops {
        for &policy in policies {
            let name = name(shop, policy);
            let failed =
                |replication, source| SteadyError::Shop { name: name.clone(), replication, source: Box::new(source) };
            let resolved =
                ResolvedPolicy::from_scenario(shop.scenario, policy).map_err(|source| failed(0, source.into()))?;
            let resolved = Arc::new(resolved);
            let run = |replication: u32| {
                let ran = lead_times(shop.scenario, &resolved, replication, stop);
                ran.map_err(|source| failed(replication, source))
            };
            let ran: Vec<_> = pool.install(|| (0..replications).into_par_iter().map(run).collect());
            let runs = ran.into_iter().collect::<Result<Option<Vec<Batched>>, _>>()?;
            cuts.push(cut(name, &runs.ok_or(SteadyError::Stopped)?)?);
        }
    }
    let time = cuts.iter().map(|cut| cut.time).fold(0.0, f64::max);
    Ok(WarmUp { time, replications, cuts })
}

/// What a shop under a policy is called.
fn name(shop: &WarmUpSearch<'_>, policy: usize) -> String {
    let policy = shop.scenario.policies.get(policy).map_or("", |policy| policy.name.as_str());
    if shop.name.is_empty() { policy.to_owned() } else { format!("{}, {policy}", shop.name) }
}

/// Lead times of a run from its start; `None` where it was stopped.
fn lead_times(
    scenario: &Scenario,
    policy: &Arc<ResolvedPolicy>,
    replication: u32,
    stop: &AtomicBool,
) -> Result<Option<Batched>, ShopError> {
    let world = scenario.drawn(replication)?;
    let recorder = LeadTimes { from: 0.0, ..LeadTimes::from_scenario(scenario, MSER_BATCH) };
    let shop = Shop::with_recorder(&world, Arc::clone(policy), replication, recorder)?;
    Ok(unless_stopped(shop, stop)?.map(|recorder| recorder.times().clone()))
}

/// Where the start of runs of one shop ends.
fn cut(name: String, runs: &[Batched]) -> Result<Cut, SteadyError> {
    let jobs = |run: &Batched| run.means().len() as u64 * run.size();
    let of = runs.iter().map(jobs).min().unwrap_or(0);
    let Some(found) = mser(runs) else { return Err(SteadyError::TooShort { name, jobs: of }) };
    let end = |run: &Batched| run.end((found.values() / run.size()) as usize).unwrap_or(0.0);
    let time = runs.iter().map(end).fold(0.0, f64::max);
    Ok(Cut { name, jobs: found.values(), of, time, at_limit: found.at_limit })
}

impl WarmUp {
    /// Whether the runs are too short to tell where the start ends.
    pub fn run_longer(&self) -> bool {
        self.cuts.iter().any(|cut| cut.at_limit)
    }

    /// The change of the scenario that holds it, to the last bit.
    pub fn change(&self) -> String {
        format!("shop.warm_up={} s", self.time)
    }

    /// In words.
    pub fn text(&self) -> String {
        let plural = if self.replications == 1 { "" } else { "s" };
        let mut text =
            format!("warm-up {:.2} h by MSER-5 from {} replication{plural}", self.time / 3600.0, self.replications);
        if let [cut] = self.cuts.as_slice() {
            text.push_str(&format!(": {} of {} jobs are left out", cut.jobs, cut.of));
        } else if let Some(longest) = self.cuts.iter().max_by(|a, b| a.time.total_cmp(&b.time)) {
            text.push_str(&format!(
                ", the longest of all that are compared ({}: {} of {} jobs)",
                longest.name, longest.jobs, longest.of
            ));
        }
        text.push('\n');
        for cut in self.cuts.iter().filter(|cut| cut.at_limit) {
            let name = &cut.name;
            text.push_str(&format!(
                "warning: run longer: half of the jobs are left out ({name}), and the start may still not be over\n"
            ));
        }
        text
    }

    /// For programs.
    pub fn json(&self) -> Value {
        let cuts: Vec<Value> = self
            .cuts
            .iter()
            .map(|cut| {
                json!({
                    "name": cut.name,
                    "jobs_left_out": cut.jobs,
                    "jobs": cut.of,
                    "time [h]": cut.time / 3600.0,
                    "run_longer": cut.at_limit,
                })
            })
            .collect();
        json!({
            "procedure": "mser5",
            "time [h]": self.time / 3600.0,
            "replications": self.replications,
            "cuts": cuts,
            "run_longer": self.run_longer(),
        })
    }
}
