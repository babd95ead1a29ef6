//! The master: units in step, outputs handed on to inputs.
//!
//! Every unit takes steps of one length; inputs are held over a step. By [`Order::Jacobi`] all units step with the
//! outputs of the beginning of the step, so that a signal arrives one step late: the error of first order in the step
//! that the method is known for. By [`Order::GaussSeidel`] they step one after the other, and later ones are given what
//! the earlier ones just came to: a signal from an earlier unit is not late, one from a later unit is, by one step.
//!
//! # Source
//! Gomes, Thule, Broman, Larsen, Vangheluwe, Co-simulation: a survey, ACM Computing Surveys 51 (2018) 49.

use crate::package::{Package, SspError};
use crate::structure::SystemStructure;
use crate::wires::{Output, Wire, outputs, start_value, wires};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use tempfile::TempDir;
use toolroom_fmu_import::simulate::{Done, SimulateError, checked, own_steps};
use toolroom_fmu_import::wire::start_values;
use toolroom_fmu_import::{
    Action, Answer, ArchiveError, Driven, Instance, Isolation, LoadError, ModelDescription, Port, Retaking, StepResult,
    Unit,
};
use toolroom_process::Wiring;
use toolroom_process::table::{Cell, CsvWriter};

/// Why a system does not run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MasterError {
    /// The package.
    #[error(transparent)]
    Package(#[from] SspError),
    /// The package cannot be unpacked.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// No place for its units.
    #[error("the units cannot be unpacked: {0}")]
    Folder(std::io::Error),
    /// A unit that cannot be loaded.
    #[error("{component}: {source}")]
    Load {
        /// Component.
        component: String,
        /// Why.
        source: LoadError,
    },
    /// A start value that its unit does not take.
    #[error("{component}.{variable}: {reason}")]
    Start {
        /// Component.
        component: String,
        /// Variable.
        variable: String,
        /// Why.
        reason: String,
    },
    /// A connection that carries no signal.
    #[error("{connection}: {reason}")]
    Connection {
        /// Both ends.
        connection: String,
        /// Why.
        reason: String,
    },
    /// A component that is not there, or twice, in an order of units.
    #[error("the order of units has to name each of them once: {}", .known.join(", "))]
    Order {
        /// The components.
        known: Vec<String>,
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
    /// A unit that failed; rows before stand.
    #[error("{component}: {source}")]
    Unit {
        /// Component.
        component: String,
        /// Time and call.
        source: SimulateError,
    },
    /// The results cannot be written.
    #[error("the results cannot be written: {0}")]
    Output(Box<dyn std::error::Error + Send + Sync>),
}

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
    /// Start values by name, of each component.
    start: Vec<BTreeMap<String, String>>,
}

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
        let mut values: Vec<BTreeMap<String, String>> = Vec::new();
        for (component, unit) in structure.components.iter().zip(&units) {
            let mut given = BTreeMap::new();
            for parameter in &component.parameters {
                let value = start_value(parameter, unit.description()).map_err(|reason| MasterError::Start {
                    component: component.name.clone(),
                    variable: parameter.name.clone(),
                    reason,
                })?;
                given.insert(parameter.name.clone(), value);
            }
            values.push(given);
        }
        for (name, value) in start {
            let found = structure.components.iter().zip(&mut values).find_map(|(component, values)| {
                let variable = name.strip_prefix(&component.name)?.strip_prefix('.')?;
                Some((variable, values))
            });
            let Some((variable, values)) = found else {
                return Err(MasterError::Start {
                    component: structure.name.clone(),
                    variable: name.clone(),
                    reason: "start values begin with the name of a component".to_owned(),
                });
            };
            values.insert(variable.to_owned(), value.clone());
        }
        Ok(Self { structure, units, outputs, wires, start: values })
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
        let heads = self.outputs.iter().flatten().map(|output| output.head.clone());
        let written = |error: csv::Error| MasterError::Output(error.into());
        let mut table = CsvWriter::new(table, std::iter::once("time [s]".to_owned()).chain(heads)).map_err(written)?;
        let mut run = self.begin(start, stop, step)?;
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
            let row = run.values.iter().flatten().map(|value| Cell::from(*value));
            table.row(std::iter::once(Cell::from(time)).chain(row)).map_err(written)?;
            if done.ended {
                break;
            }
        }
        table.flush().map_err(|error| MasterError::Output(error.into()))?;
        Ok(done)
    }

    /// What the wires bring to a component.
    fn inputs(&self, index: usize, values: &[Vec<f64>]) -> Vec<(Port, f64)> {
        let here = self.wires.iter().filter(|wire| wire.to == index);
        here.map(|wire| (wire.port, wire.factor * values[wire.from.0][wire.from.1] + wire.offset)).collect()
    }

    fn failed(&self, index: usize, source: SimulateError) -> MasterError {
        MasterError::Unit { component: self.structure.components[index].name.clone(), source }
    }

    /// Initialised instances with the outputs that they begin with.
    fn begin(&self, start: f64, stop: f64, step: f64) -> Result<Run, MasterError> {
        let mut run = Run::default();
        for (index, unit) in self.units.iter().enumerate() {
            run.parts.push(own_steps(unit, start, stop, step).map_err(|source| self.failed(index, source))?);
            let wiring = Wiring { start: self.start[index].clone(), ..Wiring::default() };
            let values = start_values(unit.description(), &wiring)
                .map_err(|error| self.failed(index, SimulateError::StartValue(error)))?;
            let instance = Instance::new(unit, &values, start)
                .map_err(|source| self.failed(index, SimulateError::Call { time: start, source }))?;
            run.instances.push(instance);
            run.retaking.push(Retaking::from_unit(unit));
            let values = run.act(self, index, &[], start)?;
            run.values.push(values);
        }
        // Outputs may follow inputs at once: as many rounds as the longest chain of units.
        for _ in 0..self.units.len() {
            for index in 0..self.units.len() {
                let inputs = self.inputs(index, &run.values);
                let actions: Vec<Action<'_>> = inputs.iter().map(|(port, value)| Action::Set(*port, *value)).collect();
                run.values[index] = run.act(self, index, &actions, start)?;
            }
        }
        Ok(run)
    }
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
