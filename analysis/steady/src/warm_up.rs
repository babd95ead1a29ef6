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
pub struct Wanted<'a> {
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
    shops: &[Wanted<'_>],
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
            let resolved = ResolvedPolicy::of(shop.scenario, policy).map_err(|source| failed(0, source.into()))?;
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
fn name(shop: &Wanted<'_>, policy: usize) -> String {
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
    let recorder = LeadTimes { from: 0.0, ..LeadTimes::of(scenario, MSER_BATCH) };
    let shop = Shop::with_recorder(&world, Arc::clone(policy), replication, recorder)?;
    Ok(unless_stopped(shop, scenario.horizon, stop)?.map(|recorder| recorder.times().clone()))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::OneRun;
    use toolroom_scenario_file::parse;
    use toolroom_shop::Silent;

    /// A queue that begins empty: exponential arrivals and service, a load of 90 %.
    fn queue(horizon: &str, load: &str) -> Scenario {
        let text = format!(
            "schema = 1\n[shop]\nname = \"queue\"\nhorizon = \"{horizon}\"\nreplications = 8\nwarm_up = \"mser5\"\n\
             [[machine]]\nname = \"M\"\nprocess = \"plain\"\n\
             [[part]]\nname = \"job\"\noperation = [{{ name = \"serve\", machines = \"M\", \
             work = {{ distribution = \"exponential\", mean = \"1 min\" }} }}]\n\
             [[arrivals]]\npart = \"job\"\npattern = \"poisson\"\nrate = \"{load} 1/h\"\n"
        );
        parse("queue.toml", &text, &[]).unwrap_or_else(|error| panic!("{error}")).scenario
    }

    fn found(scenario: &Scenario, threads: usize) -> Result<WarmUp, SteadyError> {
        let shops = [Wanted { name: "", scenario }];
        find(&shops, &[0], scenario.replications, threads, &AtomicBool::new(false))
    }

    #[test]
    fn a_queue_that_begins_empty_needs_a_warm_up_whatever_the_number_of_threads() {
        let scenario = queue("100 h", "54");
        assert!(scenario.seeks_warm_up && scenario.warm_up == 0.0);
        let one = found(&scenario, 1).expect("thousands of jobs");
        assert_eq!(one, found(&scenario, 2).expect("the same"));
        let cut = &one.cuts[0];
        assert!(cut.jobs > 0 && cut.jobs < cut.of / 2 && !one.run_longer(), "{cut:?}");
        assert!(one.time > 0.0 && one.time < 0.5 * scenario.horizon);
        // The start of the scenario that holds the time is the same to the last bit.
        let held = one.change();
        let time = held.trim_start_matches("shop.warm_up=").trim_end_matches(" s").parse::<f64>();
        assert_eq!(time.map(f64::to_bits), Ok(one.time.to_bits()));
    }

    #[test]
    fn a_queue_that_only_grows_is_told_to_run_longer() {
        let growing = found(&queue("20 h", "120"), 0).expect("a thousand jobs");
        assert!(growing.run_longer(), "{growing:?}");
        assert!(growing.text().contains("run longer"));
        assert_eq!(growing.json()["run_longer"], true);
    }

    #[test]
    fn a_run_with_too_few_jobs_and_one_that_is_stopped_are_refused() {
        assert!(matches!(found(&queue("10 min", "54"), 1), Err(SteadyError::TooShort { .. })));
        let scenario = queue("100 h", "54");
        let stopped = find(&[Wanted { name: "", scenario: &scenario }], &[0], 2, 1, &AtomicBool::new(true));
        assert!(matches!(stopped, Err(SteadyError::Stopped)));
    }

    #[test]
    fn one_long_run_knows_its_mean_as_well_as_it_says() {
        // M/M/1 at 50 % load: a job stays two minutes (Kleinrock I, eq. 3.26). 2000 h are 60 000 jobs.
        let scenario = Scenario { warm_up: 36_000.0, seeks_warm_up: false, ..queue("2000 h", "30") };
        let policy = Arc::new(ResolvedPolicy::of(&scenario, 0).unwrap());
        let mut held = 0;
        for replication in 0..20 {
            let recorder = (Silent, OneRun::recorder(&scenario));
            let shop = Shop::with_recorder(&scenario, Arc::clone(&policy), replication, recorder).unwrap();
            let (_, recorded) = shop.run().unwrap();
            let one = OneRun::of(&recorded.expect("it goes on")).expect("60 000 jobs");
            held += u32::from(!one.means().interval.excludes(120.0));
            assert!(one.means().size >= 2048 && one.means().interval.within(0.05), "{one:?}");
        }
        // Of twenty intervals at 95 % at least 17 hold it in 98.4 % of all seeds.
        assert!(held >= 17, "{held}");
    }

    #[test]
    fn a_shop_with_orders_has_no_warm_up_and_no_batches() {
        let text = "schema = 1\n[shop]\nname = \"o\"\nhorizon = \"1 h\"\nwarm_up = \"mser5\"\n[[machine]]\nname = \"M\"\n\
                    process = \"plain\"\n[[part]]\nname = \"b\"\noperation = [{ name = \"a\", machines = \"M\", work = \"1 min\" }]\n\
                    [[order]]\nid = \"1\"\npart = \"b\"\n";
        let refused = parse("orders.toml", text, &[]).expect_err("no steady state").to_string();
        assert!(refused.contains("settles into nothing"), "{refused}");
        let ends = parse("orders.toml", text, &["shop.warm_up=0 h".to_owned()]).unwrap().scenario;
        assert!(ends.is_terminating() && OneRun::recorder(&ends).is_none());
        let misspelt = parse("orders.toml", text, &["shop.warm_up=mser".to_owned()]).unwrap_err().to_string();
        assert!(misspelt.contains("mser5, or a number with its unit"), "{misspelt}");
    }
}
