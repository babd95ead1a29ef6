//! `toolroom report DIR`: the report of a finished run.

use crate::args::ReportArgs;
use crate::failure::Failure;
use crate::results::Results;
use crate::speak::Voice;
use std::process::{Command, Stdio};

pub fn run(args: &ReportArgs, voice: &Voice) -> Result<(), Failure> {
    let results = Results::read(&args.dir)?;
    let report = args.dir.join("report.html");
    if !report.is_file() {
        let message = format!("{} holds no report.html", args.dir.display());
        return Err(Failure::argument(message, "run the study again: toolroom compare FILE"));
    }
    if voice.json {
        voice.json(&results.summary)?;
    } else {
        voice.data(report.display())?;
        if let Some(line) = results.summary["decision"]["line"].as_str() {
            voice.say(line);
        }
    }
    if !results.complete() {
        voice.say("the run was interrupted: the report holds the replications that were complete");
    }
    if args.open {
        let opener = if cfg!(target_os = "macos") { "open" } else { "xdg-open" };
        let opened = Command::new(opener).arg(&report).stdin(Stdio::null()).stdout(Stdio::null()).spawn();
        opened.map_err(|error| Failure::Work { message: format!("{opener} does not start: {error}") })?;
    }
    Ok(())
}
