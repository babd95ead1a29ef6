//! A simulated run as if it had been measured: records of every process and the events of the
//! machines, with the errors of the sensors.
//!
//! A row of `operations` and `cuts` is one pass by one edge, since cutting data belong to a pass;
//! cycle and stop times belong to operations and are written where an operation has one pass. A row
//! of `trials` is one part, a row of `stretches` some blocks of a part program in one run, a row of `orders` one job.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod cutting;
mod events;
mod grinding;
mod orders;
mod program;
#[cfg(test)]
mod tests;
mod visits;

use rand_distr::{Distribution, StandardNormal};
use toolroom_kernel::{Entity, Purpose, Streams};
use toolroom_process::ModelError;
use toolroom_records::{RecordKind, Records, Sensor};
use toolroom_scenario::{Occasion, ProcessModel, Scenario, ToolType, calibrated_channel, lot_name};
use toolroom_shop::runlog::PassRow;
use toolroom_shop::{Refusal, RunLog};
use visits::Visits;

/// Sensor of a channel of a kind of records.
pub type Sheet<'a> = dyn Fn(RecordKind, &str) -> Sensor + 'a;

/// What was measured of one run, kind by kind; kinds without rows are left out. Readings carry the
/// errors of `sheet`, drawn from the seed of the scenario; times of events are those of the control
/// and have none.
///
/// # Errors
/// [`Refusal`]: means over a pass ask the process at more states than the run did, and at one of them an effect of a user
/// gives no value.
pub fn simulated(scenario: &Scenario, log: &RunLog, sheet: &Sheet<'_>) -> Result<Vec<Records>, Box<Refusal>> {
    let run = Run { scenario, log, visits: Visits::of(scenario, log), sheet, streams: Streams::new(scenario.seed, 0) };
    let mut all = vec![cutting::records(&run, RecordKind::Turning)?, cutting::records(&run, RecordKind::Milling)?];
    all.push(grinding::trials(&run)?);
    all.push(events::events(&run));
    all.push(orders::orders(&run));
    all.push(program::stretches(&run));
    all.retain(|records| !records.is_empty());
    Ok(all)
}

/// A run, and the sensors that see it.
struct Run<'a> {
    scenario: &'a Scenario,
    log: &'a RunLog,
    visits: Visits,
    sheet: &'a Sheet<'a>,
    streams: Streams,
}

impl Run<'_> {
    /// What a process refuses while a pass is followed for its records.
    fn refusal(&self, pass: &PassRow, source: ModelError) -> Box<Refusal> {
        let part = &self.scenario.parts[pass.part as usize];
        Box::new(Refusal {
            time: pass.start,
            machine: self.machine(pass.machine),
            part: part.name.clone(),
            operation: part.operations[pass.operation as usize].name.clone(),
            pass: pass.pass,
            inputs: Vec::new(),
            source,
        })
    }

    /// Readings of a channel, one a row.
    fn readings(&self, kind: RecordKind, channel: &str, values: &[f64]) -> Vec<f64> {
        let sensor = (self.sheet)(kind, channel);
        let entity = Entity::named(&format!("records/{}/{channel}", kind.file_stem()));
        let reading = |(row, value): (usize, &f64)| {
            let mut stream = self.streams.at(entity, Purpose::Measurement, row as u64);
            let mut normal = || -> f64 { StandardNormal.sample(&mut stream) };
            let read = value * (1.0 + sensor.relative * normal()) + sensor.absolute * normal();
            if sensor.resolution > 0.0 { (read / sensor.resolution).round() * sensor.resolution } else { read }
        };
        values.iter().enumerate().map(reading).collect()
    }

    /// Adds a channel where anything was measured. Gains and offsets move what the sensor reads.
    fn channel(&self, records: &mut Records, name: &str, values: &[f64]) {
        if values.iter().any(|value| value.is_finite()) {
            let moved = self.moved(records, name, values);
            records.set_numbers(name, self.readings(records.kind, name, &moved));
        }
    }

    /// Values as calibrated sensors read them.
    fn moved(&self, records: &Records, name: &str, values: &[f64]) -> Vec<f64> {
        let all = &self.scenario.calibrations;
        let words = ["gain", "offset"].map(|word| format!("{word}.{name}"));
        if all.iter().all(|own| !words.contains(&own.parameter)) {
            return values.to_vec();
        }
        let tool = self.scenario.tools.iter().find(|tool| tool.process.name() == records.kind.name());
        let tool = tool.map(|tool| tool.name.as_str());
        let value = |(row, value): (usize, &f64)| {
            let text = |column: &str| records.texts(column).map(|values| values[row].as_str());
            let time = records.numbers("start_time").map(|times| times[row]);
            let occasion = Occasion::recorded(&text, time, tool);
            calibrated_channel(all, name, &occasion, *value)
        };
        values.iter().enumerate().map(value).collect()
    }

    /// The process of a pass: what acts on it is decided at the start of its operation.
    fn process(&self, pass: usize) -> &ProcessModel {
        self.tool_of_pass(pass).process_of(self.acting(pass))
    }

    /// Whether the lot of a pass deviates because an effect of its tool is scoped to it.
    fn hardened(&self, pass: usize) -> bool {
        self.tool_of_pass(pass).variants.hardens_lots(self.acting(pass))
    }

    fn tool_of_pass(&self, pass: usize) -> &ToolType {
        &self.scenario.tools[self.log.edges[self.log.passes[pass].edge as usize].tool as usize]
    }

    /// What acts on a pass among the entries of its tool that have a scope.
    fn acting(&self, at: usize) -> u32 {
        let (pass, tool) = (&self.log.passes[at], self.tool_of_pass(at));
        if !tool.variants.has_scopes() {
            return 0;
        }
        let visit = &self.visits.list[self.visits.of_pass[at]];
        let part = &self.scenario.parts[pass.part as usize];
        let mut occasion = Occasion::at(visit.start);
        occasion.set("machine", self.machine(pass.machine));
        occasion.set("tool", tool.name.as_str());
        occasion.set("tool_id", edge_name(pass.edge));
        occasion.set("part", part.name.as_str());
        occasion.set("operation", part.operations[pass.operation as usize].name.as_str());
        occasion.set("lot", lot_name(&part.name, self.log.jobs[pass.job as usize].lot));
        let calendar = self.scenario.machines[pass.machine as usize].calendar;
        if let Some(shift) = calendar.and_then(|index| self.scenario.calendars[index].shift_at(visit.start)) {
            occasion.set("shift", shift);
        }
        occasion.set("coolant", if self.coolant(pass.machine, visit.start).1 { "second" } else { "first" });
        tool.variants.acting(&occasion)
    }

    /// Shift of a machine at a time; empty where it has no calendar of several shifts.
    fn shift(&self, machine: usize, time: f64) -> String {
        let calendar = self.scenario.machines[machine].calendar.map(|index| &self.scenario.calendars[index]);
        let several = calendar.filter(|calendar| calendar.shift_count() > 1);
        several.and_then(|calendar| calendar.shift_at(time)).unwrap_or_default()
    }

    /// [`MachineType::coolant`](toolroom_scenario::MachineType::coolant) of a machine of the log.
    fn coolant(&self, machine: u32, time: f64) -> (f64, bool) {
        self.scenario.machines[machine as usize].coolant(time)
    }

    /// Adds name and age of the coolant, where any machine gets another: without one its age is the calendar.
    fn coolants(&self, records: &mut Records, changes: &[(u32, f64)]) {
        if self.scenario.machines.iter().all(|machine| machine.coolant_change.is_none()) {
            return;
        }
        let coolants: Vec<(f64, bool)> = changes.iter().map(|(machine, time)| self.coolant(*machine, *time)).collect();
        let name = |(_, changed): &(f64, bool)| if *changed { "second" } else { "first" }.to_owned();
        records.set_texts("coolant_id", coolants.iter().map(name).collect());
        records.set_numbers("coolant_age", coolants.iter().map(|(age, _)| *age).collect());
    }

    fn machine(&self, index: u32) -> String {
        self.scenario.machines[index as usize].name.clone()
    }

    /// `part/operation`: what a control calls the program.
    fn program(&self, part: u32, operation: u32) -> String {
        let part = &self.scenario.parts[part as usize];
        format!("{}/{}", part.name, part.operations[operation as usize].name)
    }

    /// `J12/turn`.
    fn operation_id(&self, job: u32, part: u32, operation: u32) -> String {
        format!("J{job}/{}", self.scenario.parts[part as usize].operations[operation as usize].name)
    }
}

/// Name of an edge.
fn edge_name(edge: u32) -> String {
    format!("E{edge}")
}
