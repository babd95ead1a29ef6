//! `toolroom check FILE`.

use crate::args::CheckArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::fmt::Write;
use toolroom_scenario::file::{Echo, ScenarioFile, read};

pub fn run(args: &CheckArgs, voice: &Voice) -> Result<(), Failure> {
    let file = read(&args.scenario.file, &args.scenario.changes.overrides())?;
    if voice.json {
        let scenario = &file.scenario;
        let result = json!({
            "schema": 1,
            "file": args.scenario.file.display().to_string(),
            "valid": true,
            "name": scenario.name,
            "policies": scenario.policies.iter().map(|policy| &policy.name).collect::<Vec<_>>(),
            "values": file.echo,
        });
        return voice.json(&result);
    }
    voice.data(echo(&file.echo))?;
    voice.say(summary(&file));
    Ok(())
}

/// Every value under its section; defaults are marked, because they are easily forgotten.
fn echo(values: &[Echo]) -> String {
    let mut text = String::new();
    let width = values.iter().map(|value| value.key.chars().count()).max().unwrap_or(0);
    let mut section = None;
    for value in values {
        if section != Some(&value.section) {
            let title = if value.section.is_empty() { "scenario" } else { &value.section };
            let gap = if section.is_some() { "\n" } else { "" };
            let _ = writeln!(text, "{gap}{title}");
        }
        section = Some(&value.section);
        let mark = if value.default { "   (default)" } else { "" };
        let _ = writeln!(text, "  {:width$}  {}{mark}", value.key, value.value);
    }
    text.truncate(text.trim_end().len());
    text
}

fn summary(file: &ScenarioFile) -> String {
    let scenario = &file.scenario;
    let operations: usize = scenario.parts.iter().map(|part| part.operations.len()).sum();
    format!(
        "valid: {} machines, {} tools, {} parts with {operations} operations, {} policies, {} replications of {} h",
        scenario.machines.len(),
        scenario.tools.len(),
        scenario.parts.len(),
        scenario.policies.len(),
        scenario.replications,
        scenario.horizon / 3600.0,
    )
}
