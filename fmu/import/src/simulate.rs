//! A unit on its own: inputs from a table, outputs to a table.

use crate::description::{ModelDescription, ValueType, Variable};
use crate::instance::{Action, Answer, CallError, Instance, Port, StartValue, StepResult, bytes_of};
use crate::parts::Retaking;
use crate::unit::{Steps, Unit};
use crate::wire::{WiringError, start_values};
use std::collections::BTreeMap;
use std::ffi::CString;
use std::io::{Read, Write};
use std::sync::Arc;
use toolroom_process::Wiring;
use toolroom_process::table::{Cell, CsvWriter, broken_quote};

/// What is to be simulated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Experiment {
    /// Start time, s; the unit's own, or 0.
    pub start: Option<f64>,
    /// Stop time, s; the unit's own, the last time of the inputs, or 1.
    pub stop: Option<f64>,
    /// Communication step, s; the unit's own, or a five-hundredth of the time.
    pub step: Option<f64>,
    /// Start values by name, as text.
    pub start_values: BTreeMap<String, String>,
}

/// What came of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Done {
    /// Start, stop and step, s, as used.
    pub start: f64,
    /// Stop time, s.
    pub stop: f64,
    /// Communication step, s; the last one may be shorter.
    pub step: f64,
    /// Steps taken.
    pub steps: u64,
    /// Whether the unit ended the simulation, at `stop`.
    pub ended: bool,
}

/// Why a simulation did not reach its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// The table of inputs.
    #[error("inputs, line {line}: {message}")]
    Input {
        /// Line, from 1.
        line: u64,
        /// What is wrong.
        message: String,
    },
    /// Start, stop and step that give no simulation.
    #[error("from {start} s to {stop} s in steps of {step} s there is nothing to simulate")]
    Experiment {
        /// Start time, s.
        start: f64,
        /// Stop time, s.
        stop: f64,
        /// Step, s.
        step: f64,
    },
    /// Steps that a unit of fixed steps cannot take.
    #[error("the unit takes steps of {own} s only: {what} = {value} s is no multiple of it")]
    FixedStep {
        /// Its step, s.
        own: f64,
        /// What is none.
        what: &'static str,
        /// Its value, s.
        value: f64,
    },
    /// A start value.
    #[error(transparent)]
    StartValue(#[from] WiringError),
    /// The unit failed; what is written up to `time` stands.
    #[error("at {time} s: {source}")]
    Call {
        /// Time of the last row, s.
        time: f64,
        /// The call.
        source: CallError,
    },
    /// The unit took a part of a step only, and none of the rest in parts.
    #[error("the unit discarded the step from {time} s over {step} s and came to {reached} s: give a shorter --step")]
    Discarded {
        /// Start of the step, s.
        time: f64,
        /// Its length, s.
        step: f64,
        /// Where it came to, s.
        reached: f64,
    },
    /// A value that cannot be.
    #[error("at {time} s: {variable} = {value}, {rule}")]
    Value {
        /// Time, s.
        time: f64,
        /// The output.
        variable: String,
        /// Its value, in its own unit.
        value: f64,
        /// What it breaks.
        rule: String,
    },
    /// The results cannot be written.
    #[error("the results cannot be written: {0}")]
    Output(#[from] csv::Error),
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
    /// Reads a CSV table with a column `time` (s) and one for each input, headed by its name,
    /// with or without unit in brackets; the numbers are in the unit's own units, strings are taken as they are. Arrays
    /// have a column for each element, `name[1]` or `name[2,1]`; their sizes may depend on `start` values.
    ///
    /// # Errors
    /// [`SimulateError::Input`] with the line.
    pub fn read(
        description: &ModelDescription,
        start: &BTreeMap<String, String>,
        mut table: impl Read,
    ) -> Result<Self, SimulateError> {
        let refused = |line, message: String| SimulateError::Input { line, message };
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
        let bare = |name: &str| {
            let name = name.trim_start_matches('\u{FEFF}');
            name.rsplit_once(" [").map_or(name, |(name, _)| name).to_owned()
        };
        if header.get(0).map(bare).as_deref() != Some("time") {
            return Err(refused(1, "the first column is \"time\", in seconds".to_owned()));
        }
        let mut inputs = Self::default();
        let heads: Vec<String> = header.iter().skip(1).map(bare).collect();
        let settable: Vec<(&Variable, Vec<String>)> = description
            .variables
            .iter()
            .filter(|variable| variable.causality == "input" && !variable.clocked)
            .filter(|variable| is_number(variable) || is_text(variable))
            .filter_map(|variable| Some((variable, elements(description, variable, start)?)))
            .collect();
        let known = || settable.iter().flat_map(|(_, names)| names);
        if let Some(name) = heads.iter().find(|name| known().all(|known| known != *name)) {
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
            let time = number(0)?;
            if inputs.times.last().is_some_and(|last| time < *last) {
                return Err(refused(line, format!("time goes back to {time} s")));
            }
            inputs.times.push(time);
            for (i, column) in inputs.columns.iter_mut().enumerate() {
                match column {
                    Column::Numbers(numbers) => numbers.push(number(i + 1)?),
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

    /// Values of every input at `time` (s).
    fn values(&self, time: f64) -> Vec<(Port, Vec<u8>)> {
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

/// Names of the elements of `variable`: its own name for a scalar, `name[i,j]` from 1 for an array.
fn elements(
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

/// An output of a unit and its columns.
struct Output<'a> {
    variable: &'a Variable,
    action: Action<'static>,
    names: Vec<String>,
}

/// Outputs that a table can hold; those that it cannot are binary, clocks and what has a value only while one of them
/// ticks, or arrays of unknown size.
fn outputs<'a>(description: &'a ModelDescription, start: &BTreeMap<String, String>) -> Vec<Output<'a>> {
    let wanted = |variable: &&Variable| {
        variable.causality == "output"
            && !variable.clocked
            && !matches!(variable.value_type, ValueType::Binary | ValueType::Clock)
    };
    let output = |variable: &'a Variable| {
        let names = elements(description, variable, start)?;
        let port = Port { count: names.len() as u32, ..Port::from_variable(variable) };
        let action = if is_number(variable) { Action::Get(port) } else { Action::GetText(port) };
        Some(Output { variable, action, names })
    };
    description.variables.iter().filter(wanted).filter_map(output).collect()
}

/// Start values by name from texts of the form `name=value`.
///
/// # Errors
/// Which text is not of that form.
pub fn named_values(texts: &[String]) -> Result<BTreeMap<String, String>, String> {
    let named = |text: &String| {
        let (name, value) = text.split_once('=').ok_or_else(|| format!("`{text}` is not of the form name=value"))?;
        Ok((name.to_owned(), value.to_owned()))
    };
    texts.iter().map(named).collect()
}

/// Names of the outputs of `description` that [`simulate`] leaves out: binary ones, clocks and what belongs to them, and
/// arrays whose size cannot be known.
pub fn left_out(description: &ModelDescription, start: &BTreeMap<String, String>) -> Vec<String> {
    let held: Vec<&str> = outputs(description, start).iter().map(|output| output.variable.name.as_str()).collect();
    let all = description.variables.iter().filter(|variable| variable.causality == "output");
    all.filter(|variable| !held.contains(&variable.name.as_str())).map(|variable| variable.name.clone()).collect()
}

/// How many of the unit's own steps make one of `step` (s): 1 where it takes any.
///
/// # Errors
/// [`SimulateError::FixedStep`] where `step` or the time from `start` to `stop` is no multiple of its own step.
pub fn own_steps(unit: &Unit, start: f64, stop: f64, step: f64) -> Result<u64, SimulateError> {
    let Steps::Every(own) = unit.steps() else { return Ok(1) };
    let whole = |value: f64| (value / own - (value / own).round()).abs() < 1e-9 * (value / own);
    for (what, length, value) in [("--step", step, step), ("--stop", stop - start, stop)] {
        if !whole(length) {
            return Err(SimulateError::FixedStep { own, what, value });
        }
    }
    Ok((step / own).round() as u64)
}

fn is_text(variable: &Variable) -> bool {
    variable.value_type == ValueType::String
}

fn is_number(variable: &Variable) -> bool {
    !matches!(variable.value_type, ValueType::String | ValueType::Binary | ValueType::Clock)
}

/// Simulates `unit` and writes time and every output to `table`, one row for each communication point and one column for
/// each element, in the unit's own units; Booleans as 0 and 1, enumerations as numbers. What [`left_out`] names is left
/// out. A unit of fixed steps takes as many of its own as a communication step holds; a step that a unit discards is taken
/// in parts.
///
/// # Errors
/// [`SimulateError`]; rows written before stay.
pub fn simulate(
    unit: &Arc<Unit>,
    experiment: &Experiment,
    inputs: Option<&Inputs>,
    table: impl Write,
) -> Result<Done, SimulateError> {
    let description = unit.description();
    let default = description.experiment;
    let start = experiment.start.or(default.start).unwrap_or(0.0);
    let last_input = inputs.and_then(|inputs| inputs.times.last().copied());
    let stop = experiment.stop.or(last_input).or(default.stop).unwrap_or(start + 1.0);
    let fixed = if let Steps::Every(step) = unit.steps() { Some(step) } else { None };
    let step = experiment.step.or(default.step).or(fixed).unwrap_or((stop - start) / 500.0);
    let steps = ((stop - start) / step - 1e-9).ceil();
    if !(start.is_finite() && stop > start && step > 0.0 && steps < 1e9) {
        return Err(SimulateError::Experiment { start, stop, step });
    }
    let wiring = Wiring { start: experiment.start_values.clone(), ..Wiring::default() };
    let start_values: Vec<(Port, StartValue)> = start_values(description, &wiring)?;
    let parts = own_steps(unit, start, stop, step)?;
    let outputs = outputs(description, &experiment.start_values);
    let header = |output: &Output<'_>| {
        let unit = output.variable.unit.as_ref().filter(|unit| *unit != "1");
        let unit = unit.map_or(String::new(), |unit| format!(" [{unit}]"));
        output.names.iter().map(|name| format!("{name}{unit}")).collect::<Vec<_>>()
    };
    let heads = std::iter::once("time [s]".to_owned()).chain(outputs.iter().flat_map(header));
    let mut table = CsvWriter::new(table, heads)?;
    let failed = |time| move |source| SimulateError::Call { time, source };
    let mut instance = Instance::new(unit, &start_values, start).map_err(failed(start))?;
    let (mut time, mut done) = (start, Done { start, stop, step, steps: steps as u64, ended: false });
    let (mut answer, mut retaking) = (Answer::default(), Retaking::from_unit(unit));
    let gets: Vec<Action<'_>> = outputs.iter().map(|output| output.action).collect();
    for number in 0..=steps as u64 {
        // The last step ends at the stop time, however the steps round.
        let mut goal = if number as f64 == steps { stop } else { start + number as f64 * step };
        // Step, inputs and outputs at once: a unit in a worker process is asked once.
        let mut actions = Vec::new();
        let set = inputs.map_or_else(Vec::new, |inputs| inputs.values(goal));
        let after = set.iter().map(|(port, elements)| Action::SetArray(*port, elements)).chain(gets.iter().copied());
        let stepped = if number > 0 && parts == 1 {
            let after: Vec<Action<'_>> = after.collect();
            retaking.act(&mut instance, &[], (time, goal), &after, &mut answer)
        } else {
            let part = (goal - time) / parts as f64;
            let steps = (0..parts).filter(|_| number > 0);
            actions.extend(steps.map(|i| Action::Step { time: time + i as f64 * part, duration: part }));
            actions.extend(after);
            instance.act(&actions, &mut answer).map(|()| answer.stepped)
        };
        let stepped = match stepped {
            Ok(stepped) => stepped,
            Err(source) => {
                table.flush()?;
                return Err(SimulateError::Call { time, source });
            }
        };
        match stepped {
            StepResult::Whole => {}
            StepResult::Part(reached) => {
                table.flush()?;
                return Err(SimulateError::Discarded { time, step: goal - time, reached });
            }
            StepResult::Ended(end) => {
                done = Done { stop: end, steps: number, ended: true, ..done };
                goal = end;
                instance.act(&gets, &mut answer).map_err(failed(end))?;
            }
        }
        time = goal;
        match cells(&outputs, &answer, time) {
            Ok(cells) => table.row(cells)?,
            Err(refused) => {
                table.flush()?;
                return Err(refused);
            }
        }
        if done.ended {
            break;
        }
    }
    table.flush()?;
    instance.terminate().map_err(failed(time))?;
    Ok(done)
}

/// A row of the table.
fn cells<'a>(outputs: &[Output<'_>], answer: &'a Answer, time: f64) -> Result<Vec<Cell<'a>>, SimulateError> {
    let (mut values, mut texts) = (answer.values.iter(), answer.texts.iter());
    let mut row = vec![Cell::from(time)];
    for output in outputs {
        let count = output.names.len();
        if let Action::GetText(_) = output.action {
            row.extend(texts.by_ref().take(count).map(Cell::from));
            continue;
        }
        for value in values.by_ref().take(count) {
            checked(output.variable, *value, time)?;
            row.push(Cell::from(*value));
        }
    }
    Ok(row)
}

/// That a value is finite and within the bounds of its description.
///
/// # Errors
/// [`SimulateError::Value`] with `time` (s).
pub fn checked(variable: &Variable, value: f64, time: f64) -> Result<(), SimulateError> {
    let (min, max) = (variable.min.unwrap_or(f64::NEG_INFINITY), variable.max.unwrap_or(f64::INFINITY));
    let rule = if !value.is_finite() {
        "which is no finite number".to_owned()
    } else if value < min || value > max {
        format!("outside {min} to {max} of its description")
    } else {
        return Ok(());
    };
    Err(SimulateError::Value { time, variable: variable.name.clone(), value, rule })
}
