//! What the engine looks up again and again, resolved once for a scenario.

use super::error::ShopError;
use super::forward_only;
use super::job::Jobs;
use super::machine_plan::MachinePlan;
use super::operation_plan::{ContentPlan, OperationPlan, Passes};
use super::owners;
use super::quick_machines;
use super::readiness::Readiness;
use toolroom_cuts::tool_plan::{ToolPlan, cut_duration, phase_duration};
use toolroom_kernel::Entity;
use toolroom_scenario::policies::ResolveError;
use toolroom_scenario::{
    ArrivalPattern, DrawUnit, GrindingPhase, Hold, Interruption, KeyTime, MachineType, Operation, Part, Preemption,
    Presence, ReleaseRule, Scenario, SetupMatrix, Work, WorkPer,
};

/// Tables that follow from the scenario alone.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// By tool.
    pub tools: Vec<ToolPlan>,
    /// By part, by operation.
    pub operations: Vec<Vec<OperationPlan>>,
    /// Time in cut as programmed, s, by part, by operation.
    pub cutting_times: Vec<Vec<f64>>,
    /// Time of every pass as programmed, s, by part, by operation.
    pub pass_times: Vec<Vec<Vec<f64>>>,
    /// Expected time of plain work, s, by part, by operation, where rules know no other; else empty.
    pub expected: Vec<Vec<f64>>,
    /// Stations that share a machine with a station, itself included, by station.
    pub overlapping: Vec<Vec<u32>>,
    /// Whether any queue looks at the work that waits for the next operation.
    pub looks_ahead: bool,
    /// Whether a part goes into others, by part.
    pub components: Vec<bool>,
    /// Machines at which a part is built in, by part.
    pub takes: Vec<Vec<u32>>,
    /// Failure modes of every machine.
    pub modes_of: Vec<Vec<u32>>,
    /// Who draws for every failure mode.
    pub mode_owners: Vec<Entity>,
    /// Planned maintenance of every machine.
    pub upkeep_of: Vec<Vec<u32>>,
    /// Who draws for every planned maintenance.
    pub upkeep_owners: Vec<Entity>,
    /// Crib of every tool.
    pub crib_of: Vec<Option<usize>>,
    /// Names of setup groups, by number.
    groups: Vec<String>,
    /// Row and column of every setup group in every setup matrix.
    matrix_places: Vec<Vec<Option<usize>>>,
    /// Name of every machine with every tool, which owns the edges of the tool on the machine and the structure about them.
    pub tool_owners: Vec<Vec<Entity>>,
    /// Owner of the jobs of every source.
    pub sources: Vec<Entity>,
    /// Whether nothing has a scope or a target: no calibration, no deviation, no entry of a tool.
    pub as_planned: bool,
    /// Most operations of a part that has plain work.
    pub plain_operations: usize,
    /// Whether any machine's time of loading or unloading is random.
    pub random_handling: bool,
    /// Mean times of loading and unloading, s, by machine.
    pub handling: Vec<[f64; 2]>,
    /// Machines as they choose and begin.
    pub machine_plans: Vec<MachinePlan>,
    /// Whether machines with queues are all that there is: what nobody uses is not asked for after every instant.
    pub bare: bool,
    /// Whether work goes slower or faster in any shift.
    pub uneven: bool,
    /// Whether pieces pass by any operation.
    pub samples: bool,
    /// Whether fixtures travel with jobs, which may then wait for each other.
    pub travels: bool,
    /// Rows of the schedule of every source in the order of time.
    pub schedules: Vec<Vec<usize>>,
}

impl Layout {
    pub fn of(scenario: &Scenario) -> Result<Self, ShopError> {
        check(scenario)?;
        let tools: Vec<ToolPlan> =
            scenario.tools.iter().map(|tool| ToolPlan::from_process_model(&tool.process)).collect();
        let pass_times = programmed_pass_times(scenario, &tools);
        let programmed = totals(&pass_times);
        let mut groups: Vec<String> = Vec::new();
        let mut stations: Vec<Vec<usize>> = Vec::new();
        let mut first_pass = 0;
        let mut operations: Vec<Vec<OperationPlan>> = Vec::new();
        for part in &scenario.parts {
            let mut plans: Vec<OperationPlan> = Vec::new();
            for operation in &part.operations {
                let group = operation.setup_group.as_str();
                let setup_group = groups.iter().position(|each| each == group).unwrap_or_else(|| {
                    groups.push(group.to_owned());
                    groups.len() - 1
                });
                let machine = &scenario.machines[operation.machines[0]];
                let cutting_time = programmed[operations.len()][plans.len()];
                let content = operation.tool.map_or(ContentPlan::Plain, |tool| {
                    let passes = Passes { passes: operation.work.passes() as u32, first_pass };
                    first_pass += passes.passes;
                    ContentPlan::Machining { tool: tool as u32, passes }
                });
                let mut machines = operation.machines.clone();
                machines.sort_unstable();
                let station = stations.iter().position(|each| *each == machines).unwrap_or_else(|| {
                    stations.push(machines);
                    stations.len() - 1
                });
                plans.push(OperationPlan {
                    content,
                    setup_group: setup_group as u32,
                    work_per: operation.work_per,
                    station: station as u32,
                    known_time: machine.load_time.mean() + cutting_time + machine.unload_time.mean(),
                    only_machine: if let [only] = operation.machines[..] { Some(only as u32) } else { None },
                    setup_time: operation.setup_time,
                    random_setup: operation.setup_spread.is_some(),
                    paced: !operation.time_on.is_empty(),
                    own_times: operation.has_own_times(),
                    stretched: operation.worn_tool.is_some()
                        || matches!(operation.attendance.presence, Presence::First(_)),
                    apart: operation.draw == DrawUnit::Part || operation.inspection.passes_by(),
                    assembles: operation.assembles,
                    inspected: !operation.inspection.outcomes.is_empty(),
                });
            }
            operations.push(plans);
        }
        // A machine may stand ready for a group that no operation has: its setup matrix has a row for that.
        for group in scenario.machines.iter().filter_map(|machine| machine.setup_at_start.as_ref()) {
            if !group.is_empty() && !groups.contains(group) {
                groups.push(group.clone());
            }
        }
        let places = |matrix: &SetupMatrix| groups.iter().map(|group| matrix.group(group)).collect();
        let matrix_places = scenario.setup_matrices.iter().map(places).collect();
        let shared = |own: &Vec<usize>| {
            let shares = |(_, other): &(u32, &Vec<usize>)| own.iter().any(|machine| other.contains(machine));
            (0..).zip(&stations).filter(shares).map(|(station, _)| station).collect()
        };
        let overlapping = stations.iter().map(shared).collect();
        let before = scenario.branch.iter().flat_map(|branch| branch.rules.iter().flatten());
        let control = &scenario.control;
        let cards = control
            .loops
            .iter()
            .flat_map(|own| &own.rules)
            .chain(scenario.dispatch.iter().filter(|_| !control.loops.is_empty()));
        let sequence = match &control.release {
            ReleaseRule::Workload { sequence, .. } => sequence.as_slice(),
            ReleaseRule::Immediate | ReleaseRule::AtDate { .. } => &[],
        };
        let queues = (0..scenario.machines.len()).flat_map(|machine| scenario.rules(machine));
        let mut rules = queues.chain(before).chain(cards).chain(sequence);
        let looks_ahead = rules.any(|rule| rule.looks_ahead());
        let machines: Vec<Entity> = scenario.machines.iter().map(|machine| Entity::named(&machine.name)).collect();
        let (modes_of, mode_owners) = owners::of_failures(scenario, &machines);
        let (upkeep_of, upkeep_owners) = owners::of_maintenance(scenario, &machines);
        let crib_of = (0..scenario.tools.len()).map(|tool| scenario.shared.crib_of(tool)).collect();
        let mut assembles = vec![false; scenario.machines.len()];
        let components = (0..scenario.parts.len()).map(|part| scenario.is_component(part)).collect();
        let mut takes: Vec<Vec<u32>> = vec![Vec::new(); scenario.parts.len()];
        for part in &scenario.parts {
            for &machine in part.operations.iter().filter(|own| own.assembles).flat_map(|own| &own.machines) {
                assembles[machine] = true;
                part.components.iter().for_each(|component| takes[component.part].push(machine as u32));
            }
        }
        let sources = (0..scenario.arrivals.len()).map(|source| source_entity(scenario, "job", source)).collect();
        let as_planned = scenario.deviations.is_empty()
            && scenario.calibrations.is_empty()
            && scenario.tools.iter().all(|tool| !tool.variants.has_scopes());
        let random = |machine: &MachineType| !(machine.load_time.is_constant() && machine.unload_time.is_constant());
        let random_handling = scenario.machines.iter().any(random);
        let handling: Vec<[f64; 2]> =
            scenario.machines.iter().map(|own| [own.load_time.mean(), own.unload_time.mean()]).collect();
        let alone = as_planned && scenario.operators.is_empty() && !random_handling;
        let one_step = handling
            .iter()
            .zip(modes_of.iter().zip(&upkeep_of))
            .map(|(times, (modes, upkeep))| alone && modes.is_empty() && upkeep.is_empty() && *times == [0.0; 2]);
        let one_step: Vec<bool> = one_step.collect();
        let bare = is_bare(scenario);
        let alone = quick_machines::machines(scenario, &operations, one_step.clone(), bare);
        let plan = |index: usize| {
            let kinds = [one_step[index], alone[index], alone[index] && !looks_ahead];
            MachinePlan::from_scenario(scenario, index, assembles[index], kinds)
        };
        let machine_plans = (0..scenario.machines.len()).map(plan).collect();
        let schedules = scenario.arrivals.iter().map(|arrival| in_order(&arrival.pattern)).collect();
        let means = |part: &Part| part.operations.iter().map(|own| own.work.plain_time()).collect();
        let expected = match control.keys.time {
            KeyTime::Drawn => Vec::new(),
            KeyTime::Expected => scenario.parts.iter().map(means).collect(),
        };
        let plain = |part: &&Part| part.operations.iter().any(|each| matches!(each.work, Work::Plain(_)));
        let plain_operations = scenario.parts.iter().filter(plain).map(|part| part.operations.len()).max().unwrap_or(0);
        Ok(Self {
            tools,
            operations,
            cutting_times: programmed,
            pass_times,
            expected,
            overlapping,
            looks_ahead,
            components,
            takes,
            modes_of,
            mode_owners,
            upkeep_of,
            upkeep_owners,
            crib_of,
            matrix_places,
            groups,
            tool_owners: owners::of_tools(scenario),
            sources,
            as_planned,
            plain_operations,
            random_handling,
            handling,
            machine_plans,
            bare,
            uneven: scenario.calendars.iter().any(|calendar| !calendar.paces.is_even()),
            samples: scenario.parts.iter().flat_map(|part| &part.operations).any(|own| own.inspection.passes_by()),
            travels: travels(scenario),
            schedules,
        })
    }
}

impl Layout {
    /// Time of an operation of a job as rules see it, s: mean handling on its first machine with the
    /// programmed passes, or with the plain work that was drawn for the job or is expected of it.
    #[inline]
    pub fn time(&self, jobs: &Jobs, slot: u32, part: usize, operation: usize) -> f64 {
        let expected = self.expected.get(part).map(|own| own[operation]);
        self.time_with(jobs, (slot, part, operation), expected)
    }

    /// The same with the plain work that was drawn for the job, whatever rules know.
    pub fn drawn_time(&self, jobs: &Jobs, slot: u32, part: usize, operation: usize) -> f64 {
        self.time_with(jobs, (slot, part, operation), None)
    }

    /// The same with this time of plain work, where there is one.
    #[inline]
    pub fn time_with(&self, jobs: &Jobs, (slot, part, operation): (u32, usize, usize), work: Option<f64>) -> f64 {
        let plan = &self.operations[part][operation];
        match plan.content {
            ContentPlan::Plain => {
                let drawn = work.unwrap_or_else(|| jobs.drawn(slot, operation));
                time_of(plan, f64::from(jobs.at(slot).row.quantity), drawn)
            }
            ContentPlan::Machining { .. } => plan.known_time,
        }
    }

    /// Setup that a machine needs for a setup group, s; `None` where it needs none. `usual` is the time of machine
    /// or operation, which a setup matrix of the machine replaces.
    #[inline]
    pub fn setup(&self, scenario: &Scenario, machine: usize, ready: Readiness, group: u32, usual: f64) -> Option<f64> {
        let Some(index) = self.machine_plans[machine].setup_matrix else {
            return if ready.suits(group) { None } else { Some(usual) };
        };
        let (matrix, places) = (&scenario.setup_matrices[index as usize], &self.matrix_places[index as usize]);
        let to = places[group as usize]?;
        let time = match ready {
            Readiness::Anything => return None,
            Readiness::Nothing => matrix.first.as_ref().map(|times| times[to]),
            Readiness::Group(from) => places[from as usize].map(|from| matrix.times[from][to]),
        };
        time.filter(|time| *time > 0.0)
    }

    /// For what a machine stands ready at the start that names a setup group, an empty one for none.
    pub fn readiness(&self, at_start: Option<&str>) -> Readiness {
        match at_start {
            None => Readiness::Anything,
            Some(name) => match self.groups.iter().position(|group| group == name) {
                Some(group) => Readiness::Group(group as u32),
                None => Readiness::Nothing,
            },
        }
    }

    /// Passes of an operation.
    ///
    /// # Panics
    /// Where its work is plain: only what belongs to passes asks.
    pub fn passes(&self, part: usize, operation: usize) -> Passes {
        match self.operations[part][operation].content {
            ContentPlan::Machining { passes, .. } => passes,
            ContentPlan::Plain => unreachable!("plain work has no passes"),
        }
    }
}

/// Time of an operation with plain work for so many pieces, when its work takes `drawn` a piece or once, s.
#[inline]
pub(super) fn time_of(plan: &OperationPlan, pieces: f64, drawn: f64) -> f64 {
    match plan.work_per {
        WorkPer::Part => (plan.known_time + drawn) * pieces,
        WorkPer::Lot | WorkPer::Batch => plan.known_time * pieces + drawn,
    }
}

/// Rows of a schedule by time; equal times keep the order of the file.
fn in_order(pattern: &ArrivalPattern) -> Vec<usize> {
    let ArrivalPattern::Schedule(rows) = pattern else { return Vec::new() };
    let mut order: Vec<usize> = (0..rows.len()).collect();
    order.sort_by(|&a, &b| rows[a].0.total_cmp(&rows[b].0));
    order
}

/// Time in cut of every operation as programmed, s, by part and operation.
///
/// A pass takes path over feed rate where the process has a feed rate (milling), else path over
/// cutting speed (turning); a grinding phase takes its revolutions over the work speed. Plain work is
/// no time in cut. An operation whose tool does not exist has none.
pub fn programmed_cutting_times(scenario: &Scenario) -> Vec<Vec<f64>> {
    let tools: Vec<ToolPlan> = scenario.tools.iter().map(|tool| ToolPlan::from_process_model(&tool.process)).collect();
    totals(&programmed_pass_times(scenario, &tools))
}

/// Sum over the passes of every operation.
fn totals(pass_times: &[Vec<Vec<f64>>]) -> Vec<Vec<f64>> {
    pass_times.iter().map(|operations| operations.iter().map(|passes| passes.iter().sum()).collect()).collect()
}

/// Time of every pass or phase as programmed, s, by part and operation.
fn programmed_pass_times(scenario: &Scenario, tools: &[ToolPlan]) -> Vec<Vec<Vec<f64>>> {
    let times = |operation: &Operation| -> Vec<f64> {
        let Some(index) = operation.tool else { return Vec::new() };
        let (Some(tool), Some(plan)) = (scenario.tools.get(index), tools.get(index)) else {
            return vec![f64::NAN];
        };
        let phases =
            |phases: &[GrindingPhase], speed: f64| phases.iter().map(|each| phase_duration(each, speed)).collect();
        match &operation.work {
            Work::Plain(_) => Vec::new(),
            Work::Cutting(cuts) => {
                cuts.iter().map(|cut| cut_duration(cut, &tool.process, plan, &plan.cut_input(cut))).collect()
            }
            Work::Grinding { work_rotation_speed, phases: each } => phases(each, *work_rotation_speed),
            Work::Contour(work) => work.programmed.iter().map(|plan| plan.time()).collect(),
            Work::Program(work) => work.calls.iter().map(|call| call.time).collect(),
            Work::Cycle(cycle) => phases(&cycle.programmed, cycle.conditions.work_rotation_speed),
        }
    };
    scenario.parts.iter().map(|part| part.operations.iter().map(times).collect()).collect()
}

/// Whether a shop has none of what is looked at beside queues when an instant is settled.
fn is_bare(scenario: &Scenario) -> bool {
    scenario.transports.is_empty()
        && scenario.move_time.mean() == 0.0
        && scenario.operators.is_empty()
        && scenario.buffers.is_empty()
        && scenario.control.loops.is_empty()
        && scenario.shared.fixtures.is_empty()
        && scenario.control.release == ReleaseRule::Immediate
        && scenario.preemption == Preemption::None
}

/// A process of fixed steps meets the end of every programmed pass within half a step: one longer than twice the pass would
/// take no step in it.
fn fixed_steps(scenario: &Scenario) -> Result<(), ShopError> {
    for operation in scenario.parts.iter().flat_map(|part| &part.operations) {
        let Work::Cutting(cuts) = &operation.work else { continue };
        let tool_of = |pass| operation.tool_of_pass(pass).map(|tool| &scenario.tools[tool]);
        for (tool, cut) in cuts.iter().enumerate().filter_map(|(pass, cut)| Some((tool_of(pass)?, cut))) {
            let Some(step) = tool.process.machine_process().fixed_step() else { continue };
            let plan = ToolPlan::from_process_model(&tool.process);
            let pass = cut_duration(cut, &tool.process, &plan, &plan.cut_input(cut));
            if step > 2.0 * pass {
                let (tool, operation) = (tool.name.clone(), operation.name.clone());
                return Err(ShopError::FixedStep { tool, operation, step, pass, longest: 2.0 * pass });
            }
        }
    }
    Ok(())
}

/// Every index points somewhere, every operation has a machine.
fn check(scenario: &Scenario) -> Result<(), ShopError> {
    let inside = |kind, index: usize, count: usize| {
        if index < count { Ok(()) } else { Err(ShopError::from(ResolveError::UnknownIndex { kind, index, count })) }
    };
    for machine in &scenario.machines {
        if let Some(calendar) = machine.calendar {
            inside("calendar", calendar, scenario.calendars.len())?;
        }
    }
    for part in &scenario.parts {
        for operation in &part.operations {
            let tools = (0..operation.work.passes()).filter_map(|pass| operation.tool_of_pass(pass));
            for tool in tools.chain(operation.tool) {
                inside("tool", tool, scenario.tools.len())?;
            }
            if operation.tool.is_some() == matches!(operation.work, Work::Plain(_)) {
                let (part, operation) = (part.name.clone(), operation.name.clone());
                return Err(ShopError::ToolAndWork { part, operation });
            }
            for &machine in &operation.machines {
                inside("machine", machine, scenario.machines.len())?;
            }
            if operation.machines.is_empty() {
                return Err(ShopError::NoMachine { part: part.name.clone(), operation: operation.name.clone() });
            }
        }
    }
    forward_only::check(scenario)?;
    fixed_steps(scenario)?;
    for (part, _) in scenario.arrivals.iter().flat_map(|arrival| &arrival.parts) {
        inside("part", *part, scenario.parts.len())?;
    }
    for (mode, failure) in scenario.failures.iter().enumerate() {
        inside("machine", failure.machine, scenario.machines.len())?;
        if failure.part == Interruption::Finish {
            let machine = scenario.machines[failure.machine].name.clone();
            return Err(ShopError::FailureFinishesPart { mode, machine });
        }
    }
    Ok(())
}

/// Who draws for a source: what has a name draws by it, the others by their place among those that have none.
pub(super) fn source_entity(scenario: &Scenario, word: &str, source: usize) -> Entity {
    match &scenario.arrivals[source].name {
        Some(name) => Entity::named(&format!("{word} {name}")),
        None => {
            let before = scenario.arrivals[..source].iter().filter(|own| own.name.is_none()).count();
            Entity::named(word).part(before as u64)
        }
    }
}

/// Whether any fixture travels.
pub(super) fn travels(scenario: &Scenario) -> bool {
    scenario.shared.fixtures.iter().flat_map(|fixture| &fixture.holds).any(Hold::travels)
}
