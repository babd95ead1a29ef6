//! A unit on its own: inputs from a table, outputs to a table.

use crate::description::{ModelDescription, ValueType, Variable};
use crate::inputs::{elements, is_number};
use crate::instance::{Action, Answer, CallError, Instance, Port, StartValue, StepResult};
use crate::parts::Retaking;
use crate::unit::{Steps, Unit};
use crate::wire::{WiringError, start_values};
use std::collections::BTreeMap;
use std::io::Write;
use std::sync::Arc;
use toolroom_process::Wiring;
use toolroom_process::table::{Cell, CsvWriter};

pub use crate::inputs::{InputError, Inputs};

/// What is to be simulated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Experiment {
    /// Start time, s; the unit's own, or 0.
    pub start: Option<f64>,
    /// Stop time, s; the unit's own, the last time of the inputs, or 1.
    pub stop: Option<f64>,
    /// Communication step, s; that of the default experiment where the unit takes it, the unit's own, or a five-hundredth of the time.
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
    #[error(transparent)]
    Input(#[from] InputError),
    /// More steps than anybody waits for.
    #[error(
        "from {start} s to {stop} s in steps of {step} s there are {steps:e} steps, at most 1e9 are taken: give a longer --step or an earlier --stop"
    )]
    Steps {
        /// Start time, s.
        start: f64,
        /// Stop time, s.
        stop: f64,
        /// Step, s.
        step: f64,
        /// Number of steps.
        steps: f64,
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

/// Whether `length` is a multiple of `own` but for rounding.
fn is_multiple(length: f64, own: f64) -> bool {
    (length / own - (length / own).round()).abs() < 1e-9 * (length / own)
}

/// How many of the unit's own steps make one of `step` (s): 1 where it takes any.
///
/// # Errors
/// [`SimulateError::FixedStep`] where `step` or the time from `start` to `stop` is no multiple of its own step.
pub fn own_steps(unit: &Unit, start: f64, stop: f64, step: f64) -> Result<u64, SimulateError> {
    let Steps::Every(own) = unit.steps() else { return Ok(1) };
    for (what, length, value) in [("--step", step, step), ("--stop", stop - start, stop)] {
        if !is_multiple(length, own) {
            return Err(SimulateError::FixedStep { own, what, value });
        }
    }
    Ok((step / own).round() as u64)
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
    let last_input = inputs.and_then(Inputs::end);
    let stop = experiment.stop.or(last_input).or(default.stop).unwrap_or(start + 1.0);
    let fixed = if let Steps::Every(step) = unit.steps() { Some(step) } else { None };
    // The step of the default experiment is a wish, that of the unit a condition.
    let wished = default.step.filter(|step| fixed.is_none_or(|own| is_multiple(*step, own)));
    let step = experiment.step.or(wished).or(fixed).unwrap_or((stop - start) / 500.0);
    let steps = ((stop - start) / step - 1e-9).ceil();
    if !(start.is_finite() && stop > start && step > 0.0) {
        return Err(SimulateError::Experiment { start, stop, step });
    }
    if steps >= 1e9 {
        return Err(SimulateError::Steps { start, stop, step, steps });
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
    let [min, max] = variable.bounds();
    let rule = if !value.is_finite() {
        "which is no finite number".to_owned()
    } else if value < min || value > max {
        format!("outside {min} to {max} of its description")
    } else {
        return Ok(());
    };
    Err(SimulateError::Value { time, variable: variable.name.clone(), value, rule })
}
