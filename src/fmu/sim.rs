//! `toolroom fmu sim F.fmu`.

use super::refused;
use crate::args::{FmuInterface, FmuIsolation, FmuSimArgs};
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
use toolroom_process::unit::quantity;

pub fn run(args: &FmuSimArgs, voice: &Voice) -> Result<(), Failure> {
    if voice.json && args.output.is_none() {
        return Err(Failure::argument("--json and the table both go to standard output", "give --output CSV"));
    }
    let files = Files::new(std::iter::once(args.file.as_path()).chain(args.input.as_deref()), voice.force);
    args.output.as_ref().map_or(Ok(()), |path| files.check(path))?;
    let isolation = match args.isolation {
        FmuIsolation::Process => UnitIsolation::Process,
        FmuIsolation::None => UnitIsolation::None,
    };
    let limit = seconds("--call-limit", Some(&args.call_limit))?.filter(|limit| *limit > 0.0);
    let limit = limit.ok_or_else(|| Failure::argument("--call-limit has to be above 0 s", "such as \"10 s\""))?;
    let driven = match args.interface {
        None => Driven::Either,
        Some(FmuInterface::CoSimulation) => Driven::CoSimulation,
        Some(FmuInterface::ModelExchange) => Driven::ModelExchange,
    };
    let unit = Unit::load_driven(&args.file, &Isolation::of(isolation, Some(limit)), driven).map_err(not_loaded)?;
    let unit = Arc::new(unit);
    let experiment = Experiment {
        start: None,
        stop: seconds("--stop", args.stop.as_deref())?,
        step: seconds("--step", args.step.as_deref())?,
        start_values: named_values(&args.start)
            .map_err(|error| Failure::argument(error, "such as --start tool.set=ni_vk6om"))?,
    };
    let inputs = args.input.as_deref().map(|path| inputs(&unit, &experiment.start_values, path)).transpose()?;
    let left_out = left_out(unit.description(), &experiment.start_values);
    if !left_out.is_empty() {
        voice.say(format_args!("left out, since no table can hold it: {}", left_out.join(", ")));
    }
    let done = match &args.output {
        Some(path) => {
            let unwritable = |source| Failure::Unwritable { path: path.clone(), source };
            let mut draft = files.begin(path)?;
            let mut table = BufWriter::new(&mut draft.file);
            let done = simulate(&unit, &experiment, inputs.as_ref(), &mut table);
            table.flush().map_err(unwritable)?;
            drop(table);
            files.end(draft)?;
            done.map_err(|error| failed(error, Some(path)))?
        }
        None => {
            let mut table = Vec::new();
            let done = simulate(&unit, &experiment, inputs.as_ref(), &mut table);
            voice.data(String::from_utf8_lossy(&table).trim_end())?;
            done.map_err(|error| failed(error, None))?
        }
    };
    report(args, &unit, done, voice)
}

fn report(args: &FmuSimArgs, unit: &Unit, done: Done, voice: &Voice) -> Result<(), Failure> {
    let Done { start, stop, step, steps, ended } = done;
    if voice.json {
        return voice.json(&json!({
            "schema": 1,
            "file": args.file.display().to_string(),
            "fmi_version": unit.description().fmi_version,
            "start [s]": start,
            "stop [s]": stop,
            "step [s]": step,
            "steps": steps,
            "ended_by_unit": ended,
            "output": args.output,
        }));
    }
    let to = args.output.as_ref().map_or(String::new(), |path| format!("wrote {}: ", path.display()));
    let end = if ended { ", where the unit ended the simulation" } else { "" };
    voice.say(format_args!("{to}{steps} steps of {step} s from {start} s to {stop} s{end}"));
    Ok(())
}

fn inputs(unit: &Unit, start: &BTreeMap<String, String>, path: &Path) -> Result<Inputs, Failure> {
    let file = File::open(path).map_err(|error| {
        Failure::argument(format_args!("{} cannot be read: {error}", path.display()), "check --input")
    })?;
    Inputs::read(unit.description(), start, BufReader::new(file)).map_err(|error| {
        Failure::argument(
            format_args!("{}: {error}", path.display()),
            "`toolroom fmu info` lists the inputs of the unit",
        )
    })
}

fn not_loaded(error: LoadError) -> Failure {
    match error {
        LoadError::Archive(error) => refused(error),
        error => Failure::argument(error, "ask `toolroom fmu check` what is wrong with the unit"),
    }
}

/// A simulation that did not reach its end; rows before that are written.
fn failed(error: SimulateError, output: Option<&PathBuf>) -> Failure {
    match error {
        SimulateError::Call { .. } | SimulateError::Value { .. } | SimulateError::Discarded { .. } => {
            let kept = output.map_or(String::new(), |path| format!("; {} holds what came before", path.display()));
            Failure::Work { message: format!("{error}{kept}") }
        }
        SimulateError::Output(_) => Failure::Work { message: error.to_string() },
        error => Failure::argument(error, "see toolroom fmu sim --help"),
    }
}

fn seconds(flag: &str, text: Option<&str>) -> Result<Option<f64>, Failure> {
    let read = |text| {
        quantity(text, "s").map_err(|error| Failure::argument(format_args!("{flag}: {error}"), "such as \"0.1 s\""))
    };
    text.map(read).transpose()
}
