//! `toolroom gap apply`: the nominal model with the named effects switched on, and what that does
//! to the key figures of the shop.

mod figures;

mod program;

use super::nominal_of;
use crate::args::ApplyArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_analysis::gap::NominalProcess;
use toolroom_effects::Effect;
use toolroom_sim::scenario::Deviation;

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
        let text = program::applied(&text, &model, &named)?;
        put(args, &text)?;
        return wrote(args, "toolroom gap diagnose --model", voice);
    }
    let (mut of_process, mut of_shop) = (Vec::new(), String::new());
    for effect in &named {
        let (Some(id), Some(size)) = (effect["id"].as_str(), effect["size"].as_f64()) else {
            return Err(Failure::argument("an effect of the diagnosis has no id or size", "diagnose again"));
        };
        let unit = effect["unit"].as_str().unwrap_or("1");
        if Effect::named(id).is_ok() {
            let size = if unit == "1" { format!("{size}") } else { format!("\"{size} {unit}\"") };
            of_process.push(format!("{{ id = \"{id}\", size = {size} }}"));
        } else if Deviation::IDS.contains(&id) {
            let size = if unit == "1" { format!("{size}") } else { format!("{size} {unit}") };
            let shift = effect["shape"].as_str().and_then(|shape| shape.strip_prefix("shift="));
            let shift = shift.map_or_else(String::new, |shift| format!("shift = \"{shift}\"\n"));
            let by = args.diagnosis.display();
            let _ = writeln!(of_shop, "\n[[deviation]] # by {by}\nid = \"{id}\"\nsize = \"{size}\"\n{shift}");
        } else {
            voice.say(format_args!("{id} is no effect that a simulated shop can have; it is left out"));
        }
    }
    if of_process.is_empty() && of_shop.is_empty() {
        return Err(Failure::argument("none of the named effects can be simulated", "nothing was written"));
    }
    let mut out = switched_on(&text, &of_process, &args.diagnosis.display().to_string())?;
    out.push_str(of_shop.trim_end());
    out.push('\n');
    put(args, &out)?;
    let figures = args.data.as_ref().map(|data| figures::figures(&args.model, &args.out, data, voice)).transpose()?;
    if voice.json {
        let figures = figures.iter().flatten().map(figures::Figure::json).collect::<Vec<_>>();
        return voice.json(&json!({ "schema": 1, "model": args.out.display().to_string(), "kpi": figures }));
    }
    if let Some(figures) = &figures {
        voice.data(figures::table(figures).trim_end())?;
    }
    wrote(args, "toolroom run", voice)
}

fn put(args: &ApplyArgs, text: &str) -> Result<(), Failure> {
    std::fs::write(&args.out, text).map_err(|source| Failure::Unwritable { path: args.out.clone(), source })
}

fn wrote(args: &ApplyArgs, next: &str, voice: &Voice) -> Result<(), Failure> {
    voice.data(format_args!("wrote {}", args.out.display()))?;
    voice.say(format_args!("next: {next} {} ; compare with what it was before", args.out.display()));
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
