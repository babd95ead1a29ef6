//! `toolroom contour FILE`: plans of least time and least cost along a contour.

use crate::args::ContourArgs;
use crate::failure::Failure;
use crate::progress::Bar;
use crate::speak::Voice;
use crate::study::{RESUME, default_out};
use serde_json::json;
use std::time::Instant;
use toolroom_chart::page::Provenance;
use toolroom_output::{OutputDir, provenance, signals};
use toolroom_planning::contour::{
    DrawJournal, Drawn, NAMES, StudyOptions, Task, edge_life, files, join_length, studies, summary, text,
};
use toolroom_program::{Control, Dialect, Units};
use toolroom_shards::fingerprint;
use toolroom_study::study::Progress;

pub fn run(args: &ContourArgs, voice: &Voice) -> Result<(), Failure> {
    let control = args.gcode.as_deref().map(|path| {
        let units = args.units.as_deref().and_then(Units::named);
        let dialect = args.dialect.as_deref().and_then(Dialect::named);
        (path, Control { dialect, ..Control::of_file(path, units) })
    });
    let units = args.units.as_deref().and_then(Units::named);
    let join = args.join.as_deref().map(|text| {
        join_length(text)
            .map_err(|reason| Failure::argument(format_args!("--join {text}: {reason}"), "write --join \"10 um\""))
    });
    let join = join.transpose()?;
    let drawn = match (&control, &args.dxf) {
        (Some((path, control)), _) => Some(Drawn::Program(path, control)),
        (None, Some(path)) => Some(Drawn::Dxf(path, args.layer.as_deref(), units, join)),
        (None, None) => None,
    };
    let task = Task::read(&args.file, drawn, &args.set)?;
    for name in &args.pass {
        let pass = task.file.pass(name);
        pass.map_err(|error| Failure::argument(format_args!("--pass: {error}"), "leave --pass out for all"))?;
    }
    let target = args.out.clone().unwrap_or_else(|| default_out(&task.file.name));
    let inputs = std::iter::once(args.file.as_path()).chain(args.gcode.as_deref()).chain(args.dxf.as_deref());
    let output_dir = OutputDir::create(&target, NAMES, inputs, voice.force)?;
    let start = Instant::now();
    let options = options(args)?;
    let provenance = origin(args, &task);
    let head = json!([provenance.version, provenance.command, provenance.inputs, provenance.seed]);
    let journal = DrawJournal::open(&output_dir.journal(args.resume)?.join("draws"), &head)?;
    let bar = Bar::of(voice, "plans");
    let progress = |done, total| {
        signals::keeps(format!("interrupted: {done} of {total} parts of the plan are kept"), RESUME.to_owned());
        bar.at(Progress { done, total });
    };
    let studies = studies(&task.file, &options, &|note| voice.say(note), &progress, Some(&journal));
    bar.finish();
    let studies = studies.map_err(|refused| task.refused(&refused))?;
    let wall = start.elapsed();
    let dialect = args.post.as_deref().and_then(Dialect::named).unwrap_or(Dialect::Fanuc);
    let results = files(&task.file, &studies, provenance.clone(), dialect).map_err(|refused| task.refused(&refused))?;
    output_dir.put_all(&results)?;
    output_dir.record(&provenance, wall)?;
    let target = output_dir.publish()?;
    if voice.json {
        voice.json(&summary(&task.file, &studies))?;
    } else {
        voice.data(text(&task.file, &studies))?;
    }
    voice.detail(format_args!("{:.2} s", wall.as_secs_f64()));
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}

fn options(args: &ContourArgs) -> Result<StudyOptions, Failure> {
    let help = "write for example --edge 0.3 or --edge \"30 %\"";
    let edge = args
        .edge
        .as_ref()
        .map(|text| edge_life(text).map_err(|reason| Failure::argument(format_args!("--edge {text}: {reason}"), help)));
    Ok(StudyOptions {
        passes: args.pass.clone(),
        ramps: args.ramps,
        edge: edge.transpose()?,
        draws: args.draws,
        seed: args.seed,
    })
}

/// Command and input files of a plan.
fn origin(args: &ContourArgs, task: &Task) -> Provenance {
    let mut arguments: Vec<String> = Vec::new();
    for (flag, values) in [("--pass", &args.pass), ("--set", &args.set)] {
        arguments.extend(values.iter().flat_map(|value| [flag.to_owned(), value.clone()]));
    }
    if let Some(program) = &args.gcode {
        arguments.extend(["--gcode".to_owned(), program.display().to_string()]);
    }
    if let Some(drawing) = &args.dxf {
        arguments.extend(["--dxf".to_owned(), drawing.display().to_string()]);
    }
    if let Some(layer) = &args.layer {
        arguments.extend(["--layer".to_owned(), layer.clone()]);
    }
    if let Some(join) = &args.join {
        arguments.extend(["--join".to_owned(), join.clone()]);
    }
    if let Some(post) = &args.post {
        arguments.extend(["--post".to_owned(), post.clone()]);
    }
    arguments.extend(args.ramps.then(|| "--ramps".to_owned()));
    arguments.extend(args.edge.iter().flat_map(|edge| ["--edge".to_owned(), edge.clone()]));
    arguments.extend(["--draws".to_owned(), args.draws.to_string()]);
    let setup = [(task.inputs[0].name.clone(), task.inputs[0].text.as_bytes())];
    let mut provenance = provenance("contour", &setup, arguments, Some(args.seed));
    let programs = task.inputs[1..].iter();
    provenance.inputs.extend(programs.map(|input| (input.name.clone(), fingerprint(input.text.as_bytes()))));
    provenance
}
