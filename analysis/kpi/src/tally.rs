//! Everything that the key figures divide: sums to which every fact of a run is added once.

use super::cell;
use super::delivery::Delivery;
use super::groups::{GoodJob, Groups};
use super::machine_tally::MachineTally;
use toolroom_scenario::{ArrivalPattern, Operation, ProcessModel, Scenario, ShiftCalendar, WorkPer};
use toolroom_shop::programmed_cutting_times;
use toolroom_shop::runlog::{
    ChangeReason, EdgeRow, EventRow, JobOutcome, JobRow, LogEvent, MachineState, OperationResult, OperationRow,
    PassRow, StateRow,
};

/// What is planned of an operation.
#[derive(Clone, Copy, Debug)]
struct Planned {
    /// Programmed time in cut, s.
    programmed: f64,
    /// The same with the mean time of plain work, s.
    work: f64,
    /// Mean time of plain work, s.
    plain: f64,
    /// Whether plain work is done once for all pieces that move together.
    once: bool,
    /// The first machine that may do it.
    machine: usize,
    /// Whether a wheel does it.
    ground: bool,
}

/// Sums of the shop within the window.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    pub window: f64,
    /// Whether a part goes into others, by part.
    components: Vec<bool>,
    /// By part and operation.
    planned: Vec<Vec<Planned>>,
    /// What the work of one piece takes, s, by part.
    raw_times: Vec<f64>,
    /// Whether a part is an edge that is ground anew, by part.
    regrinds: Vec<bool>,
    /// Mean time of loading and unloading, s, by machine.
    handling: Vec<f64>,
    /// Whether a machine has a calendar.
    calendars: Vec<bool>,
    /// Whether crews repair all breakdowns of a machine.
    crewed: Vec<bool>,
    pub machines: Vec<MachineTally>,
    /// Good parts.
    pub good: u32,
    /// Lead times, tardiness and orders.
    pub delivery: Delivery,
    /// Sums by part, customer and station.
    pub groups: Groups,
    /// Finished pieces that go into other parts.
    pub built: u32,
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
    /// Integral of the number of jobs, s.
    pub job_time: f64,
    /// Jobs at the start and arrived since; infinite with constant work.
    pub offered: f64,
    pub machine_cost: f64,
    /// People, as far as they have a rate of their own.
    pub people_cost: f64,
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
    /// Way of the edges against the work in the cell, in turning and in milling.
    pub cell_speed: Speed,
    pub turning_speed: Speed,
    pub milling_speed: Speed,
    /// Path of the mills along the feed, m.
    pub milling_path: f64,
    /// Time in cut of wheels, s.
    pub wheel_time: f64,
    /// J.
    pub energy: f64,
}

/// Cutting speed integrated over the time in engagement.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Speed {
    /// m.
    length: f64,
    /// s.
    pub time: f64,
}

impl Speed {
    fn add(&mut self, row: &PassRow, share: f64) {
        self.length += row.cutting_length * share;
        self.time += row.engaged_time * share;
    }

    /// Mean, m/s; NaN where nothing was cut.
    pub fn mean(&self) -> f64 {
        self.length / self.time
    }
}

/// Share of `start..end` that lies at or after `from`.
#[inline]
fn share_after(from: f64, start: f64, end: f64) -> f64 {
    if start >= from {
        1.0
    } else if end <= from {
        0.0
    } else {
        (end - from) / (end - start)
    }
}

/// Whether a machine breaks down, and crews repair all its breakdowns.
fn has_crew(scenario: &Scenario, machine: usize) -> bool {
    let mut own = scenario.failures.iter().filter(|failure| failure.machine == machine).peekable();
    own.peek().is_some() && own.all(|failure| failure.crew.is_some())
}

/// The calendar of a machine.
fn calendar(scenario: &Scenario, machine: usize) -> Option<&ShiftCalendar> {
    scenario.machines[machine].calendar.map(|index| &scenario.calendars[index])
}

/// A sum whose last digit does not hang on the order of the machines in the file.
fn sum_in_any_order(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values.into_iter().sum()
}

impl Tally {
    pub fn new(scenario: &Scenario) -> Self {
        let components = (0..scenario.parts.len()).map(|part| scenario.is_component(part)).collect();
        let groups = Groups::new(scenario);
        let planned = |(operation, programmed): (&Operation, f64)| {
            let tool = operation.tool.and_then(|tool| scenario.tools.get(tool));
            let ground = tool.is_some_and(|tool| matches!(tool.process, ProcessModel::Infeed(_)));
            let machine = operation.machines[0];
            let plain = operation.mean_time_on(machine);
            let once = operation.work_per != WorkPer::Part;
            let work = programmed + operation.work.plain_time();
            Planned { programmed, work, plain, once, machine, ground }
        };
        let parts = scenario.parts.iter().zip(programmed_cutting_times(scenario));
        let machines = &scenario.machines;
        let mut tally = Self {
            components,
            planned: parts.map(|(part, times)| part.operations.iter().zip(times).map(planned).collect()).collect(),
            regrinds: (0..scenario.parts.len()).map(|part| scenario.is_regrind(part)).collect(),
            handling: machines.iter().map(|machine| machine.load_time.mean() + machine.unload_time.mean()).collect(),
            calendars: machines.iter().map(|machine| machine.calendar.is_some()).collect(),
            delivery: Delivery::new(scenario),
            crewed: (0..machines.len()).map(|machine| has_crew(scenario, machine)).collect(),
            groups,
            machines: vec![MachineTally::default(); machines.len()],
            ..Self::default()
        };
        tally.raw_times = (0..scenario.parts.len()).map(|part| tally.work_time(part, 1)).collect();
        tally
    }

    /// Operations that wheels did, by their part in the window.
    pub fn wheel_parts(&self) -> f64 {
        self.sum(|machine| machine.wheel_parts)
    }

    /// A failure or the onset of chatter counts.
    #[inline]
    pub fn add_event(&mut self, scenario: &Scenario, row: &EventRow) {
        // What is not of a machine, arrivals for example, is not looked at further.
        let Some(machine) = row.machine else { return };
        let tally = &mut self.machines[machine as usize];
        if self.crewed[machine as usize] {
            if row.event == LogEvent::Failure {
                tally.calls.push_back(row.time);
            } else if row.event == LogEvent::RepairStart {
                let waited = tally.calls.pop_front().map_or(0.0, |call| row.time - call);
                if row.time >= scenario.warm_up {
                    tally.crew_wait += waited;
                    tally.repairs_begun += 1.0;
                }
            }
        }
        if row.time < scenario.warm_up {
            return;
        }
        if row.event == LogEvent::Failure {
            tally.failures += 1.0;
        }
        self.chatter_onsets += u32::from(row.event == LogEvent::ChatterOnset);
    }

    /// Shifts worked: working time of the machine longest in shift over the length of a shift.
    pub fn shifts(&self, scenario: &Scenario) -> f64 {
        let longest = self.machines.iter().map(MachineTally::planned_busy_time).fold(0.0, f64::max);
        if longest > 0.0 { longest / scenario.shift_length } else { f64::NAN }
    }

    /// Good and scrapped parts, and components that were built into others.
    pub fn finished(&self) -> f64 {
        f64::from(self.good + self.built + self.scrapped)
    }

    pub fn sum(&self, of: fn(&MachineTally) -> f64) -> f64 {
        sum_in_any_order(self.machines.iter().map(of))
    }

    /// Over the machines that were in shift at all.
    pub fn mean_utilisation(&self) -> f64 {
        let used = || self.machines.iter().map(MachineTally::utilisation).filter(|share| share.is_finite());
        sum_in_any_order(used()) / used().count() as f64
    }

    /// Cutting and tool change time of the cell over the programmed time of its good operations.
    pub fn cell_time_ratio(&self, scenario: &Scenario) -> f64 {
        let sum =
            |of: fn(&MachineTally) -> f64| sum_in_any_order(cell(scenario).iter().map(|&m| of(&self.machines[m])));
        sum(|m| m.state(MachineState::Cutting) + m.state(MachineState::ToolChange)) / sum(|m| m.programmed_good)
    }

    /// Planned busy time comes from the calendar alone, whatever the machine does; what it works
    /// beyond the end of a shift is added.
    #[inline]
    pub fn add_state(&mut self, scenario: &Scenario, row: &StateRow) {
        if row.end <= scenario.warm_up {
            return;
        }
        let from = row.start.max(scenario.warm_up);
        let inside = row.end - from;
        let tally = &mut self.machines[row.machine as usize];
        if row.in_shift {
            tally.states[row.state as usize] += inside;
            if self.calendars[row.machine as usize]
                && let Some(calendar) = calendar(scenario, row.machine as usize)
            {
                tally.planned_busy_time += inside - calendar.working_time(from, row.end);
            }
            if row.state == MachineState::Maintenance {
                tally.planned_busy_time -= inside; // no time for production
            }
            return;
        }
        tally.states[MachineState::OffShift as usize] += inside;
        if row.state == MachineState::Down {
            tally.repair_off_shift += inside;
        }
    }

    /// What the calendars plan until the end of the run, and what that costs.
    pub fn close_machines(&mut self, scenario: &Scenario, horizon: f64) {
        self.window = horizon - scenario.warm_up;
        for (index, machine) in scenario.machines.iter().enumerate() {
            let tally = &mut self.machines[index];
            tally.planned_busy_time += calendar(scenario, index)
                .map_or(self.window, |calendar| calendar.working_time(scenario.warm_up, horizon));
            self.machine_cost += machine.rate * tally.planned_busy_time();
            self.energy += machine.idle_power * tally.planned_busy_time();
        }
        let people = scenario.operators.iter().map(|person| (person.calendar, person.rate));
        let crews = scenario.crews.iter().map(|crew| (crew.calendar, f64::from(crew.count) * crew.rate));
        for (calendar, rate) in people.chain(crews) {
            let calendar = calendar.map(|index| &scenario.calendars[index]);
            let paid = calendar.map_or(self.window, |calendar| calendar.working_time(scenario.warm_up, horizon));
            self.people_cost += rate * paid;
        }
        if scenario.arrivals.iter().any(|arrival| matches!(arrival.pattern, ArrivalPattern::ConstantWork { .. })) {
            self.offered = f64::INFINITY;
        }
        if scenario.tools.is_empty() {
            // Where nothing is cut, these are no figures.
            (self.edges, self.failed_edges, self.dressings) = (f64::NAN, f64::NAN, f64::NAN);
        }
    }

    /// A pass; its time in cut within the window, s.
    pub fn add_pass(&mut self, scenario: &Scenario, row: &PassRow, in_cell: bool) -> f64 {
        let share = share_after(scenario.warm_up, row.start, row.end);
        self.energy += row.energy * share;
        if !row.stability_margin.is_nan() {
            self.judged_time += row.cutting_time * share;
            self.chatter_time += row.chatter_time * share;
        }
        let operation = &scenario.parts[row.part as usize].operations[row.operation as usize];
        let process = operation.tool.and_then(|tool| scenario.tools.get(tool)).map(|tool| &tool.process);
        if matches!(process, Some(ProcessModel::Infeed(_))) {
            self.wheel_time += row.cutting_time * share;
        }
        match process.map(ProcessModel::name) {
            Some("turning") => self.turning_speed.add(row, share),
            Some("milling") => {
                self.milling_speed.add(row, share);
                self.milling_path += row.path * share;
            }
            _ => {}
        }
        if in_cell {
            self.cell_speed.add(row, share);
            self.cell_edge_time += row.cutting_time * share;
            self.cell_path += row.path * share;
        }
        row.cutting_time * share
    }

    /// An operation earns its planned time by the share of its own production time
    /// that lies in the window; the quantities count what is completed in it. What an interruption undid took
    /// time and earns nothing.
    #[inline]
    pub fn add_operation(&mut self, row: &OperationRow, warm_up: f64, share: f64, completed: bool) {
        let Planned { programmed, work, ground, .. } = self.planned[row.part as usize][row.operation as usize];
        let pieces = f64::from(row.quantity);
        let planned = row.work * work + pieces * self.handling[row.machine as usize];
        let tally = &mut self.machines[row.machine as usize];
        if row.result == OperationResult::Lost {
            return;
        }
        if row.start >= warm_up {
            tally.begun += 1.0;
            tally.waited += row.waited;
        }
        tally.earned += planned * share;
        if ground {
            tally.wheel_parts += share;
        }
        if matches!(row.result, OperationResult::Good | OperationResult::InProcess) {
            tally.programmed_good += programmed * share;
        }
        if completed {
            tally.planned_produced += planned;
            if row.result == OperationResult::Good {
                tally.planned_good += planned;
                tally.good += pieces;
            }
        }
    }

    /// What the work of a job takes on the first machine of every operation, s: without setup, waiting and what is done again.
    fn raw_time(&self, job: &JobRow) -> f64 {
        // Jobs of one piece take always the same.
        if job.quantity == 1 {
            self.raw_times[job.part as usize]
        } else {
            self.work_time(job.part as usize, job.quantity)
        }
    }

    /// What the work of so many pieces of a part takes, s.
    fn work_time(&self, part: usize, pieces: u32) -> f64 {
        let pieces = f64::from(pieces);
        let time = |own: &Planned| {
            let plain = if own.once { own.plain } else { pieces * own.plain };
            plain + pieces * (own.programmed + self.handling[own.machine])
        };
        self.planned[part].iter().map(time).sum()
    }

    /// A job that has left the shop, or is in it at the horizon.
    pub fn add_job(&mut self, scenario: &Scenario, job: &JobRow, horizon: f64) {
        let left = if job.finish.is_nan() { horizon } else { job.finish };
        if left < scenario.warm_up {
            return;
        }
        if self.regrinds[job.part as usize] {
            return; // edges are no parts
        }
        let component = self.components[job.part as usize];
        self.offered += if component { 0.0 } else { f64::from(job.quantity) };
        let inside = left - job.arrival.max(scenario.warm_up);
        self.job_time += inside;
        self.delivery.see(job);
        match job.outcome {
            // What goes into other parts does not leave the shop.
            JobOutcome::Good if component => {
                self.built += job.quantity;
                self.groups.add(job, inside, (None, [job.quantity, 0]));
            }
            JobOutcome::Good => {
                self.good += job.quantity;
                let raw_time = self.raw_time(job);
                self.delivery.add(scenario, job, raw_time);
                let weight = self.delivery.weight(scenario, job);
                self.groups.add(job, inside, (Some(&GoodJob { raw_time, weight }), [job.quantity, 0]));
            }
            JobOutcome::InProcess => self.groups.add(job, inside, (None, [0, 0])),
            outcome @ (JobOutcome::ToolFailure
            | JobOutcome::OutOfTolerance
            | JobOutcome::Burnt
            | JobOutcome::Chatter
            | JobOutcome::Rejected
            | JobOutcome::Preempted
            | JobOutcome::Breakdown
            | JobOutcome::ShiftEnd) => {
                let lost = job.quantity;
                self.groups.add(job, inside, (None, [lost, lost]));
                self.scrapped += lost;
                self.scrapped_by_tool += lost * u32::from(outcome == JobOutcome::ToolFailure);
                self.out_of_tolerance += lost * u32::from(outcome == JobOutcome::OutOfTolerance);
                self.burnt += lost * u32::from(outcome == JobOutcome::Burnt);
                self.scrapped_by_chatter += lost * u32::from(outcome == JobOutcome::Chatter);
                self.scrap_cost += f64::from(lost) * scenario.parts[job.part as usize].material_cost;
            }
        }
    }

    /// All edges, each with its time in cut within the window, s.
    pub fn add_edges(&mut self, scenario: &Scenario, edges: &[(EdgeRow, f64)], in_cell: &[bool]) {
        let mut life = vec![(0.0, 0.0); scenario.tools.len()];
        for (edge, _) in edges.iter().filter(|(edge, _)| edge.reason != ChangeReason::EndOfRun) {
            let (time, count) = &mut life[edge.tool as usize];
            *time += edge.cutting_time;
            *count += 1.0;
        }
        for &(ref edge, inside) in edges {
            let tool = &scenario.tools[edge.tool as usize];
            // An edge without passes has worked evenly while it was in its machine.
            let in_window = share_after(scenario.warm_up, edge.installed, edge.removed);
            let inside = if tool.life.is_some() { edge.cutting_time * in_window } else { inside };
            let (time, count) = life[edge.tool as usize];
            let whole = if edge.reason != ChangeReason::EndOfRun {
                1.0
            } else if edge.cutting_time <= 0.0 {
                0.0
            } else if count > 0.0 {
                (edge.cutting_time * count / time).min(1.0)
            } else {
                1.0
            };
            let used = if edge.cutting_time > 0.0 {
                whole * (inside / edge.cutting_time).min(1.0)
            } else {
                whole * f64::from(edge.removed >= scenario.warm_up)
            };
            let crib = scenario.shared.crib_of(edge.tool as usize).map(|crib| &scenario.shared.cribs[crib]);
            let regrind = crib.and_then(|crib| crib.regrind.as_ref()).filter(|_| edge.ground > 0);
            self.edge_cost += used * regrind.map_or(tool.edge_cost, |own| own.cost);
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
                if tool.life.is_some() {
                    self.cell_edge_time += inside;
                }
            }
        }
    }
}
