//! `toolroom fmu sim F.fmu`.

use super::{refused, seconds};
use crate::args::{FmuInterface, FmuIsolation, FmuSimArgs, UnitRunArgs};
use crate::failure::Failure;
use crate::speak::Voice;
use serde_json::json;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toolroom_fmu_import::simulate::{Done, Experiment, Inputs, SimulateError, left_out, named_values, simulate};
use toolroom_fmu_import::{Driven, Isolation, LoadError, Unit};
use toolroom_output::Files;
use toolroom_process::UnitIsolation;

pub fn run(args: &FmuSimArgs, voice: &Voice) -> Result<(), Failure> {
    let files = Files::new(std::iter::once(args.file.as_path()).chain(args.input.as_deref()), voice.force);
    let driven = match args.interface {
        None => Driven::Either,
        Some(FmuInterface::CoSimulation) => Driven::CoSimulation,
        Some(FmuInterface::ModelExchange) => Driven::ModelExchange,
    };
    let run = UnitRun(&args.run);
    run.check(&files, voice)?;
    let unit = Unit::load_driven(&args.file, &run.isolation()?, driven).map_err(not_loaded)?;
    let unit = Arc::new(unit);
    let experiment = Experiment {
        start: None,
        stop: seconds("--stop", args.run.stop.as_deref())?,
        step: seconds("--step", args.run.step.as_deref())?,
        start_values: run.start_values()?,
    };
    let inputs = args.input.as_deref().map(|path| inputs(&unit, &experiment.start_values, path)).transpose()?;
    let left_out = left_out(unit.description(), &experiment.start_values);
    if !left_out.is_empty() {
        voice.say(format_args!("left out, since no table can hold it: {}", left_out.join(", ")));
    }
    let clocks: Vec<&str> = unit.description().clocks().map(|clock| clock.name.as_str()).collect();
    if !clocks.is_empty() {
        voice.say(format_args!("these clocks do not tick here, nor does what belongs to them: {}", clocks.join(", ")));
    }
    let done = run.table(&files, voice, |table| simulate(&unit, &experiment, inputs.as_ref(), table))?;
    let done = done.map_err(|error| failed(error, args.run.output.as_ref()))?;
    run.report(&args.file, ("fmi_version", &unit.description().fmi_version), done, voice)
}

/// A simulation of units, as the options that all such verbs share ask for it.
pub struct UnitRun<'a>(pub &'a UnitRunArgs);

impl UnitRun<'_> {
    /// That the table has a place, before anything runs.
    pub fn check(&self, files: &Files, voice: &Voice) -> Result<(), Failure> {
        if voice.json && self.0.output.is_none() {
            return Err(Failure::argument("--json and the table both go to standard output", "give --output CSV"));
        }
        self.0.output.as_ref().map_or(Ok(()), |path| Ok(files.check(path)?))
    }

    /// Where the code of units runs.
    pub fn isolation(&self) -> Result<Isolation, Failure> {
        let isolation = match self.0.isolation {
            FmuIsolation::Process => UnitIsolation::Process,
            FmuIsolation::None => UnitIsolation::None,
        };
        let limit = seconds("--call-limit", Some(&self.0.call_limit))?.filter(|limit| *limit > 0.0);
        let limit = limit.ok_or_else(|| Failure::argument("--call-limit has to be above 0 s", "such as \"10 s\""))?;
        Ok(Isolation::from_unit_isolation(isolation, Some(limit)))
    }

    /// Start values by name.
    pub fn start_values(&self) -> Result<BTreeMap<String, String>, Failure> {
        named_values(&self.0.start).map_err(|error| Failure::argument(error, "such as --start tool.set=ni_vk6om"))
    }

    /// Runs `simulate` with the place of the table; what came before a failure stays.
    pub fn table<D, E>(
        &self,
        files: &Files,
        voice: &Voice,
        simulate: impl FnOnce(&mut dyn Write) -> Result<D, E>,
    ) -> Result<Result<D, E>, Failure> {
        let Some(path) = &self.0.output else {
            let mut table = Vec::new();
            let done = simulate(&mut table);
            voice.raw(String::from_utf8_lossy(&table).trim_end())?;
            return Ok(done);
        };
        let mut draft = files.begin(path)?;
        let mut table = BufWriter::new(&mut draft.file);
        let done = simulate(&mut table);
        table.flush().map_err(|source| Failure::Unwritable { path: path.clone(), source })?;
        drop(table);
        files.end(draft)?;
        Ok(done)
    }

    /// Says what came of a simulation of `file`; `standard` is the key and the number of its version.
    pub fn report(&self, file: &Path, standard: (&str, &str), done: Done, voice: &Voice) -> Result<(), Failure> {
        let Done { start, stop, step, steps, ended } = done;
        if voice.json {
            return voice.json(&json!({
                "schema": 1,
                "file": file.display().to_string(),
                (standard.0): standard.1,
                "start [s]": start,
                "stop [s]": stop,
                "step [s]": step,
                "steps": steps,
                "ended_by_unit": ended,
                "output": self.0.output,
            }));
        }
        let to = self.0.output.as_ref().map_or(String::new(), |path| format!("wrote {}: ", path.display()));
        let end = if ended { ", where a unit ended the simulation" } else { "" };
        voice.say(format_args!("{to}{steps} steps of {step} s from {start} s to {stop} s{end}"));
        Ok(())
    }
}

fn inputs(unit: &Unit, start: &BTreeMap<String, String>, path: &Path) -> Result<Inputs, Failure> {
    let file = File::open(path).map_err(|error| Failure::unreadable(path, error, "check --input"))?;
    Inputs::read(unit.description(), start, BufReader::new(file))
        .map_err(|error| Failure::of_file(path, error, "`toolroom fmu info` lists the inputs of the unit"))
}

fn not_loaded(error: LoadError) -> Failure {
    if let LoadError::Archive(error) = error {
        return refused(error);
    }
    Failure::argument(error, "ask `toolroom fmu check` what is wrong with the unit")
}

/// A simulation that did not reach its end; rows before that are written.
fn failed(error: SimulateError, output: Option<&PathBuf>) -> Failure {
    if matches!(error, SimulateError::Call { .. } | SimulateError::Value { .. } | SimulateError::Discarded { .. }) {
        let kept = output.map_or(String::new(), |path| format!("; {} holds what came before", path.display()));
        return Failure::work(format_args!("{error}{kept}"));
    }
    if let SimulateError::Output(_) = error {
        return Failure::work_error(&error);
    }
    Failure::argument(error, "see toolroom fmu sim --help")
}
