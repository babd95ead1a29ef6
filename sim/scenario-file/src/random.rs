//! Random times.

use super::choices::FamilyWord;
use super::fault::ScenarioFault;
use super::fitted;
use std::sync::Arc;
use toolroom_form::{Fault, Section, Value, Walk, nearest};
use toolroom_process::table::Lines;
use toolroom_process::unit::quantity;
use toolroom_scenario::{Distribution, Empirical};

/// A duration, or a table with a family; the placeholder after a fault is a constant.
pub(super) fn distribution(walk: &mut Walk, section: &Section<'_>, key: &str) -> Distribution {
    if let Some(time) = section.si(key) {
        return Distribution::Constant(time);
    }
    let Some(table) = walk.table(section, key) else { return Distribution::Constant(f64::NAN) };
    law(walk, &table)
}

/// A table with a family; the placeholder after a fault is a constant.
pub(super) fn law(walk: &mut Walk, table: &Section<'_>) -> Distribution {
    let value = |key: &str| table.required(key);
    let Some(family) = table.chosen("distribution", FamilyWord::from_word) else {
        return Distribution::Constant(f64::NAN); // a problem was noted
    };
    match family {
        FamilyWord::Constant => Distribution::Constant(value("mean")),
        FamilyWord::Exponential => Distribution::Exponential { mean: value("mean") },
        FamilyWord::Erlang => Distribution::Erlang { mean: value("mean"), phases: table.count32("k") },
        FamilyWord::Gamma => Distribution::Gamma { mean: value("mean"), cv: value("cv") },
        FamilyWord::Lognormal => Distribution::Lognormal { mean: value("mean"), cv: value("cv") },
        FamilyWord::Weibull => Distribution::Weibull { mean: value("mean"), shape: value("shape") },
        FamilyWord::Triangular => {
            let (low, mode, high) = three_points(walk, table);
            Distribution::Triangular { low, mode, high }
        }
        FamilyWord::Beta | FamilyWord::Pert => {
            let (low, mode, high) = three_points(walk, table);
            Distribution::Beta { low, mode, high }
        }
        FamilyWord::Normal => {
            let (low, high) = (value("low"), table.si("high").unwrap_or(f64::INFINITY));
            ascending(walk, table, ("low", low), ("high", high), false);
            normal(walk, table, low, high)
        }
        FamilyWord::Uniform => {
            let (low, high) = (value("low"), value("high"));
            ascending(walk, table, ("low", low), ("high", high), false);
            Distribution::Uniform { low, high }
        }
        FamilyWord::DiscreteUniform => {
            let (low, high) = (value("low"), value("high"));
            ascending(walk, table, ("low", low), ("high", high), false);
            steps(walk, table, low, high)
        }
        FamilyWord::Empirical => empirical(walk, table),
        FamilyWord::Fitted => fitted::law(walk, table),
    }
}

fn minutes(seconds: f64) -> String {
    format!("{} min", seconds / 60.0)
}

/// Notes two values that are not in ascending order; equal ones may be, where `equal` says so.
fn ascending(
    walk: &mut Walk,
    table: &Section<'_>,
    (first, first_value): (&'static str, f64),
    (second, second_value): (&'static str, f64),
    equal: bool,
) {
    // After a problem that was noted, a value is not a number and is in no order.
    if first_value > second_value || first_value == second_value && !equal {
        let fault = Fault::Contradiction {
            first,
            first_value: minutes(first_value),
            second,
            second_value: minutes(second_value),
            rule: "low, mode, high are in ascending order",
        };
        walk.fault(table.span_of(first), fault);
    }
}

fn three_points(walk: &mut Walk, table: &Section<'_>) -> (f64, f64, f64) {
    let (low, mode, high) = (table.required("low"), table.required("mode"), table.required("high"));
    ascending(walk, table, ("low", low), ("mode", mode), true);
    ascending(walk, table, ("mode", mode), ("high", high), true);
    if mode == low {
        ascending(walk, table, ("low", low), ("high", high), false);
    }
    (low, mode, high)
}

/// Most standard deviations by which a normal distribution may be cut off beyond its mean: of what is
/// left further out nothing is exact.
const FARTHEST_CUT: f64 = 6.0;

fn normal(walk: &mut Walk, table: &Section<'_>, low: f64, high: f64) -> Distribution {
    let (mean, sd) = (table.required("mean"), table.required("sd"));
    if low > mean + FARTHEST_CUT * sd || high < mean - FARTHEST_CUT * sd {
        let (second, value) = if low > mean { ("low", low) } else { ("high", high) };
        let fault = Fault::Contradiction {
            first: "mean",
            first_value: minutes(mean),
            second,
            second_value: minutes(value),
            rule: "some of the normal distribution is left, at most six standard deviations from its mean",
        };
        walk.fault(table.span_of("mean"), fault);
    }
    Distribution::Normal { mean, sd, low, high }
}

/// Most times of one discrete distribution.
const MOST_STEPS: f64 = 1e6;

fn steps(walk: &mut Walk, table: &Section<'_>, low: f64, high: f64) -> Distribution {
    let step = table.required("step");
    let between = (high - low) / step;
    let whole = (between - between.round()).abs() <= 1e-9 * between.abs();
    if between.is_finite() && between > 0.0 && !(whole && between < MOST_STEPS) {
        let fault = Fault::Contradiction {
            first: "step",
            first_value: minutes(step),
            second: "high",
            second_value: minutes(high),
            rule: "whole steps lead from low to high, fewer than a million",
        };
        walk.fault(table.span_of("step"), fault);
    }
    let count = if between > 0.0 && between < MOST_STEPS { between.round() as u32 + 1 } else { 1 };
    Distribution::DiscreteUniform { low, step, count }
}

fn empirical(walk: &mut Walk, table: &Section<'_>) -> Distribution {
    if let Some(file) = table.text("file") {
        for key in ["values", "weights"].into_iter().filter(|key| table.given(key)) {
            let (case, applicable) = ("observed times from a `file`".to_owned(), "file, column, unit".to_owned());
            walk.fault(table.span_of(key), Fault::NotApplicable { key, case, applicable });
        }
        let text = walk.file(table, "file", file);
        let times = text.map(|text| observed(walk, table, file, &text)).unwrap_or_default();
        let times = if times.is_empty() { Empirical::new(&[(f64::NAN, 1.0)]) } else { Empirical::observed(&times) };
        return Distribution::Empirical(Arc::new(times));
    }
    for key in ["column", "unit"].into_iter().filter(|key| table.given(key)) {
        let (case, applicable) = ("times given by `values`".to_owned(), "values, weights".to_owned());
        walk.fault(table.span_of(key), Fault::NotApplicable { key, case, applicable });
    }
    if table.got("values").is_none() {
        let example = "[\"5 min\", \"30 min\"]` or `file = \"times.csv\"".to_owned();
        let fault = Fault::MissingKey { section: table.form.title.to_owned(), key: "values", example };
        walk.fault(table.span.clone(), fault);
    }
    let numbers = |key: &str| -> Vec<f64> {
        let number = |value: &Value<'_>| if let Value::Si(number) = value { *number } else { f64::NAN };
        table.list(key).iter().map(|got| number(&got.value)).collect()
    };
    let values = numbers("values");
    let weights = if table.given("weights") { numbers("weights") } else { vec![1.0; values.len()] };
    if values.len() != weights.len() {
        let fault = Fault::Contradiction {
            first: "weights",
            first_value: format!("{} entries", weights.len()),
            second: "values",
            second_value: format!("{} entries", values.len()),
            rule: "every value has one weight",
        };
        walk.fault(table.span_of("weights"), fault);
    } else if weights.iter().sum::<f64>() <= 0.0 {
        let example = "values = [\"5 min\", \"30 min\"] with weights = [0.7, 0.3]";
        walk.fault(table.span_of("values"), Fault::Nothing { what: "time that ever occurs", example });
    }
    let weighted: Vec<(f64, f64)> = values.into_iter().zip(weights).collect();
    Distribution::Empirical(Arc::new(Empirical::new(&weighted)))
}

/// Longest time of a table, s, as in the keys of times.
const LONGEST: f64 = super::keys::quantity::DECADE;

/// The times in a column of a table, s; none after a fault. Its first line is a header where it is no time.
fn observed(walk: &mut Walk, table: &Section<'_>, file: &str, text: &str) -> Vec<f64> {
    let place = table.span_of("file");
    let fault = |line: u64, reason: String, fix: Option<String>| ScenarioFault::TableCell {
        file: file.to_owned(),
        line,
        reason,
        fix,
    };
    let first_line = text.lines().next().unwrap_or_default();
    let delimiter = if first_line.contains(';') && !first_line.contains(',') { b';' } else { b',' };
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let mut rows = Vec::new();
    for record in reader.records() {
        match record {
            Ok(record) => rows.push(record),
            Err(error) => {
                let line = error.position().map_or(0, csv::Position::line);
                walk.fault(place, fault(line, error.to_string(), None));
                return Vec::new();
            }
        }
    }
    let given = table.text("unit");
    if let Some(unit) = given.filter(|unit| quantity(&format!("1 {unit}"), "s").is_err()) {
        let reason = format!("\"{unit}\" is no unit of time");
        let fix = "write s, min, h or day".to_owned();
        walk.fault(table.span_of("unit"), ScenarioFault::Arrangement { reason, fix });
        return Vec::new();
    }
    // A header is what has no number at its beginning.
    let is_header = |cell: &str| !cell.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+'));
    let header = rows.first().filter(|row| row.iter().any(is_header)).cloned();
    let column = match (table.text("column"), &header) {
        (None, _) => 0,
        (Some(name), header) => {
            let names: Vec<&str> = header.iter().flatten().map(|cell| bare(cell).0).collect();
            let Some(found) = names.iter().position(|known| *known == bare(name).0) else {
                let near = nearest(name, names.iter().copied()).map(|near| format!("did you mean `{near}`? "));
                let fix = format!("{}columns: {}", near.unwrap_or_default(), names.join(", "));
                walk.fault(place, fault(1, format!("there is no column \"{name}\""), Some(fix)));
                return Vec::new();
            };
            found
        }
    };
    let unit = given.or(header.as_ref().and_then(|row| row.get(column)).and_then(|cell| bare(cell).1));
    let noted = walk.problems.len();
    let mut times = Vec::new();
    let mut lines = Lines::new(text);
    for row in rows.iter().skip(usize::from(header.is_some())) {
        let line = row.position().map_or(0, |position| lines.at(position.byte()) as u64);
        let cell = row.get(column).unwrap_or_default();
        if cell.is_empty() {
            continue; // other columns of the table may be longer
        }
        let plain = cell.parse::<f64>().is_ok();
        let read = match (plain, unit) {
            (true, Some(unit)) => quantity(&format!("{cell} {unit}"), "s"),
            (true | false, _) => quantity(cell, "s"),
        };
        match read {
            Ok(time) if (0.0..=LONGEST).contains(&time) => times.push(time),
            Ok(_) => {
                let fix = "a time is 0 or longer, and shorter than ten years".to_owned();
                walk.fault(place.clone(), fault(line, format!("\"{cell}\" is outside 0 to 87600 h"), Some(fix)));
            }
            Err(reason) => {
                let fix = "write 4.2 min, or give the unit: unit = \"min\", or [min] in the header".to_owned();
                walk.fault(place.clone(), fault(line, reason.to_string(), Some(fix)));
            }
        }
    }
    if times.is_empty() && walk.problems.len() == noted {
        let example = "a table with a column of times, such as `time [min]`";
        walk.fault(place, Fault::Nothing { what: "time", example });
    }
    if walk.problems.len() > noted { Vec::new() } else { times }
}

/// A header without its unit, and the unit in its square brackets.
pub(super) fn bare(header: &str) -> (&str, Option<&str>) {
    match header.strip_suffix(']').and_then(|text| text.rsplit_once('[')) {
        Some((name, unit)) => (name.trim(), Some(unit.trim())),
        None => (header.trim(), None),
    }
}
