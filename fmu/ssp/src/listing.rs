//! What a system is made of, for people and programs.

use crate::package::Package;
use crate::structure::{Connection, End, SystemStructure};
use serde_json::{Value, json};
use std::fmt::Write;

impl SystemStructure {
    /// `component.connector` of an end.
    pub(crate) fn named(&self, end: &End) -> String {
        format!("{}.{}", self.components[end.component].name, end.connector)
    }

    /// What a connection does to its signal beside the conversion of units, empty where it does nothing.
    fn change(connection: &Connection) -> String {
        if connection.factor == 1.0 && connection.offset == 0.0 {
            String::new()
        } else {
            format!("  × {} + {}", connection.factor, connection.offset)
        }
    }
}

impl Package {
    /// What the package holds, for a terminal: units, signals between them, start values.
    pub fn listing(&self) -> String {
        let structure = self.structure();
        let mut text = format!("{}, SSP {}\n", structure.name, structure.version);
        if let (start, Some(stop)) = (structure.start.unwrap_or(0.0), structure.stop) {
            let _ = writeln!(text, "  default experiment  {start} s to {stop} s");
        }
        let width = structure.components.iter().map(|each| each.name.chars().count()).max().unwrap_or(0);
        let _ = writeln!(text, "\nunits");
        for component in &structure.components {
            let _ = writeln!(text, "  {:width$}  {}", component.name, component.source);
        }
        let _ = writeln!(text, "\nsignals");
        for connection in &structure.connections {
            let change = SystemStructure::change(connection);
            let _ = writeln!(
                text,
                "  {} -> {}{change}",
                structure.named(&connection.from),
                structure.named(&connection.to)
            );
        }
        for boundary in &structure.boundary {
            let ends = boundary.ends.iter().map(|end| structure.named(end)).collect::<Vec<_>>().join(", ");
            let arrow = if boundary.kind == "output" { "<-" } else { "->" };
            let _ = writeln!(text, "  {} of the system {arrow} {ends}", boundary.name);
        }
        let _ = writeln!(text, "\nstart values");
        for component in &structure.components {
            for parameter in &component.parameters {
                let _ = writeln!(text, "  {}.{} = {}", component.name, parameter.name, parameter.value);
            }
        }
        text.truncate(text.trim_end().len());
        text
    }

    /// The same for programs.
    pub fn json(&self) -> Value {
        let structure = self.structure();
        let components = structure.components.iter().map(|component| {
            let values = component.parameters.iter().map(|each| (each.name.clone(), json!(each.value)));
            json!({
                "name": component.name,
                "source": component.source,
                "start_values": values.collect::<serde_json::Map<_, _>>(),
            })
        });
        let connections = structure.connections.iter().map(|each| {
            json!({
                "from": structure.named(&each.from),
                "to": structure.named(&each.to),
                "factor": each.factor,
                "offset": each.offset,
                "converts_units": each.converts,
            })
        });
        let boundary = structure.boundary.iter().map(|each| {
            let ends: Vec<String> = each.ends.iter().map(|end| structure.named(end)).collect();
            json!({ "name": each.name, "kind": each.kind, "ends": ends })
        });
        json!({
            "schema": 1,
            "file": self.path().display().to_string(),
            "name": structure.name,
            "ssp_version": structure.version,
            "start [s]": structure.start,
            "stop [s]": structure.stop,
            "components": components.collect::<Vec<_>>(),
            "connections": connections.collect::<Vec<_>>(),
            "boundary": boundary.collect::<Vec<_>>(),
        })
    }
}
