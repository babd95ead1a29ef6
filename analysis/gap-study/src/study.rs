//! The diagnosis of a data set, with its documents.

use crate::constants::{causes_of_facts, complete, constants_of_facts, drop_said_twice};
use crate::jobs::jobs;
use crate::known::{self, RecordedModel};
use crate::machines::Machines;
use crate::parts::{finds_a_part, fitted, split};
use crate::user_effects::refused_in;
use crate::{GapRequest, GapStudyError, Reading, Table, tables, usable};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use toolroom_apply::{Applied, Grew, PredictionRow, Process, document, grew, point_json, predictions_of};
use toolroom_chart::ResultFiles;
use toolroom_chart::page::Provenance;
use toolroom_gap::plan::plan;
use toolroom_gap::shop::{LogGroup, add_facts, visits};
use toolroom_gap::{
    Answers, DiagnosisWithBasis, EffectRefusal, Forward, GapVerdict, Jobs, NextExperiment, NominalModel,
    NominalProcess, OutlyingReading, Point, ProcessData, add_dynamics, diagnosed_processes, joined,
};
use toolroom_gap_proposals::{DescriptionRequest, NOTHING, Proposed, is_open, proposed};
use toolroom_gap_report::{Page, Rates, Readings, html, markdown};
use toolroom_records::{ColumnKind, Records};

/// Readings that a note names (assumption: more are not read).
const NAMED: usize = 5;

/// The files of a diagnosis.
pub const NAMES: &[&str] = &["diagnosis.json", "report.html", "report.md", "report.json", "predictions.csv"];

/// What is said of a data set.
pub struct GapStudy {
    /// The diagnosis of each process.
    pub answers: Answers,
    /// `diagnosis.json`.
    pub document: Value,
    /// What the nominal and the applied model predict of each row.
    pub predictions: Vec<PredictionRow>,
    /// The report, process by process; without pictures where none were wanted.
    pub pages: Vec<Page>,
    /// The file of terms that describe a gap of which no cause is known, where they were wanted and there are some.
    pub proposed: Option<String>,
}

/// A process before it is diagnosed.
struct PreparedProcess {
    asked: ProcessData,
    known: RecordedModel,
    /// Model and records; none where the table holds no usable row.
    table: Option<(NominalModel, Records)>,
}

impl GapStudy {
    /// Reads models and tables, and diagnoses them together.
    ///
    /// # Errors
    /// [`GapStudyError`]: a file that cannot be read, models and tables that do not fit each other, records in which
    /// nothing of what a model predicts was measured.
    pub fn new(request: &GapRequest<'_>, reading: &Reading<'_>) -> Result<Self, GapStudyError> {
        let tables = tables(request.models, request.set, request.defined, request.data, reading)?;
        let prepared =
            tables.into_iter().zip(request.models).map(|(table, path)| prepared(table, path, request, reading));
        let (mut asked, mut stated, mut rest) = (Vec::new(), Vec::new(), Vec::new());
        for one in prepared {
            let PreparedProcess { asked: own, known, table } = one?;
            asked.push(own);
            stated.push(known);
            rest.push(table);
        }
        let (mut answers, mut diagnosed) = diagnosed_processes(&asked, request.seed);
        if let Some(parts) = split(&answers, &rest, &stated, &asked, request) {
            let (second, rests_on) = diagnosed_processes(&parts, request.seed);
            if finds_a_part(&answers, &second, &asked, &parts) {
                (answers, diagnosed, asked) = (second, rests_on, parts);
            }
        }
        let points = points(&stated, &asked, &diagnosed);
        for ((own, points), known) in asked.iter().zip(&points).zip(&stated) {
            let refused = own.parts.iter().zip(points).find_map(|(part, own)| refused_at(part.as_ref(), own));
            if let (Some(records), Some(refusal)) = (&known.records, refused) {
                return Err(refused_in(records, refusal));
            }
        }
        for ((_, diagnosis), own) in answers.processes.iter_mut().zip(&points) {
            diagnosis.notes.extend(grew(own).iter().map(Grew::words));
        }
        let proposals = proposals(request, &mut answers, &rest, (&stated, &asked))?;
        let with_records = stated.iter().zip(&points).filter_map(|(known, own)| Some((known.records.as_ref()?, own)));
        let predictions = with_records.flat_map(|(records, points)| predictions_of(records, points)).collect();
        let machines = Machines::from_gap_request(request, &rest, reading)?;
        let jobs = jobs(request, &rest, machines.as_ref(), reading)?;
        let pages = completed(request, &mut answers, rest, &asked, (machines.as_ref(), jobs.as_ref()));
        let processes: Vec<Process<'_>> = stated.iter().zip(&points).map(|(known, own)| known.process(own)).collect();
        let mut document = document(answers.json(), &processes, known::data(&stated));
        add_facts_of(&mut document, &answers, machines.as_ref());
        let entry = |(place, own): &(usize, Proposed)| {
            let mut entry = own.entry.clone();
            entry["applied"] = point_json(&own.applied, &processes[*place]);
            entry
        };
        document["proposals"] = proposals.iter().map(entry).collect();
        let proposed = proposals.first().map(|(_, own)| own.text.clone());
        Ok(Self { answers, document, predictions, pages, proposed })
    }

    /// Processes of which too little was measured for an answer, each with what is too little.
    pub fn untold(&self) -> Vec<String> {
        let untold = self.answers.processes.iter().filter(|(_, own)| own.verdict == GapVerdict::CannotTell);
        untold.map(|(process, own)| format!("{process}: {}", own.notes.join("; "))).collect()
    }

    /// Diagnosis, predictions and report.
    pub fn files(&self, provenance: Provenance) -> ResultFiles {
        let mut files = ResultFiles::default();
        files.push("diagnosis.json", pretty(&self.document));
        files.push("predictions.csv", PredictionRow::csv(&self.predictions));
        files.push("report.html", html(&self.pages, self.answers.sections(), provenance));
        files.push("report.md", markdown(&self.pages));
        files.push("report.json", pretty(&toolroom_gap_report::json(&self.pages)));
        files
    }
}

fn pretty(value: &Value) -> String {
    format!("{value:#}")
}

/// Whether records can be taken in groups of a column.
fn known_group(model: &NominalModel, records: &Records, column: &str) -> Result<(), GapStudyError> {
    let no_group = |known: String| GapStudyError::NoGroup { column: column.to_owned(), known };
    match model.process {
        NominalProcess::Shop(_) if LogGroup::from_word(column).is_some() => Ok(()),
        NominalProcess::Shop(_) => Err(no_group(format!("; a log has {}", LogGroup::WORDS.join(", ")))),
        NominalProcess::Turning(_)
        | NominalProcess::Milling(_)
        | NominalProcess::Grinding(_)
        | NominalProcess::Empirical
        | NominalProcess::Program(_) => {
            if records.levels(column).is_some() {
                Ok(())
            } else {
                Err(no_group(String::new()))
            }
        }
    }
}

/// A model over its records, without those that are held out.
fn prepared(
    table: Table,
    path: &Path,
    request: &GapRequest<'_>,
    reading: &Reading<'_>,
) -> Result<PreparedProcess, GapStudyError> {
    let Table { model, records } = table;
    let mut records = match records {
        Ok(records) => records,
        Err(why) => {
            let asked =
                ProcessData { process: model.kind().name(), parts: Vec::new(), notes: vec![why], impossible: 0 };
            return Ok(PreparedProcess {
                asked,
                known: RecordedModel::nothing(&model, path, request.set)?,
                table: None,
            });
        }
    };
    // One of several tables may lack the column: its groups are the usual ones.
    if let Some(column) = request.group.filter(|_| request.models.len() == 1) {
        known_group(&model, &records, column)?;
    }
    let mut outside: Vec<String> = Vec::new();
    if let Some(more) = request.holdout_data {
        let more = reading.records(more, &model)?;
        (records, outside) = joined(&model, &records, more, request.group)
            .map_err(|(column, name)| GapStudyError::BothSets { column, name })?;
    }
    // Every so many groups is held out, evenly through the data.
    let every = if request.holdout > 0.0 { (1.0 / request.holdout).round().max(2.0) as usize } else { usize::MAX };
    let held = |index: usize, name: &str| {
        outside.iter().any(|own| own == name) || (every < usize::MAX && index % every == every - 1)
    };
    let asked = |model: &NominalModel| model.asked(&records, request.group, held);
    let (known, model) = RecordedModel::from_nominal_model(model, path, request.set, &records, &asked)?;
    let asked = asked(&model);
    if asked.parts.iter().all(|part| part.frame().measured.is_empty())
        && !only_values_are_missing(&model, &records, &asked)
    {
        return Err(GapStudyError::NothingMeasured { notes: asked.notes });
    }
    usable(&asked, &records)?;
    Ok(PreparedProcess { asked, known, table: Some((model, records)) })
}

/// Adds what facts contradict to what an application writes.
fn add_facts_of(document: &mut Value, answers: &Answers, machines: Option<&Machines>) {
    let all = || answers.processes.iter();
    let causes: Vec<Value> = machines.map_or_else(Vec::new, |own| {
        all().flat_map(|(process, diagnosis)| causes_of_facts(process, diagnosis, &own.scenario)).collect()
    });
    if let Some(list) = document["applied"]["calibration"].as_array_mut() {
        let constants: Vec<Value> =
            all().flat_map(|(process, diagnosis)| constants_of_facts(process, diagnosis, list)).collect();
        drop_said_twice(list, &constants, &causes);
        list.extend(constants);
    }
    if let Some(list) = document["applied"]["effects"].as_array_mut() {
        list.extend(causes.iter().cloned());
    }
    complete(&mut document["effects"], &causes);
}

/// What describes the gap of each process of which no cause is known, with the place of the process; notes say so.
fn proposals(
    request: &GapRequest<'_>,
    answers: &mut Answers,
    tables: &[Option<(NominalModel, Records)>],
    (stated, asked): (&[RecordedModel], &[ProcessData]),
) -> Result<Vec<(usize, Proposed)>, GapStudyError> {
    let Some(file) = request.propose else { return Ok(Vec::new()) };
    let mut all = Vec::new();
    for (place, (process, diagnosis)) in answers.processes.iter_mut().enumerate() {
        let Some((model, records)) = &tables[place] else { continue };
        if !is_open(process, diagnosis) {
            continue;
        }
        if stated[place].is_set_aside() {
            diagnosis.notes.push("nothing is proposed from records that the model has seen".to_owned());
            continue;
        }
        let held = |name: &str| !fitted(&asked[place], name);
        let (path, group, seed) = (&request.models[place], request.group, request.seed);
        let asking = DescriptionRequest { process, diagnosis, model, path, records, group, held: &held, file, seed };
        match proposed(&asking)? {
            Some(own) => {
                diagnosis.notes.insert(0, own.note.clone());
                all.push((place, own));
            }
            None => diagnosis.notes.push(NOTHING.to_owned()),
        }
    }
    Ok(all)
}

/// Whether a table in which nothing was measured has a place for it, so that more rows are all it lacks.
fn only_values_are_missing(model: &NominalModel, records: &Records, asked: &ProcessData) -> bool {
    if let NominalProcess::Shop(_) = model.process {
        return visits(records).list.is_empty();
    }
    let mut channels = records.kind.columns().iter().filter(|column| column.kind == ColumnKind::Channel);
    asked.impossible == 0 && channels.any(|column| records.numbers(column.name).is_some())
}

/// The first row in which an effect of a user gives no value at the size that was found.
fn refused_at(part: &dyn Forward, applied: &Applied) -> Option<EffectRefusal> {
    let (frame, mut point) = (part.frame(), Point::nominal(part));
    for effect in &applied.effects {
        let stated = frame.words.effects.iter().find(|(own, _)| *own == effect.candidate);
        point.effects[effect.candidate] = effect.size - stated.map_or(0.0, |(_, size)| *size);
    }
    let refusal = part.refusal(&point)?;
    Some(EffectRefusal { row: frame.record_of(refusal.row), ..refusal })
}

/// The applied point of each part of each process.
fn points(stated: &[RecordedModel], asked: &[ProcessData], diagnosed: &[Vec<DiagnosisWithBasis>]) -> Vec<Vec<Applied>> {
    let all = stated.iter().zip(asked).zip(diagnosed);
    all.map(|((known, own), diagnosed)| known.applied(own, diagnosed)).collect()
}

/// The pages of the report, after each diagnosis has learned its next experiment and the facts of its log.
fn completed(
    request: &GapRequest<'_>,
    answers: &mut Answers,
    tables: Vec<Option<(NominalModel, Records)>>,
    asked: &[ProcessData],
    (machines, jobs): (Option<&Machines>, Option<&Jobs>),
) -> Vec<Page> {
    let mut pages: Vec<Page> = Vec::new();
    for (((process, diagnosis), table), asked) in answers.processes.iter_mut().zip(tables).zip(asked) {
        let Some((model, records)) = table.filter(|_| diagnosis.verdict != GapVerdict::CannotTell) else {
            pages.push(Page::without_readings(process, diagnosis.clone()));
            continue;
        };
        if let Some(best) = plan(&model, &records, request.group, diagnosis).best() {
            let separates = best.separates();
            diagnosis.next = NextExperiment { design: best.design.clone(), minutes: best.minutes, separates };
        }
        // What is compared of a shop is no operation but a block of them.
        let is_shop = matches!(model.process, NominalProcess::Shop(_));
        let ids = ["operation_id", "trial_id"].iter().find_map(|name| records.texts(name)).filter(|_| !is_shop);
        for own in &mut diagnosis.apart {
            own.operation_id = ids.and_then(|ids| ids.get(own.row)).cloned().unwrap_or_default();
        }
        diagnosis.notes.extend(standing_apart(&diagnosis.apart));
        if let NominalProcess::Shop(shop) = &model.process {
            add_facts(shop, &records, jobs, &model.stated, diagnosis, request.seed);
        } else if let Some(machines) = machines {
            machines.add_to(jobs, diagnosis, request.seed);
        }
        add_dynamics(&model, &records, diagnosis, request.seed);
        if request.pages {
            let readings = Readings::of_process(&model, &records, &asked.parts, diagnosis);
            let rates = request.models.iter().find_map(|path| rates(path, request.set)).unwrap_or_default();
            pages.push(Page { process, diagnosis: diagnosis.clone(), readings, rates });
        }
    }
    pages
}

/// Says of every channel which readings stand apart.
fn standing_apart(all: &[OutlyingReading]) -> Vec<String> {
    let mut of_channel: BTreeMap<&'static str, Vec<&str>> = BTreeMap::new();
    for own in all {
        of_channel.entry(own.channel.word()).or_default().push(&own.operation_id);
    }
    let words = |(channel, ids): (&str, Vec<&str>)| {
        let named: Vec<&str> = ids.iter().copied().filter(|id| !id.is_empty()).take(NAMED).collect();
        let named = if named.is_empty() {
            String::new()
        } else {
            format!(" ({}{})", named.join(", "), if named.len() < ids.len() { " …" } else { "" })
        };
        let readings = if ids.len() == 1 { "1 reading stands" } else { &format!("{} readings stand", ids.len()) };
        format!(
            "{readings} apart in {channel}{named}: look at what happened there, and at the unit; `apart` in diagnosis.json lists all"
        )
    };
    of_channel.into_iter().map(words).collect()
}

/// Rates of the machines of a model file, where it is a scenario.
fn rates(path: &Path, set: &[String]) -> Option<Rates> {
    toolroom_scenario_file::read(path, set).ok().map(|read| Rates::from_scenario(&read.scenario))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recovery::no_other_table;
    use std::fmt::Write;
    use toolroom_gap::ChannelId;

    /// Edges of the table, the first half of them of another delivery than the second, and operations of each.
    const EDGES: usize = 32;
    const OPERATIONS: usize = 8;

    /// Sum of twelve even numbers: normal enough.
    fn normal(state: &mut u64) -> f64 {
        let mut even = || {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (*state >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| even()).sum::<f64>() - 6.0
    }

    /// Operations in the order of time with these readings of land, mm, force, N, and temperature, K.
    fn table(reading: impl Fn(usize) -> [f64; 3]) -> String {
        let mut text = String::from(
            "operation_id,machine,tool_id,sequence,start_time [s],cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],\
             cutting_time [min],flank_wear [mm],cutting_force [N],temperature [K]\n",
        );
        for row in 0..EDGES * OPERATIONS {
            let (edge, operation) = (row / OPERATIONS, row % OPERATIONS);
            let [speed, feed, depth] =
                [[220.0, 0.3, 1.5], [180.0, 0.25, 2.0], [250.0, 0.2, 1.0]][(edge + operation) % 3];
            let [land, force, hot] = reading(row);
            let _ = writeln!(
                text,
                "{row},L1,T{edge:02},{},{},{speed},{feed},{depth},4,{land:.4},{force:.2},{hot:.2}",
                operation + 1,
                row * 300
            );
        }
        text
    }

    fn written(directory: &Path, text: &str) -> std::path::PathBuf {
        let path = directory.join("operations.csv");
        std::fs::write(&path, text).expect("a file");
        path
    }

    #[test]
    fn a_rate_of_wear_that_is_another_one_from_a_date_on_is_named_and_no_effect_for_it() {
        let directory = tempfile::tempdir().expect("a directory");
        let model = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/gap/turning.toml")).to_owned();
        let reading = Reading { parquet: &no_other_table, say: &|_| {} };
        let planned = written(directory.path(), &table(|_| [0.2, 900.0, 1000.0]));
        let nominal = NominalModel::read(&model, &[]).expect("a shipped model");
        let records = reading.records(&planned, &nominal).expect("a table");
        let parts = nominal.splitting(Vec::new(), vec![("start_time".to_owned(), String::new())]);
        let part = parts.asked(&records, None, |_, _| false).parts.swap_remove(0);
        let frame = part.frame();
        let dates: Vec<usize> = (0..frame.candidates.len())
            .filter(|own| frame.candidates[*own].id.is_wear_rate() && part.written(*own).scope.from.is_some())
            .collect();
        assert_eq!(dates.len(), 7);
        // From the middle of the records on, seven tenths faster; every edge by its own factor.
        let mut point = Point::nominal(part.as_ref());
        point.effects[dates[3]] = 0.7;
        let mut state = 7;
        point.locals.iter_mut().flatten().for_each(|own| *own = normal(&mut state));
        let mut readings = vec![[0.0; 3]; EDGES * OPERATIONS];
        for (raw, observation) in part.simulate(&point).iter().zip(&frame.measured.observations) {
            let channel = &frame.measured.channels[observation.channel];
            let channels = [ChannelId::FlankWear, ChannelId::CuttingForce, ChannelId::Temperature];
            let place = channels.iter().position(|id| *id == channel.id);
            let noisy = raw + channel.sensor.deviation(*raw) * normal(&mut state);
            let unit = if channel.id == ChannelId::FlankWear { 1e3 } else { 1.0 };
            readings[observation.row][place.expect("three channels")] = noisy * unit;
        }
        let data = written(directory.path(), &table(|row| readings[row]));
        let request = GapRequest {
            models: &[model],
            set: &[],
            defined: &[],
            data: &data,
            group: None,
            holdout: 0.0,
            holdout_data: None,
            seed: 1,
            propose: None,
            pages: false,
        };
        let study = GapStudy::new(&request, &reading).expect("a diagnosis");
        let (_, diagnosis) = &study.answers.processes[0];
        let [named] = &diagnosis.effects[..] else { panic!("{:?} {:?}", diagnosis.verdict, diagnosis.notes) };
        assert!(named.id.is_wear_rate(), "{named:?}");
        assert!(named.ci90[0] < 0.7 && 0.7 < named.ci90[1], "{named:?}");
        assert_eq!(study.document["effects"][0]["kind"], "constant");
        // The date is one of seven.
        assert_eq!(study.document["effects"][0]["scope"]["from"], "38400 s", "{:#}", study.document["effects"][0]);
    }
}
