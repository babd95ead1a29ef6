//! From the sections of a study file to a study.

mod fields;
mod keys;
mod words;

pub use keys::STUDY;

use crate::replacement::Costs;
use crate::study::points::Sampling;
use crate::study::policy::{ChangeCost, Reading, Rule};
use crate::study::{Cell, Ends, FailureKind, Passes, Study, Tilt, cell};
use fields::{copula, fields};
use keys::PRICE_WORD;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toolroom_form::{Fault, FormFile, ReadError, Section, Walk, set_parameters, significant};
use toolroom_process::unit;
use toolroom_scenario::{Knowledge, Posterior, SensorSheet, SpeedRule, read_posterior_of_pair};
use toolroom_scenario_file::{process_of, sensors};
use toolroom_wear::{Cut, Pair, ParameterSet, Scatter, SetError, TURNING_SETS};
use words::{BodyWord, FailureWord, KnowsWord, ReadingWord, SamplingWord};

/// What a study file says.
#[derive(Clone, Debug)]
pub struct StudyFile {
    /// The study.
    pub study: Study,
    /// Relative half-width at which the study stops.
    pub until: Option<f64>,
    /// Costs of replacing edges, where they are given.
    pub costs: Option<Costs>,
    /// Rows of Sobol indices and paths of Morris.
    pub sensitivity: Option<(u64, u64)>,
    /// Whether every life is written, or their statistics alone.
    pub write_lives: bool,
}

/// A study file before it is understood.
#[derive(Clone, Debug)]
pub struct StudyText {
    /// Its name in messages.
    pub file: String,
    /// What it holds.
    pub text: String,
    /// Where its paths start.
    pub directory: PathBuf,
}

impl StudyText {
    /// Opens a study file.
    ///
    /// # Errors
    /// [`ReadError`]: the file cannot be opened or decoded.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        let path = toolroom_form::place_of(path);
        let file = path.display().to_string();
        let text = toolroom_form::text(&path)?;
        let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let whole =
            if toolroom_form::is_shipped(&path) { Ok(folder.to_owned()) } else { std::fs::canonicalize(folder) };
        let directory = whole.map_err(|source| ReadError::Unreadable { file: file.clone(), source })?;
        Ok(Self { file, text, directory })
    }

    /// The study with values of `--set`.
    ///
    /// # Errors
    /// [`ReadError::Faults`] with every fault found.
    pub fn parse(&self, overrides: &[String]) -> Result<FormFile<StudyFile>, ReadError> {
        parse(&self.file, &self.text, &self.directory, overrides)
    }
}

/// Reads a study file with values of `--set`.
///
/// # Errors
/// [`ReadError`]: the file cannot be opened or decoded, or every fault found in it.
pub fn read(path: &Path, overrides: &[String]) -> Result<FormFile<StudyFile>, ReadError> {
    StudyText::open(path)?.parse(overrides)
}

/// Reads the text of a study; `file` is its name in messages, `directory` where its paths start.
///
/// # Errors
/// [`ReadError::Faults`] with every fault found.
pub fn parse(file: &str, text: &str, directory: &Path, overrides: &[String]) -> Result<FormFile<StudyFile>, ReadError> {
    toolroom_form::parse(file, text, overrides, &STUDY, |walk, root| resolve(walk, root, directory))
}

fn resolve(walk: &mut Walk, root: &Section<'_>, directory: &Path) -> Option<StudyFile> {
    let (mut pair, of_set) = pair(walk, root, directory)?;
    set_parameters(walk, root, pair.parameters_mut());
    if let Err(reason) = pair.law.check() {
        walk.fault(root.span_of("parameters"), Fault::Model { subject: "parameters".to_owned(), reason });
    }
    let stated = Scatter::of_section(walk, root, &format!("{}, scatter", root.path));
    let scatter = stated.or(of_set).unwrap_or_else(Scatter::shop);
    let conditions = conditions(walk, root, &pair);
    let ends = walk.table(root, "end").map_or_else(Ends::default, |section| ends(walk, &section));
    if scatter.chipped_share > 0.0 && pair.chipping.rate == 0.0 {
        match pair.chipping.for_share(&pair, &conditions[0].1, scatter.chipped_share) {
            Ok(chipping) => pair.chipping = chipping,
            Err(reason) => {
                walk.fault(root.span_of("scatter"), Fault::Model { subject: "chipped_share".to_owned(), reason });
            }
        }
    }
    let passes = walk.table(root, "passes");
    let passes = passes.map_or(Passes { path: 37.7, pause: 0.0 }, |section| Passes {
        path: section.required("path"),
        pause: section.required("pause"),
    });
    let lagged = root.chosen("body", BodyWord::from_word) == Some(BodyWord::Lagged);
    let cells = cells(walk, root, (&pair, &scatter), &conditions, (passes, lagged));
    let (fields, named) = fields(walk, root, &pair, directory);
    let copula = copula(walk, root, &named);
    let early = walk.table(root, "early");
    let tilt = early.as_ref().map_or_else(Tilt::default, |section| Tilt {
        wear_shift: section.required("wear_shift"),
        chipping_rate: section.required("chipping_rate"),
    });
    let draws = draws(walk, root, &pair, directory);
    if draws.is_some() && early.is_some() {
        let rule = "early failures are sampled around one set of parameters: leave one of the two out";
        walk.fault(root.span_of("early"), Fault::Beside { key: "early", beside: "parameters_from", rule });
    }
    let costs = walk.table(root, "replacement").and_then(|section| costs(walk, &section));
    let sensitivity = walk.table(root, "sensitivity");
    let sensitivity = sensitivity.and_then(|section| Some((section.count("samples")?, section.count("trajectories")?)));
    let sampling = match root.chosen("sampling", SamplingWord::from_word)? {
        SamplingWord::Antithetic => Sampling::Antithetic,
        SamplingWord::LatinHypercube => Sampling::LatinHypercube,
        SamplingWord::Sobol => Sampling::Sobol,
        SamplingWord::Plain => Sampling::Plain,
    };
    let name = root.text("name")?.to_owned();
    let title = root.text("title").filter(|title| !title.is_empty()).unwrap_or(&name).to_owned();
    let study = Study {
        title,
        seed: root.count("seed")?,
        lives: root.count("lives")?,
        pair,
        worlds: Arc::default(),
        scatter,
        fields,
        copula,
        cells,
        ends,
        passes,
        lagged,
        sampling,
        tilt,
        early: early.and_then(|section| section.si("age")).unwrap_or(0.0),
        name,
    };
    let study = match draws {
        Some(draws) => {
            let pairs = draws.pairs(study.seed, "life", &study.pair, &study.scatter);
            study.among(pairs)
        }
        None => study,
    };
    let until = root.si("until");
    Some(StudyFile { study, until, costs, sensitivity, write_lives: root.flag("write_lives")? })
}

fn pair(walk: &mut Walk, root: &Section<'_>, directory: &Path) -> Option<(Pair, Option<Scatter>)> {
    let reference = root.text("parameter_set")?;
    let span = root.span_of("parameter_set");
    let loaded = ParameterSet::load(reference, directory, &TURNING_SETS);
    match loaded {
        Ok(set) => {
            set.files.iter().for_each(|file| walk.named(file.clone()));
            let set = set.of_tool(walk, root, &TURNING_SETS)?;
            match Pair::of_set(&set) {
                Ok(pair) => Some((pair, set.scatter)),
                Err(reason) => {
                    walk.fault(span, Fault::Table { reason: format!("parameter set \"{reference}\": {reason}") });
                    None
                }
            }
        }
        Err(SetError::Unknown { name, known, .. }) if process_of(&name).is_some() => {
            let other = process_of(&name).unwrap_or_default();
            let reason = format!(
                "parameter set \"{name}\": it is a set of {other}, where one of turning is due; there are {known}"
            );
            walk.fault(span, Fault::Table { reason });
            None
        }
        Err(SetError::Unknown { name, nearest, known, .. }) => {
            let nearest = nearest.map(str::to_owned);
            walk.fault(span, Fault::UnknownName { kind: "parameter set", name, nearest, known });
            None
        }
        Err(reason) => {
            walk.fault(span, Fault::Table { reason: format!("parameter set \"{reference}\": {reason}") });
            None
        }
    }
}

/// The draws that `parameters_from` names; `None` without the key and where a problem was noted.
fn draws(walk: &mut Walk, root: &Section<'_>, pair: &Pair, directory: &Path) -> Option<Posterior> {
    let file = root.text("parameters_from")?;
    let path = directory.join(file);
    let read = read_posterior_of_pair(&path, root, pair);
    walk.named(path);
    let refuse = |reason| {
        let reason = format!("parameters_from \"{file}\": {reason}");
        walk.fault(root.span_of("parameters_from"), Fault::Table { reason });
    };
    read.map_err(refuse).ok()
}

/// Every cut of the grids, with its name; at least one.
fn conditions(walk: &mut Walk, root: &Section<'_>, pair: &Pair) -> Vec<(String, Cut)> {
    let reference = pair.reference_cut();
    let mut conditions = Vec::new();
    for section in walk.sections(root, "condition", None) {
        let values =
            |key: &str, reference: f64| section.numbers(key).filter(|list| !list.is_empty()).unwrap_or(vec![reference]);
        let (speeds, feeds, depths) = (
            values("cutting_speed", reference.cutting_speed),
            values("feed_per_rev", reference.feed_per_rev),
            values("depth_of_cut", reference.depth_of_cut),
        );
        let single = speeds.len() * feeds.len() * depths.len() == 1;
        for &speed in &speeds {
            for &feed in &feeds {
                for &depth in &depths {
                    let mut parts: Vec<String> = section.text("name").map(str::to_owned).into_iter().collect();
                    if !single || parts.is_empty() {
                        parts.push(format!("v {}", significant(unit::convert(speed, "m/s", "m/min"))));
                    }
                    if feeds.len() > 1 {
                        parts.push(format!("f {}", significant(feed * 1e3)));
                    }
                    if depths.len() > 1 {
                        parts.push(format!("a {}", significant(depth * 1e3)));
                    }
                    conditions.push((parts.join(", "), Cut::nominal(speed, feed, depth)));
                }
            }
        }
    }
    if conditions.is_empty() {
        conditions.push((String::new(), reference));
    }
    conditions
}

/// Sensors' keys of shops: single edges have no flank wear readings that take time, and no gains learnt from them.
const OF_SHOPS: &[&str] = &["reading_time", "read_every", "feed_force_gain", "thermo_emf_gain"];

fn cells(
    walk: &mut Walk,
    root: &Section<'_>,
    (pair, scatter): (&Pair, &Scatter),
    conditions: &[(String, Cut)],
    course: (Passes, bool),
) -> Vec<Cell> {
    let mut policies = Vec::<(String, Rule, Reading, SensorSheet)>::new();
    for section in walk.sections(root, "policy", None) {
        let name = section.text("name").unwrap_or_default().to_owned();
        if policies.iter().any(|(known, ..)| *known == name) {
            walk.fault(section.span_of("name"), Fault::DuplicateName { kind: "policy", name: name.clone() });
        }
        let word = section.chosen("speed", |word| {
            let priced = SpeedRule::Productivity { price: None }.word();
            SpeedRule::known_word(if word == PRICE_WORD { priced } else { word })
        });
        let speed = word.and_then(|word| SpeedRule::of_word(word, &section));
        let mut rule = Rule::from(speed.unwrap_or(SpeedRule::Programmed)); // None after a problem
        if section.chosen("knows", KnowsWord::from_word) == Some(KnowsWord::Edge) {
            rule.knows = Knowledge::Edge;
        }
        // Each applies to the rules that weigh it.
        let cost = |key: &str| section.si(key).unwrap_or_default();
        rule.change = ChangeCost { time: cost("change_time"), edge: cost("edge_cost"), machine: cost("machine_rate") };
        let reading = match section.chosen("reading", ReadingWord::from_word) {
            Some(ReadingWord::Pass) => Reading::Pass,
            // The key applies to rules with sensors only.
            Some(ReadingWord::Period) | None => Reading::Period,
        };
        policies.push((name, rule, reading, sensors(walk, &section, OF_SHOPS)));
    }
    if policies.is_empty() {
        let rule = Rule::from(SpeedRule::Programmed);
        policies.push(("programmed".to_owned(), rule, Reading::Pass, SensorSheet::default()));
    }
    let made = conditions.iter().flat_map(|(condition, cut)| {
        policies.iter().map(move |(name, rule, reading, sensors)| {
            cell((condition, *cut), (name, *rule, *reading), pair, scatter, *sensors, course)
        })
    });
    made.collect()
}

fn ends(walk: &mut Walk, section: &Section<'_>) -> Ends {
    let value = |key: &str| section.si(key).unwrap_or(f64::INFINITY);
    let mut ends = Ends {
        wear: value("flank_wear"),
        force: value("cutting_force"),
        path: value("path"),
        time: value("time"),
        failure: match section.chosen("failure", FailureWord::from_word) {
            Some(FailureWord::Limit) => FailureKind::Limit,
            Some(FailureWord::Cut) | None => FailureKind::Cut,
        },
        ..Ends::default()
    };
    if let Some(rough) = walk.table(section, "roughness") {
        let (new, limit) = (rough.required("new"), rough.required("limit"));
        if limit <= new {
            let micrometres = |value: f64| format!("{} um", significant(value * 1e6));
            let fault = Fault::Contradiction {
                first: "new",
                first_value: micrometres(new),
                second: "limit",
                second_value: micrometres(limit),
                rule: "a new edge is smoother than the limit",
            };
            walk.fault(rough.span_of("limit"), fault);
        }
        ends.rough_wear = (limit - new) / rough.required("per_wear");
    }
    ends
}

fn costs(walk: &mut Walk, section: &Section<'_>) -> Option<Costs> {
    let costs = Costs { planned: section.si("planned")?, failure: section.si("failure")? };
    if costs.failure < costs.planned {
        let euros = |value: f64| format!("{} EUR", significant(value));
        let fault = Fault::Contradiction {
            first: "planned",
            first_value: euros(costs.planned),
            second: "failure",
            second_value: euros(costs.failure),
            rule: "a failure costs at least as much as a planned replacement",
        };
        walk.fault(section.span_of("failure"), fault);
    }
    Some(costs)
}
