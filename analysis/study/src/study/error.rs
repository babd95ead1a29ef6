//! Why a study or one of its runs ended early.

use crate::logs::LogError;
use std::sync::Arc;
use toolroom_scenario::Scenario;
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_shop::{RunLog, Shop, ShopError};

/// Why a study has no result.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// Nothing was requested.
    #[error("a study needs at least one replication")]
    NoReplications,
    /// Nothing to compare.
    #[error("a study needs at least one policy")]
    NoPolicies,
    /// A policy that the scenario does not have.
    #[error("there is no policy {policy}: the scenario has {count}")]
    UnknownPolicy {
        /// Index requested.
        policy: usize,
        /// Policies of the scenario.
        count: usize,
    },
    /// The warm-up has to be found before.
    #[error("the warm-up is still to be found: `run` and `compare` do that; here `warm_up` has to be a time")]
    SeeksWarmUp,
    /// The threads cannot be started.
    #[error("cannot start the threads: {source}")]
    Threads {
        /// What the thread pool said.
        source: rayon::ThreadPoolBuildError,
    },
    /// A shop stopped.
    #[error(transparent)]
    Shop(#[from] StoppedShop),
    /// A variant of the shop has no result.
    #[error("variant \"{name}\": {source}")]
    Variant {
        /// Name of the variant.
        name: String,
        /// Why.
        source: Box<StudyError>,
    },
    /// A log cannot be written.
    #[error(transparent)]
    Log(#[from] LogError),
    /// The first replication does not come out as the finished part has it.
    #[error(
        "policy `{policy}` does not repeat its first replication: the program, the machine or a file that the \
         scenario names is not what it was"
    )]
    NotRepeated {
        /// Name of the policy.
        policy: String,
    },
}

/// A run whose shop stopped before its horizon.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("policy `{name}`, replication {replication}: {source}")]
pub struct StoppedShop {
    /// Index of the policy.
    pub policy: usize,
    /// Its name.
    pub name: String,
    /// Replication, from 0.
    pub replication: u32,
    /// What happened in the shop.
    pub source: Box<ShopError>,
}

impl StoppedShop {
    /// The run once more, up to where it stopped: its log, and the reason if it stopped again.
    ///
    /// # Errors
    /// [`ShopError`] where the shop could not even be opened.
    pub fn again(&self, scenario: &Scenario) -> Result<(RunLog, Option<ShopError>), ShopError> {
        let resolved = Arc::new(ResolvedPolicy::from_scenario(scenario, self.policy)?);
        let world = scenario.drawn(self.replication)?;
        Ok(Shop::with_recorder(&world, resolved, self.replication, RunLog::default())?.run_as_far())
    }
}
