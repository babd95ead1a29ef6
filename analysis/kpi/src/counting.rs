//! Key figures while a shop runs: a recorder whose memory does not grow with the events of the run.

use super::group_figures::group_values;
use super::machine::of_machine;
use super::tally::Tally;
use super::{cell, kpis, of_shop};
use std::collections::VecDeque;
use toolroom_scenario::Scenario;
use toolroom_shop::runlog::{
    ChangeReason, EdgeRow, EventRow, JobRow, MachineState, OperationRow, PassRow, RunLog, StateRow,
};
use toolroom_shop::{Closing, Recorder};

/// Sums of one run under way.
///
/// What it keeps beside sums: the stays of a machine since its last operation, jobs that left at this instant,
/// and a row for every edge. Jobs that leave in one instant are added in the order of their numbers, and edges
/// at the end, so that the sums do not depend on how the facts came.
#[derive(Clone, Debug)]
pub struct Counting<'a> {
    scenario: &'a Scenario,
    in_cell: Vec<bool>,
    tally: Tally,
    machines: Vec<Stays>,
    leaving: Vec<(u32, JobRow)>,
    remaining: Vec<(u32, JobRow)>,
    edges: Vec<(EdgeRow, f64)>,
    closing: Option<Closing>,
}

/// Stays and operations of a machine that are not accounted for yet.
#[derive(Clone, Debug, Default)]
struct Stays {
    /// From and to, s, of time in which a part was cut, worked on or handled.
    production: Vec<(f64, f64)>,
    /// Operations that ended after the last stay that is known.
    operations: VecDeque<OperationRow>,
    /// End of that stay, s.
    until: f64,
}

impl Stays {
    /// The share of an operation's own production time that lies in the window from the end of the warm-up to `end`, and whether it
    /// was completed in it. Stays before the operation are forgotten.
    #[inline]
    fn share(&mut self, row: &OperationRow, warm_up: f64, end: f64) -> (f64, bool) {
        let before = self.production.iter().take_while(|(_, over)| *over <= row.start).count();
        if before > 0 {
            self.production.copy_within(before.., 0);
            self.production.truncate(self.production.len() - before);
        }
        let (mut done, mut inside) = (0.0, 0.0);
        for &(start, over) in self.production.iter().take_while(|(from, _)| *from < end) {
            done += (over - start.max(row.start)).max(0.0);
            inside += (over - start.max(row.start.max(warm_up))).max(0.0);
        }
        let completed = row.end >= warm_up;
        let whole = row.time_before + done + row.time_left;
        (if whole > 0.0 { inside / whole } else { f64::from(u8::from(completed)) }, completed)
    }
}

impl<'a> Counting<'a> {
    /// At time zero.
    pub fn new(scenario: &'a Scenario) -> Self {
        let mut in_cell = vec![false; scenario.machines.len()];
        cell(scenario).into_iter().for_each(|machine| in_cell[machine] = true);
        Self {
            scenario,
            in_cell,
            tally: Tally::new(scenario),
            machines: vec![Stays::default(); scenario.machines.len()],
            leaving: Vec::new(),
            remaining: Vec::new(),
            edges: Vec::new(),
            closing: None,
        }
    }

    /// Of a run that is over, from its log.
    pub fn from_scenario(scenario: &'a Scenario, log: &RunLog) -> Self {
        let mut counting = Self::new(scenario);
        log.operations.iter().for_each(|row| counting.operation(*row));
        log.states.iter().for_each(|row| counting.state(*row));
        (0..).zip(&log.edges).for_each(|(number, row)| counting.edge(number, *row));
        log.passes.iter().for_each(|row| counting.pass(*row));
        log.events.iter().for_each(|row| counting.event(*row));
        let mut jobs: Vec<(u32, &JobRow)> = (0..).zip(&log.jobs).collect();
        jobs.sort_by(|(a, left), (b, right)| left.finish.total_cmp(&right.finish).then(a.cmp(b)));
        jobs.into_iter().for_each(|(number, row)| counting.job(number, *row));
        counting.close(Closing {
            horizon: log.horizon,
            warm_up: log.warm_up,
            digest: log.digest,
            calendar_events: log.calendar_events,
        });
        counting
    }

    /// Values of [`kpis`] in their order, SI; NaN where a figure is not defined.
    pub fn values(&self) -> Vec<f64> {
        let (scenario, tally) = (self.scenario, &self.tally);
        let shop = of_shop().map(|(_, value)| value(scenario, tally));
        let machines =
            tally.machines.iter().flat_map(|machine| of_machine(scenario).map(|(_, value)| value(tally, machine)));
        let values: Vec<f64> =
            shop.chain(machines).map(|value| if value.is_finite() { value } else { f64::NAN }).collect();
        debug_assert_eq!(values.len(), kpis(scenario).len());
        values
    }

    /// Values by part, customer and station: for every [`GroupKind`](super::GroupKind) those of its groups, of each its figures,
    /// SI; NaN where a figure is not defined.
    pub fn group_values(&self) -> Vec<f64> {
        group_values(&self.tally)
    }

    /// Edges that left a machine of the cell, in the order in which they were mounted.
    pub fn lives(&self) -> impl Iterator<Item = &EdgeRow> {
        let left = |edge: &&EdgeRow| edge.reason != ChangeReason::EndOfRun && self.in_cell[edge.machine as usize];
        self.edges.iter().map(|(edge, _)| edge).filter(left)
    }

    /// What holds for the run as a whole, when it is over.
    pub fn closing(&self) -> Option<Closing> {
        self.closing
    }

    #[cfg(test)]
    pub(super) fn tally(&self) -> &Tally {
        &self.tally
    }

    /// Adds jobs that left before now.
    fn add_leaving(&mut self) {
        if self.leaving.len() > 1 {
            self.leaving.sort_by_key(|(number, _)| *number);
        }
        for (_, row) in self.leaving.drain(..) {
            self.tally.add_job(self.scenario, &row, f64::NAN);
        }
    }

    /// Adds operations of a machine that ended by then, all of them at the end of the run.
    fn add_operations(&mut self, machine: usize, until: f64, horizon: Option<f64>) {
        let stays = &mut self.machines[machine];
        while let Some(row) = stays.operations.front().copied().filter(|row| row.end <= until || horizon.is_some()) {
            let end = if row.end.is_nan() { horizon.unwrap_or(row.end) } else { row.end };
            let (share, completed) = stays.share(&row, self.scenario.warm_up, end);
            self.tally.add_operation(&row, self.scenario.warm_up, share, completed);
            stays.operations.pop_front();
        }
    }
}

impl Recorder for Counting<'_> {
    fn pass(&mut self, row: PassRow) {
        let inside = self.tally.add_pass(self.scenario, &row, self.in_cell[row.machine as usize]);
        self.edges[row.edge as usize].1 += inside;
    }

    fn edge(&mut self, number: u32, row: EdgeRow) {
        match self.edges.get_mut(number as usize) {
            Some((edge, _)) => *edge = row,
            None => self.edges.push((row, 0.0)),
        }
    }

    #[inline]
    fn arrival(&mut self, _: u32, _: JobRow) {}

    #[inline]
    fn job(&mut self, number: u32, row: JobRow) {
        if row.finish.is_nan() {
            self.remaining.push((number, row));
            return;
        }
        match self.leaving.as_mut_slice() {
            [(only, last)] if last.finish != row.finish => {
                self.tally.add_job(self.scenario, last, f64::NAN);
                (*only, *last) = (number, row);
            }
            [.., (_, last)] if last.finish != row.finish => {
                self.add_leaving();
                self.leaving.push((number, row));
            }
            _ => self.leaving.push((number, row)),
        }
    }

    #[inline]
    fn operation(&mut self, row: OperationRow) {
        let stays = &mut self.machines[row.machine as usize];
        if stays.operations.is_empty() && row.end <= stays.until {
            let (share, completed) = stays.share(&row, self.scenario.warm_up, row.end);
            self.tally.add_operation(&row, self.scenario.warm_up, share, completed);
        } else {
            stays.operations.push_back(row);
        }
    }

    #[inline]
    fn state(&mut self, row: StateRow) {
        self.tally.add_state(self.scenario, &row);
        let machine = row.machine as usize;
        let stays = &mut self.machines[machine];
        stays.until = row.end;
        if matches!(row.state, MachineState::Cutting | MachineState::Working | MachineState::Handling) {
            stays.production.push((row.start, row.end));
        }
        if !stays.operations.is_empty() {
            self.add_operations(machine, row.end, None);
        }
    }

    #[inline]
    fn event(&mut self, row: EventRow) {
        self.tally.add_event(self.scenario, &row);
    }

    fn close(&mut self, closing: Closing) {
        self.closing = Some(closing);
        for machine in 0..self.machines.len() {
            self.add_operations(machine, closing.horizon, Some(closing.horizon));
        }
        self.add_leaving();
        self.remaining.sort_by_key(|(number, _)| *number);
        for (_, row) in std::mem::take(&mut self.remaining) {
            self.tally.add_job(self.scenario, &row, closing.horizon);
        }
        self.tally.close_machines(self.scenario, closing.horizon);
        self.tally.add_edges(self.scenario, &self.edges, &self.in_cell);
    }
}
