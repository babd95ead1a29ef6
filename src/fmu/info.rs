//! `toolroom fmu info F.fmu`.

use super::{open, refused};
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;
use toolroom_fmu_import::{ModelDescription, Variable};

pub fn run(path: &Path, voice: &Voice) -> Result<(), Failure> {
    let mut archive = open(path)?;
    let reading = ModelDescription::read(&archive.description().map_err(refused)?);
    let Some(description) = reading.description else {
        let fault = reading.faults.first();
        let message = fault.map_or(String::new(), |fault| format!(":{}: {}", fault.line, fault.message));
        let message = format!("{}: modelDescription.xml{message}", path.display());
        return Err(Failure::argument(message, "`toolroom fmu check` lists everything that is wrong"));
    };
    let names = archive.entries().iter().map(toolroom_fmu_import::Entry::slashed);
    let folders: BTreeSet<String> = names
        .filter_map(|name| name.strip_prefix("binaries/")?.split_once('/').map(|(folder, _)| folder.to_owned()))
        .collect();
    if voice.json {
        voice.json(&as_json(path, &description, &folders))
    } else {
        voice.data(table(&description, &folders))?;
        if !reading.faults.is_empty() {
            let count = reading.faults.len();
            voice.say(format_args!("{count} faults in the description; see toolroom fmu check {}", path.display()));
        }
        Ok(())
    }
}

fn as_json(path: &Path, description: &ModelDescription, folders: &BTreeSet<String>) -> serde_json::Value {
    let interfaces: serde_json::Map<String, serde_json::Value> = description
        .interfaces()
        .map(|(name, interface)| (name.to_lowercase().replace([' ', '-'], "_"), json!(interface.attributes)))
        .collect();
    let variable = |variable: &Variable| {
        json!({
            "name": variable.name,
            "value_reference": variable.reference,
            "type": variable.value_type.to_string(),
            "causality": variable.causality,
            "variability": variable.variability,
            "start": variable.start,
            "unit": variable.unit,
            "min": variable.min,
            "max": variable.max,
            "description": variable.description,
        })
    };
    let experiment = &description.experiment;
    json!({
        "schema": 1,
        "file": path.display().to_string(),
        "fmi_version": description.fmi_version,
        "model_name": description.model_name,
        "token": description.token,
        "about": description.about,
        "interfaces": interfaces,
        "platforms": folders,
        "experiment": {
            "start [s]": experiment.start,
            "stop [s]": experiment.stop,
            "step [s]": experiment.step,
            "tolerance": experiment.tolerance,
        },
        "states": description.structure.derivatives.len(),
        "event_indicators": description.structure.event_indicators,
        "variables": description.variables.iter().map(variable).collect::<Vec<_>>(),
    })
}

fn table(description: &ModelDescription, folders: &BTreeSet<String>) -> String {
    let mut text = format!("{}, FMI {}\n", description.model_name, description.fmi_version);
    for name in ["description", "generationTool", "generationDateAndTime", "author", "version", "license"] {
        if let Some(value) = description.about.get(name) {
            let _ = writeln!(text, "  {name:22} {value}");
        }
    }
    for (name, interface) in description.interfaces() {
        let mut can: Vec<&str> =
            interface.attributes.keys().map(String::as_str).filter(|flag| interface.can(flag)).collect();
        if can.is_empty() {
            can.push("no optional capability");
        }
        let _ = writeln!(text, "  {name:22} {}", can.join(", "));
    }
    let platforms = folders.iter().map(String::as_str).collect::<Vec<_>>().join(", ");
    let _ = writeln!(text, "  {:22} {}", "platforms", if platforms.is_empty() { "none" } else { &platforms });
    let states = description.structure.derivatives.len();
    let _ = writeln!(text, "  {:22} {states}, event indicators {}", "states", description.structure.event_indicators);
    let width = description.variables.iter().map(|variable| variable.name.chars().count()).max().unwrap_or(0);
    for causality in
        ["input", "output", "parameter", "structuralParameter", "calculatedParameter", "local", "independent"]
    {
        let found: Vec<&Variable> =
            description.variables.iter().filter(|variable| variable.causality == causality).collect();
        if found.is_empty() {
            continue;
        }
        let _ = writeln!(text, "\n{causality}");
        for variable in found {
            let unit = variable.unit.as_ref().map_or(String::new(), |unit| format!(" [{unit}]"));
            let start = variable.start.as_deref().unwrap_or("");
            let name = format!("{}{unit}", variable.name);
            let line = format!("  {name:width$}  {start:>12}  {}", variable.description, width = width + 10);
            let _ = writeln!(text, "{}", line.trim_end());
        }
    }
    text.truncate(text.trim_end().len());
    text
}
