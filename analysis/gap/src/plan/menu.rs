//! Blocks of runs that a shop can make, around what it has run.

use super::REPLICATES;
use toolroom_records::{ColumnKind, RecordKind, Records};
use toolroom_statistics::median;

/// Handling of a part and change of an edge, min (assumptions).
const HANDLING: f64 = 0.5;
const CHANGE: f64 = 2.0;

/// Runs on offer.
pub(super) struct Offered {
    pub design: String,
    pub minutes: f64,
    pub runs: Records,
}

/// One factor of a block, by its place in the edge.
type Factor = fn(usize, usize) -> f64;

/// From the least to the greatest, evenly by the logarithm.
fn sweep(place: usize, of: usize) -> f64 {
    0.6 * (1.5_f64 / 0.6).powf(place as f64 / (of - 1) as f64)
}

/// Up and down, so that wear and the swept quantity part ways.
fn zigzag(place: usize, of: usize) -> f64 {
    sweep(place * 5 % of, of)
}

fn shifted(place: usize, of: usize) -> f64 {
    sweep((place * 3 + 2) % of, of)
}

/// What is swept in a block, with how many operations an edge.
struct Recipe {
    design: &'static str,
    operations: usize,
    factors: &'static [(&'static str, Factor)],
    /// Column of words that alternates between two of its levels.
    alternated: Option<&'static str>,
    /// Column of numbers that alternates between nought and its greatest.
    refreshed: Option<&'static str>,
}

const fn swept(design: &'static str, operations: usize, factors: &'static [(&'static str, Factor)]) -> Recipe {
    Recipe { design, operations, factors, alternated: None, refreshed: None }
}

const fn alternated(design: &'static str, column: &'static str) -> Recipe {
    Recipe { design, operations: 12, factors: &[], alternated: Some(column), refreshed: None }
}

const CUTTING: &[Recipe] = &[
    swept("speed sweep of 14 levels, ×0.6 to ×1.5, in mixed order", 14, &[("cutting_speed", zigzag)]),
    swept(
        "feed and depth sweeps of 12 levels, in mixed order",
        12,
        &[("feed_per_rev", zigzag), ("feed_per_tooth", zigzag), ("depth_of_cut", shifted)],
    ),
    swept("operations of mixed length, ×0.2 to ×2", 12, &[("cutting_time", |place, of| 1.33 * zigzag(place, of))]),
    swept("wear read early and often: 12 short operations on a new edge", 12, &[("cutting_time", |_, _| 0.25)]),
    swept("the same runs as so far, on new edges", 12, &[]),
    alternated("dry and wet, or two coolants, in turns at constant conditions", "coolant_id"),
    alternated("two lots in turns at constant conditions", "lot"),
    alternated("two materials in turns at constant conditions", "material"),
    Recipe {
        design: "fresh and old coolant in turns at constant conditions",
        operations: 12,
        factors: &[],
        alternated: None,
        refreshed: Some("coolant_age"),
    },
];

const GRINDING: &[Recipe] = &[
    swept("infeed sweep of 12 levels, ×0.6 to ×1.5, in mixed order", 12, &[("infeed_per_rev", zigzag)]),
    swept("revolutions from ×0.6 to ×1.5 at constant infeed", 12, &[("revolutions", zigzag)]),
    swept("work speeds of 12 levels, in mixed order", 12, &[("work_rotation_speed", zigzag)]),
    swept("waits of mixed length before the trial", 12, &[("wait_time", zigzag)]),
    swept("a long dressing cycle: 24 trials without dressing", 24, &[]),
    alternated("two coolants in turns with one freshly dressed wheel", "coolant_id"),
    Recipe {
        design: "fresh and old coolant in turns",
        operations: 12,
        factors: &[],
        alternated: None,
        refreshed: Some("coolant_age"),
    },
];

/// Columns of channels.
pub(super) fn channels(records: &Records) -> Vec<&'static str> {
    let columns = records.kind.columns().iter().filter(|column| column.kind == ColumnKind::Channel);
    columns.filter(|column| records.numbers(column.name).is_some()).map(|column| column.name).collect()
}

/// Every block that the records allow: what they do not record cannot be varied.
pub(super) fn blocks(records: &Records) -> Vec<Offered> {
    let recipes = match records.kind {
        RecordKind::Grinding => GRINDING,
        RecordKind::Shop | RecordKind::Orders | RecordKind::Program => &[],
        RecordKind::Turning | RecordKind::Milling | RecordKind::Empirical => CUTTING,
    };
    recipes.iter().filter_map(|recipe| block(records, recipe)).collect()
}

fn block(records: &Records, recipe: &Recipe) -> Option<Offered> {
    let recorded = recipe.factors.iter().any(|(column, _)| records.numbers(column).is_some());
    if !recipe.factors.is_empty() && !recorded {
        return None;
    }
    let levels = match recipe.alternated {
        None => None,
        // A single level is enough: the other is what it is not.
        Some(column) => Some((column, two(records, column)?)),
    };
    if let Some(column) = recipe.refreshed {
        records.numbers(column)?;
    }
    let count = REPLICATES * recipe.operations;
    let mut runs = Records::new(records.kind, count);
    let place = |row: usize| row % recipe.operations;
    for column in records.kind.columns() {
        if let Some(values) = records.numbers(column.name) {
            let middle = median(&mut values.iter().copied().filter(|value| value.is_finite()).collect::<Vec<f64>>());
            let factor = recipe.factors.iter().find(|(name, _)| *name == column.name).map(|(_, factor)| factor);
            let value = |row: usize| match (column.name, factor) {
                ("sequence" | "part_in_cycle", _) => (place(row) + 1) as f64,
                (_, Some(factor)) => middle * factor(place(row), recipe.operations),
                (name, None) if recipe.refreshed == Some(name) => {
                    let greatest = values.iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max);
                    greatest * (place(row) % 2) as f64
                }
                _ => middle,
            };
            runs.set_numbers(column.name, (0..count).map(value).collect());
        } else if let Some(texts) = records.texts(column.name) {
            let usual = most_frequent(texts);
            let text = |row: usize| match (column.name, &levels) {
                ("tool_id" | "dressing_cycle" | "wheel_id", _) => format!("planned {}", row / recipe.operations + 1),
                ("operation_id" | "trial_id", _) => format!("planned {}", row + 1),
                (name, Some((alternated, [a, b]))) if name == *alternated => {
                    if place(row) % 2 == 0 {
                        a.clone()
                    } else {
                        b.clone()
                    }
                }
                _ => usual.clone(),
            };
            runs.set_texts(column.name, (0..count).map(text).collect());
        }
    }
    growing(records, &mut runs);
    let minutes = minutes(&runs);
    Some(Offered { design: format!("{}; {REPLICATES} edges", recipe.design), minutes, runs })
}

/// Two levels of a column of words.
fn two(records: &Records, column: &str) -> Option<[String; 2]> {
    let (names, _) = records.levels(column)?;
    let mut known = names.into_iter().filter(|name| !name.is_empty());
    let first = known.next()?;
    let second = known.next().unwrap_or_else(|| format!("not {first}"));
    Some([first, second])
}

fn most_frequent(texts: &[String]) -> String {
    let mut sorted: Vec<&String> = texts.iter().collect();
    sorted.sort();
    let runs = sorted.chunk_by(|a, b| a == b);
    runs.max_by_key(|run| run.len()).and_then(|run| run.first()).map_or_else(String::new, |text| (*text).clone())
}

/// Wear grows over an edge as in the records, from new to their median last reading.
fn growing(records: &Records, runs: &mut Records) {
    let (Some(wear), Some(order)) = (records.numbers("flank_wear"), runs.numbers("sequence")) else { return };
    let mut known: Vec<f64> = wear.iter().copied().filter(|land| land.is_finite()).collect();
    if known.is_empty() {
        return;
    }
    let last = order.iter().copied().fold(1.0, f64::max);
    let land = 1.5 * median(&mut known);
    let grown = order.iter().map(|place| land * place / last).collect();
    runs.set_numbers("flank_wear", grown);
}

fn minutes(runs: &Records) -> f64 {
    let count = runs.len() as f64;
    let turning = |revolutions: &[f64]| -> f64 {
        let speeds = runs.numbers("work_rotation_speed");
        let rows = revolutions.iter().enumerate().map(|(row, revolutions)| {
            let speed = speeds.map_or(f64::NAN, |speeds| speeds[row]);
            if speed > 0.0 { revolutions * std::f64::consts::TAU / speed } else { 0.0 }
        });
        rows.sum()
    };
    let cutting = match (runs.numbers("cutting_time"), runs.numbers("revolutions")) {
        (Some(times), _) => times.iter().filter(|time| time.is_finite()).sum(),
        (None, Some(revolutions)) => turning(revolutions),
        // Nothing is known of the length of an operation: a minute each.
        (None, None) => 60.0 * count,
    };
    cutting / 60.0 + HANDLING * count + CHANGE * REPLICATES as f64
}
