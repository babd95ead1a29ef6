//! `toolroom lobes FILE`: the stability chart, or the verdict at one point.

mod picture;
mod results;
mod shards;

use crate::args::LobesArgs;
use crate::failure::Failure;
use crate::output::OutputDir;
use crate::shard::{perform, pool};
use crate::speak::Voice;
use crate::study::default_out;
use results::Origin;
use serde_json::{Value, json};
use std::fmt::Write;
use std::time::Instant;
use toolroom_chatter::{ChatterError, Hole, Lobes};
use toolroom_form::{FormFile, significant};
use toolroom_planning::lobes::{Curve, Cut, Judged, LobesFile, Point, Quantity, boundaries, read, word};
use toolroom_process::unit;

pub use shards::{merge, shard};

/// A chart worked out.
struct Computed {
    curves: Vec<Curve>,
    /// The grid, unless only the boundary was wanted.
    grid: Option<Lobes>,
    /// One an operating point.
    judgements: Vec<Judged>,
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
    let out = OutputDir::create(&target, results::NAMES, inputs, voice.force)?;
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
    let LobesFile { cut, chart, points, .. } = &file.content;
    let judge = |point: &Point| match cut.judge(point.speed, point.depth, chart) {
        Err(error) if !error.is_failed_search() => Err(error),
        judged => Ok(judged),
    };
    let judgements = points.iter().map(judge).collect::<Result<Vec<_>, _>>().map_err(refused)?;
    let curves = boundaries(cut, chart).map_err(refused)?;
    let computed = Computed { curves, grid, judgements };
    for warning in holes(&file.content, &computed) {
        voice.say(format_args!("warning: {warning}"));
    }
    let told = results::write(&out, origin, file, &computed)?;
    let target = out.publish()?;
    if voice.json {
        voice.json(&told)?;
    } else {
        voice.data(summary(&file.content, &computed))?;
    }
    voice.detail(format_args!("{:.2} s", origin.start.elapsed().as_secs_f64()));
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}

/// What the chart lacks, a sentence each: points, limits and operating points for which the search failed.
fn holes(file: &LobesFile, computed: &Computed) -> Vec<String> {
    let axes = file.cut.axes();
    let mut told = Vec::new();
    if let Some(grid) = &computed.grid
        && let Some(Hole { speed, depth, reason }) = grid.holes.first()
    {
        let (count, all) = (grid.holes.len(), grid.verdicts.len());
        let (speed, depth) = (with_unit(&axes.speed, *speed), with_unit(&axes.depth, *depth));
        told.push(format!(
            "{count} of {all} points have no verdict and are holes in the chart, first {speed}, {depth}: {reason}"
        ));
    }
    for curve in &computed.curves {
        if let Some((speed, reason)) = curve.holes.first() {
            let (count, all, label) = (curve.holes.len(), curve.limit.len(), &curve.label);
            let speed = with_unit(&axes.speed, *speed);
            told.push(format!("{label}: not found at {count} of {all} speeds, first {speed}: {reason}"));
        }
    }
    for (point, judged) in file.points.iter().zip(&computed.judgements) {
        if let Err(error) = judged {
            told.push(format!("operating point \"{}\" has no verdict: {error}", point.name));
        }
    }
    told
}

/// A quantity for people, to four decimals.
fn with_unit(quantity: &Quantity, value: f64) -> String {
    let number = significant((quantity.shown(value) * 1e4).round() / 1e4);
    if quantity.unit == "1" { number } else { format!("{number} {}", quantity.unit) }
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

/// The chart in a few lines.
fn summary(file: &LobesFile, computed: &Computed) -> String {
    let axes = file.cut.axes();
    let mut text = format!("{}\n", file.title);
    for curve in &computed.curves {
        let limits = || curve.limit.iter().filter(|(_, depth)| depth.is_finite());
        let least = limits().min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((speed, depth)) = least {
            let (depth, speed) = (with_unit(&axes.depth, *depth), with_unit(&axes.speed, *speed));
            let _ = writeln!(text, "  {}: least {depth} at {} {speed}", curve.label, axes.speed.label.to_lowercase());
        } else {
            let _ = writeln!(text, "  {}: none on the chart", curve.label);
        }
    }
    if let Some(grid) = &computed.grid {
        let (all, holes) = (grid.verdicts.len(), grid.holes.len());
        let share = 100.0 * grid.stable_share();
        let _ = match holes {
            0 => writeln!(text, "  stable: {share:.1} % of the chart"),
            _ if holes == all => writeln!(text, "  no point of the chart has a verdict"),
            _ => {
                writeln!(text, "  stable: {share:.1} % of the {} points with a verdict; {holes} have none", all - holes)
            }
        };
    }
    if !computed.judgements.is_empty() {
        let _ = writeln!(
            text,
            "  {:20} {:>12} {:>12}  {:10} {:>9} {:>12} {:>8} {:>10}",
            "operating point", axes.speed.key, axes.depth.key, "verdict", "radius", "limit", "margin", "frequency"
        );
    }
    for (point, judged) in file.points.iter().zip(&computed.judgements) {
        let Ok(judgement) = judged else {
            let (speed, depth) = (with_unit(&axes.speed, point.speed), with_unit(&axes.depth, point.depth));
            let _ = writeln!(text, "  {:20} {speed:>12} {depth:>12}  no verdict", point.name);
            continue;
        };
        let verdict = &judgement.verdict;
        let none = || "none".to_owned();
        let _ = writeln!(
            text,
            "  {:20} {:>12} {:>12}  {:10} {:>9.4} {:>12} {:>8} {:>10}",
            point.name,
            with_unit(&axes.speed, point.speed),
            with_unit(&axes.depth, point.depth),
            word(verdict.kind),
            verdict.spectral_radius,
            judgement.limit.map_or_else(none, |limit| with_unit(&axes.depth, limit)),
            judgement.margin().map_or_else(none, |margin| format!("{:.1} %", 100.0 * margin)),
            format!("{:.1} Hz", file.cut.chatter_frequency(verdict)),
        );
    }
    text.truncate(text.trim_end().len());
    text
}
