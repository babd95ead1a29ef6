//! Groups of an event log, and two logs of one shop, one after the other.

use super::block::{Block, Blocks, DAY};
use super::nominal::Shop;
use super::visit::{Visits, visits};
use std::collections::BTreeSet;
use toolroom_form::vocabulary;
use toolroom_records::Records;

/// Least time between two logs, s: no stay goes on from one to the next.
const APART: f64 = 86400.0;
/// Logs move by whole weeks, s, unless a calendar asks for more.
const WEEK: u64 = 7 * 86400;

vocabulary! {
    /// Parts of a log whose operations may belong together.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum LogGroup {
        /// All operations on a machine.
        Machine = "machine",
        /// All operations in a shift.
        Shift = "shift",
        /// All operations of a day.
        Day = "day",
    }
}

/// Groups of blocks and the group of each; of a machine on a day where the column `by` is none of [`LogGroup`].
pub(super) fn groups(blocks: &Blocks, visits: &Visits, by: Option<&str>) -> (Vec<String>, Vec<usize>) {
    let name = |block: &Block| match by.and_then(LogGroup::from_word) {
        Some(LogGroup::Machine) => visits.machines[block.machine].clone(),
        Some(LogGroup::Shift) => block.shift.clone(),
        Some(LogGroup::Day) => format!("day {:.0}", (block.time / DAY).floor() + 1.0),
        None => blocks.groups[block.group].clone(),
    };
    let all: Vec<String> = blocks.list.iter().map(name).collect();
    let mut names = all.clone();
    names.sort();
    names.dedup();
    let of_row = all.iter().map(|own| names.binary_search(own).unwrap_or(0)).collect();
    (names, of_row)
}

/// The groups that a log falls into.
pub fn groups_of(shop: &Shop, events: &Records, by: Option<&str>) -> BTreeSet<String> {
    let seen = visits(events);
    groups(&Blocks::of(shop, &seen), &seen, by).0.into_iter().collect()
}

/// Another log of the shop, moved behind `first` where it is not: by whole periods of all calendars,
/// so that shifts stay what they are.
#[must_use]
pub fn after(shop: &Shop, records: &Records, mut second: Records) -> Records {
    let (Some(times_before), Some(times)) = (records.numbers("time"), second.numbers("time")) else { return second };
    let end = times_before.iter().copied().fold(f64::NEG_INFINITY, f64::max) + APART;
    let start = times.iter().copied().fold(f64::INFINITY, f64::min);
    if start < end {
        let calendars = shop.stations.iter().filter_map(|station| station.calendar.as_ref());
        let period =
            calendars.fold(WEEK, |all, calendar| multiple(all, calendar.period().round().max(1.0) as u64)) as f64;
        let moved = ((end - start) / period).ceil() * period;
        let times = times.iter().map(|time| time + moved).collect();
        // Edges of one name in logs of the same days are not the same.
        let edges = second.texts("tool_id").map(|names| names.iter().map(|name| another(name)).collect());
        edges.into_iter().for_each(|edges| second.set_texts("tool_id", edges));
        second.set_numbers("time", times);
    }
    second
}

/// Name of an edge of another log; none where none is named.
fn another(name: &str) -> String {
    if name.is_empty() { String::new() } else { format!("{name} (2)") }
}

/// Least common multiple.
fn multiple(a: u64, b: u64) -> u64 {
    let (mut x, mut y) = (a, b);
    while y > 0 {
        (x, y) = (y, x % y);
    }
    a / x * b
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use toolroom_records::RecordKind;

    #[test]
    fn a_second_log_comes_whole_weeks_later_with_edges_of_its_own_unless_it_does_by_itself() {
        let shop =
            Shop { stations: Vec::new(), programs: BTreeMap::new(), sources: Vec::new(), other_sources: Vec::new() };
        let log = |times: [f64; 2]| {
            let mut records = Records::new(RecordKind::Shop, 2);
            records.set_numbers("time", times.into());
            records.set_texts("tool_id", vec!["T1".to_owned(), String::new()]);
            records
        };
        let moved = |times| after(&shop, &log([0.0, 9.5 * APART]), log(times)).numbers("time").map(<[f64]>::to_vec);
        assert_eq!(moved([60.0, 120.0]), Some(vec![14.0 * APART + 60.0, 14.0 * APART + 120.0]));
        assert_eq!(moved([11.0 * APART, 12.0 * APART]), Some(vec![11.0 * APART, 12.0 * APART]));
        let edges = |times| after(&shop, &log([0.0, 9.5 * APART]), log(times)).texts("tool_id").map(<[String]>::to_vec);
        assert_eq!(edges([60.0, 120.0]), Some(vec!["T1 (2)".to_owned(), String::new()]));
        assert_eq!(edges([11.0 * APART, 12.0 * APART]), Some(vec!["T1".to_owned(), String::new()]));
        assert_eq!((multiple(WEEK, 86400), multiple(6, 4)), (WEEK, 12));
    }
}
