//! Parts of records in which an effect may act alone: machines, parts, materials, lots, shifts, operators, and from a
//! date on.

use crate::EffectId;
use toolroom_effects::{Definition, parse_definitions};
use toolroom_records::Records;
use toolroom_scenario::Scope;

/// Definition of a rate of wear of its own, in the words of a user. Another batch or grade of inserts wears at another rate from a date on, on one
/// machine or in one material, and no cause of the catalogue says so: where it is not tried, an effect on the wear of new or
/// of worn edges is named in its place. Everywhere the constant `wear_rate` says the same.
const WEAR_RATE_TEXT: &str = r#"
[[effect]]
id = "constant.wear_rate"
title = "edges wear at another rate"
process = ["turning", "milling"]
size = { unit = "1", ordinary = 0.3, range = [-0.9, 9.0] }
changes = [{ term = "wear_rate", factor = "1 + size" }]
confounder = "run_in"
separating_test = "edges of the earlier delivery beside those of the later one, in the same cut"
source = "no effect but a constant of a part of the records; its ordinary size is an assumption, the spread of lives in shops (25 to 45 %, Machinery's Handbook 31, p. 139)"
"#;

/// Keys of scopes with the columns of records that tell them.
const COLUMNS: [(&str, &str); 6] = [
    ("machine", "machine"),
    ("part", "part_type"),
    ("material", "material"),
    ("lot", "lot"),
    ("shift", "shift"),
    ("operator", "operator"),
];
/// Most levels of a column that are tried one by one (assumption): each takes its share of the evidence.
const MOST_LEVELS: usize = 12;
/// Fewest groups within a scope and outside it: one alone cannot be told from its scatter.
const FEWEST_GROUPS: usize = 2;
/// Shares of the rows before the dates from which on an effect may act.
const DATES: [f64; 7] = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8];
/// Scoped effects of the catalogue at most (assumption): each takes its share of the evidence, and is a bit of a mask of 128.
pub(crate) const MOST: usize = 48;
/// Parts on which a rate of wear of its own is tried at most (assumption).
pub(crate) const MOST_RATES: usize = 20;

/// A rate of wear that is another one, as the file defines it or as it is known here; `None` where it cannot be.
pub(crate) fn wear_rate(defined: &[&'static Definition]) -> Option<&'static Definition> {
    let written = defined.iter().copied().find(|own| EffectId::from(*own).is_wear_rate());
    written.or_else(|| parse_definitions("catalogue", WEAR_RATE_TEXT).ok()?.first().copied())
}

/// A part of the records: 1 on its rows, 0 elsewhere.
pub(crate) struct Part {
    pub scope: Scope,
    pub rows: Vec<f64>,
    /// The only level of its column that is no part of it.
    left_out: Option<String>,
}

impl Part {
    /// Whether it is the level `name` of the column `column`.
    pub fn is_level(&self, column: &str, name: &str) -> bool {
        self.of_column(column).is_some_and(|levels| levels[..] == [name.to_owned()])
    }

    /// Whether it is all of the column `column` but the level `name`.
    pub fn leaves_out(&self, column: &str, name: &str) -> bool {
        self.of_column(column).is_some() && self.left_out.as_deref() == Some(name)
    }

    /// The levels of the column `column` that it is.
    fn of_column(&self, column: &str) -> Option<&Vec<String>> {
        let (key, _) = COLUMNS.iter().find(|(_, own)| *own == column)?;
        let [(own, levels)] = &self.scope.names[..] else { return None };
        (own == key).then_some(levels)
    }

    /// The shape of a candidate on this part, for people.
    pub fn words(&self, shape: &str) -> String {
        let scope = self.scope.words();
        [shape, &scope].into_iter().filter(|own| !own.is_empty()).collect::<Vec<&str>>().join(", ")
    }
}

/// Parts of the records in which an effect may act alone: levels of a column, all levels but one, and what follows a
/// date.
pub(crate) fn parts(records: &Records, groups: &[usize]) -> Vec<Part> {
    let mut parts = Vec::new();
    let told = |rows: &[f64]| {
        [1.0, 0.0].into_iter().all(|side| {
            let mut inside: Vec<usize> =
                groups.iter().zip(rows).filter(|(_, on)| **on == side).map(|(group, _)| *group).collect();
            inside.sort_unstable();
            inside.dedup();
            inside.len() >= FEWEST_GROUPS
        })
    };
    let mut add = |scope: Scope, rows: Vec<f64>, left_out: Option<String>| {
        // Two columns that tell the same are one.
        if told(&rows) && parts.iter().all(|own: &Part| own.rows != rows) {
            parts.push(Part { scope, rows, left_out });
        }
    };
    for (key, column) in COLUMNS {
        let Some((names, of_row)) = records.levels(column) else { continue };
        let named = |level: &usize| !names[*level].is_empty();
        let levels: Vec<usize> = (0..names.len()).filter(named).collect();
        if levels.len() < 2 || levels.len() > MOST_LEVELS {
            continue;
        }
        let of = |names: Vec<String>| Scope { names: vec![(key, names)], ..Scope::default() };
        for level in &levels {
            let rows = of_row.iter().map(|own| f64::from(u8::from(own == level))).collect();
            let left_out = match levels[..] {
                [first, second] => Some(names[if *level == first { second } else { first }].clone()),
                _ => None,
            };
            add(of(vec![names[*level].clone()]), rows, left_out);
        }
        if levels.len() > 2 {
            for level in &levels {
                let others = levels.iter().filter(|own| *own != level).map(|own| names[*own].clone()).collect();
                let rows = of_row.iter().map(|own| f64::from(u8::from(own != level && named(own)))).collect();
                add(of(others), rows, Some(names[*level].clone()));
            }
        }
    }
    if let Some(times) = records.numbers("start_time") {
        let mut sorted: Vec<f64> = times.iter().copied().filter(|time| time.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        for share in DATES {
            let Some(from) = sorted.get((share * sorted.len() as f64) as usize) else { continue };
            let rows = times.iter().map(|time| f64::from(u8::from(time >= from))).collect();
            add(Scope { from: Some(*from), ..Scope::default() }, rows, None);
        }
    }
    parts
}
