//! `toolroom gap apply`: the model with everything that a diagnosis has found, and what that does
//! to the key figures of the shop.

use super::{files_of, nominal_of, reading};
use crate::args::ApplyArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use toolroom_apply::{ApplyError, Changes, Request, apply, is_marked, marked};
use toolroom_gap::{NominalModel, NominalProcess};
use toolroom_gap_study::{Figure, figures, table};
use toolroom_location::Location;
use toolroom_output::Files;

pub fn run(args: &ApplyArgs, voice: &Voice) -> Result<(), Failure> {
    let place = |error: &serde_json::Error| Location::column(args.diagnosis.display(), error.line(), error.column());
    let diagnosis: Value = serde_json::from_str(&read(&args.diagnosis)?)
        .map_err(|error| Failure::of_file(&args.diagnosis, &error, "give a diagnosis.json").at(Some(place(&error))))?;
    let data: Vec<PathBuf> = args.data.iter().flat_map(|data| files_of(data)).collect();
    let inputs = args.models.iter().chain([&args.diagnosis]).chain(&data).map(AsRef::as_ref);
    let files = Files::new(inputs, voice.force);
    match &args.models[..] {
        [model] => one(args, model, &files, &diagnosis, voice),
        models => several(args, models, &files, &diagnosis, voice),
    }
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path).map_err(Failure::unread(path))
}

/// The model of a file with what the diagnosis has found of its process.
fn changed(args: &ApplyArgs, path: &Path, nominal: &NominalModel, diagnosis: &Value) -> Result<Changes, ApplyError> {
    let text = toolroom_form::text(path).map_err(|error| ApplyError::Text { message: error.to_string() })?;
    let request = Request {
        text: &text,
        overrides: &args.set,
        diagnosis,
        process: nominal.kind().name(),
        only: &args.only,
        calibration: !args.no_calibration,
        empirical: args.accept_empirical,
    };
    let mut changes = apply(request)?;
    changes.text = marked(&changes.text, &changes.data);
    if !matches!(nominal.process, NominalProcess::Program(_)) {
        // Records may name what no scenario knows; what is written has to be one.
        NominalModel::parse(&path.display().to_string(), &changes.text, &args.set)
            .map_err(|error| ApplyError::Names { message: error.to_string() })?;
    }
    Ok(changes)
}

/// Channels from which the applied model of a process is farther than the model that was read.
fn grew(diagnosis: &Value, process: &str) -> Vec<Value> {
    let list = diagnosis["applied"]["grew"].as_array().into_iter().flatten();
    list.filter(|entry| entry["process"] == process).cloned().collect()
}

fn refused(error: &ApplyError) -> Failure {
    Failure::argument(error, error.fix())
}

/// One model into one file.
fn one(args: &ApplyArgs, model: &Path, files: &Files, diagnosis: &Value, voice: &Voice) -> Result<(), Failure> {
    let out = &args.out;
    let nominal = nominal_of(model, &args.set)?;
    let changes = changed(args, model, &nominal, diagnosis).map_err(|error| refused(&error))?;
    if args.diff {
        return voice.raw(toolroom_apply::changed_lines(&toolroom_form::text(model)?, &changes.text).trim_end());
    }
    put(files, out, &changes.text)?;
    let grew = grew(diagnosis, nominal.kind().name());
    for note in grew.iter().filter_map(|entry| entry["words"].as_str()) {
        voice.say(format_args!("warning: {note}"));
    }
    for note in &changes.notes {
        voice.say(note);
    }
    if let NominalProcess::Program(_) = nominal.process {
        return wrote(out, &changes, "toolroom gap diagnose --model", voice);
    }
    let figures =
        args.data.as_ref().map(|data| reading(voice, |reading| figures(model, out, data, reading))).transpose()?;
    let warnings = figures.iter().flatten().filter_map(Figure::warning);
    warnings.for_each(|warning| voice.say(format_args!("warning: {warning}")));
    if voice.json {
        let figures = figures.iter().flatten().map(Figure::json).collect::<Vec<_>>();
        return voice.json(&json!({
            "schema": 1, "model": out.display().to_string(), "effects": changes.effects,
            "calibration": changes.constants, "kpi": figures, "grew": grew,
        }));
    }
    if let Some(figures) = &figures {
        voice.data(table(figures).trim_end())?;
    }
    wrote(out, &changes, "toolroom run", voice)
}

/// Every model of a diagnosis of several processes into a directory, each under its own name; those
/// of processes of which nothing was found stay as they are.
fn several(
    args: &ApplyArgs,
    models: &[PathBuf],
    files: &Files,
    diagnosis: &Value,
    voice: &Voice,
) -> Result<(), Failure> {
    if args.data.is_some() {
        let message = "key figures are those of one shop, but several models are given";
        return Err(Failure::argument(message, "leave --data out, or give the model of the shop alone"));
    }
    let mut texts: Vec<(PathBuf, &str, String)> = Vec::new();
    for model in models {
        let nominal = nominal_of(model, &args.set)?;
        let (is, text) = match changed(args, model, &nominal, diagnosis) {
            Ok(changes) => ("with what was found", changes.text),
            Err(ApplyError::Nothing) => ("as it was", read(model)?),
            Err(error) => return Err(refused(&error)),
        };
        let path = args.out.join(model.file_name().unwrap_or(model.as_os_str()));
        if texts.iter().any(|(other, ..)| *other == path) {
            let message = format!("two models are called {}", path.display());
            return Err(Failure::argument(message, "apply them one by one"));
        }
        if args.diff {
            voice.raw(toolroom_apply::changed_lines(&read(model)?, &text).trim_end())?;
        }
        texts.push((path, is, text));
    }
    if args.diff {
        return Ok(());
    }
    std::fs::create_dir_all(&args.out).map_err(|source| Failure::Unwritable { path: args.out.clone(), source })?;
    for (path, _, text) in &texts {
        put(files, path, text)?;
    }
    if voice.json {
        let written: Vec<Value> =
            texts.iter().map(|(path, what, _)| json!({ "path": path.display().to_string(), "is": what })).collect();
        return voice.json(&json!({ "schema": 1, "models": written }));
    }
    texts.iter().try_for_each(|(path, what, _)| voice.data(format_args!("wrote {} {what}", path.display())))
}

/// Writes a model; one in its place is replaced if `gap apply` wrote it and nobody changed it since.
fn put(files: &Files, path: &Path, text: &str) -> Result<(), Failure> {
    Ok(files.put_marked(path, text, is_marked)?)
}

fn wrote(path: &Path, changes: &Changes, next: &str, voice: &Voice) -> Result<(), Failure> {
    let effects = if changes.effects.is_empty() { "no further effect".to_owned() } else { changes.effects.join(", ") };
    let constants = changes.constants.len();
    voice.data(format_args!("wrote {} with {effects} and {constants} calibrated constants", path.display()))?;
    voice.say(format_args!("next: {next} {} ; compare with what it was before", path.display()));
    Ok(())
}
