//! A calibration from files: what is read, and what it makes.

use crate::base::{Base, Process};
use crate::calibration::{Calibration, CalibrationError};
use crate::drawn::DrawnTable;
use crate::edge_start::EdgeStart;
use crate::known::{parameters, prior};
use crate::law::Law;
use crate::request::Request;
use crate::shape::{Candidate, Shape};
use crate::treatment::{Clock, Measured, Treatment};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use toolroom_cutting::{MILLING_CATALOGUE, Milling, process_of_set};
use toolroom_form::Outline;
use toolroom_location::{Located, Location};
use toolroom_process::unit;
use toolroom_records::import::{Combine, Mapped, Mapping, Origin, import};
use toolroom_records::{OtherTable, ReadReport, RecordError, RecordKind, Records};
use toolroom_wear::{Catalogue, Pair, ParameterSet, Scatter, Spread, TURNING_SETS, is_path, read_priors};

/// Flank wear in m that may be a limit of wear: from the resolution of a microscope to what no edge survives (assumption).
const LIMITS: std::ops::RangeInclusive<f64> = 1e-6..=5e-3;

/// What is to be calibrated on which files.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationStudy {
    /// The process that cut.
    pub process: Process,
    /// Records of operations, or a table of lives.
    pub data: PathBuf,
    /// Mapping file for a table of another layout.
    pub map: Option<PathBuf>,
    /// Parameter set from which everything comes that the data do not say: a shipped name or a path.
    pub model: String,
    /// Flank wear at which an edge is worn out, with its unit; that of the set if none.
    pub limit: Option<String>,
    /// Names of wear laws; all of the process if empty or `all`.
    pub laws: Vec<String>,
    /// Words of the shapes of wear curves of laws that state lives; `all` of them; the usual ones if empty.
    pub shapes: Vec<String>,
    /// Column of words whose edges may wear at different rates, `column` or `column=word` with the word whose level the set
    /// is to carry.
    pub by: Option<String>,
    /// Parameters that are not fitted, `name=value`.
    pub fixed: Vec<String>,
    /// File whose `[prior]` goes before that of the set: a parameter set, or nothing but `[prior]`.
    pub prior: Option<PathBuf>,
    /// Edges that take no part and are predicted: a share of them, `0.2`, or names with commas.
    pub holdout: Option<String>,
    /// How edges were when their records began.
    pub start: EdgeStart,
    /// Whether the wear rate may wander within lives.
    pub life_noise: bool,
    /// Whether profile intervals are worked out.
    pub profile: bool,
    /// Draws of the posterior.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
}

impl Default for CalibrationStudy {
    fn default() -> Self {
        Self {
            process: Process::Turning,
            data: PathBuf::new(),
            map: None,
            model: String::new(),
            limit: None,
            laws: Vec::new(),
            shapes: Vec::new(),
            by: None,
            fixed: Vec::new(),
            prior: None,
            holdout: None,
            start: EdgeStart::Auto,
            life_noise: false,
            profile: false,
            draws: 2000,
            seed: 1,
        }
    }
}

/// Why a study has no result, and what helps.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct Refusal {
    /// What is wrong.
    pub reason: String,
    /// What to do about it.
    pub fix: String,
    /// The file and line at fault, where one is.
    pub at: Option<Location>,
    /// Whether the system did not give that file.
    pub is_unreadable: bool,
}

impl Refusal {
    /// The same about a place in a file.
    fn at(self, at: Option<Location>) -> Self {
        Self { at, ..self }
    }
}

/// A refusal with a reason and what helps.
fn refuse(reason: impl Display, fix: impl Display) -> Refusal {
    Refusal { reason: reason.to_string(), fix: fix.to_string(), at: None, is_unreadable: false }
}

/// A finished study.
#[derive(Clone, Debug)]
pub struct StudyResult {
    /// The calibration.
    pub calibration: Calibration,
    /// What was read of the data.
    pub read: ReadReport,
    /// The set on which the calibrated one is based, as a file of any place may call it.
    pub based_on: String,
}

impl CalibrationStudy {
    /// The parameter set that is calibrated.
    fn set(&self) -> Result<ParameterSet, Refusal> {
        ParameterSet::load(&self.model, Path::new(""), self.catalogue()).map_err(|error| {
            match process_of_set(&self.model) {
                Some(other) => refuse(
                    format!("`{}` is a set of {other}, where one of {} is due", self.model, self.catalogue().process),
                    format!("`toolroom calibrate {other}`, or another --model"),
                ),
                None => {
                    let at = error.location();
                    refuse(error, "--model names a shipped set or a file of one").at(at)
                }
            }
        })
    }

    fn catalogue(&self) -> &'static Catalogue {
        match self.process {
            Process::Turning => &TURNING_SETS,
            Process::Milling => &MILLING_CATALOGUE,
        }
    }

    /// Spreads of parameters: those of `prior` before those of the set.
    fn spreads(&self, set: &ParameterSet) -> Result<BTreeMap<String, Spread>, Refusal> {
        let mut spreads = set.prior.clone();
        let Some(path) = &self.prior else { return Ok(spreads) };
        let wrong = |error: &dyn Display| refuse(error, "--prior takes a file with [prior], see docs/calibration.md");
        let outline = Outline::read(path).map_err(|error| wrong(&error))?;
        let outline_name = if outline.has("name") {
            let path = std::path::absolute(path).map_err(|error| wrong(&error))?;
            ParameterSet::load(&path.display().to_string(), Path::new(""), self.catalogue())
                .map_err(|error| wrong(&error))?
                .prior
        } else {
            read_priors(path, self.catalogue()).map_err(|error| wrong(&error))?
        };
        spreads.extend(outline_name);
        Ok(spreads)
    }

    /// Names of the edges to be held out.
    fn held_out(&self, measured: &Measured) -> Result<Vec<String>, Refusal> {
        let Some(text) = &self.holdout else { return Ok(Vec::new()) };
        let Ok(share) = text.trim().parse::<f64>() else {
            return Ok(text.split(',').map(|name| name.trim().to_owned()).collect());
        };
        if !(share > 0.0 && share < 1.0) {
            let named = measured.edges.iter().any(|edge| edge.name == text.trim());
            return if named {
                Ok(vec![text.trim().to_owned()])
            } else {
                let fix = "a share lies between 0 and 1, such as --holdout 0.2; or name edges, --holdout E03,E07";
                Err(refuse(format_args!("--holdout {text}: neither a share nor an edge"), fix))
            };
        }
        let mut names: Vec<String> = measured.edges.iter().map(|edge| edge.name.clone()).collect();
        names.shuffle(&mut ChaCha8Rng::seed_from_u64(self.seed));
        names.truncate(((share * names.len() as f64).round() as usize).max(1));
        Ok(names)
    }

    fn base(&self, set: &ParameterSet) -> Result<Base, Refusal> {
        let wrong = |error: &dyn Display| refuse(error, "mend the set that --model names");
        match self.process {
            Process::Turning => {
                let pair = Pair::of_set(set).map_err(|error| wrong(&error))?;
                Ok(Base::Turning { pair: Box::new(pair), others: Pair::other_laws(set).into() })
            }
            Process::Milling => {
                let milling = Milling::of_set(set).map_err(|error| wrong(&error))?;
                let Milling { life, cutter, chipping, .. } = milling;
                Ok(Base::Milling { life, diameter: cutter.diameter, chipping })
            }
        }
    }

    /// Files that are read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let of_set = self.set().map_or_else(|_| Vec::new(), |set| set.files);
        std::iter::once(self.data.clone()).chain(self.map.clone()).chain(self.prior.clone()).chain(of_set).collect()
    }

    /// Reads the files and calibrates; `parquet` reads tables in that format.
    ///
    /// `progress` is told how many parts of the work are done, of how many.
    ///
    /// # Errors
    /// [`Refusal`]: a file that cannot be read, data that cannot be calibrated on, an unknown name, a limit that is none.
    pub fn run(&self, parquet: OtherTable<'_>, progress: &(dyn Fn(u32, u32) + Sync)) -> Result<StudyResult, Refusal> {
        let set = self.set()?;
        let base = self.base(&set)?;
        let limit = match &self.limit {
            Some(text) => unit::quantity(text, "m").map_err(|reason| {
                refuse(format_args!("--limit \"{text}\": {reason}"), "write for example --limit \"0.3 mm\"")
            })?,
            None => base.wear_limit(),
        };
        if !LIMITS.contains(&limit) {
            return Err(refuse(format_args!("--limit: {limit} m is no flank wear"), "look at its unit"));
        }
        let limit = limit * 1e3;
        let laws = self.laws()?;
        let fixed = self.fixed.iter().map(|text| fixed(text)).collect::<Result<Vec<_>, _>>()?;
        let by = self.by.as_deref().map(|text| match text.split_once('=') {
            Some((column, word)) => (column.trim().to_owned(), Some(word.trim().to_owned())),
            None => (text.trim().to_owned(), None),
        });
        let (records, read) = self.records(parquet)?;
        self.words_where_numbers_are_due(&read)?;
        self.every_row_was_cut(&read)?;
        let (lines, wear_unit) = (read.lines.clone(), wear_unit(&read));
        let treatment =
            Treatment { by: by.clone(), start: self.start, lines, wear_unit, ..Treatment::from_base(&base) };
        let mut measured = Measured::treated(&records, limit, &treatment).map_err(|error| {
            let reason = format!("{}: {error}", self.data.display());
            refuse(reason, "docs/calibration.md lists the columns; `toolroom import csv` maps other tables to records")
                .at(Some(Location::of(self.data.display())))
        })?;
        measured.fit_into(&base);
        let candidates = self.candidates(&laws, measured.clock)?;
        let mut of_candidates: Vec<Law> = candidates.iter().map(|candidate| candidate.law).collect();
        of_candidates.dedup();
        let parameters = parameters(&base, &of_candidates, limit);
        let spreads = self.spreads(&set)?;
        let known = |(name, spread): (&String, &Spread)| {
            let parameter = parameters.iter().find(|parameter| parameter.name == *name)?;
            Some((name.clone(), prior(parameter, *spread, &set)))
        };
        let priors = spreads.iter().filter_map(known).collect();
        let by = by.map(|(column, _)| column);
        let held_out = self.held_out(&measured)?;
        let noise_time = set.scatter.unwrap_or_else(Scatter::shop).life_noise_time / 60.0;
        let request = Request {
            candidates,
            limit,
            by,
            fixed,
            priors,
            held_out,
            draws: self.draws,
            seed: self.seed,
            life_noise: self.life_noise.then_some(noise_time),
            profile: self.profile,
        };
        let calibration =
            Calibration::with_progress(measured, base, request, progress).map_err(|error| match &error {
                CalibrationError::Parameter { .. } => refuse(error, "names are group.key or key"),
                CalibrationError::Fixed { .. } => refuse(
                    error,
                    "a value within its range, in the unit of parameter files, such as --fix stage_contrast=0.6",
                ),
                CalibrationError::HeldOut(_) => refuse(error, "--holdout 0.2, or names of edges with commas"),
                CalibrationError::NoDensity(_) => refuse(error, "look at the units of the records"),
            })?;
        // A path counts from the file that names it, which may stand elsewhere.
        let absolute = || std::path::absolute(&self.model).map(|path| path.display().to_string());
        let based_on = if is_path(&self.model) { absolute().ok() } else { None };
        Ok(StudyResult { calibration, read, based_on: based_on.unwrap_or_else(|| self.model.clone()) })
    }

    /// Refuses lives whose cells hold words: without them an edge that was still good would count as worn out.
    fn words_where_numbers_are_due(&self, read: &ReadReport) -> Result<(), Refusal> {
        let of_lives =
            |(_, column, _): &&(usize, String, String)| ["life", "censored", "inspected"].contains(&column.as_str());
        let Some((line, column, word)) = read.unreadable.iter().find(of_lives) else { return Ok(()) };
        let fix = match column.as_str() {
            "censored" => "write 1 where the edge was still good, else 0",
            _ => "write a number of minutes, or leave the cell empty",
        };
        Err(refuse(format_args!("{}: line {line}: {column} is `{word}`", self.data.display()), fix)
            .at(Some(Location::line(self.data.display(), *line))))
    }

    /// Refuses rows of which is not known what was cut: it would be missing in the wear of the edge.
    fn every_row_was_cut(&self, read: &ReadReport) -> Result<(), Refusal> {
        let Some((line, what)) = read.unknown_cuts.first() else { return Ok(()) };
        let reason = format!("{}: line {line}: {what} cannot be used", self.data.display());
        Err(refuse(reason, "write what was cut; a time in cut is that of the row alone")
            .at(Some(Location::line(self.data.display(), *line))))
    }

    fn laws(&self) -> Result<Vec<Law>, Refusal> {
        let all = Law::of(self.process);
        if self.laws.is_empty() || self.laws.iter().any(|word| word == "all") {
            return Ok(all.to_vec());
        }
        let law = |word: &String| {
            let known = || all.iter().map(|law| law.group()).collect::<Vec<_>>().join(", ");
            Law::of_group(word).filter(|law| all.contains(law)).ok_or_else(|| {
                let reason = format!("no wear law `{word}` of {}", self.process.name());
                refuse(reason, format_args!("there are all, {}", known()))
            })
        };
        self.laws.iter().map(law).collect()
    }

    /// The laws with the shapes that are to be compared. Without a word of the user a single law that states lives is tried in
    /// every shape where nothing else is to be chosen, and is curved among others.
    fn candidates(&self, laws: &[Law], clock: Clock) -> Result<Vec<Candidate>, Refusal> {
        let named = !self.laws.is_empty() && self.laws.iter().all(|word| word != "all");
        let mut laws = laws.to_vec();
        if clock == Clock::Operations {
            if let Some(law) = laws.iter().find(|law| named && !law.states_lives()) {
                let reason = format!("the law {} needs minutes, and the records have no cutting_time", law.group());
                return Err(refuse(reason, "give cutting_time, or --law extended_taylor"));
            }
            laws.retain(|law| law.states_lives());
        }
        let shape = |word: &String| {
            Shape::named(word)
                .ok_or_else(|| refuse(format_args!("no shape `{word}`"), "there are straight, curved, tilted and all"))
        };
        let shapes = if self.shapes.iter().any(|word| word == "all") {
            Shape::ALL.to_vec()
        } else if self.shapes.is_empty() {
            let many = self.process == Process::Milling || clock == Clock::Operations;
            if many { Shape::ALL.to_vec() } else { vec![Shape::Curved] }
        } else {
            self.shapes.iter().map(shape).collect::<Result<_, _>>()?
        };
        let mut candidates: Vec<Candidate> = Vec::new();
        for law in laws {
            let allowed: &[Shape] = if law.states_lives() { &shapes } else { &[Shape::Curved] };
            candidates.extend(allowed.iter().map(|shape| Candidate { law, shape: *shape }));
        }
        candidates.dedup();
        Ok(candidates)
    }

    /// Records of wear readings, or a table of lives, by its own headers or by a mapping.
    fn records(&self, parquet: OtherTable<'_>) -> Result<(Records, ReadReport), Refusal> {
        if let Some(map) = &self.map {
            let mapping = Mapping::read(map, &[]).map_err(|error| {
                let at = error.location();
                refuse(error, "mend the mapping").at(at)
            })?;
            return import(&self.data, &mapping, parquet).map_err(|error| {
                let at = error.location();
                refuse(error, "mend the mapping").at(at)
            });
        }
        let kind = match self.process {
            Process::Turning => RecordKind::Turning,
            Process::Milling => RecordKind::Milling,
        };
        match toolroom_records::read(&self.data, kind, parquet) {
            Ok(read) => Ok(read),
            Err(error @ RecordError::MissingColumn { .. }) => {
                if let Some(mapping) = by_headers(&self.data) {
                    let read = import(&self.data, &mapping, parquet).map_err(|error| {
                        let at = error.location();
                        refuse(error, "mend the table").at(at)
                    })?;
                    return self.of_this_process(read);
                }
                let fix = "docs/calibration.md lists the columns of records, a table of lives has tool_id and `life [min]`; \
                           `toolroom import csv` maps other tables to records; or give --map";
                let at = error.location();
                Err(refuse(error, fix).at(at))
            }
            Err(error) => {
                let (at, is_unreadable) = (error.location(), matches!(error, RecordError::Unreadable { .. }));
                Err(Refusal { is_unreadable, ..refuse(error, "check the path and the columns").at(at) })
            }
        }
    }

    /// Refuses a table whose feed is that of the other process: that of the set would be taken in its place.
    fn of_this_process(&self, read: (Records, ReadReport)) -> Result<(Records, ReadReport), Refusal> {
        let other = match self.process {
            Process::Turning => Process::Milling,
            Process::Milling => Process::Turning,
        };
        let has = |process: Process| read.0.numbers(process.feed()).is_some();
        if has(other) && !has(self.process) {
            let reason = format!(
                "{} has {} and no {}: it is one of {}",
                self.data.display(),
                other.feed(),
                self.process.feed(),
                other.name()
            );
            return Err(refuse(reason, format_args!("`toolroom calibrate {}`, or rename the column", other.name())));
        }
        Ok(read)
    }
}

impl StudyResult {
    /// The draws as a table: a column a parameter in its unit, the law, and the weight.
    pub fn drawn(&self) -> DrawnTable {
        let law = self.calibration.choice.carried.law.group();
        DrawnTable { columns: self.calibration.draw_columns(), rows: self.calibration.draws().collect(), law }
    }
}

/// The unit that the header of flank wear states; mm without one.
fn wear_unit(read: &ReadReport) -> String {
    let title = read.columns.iter().find(|title| title.starts_with("flank_wear") || title.contains("→ flank_wear"));
    let unit = title.and_then(|title| title.split(" → ").next()?.split_once('['));
    unit.map_or_else(|| "mm".to_owned(), |(_, unit)| unit.trim_end_matches(']').trim().to_owned())
}

fn fixed(text: &str) -> Result<(String, f64), Refusal> {
    let due = |what: &str, fix: String| refuse(format_args!("--fix {text}: {what}"), fix);
    let example = || "--fix stage_contrast=0.6".to_owned();
    let Some((name, value)) = text.split_once('=').map(|(name, value)| (name.trim(), value.trim())) else {
        return Err(due("a value is due behind the name", example()));
    };
    let number = |text: &str| text.parse::<f64>().ok().filter(|value| value.is_finite());
    if let Some(value) = number(value) {
        return Ok((name.to_owned(), value));
    }
    // A number with its unit, as files have it.
    Err(match value.split_once(' ').and_then(|(first, _)| Some((first, number(first)?))) {
        Some((first, _)) => {
            due("the number stands alone, in the unit of parameter files", format!("--fix {name}={first}"))
        }
        None => due(&format!("`{value}` is no number"), example()),
    })
}

/// The mapping of a table of lives, or of wear over time or path without the names of operations and machines: every column by its own
/// header.
fn by_headers(path: &Path) -> Option<Mapping> {
    let text = String::from_utf8(std::fs::read(path).ok()?).ok()?;
    let line =
        text.trim_start_matches('\u{feff}').lines().find(|line| !line.trim().is_empty() && !line.starts_with('#'))?;
    let kind = RecordKind::Empirical;
    let header: Vec<&str> = line.split([',', ';', '\t']).map(|title| title.trim().trim_matches('"')).collect();
    let name = |title: &str| title.split('[').next().unwrap_or_default().trim().to_owned();
    let columns: Vec<Mapped> = header
        .iter()
        .filter_map(|title| {
            let column = kind.column(&name(title))?;
            let values = BTreeMap::new();
            let origin = Origin::Column { from: (*title).to_owned(), unit: None, factor: 1.0, running: false, values };
            Some(Mapped { column, origin, combine: Combine::First })
        })
        .collect();
    let has = |wanted: &str| columns.iter().any(|mapped| mapped.column.name == wanted);
    let over_path = has("path_length") && has("flank_wear") && !has("feed_per_tooth");
    let over_time = has("cutting_time") && has("flank_wear") && has("cutting_speed");
    ((has("life") || over_path || over_time) && has("tool_id")).then(|| Mapping {
        kind,
        columns,
        keep: Vec::new(),
        rows: 1,
    })
}
