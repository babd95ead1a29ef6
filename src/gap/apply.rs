//! `toolroom gap apply`: the nominal model with the named effects switched on.

mod program;

use super::nominal_of;
use crate::args::ApplyArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::Value;
use std::fmt::Write;
use toolroom_analysis::gap::NominalProcess;
use toolroom_effects::Effect;

pub fn run(args: &ApplyArgs, voice: &Voice) -> Result<(), Failure> {
    let read = |path: &std::path::Path| {
        std::fs::read_to_string(path)
            .map_err(|error| Failure::argument(format!("{}: {error}", path.display()), "check the path"))
    };
    let text = read(&args.model)?;
    let diagnosis: Value = serde_json::from_str(&read(&args.diagnosis)?).map_err(|error| {
        Failure::argument(format!("{}: {error}", args.diagnosis.display()), "give a diagnosis.json")
    })?;
    let named = diagnosis["effects"].as_array().cloned().unwrap_or_default();
    if named.is_empty() {
        return Err(Failure::argument("the diagnosis names no effect", "there is nothing to switch on"));
    }
    if let NominalProcess::Program(model) = nominal_of(&args.model, &[])?.process {
        return write(args, &program::applied(&text, &model, &named)?, "toolroom gap diagnose --model", voice);
    }
    let mut entries: Vec<String> = Vec::new();
    for effect in &named {
        let (Some(id), Some(size)) = (effect["id"].as_str(), effect["size"].as_f64()) else {
            return Err(Failure::argument("an effect of the diagnosis has no id or size", "diagnose again"));
        };
        if Effect::named(id).is_err() {
            voice.say(format_args!("{id} is an effect of the shop: set it in the times of the scenario by hand"));
            continue;
        }
        let unit = effect["unit"].as_str().unwrap_or("1");
        let size = if unit == "1" { format!("{size}") } else { format!("\"{size} {unit}\"") };
        entries.push(format!("{{ id = \"{id}\", size = {size} }}"));
    }
    if entries.is_empty() {
        return Err(Failure::argument("none of the named effects acts on a process", "nothing was written"));
    }
    let mut out = String::new();
    let mut placed = false;
    for line in text.lines() {
        if line.trim_start().starts_with("effects") {
            return Err(Failure::argument(
                "the model switches effects on already",
                "add the new ones to its list by hand",
            ));
        }
        let _ = writeln!(out, "{line}");
        if line.trim_start().starts_with("parameter_set") && !placed {
            let _ = writeln!(out, "effects = [{}] # by {}", entries.join(", "), args.diagnosis.display());
            placed = true;
        }
    }
    if !placed {
        return Err(Failure::argument("the model has no tool with a parameter set", "effects act on a physical model"));
    }
    write(args, &out, "toolroom run", voice)
}

fn write(args: &ApplyArgs, text: &str, next: &str, voice: &Voice) -> Result<(), Failure> {
    std::fs::write(&args.out, text).map_err(|source| Failure::Unwritable { path: args.out.clone(), source })?;
    voice.data(format_args!("wrote {}", args.out.display()))?;
    voice.say(format_args!("next: {next} {} ; compare with what it was before", args.out.display()));
    Ok(())
}
