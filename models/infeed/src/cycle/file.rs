//! Cycle files.

use super::{Cycle, CycleError, CycleLimits, DressingInterval, cycle_time_estimate, dressing_interval, fastest_cycle};
use crate::{Infeed, Input, Parameters, SetError, State};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;
use toolroom_effects::{Effect, EffectError, Effects};
use toolroom_process::parameters::{Value, place};
use toolroom_process::unit::{UnitError, quantity};
use toolroom_process::{AnyRecord, ModelError, record};

record! {
    /// How the wheel is dressed.
    ///
    /// # Source
    /// Assumption.
    pub struct DressingPlan {
        /// Time that a dressing takes.
        dressing_time: Real["s" => "s"] = 90.0, 0.0..=1e5;
        /// Most parts between dressings that are considered.
        most_parts: Integer = 500.0, 1.0..=1e5;
        /// Greatest finish infeed of the estimate.
        finish_infeed: Real["m" => "um"] = 1e-6, 1e-9..=1e-3;
    }
}

/// A grinding task: machine, conditions, limits.
///
/// ```toml
/// schema = 1
/// title = "Rings, 100 um of stock"
/// parameter_set = "zb153u_40kh"
/// effects = [{ id = "threshold_force", size = "20 N" }]  # what the set leaves out
/// [parameters]                 # deviations from the set
/// dulling_rate = "0.000667 mm/mm3"
/// [conditions]                 # fields of the input
/// work_rotation_speed = "292 rpm"
/// [limits]                     # fields of CycleLimits
/// stock = "100 um"
/// [dressing]                   # fields of DressingPlan; left out: no dressing interval
/// dressing_time = "90 s"
/// ```
///
/// ```
/// let file = toolroom_infeed::CycleFile::read("cycle.toml", "schema = 1\n[limits]\nstock = \"50 um\"\n").unwrap();
/// assert_eq!(file.fastest_cycle().unwrap().revolutions, 17);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CycleFile {
    /// One line for people.
    pub title: String,
    /// The process.
    pub grinding: Infeed,
    /// Conditions; the infeed per revolution is of no account.
    pub input: Input,
    /// Limits.
    pub limits: CycleLimits,
    /// Dressing, where it is asked for.
    pub dressing: Option<DressingPlan>,
}

/// A cycle file that cannot be used; all faults at once.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", .faults.iter().map(|fault| format!("{file}:{fault}")).collect::<Vec<_>>().join("\n"))]
pub struct CycleFileError {
    /// The file, as named by the caller.
    pub file: String,
    /// What is wrong, in the order of the file.
    pub faults: Vec<CycleFault>,
}

/// One fault. Line and column count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{line}:{column}: {reason}")]
pub struct CycleFault {
    /// Line.
    pub line: usize,
    /// Column.
    pub column: usize,
    /// What is wrong there.
    pub reason: CycleReason,
}

/// What can be wrong with a cycle file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CycleReason {
    /// Not TOML, or not of this form.
    #[error("{message}")]
    Syntax {
        /// What the TOML reader says.
        message: String,
    },
    /// Another version of the format.
    #[error("schema = {schema} is not known; this version reads schema = 1")]
    Schema {
        /// What was read.
        schema: i64,
    },
    /// No such parameter set.
    #[error(transparent)]
    Set(SetError),
    /// A key that the table does not have.
    #[error("[{table}] has no `{key}`; did you mean `{nearest}`?")]
    UnknownKey {
        /// Table.
        table: &'static str,
        /// What was read.
        key: String,
        /// The most similar key.
        nearest: &'static str,
    },
    /// A value that cannot be read.
    #[error("{key}: {reason}")]
    Unit {
        /// Key.
        key: String,
        /// What is wrong.
        reason: UnitError,
    },
    /// A value out of range.
    #[error(transparent)]
    Range(ModelError),
    /// An effect that cannot act here.
    #[error(transparent)]
    Effect(EffectError),
    /// A table that a cycle file does not have.
    #[error("there is no table `{table}`; there are parameters, conditions, limits and dressing, each with its keys")]
    UnknownTable {
        /// What was read.
        table: String,
    },
}

impl CycleReason {
    /// Short name of the fault, for programs.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Syntax { .. } => "syntax",
            Self::Schema { .. } => "schema",
            Self::Set(_) => "unknown-name",
            Self::UnknownKey { .. } | Self::UnknownTable { .. } => "unknown-key",
            Self::Unit { .. } => "quantity",
            Self::Range(_) => "out-of-range",
            Self::Effect(_) => "effect",
        }
    }
}

type Entries = BTreeMap<Spanned<String>, Spanned<Value>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    schema: Spanned<i64>,
    #[serde(default)]
    title: String,
    parameter_set: Option<Spanned<String>>,
    effects: Option<Spanned<Vec<Effect>>>,
    #[serde(default)]
    parameters: Entries,
    #[serde(default)]
    conditions: Entries,
    #[serde(default)]
    limits: Entries,
    dressing: Option<Entries>,
}

impl CycleFile {
    /// Reads a cycle file; `file` is its name for messages. What is not given has its default.
    ///
    /// # Errors
    /// [`CycleFileError`] with every fault and its place.
    pub fn read(file: &str, text: &str) -> Result<Self, CycleFileError> {
        let refuse = |faults| CycleFileError { file: file.to_owned(), faults };
        let raw: Raw = toml::from_str(text).map_err(|error| {
            let (line, column) = place(text, error.span().map_or(0, |span| span.start));
            let reason = CycleReason::Syntax { message: error.message().to_owned() };
            refuse(vec![CycleFault { line, column, reason }])
        })?;
        let mut faults = Vec::new();
        let fault = |at: usize, reason| {
            let (line, column) = place(text, at);
            CycleFault { line, column, reason }
        };
        if *raw.schema.get_ref() != 1 {
            faults.push(fault(raw.schema.span().start, CycleReason::Schema { schema: *raw.schema.get_ref() }));
        }
        let mut parameters = Parameters::default();
        if let Some(set) = &raw.parameter_set {
            match Parameters::named(set.get_ref()) {
                Ok(named) => parameters = named,
                Err(error) => faults.push(fault(set.span().start, CycleReason::Set(error))),
            }
        }
        let (mut input, mut limits) = (Input::default(), CycleLimits::default());
        let mut dressing = raw.dressing.as_ref().map(|_| DressingPlan::default());
        fill(text, "parameters", &raw.parameters, &mut parameters, &mut faults);
        fill(text, "conditions", &raw.conditions, &mut input, &mut faults);
        fill(text, "limits", &raw.limits, &mut limits, &mut faults);
        if let (Some(entries), Some(dressing)) = (&raw.dressing, &mut dressing) {
            fill(text, "dressing", entries, dressing, &mut faults);
        }
        let mut grinding = Infeed { parameters, ..Infeed::default() };
        if let Some(listed) = raw.effects {
            let at = listed.span().start;
            match Effects::new(listed.into_inner()).and_then(|effects| Infeed::new(parameters, effects)) {
                Ok(with_effects) => grinding = with_effects,
                Err(error) => faults.push(fault(at, CycleReason::Effect(error))),
            }
        }
        if !faults.is_empty() {
            faults.sort_by_key(|fault| (fault.line, fault.column));
            return Err(refuse(faults));
        }
        Ok(Self { title: raw.title, grinding, input, limits, dressing })
    }

    /// Replaces one value, as `limits.stock` and `50 um`; effects by id, as
    /// `effects.threshold_force` and `20 N`.
    ///
    /// # Errors
    /// [`CycleReason`] where there is no such key, or the value is none.
    ///
    /// ```
    /// let mut file = toolroom_infeed::CycleFile::read("cycle.toml", "schema = 1").unwrap();
    /// file.set("limits.stock", "50 um").unwrap();
    /// assert!((file.limits.stock - 50e-6).abs() < 1e-15);
    /// ```
    pub fn set(&mut self, path: &str, value: &str) -> Result<(), CycleReason> {
        let (table, key) = path.split_once('.').unwrap_or((path, ""));
        if table == "effects" {
            let effect: Effect = format!("{key}={value}").parse().map_err(CycleReason::Effect)?;
            let others = self.grinding.effects.iter().filter(|each| each.entry().id != effect.entry().id);
            let all: Vec<Effect> = others.copied().chain([effect]).collect();
            let effects = Effects::new(all).map_err(CycleReason::Effect)?;
            self.grinding = Infeed::new(self.grinding.parameters, effects).map_err(CycleReason::Effect)?;
            return Ok(());
        }
        let (table, record): (&'static str, &mut dyn AnyRecord) = match table {
            "parameters" => ("parameters", &mut self.grinding.parameters),
            "conditions" => ("conditions", &mut self.input),
            "limits" => ("limits", &mut self.limits),
            "dressing" => ("dressing", self.dressing.get_or_insert_with(DressingPlan::default)),
            _ => return Err(CycleReason::UnknownTable { table: table.to_owned() }),
        };
        let index = index_of(record, table, key)?;
        let field = &record.fields()[index];
        let si = quantity(value, field.unit).map_err(|reason| CycleReason::Unit { key: key.to_owned(), reason })?;
        field.check(si).map_err(CycleReason::Range)?;
        record.set_value(index, si);
        Ok(())
    }

    /// The fastest cycle on a dressed wheel.
    ///
    /// # Errors
    /// [`CycleError`].
    pub fn fastest_cycle(&self) -> Result<Cycle, CycleError> {
        fastest_cycle(&self.grinding, &State::default(), &self.input, &self.limits)
    }

    /// The dressing interval by estimated cycles, and by the exact cycle of every part; none
    /// where the file does not ask for it.
    ///
    /// # Errors
    /// [`CycleError`].
    pub fn dressing_intervals(&self) -> Result<Option<[DressingInterval; 2]>, CycleError> {
        let Some(plan) = &self.dressing else { return Ok(None) };
        let (grinding, input, limits) = (&self.grinding, &self.input, &self.limits);
        let volume = std::f64::consts::PI * grinding.parameters.work_diameter * limits.stock;
        let wheel = |removed_volume| State { removed_volume, ..State::default() };
        let most = plan.most_parts as u32;
        let estimate = |v: f64| cycle_time_estimate(grinding, &wheel(v), input, limits, plan.finish_infeed);
        let exact = |v: f64| Ok(fastest_cycle(grinding, &wheel(v), input, limits)?.time);
        Ok(Some([
            dressing_interval(estimate, volume, plan.dressing_time, most)?,
            dressing_interval(exact, volume, plan.dressing_time, most)?,
        ]))
    }
}

/// Sets the fields of `record` from `entries`.
fn fill(text: &str, table: &'static str, entries: &Entries, record: &mut dyn AnyRecord, faults: &mut Vec<CycleFault>) {
    for (key, value) in entries {
        let name = key.get_ref();
        let mut fault = |at: usize, reason| {
            let (line, column) = place(text, at);
            faults.push(CycleFault { line, column, reason });
        };
        let index = match index_of(record, table, name) {
            Ok(index) => index,
            Err(reason) => {
                fault(key.span().start, reason);
                continue;
            }
        };
        let field = &record.fields()[index];
        let start = value.span().start;
        let read = match value.get_ref() {
            Value::Number(number) => quantity(&number.to_string(), field.unit),
            Value::Quantity(text) => quantity(text, field.unit),
        };
        match read {
            // One past the opening quote.
            Err(reason) => fault(start + 1 + reason.at(), CycleReason::Unit { key: name.clone(), reason }),
            Ok(si) => match field.check(si) {
                Err(reason) => fault(start, CycleReason::Range(reason)),
                Ok(()) => {
                    record.set_value(index, si);
                }
            },
        }
    }
}

/// Index of a field by its name.
fn index_of(record: &dyn AnyRecord, table: &'static str, name: &str) -> Result<usize, CycleReason> {
    let fields = record.fields();
    fields.iter().position(|field| field.name == name).ok_or_else(|| {
        let likeness = |field: &&toolroom_process::Field| strsim::jaro_winkler(field.name, name);
        let nearest = fields.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        CycleReason::UnknownKey { table, key: name.to_owned(), nearest: nearest.map_or("", |field| field.name) }
    })
}
