//! Shops whose work never ends: the warm-up after which they no longer remember that they began empty, and the mean of
//! one long run whose jobs depend on each other.
//!
//! | item | what it is |
//! |---|---|
//! | [`LeadTimes`] | a recorder of nothing but lead times, in batches |
//! | [`find`] | the warm-up of a shop by MSER-5, from runs of its own |
//! | [`OneRun`] | the mean lead time of one long run by batch means |
//!
//! A shop that ends by itself ([`Scenario::is_terminating`]) has neither.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod one_run;
mod warm_up;

pub use one_run::OneRun;
pub use warm_up::{Cut, MOST_RUNS, SteadyError, WarmUp, WarmUpSearch, find};

use toolroom_scenario::Scenario;
use toolroom_shop::runlog::{EdgeRow, EventRow, JobOutcome, JobRow, OperationRow, PassRow, StateRow};
use toolroom_shop::{Closing, Recorder};
use toolroom_statistics::Batched;

/// Lead times of the good jobs of a run in the order in which they leave the shop, s. Memory does not grow with the run.
#[derive(Clone, Debug)]
pub struct LeadTimes {
    /// Whether a part goes into others, by part: those do not leave the shop.
    components: Vec<bool>,
    from: f64,
    times: Batched,
}

impl LeadTimes {
    /// Of jobs that leave at or after the end of the scenario's warm-up, in batches of `size` jobs at first.
    pub fn from_scenario(scenario: &Scenario, size: u64) -> Self {
        let components = (0..scenario.parts.len()).map(|part| scenario.is_component(part)).collect();
        Self { components, from: scenario.warm_up, times: Batched::by(size) }
    }

    /// The lead times.
    pub fn times(&self) -> &Batched {
        &self.times
    }
}

impl Recorder for LeadTimes {
    fn pass(&mut self, _: PassRow) {}
    fn edge(&mut self, _: u32, _: EdgeRow) {}
    fn arrival(&mut self, _: u32, _: JobRow) {}

    fn job(&mut self, _: u32, row: JobRow) {
        if row.outcome == JobOutcome::Good && row.finish >= self.from && !self.components[row.part as usize] {
            self.times.push(row.finish - row.arrival, row.finish);
        }
    }

    fn operation(&mut self, _: OperationRow) {}
    fn state(&mut self, _: StateRow) {}
    fn event(&mut self, _: EventRow) {}
    fn close(&mut self, _: Closing) {}
}
