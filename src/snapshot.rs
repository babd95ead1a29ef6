//! Snapshots of shops: `run --snapshot-at`, and what goes on from one.

use crate::args::{Changes, CompareArgs, RunArgs};
use crate::failure::Failure;
use crate::run::{self, perform_run};
use crate::speak::Voice;
use serde_json::json;
use std::path::Path;
use toolroom_form::nearest;
use toolroom_output::{Files, quoted};
use toolroom_scenario::date;
use toolroom_scenario_file::{ScenarioFile, read};
use toolroom_snapshot::{Snapshot, SnapshotError, instant};
use toolroom_study::request::policies_named;
use toolroom_study::variants::{POSSIBLE, branched};

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// `run`, where it takes a snapshot, goes on from one, or has to do with none.
pub fn run(args: &RunArgs, voice: &Voice) -> Result<(), Failure> {
    match (&args.snapshot_at, &args.snapshot, &args.scenario.from) {
        (Some(time), Some(target), _) => take(args, (time, target), voice),
        (_, _, Some(from)) => go_on(args, from, voice),
        (_, _, None) => run::run(args, voice),
    }
}

/// `run FILE --snapshot-at TIME --snapshot TARGET`.
fn take(args: &RunArgs, (time, target): (&str, &Path), voice: &Voice) -> Result<(), Failure> {
    let (path, changes) = (args.scenario.path(), args.scenario.changes.overrides());
    let file = read(path, &changes)?;
    let policies = policies_named(&file.scenario, &args.study.policy)?;
    let time = instant(&file.scenario, time)?;
    let files = Files::new(file.files.iter().map(AsRef::as_ref).chain([path]), voice.force);
    files.check(target)?;
    let snapshot = Snapshot::take(VERSION, path, &file, changes, &policies, time)?;
    files.put(target, snapshot.text().map_err(Failure::Json)?.as_bytes())?;
    if voice.json {
        let written = target.display().to_string();
        return voice
            .json(&json!({ "schema": 1, "written": written, "at [h]": time / 3600.0, "policies": snapshot.policies }));
    }
    let when = file.scenario.start.map_or_else(|| format!("{} h", time / 3600.0), |start| date::show(start + time));
    let shown = quoted(&target.display().to_string());
    voice.say(format_args!("wrote {shown}: the shop at {when}   next: toolroom run --from {shown} --set …"));
    Ok(())
}

/// `run --from SNAPSHOT`.
fn go_on(args: &RunArgs, source: &Path, voice: &Voice) -> Result<(), Failure> {
    let snapshot = Snapshot::read(source, VERSION)?;
    whole(&args.scenario.changes)?;
    let horizon = snapshot.horizon(args.scenario.horizon.as_deref())?;
    let before = snapshot.scenario(&horizon)?;
    beyond(&before, &snapshot)?;
    let mut set = match &args.variant {
        None => Vec::new(),
        Some(name) => {
            let names = || before.variants.iter().map(|variant| variant.name.as_str());
            let Some(variant) = before.variants.iter().find(|variant| variant.name == *name) else {
                let near = nearest(name, names()).map_or_else(String::new, |near| format!("did you mean \"{near}\"? "));
                let help = format!("{near}variants: {}", names().collect::<Vec<_>>().join(", "));
                return Err(Failure::argument(format_args!("there is no variant \"{name}\""), help));
            };
            variant.set.clone()
        }
    };
    set.extend(args.scenario.changes.set.iter().cloned());
    let known = if args.study.policy.is_empty() { &snapshot.policies } else { &args.study.policy };
    // The shop as it was; who comes in the very instant of a branch is no part of it.
    snapshot.verify(&before.scenario, &policies_named(&before.scenario, known)?)?;
    let file = if set.is_empty() {
        before
    } else {
        let more: Vec<String> = horizon.iter().chain(&set).cloned().collect();
        let scenario = snapshot.scenario(&more)?;
        let world = branched(&before.scenario, &scenario.scenario, snapshot.at, &set);
        ScenarioFile { scenario: world.map_err(|error| Failure::argument(error, POSSIBLE))?, ..scenario }
    };
    let mut args = RunArgs {
        scenario: args.scenario.clone(),
        study: args.study.clone(),
        snapshot_at: None,
        snapshot: None,
        variant: args.variant.clone(),
    };
    if args.study.policy.is_empty() {
        args.study.policy = snapshot.policies.clone();
    }
    let mut start = origin(source, args.scenario.horizon.as_deref());
    if let Some(name) = &args.variant {
        start += &format!(" --variant {}", quoted(name));
    }
    let changes =
        Changes { set: snapshot.changes.iter().chain(&horizon).chain(&set).cloned().collect(), ..Changes::default() };
    let typed = args.scenario.changes.set.clone();
    let input = snapshot.file.display().to_string();
    perform_run(&args, file, (input, start), (&changes, typed), voice)
}

/// The arguments of a comparison that goes on from a snapshot: its scenario, with the changes that it holds.
pub fn from_snapshot(args: &CompareArgs, source: &Path) -> Result<(CompareArgs, Snapshot), Failure> {
    let snapshot = Snapshot::read(source, VERSION)?;
    whole(&args.scenario.changes)?;
    let changed = !args.scenario.changes.set.is_empty();
    if changed || args.plan.is_some() || args.tune || !args.sweep.is_empty() {
        let help = "write a [[variant]] into the scenario before the snapshot is taken, or use toolroom run --from";
        return Err(Failure::argument("a comparison from a snapshot takes no --set, -P, --plan and --tune", help));
    }
    let horizon = snapshot.horizon(args.scenario.horizon.as_deref())?;
    beyond(&snapshot.scenario(&horizon)?, &snapshot)?;
    let mut args = args.clone();
    args.no_tune = true;
    args.scenario.file = Some(snapshot.file.clone());
    args.scenario.changes.set = snapshot.changes.iter().chain(&horizon).cloned().collect();
    if args.study.policy.is_empty() {
        args.study.policy = snapshot.policies.clone();
    }
    Ok((args, snapshot))
}

/// What was typed in the place of a scenario.
pub fn origin(source: &Path, horizon: Option<&str>) -> String {
    let horizon = horizon.map_or_else(String::new, |time| format!(" --horizon {}", quoted(time)));
    format!("--from {}{horizon}", quoted(&source.display().to_string()))
}

/// Refuses an end that the snapshot has passed.
fn beyond(file: &ScenarioFile, snapshot: &Snapshot) -> Result<(), Failure> {
    if file.scenario.horizon > snapshot.at {
        return Ok(());
    }
    let message = format!("the run ends before the snapshot, which is at {} h", snapshot.at / 3600.0);
    Err(Failure::argument(message, "give a later --horizon"))
}

/// Refuses what would make other runs of all of it.
fn whole(changes: &Changes) -> Result<(), Failure> {
    if changes.seed.is_none() && changes.replications.is_none() {
        return Ok(());
    }
    Err(Failure::argument("seed and replications are those of the snapshot", "give them when the snapshot is taken"))
}

impl From<SnapshotError> for Failure {
    fn from(error: SnapshotError) -> Self {
        let fix = error.fix();
        match error {
            SnapshotError::Read(error) => error.into(),
            SnapshotError::Shop(error) => Self::work_error(&error),
            wrong @ (SnapshotError::NoSnapshot { .. }
            | SnapshotError::Version { .. }
            | SnapshotError::Changed { .. }
            | SnapshotError::Instant { .. }
            | SnapshotError::Digest { .. }
            | SnapshotError::NoPolicy { .. }
            | SnapshotError::Input(_)) => Self::located(wrong, fix),
        }
    }
}
