//! `toolroom grind FILE`: the fastest cycle within limits, and the dressing interval.

use crate::args::GrindArgs;
use crate::failure::Failure;
use crate::faulty::{FaultyFile, Placed, key_place};
use crate::output::{OutputDir, provenance};
use crate::speak::Voice;
use crate::study::default_out;
use std::path::Path;
use std::time::Instant;
use toolroom_form::{Echo, FormFile};
use toolroom_infeed::{CycleError, CycleFile};
use toolroom_planning::cycle::{CycleDesign, NAMES};

pub fn run(args: &GrindArgs, voice: &Voice) -> Result<(), Failure> {
    let start = Instant::now();
    let target = args.out.clone().unwrap_or_else(|| default_out(&name(&args.file)));
    let out = OutputDir::create(&target, NAMES, [args.file.as_path()], voice.force)?;
    let (file, design) = design(&args.file, &args.set)?;
    let wall = start.elapsed();
    let inputs = [(args.file.display().to_string(), file.text.as_bytes())];
    let changes = args.set.iter().flat_map(|change| ["--set".to_owned(), change.clone()]);
    let provenance = provenance("grind", &inputs, changes, None);
    out.put_all(&design.files(provenance.clone()))?;
    out.record(&provenance, wall)?;
    let target = out.publish()?;
    if voice.json {
        voice.json(&design.summary())?;
    } else {
        voice.data(design.text())?;
    }
    voice.detail(format_args!("{:.3} s", wall.as_secs_f64()));
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}

/// Name of the design: that of its file.
fn name(file: &Path) -> String {
    file.file_stem().map_or_else(|| "cycle".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// The values of a cycle file that can be worked out.
pub fn check(file: &Path, set: &[String]) -> Result<Vec<Echo>, Failure> {
    design(file, set).map(|(file, _)| file.echo)
}

/// A cycle file and the design that it asks for.
fn design(file: &Path, set: &[String]) -> Result<(FormFile<()>, CycleDesign), Failure> {
    let FormFile { content, echo, text, files } = CycleFile::read(file, set)?;
    let design =
        CycleDesign::new(name(file), content).map_err(|error| conflict(&error, &file.display().to_string(), &text))?;
    Ok((FormFile { content: (), echo, text, files }, design))
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
