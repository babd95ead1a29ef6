//! `toolroom lobes FILE`: the stability chart, or the verdict at one point.

mod known;
pub mod shards;

use crate::args::LobesArgs;
use crate::failure::Failure;
use crate::plan::pool;
use crate::shard::of_plan;
use crate::speak::Voice;
use crate::study::default_out;
use std::path::Path;
use std::time::Instant;
use toolroom_chatter::{ChatterError, Lobes};
use toolroom_form::FormFile;
use toolroom_output::{OutputDir, provenance};
use toolroom_planning::lobes::{
    Best, ChartMap, ChartStudy, GREATEST_DIFFERENCE, HISTORY_NAMES, HistoryError, LobesFile, MapError, MapKind,
    MeasuredCurve, NAMES, PitchError, PointVerdict, read,
};
use toolroom_process::unit::quantity;

pub use shards::merge;

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
    let mut file = read(path, &args.set)?;
    if let (Some(draws), Some(set)) = (&args.parameters_from, &args.parameter_set) {
        known::settle(&mut file.content, set, draws)?;
        let spread = file.content.scatter.map_or(0.0, |scatter| scatter.coefficients);
        voice.say(format_args!("cutting force known to {:.1} % (one deviation), by its draws", 100.0 * spread));
    }
    if let [speed, depth] = args.at.as_slice() {
        let measured = args.measured.as_deref().or(file.content.table.as_deref());
        verdict(&file.content, [speed, depth], measured, voice)?;
        return args
            .history
            .as_deref()
            .map_or(Ok(()), |target| history(&file, path, [speed, depth], target, args, voice));
    }
    if let ([from, to], _) | (_, [from, to]) = (args.pitch.as_slice(), args.helix.as_slice()) {
        return pool(args.threads)?.install(|| window(&file.content, [from, to], args.helix.is_empty(), voice));
    }
    let input = path.display().to_string();
    if let Some(target) = &args.plan {
        return shards::plan(&input, &file, args, target, voice);
    }
    let target = args.out.clone().unwrap_or_else(|| default_out(&file.content.name));
    let inputs = std::iter::once(path.as_path()).chain(file.files.iter().map(AsRef::as_ref));
    let output_dir = OutputDir::create(&target, NAMES, inputs, voice.force)?;
    pool(args.threads)?.install(|| {
        let LobesFile { chart, .. } = &file.content;
        let start = Instant::now();
        let grid = if chart.boundary_only {
            None
        } else {
            voice.say(format_args!("judging {} × {} points", chart.speed.points, chart.depth.points));
            Some(shards::grid(&input, &file, args, &output_dir, voice)?)
        };
        let origin = Origin { file: &input, changes: &args.set, start };
        finish(&file, grid, &origin, Some(args), output_dir, voice)
    })
}

/// Boundaries, operating points and what was requested beside the grid, then every file.
fn finish(
    file: &FormFile<LobesFile>,
    grid: Option<Lobes>,
    origin: &Origin<'_>,
    requested: Option<&LobesArgs>,
    output_dir: OutputDir,
    voice: &Voice,
) -> Result<(), Failure> {
    let mut study = ChartStudy::new(&file.content, grid).map_err(refused)?;
    if let Some(requested) = requested {
        workbench(&mut study, requested, voice)?;
    }
    for warning in study.holes() {
        voice.say(format_args!("warning: {warning}"));
    }
    let inputs = [(origin.file.to_owned(), file.text.as_bytes())];
    let changes = origin.changes.iter().flat_map(|change| ["--set".to_owned(), change.clone()]);
    let requested = requested.map_or_else(Vec::new, LobesArgs::typed);
    let provenance = provenance("lobes", &inputs, changes.chain(requested), None);
    let (summary, files) = study.files(&file.echo, provenance.clone());
    output_dir.put_all(&files)?;
    output_dir.record(&provenance, origin.start.elapsed())?;
    let target = output_dir.publish()?;
    if voice.json {
        voice.json(&summary)?;
    } else {
        voice.data(study.text())?;
    }
    voice.detail(format_args!("{:.2} s", origin.start.elapsed().as_secs_f64()));
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}

/// Robust speeds, the best point and maps, as they are requested.
fn workbench(study: &mut ChartStudy<'_>, requested: &LobesArgs, voice: &Voice) -> Result<(), Failure> {
    let failed = |error: MapError| match error {
        MapError::Refused(error) => refused(error),
        error @ (MapError::Process { .. } | MapError::NoFeed { .. }) => {
            Failure::argument(error, "see docs/dynamics.md")
        }
    };
    if let Some(depth) = &requested.robust {
        let speed = study.file.cut.axes().speed;
        let start = format!("{} {}", speed.shown(study.file.chart.speed.start), speed.unit);
        let place = study.file.cut.place(&start, depth);
        let (_, depth) = place.map_err(|error| Failure::argument(&error, "write for example --robust \"2 mm\""))?;
        study.robust = study.file.robust_speeds(depth).map_err(refused)?;
        if study.robust.is_empty() {
            let message = "robust speeds are worked out for milling and turning at constant speed";
            return Err(Failure::argument(message, "leave out --robust"));
        }
    }
    if let Some(path) = requested.measured.as_ref().or(study.file.table.as_ref()) {
        let measured = crate::modes::responses(path)?;
        let curve = MeasuredCurve::new(study, &measured);
        let curve = curve.map_err(|error| Failure::argument(error, "see docs/dynamics.md"))?;
        if curve.median.is_some_and(|median| median > GREATEST_DIFFERENCE) {
            voice.say(format_args!(
                "warning: the limits of the modes are not those of the measured response: look at the fit"
            ));
        }
        study.measured = Some(curve);
    }
    if requested.best {
        if !(0.5..1.0).contains(&requested.probability) {
            let message = format!("a probability of {} is not within 0.5 … 1", requested.probability);
            return Err(Failure::argument(message, "write for example --probability 0.95"));
        }
        study.best = Best::of(study, requested.probability).map_err(failed)?;
        if study.best.is_none() {
            voice.say(format_args!("warning: no point of the chart is stable with this probability within all limits"));
        }
    }
    for word in &requested.show {
        // The words are checked with the arguments.
        if let Some(kind) = MapKind::from_word(word)
            && !study.maps.iter().any(|map| map.kind == kind)
        {
            study.maps.push(ChartMap::new(study, kind).map_err(failed)?);
        }
    }
    Ok(())
}

/// What the stability model refuses: an iteration without result is no fault of the input.
fn refused(error: ChatterError) -> Failure {
    if matches!(error, ChatterError::NotConverged { .. }) {
        return Failure::work_error(&error);
    }
    let outside = matches!(error, ChatterError::SpeedOutsideTable { .. });
    Failure::argument(error, if outside { "give a speed of the table" } else { "see the values of the file" })
}

/// `--pitch FROM TO` and `--helix FROM TO`: the unequal pitch, or the helix, for a window of speeds.
fn window(file: &LobesFile, ends: [&String; 2], pitch: bool, voice: &Voice) -> Result<(), Failure> {
    const FIX: &str = "write for example --pitch \"7000 rpm\" \"8000 rpm\", or --helix";
    let mut speeds = [0.0; 2];
    for (speed, text) in speeds.iter_mut().zip(ends) {
        *speed = quantity(text, "rad/s").map_err(|error| Failure::argument(error, FIX))?;
    }
    let failed = |error| match error {
        PitchError::Refused(error) => refused(error),
        error @ (PitchError::Process | PitchError::Window) => Failure::argument(error, FIX),
    };
    if pitch {
        let best = file.best_pitch(speeds).map_err(failed)?;
        return if voice.json { voice.json(&best.json()) } else { voice.data(best.text()) };
    }
    let best = file.best_helix(speeds).map_err(failed)?;
    if voice.json { voice.json(&best.json()) } else { voice.data(best.text()) }
}

/// `--history DIR`: the vibration at a point over time.
fn history(
    file: &FormFile<LobesFile>,
    path: &Path,
    [speed, depth]: [&String; 2],
    target: &Path,
    args: &LobesArgs,
    voice: &Voice,
) -> Result<(), Failure> {
    let start = Instant::now();
    let place = file.content.cut.place(speed, depth).map_err(|error| Failure::argument(&error, error.fix()))?;
    let inputs = std::iter::once(path).chain(file.files.iter().map(AsRef::as_ref));
    let output_dir = OutputDir::create(target, HISTORY_NAMES, inputs, voice.force)?;
    let history = file.content.history(place).map_err(|error| match error {
        HistoryError::Refused(error) => refused(error),
        error @ (HistoryError::Process | HistoryError::NoFeed { .. }) => {
            Failure::argument(error, "see docs/dynamics.md")
        }
    })?;
    let inputs = [(path.display().to_string(), file.text.as_bytes())];
    let changes = args.set.iter().flat_map(|change| ["--set".to_owned(), change.clone()]);
    let point = ["--at".to_owned(), speed.clone(), depth.clone()];
    let provenance = provenance("lobes", &inputs, point.into_iter().chain(changes), None);
    output_dir.put_all(&history.files(provenance.clone()))?;
    output_dir.record(&provenance, start.elapsed())?;
    voice.say(format_args!("wrote {}", output_dir.publish()?.join("report.html").display()));
    Ok(())
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
        let guide = |error| Failure::argument(error, "see docs/dynamics.md");
        let measured = crate::modes::responses(path)?;
        verdict = verdict.beside(&*measured.at(place.0).map_err(guide)?).map_err(guide)?;
        if let Some(warning) = verdict.warning() {
            voice.say(format_args!("warning: {warning}"));
        }
    }
    if voice.json { voice.json(&verdict.json()) } else { voice.data(verdict.text()) }
}
