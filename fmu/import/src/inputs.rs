//! A table of input values over time, in the unit's own units.

use crate::description::{BaseUnit, ModelDescription, ValueType, Variable};
use crate::instance::{Port, bytes_of};
use std::collections::BTreeMap;
use std::ffi::CString;
use std::io::Read;
use toolroom_process::table::broken_quote;
use toolroom_process::unit;

/// Why a table of inputs cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("inputs, line {line}: {message}")]
pub struct InputError {
    /// Line, from 1.
    pub line: u64,
    /// What is wrong.
    pub message: String,
}

/// Values of input variables over time: reals are interpolated, all else is held.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inputs {
    times: Vec<f64>,
    signals: Vec<Signal>,
    /// Values of each column after the time.
    columns: Vec<Column>,
}

/// The values of a column.
#[derive(Clone, Debug, PartialEq)]
enum Column {
    Numbers(Vec<f64>),
    /// Each with a zero byte behind it.
    Texts(Vec<CString>),
}

/// A variable and its columns, one for each element.
#[derive(Clone, Debug, PartialEq)]
struct Signal {
    port: Port,
    interpolated: bool,
    columns: Vec<usize>,
}

impl Inputs {
    /// Reads a CSV table with a column `time` and one for each input, headed by its name, with or without unit in brackets:
    /// without one the time is in s and the numbers in the unit's own units, strings are taken as they are. Arrays
    /// have a column for each element, `name[1]` or `name[2,1]`; their sizes may depend on `start` values.
    ///
    /// # Errors
    /// [`InputError`] with the line.
    pub fn read(
        description: &ModelDescription,
        start: &BTreeMap<String, String>,
        mut table: impl Read,
    ) -> Result<Self, InputError> {
        let refused = |line, message: String| InputError { line, message };
        let mut text = String::new();
        table.read_to_string(&mut text).map_err(|error| refused(1, error.to_string()))?;
        if let Some(fault) = broken_quote(&text, b',') {
            return Err(refused(fault.line() as u64, fault.to_string()));
        }
        let broken = |error: csv::Error| {
            let line = error.position().map_or(1, csv::Position::line);
            refused(line, error.to_string())
        };
        let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes());
        let header = reader.headers().map_err(broken)?.clone();
        let mut all = header.iter().map(Head::read);
        let clock = all.next().filter(|head| head.name == "time");
        let clock = clock.ok_or_else(|| {
            refused(1, "the first column is \"time\", in seconds or with its unit in brackets".to_owned())
        })?;
        let clock = clock.conversion("s", None, false).map_err(|message| refused(1, message))?;
        let mut inputs = Self::default();
        let units: Vec<Head> = all.collect();
        let heads: Vec<&str> = units.iter().map(|head| head.name.as_str()).collect();
        if let Some(twice) = (1..heads.len()).find(|i| heads[..*i].contains(&heads[*i])) {
            return Err(refused(1, format!("the column \"{}\" stands twice", heads[twice])));
        }
        let settable: Vec<(&Variable, Vec<String>)> = description
            .variables
            .iter()
            .filter(|variable| variable.causality == "input" && !variable.clocked)
            .filter(|variable| is_number(variable) || is_text(variable))
            .filter_map(|variable| Some((variable, elements(description, variable, start)?)))
            .collect();
        let known = || settable.iter().flat_map(|(_, names)| names);
        if let Some(name) = heads.iter().find(|name| known().all(|known| known != **name)) {
            let known = known().map(String::as_str).take(40).collect::<Vec<_>>().join(", ");
            return Err(refused(1, format!("the unit has no input \"{name}\"; it has: {known}")));
        }
        for (variable, names) in &settable {
            let columns: Vec<Option<usize>> =
                names.iter().map(|name| heads.iter().position(|head| head == name)).collect();
            if columns.iter().all(Option::is_none) {
                continue;
            }
            if let Some(i) = columns.iter().position(Option::is_none) {
                return Err(refused(1, format!("a column \"{}\" is missing: an array is set as a whole", names[i])));
            }
            inputs.signals.push(Signal {
                port: Port { count: names.len() as u32, ..Port::from_variable(variable) },
                interpolated: variable.variability == "continuous",
                columns: columns.into_iter().flatten().collect(),
            });
        }
        inputs.columns = vec![Column::Numbers(Vec::new()); heads.len()];
        let mut takes: Vec<Option<Takes<'_>>> = vec![None; heads.len()];
        for (variable, names) in settable.iter().filter(|(variable, _)| is_number(variable)) {
            let own = variable.unit.as_deref().unwrap_or("1");
            let base = description.units.get(own).and_then(|unit| unit.base);
            for column in (0..heads.len()).filter(|column| names.iter().any(|name| name == heads[*column])) {
                let conversion =
                    units[column].conversion(own, base, variable.relative).map_err(|message| refused(1, message))?;
                takes[column] = Some(Takes { variable, conversion });
            }
        }
        for signal in inputs.signals.iter().filter(|signal| signal.port.value_type == ValueType::String) {
            signal.columns.iter().for_each(|column| inputs.columns[*column] = Column::Texts(Vec::new()));
        }
        for record in reader.records() {
            let record = record.map_err(broken)?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |at: usize| {
                let text = record.get(at).unwrap_or_default();
                let value = match text {
                    "true" => Some(1.0),
                    "false" => Some(0.0),
                    text => text.parse::<f64>().ok().filter(|value| value.is_finite()),
                };
                value.ok_or_else(|| refused(line, format!("\"{text}\" is no number")))
            };
            let time = clock.of(number(0)?);
            if inputs.times.last().is_some_and(|last| time < *last) {
                return Err(refused(line, format!("time goes back to {time} s")));
            }
            inputs.times.push(time);
            for (i, column) in inputs.columns.iter_mut().enumerate() {
                match column {
                    Column::Numbers(numbers) => {
                        let value = number(i + 1)?;
                        let taken = takes[i].as_ref().map_or(Ok(value), |takes| takes.value(value));
                        numbers.push(taken.map_err(|message| refused(line, message))?);
                    }
                    Column::Texts(texts) => {
                        let text = CString::new(record.get(i + 1).unwrap_or_default());
                        texts.push(text.map_err(|_| refused(line, "a text with a zero byte".to_owned()))?);
                    }
                }
            }
        }
        if inputs.times.is_empty() {
            return Err(refused(2, "the table has no rows".to_owned()));
        }
        Ok(inputs)
    }

    /// The last time, s.
    pub(crate) fn end(&self) -> Option<f64> {
        self.times.last().copied()
    }

    /// Values of every input at `time` (s).
    pub(crate) fn values(&self, time: f64) -> Vec<(Port, Vec<u8>)> {
        // Of two rows at one time the later one holds from then on.
        let after = self.times.partition_point(|each| *each <= time);
        let row = after.saturating_sub(1);
        let value = |signal: &Signal, values: &[f64]| {
            if signal.interpolated && after > 0 && after < self.times.len() {
                let share = (time - self.times[row]) / (self.times[after] - self.times[row]);
                return values[row] + share * (values[after] - values[row]);
            }
            values[row]
        };
        let bytes = |signal: &Signal, column: &usize| match &self.columns[*column] {
            Column::Numbers(numbers) => bytes_of(&[value(signal, numbers)]),
            Column::Texts(texts) => texts[row].to_bytes_with_nul().to_vec(),
        };
        let elements =
            |signal: &Signal| -> Vec<u8> { signal.columns.iter().flat_map(|column| bytes(signal, column)).collect() };
        self.signals.iter().map(|signal| (signal.port, elements(signal))).collect()
    }
}

/// The head of a column.
struct Head {
    name: String,
    /// Unit in brackets.
    unit: Option<String>,
}

impl Head {
    fn read(text: &str) -> Self {
        let text = text.trim_start_matches('\u{FEFF}');
        match text.strip_suffix(']').and_then(|text| text.rsplit_once(" [")) {
            Some((name, unit)) => {
                let unit = Some(unit.trim()).filter(|unit| !matches!(*unit, "" | "-"));
                Self { name: name.trim().to_owned(), unit: unit.map(str::to_owned) }
            }
            None => Self { name: text.to_owned(), unit: None },
        }
    }

    /// From the unit of the column to `own`, whose meaning is `base` where the description says it; without offset of
    /// what is `relative`.
    fn conversion(&self, own: &str, base: Option<BaseUnit>, relative: bool) -> Result<Conversion, String> {
        let Some(unit) = self.unit.as_deref().filter(|unit| *unit != own) else { return Ok(Conversion::NONE) };
        let by_name = |unit: &str| unit::parse(unit).ok().map(BaseUnit::from_unit);
        let read = by_name(unit).zip(base.or_else(|| by_name(own)));
        let (factor, offset) = read.and_then(|(read, own)| read.conversion(own)).ok_or_else(|| {
            let name = &self.name;
            format!("the column \"{name}\" is in {unit}, which is no unit of {own}: give it in {own}, or in a unit that can be converted")
        })?;
        Ok(Conversion { factor, offset: if relative { 0.0 } else { offset } })
    }
}

/// From one unit to another.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Conversion {
    factor: f64,
    offset: f64,
}

impl Conversion {
    const NONE: Self = Self { factor: 1.0, offset: 0.0 };

    fn of(self, value: f64) -> f64 {
        if self == Self::NONE { value } else { self.factor * value + self.offset }
    }
}

/// What a column of numbers sets.
#[derive(Clone, Copy)]
struct Takes<'a> {
    variable: &'a Variable,
    conversion: Conversion,
}

impl Takes<'_> {
    /// A number of the table in the unit of the variable.
    fn value(&self, read: f64) -> Result<f64, String> {
        let (value, variable) = (self.conversion.of(read), self.variable);
        if !variable.value_type.holds(value) {
            return Err(format!(
                "{value} is no value of \"{}\", which is of type {}",
                variable.name, variable.value_type
            ));
        }
        let [min, max] = variable.bounds();
        // A bound in another unit is met to rounding.
        let slack = |bound: f64| 1e-12 * value.abs().max(bound.abs()).max(self.conversion.offset.abs());
        if value < min - slack(min) || value > max + slack(max) {
            return Err(format!("{value} is outside {min} to {max}, which \"{}\" admits", variable.name));
        }
        Ok(value)
    }
}

/// Names of the elements of `variable`: its own name for a scalar, `name[i,j]` from 1 for an array.
pub(crate) fn elements(
    description: &ModelDescription,
    variable: &Variable,
    start: &BTreeMap<String, String>,
) -> Option<Vec<String>> {
    let extents = description.extents(variable, start)?;
    if extents.is_empty() {
        return Some(vec![variable.name.clone()]);
    }
    let name = |element: u64| {
        let mut rest = element;
        let mut index: Vec<String> = Vec::new();
        for extent in extents.iter().rev() {
            index.push((rest % extent + 1).to_string());
            rest /= extent;
        }
        index.reverse();
        format!("{}[{}]", variable.name, index.join(","))
    };
    Some((0..extents.iter().product()).map(name).collect())
}

fn is_text(variable: &Variable) -> bool {
    variable.value_type == ValueType::String
}

pub(crate) fn is_number(variable: &Variable) -> bool {
    !matches!(variable.value_type, ValueType::String | ValueType::Binary | ValueType::Clock)
}
