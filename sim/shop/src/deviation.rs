//! What the true shop does otherwise than planned, and what measurements have moved.

use super::Shop;
use super::recorder::Recorder;
use super::task::{Content, Moved};
use rand::RngExt;
use toolroom_kernel::{Entity, Purpose};
use toolroom_scenario::{
    Deviation, Distribution, MICRO_STOP, Occasion, ProcessModel, Scenario, ShopConstant, ShopEffect, calibrated,
    lot_name,
};

/// Owners of the draws of short stops and of holds, parts of the operation's own name.
const STOPS: u64 = 1 << 40;
const HOLDS: u64 = STOPS + 1;

/// An operation that is about to begin, as scopes see it; nothing where there are no scopes.
pub(super) struct ScopedOperation {
    occasion: Option<Box<Occasion<'static>>>,
}

impl ScopedOperation {
    pub fn calibrated(&self, scenario: &Scenario, constant: ShopConstant, value: f64) -> f64 {
        self.occasion.as_ref().map_or(value, |occasion| calibrated(&scenario.calibrations, constant, occasion, value))
    }

    /// Size of a deviation that acts on it.
    fn deviation(&self, scenario: &Scenario, effect: ShopEffect) -> f64 {
        let size = |own: &Deviation| own.size * own.recorded.unwrap_or(1.0);
        self.occasion
            .as_ref()
            .map_or(0.0, |occasion| Deviation::acting(&scenario.deviations, effect, occasion).map(size).sum())
    }

    /// Times of loading and unloading, s: what is added is added to loading.
    pub fn handling(&self, scenario: &Scenario, times: [f64; 2]) -> [f64; 2] {
        let whole = times[0] + times[1];
        let moved = self.calibrated(scenario, ShopConstant::HandlingTime, whole)
            + self.deviation(scenario, ShopEffect::OperatorDelay);
        if moved == whole {
            return times;
        }
        let calibrated = |value| self.calibrated(scenario, ShopConstant::HandlingTime, value);
        let factor = calibrated(1.0) - calibrated(0.0);
        let unload = (factor * times[1]).min(moved).max(0.0);
        [(moved - unload).max(0.0), unload]
    }

    pub fn moved(&self, scenario: &Scenario, cutting_time: f64) -> Moved {
        let time = self.calibrated(scenario, ShopConstant::ProgrammedTime, cutting_time);
        let faster = self.deviation(scenario, ShopEffect::FeedOverride).min(0.0);
        let pace = if time == cutting_time { 1.0 } else { (time / cutting_time).max(LEAST_PACE) };
        Moved { pace: pace * (1.0 + faster), wear_rate: self.calibrated(scenario, ShopConstant::WearRate, 1.0) }
    }

    /// What acts on it among the entries of a tool that have a scope.
    pub fn acting(&self, scenario: &Scenario, tool: usize) -> u32 {
        self.occasion.as_ref().map_or(0, |occasion| scenario.tools[tool].variants.acting(occasion))
    }
}

/// Least share of its programmed time that an operation takes, whatever is subtracted (assumption).
const LEAST_PACE: f64 = 0.01;

impl<'a, R: Recorder> Shop<'a, R> {
    /// The process of a tool in the operation that a machine does.
    pub(super) fn process(&self, machine: usize, tool: usize) -> &'a ProcessModel {
        let acting = self.world.machines[machine].task.as_ref().map_or(0, |task| task.machining().acting);
        self.scenario.tools[tool].process_of(acting)
    }

    /// A machine as scopes see it, without the operation in it.
    fn machine_occasion(&self, machine: usize) -> Occasion<'static> {
        let (kind, now) = (&self.scenario.machines[machine], self.now().seconds());
        let mut occasion = Occasion::at(now);
        occasion.set("machine", kind.name.clone());
        if let Some(shift) = kind.calendar.and_then(|index| self.scenario.calendars[index].shift_at(now)) {
            occasion.set("shift", shift);
        }
        occasion.set("coolant", if kind.coolant(now).1 { "second" } else { "first" });
        occasion
    }

    /// The next operation of a job on a machine.
    pub(super) fn scoped_operation(&self, machine: usize, slot: u32) -> ScopedOperation {
        if self.layout.as_planned {
            return ScopedOperation { occasion: None };
        }
        let mut occasion = self.machine_occasion(machine);
        let job = self.world.jobs.at(slot);
        let part = &self.scenario.parts[job.row.part as usize];
        let operation = &part.operations[job.operation as usize];
        occasion.set("part", part.name.clone());
        occasion.set("operation", operation.name.clone());
        occasion.set("lot", lot_name(&part.name, job.row.lot));
        // A part program has come to one of its tools.
        let state = &self.world.machines[machine];
        let at_work = state.task.as_ref().filter(|task| task.slot == slot).and_then(|task| match &task.content {
            Content::Machining(machining) => Some(machining.tool as usize),
            Content::Plain(_) | Content::Stretches(_) => None,
        });
        if let Some(tool) = at_work.or(operation.tool) {
            occasion.set("tool", self.scenario.tools[tool].name.clone());
            if let Some(edge) = &self.world.machines[machine].edges[tool] {
                occasion.set("tool_id", format!("E{}", edge.number));
            }
        }
        ScopedOperation { occasion: Some(Box::new(occasion)) }
    }

    /// The operation in a machine, or the machine alone.
    fn occupied(&self, machine: usize) -> ScopedOperation {
        match &self.world.machines[machine].task {
            Some(task) => self.scoped_operation(machine, task.slot),
            None => ScopedOperation { occasion: Some(Box::new(self.machine_occasion(machine))) },
        }
    }

    /// A value of a machine or of the operation in it, as calibration has moved it.
    pub(super) fn moved(&self, constant: ShopConstant, machine: usize, value: f64) -> f64 {
        if self.scenario.calibrations.is_empty() {
            return value;
        }
        self.occupied(machine).calibrated(self.scenario, constant, value)
    }

    /// Time between two releases of a source, s.
    pub(super) fn interval(&self, source: usize, time: f64) -> f64 {
        if self.scenario.calibrations.is_empty() {
            return time;
        }
        let mut occasion = Occasion::at(self.now().seconds());
        // The part of the next job of a mix is not known yet.
        if let [(part, _)] = self.scenario.arrivals[source].parts[..] {
            occasion.set("part", self.scenario.parts[part].name.clone());
        }
        calibrated(&self.scenario.calibrations, ShopConstant::ArrivalInterval, &occasion, time).max(0.0)
    }

    /// Size of a deviation that acts on the operation in a machine.
    pub(super) fn deviation(&self, effect: ShopEffect, machine: usize) -> f64 {
        if self.scenario.deviations.is_empty() {
            return 0.0;
        }
        self.occupied(machine).deviation(self.scenario, effect)
    }

    /// Time of a change of edges, s.
    pub(super) fn change_time(&self, machine: usize, planned: f64) -> f64 {
        let moved = self.moved(ShopConstant::ToolChangeTime, machine, planned)
            + self.deviation(ShopEffect::ToolChangeDelay, machine);
        moved.max(0.0)
    }

    /// A drawn time of plain work as calibration has moved it, s.
    pub(super) fn plain_time(&self, scoped: &ScopedOperation, drawn: f64) -> f64 {
        scoped.calibrated(self.scenario, ShopConstant::ProgrammedTime, drawn).max(0.0)
    }

    /// Time of plain work with what the shop does otherwise than planned, s.
    pub(super) fn deviating(&self, scoped: &ScopedOperation, slot: u32, planned: f64) -> f64 {
        if self.scenario.deviations.is_empty() {
            return planned;
        }
        let faster = scoped.deviation(self.scenario, ShopEffect::FeedOverride).min(0.0);
        (planned * (1.0 + faster)).max(LEAST_PACE * planned) + self.delay(scoped, slot, planned)
    }

    /// Time that the program of a job's operation takes beyond its passes, s; `programmed` is that of the
    /// passes.
    pub(super) fn delay(&self, scoped: &ScopedOperation, slot: u32, programmed: f64) -> f64 {
        if self.scenario.deviations.is_empty() {
            return 0.0;
        }
        let slower = scoped.deviation(self.scenario, ShopEffect::FeedOverride).max(0.0);
        let rate = scoped.deviation(self.scenario, ShopEffect::MicroStops);
        if slower == 0.0 && rate == 0.0 {
            return 0.0;
        }
        let job = self.world.jobs.at(slot);
        let owner: Entity = job.entity.part(u64::from(job.operation)).part(STOPS);
        let mut stream = self.streams.open(owner, Purpose::Processing);
        let wait = Distribution::Exponential { mean: 1.0 };
        let stop = Distribution::Exponential { mean: MICRO_STOP };
        let (mut programmed_time, mut stopped) = (0.0, 0.0);
        loop {
            programmed_time += wait.sample(&mut stream);
            if programmed_time > rate * programmed {
                break;
            }
            stopped += stop.sample(&mut stream);
        }
        slower * programmed + stopped
    }

    /// Time for which the feed of a job's operation is held, s.
    pub(super) fn hold(&self, scoped: &ScopedOperation, slot: u32) -> f64 {
        if self.scenario.deviations.is_empty() {
            return 0.0;
        }
        let Some(occasion) = &scoped.occasion else { return 0.0 };
        let job = self.world.jobs.at(slot);
        let owner: Entity = job.entity.part(u64::from(job.operation)).part(HOLDS);
        let mut stream = self.streams.open(owner, Purpose::Processing);
        let acting = Deviation::acting(&self.scenario.deviations, ShopEffect::FeedHold, occasion);
        acting.filter(|own| stream.random::<f64>() < own.share).map(|own| own.size).sum()
    }
}
