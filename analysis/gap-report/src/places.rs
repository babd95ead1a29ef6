//! Where the rows of a model belong.

use crate::DAY;
use crate::minutes::Rates;
use crate::readings::{Place, Readings};
use std::collections::BTreeMap;
use toolroom_gap::shop::visits;
use toolroom_gap::{ChannelId, Diagnosis, Forward, NominalModel, NominalProcess};
use toolroom_records::Records;
use toolroom_scenario::Scenario;

impl Rates {
    /// Those of the machines of a scenario.
    pub fn from_scenario(scenario: &Scenario) -> Self {
        let by_machine = scenario.machines.iter().map(|machine| (machine.name.clone(), machine.rate)).collect();
        Self { currency: scenario.currency.clone(), by_machine }
    }
}

impl Readings {
    /// Readings of all parts of a process.
    pub fn of_process(
        model: &NominalModel,
        records: &Records,
        parts: &[Box<dyn Forward>],
        diagnosis: &Diagnosis,
    ) -> Self {
        let mut readings = Self::default();
        for part in parts {
            match &model.process {
                NominalProcess::Shop(_) => {
                    let places = of_days(records, part.as_ref());
                    readings.add(part.as_ref(), diagnosis, &|row, channel| places(row, channel));
                }
                NominalProcess::Turning(_)
                | NominalProcess::Milling(_)
                | NominalProcess::Grinding(_)
                | NominalProcess::Empirical
                | NominalProcess::Program(_) => {
                    let text = |row: usize| records.texts("machine").map_or_else(String::new, |own| own[row].clone());
                    let time = |row: usize| records.numbers("start_time").map_or(f64::NAN, |own| own[row]);
                    let place = |row, _: &str| Place { machine: text(row), time: time(row), operations: 1.0 };
                    readings.add(part.as_ref(), diagnosis, &place);
                }
            }
        }
        readings
    }
}

/// Places of the blocks of a shop: a machine and day. The medians of a channel stand for all operations (changes, holds)
/// of that machine and day, each for as many.
fn of_days(records: &Records, part: &dyn Forward) -> impl Fn(usize, &str) -> Place {
    let seen = visits(records);
    let mut counts: BTreeMap<String, [usize; 3]> = BTreeMap::new();
    for visit in &seen.list {
        let name = format!("{} day {}", seen.machines[visit.machine], (visit.start / DAY).floor() as i64 + 1);
        let count = counts.entry(name).or_default();
        *count = [count[0] + 1, count[1] + visit.changes.len(), count[2] + visit.holds.len()];
    }
    let measured = &part.frame().measured;
    let mut blocks: BTreeMap<(usize, String), f64> = BTreeMap::new();
    for observation in &measured.observations {
        let channel = measured.channels[observation.channel].id.to_string();
        *blocks.entry((measured.group_of_row[observation.row], channel)).or_default() += 1.0;
    }
    let (groups, of_row) = (measured.groups.clone(), measured.group_of_row.clone());
    move |row, channel| {
        let name = &groups[of_row[row]];
        let [visits, changes, holds] = counts.get(name).copied().unwrap_or_default();
        let events = match channel {
            channel if channel == ChannelId::ToolChangeTime.word() => changes,
            channel if channel == ChannelId::FeedHoldTime.word() => holds,
            _ => visits,
        };
        let operations = events as f64 / blocks.get(&(of_row[row], channel.to_owned())).copied().unwrap_or(1.0);
        let day = name.rsplit_once(" day ").and_then(|(machine, day)| Some((machine, day.parse::<f64>().ok()?)));
        let (machine, time) = day.map_or((name.as_str(), f64::NAN), |(machine, day)| (machine, DAY * (day - 0.5)));
        Place { machine: machine.to_owned(), time, operations }
    }
}
