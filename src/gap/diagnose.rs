//! `toolroom gap diagnose`.

use super::{files_of, reading};
use crate::args::DiagnoseArgs;
use crate::effects::defined;
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::path::PathBuf;
use toolroom_chart::page::Provenance;
use toolroom_gap_study::{GapRequest, GapStudy, NAMES};
use toolroom_output::{Files, OutputDir};
use toolroom_shards::fingerprint;

pub fn run(args: &DiagnoseArgs, voice: &Voice) -> Result<(), Failure> {
    let data: Vec<PathBuf> =
        [&args.data].into_iter().chain(&args.holdout_data).flat_map(|data| files_of(data)).collect();
    let inputs = || args.models.iter().chain(&data).chain(&args.effects).map(AsRef::as_ref);
    let out = args.out.as_deref().map(|target| OutputDir::create(target, NAMES, inputs(), voice.force)).transpose()?;
    let files = Files::new(inputs(), voice.force);
    if let Some(path) = &args.propose {
        files.check(path)?;
    }
    let file = args.propose.as_ref().map(|path| path.display().to_string());
    let defined = defined(&args.effects)?;
    let request = GapRequest {
        models: &args.models,
        set: &args.set,
        defined: &defined,
        data: &args.data,
        group: args.group.as_deref(),
        holdout: args.holdout.unwrap_or(0.0),
        holdout_data: args.holdout_data.as_deref(),
        seed: args.seed,
        propose: file.as_deref(),
        pages: out.is_some(),
    };
    let study = reading(voice, |reading| GapStudy::new(&request, reading))?;
    if let Some(out) = out {
        write(args, out, &study, voice)?;
    }
    if let (Some(path), Some(text)) = (&args.propose, &study.proposed) {
        files.put(path, text.as_bytes())?;
        voice.say(format_args!("wrote {}: empirical, not a cause", path.display()));
    }
    if voice.json {
        voice.json(&study.document)?
    } else {
        voice.data(study.answers.terminal())?
    }
    let untold = study.untold();
    if untold.is_empty() { Ok(()) } else { Err(Failure::TooLittle { message: untold.join("; ") }) }
}

fn write(args: &DiagnoseArgs, output_dir: OutputDir, study: &GapStudy, voice: &Voice) -> Result<(), Failure> {
    let models: Vec<String> = args.models.iter().map(|model| model.display().to_string()).collect();
    let data = args.data.display().to_string();
    let effects: String = args.effects.iter().map(|path| format!(" --effects {}", path.display())).collect();
    let propose = args.propose.iter().map(|path| format!(" --propose {}", path.display())).collect::<String>();
    let command = format!("toolroom gap diagnose --model {} --data {data}{effects}{propose}", models.join(" --model "));
    let hash =
        |name: &String| (name.clone(), std::fs::read(name).map_or_else(|_| String::new(), |bytes| fingerprint(&bytes)));
    let inputs = models.iter().chain([&data]).map(hash).collect();
    let version = env!("CARGO_PKG_VERSION");
    let provenance =
        Provenance { version: version.to_owned(), command: command.clone(), seed: Some(args.seed), inputs };
    output_dir.put_all(&study.files(provenance))?;
    let run = json!({ "schema": 1, "version": version, "command": command, "complete": true });
    output_dir.put("run.json", &format!("{run:#}"))?;
    let target = output_dir.publish()?;
    voice.say(format_args!("wrote {}", target.join("report.html").display()));
    Ok(())
}
