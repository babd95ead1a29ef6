//! Trials of settings: what all searches share, settings that are tried, and what a replication of them gives.

use super::{Objective, TriedRun};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use toolroom_kpi::{Counting, unless_stopped};
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_scenario::{Scenario, TuneRequest};
use toolroom_shards::Journal;
use toolroom_shop::runlog::ChangeReason;
use toolroom_shop::{Shop, ShopError};

/// What all rules have in common.
pub(super) struct Search<'a> {
    /// The scenario with the seed of the tuning.
    pub scenario: &'a Scenario,
    pub request: &'a TuneRequest,
    /// Simulates a replication; `None` where the user stopped it.
    pub simulate: &'a Simulate<'a>,
    /// −1 where more of the objective is better, else 1.
    pub sign: f64,
    /// From SI to the unit of files.
    pub scale: f64,
    pub pool: &'a rayon::ThreadPool,
    /// Told how many more runs are done.
    pub progress: &'a (dyn Fn(u32) + Sync),
    /// Replications that an earlier search simulated.
    pub known: BTreeMap<Trial, Run>,
    /// Where finished replications are written.
    pub journal: Option<&'a Journal<TriedRun>>,
}

/// What a replication is of: name of the policy, word of its rule of tool change, bits of its settings, number of the
/// replication.
pub(super) type Trial = (String, String, Vec<u64>, u32);

/// Who simulates.
type Simulate<'a> = dyn Fn(&Asked<'_>) -> Result<Option<Run>, ShopError> + Sync + 'a;

/// One replication at settings.
pub(super) struct Asked<'a> {
    pub point: &'a Point,
    pub replication: u32,
}

/// One replication.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    /// Less is better; infinite where it is not defined.
    pub objective: f64,
    pub edges: u32,
    pub collapsed: u32,
    pub failed: u32,
}

/// Settings that are tried.
pub(super) struct Point {
    /// One value an axis, SI.
    pub values: Vec<f64>,
    pub policy: Arc<ResolvedPolicy>,
    pub runs: Vec<Run>,
}

impl TriedRun {
    pub(super) fn known(self) -> (Trial, Run) {
        let Self { policy, change, settings, replication, objective, edges, collapsed, failed } = self;
        (
            (policy, change, settings, replication),
            Run { objective: f64::from_bits(objective), edges, collapsed, failed },
        )
    }

    pub(super) fn from_change((policy, change, settings, replication): Trial, run: Run) -> Self {
        let Run { objective, edges, collapsed, failed } = run;
        Self { policy, change, settings, replication, objective: objective.to_bits(), edges, collapsed, failed }
    }
}

impl Run {
    /// Simulates in a shop; `None` where the user stopped it.
    pub fn simulated(
        scenario: &Scenario,
        objective: Objective,
        stop: &AtomicBool,
        asked: &Asked<'_>,
    ) -> Result<Option<Self>, ShopError> {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        let world = scenario.drawn(asked.replication).map_err(ShopError::from)?;
        let counting = Counting::new(scenario);
        let shop = Shop::with_recorder(&world, Arc::clone(&asked.point.policy), asked.replication, counting)?;
        let Some(counting) = unless_stopped(shop, stop)? else { return Ok(None) };
        let value = objective.sign * counting.values()[objective.index];
        let mut run = Self {
            objective: if value.is_finite() { value } else { f64::INFINITY },
            edges: 0,
            collapsed: 0,
            failed: 0,
        };
        for edge in counting.lives() {
            let collapsed = edge.reason == ChangeReason::ThermalCollapse;
            run.edges += 1;
            run.collapsed += u32::from(collapsed);
            run.failed += u32::from(collapsed || edge.reason == ChangeReason::Chipping);
        }
        Ok(Some(run))
    }
}
