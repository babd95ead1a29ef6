//! `toolroom life FILE`: plan, shards, merge.

use super::request;
use crate::args::{LifeArgs, Statistics};
use crate::failure::Failure;
use crate::plan::{leave, pool};
use crate::progress::Bar;
use crate::speak::Voice;
use crate::study::default_out;
use serde_json::json;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;
use toolroom_form::FormFile;
use toolroom_life::file::{StudyFile, StudyText};
use toolroom_life::study::report::{Inputs, NAMES, results};
use toolroom_life::study::run::enough;
use toolroom_life::study::shard;
use toolroom_output::signals::{self as stop, Begun, partials, tidy};
use toolroom_output::{Files, OutputDir};
use toolroom_records::table::NewTable;
use toolroom_shards::{Plan, ShardError, discard, fingerprint, read_plan, write_plan};
use toolroom_study::study::Progress;

pub fn run(args: &LifeArgs, path: &Path, voice: &Voice) -> Result<(), Failure> {
    let text = StudyText::open(path)?;
    let mut overrides = args.shards.set.clone();
    overrides.extend(args.statistics.seed.map(|seed| format!("seed={seed}")));
    overrides.extend(args.shards.lives.map(|lives| format!("lives={lives}")));
    let mut parsed = text.parse(&overrides)?;
    let request = request(&args.statistics, parsed.content.costs)?;
    let threads = pool(args.shards.threads)?;
    if let Some(relative) = parsed.content.until {
        let lives = threads.install(|| enough(&parsed.content.study, relative));
        voice.say(format_args!(
            "{lives} lives of each condition and policy will do for a half-width of {} %",
            100.0 * relative
        ));
        overrides.push(format!("lives={lives}"));
        parsed = text.parse(&overrides)?;
    }
    let study = &parsed.content.study;
    let plan = shard::plan(env!("CARGO_PKG_VERSION"), text, &parsed, overrides, args.shards.shards)?;
    let shards = plan.shards;
    if let Some(target) = &args.shards.plan {
        let inputs = parsed.files.iter().map(AsRef::as_ref).chain([path]);
        leave(&plan, target, &Files::new(inputs, voice.force))?;
        let shown = target.display();
        voice.say(format_args!(
            "wrote {shown}: {shards} shards of {} lives   next: toolroom life --run {shown} --shard 0 --out parts",
            study.lives
        ));
        return Ok(());
    }
    let target = args.out.clone().unwrap_or_else(|| default_out(&study.name));
    let inputs = parsed.files.iter().map(AsRef::as_ref).chain([path]);
    let mut out = OutputDir::create(&target, NAMES, inputs, voice.force)?;
    let parts = begin(&mut out, &plan, args.shards.resume, voice.force)?;
    // A part is there as a whole or not at all: a signal ends the program at once.
    let _tidy = tidy(Begun::Partials(parts.clone()));
    let complete = |number: u64| {
        let message = format!("interrupted: {number} of {shards} shards are complete in {}", parts.display());
        stop::keeps(message, "the same command with --resume goes on".to_owned());
    };
    complete(0);
    let bar = Bar::new(voice);
    let start = Instant::now();
    for number in 0..shards {
        threads.install(|| shard::run(study, &plan, number, &parts, rows(parsed.content.write_lives)))?;
        complete(number + 1);
        bar.at(Progress { done: number as u32 + 1, total: shards as u32 });
    }
    bar.finish();
    let wall = start.elapsed();
    let all = study.lives.saturating_mul(study.cells.len() as u64);
    voice.detail(format_args!(
        "{all} lives in {:.2} s, {:.0} a second",
        wall.as_secs_f64(),
        all as f64 / wall.as_secs_f64()
    ));
    finish(&plan, &parsed, &parts, out, &request, voice)
}

/// One shard of a planned study.
pub fn shard(plan: &Plan, number: u64, folder: &Path) -> Result<(), Failure> {
    let content = shard::study(plan)?.content;
    shard::run(&content.study, plan, number, folder, rows(content.write_lives)).map_err(Failure::from)
}

/// Merges the parts of a planned study.
pub fn merge(
    plan: &Plan,
    parts: &Path,
    out: Option<&Path>,
    statistics: &Statistics,
    voice: &Voice,
) -> Result<(), Failure> {
    let parsed = shard::study(plan)?;
    let request = request(statistics, parsed.content.costs)?;
    let out = out.map_or_else(|| default_out(&plan.name), Path::to_owned);
    let out = OutputDir::create(&out, NAMES, parsed.files.iter().map(AsRef::as_ref), voice.force)?;
    finish(plan, &parsed, parts, out, &request, voice)
}

/// Folder of the parts within that of the results.
const PARTS: &str = "parts";

/// The folder of the parts within that of the results, without earlier ones unless the study goes on.
fn begin(output_dir: &mut OutputDir, plan: &Plan, resume: bool, force: bool) -> Result<PathBuf, Failure> {
    let parts = output_dir.target().join(PARTS);
    let failed = |source| Failure::Unwritable { path: parts.clone(), source };
    // This process has the folder to itself: drafts of parts are those of dead ones.
    partials(&parts).try_for_each(fs::remove_file).map_err(failed)?;
    if resume && parts.join("plan.json").is_file() {
        let there = read_plan(&parts.join("plan.json"))?;
        if there.hash() != plan.hash() {
            let message =
                format!("{} holds another study: its file, changes, seed, lives or shards differ", parts.display());
            return Err(Failure::argument(message, "go on with the same arguments, or start anew without --resume"));
        }
    } else {
        output_dir.clear(PARTS)?;
        discard(&parts, force).map_err(|error| {
            let ShardError::Changed { path, .. } = &error else { return Failure::from(error) };
            Failure::argument(
                format_args!("{} was changed since toolroom wrote it", path.display()),
                "move it away, choose another --out, or replace it with --force; nothing was changed",
            )
        })?;
    }
    fs::create_dir_all(&parts).map_err(failed)?;
    write_plan(&parts.join("plan.json"), plan)?;
    Ok(parts)
}

/// Counts the parts of a plan that lie within the results among them.
fn own_parts(output_dir: &mut OutputDir, plan: &Plan, parts: &Path) {
    output_dir.placed(format!("{PARTS}/plan.json"));
    for number in 0..plan.shards {
        for extension in ["json", "parquet"] {
            let name = format!("part-{number:06}.{extension}");
            if parts.join(&name).is_file() {
                output_dir.placed(format!("{PARTS}/{name}"));
            }
        }
    }
}

fn finish(
    plan: &Plan,
    parsed: &FormFile<StudyFile>,
    parts: &Path,
    mut output_dir: OutputDir,
    request: &toolroom_life::analysis::Request,
    voice: &Voice,
) -> Result<(), Failure> {
    let merged = shard::merge(plan, parsed.content.study.cells.len(), parts)?;
    let inputs = Inputs { plan, parsed, merged: &merged, request };
    let result = results(&inputs).map_err(|error| Failure::work_error(&error))?;
    output_dir.put_all(&result.files)?;
    output_dir.put_json(
        "run.json",
        &json!({
            "schema": 1, "version": plan.version, "command": format!("toolroom life {}", plan.file),
            "inputs": [{ "name": plan.file, "hash": fingerprint(plan.text.as_bytes()) }],
            "plan": plan.hash(), "shards": plan.shards, "complete": true,
        }),
    )?;
    // Parts that lie within the results stay where they are.
    if fs::canonicalize(parts).ok() == fs::canonicalize(output_dir.target().join(PARTS)).ok() {
        own_parts(&mut output_dir, plan, parts);
    }
    let target = output_dir.publish()?;
    if voice.json {
        voice.json(&result.summary)?;
    } else {
        voice.data(result.text.trim_end())?;
    }
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}

/// The table that lives are written to, where they are wanted.
fn rows(write_lives: bool) -> Option<NewTable<'static>> {
    write_lives.then_some(&toolroom_parquet::create)
}
