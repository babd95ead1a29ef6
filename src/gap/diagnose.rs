//! `toolroom gap diagnose`.

use super::known::{self, Known};
use super::tables::{Table, tables};
use crate::args::DiagnoseArgs;
use crate::failure::Failure;
use crate::output::OutputDir;
use crate::speak::Voice;
use serde_json::json;
use std::path::Path;
use toolroom_apply::{Applied, PredictionRow, Process, document, predictions_of};
use toolroom_chart::page::Provenance;
use toolroom_gap::joined;
use toolroom_gap::plan::plan;
use toolroom_gap::shop::{add_facts, visits};
use toolroom_gap::{Answers, Asked, GapVerdict, NextExperiment, NominalModel, NominalProcess, diagnosed_processes};
use toolroom_gap_report::{Page, Rates, Readings, html, markdown};
use toolroom_records::{ColumnKind, Records};
use toolroom_shards::fingerprint;

pub fn run(args: &DiagnoseArgs, voice: &Voice) -> Result<(), Failure> {
    let group = args.group.as_deref();
    let inputs = args.models.iter().chain([&args.data]).chain(&args.holdout_data).map(AsRef::as_ref);
    let names = &["diagnosis.json", "report.html", "report.md", "report.json", "predictions.csv"];
    let out = args.out.as_deref().map(|target| OutputDir::create(target, names, inputs, voice.force)).transpose()?;
    let mut asked: Vec<Asked> = Vec::new();
    let mut rest: Vec<Option<(NominalModel, Records)>> = Vec::new();
    let mut stated: Vec<Known> = Vec::new();
    for (Table { model, records }, path) in
        tables(&args.models, &args.set, &args.data, voice)?.into_iter().zip(&args.models)
    {
        let mut records = match records {
            Ok(records) => records,
            Err(why) => {
                let process = model.kind().name();
                asked.push(Asked { process, parts: Vec::new(), notes: vec![why], impossible: 0 });
                stated.push(Known::nothing(&model, path, &args.set)?);
                rest.push(None);
                continue;
            }
        };
        let mut outside: Vec<String> = Vec::new();
        if let Some(path) = &args.holdout_data {
            (records, outside) = with_more(&model, &records, path, group, voice)?;
        }
        let share = args.holdout.unwrap_or(0.0);
        // Every so many groups is held out, evenly through the data.
        let every = if share > 0.0 { (1.0 / share).round().max(2.0) as usize } else { usize::MAX };
        let held = |index: usize, name: &str| {
            outside.iter().any(|own| own == name) || (every < usize::MAX && index % every == every - 1)
        };
        let (known, model) = Known::of(model, path, &args.set, &records, &|model| model.asked(&records, group, held))?;
        let one = model.asked(&records, group, held);
        if one.parts.iter().all(|part| part.frame().measured.is_empty())
            && !only_values_are_missing(&model, &records, &one)
        {
            return Err(super::nothing_measured(&one.notes));
        }
        asked.push(one);
        stated.push(known);
        rest.push(Some((model, records)));
    }
    let (mut answers, diagnosed) = diagnosed_processes(&asked, args.seed);
    let points: Vec<Vec<Applied>> = stated
        .iter()
        .zip(&asked)
        .zip(&diagnosed)
        .map(|((known, own), diagnosed)| known.applied(own, diagnosed))
        .collect();
    let predicted: Vec<PredictionRow> = stated
        .iter()
        .zip(&points)
        .flat_map(|(known, points)| known.records.as_ref().map_or_else(Vec::new, |own| predictions_of(own, points)))
        .collect();
    let mut pages: Vec<Page> = Vec::new();
    for (((process, diagnosis), rest), asked) in answers.processes.iter_mut().zip(rest).zip(&asked) {
        let Some((model, records)) = rest.filter(|_| diagnosis.verdict != GapVerdict::CannotTell) else {
            pages.push(Page::without_readings(process, diagnosis.clone()));
            continue;
        };
        if let Some(best) = plan(&model, &records, group, diagnosis).best() {
            let separates = best.separates();
            diagnosis.next = NextExperiment { design: best.design.clone(), minutes: best.minutes, separates };
        }
        // What is compared of a shop is no operation but a block of them.
        let is_shop = matches!(model.process, NominalProcess::Shop(_));
        let ids = ["operation_id", "trial_id"].iter().find_map(|name| records.texts(name)).filter(|_| !is_shop);
        for own in &mut diagnosis.apart {
            own.operation_id = ids.and_then(|ids| ids.get(own.row)).cloned().unwrap_or_default();
        }
        if let NominalProcess::Shop(shop) = &model.process {
            add_facts(shop, &records, &model.stated.deviations, diagnosis, args.seed);
        }
        if out.is_some() {
            let readings = Readings::of_process(&model, &records, &asked.parts, diagnosis);
            let rates = args.models.iter().find_map(|path| rates(path, &args.set)).unwrap_or_default();
            pages.push(Page { process, diagnosis: diagnosis.clone(), readings, rates });
        }
    }
    let document = |answers: &Answers| {
        let processes: Vec<Process<'_>> =
            stated.iter().zip(&points).map(|(known, points)| known.process(points)).collect();
        document(answers.json(), &processes, known::data(&stated))
    };
    write(args, out, &answers, (&document(&answers), &predicted, &pages), voice)?;
    let untold: Vec<String> = answers
        .processes
        .iter()
        .filter(|(_, own)| own.verdict == GapVerdict::CannotTell)
        .map(|(process, own)| format!("{process}: {}", own.notes.join("; ")))
        .collect();
    if untold.is_empty() { Ok(()) } else { Err(Failure::TooLittle { message: untold.join("; ") }) }
}

/// Whether a table in which nothing was measured has a place for it, so that more rows are all it lacks.
fn only_values_are_missing(model: &NominalModel, records: &Records, asked: &Asked) -> bool {
    if let NominalProcess::Shop(_) = model.process {
        return visits(records).list.is_empty();
    }
    let mut channels = records.kind.columns().iter().filter(|column| column.kind == ColumnKind::Channel);
    asked.impossible == 0 && channels.any(|column| records.numbers(column.name).is_some())
}

/// The records followed by those of another set, and the groups that only the other has.
fn with_more(
    model: &NominalModel,
    records: &Records,
    path: &Path,
    group: Option<&str>,
    voice: &Voice,
) -> Result<(Records, Vec<String>), Failure> {
    let more = super::recorded(path, model, voice)?;
    joined(model, records, more, group).map_err(|(column, name)| {
        let message = format!("{column} {name} stands in both sets; a group is either fitted or held out");
        Failure::argument(message, "give the groups of the second set other names")
    })
}

/// Rates of the machines of a model file, where it is a scenario.
fn rates(path: &Path, set: &[String]) -> Option<Rates> {
    toolroom_scenario::file::read(path, set).ok().map(|read| Rates::of(&read.scenario))
}

fn write(
    args: &DiagnoseArgs,
    out: Option<OutputDir>,
    answers: &Answers,
    (document, predicted, pages): (&serde_json::Value, &[PredictionRow], &[Page]),
    voice: &Voice,
) -> Result<(), Failure> {
    if let Some(out) = out {
        let pretty = |value: &serde_json::Value| serde_json::to_string_pretty(value).map_err(Failure::Json);
        let models: Vec<String> = args.models.iter().map(|model| model.display().to_string()).collect();
        let data = args.data.display().to_string();
        let command = format!("toolroom gap diagnose --model {} --data {data}", models.join(" --model "));
        let hash = |name: &String| {
            (name.clone(), std::fs::read(name).map_or_else(|_| String::new(), |bytes| fingerprint(&bytes)))
        };
        let inputs = models.iter().chain([&data]).map(hash).collect();
        let version = env!("CARGO_PKG_VERSION");
        let provenance =
            Provenance { version: version.to_owned(), command: command.clone(), seed: Some(args.seed), inputs };
        out.put("diagnosis.json", &pretty(document)?)?;
        out.put("predictions.csv", &PredictionRow::csv(predicted))?;
        out.put("report.html", &html(pages, answers.sections(), provenance))?;
        out.put("report.md", &markdown(pages))?;
        out.put("report.json", &pretty(&toolroom_gap_report::json(pages))?)?;
        out.put(
            "run.json",
            &pretty(&json!({ "schema": 1, "version": version, "command": command, "complete": true }))?,
        )?;
        let target = out.publish()?;
        voice.say(format_args!("wrote {}", target.join("report.html").display()));
    }
    if voice.json { voice.json(document) } else { voice.data(answers.terminal()) }
}
