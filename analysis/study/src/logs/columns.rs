//! The columns of the tables, each defined once.

use super::Names;
use toolroom_process::unit;
use toolroom_records::table::{Kind, Value};
use toolroom_shop::runlog::{EdgeRow, EventRow, JobRow, PassRow, StateRow};

/// A row of a log and where it stands.
#[derive(Clone, Copy)]
pub struct Row<'a, R> {
    /// Names behind indices.
    pub names: &'a Names,
    /// Index of the policy.
    pub policy: usize,
    /// Replication, from 0.
    pub replication: u32,
    /// Index of the row in its log: the number of an edge or a job.
    pub index: u32,
    /// The row.
    pub row: &'a R,
}

enum Source<R> {
    Real { value: fn(&R) -> f64, per_display: f64 },
    Count(fn(&Row<'_, R>) -> Option<u32>),
    Text(for<'a> fn(&Row<'a, R>) -> &'a str),
}

/// A column of a table.
pub struct Column<R> {
    name: &'static str,
    unit: &'static str,
    source: Source<R>,
}

impl<R> Column<R> {
    /// `name [unit]`, or the name of what has no unit.
    pub fn header(&self) -> String {
        if self.unit == "1" { self.name.to_owned() } else { format!("{} [{}]", self.name, self.unit) }
    }

    /// Kind of its cells.
    pub fn kind(&self) -> Kind {
        match self.source {
            Source::Real { .. } => Kind::Real,
            Source::Count(_) => Kind::Count,
            Source::Text(_) => Kind::Text,
        }
    }

    /// Cell of a row.
    pub fn value<'a>(&self, row: &Row<'a, R>) -> Value<'a> {
        match self.source {
            Source::Real { value, per_display } => {
                Value::Real(Some(value(row.row) / per_display).filter(|value| value.is_finite()))
            }
            Source::Count(value) => Value::Count(value(row)),
            Source::Text(value) => Value::Text(value(row)),
        }
    }
}

/// A number kept in `si` and shown in `display`.
fn real<R>(name: &'static str, si: &str, display: &'static str, value: fn(&R) -> f64) -> Column<R> {
    Column { name, unit: display, source: Source::Real { value, per_display: unit::convert(1.0, display, si) } }
}

fn count<R>(name: &'static str, value: fn(&Row<'_, R>) -> Option<u32>) -> Column<R> {
    Column { name, unit: "1", source: Source::Count(value) }
}

fn text<R>(name: &'static str, value: for<'a> fn(&Row<'a, R>) -> &'a str) -> Column<R> {
    Column { name, unit: "1", source: Source::Text(value) }
}

/// The columns that every table starts with.
fn run<R>() -> [Column<R>; 2] {
    [text("policy", |r| r.names.policy(r.policy)), count("replication", |r| Some(r.replication))]
}

/// Passes: what was cut, how, and what came of it.
pub fn operations() -> Vec<Column<PassRow>> {
    let columns = [
        count("job", |r: &Row<'_, PassRow>| Some(r.row.job)),
        text("part", |r| r.names.part(r.row.part)),
        text("operation", |r| r.names.operation(r.row.part, r.row.operation)),
        count("pass", |r| Some(r.row.pass)),
        text("machine", |r| r.names.machine(r.row.machine)),
        count("edge", |r| Some(r.row.edge)),
        real("start", "s", "min", |row| row.start),
        real("end", "s", "min", |row| row.end),
        real("cutting_time", "s", "min", |row| row.cutting_time),
        real("cutting_speed_start", "m/s", "m/min", |row| row.speed_start),
        real("cutting_speed_end", "m/s", "m/min", |row| row.speed_end),
        real("feed", "m", "mm", |row| row.feed),
        real("depth_of_cut", "m", "mm", |row| row.depth_of_cut),
        real("path", "m", "m", |row| row.path),
        real("edge_time", "s", "min", |row| row.edge_time),
        real("flank_wear_start", "m", "mm", |row| row.flank_wear_start),
        real("flank_wear_end", "m", "mm", |row| row.flank_wear_end),
        real("flank_wear_estimate", "m", "mm", |row| row.flank_wear_estimate),
        real("cutting_force", "N", "N", |row| row.cutting_force),
        real("spindle_power", "W", "kW", |row| row.spindle_power),
        real("temperature", "K", "K", |row| row.temperature),
        real("energy", "J", "kJ", |row| row.energy),
        real("size_error", "m", "um", |row| row.size_error),
        real("chatter_time", "s", "min", |row| row.chatter_time),
        real("stability_margin", "1", "1", |row| row.stability_margin),
        real("chatter_frequency", "1/s", "Hz", |row| row.chatter_frequency),
        real("vibration_amplitude", "m", "um", |row| row.vibration_amplitude),
        real("roughness_ra", "m", "um", |row| row.roughness),
        real("engaged_time", "s", "min", |row| row.engaged_time),
        real("cutting_length", "m", "m", |row| row.cutting_length),
    ];
    run().into_iter().chain(columns).collect()
}

/// Edges and dressing cycles of wheels, from installation to removal.
pub fn tools() -> Vec<Column<EdgeRow>> {
    let columns = [
        count("edge", |r| Some(r.index)),
        text("tool", |r: &Row<'_, EdgeRow>| r.names.tool(r.row.tool)),
        text("machine", |r| r.names.machine(r.row.machine)),
        real("installed", "s", "min", |row| row.installed),
        real("removed", "s", "min", |row| row.removed),
        text("reason", |r| r.row.reason.name()),
        real("cutting_time", "s", "min", |row| row.cutting_time),
        real("path", "m", "m", |row| row.path),
        count("passes", |r| Some(r.row.passes)),
        count("parts", |r| Some(r.row.parts)),
        real("flank_wear", "m", "mm", |row| row.flank_wear),
        real("mechanical_wear_factor", "1", "1", |row| row.mechanical_wear_factor),
        real("thermal_wear_factor", "1", "1", |row| row.thermal_wear_factor),
    ];
    run().into_iter().chain(columns).collect()
}

/// Jobs from arrival to finish.
pub fn jobs() -> Vec<Column<JobRow>> {
    let columns = [
        count("job", |r| Some(r.index)),
        text("part", |r: &Row<'_, JobRow>| r.names.part(r.row.part)),
        count("lot", |r| Some(r.row.lot)),
        text("order", |r| r.names.order(r.row.order)),
        count("quantity", |r| Some(r.row.quantity)),
        real("arrival", "s", "min", |row| row.arrival),
        real("start", "s", "min", |row| row.start),
        real("finish", "s", "min", |row| row.finish),
        real("due", "s", "min", |row| row.due),
        text("outcome", |r| r.row.outcome.name()),
    ];
    run().into_iter().chain(columns).collect()
}

/// Stays of machines in states.
pub fn states() -> Vec<Column<StateRow>> {
    let columns = [
        text("machine", |r: &Row<'_, StateRow>| r.names.machine(r.row.machine)),
        text("state", |r| r.row.state.name()),
        real("start", "s", "min", |row| row.start),
        real("end", "s", "min", |row| row.end),
        count("job", |r| r.row.job),
        count("in_shift", |r| Some(u32::from(r.row.in_shift))),
    ];
    run().into_iter().chain(columns).collect()
}

/// Events in order.
pub fn events() -> Vec<Column<EventRow>> {
    let columns = [
        real("time", "s", "min", |row: &EventRow| row.time),
        text("event", |r| r.row.event.name()),
        text("machine", |r| r.row.machine.map_or("", |machine| r.names.machine(machine))),
        count("job", |r| r.row.job),
        count("edge", |r| r.row.edge),
    ];
    run().into_iter().chain(columns).collect()
}
