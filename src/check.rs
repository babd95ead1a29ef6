//! `toolroom check FILE…`.

use crate::args::CheckArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use crate::study::section;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use toolroom_form::Echo;
use toolroom_kinds::{CheckResult, FileKind};

pub fn run(args: &CheckArgs, voice: &Voice) -> Result<(), Failure> {
    let [file] = &args.files[..] else { return each(args, voice) };
    let (kind, checked) = read(file, args)?;
    if voice.json {
        return voice.json(&accepted(file, checked));
    }
    if !checked.echo.is_empty() {
        voice.data(echo(&checked.echo, kind.word))?;
    }
    voice.say(checked.summary);
    Ok(())
}

/// Several files: a line for each, the faults of all.
fn each(args: &CheckArgs, voice: &Voice) -> Result<(), Failure> {
    if !args.changes.overrides().is_empty() {
        let message = format!("values are changed in one file, and there are {}", args.files.len());
        return Err(Failure::argument(message, "check the file with changed values by itself"));
    }
    let (mut results, mut refused) = (Vec::new(), 0);
    // What is refused is told at once to people, and to programs with the rest.
    let people = voice.for_people();
    for file in &args.files {
        if is_schema(file) {
            voice.say(format_args!("{}: a schema for editors, passed over", file.display()));
            continue;
        }
        match read(file, args) {
            Ok((_, checked)) => {
                voice.say(format_args!("{}: {}", file.display(), checked.summary));
                results.push(accepted(file, checked));
            }
            Err(failure) => {
                refused += 1;
                results.push(failure.refusal(file));
                failure.report(&people);
            }
        }
    }
    let looked_at = results.len();
    if voice.json {
        voice.json(&json!({ "schema": 1, "valid": refused == 0, "files": results }))?;
    }
    if refused == 0 {
        return Ok(());
    }
    Err(Failure::argument(
        format_args!("{refused} of {looked_at} files are refused"),
        "the faults are listed above, file by file",
    ))
}

/// Whether a file of a list is a schema as `new` and `schema` write it beside the files that a pattern is meant for.
fn is_schema(path: &Path) -> bool {
    let named = path.file_name().and_then(|name| name.to_str()).is_some_and(|name| name.ends_with(".schema.json"));
    named && std::fs::read_to_string(path).is_ok_and(|text| text.contains("\"$schema\": \"https://json-schema.org"))
}

/// The kind of a file, and what its reader says.
fn read(path: &Path, args: &CheckArgs) -> Result<(&'static FileKind, CheckResult), Failure> {
    let kind = args.kind.map_or_else(|| FileKind::from_path(path), Ok)?;
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
    // The base of tables has no values of its own that a shop could be made of.
    if kind.word == "scenario" && !checked.echo.is_empty() {
        // Its figures are known where they are computed.
        let file = toolroom_scenario_file::read(path, &changes.overrides())?;
        section(&file)?;
    }
    Ok((kind, checked))
}

/// What programs are told of a file that is accepted.
fn accepted(path: &Path, checked: CheckResult) -> Value {
    let mut result = json!({ "schema": 1, "file": path.display().to_string(), "valid": true });
    if let Value::Object(result) = &mut result {
        result.extend(checked.result);
    }
    result
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
