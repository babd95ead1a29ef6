//! A calibration from files: what is read, and what it makes.

use crate::calibration::{Calibration, CalibrationError, Request};
use crate::law::Law;
use crate::parameter::Prior;
use crate::treatment::Measured;
use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs::File;
use std::path::{Path, PathBuf};
use toolroom_process::unit;
use toolroom_records::import::{Combine, Mapped, Mapping, Origin, import};
use toolroom_records::table::{Kind, NewTable, TableError, Value};
use toolroom_records::{OtherTable, ReadReport, RecordError, RecordKind, Records};
use toolroom_wear::{Pair, ParameterSet, Spread, TURNING_SETS, is_path};

/// Flank wear in m that may be a limit of wear: from the resolution of a microscope to what no edge survives (assumption).
const LIMITS: std::ops::RangeInclusive<f64> = 1e-6..=5e-3;

/// What is to be calibrated on which files.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationStudy {
    /// Records of turning operations, or a table of lives.
    pub data: PathBuf,
    /// Mapping file for a table of another layout.
    pub map: Option<PathBuf>,
    /// Parameter set from which everything comes that the data do not say: a shipped name or a path.
    pub model: String,
    /// Flank wear at which an edge is worn out, with its unit; that of the set if none.
    pub limit: Option<String>,
    /// Names of wear laws; all of them if empty or `all`.
    pub laws: Vec<String>,
    /// Parameters that are not fitted, `name=value`.
    pub fixed: Vec<String>,
    /// Draws of the posterior.
    pub draws: usize,
    /// Seed of the draws.
    pub seed: u64,
}

/// Why a study has no result, and what helps.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{reason}")]
pub struct Refusal {
    /// What is wrong.
    pub reason: String,
    /// What to do about it.
    pub fix: String,
}

/// A refusal with a reason and what helps.
fn refuse(reason: impl Display, fix: impl Display) -> Refusal {
    Refusal { reason: reason.to_string(), fix: fix.to_string() }
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
        ParameterSet::load(&self.model, Path::new(""), &TURNING_SETS)
            .map_err(|error| refuse(error, "--model names a shipped set or a file of one"))
    }

    /// Files that are read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let of_set = self.set().map_or_else(|_| Vec::new(), |set| set.files);
        std::iter::once(self.data.clone()).chain(self.map.clone()).chain(of_set).collect()
    }

    /// Reads the files and calibrates; `parquet` reads tables in that format.
    ///
    /// # Errors
    /// [`Refusal`]: a file that cannot be read, data that cannot be calibrated on, an unknown name, a limit that is none.
    pub fn run(&self, parquet: OtherTable<'_>) -> Result<StudyResult, Refusal> {
        let set = self.set()?;
        let base = Pair::of_set(&set).map_err(|error| refuse(error, "mend the set that --model names"))?;
        let limit = match &self.limit {
            Some(text) => unit::quantity(text, "m").map_err(|reason| {
                refuse(format_args!("--limit \"{text}\": {reason}"), "write for example --limit \"0.3 mm\"")
            })?,
            None => base.limits.wear_limit,
        };
        if !LIMITS.contains(&limit) {
            return Err(refuse(format_args!("--limit: {limit} m is no flank wear"), "look at its unit"));
        }
        let limit = limit * 1e3;
        let laws = self.laws()?;
        let fixed = self.fixed.iter().map(|text| fixed(text)).collect::<Result<Vec<_>, _>>()?;
        let priors = set.prior.iter().filter_map(|(name, spread)| prior(name, spread, &laws)).collect();
        let (records, read) = self.records(parquet)?;
        let measured = Measured::of(&records, limit).map_err(|error| {
            refuse(error, "docs/calibration.md lists the columns; `toolroom import csv` maps other tables to records")
        })?;
        let request = Request { laws, limit, fixed, priors, draws: self.draws, seed: self.seed };
        let calibration = Calibration::new(measured, &base, request).map_err(|error| match &error {
            CalibrationError::Parameter { .. } => refuse(error, "names are group.key or key"),
            CalibrationError::NoDensity(_) => refuse(error, "look at the units of the records"),
        })?;
        // A path counts from the file that names it, which may stand elsewhere.
        let absolute = || std::path::absolute(&self.model).map(|path| path.display().to_string());
        let based_on = if is_path(&self.model) { absolute().ok() } else { None };
        Ok(StudyResult { calibration, read, based_on: based_on.unwrap_or_else(|| self.model.clone()) })
    }

    fn laws(&self) -> Result<Vec<Law>, Refusal> {
        if self.laws.is_empty() || self.laws.iter().any(|word| word == "all") {
            return Ok(Law::ALL.to_vec());
        }
        let law = |word: &String| {
            let known = || Law::ALL.map(Law::group).join(", ");
            Law::of_group(word)
                .ok_or_else(|| refuse(format_args!("no wear law `{word}`"), format_args!("there are all, {}", known())))
        };
        self.laws.iter().map(law).collect()
    }

    /// Records of wear readings, or a table of lives, by its own headers or by a mapping.
    fn records(&self, parquet: OtherTable<'_>) -> Result<(Records, ReadReport), Refusal> {
        if let Some(map) = &self.map {
            let mapping = Mapping::read(map, &[]).map_err(|error| refuse(error, "mend the mapping"))?;
            return import(&self.data, &mapping, parquet).map_err(|error| refuse(error, "mend the mapping"));
        }
        match toolroom_records::read(&self.data, RecordKind::Turning, parquet) {
            Ok(read) => Ok(read),
            Err(error @ RecordError::MissingColumn { .. }) => match lives(&self.data) {
                Some(mapping) => {
                    import(&self.data, &mapping, parquet).map_err(|error| refuse(error, "mend the table of lives"))
                }
                None => Err(refuse(error, "`toolroom import csv` maps other tables to records; or give --map")),
            },
            Err(error) => Err(refuse(error, "check the path and the columns")),
        }
    }
}

impl StudyResult {
    /// The draws as a table: a column a parameter in its unit, the law, and the weight.
    ///
    /// # Errors
    /// What the format says.
    pub fn write_draws(&self, file: File, new_table: NewTable<'_>) -> Result<(), TableError> {
        let names = self.calibration.draw_columns();
        let columns = names.iter().map(|name| (name.as_str(), Kind::Real));
        let columns: Vec<(&str, Kind)> = columns.chain([("law", Kind::Text), ("weight", Kind::Real)]).collect();
        let mut table = new_table(file, &columns)?;
        let law = self.calibration.choice.law.group();
        for draw in self.calibration.draws() {
            let numbers = draw.into_iter().map(|value| Value::Real(Some(value)));
            let cells: Vec<Value<'_>> = numbers.chain([Value::Text(law), Value::Real(Some(1.0))]).collect();
            table.row(&cells)?;
        }
        table.finish()
    }
}

fn fixed(text: &str) -> Result<(String, f64), Refusal> {
    let parts = text.split_once('=').and_then(|(name, value)| Some((name.trim(), value.trim().parse::<f64>().ok()?)));
    parts
        .filter(|(_, value)| value.is_finite())
        .map(|(name, value)| (name.to_owned(), value))
        .ok_or_else(|| refuse(format_args!("--fix {text}: a name and a number are due"), "--fix stage_contrast=0.6"))
}

/// A standard deviation of the set as a prior of the laws in question, around the value of the set.
fn prior(name: &str, spread: &Spread, laws: &[Law]) -> Option<(String, Prior)> {
    let (group, _) = name.split_once('.')?;
    (group == "force" || laws.iter().any(|law| law.group() == group)).then(|| {
        let deviation = match spread {
            Spread::Factor(factor) => factor.ln().abs(),
            Spread::Deviation(deviation) => *deviation,
        };
        (name.to_owned(), Prior { mean: f64::NAN, deviation })
    })
}

/// The mapping of a table that has a column of lives: every column by its own header.
fn lives(path: &Path) -> Option<Mapping> {
    let text = String::from_utf8(std::fs::read(path).ok()?).ok()?;
    let line = text.trim_start_matches('\u{feff}').lines().next()?;
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
    (has("life") && has("tool_id")).then(|| Mapping { kind, columns, keep: Vec::new(), rows: 1 })
}
