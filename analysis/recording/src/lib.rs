//! A simulated run as if it had been measured: records of every process and the events of the
//! machines, with the errors of the sensors.
//!
//! A row of `operations` and `cuts` is one pass by one edge, since cutting data belong to a pass;
//! cycle and stop times belong to operations and are written where an operation has one pass. A row
//! of `trials` is one part.

mod cutting;
mod events;
mod grinding;
#[cfg(test)]
mod tests;
mod visits;

use rand_distr::{Distribution, StandardNormal};
use toolroom_kernel::{Entity, Purpose, Streams};
use toolroom_records::{RecordKind, Records, Sensor};
use toolroom_scenario::Scenario;
use toolroom_shop::RunLog;
use visits::Visits;

/// Sensor of a channel of a kind of records.
pub type Sheet<'a> = dyn Fn(RecordKind, &str) -> Sensor + 'a;

/// What was measured of one run, kind by kind; kinds without rows are left out. Readings carry the
/// errors of `sheet`, drawn from the seed of the scenario; times of events are those of the control
/// and have none.
pub fn simulated(scenario: &Scenario, log: &RunLog, sheet: &Sheet<'_>) -> Vec<Records> {
    let run = Run { scenario, log, visits: Visits::of(log), sheet, streams: Streams::new(scenario.seed, 0) };
    let mut all = vec![cutting::records(&run, RecordKind::Turning), cutting::records(&run, RecordKind::Milling)];
    all.push(grinding::trials(&run));
    all.push(events::events(&run));
    all.retain(|records| !records.is_empty());
    all
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

    /// Adds a channel where anything was measured.
    fn channel(&self, records: &mut Records, name: &str, values: &[f64]) {
        if values.iter().any(|value| value.is_finite()) {
            records.set_numbers(name, self.readings(records.kind, name, values));
        }
    }

    /// Shift of a machine at a time; empty where it has no calendar of several shifts.
    fn shift(&self, machine: usize, time: f64) -> String {
        let calendar = self.scenario.machines[machine].calendar.map(|index| &self.scenario.calendars[index]);
        let several = calendar.filter(|calendar| calendar.shifts.len() > 1);
        several.and_then(|calendar| calendar.shift_at(time)).unwrap_or_default()
    }

    /// [`MachineType::coolant`](toolroom_scenario::MachineType::coolant) of a machine of the log.
    fn coolant(&self, machine: u32, time: f64) -> (f64, bool) {
        self.scenario.machines[machine as usize].coolant(time)
    }

    /// Adds name and age of the coolant, where any machine gets another: without one its age is the calendar.
    fn coolants(&self, records: &mut Records, at: &[(u32, f64)]) {
        if self.scenario.machines.iter().all(|machine| machine.coolant_change.is_none()) {
            return;
        }
        let coolants: Vec<(f64, bool)> = at.iter().map(|(machine, time)| self.coolant(*machine, *time)).collect();
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
