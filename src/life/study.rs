//! `toolroom life FILE`: plan, shards, merge.

use super::file::{StudyFile, parse};
use super::page::{Inputs, write};
use super::request;
use crate::args::{LifeArgs, Statistics};
use crate::failure::Failure;
use crate::output::OutputDir;
use crate::progress::Bar;
use crate::shard::{pool, refused};
use crate::speak::Voice;
use crate::stop;
use crate::study::default_out;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering;
use std::time::Instant;
use toolroom_analysis::life::study::run::lives;
use toolroom_analysis::life::study::shard;
use toolroom_analysis::shards::{Plan, read_plan, write_plan};
use toolroom_analysis::study::Progress;
use toolroom_sim::scenario::file::FormFile;

/// Lives of a shard when nobody says how many shards there are.
const SHARD: u64 = 500_000;
/// Lives of the pilot from which the number of lives for a precision is reckoned.
const PILOT: u64 = 2000;
/// Two-sided 95 % quantile of the normal law.
const Z: f64 = 1.959_964;

pub fn run(args: &LifeArgs, path: &Path, voice: &Voice) -> Result<(), Failure> {
    let file = path.display().to_string();
    let bytes = fs::read(path)
        .map_err(|error| Failure::argument(format_args!("{file} cannot be read: {error}"), "give a study file"))?;
    let text = String::from_utf8(bytes)
        .map_err(|_| Failure::argument(format_args!("{file} is not UTF-8"), "save it as UTF-8"))?;
    let directory =
        fs::canonicalize(path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new(".")))
            .map_err(|source| Failure::Unwritable { path: path.to_owned(), source })?;
    let mut overrides = args.shards.set.clone();
    overrides.extend(args.statistics.seed.map(|seed| format!("seed={seed}")));
    overrides.extend(args.shards.lives.map(|lives| format!("lives={lives}")));
    let mut parsed = parse(&file, &text, &directory, &overrides)?;
    let request = request(&args.statistics, parsed.content.costs)?;
    let threads = pool(args.shards.threads)?;
    if let Some(relative) = parsed.content.until {
        let lives = threads.install(|| enough(&parsed.content, relative));
        voice.say(format_args!(
            "{lives} lives of each condition and policy will do for a half-width of {} %",
            100.0 * relative
        ));
        overrides.push(format!("lives={lives}"));
        parsed = parse(&file, &text, &directory, &overrides)?;
    }
    let study = &parsed.content.study;
    let all = study.lives.saturating_mul(study.cells.len() as u64);
    let shards = args.shards.shards.unwrap_or(all.div_ceil(SHARD)).min(study.lives);
    let plan = Plan {
        schema: 1,
        kind: "life".to_owned(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        name: study.name.clone(),
        file,
        directory: directory.display().to_string(),
        text,
        files: Plan::fingerprints(&parsed.files).map_err(refused)?,
        overrides,
        policies: Vec::new(),
        seed: study.seed,
        pieces: study.lives,
        shards,
    };
    if let Some(target) = &args.shards.plan {
        write_plan(target, &plan).map_err(refused)?;
        let shown = target.display();
        voice.say(format_args!(
            "wrote {shown}: {shards} shards of {} lives   next: toolroom life --run {shown} --shard 0 --out parts",
            study.lives
        ));
        return Ok(());
    }
    let out = args.out.clone().unwrap_or_else(|| default_out(&study.name));
    let parts = begin(&out, &plan, args.shards.resume)?;
    let stop = stop::on_interrupt()?;
    let bar = Bar::new(voice);
    let start = Instant::now();
    for number in 0..shards {
        if stop.load(Ordering::Relaxed) {
            bar.finish();
            let message = format!(
                "interrupted: {number} of {shards} shards are complete in {}; go on with --resume",
                parts.display()
            );
            return Err(Failure::Work { message });
        }
        threads.install(|| shard::run(study, &plan, number, &parts, parsed.content.write_lives)).map_err(refused)?;
        bar.at(Progress { done: number as u32 + 1, total: shards as u32 });
    }
    bar.finish();
    let wall = start.elapsed();
    voice.detail(format_args!(
        "{all} lives in {:.2} s, {:.0} a second",
        wall.as_secs_f64(),
        all as f64 / wall.as_secs_f64()
    ));
    finish(&plan, &parsed, &parts, &out, &request, voice)
}

/// One shard of a planned study.
pub fn shard(plan: &Plan, number: u64, out: &Path) -> Result<(), Failure> {
    let content = study_of(plan)?.content;
    shard::run(&content.study, plan, number, out, content.write_lives).map_err(refused)
}

/// Merges the parts of a planned study.
pub fn merge(
    plan: &Plan,
    parts: &Path,
    out: Option<&Path>,
    statistics: &Statistics,
    voice: &Voice,
) -> Result<(), Failure> {
    let parsed = study_of(plan)?;
    let request = request(statistics, parsed.content.costs)?;
    let out = out.map_or_else(|| default_out(&plan.name), Path::to_owned);
    finish(plan, &parsed, parts, &out, &request, voice)
}

fn study_of(plan: &Plan) -> Result<FormFile<StudyFile>, Failure> {
    Ok(parse(&plan.file, &plan.text, Path::new(&plan.directory), &plan.overrides)?)
}

/// Lives that bring the half-width of every mean life to `relative` of it, by the scatter of a
/// pilot (C. Stein, Annals of Mathematical Statistics 16 (1945) 243); at most those of the file.
fn enough(file: &StudyFile, relative: f64) -> u64 {
    let study = &file.study;
    let pilot = PILOT.min(study.lives);
    let needed = study.cells.iter().map(|cell| {
        let cv = lives(study, cell, 0, pilot, false).0.life.variation();
        (Z * cv / relative).powi(2).ceil() as u64
    });
    needed.max().unwrap_or(pilot).clamp(pilot, study.lives)
}

/// The directory of the parts within that of the results, emptied unless the study goes on.
fn begin(out: &Path, plan: &Plan, resume: bool) -> Result<PathBuf, Failure> {
    let parts = out.join("parts");
    let failed = |source| Failure::Unwritable { path: out.to_owned(), source };
    let ours = out.join("run.json").is_file() || parts.join("plan.json").is_file();
    let empty = !out.exists() || fs::read_dir(out).map_err(failed)?.next().is_none();
    if !ours && !empty {
        let message = format!("{} holds files that are no results of toolroom", out.display());
        return Err(Failure::argument(message, "choose another directory with --out DIR; nothing was changed"));
    }
    if resume && parts.join("plan.json").is_file() {
        let there = read_plan(&parts.join("plan.json")).map_err(refused)?;
        if there.hash() != plan.hash() {
            let message =
                format!("{} holds another study: its file, changes, seed, lives or shards differ", parts.display());
            return Err(Failure::argument(message, "go on with the same arguments, or start anew without --resume"));
        }
    } else if parts.exists() {
        fs::remove_dir_all(&parts).map_err(failed)?;
    }
    fs::create_dir_all(&parts).map_err(failed)?;
    write_plan(&parts.join("plan.json"), plan).map_err(refused)?;
    Ok(parts)
}

fn finish(
    plan: &Plan,
    parsed: &FormFile<StudyFile>,
    parts: &Path,
    out: &Path,
    request: &toolroom_analysis::life::analysis::Request,
    voice: &Voice,
) -> Result<(), Failure> {
    let merged = shard::merge(plan, parsed.content.study.cells.len(), parts).map_err(refused)?;
    // Parts that lie within the results stay where they are.
    let within = parts.parent() == Some(out);
    let draft = if within { None } else { Some(OutputDir::create(out)?) };
    let directory = draft.as_ref().map_or(out, OutputDir::draft).to_owned();
    let inputs = Inputs { plan, parsed, merged: &merged, request };
    let result = write(&directory, &inputs)?;
    let target = match draft {
        Some(draft) => draft.publish()?,
        None => directory,
    };
    if voice.json {
        voice.json(&result.summary)?;
    } else {
        voice.data(result.text.trim_end())?;
    }
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}
