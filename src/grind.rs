//! `toolroom grind FILE`: the fastest cycle within limits, and the dressing interval.

use crate::args::GrindArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::default_out;
use std::path::Path;
use std::time::Instant;
use toolroom_form::FormFile;
use toolroom_output::{OutputDir, provenance};
use toolroom_planning::cycle::{CycleDesign, NAMES};

pub fn run(args: &GrindArgs, voice: &Voice) -> Result<(), Failure> {
    let start = Instant::now();
    let target = args.out.clone().unwrap_or_else(|| default_out(&name(&args.file)));
    let output_dir = OutputDir::create(&target, NAMES, [args.file.as_path()], voice.force)?;
    let FormFile { content: design, text, .. } = CycleDesign::read(&args.file, &args.set)?;
    let wall = start.elapsed();
    let inputs = [(args.file.display().to_string(), text.as_bytes())];
    let changes = args.set.iter().flat_map(|change| ["--set".to_owned(), change.clone()]);
    let provenance = provenance("grind", &inputs, changes, None);
    output_dir.put_all(&design.files(provenance.clone()))?;
    output_dir.record(&provenance, wall)?;
    let target = output_dir.publish()?;
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
