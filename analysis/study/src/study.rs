//! Every policy on common random numbers, many times over.
//!
//! ```text
//!  Scenario ──► simulate(policy, replication), in parallel ──► key figures ──► Study (fixed order)
//!                                   └─ first replications ──► LogWriter, in order
//! ```
//! Replications run in chunks of fixed size, so that neither the results nor the decision to stop
//! depend on the number of threads, and only the logs of one chunk are in memory. A study that was
//! stopped goes on from its [`Finished`] part to the same result.

mod error;
mod finished;
mod options;
mod precision;
mod rows;
mod samples;
mod stored;

pub use crate::kpi::Progress;
pub use error::{StoppedShop, StudyError};
pub use finished::{Finished, FinishedError};
pub use options::StudyOptions;
pub use precision::{NoPrecision, Precision, Width};
use rows::Rows;
pub(crate) use samples::by_draw;
pub use stored::{KnownRuns, StoredRun, known, known_of, stored_digest, stored_runs};

use crate::kpi::{self, Counting, Kpi, unless_stopped};
use crate::logs::LogWriter;
use crate::planner::Figures;
use crate::tune::Tuning;
use crate::variants::{self, SelectedShop, VariantRuns};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use toolroom_scenario::Scenario;
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_shards::{FNV_OFFSET, fnv};
use toolroom_shop::runlog::{ChangeReason, EdgeRow};
use toolroom_shop::{RunLog, Shop, ShopError};
use toolroom_statistics::{CONFIDENCE, t_interval};
use toolroom_steady::{LeadTimes, OneRun, WarmUp};

/// Replications between two checks of the stop rule where logs are kept.
const LOGGED_CHUNK: u32 = 4;

/// The same without logs; a multiple of the former.
const CHUNK: u32 = 16;

/// Life of one cutting edge of a lathe that left the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeLife {
    /// Time in cut, s.
    pub cutting_time: f64,
    /// Why it left.
    pub reason: ChangeReason,
}

/// An edge's life in files: time in cut (s) and name of the reason.
type NamedLife = (f64, String);

impl EdgeLife {
    fn named(&self) -> NamedLife {
        (self.cutting_time, self.reason.name().to_owned())
    }

    /// Time in cut, s, and number of the reason.
    fn numbers(&self) -> [f64; 2] {
        [self.cutting_time, f64::from(self.reason as u8)]
    }

    fn of_numbers(numbers: &[f64]) -> Option<Self> {
        let &[cutting_time, number] = numbers else { return None };
        let reason = ChangeReason::ALL.into_iter().find(|reason| f64::from(*reason as u8) == number)?;
        Some(Self { cutting_time, reason })
    }

    fn of_named((cutting_time, name): &NamedLife) -> Option<Self> {
        let reason = ChangeReason::ALL.into_iter().find(|reason| reason.name() == name)?;
        Some(Self { cutting_time: *cutting_time, reason })
    }
}

/// Key figures of every policy in every replication.
#[derive(Clone, Debug)]
pub struct Study {
    /// Policies by index into the scenario, in the order of everything below.
    pub policies: Vec<usize>,
    /// What the values are.
    pub kpis: Vec<Kpi>,
    /// Replications that all policies finished.
    pub replications: u32,
    /// Replications in a row that share a draw of the parameters; one where nothing is drawn.
    pub alike: u32,
    /// Whether everything requested was run; false after a stop by the user.
    pub complete: bool,
    /// Stop rule under which replications were run, of which there were then as many as it took; none: their number was given.
    pub until: Vec<Precision>,
    /// Digest of the digests of all runs, in order.
    pub digest: u64,
    /// Logs of the first replication, by policy.
    pub first_logs: Vec<RunLog>,
    /// How the settings of the policies were found.
    pub tuning: Option<Arc<Tuning>>,
    /// How the warm-up of the scenario was found.
    pub warm_up: Option<Arc<WarmUp>>,
    /// The figure that matters most.
    pub primary: Option<String>,
    /// The mean lead time by policy, where there is but one run of a shop that goes on.
    pub one_run: Vec<Option<OneRun>>,
    /// Variants of the shop, run as often on the same random numbers.
    pub(crate) variants: Vec<VariantRuns>,
    /// The best of them, where that was requested.
    pub(crate) selection: Option<SelectedShop>,
    /// By policy and replication: key figures, then what a planner asks.
    values: Vec<Rows>,
    /// Edges of the lathes over all replications, by policy, as [`EdgeLife::numbers`].
    edge_lives: Vec<Rows>,
}

impl Study {
    /// Position of a figure of the shop.
    pub fn index(&self, id: &str) -> Option<usize> {
        self.kpis.iter().position(|kpi| kpi.machine.is_none() && kpi.definition.id == id)
    }

    /// Position of a figure of a machine.
    pub fn machine_index(&self, machine: usize, id: &str) -> Option<usize> {
        // Figures of the shop stand first, then those of each machine.
        let first = self.kpis.partition_point(|kpi| kpi.machine < Some(machine));
        let own = self.kpis[first..].iter().take_while(|kpi| kpi.machine == Some(machine));
        own.into_iter().position(|kpi| kpi.definition.id == id).map(|place| first + place)
    }

    /// Value of a figure in each replication, SI, NaN where it is not defined. `policy` counts
    /// within [`policies`](Self::policies).
    pub fn values(&self, policy: usize, kpi: usize) -> Vec<f64> {
        self.values[policy].column(kpi)
    }

    /// Values of all key figures in each replication.
    pub fn replications(&self, policy: usize) -> impl Iterator<Item = Vec<f64>> + '_ {
        self.values[policy].iter().map(move |mut values| {
            values.truncate(self.kpis.len());
            values
        })
    }

    /// What a planner asks, in each replication, as [`Figures`] says.
    pub(crate) fn planner_figures(&self, policy: usize) -> impl Iterator<Item = Vec<f64>> + '_ {
        self.values[policy].iter().map(move |mut values| values.split_off(self.kpis.len()))
    }

    /// Edges of the lathes over all replications.
    pub fn edge_lives(&self, policy: usize) -> impl Iterator<Item = EdgeLife> + '_ {
        self.edge_lives[policy].iter().filter_map(|numbers| EdgeLife::of_numbers(&numbers))
    }
}

/// Runs the policies of a scenario on common random numbers.
///
/// The logs of the first [`logged`](StudyOptions::logged) replications go to `logs` in the order
/// of replications, then policies. `progress` is called from any thread. When `stop` is set, the
/// runs in hand are given up and the replications complete for all policies are the result. After an
/// [`earlier`](StudyOptions::earlier) part only the first of its replications is run again, for the
/// logs and to see that it repeats; `logs` have its rows already.
///
/// # Errors
/// See [`StudyError`]; of several shops that stopped, the first one in order is reported.
pub fn run_study(
    scenario: &Scenario,
    options: &StudyOptions,
    logs: Option<&mut LogWriter>,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<Study, StudyError> {
    whole(run_study_as_far(scenario, options, logs, progress, stop)?)
}

/// Like [`run_study`], but a shop that stops ends the study as an interruption does: the
/// replications before it that are complete for all policies are the result, beside the reason.
///
/// # Errors
/// See [`StudyError`], but for a shop that stopped.
pub fn run_study_as_far(
    scenario: &Scenario,
    options: &StudyOptions,
    logs: Option<&mut LogWriter>,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<(Study, Option<StoppedShop>), StudyError> {
    check(scenario, options)?;
    let resolved = resolve(scenario, &options.policies)?;
    let simulate = |policy: usize, replication| {
        let world = scenario.drawn(replication)?;
        let log = keeps_log(scenario, options, replication).then(RunLog::default);
        let lead_times = if options.is_one_run() { OneRun::recorder(scenario) } else { None };
        let recorder = ((Counting::new(scenario), log), lead_times);
        let shop = Shop::with_recorder(&world, Arc::clone(&resolved[&policy]), replication, recorder)?;
        let ended = unless_stopped(shop, stop)?;
        Ok(ended.map(|((counting, log), lead_times)| Run { lead_times, ..Run::of(scenario, &counting, log) }))
    };
    let shops = 1 + options.variants.len() as u32;
    let of_all = |at: Progress| progress(Progress { done: at.done, total: at.total.saturating_mul(shops) });
    let (mut study, stopped) = study_as_far(scenario, options, logs, &of_all, stop, &simulate)?;
    if study.complete && study.variants.is_empty() {
        variants::run(scenario, &mut study, options, progress, stop)?;
    }
    Ok((study, stopped))
}

/// Whether the log of a replication is needed: to be written, for pictures of the first one, or for what a
/// planner asks.
fn keeps_log(scenario: &Scenario, options: &StudyOptions, replication: u32) -> bool {
    replication < options.logged || !scenario.orders.is_empty()
}

fn whole((study, stopped): (Study, Option<StoppedShop>)) -> Result<Study, StudyError> {
    stopped.map_or(Ok(study), |stopped| Err(StudyError::Shop(stopped)))
}

/// The policies worked out.
fn resolve(scenario: &Scenario, policies: &[usize]) -> Result<BTreeMap<usize, Arc<ResolvedPolicy>>, StudyError> {
    let resolve = |&policy: &usize| {
        let resolved = ResolvedPolicy::from_scenario(scenario, policy);
        resolved
            .map(|resolved| (policy, Arc::new(resolved)))
            .map_err(|source| StudyError::Shop(stopped(scenario, policy, 0, source.into())))
    };
    policies.iter().map(resolve).collect()
}

fn stopped(scenario: &Scenario, policy: usize, replication: u32, source: ShopError) -> StoppedShop {
    StoppedShop { policy, name: scenario.policies[policy].name.clone(), replication, source: Box::new(source) }
}

/// One finished run.
struct Run {
    values: Vec<f64>,
    digest: u64,
    lives: Vec<EdgeLife>,
    log: Option<RunLog>,
    /// Lead times one by one, where it is the only run.
    lead_times: Option<LeadTimes>,
}

impl Run {
    /// A run that is over, from its log.
    #[cfg(test)]
    fn of_log(scenario: &Scenario, log: RunLog) -> Self {
        Self::of(scenario, &Counting::from_scenario(scenario, &log), Some(log))
    }

    /// What was counted, and the log, where one was kept.
    fn of(scenario: &Scenario, counting: &Counting<'_>, log: Option<RunLog>) -> Self {
        let mut values = counting.values();
        if let Some(log) = &log {
            values.extend(Figures::of(scenario).evaluate(scenario, log));
        }
        values.extend(counting.group_values());
        let life = |edge: &EdgeRow| EdgeLife { cutting_time: edge.cutting_time, reason: edge.reason };
        let digest = counting.closing().map_or(0, |closing| closing.digest);
        Self { values, digest, lives: counting.lives().map(life).collect(), log, lead_times: None }
    }
}

#[cfg(test)]
pub(crate) fn study_with<S>(
    scenario: &Scenario,
    options: &StudyOptions,
    logs: Option<&mut LogWriter>,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
    simulate: &S,
) -> Result<Study, StudyError>
where
    S: Fn(usize, u32) -> Result<RunLog, ShopError> + Sync,
{
    let simulate = |policy, replication| Ok(Some(Run::of_log(scenario, simulate(policy, replication)?)));
    whole(study_as_far(scenario, options, logs, progress, stop, &simulate)?)
}

fn study_as_far<S>(
    scenario: &Scenario,
    options: &StudyOptions,
    mut logs: Option<&mut LogWriter>,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
    simulate: &S,
) -> Result<(Study, Option<StoppedShop>), StudyError>
where
    S: Fn(usize, u32) -> Result<Option<Run>, ShopError> + Sync,
{
    check(scenario, options)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads)
        .build()
        .map_err(|source| StudyError::Threads { source })?;
    let count = options.policies.len();
    let total = options.replications.saturating_mul(count as u32);
    let before = options.earlier.as_ref().map_or(0, |earlier| earlier.replications);
    let done = AtomicU32::new(before.saturating_mul(count as u32));
    // `None` where the run was given up.
    let evaluated = |policy: usize, replication: u32| -> Option<Result<Run, StoppedShop>> {
        let kept = |run: Run| Run { log: run.log.filter(|_| replication < options.logged), ..run };
        let simulated = simulate(policy, replication).transpose()?;
        Some(simulated.map(kept).map_err(|source| stopped(scenario, policy, replication, source)))
    };
    // Replications after one that stopped are not wanted; those before it decide what is reported.
    let last_wanted = AtomicU32::new(u32::MAX);
    let run = |(replication, policy): (u32, usize)| -> Option<Result<Run, StoppedShop>> {
        if stop.load(Ordering::Relaxed) || replication > last_wanted.load(Ordering::Relaxed) {
            return None;
        }
        let with_log = replication < options.logged;
        let known =
            options.known.get(&(options.shop, replication, policy)).filter(|_| !with_log && !options.is_one_run());
        let run = known.map_or_else(|| evaluated(policy, replication), |known| Some(Ok(known.run())))?;
        match (&run, &options.journal) {
            (Err(_), _) => _ = last_wanted.fetch_min(replication, Ordering::Relaxed),
            (Ok(run), Some(journal)) if known.is_none() && !with_log => {
                journal.add(&StoredRun::from_policy(options.shop, policy, replication, run));
            }
            (Ok(_), _) => {}
        }
        progress(Progress { done: done.fetch_add(1, Ordering::Relaxed) + 1, total });
        Some(run)
    };

    let mut study = Study {
        policies: options.policies.clone(),
        kpis: kpi::kpis(scenario),
        replications: 0,
        alike: scenario.replications_alike(),
        complete: true,
        until: options.until.clone(),
        digest: FNV_OFFSET,
        first_logs: Vec::new(),
        tuning: options.tuning.clone(),
        variants: Vec::new(),
        selection: None,
        warm_up: options.warm_up.clone(),
        primary: options.primary.clone(),
        one_run: vec![None; count],
        values: vec![Rows::default(); count],
        edge_lives: vec![Rows::default(); count],
    };
    if let Some(earlier) = &options.earlier {
        let first =
            pool.install(|| options.policies.par_iter().map(|&policy| evaluated(policy, 0)).collect::<Vec<_>>());
        let Some(first) = first.into_iter().collect::<Option<Result<Vec<_>, _>>>() else {
            study.complete = false;
            return Ok((study, None));
        };
        earlier.restore(scenario, first?, &mut study)?;
    }
    while study.replications < options.replications {
        let first = study.replications;
        let look = (!options.until.is_empty()).then(|| Precision::next_look(first));
        let end = chunk_end(first, options.logged).min(look.unwrap_or(u32::MAX));
        let last = options.replications.min(end).min(options.stop_after.unwrap_or(u32::MAX));
        let tasks: Vec<(u32, usize)> = (first..last)
            .flat_map(|replication| options.policies.iter().map(move |&policy| (replication, policy)))
            .collect();
        let mut runs = pool.install(|| tasks.par_iter().copied().map(run).collect::<Vec<_>>()).into_iter();
        for replication in first..last {
            let of_replication: Vec<_> = runs.by_ref().take(count).collect();
            let mut finished = Vec::with_capacity(count);
            for run in of_replication.into_iter().flatten() {
                match run {
                    Ok(run) => finished.push(run),
                    Err(stopped) => {
                        study.complete = false;
                        return Ok((study, Some(stopped)));
                    }
                }
            }
            if finished.len() < count {
                study.complete = false;
                return Ok((study, None));
            }
            for (position, run) in finished.into_iter().enumerate() {
                study.add(position, replication, run, logs.as_deref_mut().filter(|_| replication < options.logged))?;
            }
            study.replications = replication + 1;
        }
        if look == Some(last) && study.is_precise() {
            break;
        }
        if last < options.replications && options.stop_after.is_some_and(|most| most <= last) {
            study.complete = false;
            break;
        }
    }
    Ok((study, None))
}

/// End of the chunk in which a replication lies, wherever a study was stopped and goes on.
fn chunk_end(replication: u32, logged: u32) -> u32 {
    let chunk = if replication / LOGGED_CHUNK < logged.div_ceil(LOGGED_CHUNK) { LOGGED_CHUNK } else { CHUNK };
    replication.saturating_add(chunk - replication % chunk)
}

fn check(scenario: &Scenario, options: &StudyOptions) -> Result<(), StudyError> {
    if options.replications == 0 {
        return Err(StudyError::NoReplications);
    }
    if options.policies.is_empty() {
        return Err(StudyError::NoPolicies);
    }
    if scenario.seeks_warm_up {
        return Err(StudyError::SeeksWarmUp);
    }
    let count = scenario.policies.len();
    match options.policies.iter().find(|&&policy| policy >= count) {
        Some(&policy) => Err(StudyError::UnknownPolicy { policy, count }),
        None => Ok(()),
    }
}

impl Study {
    fn add(
        &mut self,
        position: usize,
        replication: u32,
        run: Run,
        logs: Option<&mut LogWriter>,
    ) -> Result<(), StudyError> {
        self.digest = fnv(self.digest, &run.digest.to_le_bytes());
        self.one_run[position] = run.lead_times.as_ref().and_then(OneRun::from_lead_times);
        self.values[position].push(&run.values);
        run.lives.iter().for_each(|life| self.edge_lives[position].push(&life.numbers()));
        if let Some(log) = run.log {
            if let Some(writer) = logs {
                writer.write(self.policies[position], replication, &log)?;
            }
            if replication == 0 {
                self.first_logs.push(log);
            }
        }
        Ok(())
    }

    /// Whether all that is watched is known well enough; false where nothing is watched.
    fn is_precise(&self) -> bool {
        let known = |policy: usize, precision: &Precision| {
            precision.figures().into_iter().all(|id| {
                self.index(id).is_some_and(|kpi| precision.holds(&t_interval(&self.samples(policy, kpi), CONFIDENCE)))
            })
        };
        self.replications >= Precision::LEAST
            && !self.until.is_empty()
            && (0..self.policies.len()).all(|policy| self.until.iter().all(|precision| known(policy, precision)))
    }
}

#[cfg(test)]
mod tests;
