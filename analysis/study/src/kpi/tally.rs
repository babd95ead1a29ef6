//! One walk over the tables of a log: everything that the key figures divide.

use super::cell;
use toolroom_scenario::{ArrivalPattern, ProcessModel, Scenario};
use toolroom_shop::programmed_cutting_times;
use toolroom_shop::runlog::{ChangeReason, EventRow, JobOutcome, MachineState, PassRow, RunLog};

/// Sums of one machine, s unless said otherwise.
#[derive(Clone, Debug, Default)]
pub(super) struct MachineTally {
    states: [f64; MachineState::ALL.len()],
    /// Time in shift: what the states leave of the window, exact where no shift ends.
    planned_busy_time: f64,
    /// Programmed time (cutting and handling) of the operations produced: PRI · PQ.
    pub planned_produced: f64,
    /// The same of the good ones: PRI · GQ.
    pub planned_good: f64,
    /// Programmed cutting time of the good ones.
    pub programmed_good: f64,
    /// Good operations, 1.
    pub good: f64,
}

impl MachineTally {
    pub fn state(&self, state: MachineState) -> f64 {
        self.states[state as usize]
    }

    pub fn planned_busy_time(&self) -> f64 {
        self.planned_busy_time
    }

    pub fn production_time(&self) -> f64 {
        self.state(MachineState::Cutting) + self.state(MachineState::Handling)
    }

    pub fn utilisation(&self) -> f64 {
        let idle = self.state(MachineState::Idle) + self.state(MachineState::Down);
        1.0 - idle / self.planned_busy_time()
    }
}

/// Sums of the shop within the window.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub window: f64,
    pub machines: Vec<MachineTally>,
    pub good: u32,
    pub scrapped: u32,
    pub scrapped_by_tool: u32,
    pub out_of_tolerance: u32,
    pub burnt: u32,
    pub scrapped_by_chatter: u32,
    /// Time in cut of passes whose stability is judged, and in an unstable cut, s.
    pub judged_time: f64,
    pub chatter_time: f64,
    /// Times that chatter set in.
    pub chatter_onsets: u32,
    pub tardy: u32,
    /// Sum of lead times, s.
    pub lead_time: f64,
    /// Sum of tardiness, s.
    pub tardiness: f64,
    /// Integral of the number of jobs, s.
    pub job_time: f64,
    /// Jobs at the start and arrived since; infinite with constant work.
    pub offered: f64,
    pub machine_cost: f64,
    pub edge_cost: f64,
    pub scrap_cost: f64,
    /// Edges used, failed, and dressing cycles, counted as they wear.
    pub edges: f64,
    pub failed_edges: f64,
    pub dressings: f64,
    /// Edges used, time in cut and path of the cell.
    pub cell_edges: f64,
    pub cell_edge_time: f64,
    pub cell_path: f64,
    /// Time in cut of wheels, s, and operations that they finished.
    pub wheel_time: f64,
    pub wheel_parts: f64,
    /// J.
    pub energy: f64,
}

/// Share of `start..end` that lies at or after `from`.
fn share_after(from: f64, start: f64, end: f64) -> f64 {
    if start >= from {
        1.0
    } else if end <= from {
        0.0
    } else {
        (end - from) / (end - start)
    }
}

impl Tally {
    pub fn new(scenario: &Scenario, log: &RunLog) -> Self {
        let mut tally = Self {
            window: log.horizon - scenario.warm_up,
            machines: vec![MachineTally::default(); scenario.machines.len()],
            ..Self::default()
        };
        tally.add_states(scenario, log);
        tally.add_operations(scenario, log);
        tally.add_jobs(scenario, log);
        tally.add_edges(scenario, log);
        let onset = |event: &&EventRow| event.event == "chatter_onset" && event.time >= scenario.warm_up;
        tally.chatter_onsets = log.events.iter().filter(onset).count() as u32;
        tally
    }

    /// Shifts worked: working time of the machine longest in shift over the length of a shift.
    pub fn shifts(&self, scenario: &Scenario) -> f64 {
        let longest = self.machines.iter().map(MachineTally::planned_busy_time).fold(0.0, f64::max);
        if longest > 0.0 { longest / scenario.shift_length } else { f64::NAN }
    }

    /// Good and scrapped parts.
    pub fn finished(&self) -> f64 {
        f64::from(self.good + self.scrapped)
    }

    pub fn sum(&self, of: fn(&MachineTally) -> f64) -> f64 {
        self.machines.iter().map(of).sum()
    }

    /// Over the machines that were in shift at all.
    pub fn mean_utilisation(&self) -> f64 {
        let used = || self.machines.iter().map(MachineTally::utilisation).filter(|share| share.is_finite());
        used().sum::<f64>() / used().count() as f64
    }

    /// Cutting and tool change time of the cell over the programmed time of its good operations.
    pub fn cell_time_ratio(&self, scenario: &Scenario) -> f64 {
        let sum = |of: fn(&MachineTally) -> f64| -> f64 { cell(scenario).iter().map(|&m| of(&self.machines[m])).sum() };
        sum(|m| m.state(MachineState::Cutting) + m.state(MachineState::ToolChange)) / sum(|m| m.programmed_good)
    }

    fn add_states(&mut self, scenario: &Scenario, log: &RunLog) {
        for row in &log.states {
            let inside = (row.end - row.start.max(scenario.warm_up)).max(0.0);
            self.machines[row.machine as usize].states[row.state as usize] += inside;
        }
        for (machine, tally) in scenario.machines.iter().zip(&mut self.machines) {
            if tally.states.iter().any(|&time| time > 0.0) {
                tally.planned_busy_time = self.window - tally.state(MachineState::OffShift);
            }
            self.machine_cost += machine.rate * tally.planned_busy_time();
            self.energy += machine.idle_power * tally.planned_busy_time();
        }
    }

    /// An operation is produced when a pass of a later one of its job follows, when the job left
    /// the shop after it, or when its last pass ended before the horizon.
    fn add_operations(&mut self, scenario: &Scenario, log: &RunLog) {
        let programmed = programmed_cutting_times(scenario);
        let mut latest: Vec<Option<&PassRow>> = vec![None; log.jobs.len()];
        for row in &log.passes {
            let share = share_after(scenario.warm_up, row.start, row.end);
            self.energy += row.energy * share;
            if !row.stability_margin.is_nan() {
                self.judged_time += row.cutting_time * share;
                self.chatter_time += row.chatter_time * share;
            }
            let before = latest[row.job as usize].replace(row);
            if let Some(before) = before.filter(|before| before.operation != row.operation) {
                self.add_operation(scenario, &programmed, before, true);
            }
        }
        for (job, row) in log.jobs.iter().zip(latest) {
            let Some(row) = row else { continue };
            match job.outcome {
                JobOutcome::Good => self.add_operation(scenario, &programmed, row, true),
                JobOutcome::InProcess => {
                    let operation = &scenario.parts[row.part as usize].operations[row.operation as usize];
                    let passes = operation.work.passes();
                    if row.pass as usize + 1 == passes && row.end < log.horizon {
                        self.add_operation(scenario, &programmed, row, true);
                    }
                }
                _ => self.add_operation(scenario, &programmed, row, false),
            }
        }
    }

    fn add_operation(&mut self, scenario: &Scenario, programmed: &[Vec<f64>], last: &PassRow, good: bool) {
        if last.end < scenario.warm_up {
            return;
        }
        let machine = &scenario.machines[last.machine as usize];
        let programmed = programmed[last.part as usize][last.operation as usize];
        let planned = programmed + machine.load_time.mean() + machine.unload_time.mean();
        let tally = &mut self.machines[last.machine as usize];
        tally.planned_produced += planned;
        if good {
            tally.planned_good += planned;
            tally.programmed_good += programmed;
            tally.good += 1.0;
        }
    }

    fn add_jobs(&mut self, scenario: &Scenario, log: &RunLog) {
        for job in &log.jobs {
            let left = if job.finish.is_nan() { log.horizon } else { job.finish };
            if left < scenario.warm_up {
                continue;
            }
            self.offered += 1.0;
            self.job_time += left - job.arrival.max(scenario.warm_up);
            match job.outcome {
                JobOutcome::Good => {
                    self.good += 1;
                    self.lead_time += job.finish - job.arrival;
                    self.tardiness += (job.finish - job.due).max(0.0);
                    self.tardy += u32::from(job.finish > job.due);
                }
                JobOutcome::InProcess => {}
                outcome => {
                    self.scrapped += 1;
                    self.scrapped_by_tool += u32::from(outcome == JobOutcome::ToolFailure);
                    self.out_of_tolerance += u32::from(outcome == JobOutcome::OutOfTolerance);
                    self.burnt += u32::from(outcome == JobOutcome::Burnt);
                    self.scrapped_by_chatter += u32::from(outcome == JobOutcome::Chatter);
                    self.scrap_cost += scenario.parts[job.part as usize].material_cost;
                }
            }
        }
        if scenario.arrivals.iter().any(|arrival| matches!(arrival.pattern, ArrivalPattern::ConstantWork { .. })) {
            self.offered = f64::INFINITY;
        }
    }

    fn add_edges(&mut self, scenario: &Scenario, log: &RunLog) {
        let in_cell = {
            let mut flags = vec![false; scenario.machines.len()];
            cell(scenario).into_iter().for_each(|machine| flags[machine] = true);
            flags
        };
        // Time in cut within the window, by edge.
        let mut inside = vec![0.0; log.edges.len()];
        for row in &log.passes {
            let share = share_after(scenario.warm_up, row.start, row.end);
            inside[row.edge as usize] += row.cutting_time * share;
            let operation = &scenario.parts[row.part as usize].operations[row.operation as usize];
            if scenario.tools.get(operation.tool).is_some_and(|tool| matches!(tool.process, ProcessModel::Infeed(_))) {
                self.wheel_time += row.cutting_time * share;
                if row.pass as usize + 1 == operation.work.passes() && row.end < log.horizon {
                    self.wheel_parts += share;
                }
            }
            if in_cell[row.machine as usize] {
                self.cell_edge_time += row.cutting_time * share;
                self.cell_path += row.path * share;
            }
        }
        let mut life = vec![(0.0, 0.0); scenario.tools.len()];
        for edge in log.edges.iter().filter(|edge| edge.reason != ChangeReason::EndOfRun) {
            let (time, count) = &mut life[edge.tool as usize];
            *time += edge.cutting_time;
            *count += 1.0;
        }
        for (edge, inside) in log.edges.iter().zip(inside) {
            let tool = &scenario.tools[edge.tool as usize];
            let (time, count) = life[edge.tool as usize];
            let whole = match edge.reason {
                ChangeReason::EndOfRun if edge.cutting_time <= 0.0 => 0.0,
                ChangeReason::EndOfRun if count > 0.0 => (edge.cutting_time * count / time).min(1.0),
                _ => 1.0,
            };
            let used = if edge.cutting_time > 0.0 {
                whole * (inside / edge.cutting_time).min(1.0)
            } else {
                whole * f64::from(edge.removed >= scenario.warm_up)
            };
            self.edge_cost += used * tool.edge_cost;
            if matches!(tool.process, ProcessModel::Infeed(_)) {
                self.dressings += used;
                continue;
            }
            self.edges += used;
            if matches!(edge.reason, ChangeReason::Chipping | ChangeReason::ThermalCollapse) {
                self.failed_edges += used;
            }
            if in_cell[edge.machine as usize] {
                self.cell_edges += used;
            }
        }
    }
}
