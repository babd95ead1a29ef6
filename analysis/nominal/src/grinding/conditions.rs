//! Conditions of recorded trials, and what stands in for what was not recorded.

use super::plunge::Stage;
use crate::features;
use std::collections::BTreeMap;
use toolroom_infeed::Input;
use toolroom_records::Records;

/// Time of a part beside grinding and waiting, s (assumption), where no start time is recorded.
const HANDLING: f64 = 60.0;

/// Conditions of all trials.
pub(super) struct Conditions {
    pub inputs: Vec<Input>,
    pub revolutions: Vec<f64>,
    pub spark_out: Vec<f64>,
    pub finish: Vec<Stage>,
    /// Parts ground between the trial before and this one.
    pub between: Vec<f64>,
    /// Stock of a part between trials, m.
    pub ordinary_stock: f64,
}

impl Conditions {
    /// Conditions of `records`, and what had to be assumed.
    pub fn new(records: &Records) -> (Self, Vec<String>) {
        let column = |name: &str| {
            records.numbers(name).map_or_else(
                || vec![0.0; records.len()],
                |v| v.iter().map(|x| if x.is_finite() { *x } else { 0.0 }).collect(),
            )
        };
        let (infeed, rotation) = (column("infeed_per_rev"), column("work_rotation_speed"));
        let (revolutions, spark_out) = (column("revolutions"), column("spark_out_revolutions"));
        let finish: Vec<Stage> = (column("finish_infeed_per_rev").into_iter().zip(column("finish_revolutions")))
            .map(|(infeed_per_rev, revolutions)| Stage { infeed_per_rev, revolutions })
            .collect();
        let (age, wait) = (column("coolant_age"), column("wait_time"));
        let between = between(records);
        let mut notes = Vec::new();
        let time = features::elapsed(records).unwrap_or_else(|| {
            notes.push(
                "no start_time: the age of the machine is reckoned from the order of the trials, a minute each beside \
                 grinding and waiting; the size of stiffness_drift is as good as that"
                    .to_owned(),
            );
            let turns =
                |row: usize| (revolutions[row] + finish[row].revolutions + spark_out[row]) * std::f64::consts::TAU;
            let grinding = |row: usize| if rotation[row] > 0.0 { turns(row) / rotation[row] } else { 0.0 };
            reckoned(records, |row| (1.0 + between[row]) * (grinding(row) + wait[row] + HANDLING))
        });
        let inputs = (0..records.len())
            .map(|row| Input {
                infeed_per_rev: infeed[row],
                work_rotation_speed: rotation[row],
                coolant_age: age[row],
                wait_time: wait[row],
                machine_time: if time[row].is_finite() { time[row] } else { 0.0 },
                ..Input::default()
            })
            .collect();
        let commanded =
            |row: usize| infeed[row] * revolutions[row] + finish[row].infeed_per_rev * finish[row].revolutions;
        let ordinary_stock = (0..records.len()).map(commanded).sum::<f64>() / records.len().max(1) as f64;
        (Self { inputs, revolutions, spark_out, finish, between, ordinary_stock }, notes)
    }

    /// Age of the machine at the last trial, s.
    pub fn latest(&self) -> f64 {
        self.inputs.iter().map(|input| input.machine_time).fold(0.0, f64::max)
    }
}

/// Running sums of `duration` by machine.
fn reckoned(records: &Records, duration: impl Fn(usize) -> f64) -> Vec<f64> {
    let machines = records.levels("machine").map_or_else(|| vec![0; records.len()], |(_, of_row)| of_row);
    let mut clocks = BTreeMap::new();
    let of_row = |(row, machine): (usize, &usize)| {
        let clock = clocks.entry(*machine).or_insert(0.0);
        *clock += duration(row);
        *clock
    };
    machines.iter().enumerate().map(of_row).collect()
}

/// Names of machine, wheel and dressing cycle of a row; empty where not recorded.
fn names(records: &Records, row: usize) -> [&str; 3] {
    ["machine", "wheel_id", "dressing_cycle"].map(|column| records.texts(column).map_or("", |texts| &texts[row]))
}

/// Dressings as groups: names and each row's group. A cycle is one of a wheel on a machine;
/// without a recorded cycle one begins wherever `part_in_cycle` starts anew.
pub fn dressings(records: &Records) -> (Vec<String>, Vec<usize>) {
    let numbered = records.texts("dressing_cycle").is_some_and(|texts| texts.iter().any(|text| !text.is_empty()));
    let parts = records.numbers("part_in_cycle").filter(|_| !numbered);
    let mut last: BTreeMap<[&str; 3], (f64, usize)> = BTreeMap::new();
    let keys: Vec<([&str; 3], usize)> = (0..records.len())
        .map(|row| {
            let key = names(records, row);
            let (before, cycle) = last.entry(key).or_insert((f64::NEG_INFINITY, 1));
            if let Some(part) = parts.map(|parts| parts[row]).filter(|part| part.is_finite()) {
                *cycle += usize::from(part <= *before);
                *before = part;
            }
            (key, *cycle)
        })
        .collect();
    let mut distinct = keys.clone();
    distinct.sort_unstable();
    distinct.dedup();
    let of_row = keys.iter().map(|key| distinct.binary_search(key).unwrap_or(0)).collect();
    let own = |place: usize| distinct.iter().map(|(key, _)| key[place]).collect::<std::collections::BTreeSet<_>>();
    let alone = numbered && own(2).len() == distinct.len();
    let several = [own(0).len() > 1, own(1).len() > 1];
    let name = |(key, cycle): &([&str; 3], usize)| {
        if alone {
            return key[2].to_owned();
        }
        let mut name: Vec<String> = (0..2).filter(|place| several[*place]).map(|place| key[place].to_owned()).collect();
        name.push(if numbered { key[2].to_owned() } else { format!("dressing {cycle}") });
        name.join(" ")
    };
    (distinct.iter().map(name).collect(), of_row)
}

/// Parts between the trial before in the same dressing and each trial.
fn between(records: &Records) -> Vec<f64> {
    let (_, groups) = dressings(records);
    let Some(parts) = records.numbers("part_in_cycle") else { return vec![0.0; records.len()] };
    let mut seen: BTreeMap<usize, f64> = BTreeMap::new();
    let of_row = |(row, group): (usize, &usize)| {
        let seen = seen.entry(*group).or_insert(0.0);
        let part = if parts[row].is_finite() { parts[row] } else { *seen + 1.0 };
        let between = (part - *seen - 1.0).clamp(0.0, 1e4);
        *seen = part.max(*seen + 1.0);
        between
    };
    groups.iter().enumerate().map(of_row).collect()
}
