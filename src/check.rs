//! `toolroom check FILE`.

use crate::args::CheckArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::section;
use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_form::Echo;
use toolroom_kinds::FileKind;

pub fn run(args: &CheckArgs, voice: &Voice) -> Result<(), Failure> {
    let path = &args.file;
    let kind = args.kind.map_or_else(|| FileKind::of(path), Ok)?;
    let Some(read) = kind.read else {
        return Err(Failure::argument(
            format_args!("files of the kind {} are written by toolroom, not read", kind.word),
            "leave --kind out",
        ));
    };
    let changes = &args.changes;
    if kind.word != "scenario" && (changes.seed.is_some() || changes.replications.is_some()) {
        let message =
            format!("--seed and --replications are for scenarios; {} is a {} file", path.display(), kind.word);
        return Err(Failure::argument(message, "change values of this file with --set"));
    }
    let checked = read(path, &changes.overrides())?;
    if kind.word == "scenario" {
        // Its figures are known where they are computed.
        let file = toolroom_scenario_file::read(path, &changes.overrides())?;
        section(&file)?;
    }
    if voice.json {
        let mut result = json!({ "schema": 1, "file": path.display().to_string(), "valid": true });
        if let Value::Object(result) = &mut result {
            result.extend(checked.result);
        }
        return voice.json(&result);
    }
    if !checked.echo.is_empty() {
        voice.data(echo(&checked.echo, kind.word))?;
    }
    voice.say(checked.summary);
    Ok(())
}

/// Every value under its section, those of none under the kind of the file; defaults are marked, because they are easily forgotten.
fn echo(values: &[Echo], kind: &str) -> String {
    let mut text = String::new();
    let width = values.iter().map(|value| value.key.chars().count()).max().unwrap_or(0);
    let mut section = None;
    for value in values {
        if section != Some(&value.section) {
            let title = if value.section.is_empty() { kind } else { &value.section };
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
