//! `toolroom lobes FILE`: the stability chart, or the verdict at one point.

mod shards;

use crate::args::LobesArgs;
use crate::failure::Failure;
use crate::shard::{of_plan, pool};
use crate::speak::Voice;
use crate::study::default_out;
use std::path::Path;
use std::time::Instant;
use toolroom_chatter::{ChatterError, Lobes};
use toolroom_form::FormFile;
use toolroom_output::{OutputDir, provenance};
use toolroom_planning::lobes::{ChartStudy, LobesFile, NAMES, PointVerdict, read};

pub use shards::{merge, shard};

/// Where a chart comes from.
struct Origin<'a> {
    /// Name of the lobes file.
    file: &'a str,
    /// Changes to it, `path=value`.
    changes: &'a [String],
    /// When the work began.
    start: Instant,
}

pub fn run(args: &LobesArgs, voice: &Voice) -> Result<(), Failure> {
    let Some(path) = &args.file else {
        return of_plan(args.run.as_deref(), args.shard, args.out.as_deref(), args.threads, voice);
    };
    let file = read(path, &args.set)?;
    if let [speed, depth] = args.at.as_slice() {
        return verdict(&file.content, [speed, depth], args.measured.as_deref(), voice);
    }
    let input = path.display().to_string();
    if let Some(target) = &args.plan {
        return shards::plan(&input, &file, args, target, voice);
    }
    let target = args.out.clone().unwrap_or_else(|| default_out(&file.content.name));
    let inputs = std::iter::once(path.as_path()).chain(file.files.iter().map(AsRef::as_ref));
    let out = OutputDir::create(&target, NAMES, inputs, voice.force)?;
    pool(args.threads)?.install(|| {
        let LobesFile { chart, .. } = &file.content;
        let start = Instant::now();
        let grid = if chart.boundary_only {
            None
        } else {
            voice.say(format_args!("judging {} × {} points", chart.speed.points, chart.depth.points));
            Some(shards::grid(&input, &file, args, &out, voice)?)
        };
        let origin = Origin { file: &input, changes: &args.set, start };
        finish(&file, grid, &origin, out, voice)
    })
}

/// Boundaries and operating points beside the grid, then every file.
fn finish(
    file: &FormFile<LobesFile>,
    grid: Option<Lobes>,
    origin: &Origin<'_>,
    out: OutputDir,
    voice: &Voice,
) -> Result<(), Failure> {
    let study = ChartStudy::new(&file.content, grid).map_err(refused)?;
    for warning in study.holes() {
        voice.say(format_args!("warning: {warning}"));
    }
    let inputs = [(origin.file.to_owned(), file.text.as_bytes())];
    let changes = origin.changes.iter().flat_map(|change| ["--set".to_owned(), change.clone()]);
    let provenance = provenance("lobes", &inputs, changes, None);
    let (summary, files) = study.files(&file.echo, provenance.clone());
    out.put_all(&files)?;
    out.record(&provenance, origin.start.elapsed())?;
    let target = out.publish()?;
    if voice.json {
        voice.json(&summary)?;
    } else {
        voice.data(study.text())?;
    }
    voice.detail(format_args!("{:.2} s", origin.start.elapsed().as_secs_f64()));
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}

/// What the stability model refuses: an iteration without result is no fault of the input.
fn refused(error: ChatterError) -> Failure {
    match error {
        ChatterError::NotConverged { .. } => Failure::Work { message: error.to_string() },
        _ => Failure::argument(error, "see the values of the file"),
    }
}

/// `--at SPEED DEPTH`, with the limit straight from a `measured` response beside it.
fn verdict(
    file: &LobesFile,
    [speed, depth]: [&String; 2],
    measured: Option<&Path>,
    voice: &Voice,
) -> Result<(), Failure> {
    let place = file.cut.place(speed, depth).map_err(|error| Failure::argument(&error, error.fix()))?;
    let mut verdict = PointVerdict::new(file, place).map_err(refused)?;
    if let Some(path) = measured {
        let measured = crate::modes::measurement(path, &Default::default())?.0;
        verdict = verdict.beside(&measured).map_err(|error| Failure::argument(error, "see docs/dynamics.md"))?;
        if let Some(warning) = verdict.warning() {
            voice.say(format_args!("warning: {warning}"));
        }
    }
    if voice.json { voice.json(&verdict.json()) } else { voice.data(verdict.text()) }
}
