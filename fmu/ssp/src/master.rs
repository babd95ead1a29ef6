//! The master: units in step, outputs handed on to inputs.
//!
//! Every unit takes steps of one length; inputs are held over a step. By [`Order::Jacobi`] all units step with the
//! outputs of the beginning of the step, so that a signal arrives one step late: the error of first order in the step
//! that the method is known for. By [`Order::GaussSeidel`] they step one after the other, and later ones are given what
//! the earlier ones just came to: a signal from an earlier unit is not late, one from a later unit is, by one step.
//!
//! # Source
//! Gomes, Thule, Broman, Larsen, Vangheluwe, Co-simulation: a survey, ACM Computing Surveys 51 (2018) 49.

use crate::error::MasterError;
use crate::loops::{Loop, loops};
use crate::package::Package;
use crate::structure::SystemStructure;
use crate::wires::{Output, Shown, Wire, outputs, shown, start_value, wires};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tempfile::TempDir;
use toolroom_fmu_import::simulate::{Done, SimulateError, checked, own_steps};
use toolroom_fmu_import::wire::start_values;
use toolroom_fmu_import::{
    Action, Answer, Driven, Instance, Isolation, ModelDescription, Port, Retaking, StartValue, StepResult, Unit,
    WiringError,
};
use toolroom_process::Wiring;
use toolroom_process::table::{Cell, CsvWriter};

/// Who steps when.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Order {
    /// All with the outputs of the beginning of the step.
    Jacobi,
    /// One after the other in the order of the file.
    #[default]
    GaussSeidel,
    /// One after the other in this order of components.
    Given(Vec<String>),
}

/// What is to be simulated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Experiment {
    /// Stop time, s; that of the package, or 1 s after its start.
    pub stop: Option<f64>,
    /// Communication step, s; the shortest one of the units' default experiments, or a five-hundredth of the time.
    pub step: Option<f64>,
}

/// The units of a package, loaded and connected.
#[derive(Debug)]
pub struct System {
    structure: SystemStructure,
    units: Vec<Arc<Unit>>,
    outputs: Vec<Vec<Output>>,
    wires: Vec<Wire>,
    /// Outputs of the system itself.
    shown: Vec<Shown>,
    loops: Vec<Loop>,
    /// Start values of each component.
    start: Vec<Vec<(Port, StartValue)>>,
}

/// Rounds in which signals are handed on before the first step (assumption: a loop that halves its error in each has
/// settled after fifty).
const MOST_ROUNDS: usize = 200;

/// Share of its greatest value by which a signal still changes that counts as settled (assumption: far above rounding,
/// far below the error of a step).
const SETTLED: f64 = 1e-12;

impl System {
    /// Loads the units of `package` where `isolation` says, and connects them. `start` has values by
    /// `component.variable`, which take the place of those of the package.
    ///
    /// # Errors
    /// [`MasterError`] of what cannot be loaded or connected.
    pub fn load(
        package: &mut Package,
        start: &BTreeMap<String, String>,
        isolation: &Isolation,
    ) -> Result<Self, MasterError> {
        let folder: TempDir =
            tempfile::Builder::new().prefix("toolroom-ssp-").tempdir().map_err(MasterError::Folder)?;
        package.unpack(folder.path())?;
        let structure = package.structure().clone();
        let mut units = Vec::new();
        let mut known: BTreeMap<(PathBuf, &str), Arc<Unit>> = BTreeMap::new();
        for component in &structure.components {
            let path = folder.path().join(&component.source);
            let driven = match component.implementation.as_str() {
                "CoSimulation" => Driven::CoSimulation,
                "ModelExchange" => Driven::ModelExchange,
                _ => Driven::Either,
            };
            let key = (path.clone(), component.implementation.as_str());
            let unit = match known.get(&key) {
                Some(unit) => Arc::clone(unit),
                None => Arc::new(
                    Unit::load_driven(&path, isolation, driven)
                        .map_err(|source| MasterError::Load { component: component.name.clone(), source })?,
                ),
            };
            known.insert(key, Arc::clone(&unit));
            units.push(unit);
        }
        let descriptions: Vec<&ModelDescription> = units.iter().map(|unit| unit.description()).collect();
        let outputs: Vec<Vec<Output>> =
            (0..units.len()).map(|index| outputs(&structure, index, descriptions[index])).collect();
        let wires = wires(&structure, &descriptions, &outputs)?;
        let start = start_values_of(package.path(), &structure, &descriptions, start)?;
        let (shown, loops) = (shown(&structure, &descriptions, &outputs)?, loops(&structure, &descriptions));
        Ok(Self { structure, units, outputs, wires, shown, loops, start })
    }

    /// Algebraic loops: signals that may determine each other at one instant, by what their units say of their outputs. They
    /// are settled before the first step, and late by a step after it.
    pub fn loops(&self) -> &[Loop] {
        &self.loops
    }

    /// The components in the order in which they step.
    fn sequence(&self, order: &Order) -> Result<Vec<usize>, MasterError> {
        let components = &self.structure.components;
        let Order::Given(names) = order else { return Ok((0..components.len()).collect()) };
        let place = |name: &String| components.iter().position(|component| component.name == *name);
        let mut sequence: Vec<usize> = names.iter().filter_map(place).collect();
        sequence.dedup();
        if sequence.len() != components.len() || names.len() != components.len() {
            let known = components.iter().map(|component| component.name.clone()).collect();
            return Err(MasterError::Order { known });
        }
        Ok(sequence)
    }

    /// Simulates the system and writes time and every output connector to `table`, a row for each communication point,
    /// in the units' own units; Booleans as 0 and 1.
    ///
    /// # Errors
    /// [`MasterError`]; rows written before stay.
    pub fn simulate(&self, experiment: &Experiment, order: &Order, table: impl Write) -> Result<Done, MasterError> {
        let sequence = self.sequence(order)?;
        let start = self.structure.start.unwrap_or(0.0);
        let stop = experiment.stop.or(self.structure.stop).unwrap_or(start + 1.0);
        let smallest = self.units.iter().filter_map(|unit| unit.description().experiment.step).reduce(f64::min);
        let step = experiment.step.or(smallest).unwrap_or((stop - start) / 500.0);
        let steps = ((stop - start) / step - 1e-9).ceil();
        if !(start.is_finite() && stop > start && step > 0.0 && steps < 1e9) {
            return Err(MasterError::Experiment { start, stop, step });
        }
        let parts = self.units.iter().enumerate().map(|(index, unit)| {
            own_steps(unit, start, stop, step)
                .map_err(|source| MasterError::Steps { component: self.name(index), source: Box::new(source) })
        });
        let parts = parts.collect::<Result<Vec<u64>, _>>()?;
        let heads = self.outputs.iter().flatten().map(|output| &output.head);
        let heads = heads.chain(self.shown.iter().map(|shown| &shown.head)).cloned();
        let written = |error: csv::Error| MasterError::Output(error.into());
        let mut table = CsvWriter::new(table, std::iter::once("time [s]".to_owned()).chain(heads)).map_err(written)?;
        let mut run = self.begin(start, parts)?;
        let mut done = Done { start, stop, step, steps: steps as u64, ended: false };
        let mut time = start;
        for number in 0..=steps as u64 {
            if number > 0 {
                // The last step ends at the stop time, however the steps round.
                let goal = if number as f64 == steps { stop } else { start + number as f64 * step };
                let before = run.values.clone();
                for &index in &sequence {
                    let seen = if *order == Order::Jacobi { &before } else { &run.values };
                    let inputs = self.inputs(index, seen);
                    let (values, ended) = run.step(self, index, &inputs, time, goal)?;
                    run.values[index] = values;
                    if let Some(end) = ended {
                        done = Done { stop: end, steps: number, ended: true, ..done };
                    }
                }
                time = if done.ended { done.stop } else { goal };
            }
            let shown = self.shown.iter().map(|shown| shown.value(&run.values));
            let row = run.values.iter().flatten().copied().chain(shown).map(Cell::from);
            table.row(std::iter::once(Cell::from(time)).chain(row)).map_err(written)?;
            if done.ended {
                break;
            }
        }
        table.flush().map_err(|error| MasterError::Output(error.into()))?;
        run.terminate(self, time)?;
        Ok(done)
    }

    /// What the wires bring to a component.
    fn inputs(&self, index: usize, values: &[Vec<f64>]) -> Vec<(Port, f64)> {
        let here = self.wires.iter().filter(|wire| wire.to == index);
        here.map(|wire| (wire.port, wire.factor * values[wire.from.0][wire.from.1] + wire.offset)).collect()
    }

    fn failed(&self, index: usize, source: SimulateError) -> MasterError {
        MasterError::Unit { component: self.name(index), source: Box::new(source) }
    }

    fn name(&self, index: usize) -> String {
        self.structure.components[index].name.clone()
    }

    /// Initialised instances with the outputs that they begin with.
    fn begin(&self, start: f64, parts: Vec<u64>) -> Result<Run, MasterError> {
        let mut run = Run { parts, ..Run::default() };
        for (index, unit) in self.units.iter().enumerate() {
            let instance = Instance::new(unit, &self.start[index], start)
                .map_err(|source| self.failed(index, SimulateError::Call { time: start, source }))?;
            run.instances.push(instance);
            run.retaking.push(Retaking::from_unit(unit));
            let values = run.act(self, index, &[], start)?;
            run.values.push(values);
        }
        // Outputs may follow inputs at once: as many rounds as the longest chain of units, and in a loop until they settle.
        let mut greatest = run.values.clone();
        for round in 0..MOST_ROUNDS {
            let mut settled = true;
            for index in 0..self.units.len() {
                let inputs = self.inputs(index, &run.values);
                let actions: Vec<Action<'_>> = inputs.iter().map(|(port, value)| Action::Set(*port, *value)).collect();
                let values = run.act(self, index, &actions, start)?;
                for ((new, old), greatest) in values.iter().zip(&run.values[index]).zip(&mut greatest[index]) {
                    *greatest = greatest.abs().max(new.abs());
                    settled &= (new - old).abs() <= SETTLED * *greatest;
                }
                run.values[index] = values;
            }
            if settled && round + 1 >= self.units.len() {
                return Ok(run);
            }
        }
        let signals = self.loops.iter().map(|each| each.signals.as_str()).collect::<Vec<_>>().join("; ");
        Err(MasterError::Loop { start, signals })
    }
}

/// Start values of each component as its unit takes them: those of the package at `path`, and over them those of `given`.
fn start_values_of(
    path: &Path,
    structure: &SystemStructure,
    descriptions: &[&ModelDescription],
    given: &BTreeMap<String, String>,
) -> Result<Vec<Vec<(Port, StartValue)>>, MasterError> {
    let components = || structure.components.iter().zip(descriptions);
    let mut own: Vec<BTreeMap<String, String>> = vec![BTreeMap::new(); descriptions.len()];
    for (name, value) in given {
        let found = structure.components.iter().zip(&mut own).find_map(|(component, own)| {
            let variable = name.strip_prefix(&component.name)?.strip_prefix('.')?;
            Some((variable, own))
        });
        let Some((variable, own)) = found else {
            let reason = "start values begin with the name of a component".to_owned();
            let system = structure.name.clone();
            return Err(MasterError::Start { place: None, system, variable: name.clone(), reason });
        };
        own.insert(variable.to_owned(), value.clone());
    }
    let mut all = Vec::new();
    for ((component, description), own) in components().zip(own) {
        let refused = |variable: &str, reason: String| {
            // The last one of a name is the one that holds; one that was given takes its place.
            let mut written = component.parameters.iter().rev().filter(|_| !own.contains_key(variable));
            let place = written.find(|parameter| parameter.name == variable);
            MasterError::Start {
                place: place.map(|parameter| format!("{}: {}:{}", path.display(), parameter.entry, parameter.line)),
                system: structure.name.clone(),
                variable: format!("{}.{variable}", component.name),
                reason,
            }
        };
        let mut values = BTreeMap::new();
        for parameter in &component.parameters {
            let value = start_value(parameter, description).map_err(|reason| refused(&parameter.name, reason))?;
            values.insert(parameter.name.clone(), value);
        }
        values.extend(own.clone());
        let wiring = Wiring { start: values, ..Wiring::default() };
        all.push(start_values(description, &wiring).map_err(|error| {
            let reason = error.to_string();
            if let WiringError::UnknownVariable { variable, .. }
            | WiringError::StartValue { variable, .. }
            | WiringError::StartCount { variable, .. }
            | WiringError::StartRange { variable, .. } = &error
            {
                return refused(variable, reason);
            }
            refused("", reason)
        })?);
    }
    Ok(all)
}

/// Instances on their way.
#[derive(Default)]
struct Run {
    instances: Vec<Instance>,
    /// Steps of a unit of fixed steps in one of communication; 1 for the others.
    parts: Vec<u64>,
    /// How steps are taken that a unit discards.
    retaking: Vec<Retaking>,
    /// The last outputs of each component.
    values: Vec<Vec<f64>>,
    answer: Answer,
}

impl Run {
    /// Does `actions` and reads every output, in one call of the unit's process.
    fn act(
        &mut self,
        system: &System,
        index: usize,
        actions: &[Action<'_>],
        time: f64,
    ) -> Result<Vec<f64>, MasterError> {
        let gets = system.outputs[index].iter().map(|output| Action::Get(output.port));
        let actions: Vec<Action<'_>> = actions.iter().copied().chain(gets).collect();
        self.instances[index]
            .act(&actions, &mut self.answer)
            .map_err(|source| system.failed(index, SimulateError::Call { time, source }))?;
        self.read(system, index, time)
    }

    /// The values of the last answer, checked.
    fn read(&self, system: &System, index: usize, time: f64) -> Result<Vec<f64>, MasterError> {
        let description = system.units[index].description();
        for (output, value) in system.outputs[index].iter().zip(&self.answer.values) {
            let variable = description.variable(&output.name);
            variable
                .map_or(Ok(()), |variable| checked(variable, *value, time))
                .map_err(|source| system.failed(index, source))?;
        }
        Ok(self.answer.values.clone())
    }

    /// Ends the simulation of every unit.
    fn terminate(&mut self, system: &System, time: f64) -> Result<(), MasterError> {
        for (index, instance) in self.instances.iter_mut().enumerate() {
            let failed = |source| system.failed(index, SimulateError::Call { time, source });
            instance.terminate().map_err(failed)?;
        }
        Ok(())
    }

    /// One communication step of a component; the time at which it ended the simulation, where it did.
    fn step(
        &mut self,
        system: &System,
        index: usize,
        inputs: &[(Port, f64)],
        time: f64,
        goal: f64,
    ) -> Result<(Vec<f64>, Option<f64>), MasterError> {
        let duration = (goal - time) / self.parts[index] as f64;
        let sets: Vec<Action<'_>> = inputs.iter().map(|(port, value)| Action::Set(*port, *value)).collect();
        let stepped = if self.parts[index] == 1 {
            let gets: Vec<Action<'_>> = system.outputs[index].iter().map(|output| Action::Get(output.port)).collect();
            let (instance, retaking) = (&mut self.instances[index], &mut self.retaking[index]);
            retaking
                .act(instance, &sets, (time, goal), &gets, &mut self.answer)
                .map_err(|source| system.failed(index, SimulateError::Call { time, source }))?
        } else {
            let steps =
                (0..self.parts[index]).map(|part| Action::Step { time: time + part as f64 * duration, duration });
            self.act(system, index, &sets.into_iter().chain(steps).collect::<Vec<_>>(), time)?;
            self.answer.stepped
        };
        match stepped {
            StepResult::Whole => Ok((self.read(system, index, time)?, None)),
            StepResult::Part(reached) => {
                let source = SimulateError::Discarded { time, step: goal - time, reached };
                Err(system.failed(index, source))
            }
            StepResult::Ended(end) => Ok((self.act(system, index, &[], end)?, Some(end))),
        }
    }
}
