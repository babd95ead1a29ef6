//! `toolroom identify DATA`: lag and stiffnesses from plunge trials.

use crate::args::{IdentifyArgs, IdentifyBasis};
use crate::failure::Failure;
use crate::faulty::{FaultyFile, Placed};
use crate::output::{OutputDir, provenance};
use crate::speak::Voice;
use crate::study::default_out;
use std::path::Path;
use std::time::Instant;
use toolroom_chart::page::Provenance;
use toolroom_form::nearest;
use toolroom_infeed::{Basis, IdentifyError, IdentifyOptions, TableError, read_force_traces, read_trials};
use toolroom_planning::identification::{IdentificationStudy, NAMES};
use toolroom_process::{AnyRecord, unit};
use toolroom_shards::fingerprint;

/// An input file as read.
struct Input {
    name: String,
    bytes: Vec<u8>,
}

pub fn run(args: &IdentifyArgs, voice: &Voice) -> Result<(), Failure> {
    let start = Instant::now();
    let target = args.out.clone().unwrap_or_else(|| default_out(&title(args)));
    let inputs = std::iter::once(args.data.as_path()).chain(args.forces.as_deref());
    let out = OutputDir::create(&target, NAMES, inputs, voice.force)?;
    let (inputs, study) = study(args, voice)?;
    let wall = start.elapsed();
    let provenance = origin(args, &inputs);
    out.put_all(&study.files(provenance.clone()))?;
    out.record(&provenance, wall)?;
    let target = out.publish()?;
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
fn origin(args: &IdentifyArgs, inputs: &[Input]) -> Provenance {
    let mut arguments: Vec<String> = Vec::new();
    if let Some(force) = &args.forces {
        arguments.extend(["--forces".to_owned(), force.display().to_string()]);
    }
    arguments.extend(["--basis".to_owned(), args.basis.name().to_owned()]);
    arguments.extend(args.error.iter().flat_map(|change| ["--error".to_owned(), change.clone()]));
    let trials = [(inputs[0].name.clone(), inputs[0].bytes.as_slice())];
    let mut provenance = provenance("identify", &trials, arguments, Some(args.seed));
    provenance.inputs.extend(inputs[1..].iter().map(|input| (input.name.clone(), fingerprint(&input.bytes))));
    provenance
}

/// The input files, and the study of the trials in them.
fn study(args: &IdentifyArgs, voice: &Voice) -> Result<(Vec<Input>, IdentificationStudy), Failure> {
    let options = options(args)?;
    let data = read(&args.data)?;
    let table = read_trials(&data.name, &data.bytes).map_err(|error| refused_table(error, &data))?;
    let mut trials = table.trials;
    let mut notes: Vec<(String, String)> =
        table.notes.iter().map(|note| (data.name.clone(), note.to_string())).collect();
    let mut inputs = vec![data];
    if let Some(path) = &args.forces {
        let force = read(path)?;
        let more =
            read_force_traces(&force.name, &force.bytes, &mut trials).map_err(|error| refused_table(error, &force))?;
        notes.extend(more.iter().map(|note| (force.name.clone(), note.to_string())));
        inputs.push(force);
    }
    for (file, note) in &notes {
        voice.say(format_args!("{file}: {note}"));
    }
    let study = IdentificationStudy::new(title(args), trials, options);
    let study = study.map_err(|error| impossible(error, &inputs[0]))?;
    Ok((inputs, study))
}

fn options(args: &IdentifyArgs) -> Result<IdentifyOptions, Failure> {
    let basis = match args.basis {
        IdentifyBasis::Both => Basis::Both,
        IdentifyBasis::Stock => Basis::Stock,
        IdentifyBasis::Force => Basis::Force,
    };
    let mut options = IdentifyOptions { basis, resamples: args.resamples, seed: args.seed, ..Default::default() };
    let errors: &mut dyn AnyRecord = &mut options.errors;
    for change in &args.error {
        let (key, value) = change.split_once('=').unwrap_or((change, ""));
        let fields = errors.fields();
        let Some(index) = fields.iter().position(|field| field.name == key.trim()) else {
            let known: Vec<&str> = fields.iter().map(|field| field.name).collect();
            let near =
                nearest(key, known.iter().copied()).map_or(String::new(), |near| format!("did you mean `{near}`? "));
            let help = format!("{near}measurements: {}", known.join(", "));
            return Err(Failure::argument(format_args!("--error: there is no measurement `{key}`"), help));
        };
        let field = &fields[index];
        let help =
            format!("write for example --error {}=\"{} {}\"", field.name, field.to_display(field.start), field.display);
        let read = unit::quantity(value, field.unit)
            .map_err(|error| Failure::argument(format_args!("--error {key}: {error}"), &help))?;
        field.check(read).map_err(|error| Failure::argument(format_args!("--error {error}"), &help))?;
        errors.set_value(index, read);
    }
    Ok(options)
}

fn read(path: &Path) -> Result<Input, Failure> {
    let name = path.display().to_string();
    let bytes = std::fs::read(path).map_err(|error| {
        Failure::argument(
            format_args!("{name} cannot be read: {error}"),
            "give a table of trials, such as scenarios/data/zb153u_trials.csv",
        )
    })?;
    Ok(Input { name, bytes })
}

/// A table that is none.
fn refused_table(error: TableError, input: &Input) -> Failure {
    let text = String::from_utf8_lossy(&input.bytes);
    // Columns of a table are cells: the line is what an editor finds.
    let placed = |fault: &toolroom_infeed::TableFault| {
        Placed::new(fault.reason.code(), (fault.line, 1), format_args!("{} (cell {})", fault.reason, fault.column))
    };
    FaultyFile::new(&input.name, &text, error.faults.iter().map(placed).collect()).into()
}

/// Trials that cannot be, each by its name and line.
fn impossible(error: IdentifyError, input: &Input) -> Failure {
    match error {
        IdentifyError::Impossible { trials } => {
            let text = String::from_utf8_lossy(&input.bytes);
            let placed = |trial: &toolroom_infeed::ImpossibleTrial| {
                let message = format!("trial `{}`: {}", trial.trial_id, trial.fault);
                Placed::new(trial.fault.code(), (trial.line.unwrap_or(1), 1), message)
            };
            FaultyFile::new(&input.name, &text, trials.iter().map(placed).collect()).into()
        }
        other => Failure::argument(&other, "see the header of scenarios/data/zb153u_trials.csv"),
    }
}
