//! `toolroom compare FILE -P KEY LO HI STEP`: the comparison at several values of one key.

use crate::args::CompareArgs;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::speak::Voice;
use crate::stop;
use crate::study::chosen;
use serde_json::{Value, json};
use std::fmt::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use toolroom_form::significant;
use toolroom_scenario::file::read;
use toolroom_study::compare::Comparison;
use toolroom_study::study::{Precision, StudyOptions, run_study};
use toolroom_study::summary::summary;

/// Points of a sweep; more are a slip of the step.
const MOST: usize = 1000;

pub fn run(args: &CompareArgs, voice: &Voice) -> Result<(), Failure> {
    let [key, low, high, step] = args.sweep.as_slice() else {
        return Err(Failure::argument(
            "a sweep takes KEY LO HI STEP",
            "-P machine.L.tool_change_time \"1 min\" \"5 min\" \"1 min\"",
        ));
    };
    let values = values(low, high, step)?;
    let stop = Arc::new(AtomicBool::new(false));
    let _gentle = stop::gently(&stop);
    let mut points: Vec<Value> = Vec::new();
    let mut text = String::new();
    let mut interrupted = None;
    for value in &values {
        let mut overrides = args.scenario.changes.overrides();
        overrides.push(format!("{key}={value}"));
        let file = read(&args.scenario.file, &overrides)?;
        let scenario = &file.scenario;
        let options = StudyOptions {
            policies: chosen(scenario, &args.study.policy)?,
            threads: args.study.threads,
            until: args.study.until.map(|relative_half_width| Precision { relative_half_width }),
            logged: 0,
            ..StudyOptions::of(scenario)
        };
        voice.say(format_args!("{key} = {value}"));
        let bar = Bar::new(voice);
        let study = run_study(scenario, &options, None, &|at| bar.at(at), &stop);
        bar.finish();
        let study = study.map_err(|error| Failure::Work { message: error.to_string() })?;
        if !study.complete {
            interrupted = Some(study.replications);
            break;
        }
        let comparison = Comparison::new(scenario, &study);
        let summary = summary(scenario, &study, &comparison);
        let _ = writeln!(text, "{key} = {value}");
        for policy in summary["policies"].as_array().into_iter().flatten() {
            let figure = |name: &str| figure(&policy["kpi"], name);
            let _ = writeln!(
                text,
                "  {:34} parts/shift {:>16}   cost/part {:>16}   edges/100 parts {:>16}",
                policy["name"].as_str().unwrap_or_default(),
                figure("parts_per_shift"),
                figure("cost_per_part"),
                figure("edges_per_100_parts"),
            );
        }
        points.push(json!({ "value": value, "summary": summary }));
        if stop.load(Ordering::SeqCst) {
            interrupted = Some(study.replications);
            break;
        }
    }
    if voice.json {
        voice.json(&json!({ "schema": 1, "key": key, "points": points }))?;
    } else {
        voice.data(text.trim_end())?;
    }
    match interrupted {
        None => Ok(()),
        Some(_) => Err(Failure::Interrupted {
            message: format!("interrupted: {} of {} points are complete", points.len(), values.len()),
            help: format!("go on with LO at {}", values[points.len().min(values.len() - 1)]),
        }),
    }
}

/// Mean and half-width; figures may carry their unit in the key.
fn figure(figures: &Value, name: &str) -> String {
    let found = figures.as_object().into_iter().flatten().find(|(key, _)| key.split(' ').next() == Some(name));
    let Some((_, value)) = found else { return "–".to_owned() };
    match (value["mean"].as_f64(), value["ci95"][1].as_f64()) {
        (Some(mean), Some(high)) => format!("{mean:.2} ± {:.2}", high - mean),
        (Some(mean), None) => format!("{mean:.2}"),
        _ => "–".to_owned(),
    }
}

/// `1 min`, `5 min`, `1 min` to every value between, in the unit as written.
fn values(low: &str, high: &str, step: &str) -> Result<Vec<String>, Failure> {
    let (a, unit) = split(low)?;
    let ((b, unit_b), (d, unit_d)) = (split(high)?, split(step)?);
    if unit_b != unit || unit_d != unit {
        let message = format!("\"{low}\", \"{high}\" and \"{step}\" are not in one unit");
        return Err(Failure::argument(message, "write all three in the same unit"));
    }
    let count = ((b - a) / d + 1e-9).floor();
    if !(d > 0.0 && count >= 0.0 && count < MOST as f64) {
        let message = format!("from {low} to {high} by {step} there are no points, or more than {MOST}");
        return Err(Failure::argument(message, "LO is at most HI and STEP is positive"));
    }
    Ok((0..=count as usize)
        .map(|i| format!("{} {unit}", significant(a + d * i as f64)).trim_end().to_owned())
        .collect())
}

fn split(text: &str) -> Result<(f64, &str), Failure> {
    let text = text.trim();
    let end = text.find(|c: char| c.is_alphabetic() || c == '%' || c.is_whitespace()).unwrap_or(text.len());
    let number: f64 = text[..end]
        .parse()
        .map_err(|_| Failure::argument(format_args!("`{text}` does not start with a number"), "such as \"1 min\""))?;
    Ok((number, text[end..].trim()))
}

#[cfg(test)]
mod tests {
    use super::values;

    #[test]
    fn a_sweep_has_its_ends_and_its_unit() {
        let list = |low, high, step| values(low, high, step).ok();
        assert_eq!(list("1 min", "2 min", "0.5 min"), Some(vec!["1 min".into(), "1.5 min".into(), "2 min".into()]));
        assert_eq!(list("0.1", "0.3", "0.1"), Some(vec!["0.1".into(), "0.2".into(), "0.3".into()]));
        assert_eq!(list("3 min", "1 min", "1 min"), None);
        assert_eq!(list("1 min", "3 s", "1 min"), None);
        assert_eq!(list("1 min", "3 min", "0 min"), None);
        assert_eq!(list("x", "3 min", "1 min"), None);
    }
}
