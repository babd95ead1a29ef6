//! `toolroom gap diagnose`.

use super::{nominal, recorded};
use crate::args::DiagnoseArgs;
use crate::failure::Failure;
use crate::output::OutputDir;
use crate::speak::Voice;
use serde_json::json;
use toolroom_analysis::gap::plan::plan;
use toolroom_analysis::gap::{Diagnosis, NextExperiment, diagnose_parts};
use toolroom_analysis::page::Provenance;
use toolroom_analysis::records::RecordKind;
use toolroom_analysis::results::fingerprint;

pub fn run(args: &DiagnoseArgs, voice: &Voice) -> Result<(), Failure> {
    let model = nominal(&args.data)?;
    let mut records = recorded(&args.data.data, &model, voice)?;
    let group = args.data.group.as_deref();
    let mut outside: Vec<String> = Vec::new();
    if let Some(path) = &args.holdout_data {
        let mut more = recorded(path, &model, voice)?;
        let column = group.unwrap_or(if model.kind() == RecordKind::Program { "section" } else { "tool_id" });
        if model.kind() == RecordKind::Program {
            // The same sections of the same programs ran on other pieces.
            let names = more.texts(column).map(|names| names.iter().map(|name| format!("{name}, held out")).collect());
            names.into_iter().for_each(|names| more.set_texts(column, names));
        }
        outside = more.levels(column).map(|(names, _)| names).unwrap_or_default();
        let inside = records.levels(column).map(|(names, _)| names).unwrap_or_default();
        if let Some(both) = outside.iter().find(|name| inside.contains(name)) {
            let message = format!("{column} {both} stands in both sets; a group is either fitted or held out");
            return Err(Failure::argument(message, "give the groups of the second set other names"));
        }
        records = records.followed_by(&more);
    }
    let share = args.holdout.unwrap_or(0.0);
    // Every so many groups is held out, evenly through the data.
    let every = if share > 0.0 { (1.0 / share).round().max(2.0) as usize } else { usize::MAX };
    let (parts, notes) = model.parts(&records, group, |index, name| {
        outside.iter().any(|own| own == name) || (every < usize::MAX && index % every == every - 1)
    });
    if parts.iter().all(|part| part.frame().measured.is_empty()) {
        return Err(super::nothing_measured(&notes));
    }
    let mut diagnosis = diagnose_parts(&parts, args.seed);
    if let Some(best) = plan(&model, &records, group, &diagnosis).best() {
        let separates = best.separates();
        diagnosis.next = NextExperiment { design: best.design.clone(), minutes: best.minutes, separates };
    }
    diagnosis.notes.extend(notes);
    write(args, &diagnosis, voice)
}

fn write(args: &DiagnoseArgs, diagnosis: &Diagnosis, voice: &Voice) -> Result<(), Failure> {
    if let Some(target) = &args.out {
        let out = OutputDir::create(target)?;
        let put = |name: &str, text: &str| {
            let path = out.draft().join(name);
            std::fs::write(&path, text).map_err(|source| Failure::Unwritable { path, source })
        };
        let pretty = |value: &serde_json::Value| serde_json::to_string_pretty(value).map_err(Failure::Json);
        let (model, data) = (args.data.model.display().to_string(), args.data.data.display().to_string());
        let command = format!("toolroom gap diagnose --model {model} --data {data}");
        let hash = |name: &String| {
            (name.clone(), std::fs::read(name).map_or_else(|_| String::new(), |bytes| fingerprint(&bytes)))
        };
        let inputs = vec![hash(&model), hash(&data)];
        let version = env!("CARGO_PKG_VERSION");
        let provenance =
            Provenance { version: version.to_owned(), command: command.clone(), seed: Some(args.seed), inputs };
        put("diagnosis.json", &pretty(&diagnosis.json())?)?;
        put("report.html", &diagnosis.report(provenance).html())?;
        put("run.json", &pretty(&json!({ "schema": 1, "version": version, "command": command, "complete": true }))?)?;
        let target = out.publish()?;
        voice.say(format_args!("wrote {}", target.join("report.html").display()));
    }
    if voice.json { voice.json(&diagnosis.json()) } else { voice.data(diagnosis.terminal()) }
}
