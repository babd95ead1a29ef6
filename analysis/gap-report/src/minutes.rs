//! Minutes and money a week.

use crate::Reading;
use crate::readings::Readings;
use crate::{DAY, WEEK};
use std::collections::BTreeMap;

/// Mean of the times in cut over their middle, of what is stopped from time to time.
const EXCESS: &str = "cutting_excess";
/// Channels whose values are time of a machine.
const TIMES: [&str; 5] = ["cycle_time", "cutting_time", "handling_time", "tool_change_time", "feed_hold_time"];

/// What an hour of each machine costs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rates {
    /// Currency code.
    pub currency: String,
    /// Cost of a second of a machine, by its name.
    pub by_machine: BTreeMap<String, f64>,
}

/// A step of the waterfall.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// `nominal model`, `calibration`, an effect (with its scope, where several have its id), `unexplained`, `recorded`.
    pub label: String,
    /// Machine time a week, min; of the first and the last the total, else the change.
    pub minutes: f64,
    /// Cost a week; of machines without a rate nothing.
    pub money: f64,
}

/// Machine time and cost of the recorded operations a week. The steps between the first and the last add up to
/// their difference.
#[derive(Clone, Debug, PartialEq)]
pub struct Minutes {
    /// Currency code; empty where no machine has a rate.
    pub currency: String,
    /// Recorded time, weeks.
    pub weeks: f64,
    /// Steps, from the nominal model to the records.
    pub steps: Vec<Step>,
}

impl Minutes {
    /// Of readings of times; `None` where no time was measured, or not for a day.
    pub fn from_readings(readings: &Readings, rates: &Rates) -> Option<Self> {
        let timed: Vec<usize> = (0..readings.channels.len())
            .filter(|channel| TIMES.contains(&readings.channels[*channel].name.as_str()))
            .collect();
        let all = || timed.iter().flat_map(|channel| readings.of(*channel));
        let times = all().map(|reading| reading.place.time).filter(|time| time.is_finite());
        let (first, last) = times.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), time| (a.min(time), b.max(time)));
        let span = readings.span.unwrap_or(last - first);
        if span.is_nan() || span < DAY {
            return None;
        }
        let weeks = span / WEEK;
        let excess = excesses(readings);
        // Stage of the model, or what was measured behind the last one.
        let time = |reading: &Reading, stage: usize| {
            let Some(stage_value) = reading.stages.get(stage) else { return reading.measured };
            let place = (reading.channel, reading.place.machine.clone(), reading.place.time.to_bits());
            stage_value * excess.get(&place).map_or(1.0, |means| means[stage] / means[means.len() - 1])
        };
        let sum = |value: &dyn Fn(&Reading) -> f64| {
            all().fold([0.0; 2], |[minutes, money], reading| {
                let seconds = value(reading) * reading.place.operations;
                let rate = rates.by_machine.get(&reading.place.machine).copied().unwrap_or(0.0);
                [minutes + seconds / 60.0 / weeks, money + seconds * rate / weeks]
            })
        };
        let step = |label: &str, [minutes, money]: [f64; 2]| Step { label: label.to_owned(), minutes, money };
        let mut steps = vec![step("nominal model", sum(&|reading| time(reading, 0)))];
        for (stage, name) in readings.stages.iter().enumerate() {
            steps.push(step(name, sum(&|reading| time(reading, stage + 1) - time(reading, stage))));
        }
        steps.push(step("unexplained", sum(&|reading| reading.measured - time(reading, readings.stages.len()))));
        steps.push(step("recorded", sum(&|reading| reading.measured)));
        let currency = if rates.by_machine.is_empty() { String::new() } else { rates.currency.clone() };
        Some(Self { currency, weeks, steps })
    }

    /// What an effect costs a week, or saves, in a sentence.
    pub fn effect(&self, label: &str) -> Option<String> {
        let saves = self.steps.iter().find(|step| step.label == label)?.minutes < 0.0;
        let cost = self.cost(label)?.replace('-', "");
        Some(format!("It {} {cost}.", if saves { "saves" } else { "costs" }))
    }

    /// What a step costs a week, in words: `41 min and 58 EUR a week`.
    pub fn cost(&self, label: &str) -> Option<String> {
        let step = self.steps.iter().find(|step| step.label == label)?;
        let money =
            if self.currency.is_empty() { String::new() } else { format!(" and {:.0} {}", step.money, self.currency) };
        Some(format!("{:.0} min{money} a week", step.minutes))
    }
}

/// Means of the excess of times in cut by the channel of these times and by machine and day: of each stage, then as measured. A
/// reading of the times is a middle, and what stops an operation now and then moves the mean alone.
fn excesses(readings: &Readings) -> BTreeMap<(usize, String, u64), Vec<f64>> {
    let channel = |name: &str| readings.channels.iter().position(|own| own.name == name);
    let (Some(cut), Some(excess)) = (channel("cutting_time"), channel(EXCESS)) else { return BTreeMap::new() };
    let mut all: BTreeMap<(usize, String, u64), (Vec<f64>, f64)> = BTreeMap::new();
    for reading in readings.of(excess) {
        let place = (cut, reading.place.machine.clone(), reading.place.time.to_bits());
        let (sums, count) = all.entry(place).or_insert_with(|| (vec![0.0; reading.stages.len() + 1], 0.0));
        let values = reading.stages.iter().chain([&reading.measured]);
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        *count += 1.0;
    }
    let mean = |(sums, count): (Vec<f64>, f64)| sums.into_iter().map(|sum| sum / count).collect();
    all.into_iter().map(|(place, own)| (place, mean(own))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::readings::ReadChannel;
    use crate::{Place, Reading};

    #[test]
    fn the_steps_of_the_waterfall_add_up() {
        let reading = |day: f64, measured: f64| Reading {
            channel: 0,
            place: Place { machine: "L1".to_owned(), time: day * DAY, operations: 10.0 },
            measured,
            stages: vec![100.0, 101.0, 107.0],
        };
        let readings = Readings {
            channels: vec![ReadChannel {
                name: "cycle_time".to_owned(),
                unit: "s".to_owned(),
                display: "s".to_owned(),
                relative: true,
            }],
            stages: vec!["calibration".to_owned(), "feed_override".to_owned()],
            list: vec![reading(0.0, 108.0), reading(7.0, 107.0)],
            span: None,
        };
        let rates =
            Rates { currency: "EUR".to_owned(), by_machine: BTreeMap::from([("L1".to_owned(), 60.0 / 3600.0)]) };
        let minutes = Minutes::from_readings(&readings, &rates).expect("a week of times");
        let by_step: Vec<f64> = minutes.steps.iter().map(|step| step.minutes).collect();
        assert!((by_step[..4].iter().sum::<f64>() - by_step[4]).abs() < 1e-9, "{by_step:?}");
        assert_eq!(minutes.cost("feed_override").as_deref(), Some("2 min and 2 EUR a week"));
        assert_eq!(minutes.effect("feed_override").as_deref(), Some("It costs 2 min and 2 EUR a week."));
        let faster = |step: &Step| Step { minutes: -step.minutes, money: -step.money, label: step.label.clone() };
        let saved = Minutes { steps: minutes.steps.iter().map(faster).collect(), ..minutes.clone() };
        assert_eq!(saved.effect("feed_override").as_deref(), Some("It saves 2 min and 2 EUR a week."));
        assert!((by_step[2] - 2.0).abs() < 1e-12, "twenty operations, 6 s each");
        assert!(Minutes::from_readings(&Readings { list: vec![reading(0.0, 1.0)], ..readings }, &rates).is_none());
    }
}
