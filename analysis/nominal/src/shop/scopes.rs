//! Parts of a shop's log on which an effect may act alone: shifts, machines, pools of machines, parts, and all from a day on.

use super::block::{Block, DAY};
use super::nominal::Shop;
use super::visit::Visits;
use std::collections::BTreeSet;
use toolroom_scenario::Scope;

/// Shifts, machines or parts among which one may have an effect of its own (count). Assumption: among more the price of
/// the choice hides what is to be found.
const MOST_LEVELS: usize = 12;
/// Machines or pools in one shift that are tried (count). Assumption: as above.
const MOST_CROSSED: usize = 24;

/// A part of the blocks, with the weight of each block in it.
pub(super) type Part = (Scope, Vec<f64>);

/// Parts of the blocks on which an effect may act: shifts, machines and parts one by one, pools of machines, machines and pools in
/// one shift, and all from the beginning of a day on. Of parts that hold the same blocks the first counts.
pub(super) fn parts(shop: &Shop, visits: &Visits, blocks: &[Block]) -> Vec<Part> {
    let part = |block: &Block| block.program.and_then(|program| Some(visits.programs[program].split_once('/')?.0));
    let shifts: Vec<String> = blocks.iter().map(|block| block.shift.clone()).collect();
    let machines: Vec<String> = blocks.iter().map(|block| visits.machines[block.machine].clone()).collect();
    let made: Vec<String> = blocks.iter().map(|block| part(block).unwrap_or_default().to_owned()).collect();
    let mut found: Vec<Part> = Vec::new();
    let mut add = |names: Vec<(&'static str, Vec<&str>)>, from: Option<f64>, on: Vec<f64>| {
        let known = |own: &Part| own.1 == on;
        if on.contains(&1.0) && on.contains(&0.0) && !found.iter().any(known) {
            let owned = |(key, list): (&'static str, Vec<&str>)| (key, list.into_iter().map(str::to_owned).collect());
            found.push((Scope { names: names.into_iter().map(owned).collect(), from, until: None }, on));
        }
    };
    let on = |names: &[String], test: &dyn Fn(&str) -> bool| -> Vec<f64> {
        names.iter().map(|name| f64::from(u8::from(test(name)))).collect()
    };
    for (key, names) in [("shift", &shifts), ("machine", &machines), ("part", &made)] {
        for level in levels(names) {
            add(vec![(key, vec![level])], None, on(names, &|name| name == level));
        }
    }
    let pools = pools(shop, visits);
    for pool in pools.iter().chain(&all_but_one(visits)) {
        add(vec![("machine", pool.clone())], None, on(&machines, &|name| pool.contains(&name)));
    }
    let alone = visits.machines.iter().map(|name| vec![name.as_str()]);
    let (places, turns) = (alone.chain(pools).collect::<Vec<_>>(), levels(&shifts));
    if places.len() * turns.len() <= MOST_CROSSED {
        for place in &places {
            for shift in &turns {
                let both = machines
                    .iter()
                    .zip(&shifts)
                    .map(|(machine, own)| f64::from(u8::from(place.contains(&machine.as_str()) && own == *shift)));
                add(vec![("machine", place.clone()), ("shift", vec![*shift])], None, both.collect());
            }
        }
    }
    for from in days(blocks) {
        let on = blocks.iter().map(|block| f64::from(u8::from(block.time >= from))).collect();
        add(Vec::new(), Some(from), on);
    }
    found
}

/// Beginnings of days, s, but for the first and the last tenth of the log; of many, as many as a name may have levels.
fn days(blocks: &[Block]) -> Vec<f64> {
    let times = || blocks.iter().map(|block| block.time);
    let (first, last) = (times().fold(f64::INFINITY, f64::min), times().fold(f64::NEG_INFINITY, f64::max));
    let edge = 0.1 * (last - first);
    let days: BTreeSet<i64> = times().map(|time| (time / DAY).floor() as i64).collect();
    let all: Vec<f64> = days.into_iter().map(|day| day as f64 * DAY).collect();
    let inner: Vec<f64> = all.into_iter().filter(|day| *day > first + edge && *day < last - edge).collect();
    let step = inner.len().div_ceil(MOST_LEVELS).max(1);
    inner.into_iter().step_by(step).collect()
}

/// Names that occur, where they are two to twelve.
fn levels(names: &[String]) -> Vec<&str> {
    let levels: BTreeSet<&str> = names.iter().map(String::as_str).filter(|name| !name.is_empty()).collect();
    if (2..=MOST_LEVELS).contains(&levels.len()) { levels.into_iter().collect() } else { Vec::new() }
}

/// Several of the machines that have something in common, but not all: those of one process, those that run one program.
fn pools<'a>(shop: &Shop, visits: &'a Visits) -> Vec<Vec<&'a str>> {
    let process = |machine: usize| shop.station(&visits.machines[machine]).map(|station| station.process.as_str());
    let kinds: BTreeSet<&str> = (0..visits.machines.len()).filter_map(process).collect();
    let mut pools: Vec<Vec<&str>> =
        kinds.iter().map(|kind| those(visits, &|machine| process(machine) == Some(*kind))).collect();
    for program in 0..visits.programs.len() {
        let runs = visits.list.iter().filter(|visit| visit.program == program).map(|visit| visit.machine);
        let runs: BTreeSet<usize> = runs.collect();
        pools.push(those(visits, &|machine| runs.contains(&machine)));
    }
    let mut several: Vec<Vec<&str>> = Vec::new();
    for pool in pools.into_iter().filter(|pool| pool.len() > 1 && pool.len() < visits.machines.len()) {
        if !several.contains(&pool) {
            several.push(pool);
        }
    }
    several
}

/// All machines but one of three or more.
fn all_but_one(visits: &Visits) -> Vec<Vec<&str>> {
    let count = visits.machines.len();
    if !(3..=MOST_LEVELS).contains(&count) {
        return Vec::new();
    }
    (0..count).map(|left_out| those(visits, &|machine| machine != left_out)).collect()
}

/// Names of the machines for which `test` holds.
fn those<'a>(visits: &'a Visits, test: &dyn Fn(usize) -> bool) -> Vec<&'a str> {
    let chosen = (0..visits.machines.len()).filter(|machine| test(*machine));
    chosen.map(|machine| visits.machines[machine].as_str()).collect()
}
