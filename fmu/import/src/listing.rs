//! What a unit offers, for people and programs.

use crate::archive::{Archive, Entry};
use crate::description::{ModelDescription, Variable};
use serde_json::{Map, Value, json};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

impl Archive {
    /// Folders of `binaries`, each for a platform.
    pub fn binary_folders(&self) -> BTreeSet<String> {
        let names = self.entries().iter().map(Entry::slashed);
        names
            .filter_map(|name| name.strip_prefix("binaries/")?.split_once('/').map(|(folder, _)| folder.to_owned()))
            .collect()
    }
}

impl ModelDescription {
    /// What a unit offers, for a terminal: interfaces, platforms with a library, and variables by causality.
    pub fn listing(&self, folders: &BTreeSet<String>) -> String {
        let mut text = format!("{}, FMI {}\n", self.model_name, self.fmi_version);
        for name in ["description", "generationTool", "generationDateAndTime", "author", "version", "license"] {
            if let Some(value) = self.about.get(name) {
                let _ = writeln!(text, "  {name:22} {value}");
            }
        }
        for (name, interface) in self.interfaces() {
            let mut can: Vec<&str> =
                interface.attributes.keys().map(String::as_str).filter(|flag| interface.can(flag)).collect();
            if can.is_empty() {
                can.push("no optional capability");
            }
            let _ = writeln!(text, "  {name:22} {}", can.join(", "));
        }
        let platforms = folders.iter().map(String::as_str).collect::<Vec<_>>().join(", ");
        let _ = writeln!(text, "  {:22} {}", "platforms", if platforms.is_empty() { "none" } else { &platforms });
        let states = self.structure.derivatives.len();
        let _ = writeln!(text, "  {:22} {states}, event indicators {}", "states", self.structure.event_indicators);
        let width = self.variables.iter().map(|variable| variable.name.chars().count()).max().unwrap_or(0);
        for causality in
            ["input", "output", "parameter", "structuralParameter", "calculatedParameter", "local", "independent"]
        {
            let found: Vec<&Variable> =
                self.variables.iter().filter(|variable| variable.causality == causality).collect();
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

    /// The same for programs; `path` is the file of the unit.
    pub fn json(&self, path: &Path, folders: &BTreeSet<String>) -> Value {
        let interfaces: Map<String, Value> = self
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
        let experiment = &self.experiment;
        json!({
            "schema": 1,
            "file": path.display().to_string(),
            "fmi_version": self.fmi_version,
            "model_name": self.model_name,
            "token": self.token,
            "about": self.about,
            "interfaces": interfaces,
            "platforms": folders,
            "experiment": {
                "start [s]": experiment.start,
                "stop [s]": experiment.stop,
                "step [s]": experiment.step,
                "tolerance": experiment.tolerance,
            },
            "states": self.structure.derivatives.len(),
            "event_indicators": self.structure.event_indicators,
            "variables": self.variables.iter().map(variable).collect::<Vec<_>>(),
        })
    }
}
