//! `toolroom grind FILE`: the fastest cycle within limits, and the dressing interval.

mod picture;
mod results;
mod text;

use crate::args::GrindArgs;
use crate::failure::Failure;
use crate::faulty::{FaultyFile, Placed, key_place};
use crate::output::OutputDir;
use crate::speak::Voice;
use crate::study::default_out;
use std::path::Path;
use std::time::Instant;
use toolroom_infeed::{Cycle, CycleError, CycleFile, CycleFileError, DressingInterval};

/// A grinding task worked out.
struct Design {
    name: String,
    text: String,
    file: CycleFile,
    cycle: Cycle,
    /// By estimated cycles and by the exact cycle of every part.
    dressing: Option<[DressingInterval; 2]>,
}

pub fn run(args: &GrindArgs, voice: &Voice) -> Result<(), Failure> {
    let start = Instant::now();
    let target = args.out.clone().unwrap_or_else(|| default_out(&name(&args.file)));
    let out = OutputDir::create(&target, results::NAMES, [args.file.as_path()], voice.force)?;
    let design = design(&args.file, &args.set)?;
    let wall = start.elapsed();
    results::write(&out, args, &design, wall)?;
    let target = out.publish()?;
    if voice.json {
        voice.json(&results::summary(&design))?;
    } else {
        voice.data(text::summary(&design))?;
    }
    voice.detail(format_args!("{:.3} s", wall.as_secs_f64()));
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}

/// Name of the design: that of its file.
fn name(file: &Path) -> String {
    file.file_stem().map_or_else(|| "cycle".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// Whether a cycle file can be worked out.
pub fn check(file: &Path, set: &[String]) -> Result<(), Failure> {
    design(file, set).map(|_| ())
}

fn design(file: &Path, set: &[String]) -> Result<Design, Failure> {
    let name = name(file);
    let path = file.display().to_string();
    let text = std::fs::read_to_string(file).map_err(|error| {
        Failure::argument(
            format_args!("{path} cannot be read: {error}"),
            "give a cycle file, such as scenarios/grinding/cycle.toml",
        )
    })?;
    let text = text.trim_start_matches('\u{FEFF}').to_owned();
    let mut file = CycleFile::read(&path, &text).map_err(|error| refused_file(&error, &text))?;
    for change in set {
        let (key, value) = change.split_once('=').ok_or_else(|| {
            Failure::argument(format_args!("`{change}` is not of the form key=value"), "--set limits.stock=\"50 um\"")
        })?;
        file.set(key.trim(), value.trim()).map_err(|reason| {
            Failure::argument(
                format_args!("--set {change}: {reason}"),
                "keys are table.key, such as limits.stock, or effects.ID",
            )
        })?;
    }
    let refuse = |error| conflict(&error, &path, &text);
    let cycle = file.fastest_cycle().map_err(refuse)?;
    let dressing = file.dressing_intervals().map_err(refuse)?;
    Ok(Design { name, text, file, cycle, dressing })
}

impl Design {
    /// Limits that the cycle breaks in the process itself. The search takes the wheel as it is at
    /// the start of the part; dulling within the part and warm gauging come on top.
    fn broken(&self) -> Vec<&'static str> {
        let (cycle, limits) = (&self.cycle, &self.file.limits);
        let above = |value: f64, limit: f64| value > limit * (1.0 + 1e-9);
        [
            ("rough_temperature_rise", above(cycle.peak_temperature_rise, limits.rough_temperature_rise)),
            ("finish_stock", above(limits.finish_stock, cycle.finish_stock)),
            ("last_depth", above(cycle.last_depth, limits.last_depth)),
            ("size_error", above(cycle.size_error, limits.size_error)),
            ("roundness_error", above(cycle.roundness_error, limits.roundness_error)),
        ]
        .into_iter()
        .filter_map(|(limit, broken)| broken.then_some(limit))
        .collect()
    }

    /// What to know about broken limits before the cycle is used.
    fn warning(&self) -> Option<String> {
        let broken = self.broken();
        (!broken.is_empty()).then(|| {
            format!(
                "what the wheel does within the part breaks {}: the search takes the wheel as it is at the start; tighten \
                 the limit by what is missing",
                broken.join(", ")
            )
        })
    }
}

fn refused_file(error: &CycleFileError, text: &str) -> Failure {
    let placed = |fault: &toolroom_infeed::CycleFault| {
        Placed::new(fault.reason.code(), (fault.line, fault.column), &fault.reason)
    };
    FaultyFile::new(&error.file, text, error.faults.iter().map(placed).collect()).into()
}

/// Limits that no cycle meets: their place in the file is that of the first of them.
fn conflict(error: &CycleError, path: &str, text: &str) -> Failure {
    let code = if error.limits().is_empty() { "out-of-range" } else { "limits-conflict" };
    let place = key_place(text, "limits", error.limits().first().copied().unwrap_or("limits"));
    let mut fault = Placed::new(code, place, error);
    if let [one, other, ..] = error.limits() {
        fault.fix = Some(format!("change {one} or {other}"));
    }
    FaultyFile::new(path, text, vec![fault]).into()
}
