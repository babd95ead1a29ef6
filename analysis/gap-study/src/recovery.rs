//! Whether the diagnosis finds again what a simulated shop hides: a study of parameter recovery.
//!
//! ```text
//!  TRUTH.toml, seed ─► run ─► records ─► diagnosis by MODEL.toml ─► names, sizes, facts
//!                                               │ apply
//!                                               ▼
//!                         key figures of MODEL, applied and TRUTH     fresh records ─► diagnosis by the applied model
//! ```
//!
//! Without a truth of its own the model is held against its own runs: whatever is named then is named wrongly.
//!
//! # Source
//! Talts, Betancourt, Simpson, Vehtari & Gelman 2018 (simulation-based calibration) for the idea; counts with exact
//! (Clopper–Pearson) bounds.
//!
//! # What is not modelled
//! Truth and model share their equations, integrator and noise: what this shows is an upper bound of what a real shop
//! will. `toolroom gap blind` has other equations.

use crate::figures::{Figure, compared};
use crate::recorded::recorded;
use crate::{GapRequest, GapStudy, GapStudyError, Reading};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use toolroom_apply::{ApplyError, Request, apply, scope_json};
use toolroom_gap::{Diagnosis, EffectId, GapVerdict, ModelFileError, NominalModel};
use toolroom_process::unit;
use toolroom_records::{RawTable, RecordError, write_csv};
use toolroom_scenario::{Scenario, Scope};
use toolroom_scenario_file::read;

/// Distance of the seeds of fresh records from those of the first ones (count). Assumption: nobody asks for so many logs.
const FRESH: u64 = 1_000_000;

/// A study that is wanted.
#[derive(Clone, Copy)]
pub struct RecoveryRequest<'a> {
    /// The nominal model.
    pub model: &'a Path,
    /// The scenario whose runs are recorded; the nominal model itself, if none.
    pub truth: Option<&'a Path>,
    /// Values that replace those of both files, `path=value`.
    pub set: &'a [String],
    /// Seed of the first run; the others follow it.
    pub seed: u64,
    /// Runs.
    pub logs: u32,
    /// Whether the found model is diagnosed on fresh records of the truth.
    pub fresh: bool,
    /// Whether key figures of the shop are compared.
    pub figures: bool,
    /// Folder of the records, a folder `log-SEED` each.
    pub folder: &'a Path,
}

/// Writes a file, whose folder exists; refuses to replace what is not its own.
pub type FileWriter<'a, E> = &'a (dyn Fn(&Path, &[u8]) -> Result<(), E> + Sync);

/// Records of a study are texts.
pub(crate) fn no_other_table(path: &Path) -> Result<RawTable, RecordError> {
    let source = std::io::Error::other("a study of recovery writes CSV alone");
    Err(RecordError::Unreadable { path: path.to_owned(), source })
}

/// An entry of the truth that the model lacks.
#[derive(Clone, Debug, PartialEq)]
pub struct HiddenEntry {
    /// The effect.
    pub id: EffectId,
    /// Where it acts.
    pub scope: Scope,
    /// Size, in `unit`.
    pub size: f64,
    /// Unit for people.
    pub unit: &'static str,
}

/// A name that a diagnosis gave.
#[derive(Clone, Debug, PartialEq)]
pub struct GivenName {
    /// Effects that cannot be told from it, itself first.
    pub class: Vec<EffectId>,
    /// Shape and scope, in words.
    pub shape: String,
    /// Size, in the unit for people.
    pub size: f64,
    /// Its 90 % interval.
    pub ci90: [f64; 2],
    /// Printed probability.
    pub probability: f64,
    /// Whether it is a hidden effect, or cannot be told from one.
    pub right: bool,
}

/// How a hidden entry was found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Finding {
    /// It, or what cannot be told from it, was named.
    pub found: bool,
    /// Its scope was named; `None` where it was not named itself.
    pub scope: Option<bool>,
    /// The 90 % interval of the size holds its size; `None` where it was not named with its scope.
    pub covered: Option<bool>,
}

/// How far a key figure closes: by what was applied, and by the truth.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedFigure {
    /// The figure.
    pub name: String,
    /// Share that what was applied closes.
    pub applied: f64,
    /// Share that the truth closes.
    pub truth: f64,
    /// Whether its gap grows with what was applied, for certain.
    pub grew: bool,
}

/// A log with its answer.
#[derive(Clone, Debug, PartialEq)]
pub struct RecoveredLog {
    /// Seed of its run.
    pub seed: u64,
    /// The verdict.
    pub verdict: GapVerdict,
    /// Probability of the test of the calibrated model, where it was tested.
    pub p: Option<f64>,
    /// What was named.
    pub named: Vec<GivenName>,
    /// Constants that facts contradict, in words.
    pub facts: Vec<String>,
    /// Each hidden entry.
    pub hidden: Vec<Finding>,
    /// The verdict on fresh records by the applied model, and how many effects it names; where that was asked and
    /// something was applied.
    pub fresh: Option<(GapVerdict, usize)>,
    /// Key figures with a gap, where they were asked.
    pub figures: Vec<ClosedFigure>,
}

/// The entries of `truth` that `model` lacks.
fn hidden(model: &Scenario, truth: &Scenario) -> Vec<HiddenEntry> {
    let entries = |scenario: &Scenario| {
        let of_shop = scenario.deviations.iter().map(|deviation| {
            let (id, entry) = (EffectId::from(deviation.effect), deviation.effect.entry());
            let size = unit::convert(deviation.size, entry.size.unit, entry.size.display);
            HiddenEntry { id, scope: deviation.scope.clone(), size, unit: entry.size.display }
        });
        let of_tools = scenario.tools.iter().flat_map(|tool| &tool.variants.effects).map(|tool| {
            let (id, entry) = (EffectId::from(&tool.effect), tool.effect.entry());
            let size = unit::convert(tool.effect.size(), entry.size.unit, entry.size.display);
            HiddenEntry { id, scope: tool.scope.clone(), size, unit: entry.size.display }
        });
        of_shop.chain(of_tools).collect::<Vec<HiddenEntry>>()
    };
    let known = entries(model);
    let mut found: Vec<HiddenEntry> = entries(truth);
    found.retain(|entry| !known.contains(entry));
    found.dedup();
    found
}

/// Runs the truth, diagnoses what was recorded, and counts. Every file is written by `put`; `progress` receives how many logs of
/// how many are done.
///
/// # Errors
/// [`GapStudyError`]: files and folders that cannot be read or made, a run that stops, records that the model does not suit;
/// and what `put` refuses.
pub fn recovery<E: From<GapStudyError> + Send>(
    request: &RecoveryRequest<'_>,
    put: FileWriter<'_, E>,
    progress: &(dyn Fn(u32, u32) + Sync),
) -> Result<(Vec<HiddenEntry>, Vec<RecoveredLog>), E> {
    let truth = request.truth.unwrap_or(request.model);
    let scenario = |path: &Path| -> Result<Scenario, GapStudyError> {
        Ok(read(path, request.set).map_err(ModelFileError::from)?.scenario)
    };
    let entries = hidden(&scenario(request.model)?, &scenario(truth)?);
    let done = AtomicU32::new(0);
    let seeds: Vec<u64> = (0..u64::from(request.logs)).map(|log| request.seed.wrapping_add(log)).collect();
    let one = |seed: &u64| {
        let log = log(request, put, (truth, &entries), *seed);
        progress(done.fetch_add(1, Ordering::Relaxed) + 1, request.logs);
        log
    };
    let logs = seeds.par_iter().map(one).collect::<Result<Vec<RecoveredLog>, E>>()?;
    Ok((entries, logs))
}

fn log<E: From<GapStudyError>>(
    request: &RecoveryRequest<'_>,
    put: FileWriter<'_, E>,
    (truth, entries): (&Path, &[HiddenEntry]),
    seed: u64,
) -> Result<RecoveredLog, E> {
    let folder = request.folder.join(format!("log-{seed}"));
    simulated(request, put, (truth, seed), &folder)?;
    let study = diagnosed(request, request.model, &folder)?;
    let Some((_, diagnosis)) = study.answers.processes.first() else {
        return Err(GapStudyError::Work("the model diagnoses no process".to_owned()).into());
    };
    let named: Vec<GivenName> = diagnosis
        .effects
        .iter()
        .map(|own| GivenName {
            class: own.class.clone(),
            shape: own.shape.clone(),
            size: own.size,
            ci90: own.ci90,
            probability: own.probability,
            right: entries.iter().any(|entry| own.class.contains(&entry.id)),
        })
        .collect();
    let mut log = RecoveredLog {
        seed,
        verdict: diagnosis.verdict,
        p: diagnosis.fit.as_ref().map(|fit| fit.p),
        facts: diagnosis.findings.iter().filter(|own| own.constant).map(|own| own.words.clone()).collect(),
        hidden: entries.iter().map(|entry| finding(entry, diagnosis, &study.document)).collect(),
        named,
        fresh: None,
        figures: Vec::new(),
    };
    if request.fresh || request.figures {
        let better = folder.join("model.toml");
        if let Some(text) = applied(request, &study.document)? {
            put(&better, text.as_bytes())?;
            after(request, put, (truth, seed), (&folder, &better), &mut log)?;
        }
    }
    Ok(log)
}

/// What an applied model makes of the key figures and of fresh records.
fn after<E: From<GapStudyError>>(
    request: &RecoveryRequest<'_>,
    put: FileWriter<'_, E>,
    (truth, seed): (&Path, u64),
    (folder, better): (&Path, &Path),
    log: &mut RecoveredLog,
) -> Result<(), E> {
    let reading = Reading { parquet: &no_other_table, say: &|_| {} };
    if request.figures {
        let [by_applied, by_truth] = compared(request.model, [better, truth], folder, request.set, &reading)?;
        log.figures = by_applied.iter().filter_map(|own| closed(own, &by_truth)).collect();
    }
    if request.fresh {
        let fresh = folder.join("fresh");
        simulated(request, put, (truth, seed.wrapping_add(FRESH)), &fresh)?;
        let study = diagnosed(request, better, &fresh)?;
        log.fresh = study.answers.processes.first().map(|(_, own)| (own.verdict, own.effects.len()));
    }
    Ok(())
}

/// A figure of which truth and record tell a gap.
fn closed(figure: &Figure, by_truth: &[Figure]) -> Option<ClosedFigure> {
    let truth = by_truth.iter().find(|own| own.words() == figure.words())?.closed()?;
    let applied = figure.closed()?;
    Some(ClosedFigure { name: figure.words(), applied: applied.share, truth: truth.share, grew: figure.grew() })
}

/// Records of a run of the truth, as tables of `folder`.
fn simulated<E: From<GapStudyError>>(
    request: &RecoveryRequest<'_>,
    put: FileWriter<'_, E>,
    (truth, seed): (&Path, u64),
    folder: &Path,
) -> Result<(), E> {
    let mut file = read(truth, request.set).map_err(ModelFileError::from).map_err(GapStudyError::from)?;
    file.scenario.seed = seed;
    let log = toolroom_shop::run(&file.scenario, 0, 0).map_err(GapStudyError::from)?;
    let unwritable = |source| GapStudyError::Unwritable { path: folder.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(unwritable)?;
    for records in recorded(&truth.display().to_string(), &file, &log)? {
        let mut csv = Vec::new();
        write_csv(&records, &mut csv).map_err(|error| GapStudyError::Work(error.to_string()))?;
        put(&folder.join(records.kind.file_stem()).with_extension("csv"), &csv)?;
    }
    Ok(())
}

fn diagnosed(request: &RecoveryRequest<'_>, model: &Path, data: &Path) -> Result<GapStudy, GapStudyError> {
    let models: Vec<PathBuf> = vec![model.to_owned()];
    let reading = Reading { parquet: &no_other_table, say: &|_| {} };
    let asked = GapRequest {
        models: &models,
        set: request.set,
        defined: &[],
        data,
        group: None,
        holdout: 0.0,
        holdout_data: None,
        seed: 1,
        propose: None,
        pages: false,
    };
    GapStudy::new(&asked, &reading)
}

/// The model with what was found; `None` where that is nothing.
fn applied(request: &RecoveryRequest<'_>, diagnosis: &Value) -> Result<Option<String>, GapStudyError> {
    let text = std::fs::read_to_string(request.model)
        .map_err(|source| GapStudyError::Unreadable { path: request.model.to_owned(), source })?;
    let process = NominalModel::read(request.model, request.set)?.kind().name();
    let asked = Request {
        text: &text,
        overrides: request.set,
        diagnosis,
        process,
        only: &[],
        calibration: true,
        empirical: false,
    };
    match apply(asked) {
        Ok(changes) => Ok(Some(changes.text)),
        Err(ApplyError::Nothing) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

/// How an entry was found.
fn finding(entry: &HiddenEntry, diagnosis: &Diagnosis, document: &Value) -> Finding {
    // A constant that a log cannot tell from the entry is one class with it.
    let delays = diagnosis.findings.iter().filter_map(|own| diagnosis.facts[own.fact].told.delay.as_ref());
    let found = diagnosis.effects.iter().any(|own| own.class.contains(&entry.id))
        || delays.into_iter().any(|own| own.effect == entry.id.word());
    let wanted = scope_json(&entry.scope);
    let same = |own: &&Value| own["id"] == entry.id.word();
    let mut written = document["applied"]["effects"].as_array().into_iter().flatten().filter(same).peekable();
    let named = diagnosis.effects.iter().any(|own| own.id == entry.id) && written.peek().is_some();
    let scope = named.then(|| written.any(|own| alike(&own["scope"], &wanted)));
    let holds = |own: &&toolroom_gap::NamedEffect| own.ci90[0] <= entry.size && entry.size <= own.ci90[1];
    let own: Vec<_> = diagnosis.effects.iter().filter(|own| own.id == entry.id).collect();
    let covered = (scope == Some(true) && own.len() == 1).then(|| own.iter().all(holds));
    Finding { found, scope, covered }
}

/// Whether two scopes choose the same, whatever the order of names; dates are those of a grid and may differ.
fn alike(a: &Value, b: &Value) -> bool {
    let words = |scope: &Value| {
        let map = scope.as_object().into_iter().flatten();
        let mut all: Vec<(String, Vec<String>)> = map
            .map(|(key, names)| {
                let list = names.as_array().into_iter().flatten().filter_map(Value::as_str).map(str::to_owned);
                let mut list: Vec<String> = list.collect();
                list.sort();
                (key.clone(), list)
            })
            .collect();
        all.sort();
        all
    };
    words(a) == words(b)
}

impl RecoveredLog {
    /// Whether a name was given that nothing hidden stands behind.
    pub fn wrong(&self) -> bool {
        self.named.iter().any(|own| !own.right)
    }

    /// For programs.
    pub fn json(&self) -> Value {
        let named = self.named.iter().map(|own| {
            json!({
                "class": EffectId::words(&own.class), "shape": own.shape, "size": own.size, "ci90": own.ci90,
                "probability": own.probability, "right": own.right,
            })
        });
        let hidden =
            self.hidden.iter().map(|own| json!({ "found": own.found, "scope": own.scope, "covered": own.covered }));
        let figures = self.figures.iter().map(
            |own| json!({ "kpi": own.name, "closed": own.applied, "closed_by_truth": own.truth, "grew": own.grew }),
        );
        json!({
            "seed": self.seed, "verdict": self.verdict.name(), "p": self.p, "named": named.collect::<Vec<_>>(),
            "facts": self.facts, "hidden": hidden.collect::<Vec<_>>(),
            "fresh": self.fresh.map(|(verdict, names)| json!({ "verdict": verdict.name(), "named": names })),
            "figures": figures.collect::<Vec<_>>(),
        })
    }
}
