//! `toolroom compare FILE -P KEY LO HI STEP`: the comparison at several values of one key.

use crate::args::CompareArgs;
use crate::compare::{tuned, tuning_wanted};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::speak::Voice;
use crate::study::statistics;
use crate::warm_up::settle;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use toolroom_output::signals as stop;
use toolroom_output::{OutputDir, provenance};
use toolroom_scenario_file::read;
use toolroom_study::compare::Comparison;
use toolroom_study::request::policies_named;
use toolroom_study::study::{StudyOptions, run_study};
use toolroom_study::summary::summary;
use toolroom_study::sweep::{Sweep, SweepResult};

pub fn run(args: &CompareArgs, voice: &Voice) -> Result<(), Failure> {
    let [key, low, high, step] = args.sweep.as_slice() else {
        return Err(Failure::argument(
            "a sweep takes KEY LO HI STEP",
            "-P machine.L.tool_change_time \"1 min\" \"5 min\" \"1 min\"",
        ));
    };
    let sweep = Sweep::new(key, low, high, step).map_err(|error| Failure::argument(&error, error.fix()))?;
    let values = &sweep.values;
    let began = Instant::now();
    let stop = Arc::new(AtomicBool::new(false));
    let _gentle = stop::gently(&stop);
    let mut result = SweepResult::default();
    let mut interrupted = None;
    for value in values {
        let mut overrides = args.scenario.changes.overrides();
        overrides.push(format!("{key}={value}"));
        let mut file = read(args.scenario.path(), &overrides)?;
        let policies = policies_named(&file.scenario, &args.study.policy)?;
        voice.say(format_args!("{key} = {value}"));
        let warm_up = settle(&mut file, &mut [], &policies, &args.study, Path::new(""), voice)?;
        overrides.extend(warm_up.iter().map(|found| found.change()));
        let (file, tuning) = match tuning_wanted(args, &file) {
            Some(wanted) => tuned(args, overrides, &file, (&policies, &wanted), voice, &stop, None)?,
            None => (file, None),
        };
        result.retuned = tuning.is_some();
        let scenario = &file.scenario;
        let options = StudyOptions {
            policies,
            tuning,
            warm_up,
            threads: args.study.threads,
            until: statistics(&file, &args.study)?.until,
            logged: 0,
            ..StudyOptions::of(scenario)
        };
        let bar = Bar::new(voice);
        let study = run_study(scenario, &options, None, &|at| bar.at(at), &stop);
        bar.finish();
        let study = study.map_err(|error| Failure::work_error(&error))?;
        if !study.complete {
            interrupted = Some(study.replications);
            break;
        }
        let comparison = Comparison::new(scenario, &study);
        result.summaries.push(summary(scenario, &study, &comparison));
        result.pairs.push(comparison.decision.pairs(&study));
        if stop.load(Ordering::SeqCst) {
            interrupted = Some(study.replications);
            break;
        }
    }
    if let Some(target) = &args.study.out {
        let inputs = [args.scenario.path()];
        let output_dir = OutputDir::create(target, &["sweep.json", "report.html"], inputs, voice.force)?;
        let bytes = std::fs::read(args.scenario.path()).unwrap_or_default();
        let words = std::iter::once("-P").chain(args.sweep.iter().map(String::as_str));
        let changes = args.scenario.changes.overrides();
        let changes = changes.iter().flat_map(|change| ["--set", change.as_str()]);
        let origin = provenance(
            "compare",
            &[(args.scenario.path().display().to_string(), &bytes)],
            words.chain(changes).map(str::to_owned),
            None,
        );
        output_dir.put_json("sweep.json", &sweep.json(&result))?;
        output_dir.put("report.html", &sweep.report(&result).provenance(origin.clone()).html())?;
        output_dir.record(&origin, began.elapsed())?;
        let target = output_dir.publish()?;
        voice.say(format_args!("wrote {}", target.join("report.html").display()));
    }
    if voice.json {
        voice.json(&sweep.json(&result))?;
    } else {
        voice.data(sweep.text(&result))?;
    }
    match interrupted {
        None => Ok(()),
        Some(_) => Err(Failure::Interrupted {
            message: format!("interrupted: {} of {} points are complete", result.summaries.len(), values.len()),
            help: format!("go on with LO at {}", values[result.summaries.len().min(values.len() - 1)]),
        }),
    }
}
