//! What a study is requested to run.

use super::{Finished, KnownRuns, Precision, StoredRun};
use crate::tune::Tuning;
use crate::variants::{VariantShop, Wanted};
use std::sync::Arc;
use toolroom_scenario::Scenario;
use toolroom_shards::Journal;
use toolroom_steady::WarmUp;

/// What to run.
#[derive(Clone, Debug)]
pub struct StudyOptions {
    /// Policies by index; the first one is the baseline of every difference.
    pub policies: Vec<usize>,
    /// Replications of each; with [`until`](Self::until) the most that are run.
    pub replications: u32,
    /// Threads; 0 for one per processor.
    pub threads: usize,
    /// Stop when every policy is known this well; empty: after all replications.
    pub until: Vec<Precision>,
    /// Replications whose full logs are written, from the first on.
    pub logged: u32,
    /// Runs made elsewhere, which are not made again unless their log is wanted.
    pub known: Arc<KnownRuns>,
    /// Where runs without a log are written as they end, so that they are known after any end of the process.
    pub journal: Option<Arc<Journal<StoredRun>>>,
    /// Stop after so many replications as if the user had stopped it.
    pub stop_after: Option<u32>,
    /// What an earlier, stopped run of the same study finished.
    pub earlier: Option<Finished>,
    /// How the settings of the policies were found.
    pub tuning: Option<Arc<Tuning>>,
    /// The shop as it is, 0, or its variant, from 1: by it known runs are found and finished ones are kept.
    pub shop: u32,
    /// Variants of the shop that are run as often.
    pub variants: Vec<VariantShop>,
    /// By what the best of the shop and its variants is selected.
    pub select: Option<Wanted>,
    /// How the warm-up of the scenario was found.
    pub warm_up: Option<Arc<WarmUp>>,
    /// The figure that matters most: the run with its median is shown.
    pub primary: Option<String>,
}

impl StudyOptions {
    /// All policies of a scenario with its number of replications and full logs of the first.
    pub fn of(scenario: &Scenario) -> Self {
        Self {
            policies: (0..scenario.policies.len()).collect(),
            replications: scenario.replications,
            threads: 0,
            until: Vec::new(),
            logged: 1,
            known: Arc::default(),
            journal: None,
            stop_after: None,
            earlier: None,
            tuning: None,
            shop: 0,
            variants: Vec::new(),
            select: None,
            warm_up: None,
            primary: None,
        }
    }

    /// Whether there is but one run, whose jobs alone tell how well its mean is known.
    pub(super) fn is_one_run(&self) -> bool {
        self.replications == 1
    }
}
