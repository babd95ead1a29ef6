//! `toolroom lobes FILE`: the stability chart, or the verdict at one point.

mod shards;

use crate::args::LobesArgs;
use crate::failure::Failure;
use crate::output::{OutputDir, provenance};
use crate::shard::{perform, pool};
use crate::speak::Voice;
use crate::study::default_out;
use serde_json::{Value, json};
use std::fmt::Write;
use std::time::Instant;
use toolroom_chatter::{ChatterError, Lobes};
use toolroom_form::{FormFile, significant};
use toolroom_planning::lobes::{ChartStudy, Cut, LobesFile, NAMES, read};
use toolroom_process::unit;

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
        let (Some(plan), Some(number), Some(out)) = (&args.run, args.shard, &args.out) else {
            return Err(Failure::argument(
                "--run needs --shard and --out",
                "write --run plan.json --shard 0 --out parts",
            ));
        };
        return perform(plan, number, out, args.threads, voice);
    };
    let file = read(path, &args.set)?;
    if let [speed, depth] = args.at.as_slice() {
        return verdict(&file.content, speed, depth, voice);
    }
    let input = path.display().to_string();
    if let Some(target) = &args.plan {
        return shards::plan(&input, &file, args, target, voice);
    }
    let target = args.out.clone().unwrap_or_else(|| default_out(&file.content.name));
    let inputs = std::iter::once(path.as_path()).chain(file.files.iter().map(AsRef::as_ref));
    let out = OutputDir::create(&target, NAMES, inputs, voice.force)?;
    pool(args.threads)?.install(|| {
        let LobesFile { cut, chart, .. } = &file.content;
        let start = Instant::now();
        let grid = if chart.boundary_only {
            None
        } else {
            voice.say(format_args!("judging {} × {} points", chart.speed.points, chart.depth.points));
            Some(cut.lobes(chart, 0..chart.speed.points).map_err(refused)?)
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

/// `--at SPEED DEPTH`.
fn verdict(file: &LobesFile, speed: &str, depth: &str, voice: &Voice) -> Result<(), Failure> {
    let LobesFile { cut, chart, .. } = file;
    let (speed, depth) = (speed_at(cut, speed)?, depth_at(cut, depth)?);
    let judgement = cut.judge(speed, depth, chart).map_err(refused)?;
    let values = judgement.json(cut);
    if voice.json {
        let mut object =
            serde_json::Map::from_iter([("schema".to_owned(), json!(1)), ("name".to_owned(), json!(file.name))]);
        object.extend(values);
        return voice.json(&object);
    }
    let mut text = format!("{}\n", file.title);
    for (name, value) in &values {
        let value = match value {
            Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), significant),
            Value::String(text) => text.clone(),
            Value::Null => "none".to_owned(),
            Value::Array(intervals) if name == "stable_intervals [mm]" => {
                let end = |interval: &Value, side: usize| interval[side].as_f64().map_or_else(String::new, significant);
                let interval = |interval: &Value| format!("{}–{}", end(interval, 0), end(interval, 1));
                intervals.iter().map(interval).collect::<Vec<_>>().join(", ")
            }
            // The lines are many; the strongest has a row of its own.
            Value::Array(lines) => format!("{} lines, with --json", lines.len()),
            other => other.to_string(),
        };
        let _ = writeln!(text, "  {name:28} {value:>24}");
    }
    voice.data(text.trim_end())
}

/// A spindle speed, rad/s; for a chuck a speed ratio, or the spindle speed that gives it.
fn speed_at(cut: &Cut, text: &str) -> Result<f64, Failure> {
    let example = example(cut);
    let speed = match cut {
        Cut::Chuck(chuck) => ratio(text, 3.0 / chuck.natural_frequency(), example)?,
        Cut::Lathe(lathe) => ratio(text, 1.0 / lathe.reference_frequency(), example)?,
        _ => unit::quantity(text, cut.axes().speed.si).map_err(|error| Failure::argument(error, example))?,
    };
    // A cut may come without lag.
    let least = if matches!(cut, Cut::ChipLag(_)) { 0.0 } else { f64::MIN_POSITIVE };
    if speed.is_finite() && speed >= least {
        return Ok(speed);
    }
    Err(Failure::argument(format_args!("the speed must be positive, is {text}"), example))
}

/// A ratio, or a spindle speed over that of ratio one.
fn ratio(text: &str, per_speed: f64, example: &str) -> Result<f64, Failure> {
    match unit::quantity(text, "rad/s") {
        Ok(spindle) => Ok(per_speed * spindle),
        Err(_) => unit::quantity(text, "1").map_err(|error| Failure::argument(error, example)),
    }
}

fn example(cut: &Cut) -> &'static str {
    match cut {
        Cut::Chuck(_) | Cut::Lathe(_) => "write for example --at 1 0.3",
        Cut::ChipLag(_) => "write for example --at \"40 us\" \"1.9 N/um\"",
        _ => "write for example --at \"5000 rpm\" \"0.5 mm\"",
    }
}

/// A depth of cut, m, or what stands for it on the second axis.
fn depth_at(cut: &Cut, text: &str) -> Result<f64, Failure> {
    let example = example(cut);
    let depth = unit::quantity(text, cut.axes().depth.si).map_err(|error| Failure::argument(error, example))?;
    if depth.is_finite() && depth >= 0.0 {
        return Ok(depth);
    }
    Err(Failure::argument(format_args!("the depth must not be negative, is {text}"), example))
}
