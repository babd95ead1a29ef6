//! The feed override in force, read off the plateau of the reported feed.
//!
//! A log reports an override when it changes. Where it stood at 118 % before the log began, nothing says so; but then the
//! reported feed stands at 118 % of the programmed one wherever the cutter moves long enough.

use super::runs::Run;
use std::collections::BTreeMap;
use toolroom_program::{Program, Purpose};

/// Width of the classes in which the ratio is counted, relative.
const CLASS: f64 = 0.0025;
/// Ratios of the feeds that are counted at all.
const RANGE: std::ops::RangeInclusive<f64> = 0.05..=3.0;
/// Units of the reported feed, mm/min: mm/min, mm/s, in/min, in/s.
const UNITS: [f64; 4] = [1.0, 60.0, 25.4, 1524.0];
/// Least number of reports on the plateau, and their least share of all (assumptions).
const LEAST: usize = 8;
const LEAST_SHARE: f64 = 0.08;

/// Feed of each line of a program that moves at one feed, mm/min.
fn feeds(program: &Program) -> BTreeMap<usize, f64> {
    let mut feeds: BTreeMap<usize, f64> = BTreeMap::new();
    for block in &program.blocks {
        let cut = |motion: &&toolroom_program::Motion| {
            !motion.rapid && motion.purpose != Purpose::Thread && motion.time > 0.0 && !motion.is_rotary()
        };
        if let Some(motion) = block.motions.iter().find(cut) {
            feeds.insert(block.line, 60.0 * motion.length / motion.time);
        }
    }
    feeds
}

/// The override in force of a run, 1 as programmed: the most frequent ratio of the reported feed to that of the reported block,
/// in the unit that brings it nearest to 1. `None` where the log has no feed or no plateau.
pub(super) fn plateau(run: &Run, program: &Program) -> Option<f64> {
    let feeds = feeds(program);
    let mut state = 0;
    let mut raw: Vec<f64> = Vec::new();
    for (time, feed) in &run.feeds {
        while run.states.get(state + 1).is_some_and(|next| next.time <= *time) {
            state += 1;
        }
        let block = run.states.get(state).map_or(f64::NAN, |state| state.block);
        if block >= 1.0
            && let Some(programmed) = feeds.get(&(block as usize)).filter(|_| *feed > 0.0)
        {
            raw.push(feed / programmed);
        }
    }
    let of_unit = |unit: f64| -> Option<(usize, f64)> {
        let mut classes: BTreeMap<i64, (usize, f64)> = BTreeMap::new();
        for ratio in raw.iter().map(|ratio| ratio * unit).filter(|ratio| RANGE.contains(ratio)) {
            let class = classes.entry((ratio.ln() / CLASS).round() as i64).or_default();
            *class = (class.0 + 1, class.1 + ratio);
        }
        let most = classes.values().max_by_key(|(count, _)| *count)?;
        Some((most.0, most.1 / most.0 as f64))
    };
    let found = UNITS.into_iter().filter_map(of_unit);
    let enough = |(count, _): &(usize, f64)| *count >= LEAST && *count as f64 >= LEAST_SHARE * raw.len() as f64;
    found.filter(enough).min_by(|a, b| a.1.ln().abs().total_cmp(&b.1.ln().abs())).map(|(_, ratio)| ratio)
}

/// Whether the log itself has more than one override while the program runs: then its reports are followed.
pub(super) fn changes(run: &Run) -> bool {
    let mut values = run.states.iter().map(|state| state.feed_override).filter(|value| *value > 0.0);
    let first = values.next();
    values.any(|value| Some(value) != first)
}
