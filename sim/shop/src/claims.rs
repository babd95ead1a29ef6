//! Queues with exact answers, through the scenario file that is shipped.

use crate::recorder::{Closing, Recorder};
use crate::runlog::{EdgeRow, EventRow, JobRow, OperationRow, PassRow, StateRow};
use crate::{Shop, ShopError};
use std::sync::Arc;
use toolroom_process::Claim;
use toolroom_scenario::file::parse;
use toolroom_scenario::policies::ResolvedPolicy;

/// One server, random arrivals.
const QUEUE: &str = include_str!("../../../scenarios/shop/queue.toml");
/// Simulated time of a claim: two million jobs.
const LENGTH: &str = "shop.horizon=\"41667 h\"";

/// A queue whose mean stay is known.
struct Case {
    claim: &'static str,
    source: &'static str,
    changes: &'static [&'static str],
    /// Mean time in the shop, min.
    stay: f64,
    tolerance: f64,
}

/// The shipped queue at 80 % load and queues that differ from it by a word. The tolerances are some four
/// standard errors of the mean of two million correlated stays.
const CASES: &[Case] = &[
    Case {
        claim: "mean stay in M/M/1 at 80 % load, min",
        source: "Kleinrock, Queueing Systems I (1975), eq. 3.26",
        changes: &[],
        stay: 5.0,
        tolerance: 0.025,
    },
    Case {
        claim: "mean stay in M/D/1 at 80 % load, min",
        source: "Pollaczek and Khinchine: Kleinrock I, eq. 5.64",
        changes: &["part.job.operation.serve.work=\"1 min\""],
        stay: 3.0,
        tolerance: 0.015,
    },
    Case {
        claim: "mean stay in M/E4/1 at 80 % load, min",
        source: "Pollaczek and Khinchine: Kleinrock I, eq. 5.64",
        changes: &["part.job.operation.serve.work={ distribution = \"erlang\", mean = \"1 min\", k = 4 }"],
        stay: 3.5,
        tolerance: 0.015,
    },
    Case {
        claim: "mean stay in M/G/1 at 80 % load, gamma times of cv 2, min",
        source: "Pollaczek and Khinchine: Kleinrock I, eq. 5.64",
        changes: &["part.job.operation.serve.work={ distribution = \"gamma\", mean = \"1 min\", cv = 2.0 }"],
        stay: 11.0,
        tolerance: 0.05,
    },
    Case {
        claim: "mean stay in M/M/2 at 80 % load, min",
        source: "Erlang C: Kleinrock I, eq. 3.40",
        changes: &["machine.server.count=2", "arrivals.1.rate=\"96 1/h\""],
        stay: 2.777_778,
        tolerance: 0.025,
    },
    Case {
        claim: "mean stay in M/M/4 at 80 % load, min",
        source: "Erlang C: Kleinrock I, eq. 3.40",
        changes: &["machine.server.count=4", "arrivals.1.rate=\"192 1/h\""],
        stay: 1.745_541,
        tolerance: 0.025,
    },
];

/// Time that jobs stay in the shop.
#[derive(Clone, Debug, Default)]
struct Stays {
    /// Since when they count, s.
    from: f64,
    total: f64,
    count: f64,
}

impl Recorder for Stays {
    fn job(&mut self, _: u32, row: JobRow) {
        if row.arrival >= self.from && row.finish.is_finite() {
            self.total += row.finish - row.arrival;
            self.count += 1.0;
        }
    }
    fn pass(&mut self, _: PassRow) {}
    fn edge(&mut self, _: u32, _: EdgeRow) {}
    fn operation(&mut self, _: OperationRow) {}
    fn state(&mut self, _: StateRow) {}
    fn event(&mut self, _: EventRow) {}
    fn close(&mut self, _: Closing) {}
}

/// Mean stays in queues against their exact values, simulated now.
///
/// # Errors
/// [`ShopError`] where the shop stops.
///
/// # Panics
/// Where the shipped scenario is no scenario.
pub fn claims() -> Result<Vec<Claim>, ShopError> {
    std::thread::scope(|scope| {
        let running: Vec<_> = CASES.iter().map(|case| scope.spawn(|| case.checked())).collect();
        running.into_iter().map(|case| case.join().expect("a claim ends")).collect()
    })
}

impl Case {
    fn checked(&self) -> Result<Claim, ShopError> {
        let changes: Vec<String> = self.changes.iter().chain([&LENGTH]).map(|&change| change.to_owned()).collect();
        let file = parse("queue.toml", QUEUE, &changes).unwrap_or_else(|error| panic!("{}: {error}", self.claim));
        let policy = Arc::new(ResolvedPolicy::of(&file.scenario, 0)?);
        let stays = Stays { from: file.scenario.warm_up, ..Stays::default() };
        let stays = Shop::with_recorder(&file.scenario, policy, 0, stays)?.run()?;
        Ok(Claim {
            claim: self.claim.to_owned(),
            source: self.source.to_owned(),
            published: self.stay,
            computed: stays.total / stays.count / 60.0,
            tolerance: self.tolerance,
        })
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn queues_have_their_exact_mean_stays() {
        for claim in super::claims().expect("the queues run") {
            assert!(claim.pass(), "{claim:?}");
        }
    }
}
