//! Blocks of records and what their streams read.
//!
//! A reading is the mean residual of a channel against the model as its file stands, or the score of an effect in the block
//! by itself. The model is not fitted: what is fitted would follow a drift.

use crate::watch::{Block, Reading};
use std::collections::BTreeMap;
use toolroom_gap::shop::{Shop, visits};
use toolroom_gap::{Direction, Forward, NominalModel, NominalProcess, Point, Transform};
use toolroom_records::{RecordKind, Records};

const DAY: f64 = 86400.0;
/// Differences that mean nothing, in standard deviations of a value (assumption).
const RESOLUTION: f64 = 0.02;
/// Most effects that are streams of their own (count; assumption).
const EFFECTS: usize = 160;

/// Column of the time of a row, s.
pub fn time_column(records: &Records) -> &'static str {
    if records.kind == RecordKind::Shop { "time" } else { "start_time" }
}

/// Every block but the newest of each machine, which may still grow.
pub fn blocks(model: &NominalModel, records: &Records, group: Option<&str>) -> Vec<Block> {
    let parts = model.asked(records, group, |_, _| false).parts;
    let shop = match &model.process {
        NominalProcess::Shop(shop) => Some(shop),
        NominalProcess::Turning(_)
        | NominalProcess::Milling(_)
        | NominalProcess::Grinding(_)
        | NominalProcess::Empirical
        | NominalProcess::Program(_) => None,
    };
    let mut all: BTreeMap<String, (String, Block)> = BTreeMap::new();
    for part in &parts {
        let measured = &part.frame().measured;
        for (group, readings) in readings(part.as_ref()).into_iter().enumerate().filter(|(_, own)| !own.is_empty()) {
            let name = &measured.groups[group];
            let rows: Vec<usize> =
                (0..measured.group_of_row.len()).filter(|row| measured.group_of_row[*row] == group).collect();
            let (machine, time) = place(records, name, &rows, group);
            let (_, block) = all.entry(name.clone()).or_insert_with(|| {
                let block = Block { name: name.clone(), time, rows: rows.len(), readings: Vec::new() };
                (machine.clone(), block)
            });
            let suffix = if machine.is_empty() { String::new() } else { format!(" {machine}") };
            block.readings.extend(
                readings.into_iter().map(|(stream, value)| (format!("{stream}{suffix}"), Reading::Value(value))),
            );
        }
    }
    if let Some(shop) = shop {
        add_failures(shop, records, &mut all);
    }
    let mut newest: BTreeMap<&str, f64> = BTreeMap::new();
    for (machine, block) in all.values() {
        let last = newest.entry(machine.as_str()).or_insert(block.time);
        *last = last.max(block.time);
    }
    all.values()
        .filter(|(machine, block)| block.time < newest[machine.as_str()])
        .map(|(_, block)| block.clone())
        .collect()
}

/// Machine and time of a group: of the name `L1 day 3`, or of its first row; without times the groups are in their order.
fn place(records: &Records, name: &str, rows: &[usize], group: usize) -> (String, f64) {
    if records.kind == RecordKind::Shop {
        let day = name.rsplit_once(" day ").and_then(|(machine, day)| Some((machine, day.parse::<f64>().ok()?)));
        return day
            .map_or_else(|| (String::new(), group as f64), |(machine, day)| (machine.to_owned(), DAY * (day - 1.0)));
    }
    let row = rows.first().copied().unwrap_or(0);
    let machine = records.texts("machine").map_or_else(String::new, |machines| machines[row].clone());
    let times = records.numbers(time_column(records));
    let time = times.map(|times| rows.iter().map(|row| times[*row]).fold(f64::INFINITY, f64::min));
    (machine, time.filter(|time| time.is_finite()).unwrap_or(group as f64))
}

/// A reading in standard deviations of a single value, without what is below the resolution of any sensor: times of
/// a control that are all but the same differ by how they were rounded, and that changes with the calendar.
fn resolved(reading: f64) -> f64 {
    (reading / RESOLUTION).round() * RESOLUTION
}

/// Readings of every group of a model.
fn readings(part: &dyn Forward) -> Vec<Vec<(String, f64)>> {
    let frame = part.frame();
    let measured = &frame.measured;
    let point = Point::nominal(part);
    let raw = part.simulate(&point);
    let log = |channel: usize| measured.channels[channel].transform == Transform::Log;
    let residuals: Vec<f64> = measured
        .observations
        .iter()
        .zip(&raw)
        .map(|(own, raw)| own.value - if log(own.channel) { raw.ln() } else { *raw })
        .collect();
    // A block is of one machine and its streams are, too: an effect at machines is that everywhere, and one from a date on is what
    // is looked for.
    let own = |candidate: &usize| {
        let scope = part.written(*candidate).scope;
        scope.names.iter().all(|(key, _)| *key != "machine") && scope.from.is_none() && scope.until.is_none()
    };
    let watched: Vec<usize> = (0..frame.candidates.len()).filter(own).take(EFFECTS).collect();
    let effects: Vec<Direction> = watched.iter().map(|candidate| Direction::Effect(*candidate)).collect();
    let slopes = part.slopes(&point, &raw, &effects);
    let of_group = |group: usize| {
        let span = measured.spans[group].clone();
        let mut readings = Vec::new();
        for (index, channel) in measured.channels.iter().enumerate() {
            let in_block =
                span.clone().filter(|i| measured.observations[*i].channel == index && residuals[*i].is_finite());
            let (sum, deviation) = in_block.fold((0.0, 0.0), |(sum, deviation), i| {
                (sum + residuals[i], deviation + measured.observations[i].deviation)
            });
            if deviation > 0.0 {
                readings.push((channel.id.to_string(), resolved(sum / deviation)));
            }
        }
        for (candidate, slopes) in watched.iter().map(|candidate| &frame.candidates[*candidate]).zip(&slopes) {
            let (mut product, mut square, mut count) = (0.0, 0.0, 0.0_f64);
            for i in span.clone().filter(|i| residuals[*i].is_finite()) {
                let observation = &measured.observations[i];
                let slope = if log(observation.channel) { slopes[i] / raw[i] } else { slopes[i] };
                let weight = observation.deviation.powi(-2);
                if slope.is_finite() && weight.is_finite() {
                    product += weight * slope * residuals[i];
                    square += weight * slope * slope;
                    count += 1.0;
                }
            }
            if square > 0.0 {
                let shape = if candidate.shape.is_empty() { String::new() } else { format!(" ({})", candidate.shape) };
                readings.push((format!("effect {}{shape}", candidate.id), resolved(product / (square * count).sqrt())));
            }
        }
        readings
    };
    (0..measured.groups.len()).map(of_group).collect()
}

/// Adds the breakdowns of each machine and day.
fn add_failures(shop: &Shop, records: &Records, all: &mut BTreeMap<String, (String, Block)>) {
    let seen = visits(records);
    for (machine, name) in seen.machines.iter().enumerate() {
        let [mode] = shop.station(name).map_or(&[][..], |station| &station.failures) else { continue };
        let day = |time: f64| (time / DAY).floor() as i64;
        let mut used: BTreeMap<i64, f64> = BTreeMap::new();
        for visit in seen.list.iter().filter(|visit| visit.machine == machine) {
            let time = visit.cutting + visit.handling + visit.setup;
            *used.entry(day(visit.start)).or_default() += time + visit.changes.iter().chain(&visit.holds).sum::<f64>();
        }
        for (number, used) in used {
            let Some((_, block)) = all.get_mut(&format!("{name} day {}", number + 1)) else { continue };
            let count = seen.breakdowns[machine].times.iter().filter(|time| day(**time) == number).count() as u64;
            let expected = used / mode.time_between.mean();
            block.readings.push((format!("failures {name}"), Reading::Count { count, expected }));
        }
    }
}
