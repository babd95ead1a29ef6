//! Every rule at its best settings: rules are tuned with the same budget of simulated replications, on a seed of their own,
//! before they are compared.
//!
//! ```text
//!  grid of settings ──► few replications of each ──► border? extend ──► the better third: more replications
//!        ──► surface through all of them ──► finer grid around its minimum ──► the best few ──► its minimum itself: what is left
//! ```
//! All settings of all rules see the same random numbers, so that what a replication costs everybody can be told from what a
//! setting costs. The best setting is that of the least estimate ([`toolroom_surface`]): a quadratic surface through the
//! settings that lie on one, and as much of each setting's own deviation from it as its replications bear out. The least
//! of the settings' own means would mostly be a lucky one. Settings that lose more edges than the guard allows are no rivals.
//!
//! Halving the field takes the place of a selection with a promised probability (Kim and Nelson 2001): with the default
//! indifference of 0.1 % and paired deviations of some per cent that procedure strikes none of 24 settings within 25
//! replications of each, and would spend the whole budget on equal shares.
//!
//! Where a policy leaves open by which rule edges are changed, each rule is searched with an equal share of the budget, and one
//! more share goes to the better ones.
//!
//! # Source
//! Z. Karnin, T. Koren, O. Somekh, ICML 2013 (sequential halving for the best of many at a fixed budget).
//!
//! # What is not modelled
//! Settings are tuned for the mean of one key figure on one scenario; what they are worth when prices or times change is
//! another study. Stability rules, grinding cycles, dressing and contours are not tuned.

#![deny(clippy::wildcard_enum_match_arm)]

mod axis;
mod field;
mod found;
mod outlook;
mod search;
mod trial;
#[cfg(test)]
mod valley;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use toolroom_form::nearest;
use toolroom_kpi::{self as kpi, Better, Progress};
use toolroom_scenario::policies::ResolveError;
use toolroom_scenario::{Scenario, Tunable, TuneRequest};
use toolroom_shards::Journal;
use toolroom_shop::ShopError;
use trial::{Asked, Run, Search};

/// Least budget of a rule: two replications of every setting of the first grid, and as much again.
pub const LEAST_BUDGET: u32 = 100;

/// A setting at its tuned value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TunedSetting {
    /// Its key in files.
    pub key: String,
    /// Its value with its unit, exactly as it was simulated.
    pub value: String,
    /// Least and greatest value, with units, of the settings that stayed in the field and whose objective is within the
    /// indifference of the best.
    pub flat: (String, String),
    /// Whether the best lies at the end of what may be tried.
    pub border: bool,
}

/// What tuning found for one policy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TunedPolicy {
    /// Name of the policy.
    pub name: String,
    /// Its settings; none where it stands as it is given.
    pub settings: Vec<TunedSetting>,
    /// Why it is not tuned.
    pub given: Option<String>,
    /// Changes of the scenario file that give the policy its settings.
    pub changes: Vec<String>,
    /// Replications that were simulated for it.
    pub evaluations: u32,
    /// Mean objective of the best settings while tuning, in the unit of files; null where it is not tuned.
    pub objective: Option<f64>,
    /// Its standard error.
    pub standard_error: Option<f64>,
    /// Share of edges that collapsed thermally at these settings.
    pub collapsed: Option<f64>,
    /// Share of edges that were lost in cut.
    pub failed: Option<f64>,
    /// Cheaper settings that the guard excludes.
    pub excluded: Option<Excluded>,
    /// The best of every rule of tool change, the chosen one first; empty where the policy keeps its own.
    #[serde(default)]
    pub tool_changes: Vec<ToolChangeTried>,
    /// What the settings of the first grid cost, for a picture; `None` where a policy has not two settings.
    #[serde(default)]
    pub map: Option<SettingsMap>,
}

/// The best settings of a policy where the guard lets every setting stand.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Excluded {
    /// In words.
    pub settings: String,
    /// Changes of the scenario file that give the policy these settings.
    pub changes: Vec<String>,
    /// Mean objective while tuning, in the unit of files.
    pub objective: f64,
}

/// The best settings with one rule of tool change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ToolChangeTried {
    /// Word of the rule in files.
    pub rule: String,
    /// Settings in words.
    pub settings: String,
    /// Estimated objective, in the unit of files; null where the guard lets no setting stand.
    pub objective: Option<f64>,
}

/// The objective over the two settings of a policy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SettingsMap {
    /// Keys of the settings and the units in which their values are told.
    pub settings: [(String, String); 2],
    /// Values of the first setting and of the second one.
    pub values: [Vec<f64>; 2],
    /// Estimated objective in the unit of files, row by row along the second setting; null where it is not defined.
    pub objective: Vec<Option<f64>>,
    /// Whether the guard excludes a setting, in the same order.
    pub excluded: Vec<bool>,
    /// The settings that were chosen.
    pub chosen: [f64; 2],
}

impl TunedPolicy {
    /// Whether it was tuned.
    pub fn is_tuned(&self) -> bool {
        self.given.is_none()
    }
}

/// What tuning found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tuning {
    /// Key figure that was tuned for.
    pub objective: String,
    /// Its unit in files.
    pub unit: String,
    /// Seed of the tuning.
    pub seed: u64,
    /// Replications for every rule.
    pub budget: u32,
    /// Greatest share of edges that may collapse.
    pub collapse: f64,
    /// Greatest share of edges that may be lost in cut.
    pub failure: Option<f64>,
    /// Policies in the order of the study.
    pub policies: Vec<TunedPolicy>,
    /// The verdict where settings that the guard excludes are rivals, too; `None` where it excludes no better ones.
    #[serde(default)]
    pub without_guard: Option<GuardlessVerdict>,
}

/// A verdict between rules that were tuned without the guard, judged on the same random numbers.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GuardlessVerdict {
    /// In one line.
    pub line: String,
    /// The adaptive rule and its rival.
    pub between: [Option<String>; 2],
    /// Difference of the objective and the ends of its interval, as in the verdict under the guard.
    pub difference: Option<[f64; 3]>,
}

impl Tuning {
    /// Changes of the scenario file that give every tuned policy its settings.
    pub fn changes(&self) -> Vec<String> {
        self.policies.iter().flat_map(|policy| policy.changes.iter().cloned()).collect()
    }

    /// The same where every policy may have the settings that the guard excludes; `None` where it excludes no better ones.
    pub fn freed_of_guard(&self) -> Option<Self> {
        let freed = |policy: &TunedPolicy| match &policy.excluded {
            Some(Excluded { changes, objective, .. }) => TunedPolicy {
                given: None,
                changes: changes.clone(),
                objective: Some(*objective),
                excluded: None,
                ..policy.clone()
            },
            None => policy.clone(),
        };
        let excludes = self.policies.iter().any(|policy| policy.excluded.is_some());
        excludes.then(|| Self { policies: self.policies.iter().map(freed).collect(), ..self.clone() })
    }

    /// What was found for the policy called `name`.
    pub fn of(&self, name: &str) -> Option<&TunedPolicy> {
        self.policies.iter().find(|policy| policy.name == name)
    }
}

/// Why rules could not be tuned.
#[derive(Debug, thiserror::Error)]
pub enum TuneError {
    /// No such key figure, or one of which neither more nor less is better.
    #[error("there is no key figure \"{objective}\" to tune for")]
    Objective {
        /// As given.
        objective: String,
        /// What may have been meant, and all of them.
        known: String,
    },
    /// The same random numbers would tune and judge.
    #[error("the seed {seed} tunes and judges")]
    Seed {
        /// The seed.
        seed: u64,
    },
    /// Too few replications for the first grid.
    #[error("a budget of {budget} replications is too small to tune with")]
    Budget {
        /// As given.
        budget: u32,
        /// The least that is enough.
        least: u32,
    },
    /// No policy has a setting that may be tuned.
    #[error("no policy of this study can be tuned")]
    Nothing {
        /// Why, policy by policy.
        reasons: Vec<String>,
    },
    /// The threads cannot be started.
    #[error("cannot start the threads: {source}")]
    Threads {
        /// What the thread pool said.
        source: rayon::ThreadPoolBuildError,
    },
    /// A policy cannot be worked out.
    #[error(transparent)]
    Policy(#[from] ResolveError),
    /// A shop stopped.
    #[error("policy `{policy}` with {settings}: {source}")]
    Shop {
        /// Name of the policy.
        policy: String,
        /// Its settings.
        settings: String,
        /// What happened in the shop.
        source: Box<ShopError>,
    },
    /// The user stopped it.
    #[error("interrupted while tuning; nothing was written")]
    Stopped,
}

impl TuneError {
    /// The way out.
    pub fn fix(&self) -> String {
        match self {
            Self::Objective { known, .. } => known.clone(),
            Self::Seed { .. } => "give [tune] another seed than [shop]".to_owned(),
            Self::Budget { least, .. } => format!("give [tune] a budget of {least} or more"),
            Self::Nothing { reasons } => reasons.join("; "),
            Self::Threads { .. } => "try fewer --threads".to_owned(),
            Self::Policy(_) | Self::Shop { .. } => "leave the policy out, or give it a range under `tune`".to_owned(),
            Self::Stopped => "the same command starts anew".to_owned(),
        }
    }
}

/// What is tuned for.
#[derive(Clone, Copy, Debug)]
struct Objective {
    /// Position among the figures of a run.
    index: usize,
    /// −1 where more is better, else 1: the search looks for the least.
    sign: f64,
}

/// A replication that was simulated while tuning, as a journal keeps it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TriedRun {
    /// Name of the policy.
    policy: String,
    /// Word of its rule of tool change.
    #[serde(default)]
    change: String,
    /// Its settings in SI, as bits.
    settings: Vec<u64>,
    replication: u32,
    /// What is minimised, as bits: it may be infinite, which is no JSON number.
    objective: u64,
    edges: u32,
    collapsed: u32,
    failed: u32,
}

/// What a journal of tuning begins with: the study that is tuned for, as
/// `StudyRequest::head` of toolroom-study tells it, and how rules are tuned.
pub fn tuning_head(study: &Value, request: &TuneRequest) -> Value {
    let TuneRequest { objective, budget, seed, collapse, failure, indifference } = request;
    json!({
        "study": study, "objective": objective, "budget": budget, "seed": seed, "collapse": collapse,
        "failure": failure, "indifference": indifference,
    })
}

/// Tunes `policies` (by index) of `scenario` as `request` says.
///
/// Every policy that may be tuned gets the same number of simulated replications. The result does not depend on `threads`
/// (0: one for each processor).
///
/// # Errors
/// See [`TuneError`].
pub fn tune(
    scenario: &Scenario,
    policies: &[usize],
    request: &TuneRequest,
    threads: usize,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
) -> Result<Tuning, TuneError> {
    tune_from(scenario, policies, request, threads, progress, stop, None)
}

/// Like [`tune`], with a journal for the replications that end, and those that it held: they are not simulated again.
/// The result is that of an undisturbed search.
///
/// # Errors
/// See [`TuneError`].
pub fn tune_from(
    scenario: &Scenario,
    policies: &[usize],
    request: &TuneRequest,
    threads: usize,
    progress: &(dyn Fn(Progress) + Sync),
    stop: &AtomicBool,
    journal: Option<(&Journal<TriedRun>, Vec<TriedRun>)>,
) -> Result<Tuning, TuneError> {
    let (journal, tried) = journal.map_or((None, Vec::new()), |(journal, tried)| (Some(journal), tried));
    let kpis = kpi::kpis(scenario);
    let figures = || kpis.iter().filter(|kpi| kpi.machine.is_none() && kpi.definition.better != Better::Neither);
    let wanted = request.objective.as_str();
    let Some(index) = kpis.iter().position(|kpi| {
        kpi.machine.is_none() && kpi.definition.id == wanted && kpi.definition.better != Better::Neither
    }) else {
        let known: Vec<&str> = figures().map(|kpi| kpi.definition.id).collect();
        let near = nearest(wanted, known.iter().copied()).map(|near| format!("did you mean \"{near}\"? "));
        let known = format!("{}key figures: {}", near.unwrap_or_default(), known.join(", "));
        return Err(TuneError::Objective { objective: wanted.to_owned(), known });
    };
    if request.seed == scenario.seed {
        return Err(TuneError::Seed { seed: request.seed });
    }
    let least = policies.iter().map(|&policy| LEAST_BUDGET * Search::shares(&scenario.policies[policy])).max();
    if let Some(least) = least.filter(|least| request.budget < *least) {
        return Err(TuneError::Budget { budget: request.budget, least });
    }
    let definition = kpis[index].definition;
    let objective = Objective { index, sign: if definition.better == Better::More { -1.0 } else { 1.0 } };
    let reasons: Vec<Option<String>> = policies.iter().map(|&policy| untunable(scenario, policy)).collect();
    let tunable = reasons.iter().filter(|reason| reason.is_none()).count() as u32;
    if tunable == 0 {
        let named = policies.iter().zip(&reasons);
        let told = named.map(|(&policy, reason)| {
            format!("{}: {}", scenario.policies[policy].name, reason.as_deref().unwrap_or_default())
        });
        return Err(TuneError::Nothing { reasons: told.collect() });
    }
    let pool =
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|source| TuneError::Threads { source })?;
    let done = AtomicU32::new(0);
    let tuned_on = Scenario { seed: request.seed, ..scenario.clone() };
    let search = Search {
        simulate: &|asked: &Asked<'_>| Run::simulated(&tuned_on, objective, stop, asked),
        scenario: &tuned_on,
        request,
        sign: objective.sign,
        scale: definition.file_scale(),
        pool: &pool,
        progress: &|more| {
            let done = done.fetch_add(more, Ordering::Relaxed) + more;
            progress(Progress { done, total: tunable.saturating_mul(request.budget) });
        },
        known: tried.into_iter().map(TriedRun::known).collect(),
        journal,
    };
    let tuned = policies.iter().zip(reasons).map(|(&policy, reason)| match reason {
        Some(reason) => Ok(given(&scenario.policies[policy].name, reason)),
        None => search.policy(policy),
    });
    Ok(Tuning {
        objective: request.objective.clone(),
        unit: match definition.file_unit() {
            "currency" => scenario.currency.clone(),
            unit => unit.to_owned(),
        },
        seed: request.seed,
        budget: request.budget,
        collapse: request.collapse,
        failure: request.failure,
        policies: tuned.collect::<Result<_, _>>()?,
        without_guard: None,
    })
}

/// A policy that stands as it is given.
fn given(name: &str, reason: String) -> TunedPolicy {
    TunedPolicy {
        name: name.to_owned(),
        settings: Vec::new(),
        given: Some(reason),
        changes: Vec::new(),
        evaluations: 0,
        objective: None,
        standard_error: None,
        collapsed: None,
        failed: None,
        excluded: None,
        tool_changes: Vec::new(),
        map: None,
    }
}

/// Why a policy stands as it is given; `None` where it can be tuned.
fn untunable(scenario: &Scenario, policy: usize) -> Option<String> {
    let rule = &scenario.policies[policy];
    if rule.tune == Tunable::Given {
        return Some("the file says `tune = false`".to_owned());
    }
    axis::Reference::of(scenario).is_none().then(|| "no turning operation follows a commanded speed".to_owned())
}
