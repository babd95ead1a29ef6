//! `toolroom run FILE`: policies with full logs.

use crate::args::{Changes, RunArgs};
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::{Request, default_out, perform, statistics};
use crate::warm_up::settle;
use toolroom_scenario_file::{ScenarioFile, read};
use toolroom_study::request::policies_named;

pub fn run(args: &RunArgs, voice: &Voice) -> Result<(), Failure> {
    let changes = &args.scenario.changes;
    let file = read(args.scenario.path(), &changes.overrides())?;
    let input = args.scenario.path().display().to_string();
    perform_run(args, file, (input.clone(), input), (changes, changes.overrides()), voice)
}

/// Runs a scenario: `input` is its name, `start` what was typed in its place, `typed` those of the changes that were.
pub fn perform_run(
    args: &RunArgs,
    mut file: ScenarioFile,
    (input, start): (String, String),
    (changes, typed): (&Changes, Vec<String>),
    voice: &Voice,
) -> Result<(), Failure> {
    let policies = policies_named(&file.scenario, &args.study.policy)?;
    let out = default_out(&file.scenario.name);
    let target = args.study.out.as_deref().unwrap_or(&out);
    let wanted = statistics(&file, &args.study)?;
    let warm_up = settle(&mut file, &mut [], &policies, &args.study, target, voice)?;
    let request = Request {
        command: format!("run {start}"),
        input,
        changes,
        typed,
        args: &args.study,
        policies,
        logged: file.scenario.replications,
        out,
        file,
        known: std::sync::Arc::default(),
        tuning: None,
        variants: Vec::new(),
        select: None,
        until: wanted.until,
        primary: wanted.primary,
        warm_up,
    };
    perform(&request, None, voice)
}
