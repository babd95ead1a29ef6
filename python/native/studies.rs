//! Studies other than those of a shop: each yields a summary, a text for people and the files of the command line.

use crate::failure::Failure;
use crate::shop::quoted;
use crate::work::through;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde_json::Value;
use std::path::{Path, PathBuf};
use toolroom::apply::{Request as ApplyRequest, apply as applied, marked};
use toolroom::calibrate::CalibrationStudy;
use toolroom::chart::ResultFiles;
use toolroom::chart::page::Provenance;
use toolroom::gap::NominalModel;
use toolroom::gap_study::{GapRequest, GapStudy, GapStudyError, Reading, user_effects};
use toolroom::infeed::{Basis, IdentifyOptions};
use toolroom::life::analysis::Request;
use toolroom::life::file::StudyText;
use toolroom::life::replacement::Costs;
use toolroom::life::study::report::{Inputs, results};
use toolroom::life::study::run::enough;
use toolroom::life::study::shard;
use toolroom::parquet::{create, read_cells};
use toolroom::planning::identification::{IdentificationStudy, Table as Trials, TrialsError, measurement_errors};
use toolroom::planning::lobes::{ChartStudy, LobesFile, PointVerdict, read as read_lobes};
use toolroom::shards::fingerprint;

/// What a study yields: summary as JSON, text for people, files by name, and remarks.
pub struct Made {
    summary: Value,
    text: String,
    files: ResultFiles,
    notes: Vec<String>,
}

impl<'py> IntoPyObject<'py> for Made {
    type Target = PyDict;
    type Output = Bound<'py, PyDict>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        let made = PyDict::new(py);
        made.set_item("summary", self.summary.to_string())?;
        made.set_item("text", self.text)?;
        made.set_item("notes", self.notes)?;
        let files = PyDict::new(py);
        for (name, contents) in self.files.iter() {
            files.set_item(name, PyBytes::new(py, contents))?;
        }
        made.set_item("files", files)?;
        Ok(made)
    }
}

/// The command line that makes the same files.
fn origin(
    verb: &str,
    inputs: &[(String, &[u8])],
    words: impl IntoIterator<Item = String>,
    seed: Option<u64>,
) -> Provenance {
    let words = inputs.iter().map(|(name, _)| name.clone()).chain(words);
    let command = words.fold(format!("toolroom {verb}"), |command, word| command + " " + &quoted(&word));
    let inputs = inputs.iter().map(|(name, bytes)| (name.clone(), fingerprint(bytes))).collect();
    Provenance { version: env!("CARGO_PKG_VERSION").to_owned(), command, seed, inputs }
}

fn pool(threads: usize) -> Result<rayon::ThreadPool, Failure> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(Failure::work)
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| Failure::file(path, &error))
}

/// Statistics of lives, by the names of the command line.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Statistics {
    confidence: f64,
    bootstrap: u32,
    goodness: u32,
    costs: Option<(f64, f64)>,
    seed: Option<u64>,
}

impl Statistics {
    /// The request; `costs` are those of a study file.
    fn request(&self, costs: Option<Costs>) -> Result<Request, Failure> {
        let given = self.costs.map(|(planned, failure)| Costs { planned, failure });
        let costs = given.or(costs).unwrap_or(Request::default().costs);
        let Costs { planned, failure } = costs;
        if !(planned > 0.0 && failure.is_finite() && failure >= planned) {
            let message =
                format!("costs of {planned} and {failure}: a failure costs at least as much as a planned replacement");
            return Err(Failure::argument(message, "give both in one money, for example costs=(1, 5)"));
        }
        if !(0.5..=0.999).contains(&self.confidence) {
            return Err(Failure::argument(format_args!("a confidence of {}", self.confidence), "from 0.5 to 0.999"));
        }
        if self.bootstrap < 20 {
            return Err(Failure::argument(format_args!("{} resampled refits", self.bootstrap), "at least 20"));
        }
        Ok(Request {
            confidence: self.confidence,
            bootstrap: self.bootstrap,
            goodness: self.goodness,
            costs,
            seed: self.seed.unwrap_or(1),
            ..Request::default()
        })
    }
}

/// A Monte Carlo study of tool lives; its parts go into the folder `parts`.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // keyword arguments of Python
pub fn life(
    py: Python<'_>,
    file: PathBuf,
    set: Vec<String>,
    lives: Option<u64>,
    statistics: Statistics,
    threads: usize,
    parts: PathBuf,
) -> Result<Made, Failure> {
    through(py, move || {
        let text = StudyText::open(&file)?;
        let mut overrides = set;
        overrides.extend(statistics.seed.map(|seed| format!("seed={seed}")));
        overrides.extend(lives.map(|lives| format!("lives={lives}")));
        let mut parsed = text.parse(&overrides)?;
        let request = statistics.request(parsed.content.costs)?;
        let threads = pool(threads)?;
        if let Some(relative) = parsed.content.until {
            let lives = threads.install(|| enough(&parsed.content.study, relative));
            overrides.push(format!("lives={lives}"));
            parsed = text.parse(&overrides)?;
        }
        let study = &parsed.content.study;
        let plan = shard::plan(env!("CARGO_PKG_VERSION"), text, &parsed, overrides, None).map_err(Failure::work)?;
        let write: toolroom::records::table::NewTable<'_> = &create;
        let rows = parsed.content.write_lives.then_some(write);
        for number in 0..plan.shards {
            threads.install(|| shard::run(study, &plan, number, &parts, rows)).map_err(Failure::work)?;
        }
        let merged = shard::merge(&plan, study.cells.len(), &parts).map_err(Failure::work)?;
        let inputs = Inputs { plan: &plan, parsed: &parsed, merged: &merged, request: &request };
        let made = threads.install(|| results(&inputs)).map_err(Failure::work)?;
        Ok(Made { summary: made.summary, text: made.text, files: made.files, notes: Vec::new() })
    })
}

/// What the stability model refuses.
fn unstable(error: toolroom::chatter::ChatterError) -> Failure {
    if error.is_failed_search() { Failure::work(error) } else { Failure::argument(error, "see the values of the file") }
}

/// A stability chart.
#[pyfunction]
pub fn lobes(py: Python<'_>, file: PathBuf, set: Vec<String>, threads: usize) -> Result<Made, Failure> {
    through(py, move || {
        let read = read_lobes(&file, &set)?;
        pool(threads)?.install(|| {
            let LobesFile { cut, chart, .. } = &read.content;
            let all = 0..chart.speed.points;
            let grid = if chart.boundary_only { None } else { Some(cut.lobes(chart, all).map_err(unstable)?) };
            let study = ChartStudy::new(&read.content, grid).map_err(unstable)?;
            let inputs = [(file.display().to_string(), read.text.as_bytes())];
            let words = set.iter().flat_map(|change| ["--set".to_owned(), change.clone()]);
            let (summary, files) = study.files(&read.echo, origin("lobes", &inputs, words, None));
            Ok(Made { summary, text: study.text(), files, notes: study.holes() })
        })
    })
}

/// The verdict at one speed and depth, as JSON.
#[pyfunction]
pub fn verdict(
    py: Python<'_>,
    file: PathBuf,
    set: Vec<String>,
    speed: String,
    depth: String,
) -> Result<String, Failure> {
    through(py, move || {
        let read = read_lobes(&file, &set)?;
        let place = read.content.cut.place(&speed, &depth).map_err(|error| Failure::argument(&error, error.fix()))?;
        let verdict = PointVerdict::new(&read.content, place).map_err(unstable)?;
        Ok(Value::Object(verdict.json()).to_string())
    })
}

/// Lag and stiffnesses of plunge grinding from trials.
#[pyfunction]
#[pyo3(signature = (data, forces, basis, error, resamples, seed))]
#[allow(clippy::too_many_arguments)] // keyword arguments of Python
pub fn identify(
    py: Python<'_>,
    data: PathBuf,
    forces: Option<PathBuf>,
    basis: &str,
    error: Vec<String>,
    resamples: u32,
    seed: u64,
) -> Result<Made, Failure> {
    let Some(basis) = Basis::from_word(basis) else {
        return Err(Failure::argument(format_args!("there is no basis \"{basis}\""), Basis::WORDS.join(", ")));
    };
    through(py, move || {
        let errors = measurement_errors(&error).map_err(|error| Failure::argument(&error, error.fix()))?;
        let options = IdentifyOptions { basis, resamples: resamples as usize, seed, errors, strict: false };
        let table = |path: &Path| Ok::<_, Failure>(Trials { name: path.display().to_string(), bytes: bytes_of(path)? });
        let trials = table(&data)?;
        let forces = forces.as_deref().map(table).transpose()?;
        let title = data.file_stem().map_or_else(|| "trials".to_owned(), |stem| stem.to_string_lossy().into_owned());
        let read = IdentificationStudy::read(title, &trials, forces.as_ref(), options);
        let (study, notes) = read.map_err(|error| match error {
            TrialsError::Tables(error) => error.into(),
            other => Failure::argument(&other, "see the header of scenarios/data/zb153u_trials.csv"),
        })?;
        let mut words: Vec<String> = Vec::new();
        if let Some(forces) = &forces {
            words.extend(["--forces".to_owned(), forces.name.clone()]);
        }
        words.extend(["--basis".to_owned(), basis.word().to_owned()]);
        words.extend(error.iter().flat_map(|change| ["--error".to_owned(), change.clone()]));
        let mut provenance = origin("identify", &[(trials.name.clone(), &trials.bytes)], words, Some(seed));
        provenance.inputs.extend(forces.iter().map(|own| (own.name.clone(), fingerprint(&own.bytes))));
        Ok(Made { summary: study.summary(), text: study.text(), files: study.files(provenance), notes })
    })
}

/// A parameter set with uncertainty from measured edges; `name` is that of the set.
#[pyfunction]
#[pyo3(signature = (data, model, name, map, limit, law, fix, draws, seed))]
#[allow(clippy::too_many_arguments)] // keyword arguments of Python
pub fn calibrate(
    py: Python<'_>,
    data: PathBuf,
    model: String,
    name: String,
    map: Option<PathBuf>,
    limit: Option<String>,
    law: Vec<String>,
    fix: Vec<String>,
    draws: usize,
    seed: u64,
) -> Result<Made, Failure> {
    if !(100..=1_000_000).contains(&draws) {
        return Err(Failure::argument(format_args!("{draws} draws"), "from 100 to 1000000"));
    }
    through(py, move || {
        let study = CalibrationStudy {
            data: data.clone(),
            map,
            model,
            limit,
            laws: law,
            fixed: fix,
            draws,
            seed,
            ..CalibrationStudy::default()
        };
        let result =
            study.run(&read_cells, &|_, _| ()).map_err(|refusal| Failure::argument(&refusal.reason, &refusal.fix))?;
        let calibration = &result.calibration;
        let mut files = ResultFiles::default();
        files.push(format!("{name}.toml"), calibration.set_file(&name, &result.based_on));
        let (folder, path) = scratch()?;
        let file = std::fs::File::create(&path).map_err(|error| Failure::file(&path, &error))?;
        let written = result.drawn().write(file, &create).map_err(Failure::work);
        let posterior = written.and_then(|()| bytes_of(&path));
        // A folder of the system for files that nobody needs: it may stay where it cannot be removed.
        drop(std::fs::remove_dir_all(&folder));
        files.push(format!("{name}-posterior.parquet"), posterior?);
        let json = calibration.json();
        files.push(
            format!("{name}-calibration.json"),
            serde_json::to_string_pretty(&json).map_err(Failure::work)? + "\n",
        );
        let inputs = [(data.display().to_string(), bytes_of(&data)?)];
        let inputs: Vec<(String, &[u8])> =
            inputs.iter().map(|(name, bytes)| (name.clone(), bytes.as_slice())).collect();
        let words = ["--model".to_owned(), study.model.clone()];
        let provenance = origin("calibrate turning --data", &inputs, words, Some(seed));
        files.push(format!("{name}-report.html"), calibration.report().provenance(provenance).html());
        let notes = vec![result.read.to_string().trim_end().to_owned()];
        Ok(Made { summary: json, text: calibration.text(), files, notes })
    })
}

/// A folder of this process for a file that a library writes and Python is to have as bytes.
fn scratch() -> Result<(PathBuf, PathBuf), Failure> {
    use std::sync::atomic::{AtomicU64, Ordering};
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let folder = std::env::temp_dir().join(format!("toolroom-{}-{number}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|error| Failure::file(&folder, &error))?;
    let path = folder.join("draws.parquet");
    Ok((folder, path))
}

/// A diagnosis with its documents, and the text of the file of terms where some are proposed.
#[pyfunction]
#[pyo3(signature = (models, data, set, group, holdout, holdout_data, seed, definitions, propose))]
#[allow(clippy::too_many_arguments)] // keyword arguments of Python
pub fn diagnose(
    py: Python<'_>,
    models: Vec<PathBuf>,
    data: PathBuf,
    set: Vec<String>,
    group: Option<String>,
    holdout: f64,
    holdout_data: Option<PathBuf>,
    seed: u64,
    definitions: Vec<PathBuf>,
    propose: Option<String>,
) -> Result<(Made, Option<String>), Failure> {
    if !(0.0..1.0).contains(&holdout) {
        return Err(Failure::argument(format_args!("a holdout of {holdout}"), "a share of the groups, from 0 to 1"));
    }
    let defined = user_effects(&definitions)?;
    through(py, move || {
        let notes = std::cell::RefCell::new(Vec::new());
        let say = |line: &str| notes.borrow_mut().push(line.to_owned());
        let reading = Reading { parquet: &read_cells, say: &say };
        let request = GapRequest {
            models: &models,
            set: &set,
            defined: &defined,
            data: &data,
            group: group.as_deref(),
            holdout,
            holdout_data: holdout_data.as_deref(),
            seed,
            propose: propose.as_deref(),
            pages: true,
        };
        let study = GapStudy::new(&request, &reading)?;
        let shown: Vec<String> = models.iter().map(|model| model.display().to_string()).collect();
        let data = data.display().to_string();
        let files: String = definitions.iter().map(|path| format!(" --effects {}", path.display())).collect();
        let terms = propose.iter().map(|path| format!(" --propose {path}")).collect::<String>();
        let command = format!("toolroom gap diagnose --model {} --data {data}{files}{terms}", shown.join(" --model "));
        let hash = |name: &String| {
            (name.clone(), std::fs::read(name).map_or_else(|_| String::new(), |bytes| fingerprint(&bytes)))
        };
        let inputs = shown.iter().chain([&data]).map(hash).collect();
        let version = env!("CARGO_PKG_VERSION").to_owned();
        let files = study.files(Provenance { version, command, seed: Some(seed), inputs });
        let (summary, text) = (study.document.clone(), study.answers.terminal());
        let mut notes = notes.into_inner();
        notes.extend(study.untold().into_iter().map(|why| format!("too little data for an answer: {why}")));
        Ok((Made { summary, text, files, notes }, study.proposed))
    })
}

/// The text of a model with what a diagnosis (JSON) has found, and remarks.
#[pyfunction]
pub fn apply(
    model: PathBuf,
    diagnosis: &str,
    set: Vec<String>,
    only: Vec<String>,
    calibration: bool,
    accept_empirical: bool,
) -> Result<(String, Vec<String>), Failure> {
    let nominal = NominalModel::read(&model, &set).map_err(|error| Failure::from(GapStudyError::from(error)))?;
    let diagnosis: Value = serde_json::from_str(diagnosis).map_err(Failure::work)?;
    let text = toolroom::form::text(&model)?;
    let request = ApplyRequest {
        empirical: accept_empirical,
        text: &text,
        overrides: &set,
        diagnosis: &diagnosis,
        process: nominal.kind().name(),
        only: &only,
        calibration,
    };
    let changes = applied(request).map_err(|error| Failure::argument(&error, error.fix()))?;
    Ok((marked(&changes.text, &changes.data), changes.notes))
}
