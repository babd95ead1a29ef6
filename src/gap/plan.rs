//! `toolroom gap plan`.

use super::{files_of, nominal, recorded};
use crate::args::PlanArgs;
use crate::failure::Failure;
use crate::speak::Voice;
use std::time::Instant;
use toolroom_gap::plan::plan;
use toolroom_gap::{ProcessData, diagnose_parts};
use toolroom_gap_study::usable;
use toolroom_output::{OutputDir, provenance};
use toolroom_records::write_csv;

pub fn run(args: &PlanArgs, voice: &Voice) -> Result<(), Failure> {
    let began = Instant::now();
    let data = files_of(&args.data.data);
    let inputs = data.iter().chain([&args.data.model]).map(AsRef::as_ref);
    let names = &["plan.json", "runs.csv"];
    let out = args.out.as_deref().map(|target| OutputDir::create(target, names, inputs, voice.force)).transpose()?;
    let model = nominal(&args.data)?;
    let records = recorded(&args.data.data, &model, voice)?;
    let group = args.data.group.as_deref();
    let asked = model.asked(&records, group, |_, _| false);
    usable(&asked, &records)?;
    let ProcessData { parts, notes, .. } = asked;
    notes.iter().for_each(|note| voice.say(note));
    if parts.iter().all(|part| part.frame().measured.is_empty()) {
        return Err(super::nothing_measured(&notes));
    }
    let diagnosis = diagnose_parts(&parts, args.seed);
    let plan = plan(&model, &records, group, &diagnosis);
    if let Some(out) = out {
        out.put_json("plan.json", &plan.json())?;
        if let Some(best) = plan.best() {
            let mut csv = Vec::new();
            write_csv(&best.runs, &mut csv).map_err(|error| Failure::work_error(&error))?;
            out.put("runs.csv", &String::from_utf8_lossy(&csv))?;
        }
        let name = args.data.model.display().to_string();
        let bytes = toolroom_form::bytes(&args.data.model).map_err(Failure::unread(&args.data.model))?;
        let data = args.data.data.display().to_string();
        let record = provenance("gap plan", &[(name, &bytes)], ["--data".to_owned(), data], Some(args.seed));
        out.record(&record, began.elapsed())?;
        voice.say(format_args!("wrote {}", out.publish()?.join("plan.json").display()));
    }
    if voice.json { voice.json(&plan.json()) } else { voice.data(plan.text()) }
}
