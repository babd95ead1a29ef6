//! Random times.

use super::choices::FamilyWord;
use super::fitted;
use std::sync::Arc;
use toolroom_form::{Fault, Section, Value, Walk};
use toolroom_scenario::{Distribution, Empirical};

/// A duration, or a table with a family; the placeholder after a fault is a constant.
pub(super) fn distribution(walk: &mut Walk, section: &Section<'_>, key: &str) -> Distribution {
    if let Some(time) = section.si(key) {
        return Distribution::Constant(time);
    }
    let Some(table) = walk.table(section, key) else { return Distribution::Constant(f64::NAN) };
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
            let (low, mode, high) = three_points(walk, &table);
            Distribution::Triangular { low, mode, high }
        }
        FamilyWord::Beta => {
            let (low, mode, high) = three_points(walk, &table);
            Distribution::Beta { low, mode, high }
        }
        FamilyWord::Normal => {
            let (low, high) = (value("low"), table.si("high").unwrap_or(f64::INFINITY));
            ascending(walk, &table, ("low", low), ("high", high), false);
            normal(walk, &table, low, high)
        }
        FamilyWord::Uniform => {
            let (low, high) = (value("low"), value("high"));
            ascending(walk, &table, ("low", low), ("high", high), false);
            Distribution::Uniform { low, high }
        }
        FamilyWord::DiscreteUniform => {
            let (low, high) = (value("low"), value("high"));
            ascending(walk, &table, ("low", low), ("high", high), false);
            steps(walk, &table, low, high)
        }
        FamilyWord::Empirical => empirical(walk, &table),
        FamilyWord::Fitted => fitted::law(walk, &table),
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
