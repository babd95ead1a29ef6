//! `toolroom gap loop`: diagnose, apply, diagnose again, until nothing new is named.

use super::{apply, diagnose, nominal_of, reading};
use crate::args::{ApplyArgs, DiagnoseArgs, LoopArgs};
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::{Value, json};
use std::path::Path;
use toolroom_gap::{GapVerdict, NominalProcess};
use toolroom_gap_study::{Figure, figures, table};
use toolroom_records::RecordKind;

pub fn run(args: &LoopArgs, voice: &Voice) -> Result<(), Failure> {
    let mut model = args.model.clone();
    let mut named_before: Vec<String> = Vec::new();
    for round in 1..=args.rounds {
        let folder = args.out.join(format!("round-{round}"));
        voice.say(format_args!("round {round}: {}", model.display()));
        let diagnosing = DiagnoseArgs {
            models: vec![model.clone()],
            data: args.data.clone(),
            group: None,
            set: Vec::new(),
            effects: args.effects.clone(),
            propose: None,
            holdout: None,
            holdout_data: None,
            seed: args.seed,
            out: Some(folder.clone()),
        };
        diagnose::run(&diagnosing, voice)?;
        let path = folder.join("diagnosis.json");
        let text = std::fs::read_to_string(&path).map_err(Failure::unread(&path))?;
        let diagnosis: Value = serde_json::from_str(&text).map_err(Failure::Json)?;
        let words = |effect: &Value| format!("{} {} {}", effect["id"], effect["shape"], effect["scope"]);
        let named: Vec<String> = diagnosis["effects"].as_array().into_iter().flatten().map(words).collect();
        let new = named.iter().any(|effect| !named_before.contains(effect));
        if round > 1 && !new {
            let verdict = GapVerdict::ALL.into_iter().find(|own| diagnosis["verdict"] == own.name());
            let left = match verdict {
                Some(GapVerdict::Unknown) => "; what is left of the gap has no cause that was found",
                Some(GapVerdict::Masked) => "; calibration takes up what may be left of the gap",
                Some(
                    GapVerdict::Effect
                    | GapVerdict::Constant
                    | GapVerdict::Small
                    | GapVerdict::NoGap
                    | GapVerdict::CannotTell,
                )
                | None => "",
            };
            voice.data(format_args!(
                "round {round} names nothing new: {} holds what was found{left}",
                model.display()
            ))?;
            return compared(args, &model, voice);
        }
        named_before.extend(named);
        let nothing = |key: &str| diagnosis["applied"][key].as_array().is_none_or(Vec::is_empty);
        if nothing("effects") && nothing("calibration") {
            return voice.data(format_args!("round {round} finds nothing to apply to {}", model.display()));
        }
        let better = folder.join("model.toml");
        let applying = ApplyArgs {
            models: vec![model.clone()],
            diagnosis: path,
            data: None,
            only: Vec::new(),
            no_calibration: false,
            accept_empirical: false,
            diff: false,
            set: Vec::new(),
            out: better.clone(),
        };
        apply::run(&applying, voice)?;
        model = better;
    }
    voice.data(format_args!("{} rounds: {} holds what was found", args.rounds, model.display()))?;
    compared(args, &model, voice)
}

/// Key figures of the recorded shop, of the first model and of the last one, where events of its machines are recorded.
fn compared(args: &LoopArgs, model: &Path, voice: &Voice) -> Result<(), Failure> {
    let process = nominal_of(&args.model, &[])?.process;
    let is_shop = matches!(process, NominalProcess::Shop(_));
    let has_none = matches!(process, NominalProcess::Empirical | NominalProcess::Program(_));
    if has_none || !is_shop && !toolroom_records::tables(&args.data).contains(&RecordKind::Shop) {
        return Ok(());
    }
    let figures = reading(voice, |reading| figures(&args.model, model, &args.data, reading))?;
    for warning in figures.iter().filter_map(Figure::warning) {
        voice.say(format_args!("warning: {warning}"));
    }
    if voice.json {
        return voice.json(&json!({ "schema": 1, "kpi": figures.iter().map(Figure::json).collect::<Vec<_>>() }));
    }
    voice.data(table(&figures).trim_end())
}
