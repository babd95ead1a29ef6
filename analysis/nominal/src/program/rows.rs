//! What the rows of timed stretches hold beside their times.

use super::ProgramModel;
use crate::Measured;
use std::collections::BTreeMap;
use toolroom_program::{Action, Block, Program};
use toolroom_records::Records;
use toolroom_statistics::median;

/// Share by which an override may differ from 100 % where the run still counts as undisturbed.
const UNTOUCHED: f64 = 0.005;

/// Quantities of every row.
#[derive(Debug, Default)]
pub(super) struct Rows {
    /// Program, first block and end, by index; `None` where the program is not known.
    pub of_program: Vec<Option<(usize, usize, usize)>>,
    /// Median of undisturbed runs of the same program, s; NaN where there is none.
    pub median: Vec<f64>,
    /// Whether there is a nominal time at all.
    pub known: Vec<bool>,
    /// Time that the logged feed override would add, s: `feed_time·(1/override − 1)`.
    pub overridden: Vec<f64>,
    /// Tool changes; of whole runs, those beside the usual ones.
    pub changes: Vec<f64>,
    /// Holes of canned cycles.
    pub holes: Vec<f64>,
    /// Holds.
    pub holds: Vec<f64>,
    /// Logged time of holds, s.
    pub hold_time: Vec<f64>,
    /// Logged time of holds over the mean of a hold.
    pub hold_share: Vec<f64>,
    /// Ends of a program.
    pub ends: Vec<f64>,
    /// Pockets of the magazine between old tools and new ones.
    pub pockets: Vec<f64>,
    /// Blocks with M codes.
    pub auxiliary: Vec<f64>,
    /// Share of rapid motions in the nominal time.
    pub rapid_share: Vec<f64>,
    /// Motions at feed per second.
    pub density: Vec<f64>,
    /// Blocks per second.
    pub block_density: Vec<f64>,
    /// Logarithm of the mean feed.
    pub ln_feed: Vec<f64>,
}

/// Rows by group, place in the program and time.
pub(super) fn order(records: &Records, groups: &[usize]) -> Vec<usize> {
    let number = |name: &str, row: usize| records.numbers(name).map_or(0.0, |values| values[row]);
    let text = |name: &str, row: usize| records.texts(name).map_or("", |texts| texts[row].as_str());
    let mut order: Vec<usize> = (0..records.len()).collect();
    order.sort_by(|a, b| {
        let by = |name: &str| number(name, *a).total_cmp(&number(name, *b));
        groups[*a]
            .cmp(&groups[*b])
            .then_with(|| text("program", *a).cmp(text("program", *b)))
            .then_with(|| by("first_block"))
            .then_with(|| by("start_time"))
            .then_with(|| text("operation_id", *a).cmp(text("operation_id", *b)))
    });
    order
}

/// Reads off what the rows of `records` are; `inside` says which take part in the fit: medians are
/// theirs.
pub(super) fn rows(model: &ProgramModel, records: &Records, inside: &[bool]) -> Rows {
    let count = records.len();
    let finite = |name: &str, missing: f64| -> Vec<f64> {
        let values = records.numbers(name).map_or_else(|| vec![missing; count], <[f64]>::to_vec);
        values.into_iter().map(|value| if value.is_finite() { value } else { missing }).collect()
    };
    let empty = vec![String::new(); count];
    let programs = records.texts("program").unwrap_or(&empty);
    let (share, times) = (finite("feed_override", 1.0), finite("cycle_time", f64::NAN));
    let (holds, hold_time) = (finite("hold_count", 0.0), finite("hold_time", 0.0));
    let (first, last) = (finite("first_block", f64::NAN), finite("last_block", f64::NAN));
    let mean_hold = hold_time.iter().sum::<f64>() / holds.iter().sum::<f64>();
    let mut rows = Rows {
        changes: finite("tool_changes", 0.0),
        holds: holds.clone(),
        hold_share: hold_time.iter().map(|time| if mean_hold > 0.0 { time / mean_hold } else { 0.0 }).collect(),
        hold_time,
        ..Rows::default()
    };
    let untouched = |row: usize| (share[row] - 1.0).abs() < UNTOUCHED && holds[row] == 0.0 && inside[row];
    let mut usual: BTreeMap<&str, (Vec<f64>, Vec<f64>)> = BTreeMap::new();
    for row in (0..count).filter(|row| untouched(*row) && times[*row].is_finite()) {
        let usual_times = usual.entry(&programs[row]).or_default();
        usual_times.0.push(times[row]);
        usual_times.1.push(rows.changes[row]);
    }
    let usual: BTreeMap<&str, (f64, f64)> = usual
        .into_iter()
        .map(|(name, (mut times, mut changes))| (name, (median(&mut times), median(&mut changes))))
        .collect();
    let magazines: Vec<Vec<f64>> = model.programs.iter().map(|(_, program)| pockets(program)).collect();
    for row in 0..count {
        let place = model.programs.iter().position(|(name, _)| *name == programs[row]).and_then(|index| {
            let blocks = &model.programs[index].1.blocks;
            // Lines without words are no blocks: a stretch begins with the first block that it holds.
            let begin = blocks.iter().position(|block| block.line as f64 >= first[row])?;
            let end = blocks.iter().rposition(|block| block.line as f64 <= last[row])? + 1;
            (begin < end).then_some((index, begin, end))
        });
        let (typical, changes) = usual.get(programs[row].as_str()).copied().unwrap_or((f64::NAN, f64::NAN));
        let blocks = place.map_or(&[][..], |(index, begin, end)| &model.programs[index].1.blocks[begin..end]);
        let rapid_speed = model.drives.rapid_speed;
        let nominal: f64 = blocks.iter().map(|block| block.nominal(rapid_speed)).sum();
        let feed: f64 = blocks.iter().map(|block| block.feed_time()).sum();
        let way: f64 = blocks.iter().flat_map(|block| &block.motions).map(|motion| 1e-3 * motion.feed_length()).sum();
        let motions = blocks.iter().flat_map(|block| &block.motions).filter(|motion| !motion.rapid).count();
        rows.of_program.push(place);
        rows.median.push(typical);
        rows.known.push(place.is_some() || typical.is_finite());
        let moved = if place.is_some() { feed } else { typical };
        let slower = if share[row] > 0.0 { 1.0 / share[row] - 1.0 } else { 0.0 };
        // The log knows overrides to a per cent: less is none.
        rows.overridden.push(if slower.abs() < UNTOUCHED || !moved.is_finite() { 0.0 } else { moved * slower });
        rows.changes[row] = match place {
            Some(_) => blocks.iter().filter(|block| block.tool_change).count() as f64,
            None if changes.is_finite() => rows.changes[row] - changes,
            None => 0.0,
        };
        let behind = |(index, begin, end): (usize, usize, usize)| magazines[index][begin..end].iter().sum();
        rows.pockets.push(place.map_or(0.0, behind));
        let ends = |block: &&Block| block.actions.iter().any(|(_, action)| matches!(action, Action::End));
        rows.ends.push(blocks.iter().filter(ends).count() as f64);
        rows.holes.push(blocks.iter().map(|block| f64::from(block.holes)).sum());
        rows.auxiliary.push(blocks.iter().filter(|block| block.auxiliary).count() as f64);
        rows.rapid_share.push(if nominal > 0.0 { 1.0 - feed / nominal } else { 0.0 });
        rows.density.push(if feed > 0.0 { motions as f64 / feed } else { 0.0 });
        rows.block_density.push(if nominal > 0.0 { blocks.len() as f64 / nominal } else { 0.0 });
        rows.ln_feed.push(if feed > 0.0 && way > 0.0 { (way / feed).ln() } else { f64::NAN });
    }
    rows
}

/// Pockets of the magazine that the tool change of each block passes; none where the tool before is not known.
fn pockets(program: &Program) -> Vec<f64> {
    let mut before = None;
    let mut passed = |block: &Block| {
        let mut sum = 0;
        for (_, action) in &block.actions {
            if let Action::Change(tool) = action {
                sum += tool.zip(before).map_or(0, |(new, old): (u32, u32)| new.abs_diff(old));
                before = tool.or(before);
            }
        }
        f64::from(sum)
    };
    program.blocks.iter().map(&mut passed).collect()
}

/// Mean measured and predicted time of each stretch of the known programs, with one of its rows.
fn means(
    rows: &Rows,
    measured: &Measured,
    predicted: &[f64],
    inside: impl Fn(usize) -> bool,
) -> Vec<(f64, f64, usize)> {
    let mut sums: BTreeMap<(usize, usize), (f64, f64, f64, usize)> = BTreeMap::new();
    for (observation, predicted) in measured.observations.iter().zip(predicted) {
        let Some((program, first, _)) = rows.of_program[observation.row] else { continue };
        if inside(observation.row) {
            let sum = sums.entry((program, first)).or_insert((0.0, 0.0, 0.0, observation.row));
            *sum = (sum.0 + observation.value, sum.1 + predicted, sum.2 + 1.0, sum.3);
        }
    }
    sums.into_values().map(|(value, predicted, count, row)| (value / count, predicted / count, row)).collect()
}

/// Mean measured and predicted time of a run of each program, in words.
pub(super) fn totals(model: &ProgramModel, rows: &Rows, measured: &Measured, predicted: &[f64]) -> Vec<String> {
    let out = |row: usize| !measured.fitted[measured.group_of_row[row]];
    let any = (0..rows.of_program.len()).any(out);
    let list = means(rows, measured, predicted, |row| !any || out(row));
    let level_of = |(index, (name, _)): (usize, &(String, Program))| {
        let of_program =
            list.iter().filter(|(_, _, row)| rows.of_program[*row].is_some_and(|(program, ..)| program == index));
        let (value, predicted) =
            of_program.fold((0.0, 0.0), |sum, (value, predicted, _)| (sum.0 + value, sum.1 + predicted));
        let whose = if any { " held out" } else { "" };
        (value > 0.0).then(|| {
            let gap = 100.0 * (value / predicted - 1.0);
            format!("{name}: a run{whose} takes {value:.1} s, nominal {predicted:.1} s ({gap:+.1} %)")
        })
    };
    model.programs.iter().enumerate().filter_map(level_of).collect()
}

/// The stretches that differ most from `predicted` in the mean of their runs, in words.
pub(super) fn places(
    model: &ProgramModel,
    rows: &Rows,
    measured: &Measured,
    predicted: &[f64],
    most: usize,
) -> Vec<String> {
    let mut list = means(rows, measured, predicted, |_| true);
    list.sort_by(|a, b| (b.0 - b.1).abs().total_cmp(&(a.0 - a.1).abs()));
    let words = |(value, predicted, row): &(f64, f64, usize)| {
        let (program, first, end) = rows.of_program[*row].unwrap_or_default();
        let (name, program) = &model.programs[program];
        let blocks = &program.blocks[first..end];
        let (from, to) = (blocks.first().map_or(0, |block| block.line), blocks.last().map_or(0, |block| block.line));
        let tool = blocks.last().and_then(|block| block.tool).map_or(String::new(), |tool| format!(" T{tool}"));
        let what = if blocks.iter().any(|block| block.tool_change) {
            "tool change"
        } else if blocks.iter().any(|block| block.holes > 0) {
            "holes"
        } else if blocks.iter().all(|block| block.motions.is_empty()) {
            "no motion"
        } else {
            "motions"
        };
        format!("{name}{tool}, {what} of blocks {from} to {to}: {value:.1} s measured, {predicted:.1} s nominal")
    };
    list.iter().take(most).map(words).collect()
}
