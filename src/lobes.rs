//! `toolroom lobes FILE`: the stability chart, or the verdict at one point.

mod cut;
mod file;
mod picture;
mod results;

use crate::args::LobesArgs;
use crate::failure::Failure;
use crate::output::OutputDir;
use crate::speak::Voice;
use crate::study::default_out;
use cut::{Curve, Cut, Judgement, word};
use file::LobesFile;
use serde_json::{Value, json};
use std::fmt::Write;
use std::time::Instant;
use toolroom_chatter::{ChatterError, Lobes};
use toolroom_process::unit;
use toolroom_sim::scenario::file::significant;

/// A chart worked out.
struct Computed {
    curves: Vec<Curve>,
    /// The grid, unless only the boundary was wanted.
    grid: Option<Lobes>,
    /// One an operating point.
    judgements: Vec<Judgement>,
}

pub fn run(args: &LobesArgs, voice: &Voice) -> Result<(), Failure> {
    let file = file::read(&args.file, &args.set)?;
    if let [speed, depth] = args.at.as_slice() {
        return verdict(&file.content, speed, depth, voice);
    }
    let target = args.out.clone().unwrap_or_else(|| default_out(&file.content.name));
    // An unwritable place is told before the work, and nothing lies there while it lasts.
    drop(OutputDir::create(&target)?);
    let start = Instant::now();
    let computed = compute(&file.content, voice)?;
    let wall = start.elapsed();
    let out = OutputDir::create(&target)?;
    results::write(&out, args, &file, &computed, wall)?;
    let target = out.publish()?;
    if voice.json {
        voice.json(&results::summary(&file.content, &computed))?;
    } else {
        voice.data(summary(&file.content, &computed))?;
    }
    voice.detail(format_args!("{:.2} s", wall.as_secs_f64()));
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}

fn compute(file: &LobesFile, voice: &Voice) -> Result<Computed, Failure> {
    let LobesFile { cut, chart, points, .. } = file;
    let judge = |point: &file::Point| cut.judge(point.speed, point.depth, chart);
    let judgements = points.iter().map(judge).collect::<Result<Vec<_>, _>>().map_err(refused)?;
    let curves = cut.boundaries(chart).map_err(refused)?;
    let grid = if chart.boundary_only {
        None
    } else {
        voice.say(format_args!("judging {} × {} points", chart.speed.points, chart.depth.points));
        match cut.lobes(chart) {
            Err(error @ ChatterError::NotConverged { .. }) => {
                // The boundary does not come from the grid; it stands without it.
                voice.say(format_args!("warning: {error}; the boundary alone is drawn"));
                None
            }
            grid => Some(grid.map_err(refused)?),
        }
    };
    Ok(Computed { curves, grid, judgements })
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
    let values = cut.json(&judgement);
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
        Cut::Chuck(chuck) => match unit::quantity(text, "rad/s") {
            Ok(spindle) => 3.0 * spindle / chuck.natural_frequency(),
            Err(_) => unit::quantity(text, "1").map_err(|error| Failure::argument(error, example))?,
        },
        _ => unit::quantity(text, "rad/s").map_err(|error| Failure::argument(error, example))?,
    };
    if speed.is_finite() && speed > 0.0 {
        return Ok(speed);
    }
    Err(Failure::argument(format_args!("the speed must be positive, is {text}"), example))
}

fn example(cut: &Cut) -> &'static str {
    match cut {
        Cut::Chuck(_) => "write for example --at 1 0.3",
        _ => "write for example --at \"5000 rpm\" \"0.5 mm\"",
    }
}

/// A depth of cut, m, or the modulation of a chuck.
fn depth_at(cut: &Cut, text: &str) -> Result<f64, Failure> {
    let example = example(cut);
    let unit = if matches!(cut, Cut::Chuck(_)) { "1" } else { "m" };
    let depth = unit::quantity(text, unit).map_err(|error| Failure::argument(error, example))?;
    if depth.is_finite() && depth >= 0.0 {
        return Ok(depth);
    }
    Err(Failure::argument(format_args!("the depth must not be negative, is {text}"), example))
}

/// The chart in a few lines.
fn summary(file: &LobesFile, computed: &Computed) -> String {
    let axes = file.cut.axes();
    let with_unit = |quantity: &cut::Quantity, value: f64| {
        let number = significant((quantity.shown(value) * 1e4).round() / 1e4);
        if quantity.unit == "1" { number } else { format!("{number} {}", quantity.unit) }
    };
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
        let _ = writeln!(text, "  stable: {:.1} % of the chart", 100.0 * grid.stable_share());
    }
    if !computed.judgements.is_empty() {
        let _ = writeln!(
            text,
            "  {:20} {:>12} {:>12}  {:10} {:>9} {:>12} {:>8} {:>10}",
            "operating point", axes.speed.key, axes.depth.key, "verdict", "radius", "limit", "margin", "frequency"
        );
    }
    for (point, judgement) in file.points.iter().zip(&computed.judgements) {
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
