//! Where the rows of a model belong.

use crate::DAY;
use crate::minutes::Rates;
use crate::readings::{Place, Readings};
use std::collections::BTreeMap;
use toolroom_gap::shop::{Visits, visits};
use toolroom_gap::{ChannelId, Diagnosis, Forward, NominalModel, NominalProcess, Transform};
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
                    let seen = visits(records);
                    readings.span = Some(span(&seen));
                    readings.add(part.as_ref(), diagnosis, &of_days(&seen, part.as_ref()));
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

/// Places of the blocks of a shop: a machine and day. The middles of a channel stand for all operations (changes, holds) of that
/// machine and day: each for as many as it was taken of, times what all of them took over what their middles say.
fn of_days<'a>(seen: &'a Visits, part: &'a dyn Forward) -> impl Fn(usize, &str) -> Place + 'a {
    let mut taken: BTreeMap<(String, &str), f64> = BTreeMap::new();
    for visit in &seen.list {
        let name = format!("{} day {}", seen.machines[visit.machine], (visit.start / DAY).floor() as i64 + 1);
        for (channel, time) in [
            (ChannelId::CuttingTime, visit.cutting),
            (ChannelId::HandlingTime, visit.handling),
            (ChannelId::ToolChangeTime, visit.changes.iter().sum()),
            (ChannelId::FeedHoldTime, visit.holds.iter().sum()),
        ] {
            *taken.entry((name.clone(), channel.word())).or_default() += time;
        }
    }
    let frame = part.frame();
    let measured = &frame.measured;
    let mut said: BTreeMap<(usize, &str), f64> = BTreeMap::new();
    for (observation, count) in measured.observations.iter().zip(&frame.stands_for) {
        let channel = &measured.channels[observation.channel];
        let value = if channel.transform == Transform::Log { observation.value.exp() } else { observation.value };
        *said.entry((measured.group_of_row[observation.row], channel.id.word())).or_default() += count * value;
    }
    move |row, channel| {
        let group = measured.group_of_row[row];
        let name = &measured.groups[group];
        let whole = taken.iter().find(|((own, of), _)| own == name && *of == channel).map(|(_, time)| *time);
        let middles = said.iter().find(|((own, of), _)| *own == group && *of == channel).map(|(_, time)| *time);
        let operations = match (whole, middles) {
            (Some(whole), Some(middles)) if middles > 0.0 => whole / middles,
            _ => 1.0,
        };
        let day = name.rsplit_once(" day ").and_then(|(machine, day)| Some((machine, day.parse::<f64>().ok()?)));
        let (machine, time) = day.map_or((name.as_str(), f64::NAN), |(machine, day)| (machine, DAY * (day - 0.5)));
        Place { machine: machine.to_owned(), time, operations }
    }
}

/// From the first to the last operation of a log, s.
fn span(seen: &Visits) -> f64 {
    let ends = seen.list.iter().map(|visit| visit.end).fold(f64::NEG_INFINITY, f64::max);
    ends - seen.list.iter().map(|visit| visit.start).fold(f64::INFINITY, f64::min)
}
