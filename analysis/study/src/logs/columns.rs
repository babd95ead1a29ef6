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
    Real {
        value: fn(&R) -> f64,
        per_display: f64,
    },
    /// A number that some rows do not have: empty there.
    Partial {
        value: fn(&R) -> f64,
        per_display: f64,
        is_defined: fn(&Row<'_, R>) -> bool,
    },
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
            Source::Real { .. } | Source::Partial { .. } => Kind::Real,
            Source::Count(_) => Kind::Count,
            Source::Text(_) => Kind::Text,
        }
    }

    /// Cell of a row.
    pub fn value<'a>(&self, row: &Row<'a, R>) -> Value<'a> {
        let real = |value: f64| Some(value).filter(|value| value.is_finite());
        match self.source {
            Source::Real { value, per_display } => Value::Real(real(value(row.row) / per_display)),
            Source::Partial { value, per_display, is_defined } => {
                Value::Real(is_defined(row).then(|| value(row.row) / per_display).and_then(real))
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

/// A number of passes that cut with edges, which wheels do not have.
fn of_edges(name: &'static str, si: &str, display: &'static str, value: fn(&PassRow) -> f64) -> Column<PassRow> {
    partial((name, si, display), value, |row| !row.names.is_ground(row.row.part, row.row.operation))
}

/// A number of passes of wheels alone.
fn of_wheels(name: &'static str, si: &str, display: &'static str, value: fn(&PassRow) -> f64) -> Column<PassRow> {
    partial((name, si, display), value, |row| row.names.is_ground(row.row.part, row.row.operation))
}

/// A number, by name, SI unit and unit of the table, that some rows do not have.
fn partial<R>(
    (name, si, display): (&'static str, &str, &'static str),
    value: fn(&R) -> f64,
    is_defined: fn(&Row<'_, R>) -> bool,
) -> Column<R> {
    let per_display = unit::convert(1.0, display, si);
    Column { name, unit: display, source: Source::Partial { value, per_display, is_defined } }
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

/// Passes: what was cut or ground, how, and what came of it. What a wheel does not have is empty: speeds, depth and path of an edge,
/// chatter and roughness; its force is the normal one.
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
        of_edges("cutting_speed_start", "m/s", "m/min", |row| row.speed_start),
        of_edges("cutting_speed_end", "m/s", "m/min", |row| row.speed_end),
        real("feed", "m", "mm", |row| row.feed),
        of_edges("depth_of_cut", "m", "mm", |row| row.depth_of_cut),
        of_edges("path", "m", "m", |row| row.path),
        real("edge_time", "s", "min", |row| row.edge_time),
        real("flank_wear_start", "m", "mm", |row| row.flank_wear_start),
        real("flank_wear_end", "m", "mm", |row| row.flank_wear_end),
        real("flank_wear_estimate", "m", "mm", |row| row.flank_wear_estimate),
        of_edges("cutting_force", "N", "N", |row| row.cutting_force),
        real("spindle_power", "W", "kW", |row| row.spindle_power),
        real("temperature", "K", "K", |row| row.temperature),
        real("energy", "J", "kJ", |row| row.energy),
        real("size_error", "m", "um", |row| row.size_error),
        of_edges("chatter_time", "s", "min", |row| row.chatter_time),
        real("stability_margin", "1", "1", |row| row.stability_margin),
        of_edges("chatter_frequency", "1/s", "Hz", |row| row.chatter_frequency),
        of_edges("vibration_amplitude", "m", "um", |row| row.vibration_amplitude),
        of_edges("roughness_ra", "m", "um", |row| row.roughness),
        of_edges("engaged_time", "s", "min", |row| row.engaged_time),
        of_edges("cutting_length", "m", "m", |row| row.cutting_length),
        // What a wheel presses with is no cutting force.
        of_wheels("normal_force", "N", "N", |row| row.cutting_force),
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
