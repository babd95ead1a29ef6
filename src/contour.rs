//! `toolroom contour FILE`: plans of least time and least cost along a contour.

mod compute;
mod input;
mod picture;
mod report;
mod results;
mod text;

use crate::args::ContourArgs;
use crate::failure::Failure;
use crate::output::OutputDir;
use crate::speak::Voice;
use crate::study::default_out;
use std::path::Path;
use std::time::Instant;

/// Name and number of passes of a contour file that can be read.
pub fn check(file: &Path, set: &[String]) -> Result<(String, usize), Failure> {
    let task = input::read(file, None, set, &[])?;
    Ok((task.file.name, task.file.passes.len()))
}

pub fn run(args: &ContourArgs, voice: &Voice) -> Result<(), Failure> {
    let task = input::read(&args.file, args.gcode.as_deref(), &args.set, &args.pass)?;
    let target = args.out.clone().unwrap_or_else(|| default_out(&task.file.name));
    let inputs = std::iter::once(args.file.as_path()).chain(args.gcode.as_deref());
    let out = OutputDir::create(&target, results::NAMES, inputs, voice.force)?;
    let start = Instant::now();
    let studies = compute::studies(&task, args, voice)?;
    let wall = start.elapsed();
    results::write(&out, args, &task, &studies, wall)?;
    let target = out.publish()?;
    if voice.json {
        voice.json(&results::summary(&task, &studies))?;
    } else {
        voice.data(text::summary(&task, &studies))?;
    }
    voice.detail(format_args!("{:.2} s", wall.as_secs_f64()));
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}
