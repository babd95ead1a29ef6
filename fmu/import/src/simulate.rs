//! A unit on its own: inputs from a table, outputs to a table.

use crate::description::{ModelDescription, ValueType, Variable};
use crate::instance::{Action, Answer, CallError, Instance, Port, StartValue, Stepped};
use crate::unit::Unit;
use crate::wire::{WiringError, start_values};
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
    pub start_values: std::collections::BTreeMap<String, String>,
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
    /// The unit took a part of a step only.
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
    columns: Vec<Column>,
}

#[derive(Clone, Debug, PartialEq)]
struct Column {
    port: Port,
    interpolated: bool,
    values: Vec<f64>,
}

impl Inputs {
    /// Reads a CSV table with a column `time` (s) and one for each input, headed by its name,
    /// with or without unit in brackets; the numbers are in the unit's own units.
    ///
    /// # Errors
    /// [`SimulateError::Input`] with the line.
    pub fn read(description: &ModelDescription, mut table: impl Read) -> Result<Self, SimulateError> {
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
        for name in header.iter().skip(1).map(bare) {
            let variable = description.variable(&name).filter(|variable| settable(variable)).ok_or_else(|| {
                let known = description.variables.iter().filter(|variable| settable(variable));
                let known = known.map(|variable| variable.name.as_str()).collect::<Vec<_>>().join(", ");
                refused(1, format!("the unit has no input \"{name}\"; it has: {known}"))
            })?;
            inputs.columns.push(Column {
                port: Port::of(variable),
                interpolated: variable.variability == "continuous",
                values: Vec::new(),
            });
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
                column.values.push(number(i + 1)?);
            }
        }
        if inputs.times.is_empty() {
            return Err(refused(2, "the table has no rows".to_owned()));
        }
        Ok(inputs)
    }

    /// Sets every input to its value at `time` (s).
    fn set(&self, time: f64, actions: &mut Vec<Action<'_>>) {
        // Of two rows at one time the later one holds from then on.
        let after = self.times.partition_point(|each| *each <= time);
        for column in &self.columns {
            let row = after.saturating_sub(1);
            let mut value = column.values[row];
            if column.interpolated && after > 0 && after < self.times.len() {
                let share = (time - self.times[row]) / (self.times[after] - self.times[row]);
                value += share * (column.values[after] - value);
            }
            actions.push(Action::Set(column.port, value));
        }
    }
}

fn settable(variable: &Variable) -> bool {
    variable.causality == "input" && variable.dimensions == 0 && is_number(variable)
}

fn is_number(variable: &Variable) -> bool {
    !matches!(variable.value_type, ValueType::String | ValueType::Binary | ValueType::Clock)
}

/// Simulates `unit` and writes time and every scalar output to `table`, one row for each
/// communication point, in the unit's own units.
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
    let own = description.experiment;
    let start = experiment.start.or(own.start).unwrap_or(0.0);
    let last_input = inputs.and_then(|inputs| inputs.times.last().copied());
    let stop = experiment.stop.or(last_input).or(own.stop).unwrap_or(start + 1.0);
    let step = experiment.step.or(own.step).unwrap_or((stop - start) / 500.0);
    let steps = ((stop - start) / step - 1e-9).ceil();
    if !(start.is_finite() && stop > start && step > 0.0 && steps < 1e9) {
        return Err(SimulateError::Experiment { start, stop, step });
    }
    let wiring = Wiring { start: experiment.start_values.clone(), ..Wiring::default() };
    let start_values: Vec<(Port, StartValue)> = start_values(description, &wiring)?;
    let outputs: Vec<&Variable> = description
        .variables
        .iter()
        .filter(|variable| variable.causality == "output" && variable.dimensions == 0 && is_number(variable))
        .collect();
    let header = |variable: &&Variable| match &variable.unit {
        Some(unit) if unit != "1" => format!("{} [{unit}]", variable.name),
        _ => variable.name.clone(),
    };
    let mut table = CsvWriter::new(table, std::iter::once("time [s]".to_owned()).chain(outputs.iter().map(header)))?;
    let failed = |time| move |source| SimulateError::Call { time, source };
    let mut instance = Instance::new(unit, &start_values, start).map_err(failed(start))?;
    let (mut time, mut done) = (start, Done { start, stop, step, steps: steps as u64, ended: false });
    let mut answer = Answer::default();
    let gets: Vec<Action<'_>> = outputs.iter().map(|variable| Action::Get(Port::of(variable))).collect();
    for number in 0..=steps as u64 {
        // The last step ends at the stop time, however the steps round.
        let mut goal = if number as f64 == steps { stop } else { start + number as f64 * step };
        // Step, inputs and outputs at once: a unit in a worker process is asked once.
        let mut actions = Vec::new();
        actions.extend((number > 0).then_some(Action::Step { time, duration: goal - time }));
        if let Some(inputs) = inputs {
            inputs.set(goal, &mut actions);
        }
        actions.extend(gets.iter().copied());
        if let Err(source) = instance.act(&actions, &mut answer) {
            table.flush()?;
            return Err(SimulateError::Call { time, source });
        }
        match answer.stepped {
            Stepped::Whole => {}
            Stepped::Part(reached) => {
                table.flush()?;
                return Err(SimulateError::Discarded { time, step: goal - time, reached });
            }
            Stepped::Ended(end) => {
                done = Done { stop: end, steps: number, ended: true, ..done };
                goal = end;
                instance.act(&gets, &mut answer).map_err(failed(end))?;
            }
        }
        time = goal;
        if let Err(refused) = outputs.iter().zip(&answer.values).try_for_each(|(of, value)| check(of, *value, time)) {
            table.flush()?;
            return Err(refused);
        }
        table.row(std::iter::once(time).chain(answer.values.iter().copied()).map(Cell::from).collect::<Vec<_>>())?;
        if done.ended {
            break;
        }
    }
    table.flush()?;
    Ok(done)
}

/// That a value is finite and within the bounds of its description.
fn check(variable: &Variable, value: f64, time: f64) -> Result<(), SimulateError> {
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
