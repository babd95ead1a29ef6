//! `toolroom gap apply`: the nominal model with the named effects switched on, and what that does
//! to the key figures of the shop.

mod figures;
mod mark;
mod program;

use super::nominal_of;
use crate::args::ApplyArgs;
use crate::failure::Failure;
use crate::output::Files;
use crate::speak::Voice;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use toolroom_effects::Effect;
use toolroom_gap::{NominalModel, NominalProcess};
use toolroom_scenario::Deviation;

pub fn run(args: &ApplyArgs, voice: &Voice) -> Result<(), Failure> {
    let diagnosis: Value = serde_json::from_str(&read(&args.diagnosis)?).map_err(|error| {
        Failure::argument(format!("{}: {error}", args.diagnosis.display()), "give a diagnosis.json")
    })?;
    if diagnosis["effects"].as_array().is_none_or(Vec::is_empty) {
        return Err(Failure::argument("the diagnosis names no effect", "there is nothing to switch on"));
    }
    let inputs = args.models.iter().chain([&args.diagnosis]).chain(&args.data).map(AsRef::as_ref);
    let files = Files::new(inputs, voice.force);
    match &args.models[..] {
        [model] => one(args, model, &files, &diagnosis, voice),
        models => several(args, models, &files, &diagnosis, voice),
    }
}

fn read(path: &Path) -> Result<String, Failure> {
    std::fs::read_to_string(path)
        .map_err(|error| Failure::argument(format!("{}: {error}", path.display()), "check the path"))
}

/// Effects of a diagnosis that belong to a process; those of a diagnosis of one process all do.
fn named(diagnosis: &Value, process: &str) -> Vec<Value> {
    let own = |effect: &&Value| effect["process"].as_str().is_none_or(|own| own == process);
    diagnosis["effects"].as_array().into_iter().flatten().filter(own).cloned().collect()
}

/// One model into one file.
fn one(args: &ApplyArgs, model: &Path, files: &Files, diagnosis: &Value, voice: &Voice) -> Result<(), Failure> {
    let out = &args.out;
    let nominal = nominal_of(model, &[])?;
    let process = nominal.kind().name();
    let named = named(diagnosis, process);
    if named.is_empty() {
        let message = format!("the diagnosis names no effect of {process}");
        return Err(Failure::argument(message, "give the model of the process that has one"));
    }
    let held = args.data.as_ref().map(|data| figures::held(data, &nominal, voice)).transpose()?.flatten();
    put(files, out, &applied(model, &nominal, &named, held, &args.diagnosis, voice)?)?;
    if let NominalProcess::Program(_) = nominal.process {
        return wrote(out, "toolroom gap diagnose --model", voice);
    }
    let figures = args.data.as_ref().map(|data| figures::figures(model, out, data, voice)).transpose()?;
    if voice.json {
        let figures = figures.iter().flatten().map(figures::Figure::json).collect::<Vec<_>>();
        return voice.json(&json!({ "schema": 1, "model": out.display().to_string(), "kpi": figures }));
    }
    if let Some(figures) = &figures {
        voice.data(figures::table(figures).trim_end())?;
    }
    wrote(out, "toolroom run", voice)
}

/// Every model of a diagnosis of several processes into a directory, each under its own name; those
/// of processes without a named effect stay as they are.
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
        let nominal = nominal_of(model, &[])?;
        let named = named(diagnosis, nominal.kind().name());
        let text = if named.is_empty() {
            read(model)?
        } else {
            applied(model, &nominal, &named, None, &args.diagnosis, voice)?
        };
        let path = args.out.join(model.file_name().unwrap_or(model.as_os_str()));
        if texts.iter().any(|(other, ..)| *other == path) {
            let message = format!("two models are called {}", path.display());
            return Err(Failure::argument(message, "apply them one by one"));
        }
        texts.push((path, if named.is_empty() { "as it was" } else { "with its effects" }, text));
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

/// The text of a model with effects switched on; `held` is the share of operations with holds.
fn applied(
    path: &Path,
    model: &NominalModel,
    named: &[Value],
    held: Option<f64>,
    diagnosis: &Path,
    voice: &Voice,
) -> Result<String, Failure> {
    let (text, _) = mark::parted(&read(path)?);
    if let NominalProcess::Program(model) = &model.process {
        return program::applied(&text, model, named);
    }
    let by = diagnosis.display();
    let (mut of_process, mut of_shop) = (Vec::new(), String::new());
    for effect in named {
        let (Some(id), Some(size)) = (effect["id"].as_str(), effect["size"].as_f64()) else {
            return Err(Failure::argument("an effect of the diagnosis has no id or size", "diagnose again"));
        };
        let unit = effect["unit"].as_str().unwrap_or("1");
        if Effect::named(id).is_ok() {
            let size = if unit == "1" { format!("{size}") } else { format!("\"{size} {unit}\"") };
            of_process.push(format!("{{ id = \"{id}\", size = {size} }}"));
        } else if Deviation::IDS.contains(&id) {
            let size = if unit == "1" { format!("{size}") } else { format!("{size} {unit}") };
            let shape = effect["shape"].as_str().unwrap_or_default();
            let shift = shape.strip_prefix("shift=").map_or_else(String::new, |shift| format!("shift = \"{shift}\"\n"));
            let share = match (id, held) {
                ("feed_hold", None) => {
                    let message = "only the log knows which share of the operations is held";
                    return Err(Failure::argument(
                        message,
                        "add --data with the events, and the model of the shop alone",
                    ));
                }
                ("feed_hold", Some(share)) => format!("share = {share:.4}\n"),
                _ => String::new(),
            };
            let _ = writeln!(of_shop, "\n[[deviation]] # by {by}\nid = \"{id}\"\nsize = \"{size}\"\n{shift}{share}");
        } else {
            voice.say(format_args!("{id} is no effect that a simulated shop can have; it is left out"));
        }
    }
    if of_process.is_empty() && of_shop.is_empty() {
        return Err(Failure::argument("none of the named effects can be simulated", "nothing was written"));
    }
    let mut out = switched_on(&text, &of_process, &by.to_string())?;
    out.push_str(of_shop.trim_end());
    out.push('\n');
    Ok(out)
}

/// Writes a model; one in its place is replaced if `gap apply` wrote it and nobody changed it since.
fn put(files: &Files, path: &Path, text: &str) -> Result<(), Failure> {
    files.put_marked(path, &mark::marked(text), mark::is_marked)
}

fn wrote(path: &Path, next: &str, voice: &Voice) -> Result<(), Failure> {
    voice.data(format_args!("wrote {}", path.display()))?;
    voice.say(format_args!("next: {next} {} ; compare with what it was before", path.display()));
    Ok(())
}

/// The model with effects of its first tool.
fn switched_on(text: &str, effects: &[String], by: &str) -> Result<String, Failure> {
    let mut out = String::new();
    let mut placed = effects.is_empty();
    for line in text.lines() {
        let _ = writeln!(out, "{line}");
        if placed {
            continue;
        }
        if line.trim_start().starts_with("effects") {
            let fix = "add the new ones to its list by hand";
            return Err(Failure::argument("the model switches effects on already", fix));
        }
        if line.trim_start().starts_with("parameter_set") {
            let _ = writeln!(out, "effects = [{}] # by {by}", effects.join(", "));
            placed = true;
        }
    }
    if placed {
        Ok(out)
    } else {
        Err(Failure::argument("the model has no tool with a parameter set", "effects act on a physical model"))
    }
}
