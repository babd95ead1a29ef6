//! `toolroom identify DATA`: lag and stiffnesses from plunge trials.

use crate::args::IdentifyArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::default_out;
use std::path::Path;
use std::time::Instant;
use toolroom_chart::page::Provenance;
use toolroom_infeed::IdentifyOptions;
use toolroom_output::{OutputDir, provenance};
use toolroom_planning::identification::{IdentificationStudy, NAMES, Table, TrialsError, measurement_errors};
use toolroom_shards::fingerprint;

pub fn run(args: &IdentifyArgs, voice: &Voice) -> Result<(), Failure> {
    let start = Instant::now();
    let target = args.out.clone().unwrap_or_else(|| default_out(&title(args)));
    let inputs = std::iter::once(args.data.as_path()).chain(args.forces.as_deref());
    let output_dir = OutputDir::create(&target, NAMES, inputs, voice.force)?;
    let (inputs, study) = study(args, voice)?;
    let wall = start.elapsed();
    let provenance = origin(args, &inputs);
    output_dir.put_all(&study.files(provenance.clone()))?;
    output_dir.record(&provenance, wall)?;
    let target = output_dir.publish()?;
    if voice.json {
        voice.json(&study.summary())?;
    } else {
        voice.data(study.text())?;
    }
    voice.detail(format_args!("{:.3} s", wall.as_secs_f64()));
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}

/// Name of the study: that of its table.
fn title(args: &IdentifyArgs) -> String {
    args.data.file_stem().map_or_else(|| "trials".to_owned(), |stem| stem.to_string_lossy().into_owned())
}

/// Command and input files of an identification.
fn origin(args: &IdentifyArgs, inputs: &[Table]) -> Provenance {
    let mut arguments: Vec<String> = Vec::new();
    if let Some(force) = &args.forces {
        arguments.extend(["--forces".to_owned(), force.display().to_string()]);
    }
    arguments.extend(["--basis".to_owned(), args.basis.word().to_owned()]);
    arguments.extend(args.strict.then(|| "--strict".to_owned()));
    arguments.extend(args.error.iter().flat_map(|change| ["--error".to_owned(), change.clone()]));
    let trials = [(inputs[0].name.clone(), inputs[0].bytes.as_slice())];
    let mut provenance = provenance("identify", &trials, arguments, Some(args.seed));
    provenance.inputs.extend(inputs[1..].iter().map(|input| (input.name.clone(), fingerprint(&input.bytes))));
    provenance
}

/// The input files, and the study of the trials in them.
fn study(args: &IdentifyArgs, voice: &Voice) -> Result<(Vec<Table>, IdentificationStudy), Failure> {
    let options = options(args)?;
    let trials = read(&args.data)?;
    let forces = args.forces.as_deref().map(read).transpose()?;
    let (study, notes) = IdentificationStudy::read(title(args), &trials, forces.as_ref(), options).map_err(refused)?;
    notes.iter().for_each(|note| voice.say(note));
    Ok((std::iter::once(trials).chain(forces).collect(), study))
}

fn refused(error: TrialsError) -> Failure {
    if let TrialsError::Tables(error) = error {
        return error.into();
    }
    Failure::argument(&error, "see the header of scenarios/data/zb153u_trials.csv")
}

fn options(args: &IdentifyArgs) -> Result<IdentifyOptions, Failure> {
    let errors = measurement_errors(&args.error)
        .map_err(|error| Failure::argument(format_args!("--error: {error}"), error.fix()))?;
    Ok(IdentifyOptions {
        basis: args.basis,
        resamples: args.resamples as usize,
        seed: args.seed,
        errors,
        strict: args.strict,
    })
}

fn read(path: &Path) -> Result<Table, Failure> {
    let name = path.display().to_string();
    let bytes = toolroom_form::bytes(path).map_err(|error| {
        Failure::unreadable(path, error, "give a table of trials, such as scenarios/data/zb153u_trials.csv")
    })?;
    Ok(Table { name, bytes })
}
