//! `toolroom report DIR`: the report of a finished run.

use crate::args::ReportArgs;
use crate::asked::Asked;
use crate::failure::Failure;
use crate::results::Results;
use crate::speak::Voice;
use std::path::Path;
use std::process::{Command, Stdio};
use toolroom_analysis::results::redraw;
use toolroom_analysis::study::StudyOptions;

pub fn run(args: &ReportArgs, voice: &Voice) -> Result<(), Failure> {
    let results = Results::read(&args.dir)?;
    let report = args.dir.join("report.html");
    if !report.is_file() {
        draw(&args.dir, &results)?;
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

/// Draws the report of a study of a shop again from what is in its directory.
fn draw(dir: &Path, results: &Results) -> Result<(), Failure> {
    let help = "run the study again";
    let Some(asked) = Asked::read(&results.run) else {
        let message = format!("{} holds no report.html, nor what is needed to draw it", dir.display());
        return Err(Failure::argument(message, help));
    };
    asked.refuse_version(dir)?;
    let file = asked.scenario()?;
    let options = StudyOptions { policies: asked.policies(&file)?, ..StudyOptions::of(&file.scenario) };
    let command = results.run["command"].as_str().unwrap_or_default().to_owned();
    redraw(dir, &file.scenario, &options, &asked.information(command)?).map_err(|error| match error.path() {
        Some(_) => Failure::Work { message: error.to_string() },
        None => Failure::argument(error, help),
    })
}
