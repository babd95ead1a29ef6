//! Exported units in the importer `fmi-rs`: `toolroom-fmu-conformance ACTION FILE [OUTPUT]`.
//!
//! | action | result, one line of JSON on standard output |
//! |---|---|
//! | `validate` | what its reading of the standard finds wrong with the description |
//! | `cs` | time and output at six points up to 600 s, in steps of 1 s |
//! | `state` | output at 600 s, once straight on and once from bytes saved at 300 s in another instance |
//! | `speed` | nanoseconds of a step, of reading the output, of saving the state |

mod instance;

use instance::{Failed, Unit};
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let result = match arguments[..] {
        ["validate", file] => Unit::open(file).map(|unit| list(unit.problems().iter().map(|text| quoted(text)))),
        ["cs", file, output] => Unit::open(file).and_then(|unit| trajectory(&unit, output)),
        ["state", file, output] => Unit::open(file).and_then(|unit| state(&unit, output)),
        ["speed", file, output] => Unit::open(file).and_then(|unit| speed(&unit, output)),
        _ => Err(Failed("validate FILE, or cs|state|speed FILE OUTPUT".to_owned())),
    };
    match result {
        Ok(line) => {
            println!("{line}");
            ExitCode::SUCCESS
        }
        Err(Failed(reason)) => {
            eprintln!("{reason}");
            ExitCode::FAILURE
        }
    }
}

fn trajectory(unit: &Unit, output: &str) -> Result<String, Failed> {
    let mut unit = unit.instance(output)?;
    let mut rows = Vec::new();
    for step in 1..=600 {
        unit.step(f64::from(step - 1), 1.0)?;
        if step % 100 == 0 {
            rows.push(format!("[{step}, {:?}]", unit.output()?));
        }
    }
    Ok(list(rows))
}

fn state(unit: &Unit, output: &str) -> Result<String, Failed> {
    let (mut other, mut unit) = (unit.instance(output)?, unit.instance(output)?);
    for step in 0..300 {
        unit.step(f64::from(step), 1.0)?;
    }
    let saved = unit.bytes()?;
    other.restore(&saved)?;
    for step in 300..600 {
        unit.step(f64::from(step), 1.0)?;
        other.step(f64::from(step), 1.0)?;
    }
    let mut damaged = saved.clone();
    damaged[saved.len() / 2] ^= 1;
    let refused = other.restore(&damaged).is_err();
    let (on, restored) = (unit.output()?, other.output()?);
    Ok(format!("{{\"on\": {on:?}, \"restored\": {restored:?}, \"bytes\": {}, \"refused\": {refused}}}", saved.len()))
}

/// Least of several means, so that what else the computer does counts as little as possible.
fn speed(unit: &Unit, output: &str) -> Result<String, Failed> {
    let mut said = Vec::new();
    for length in [0.01, 0.1] {
        let least = least(|| {
            // A new instance, so that every run is of a young edge.
            let mut instance = unit.instance(output)?;
            mean(|i| instance.step(f64::from(i) * length, length))
        })?;
        said.push(format!("\"step of {length} s\": {least:.1}"));
    }
    let mut instance = unit.instance(output)?;
    instance.step(0.0, 0.1)?;
    let get = least(|| {
        mean(|_| {
            instance.output().map(|value| {
                black_box(value);
            })
        })
    })?;
    said.push(format!("\"get\": {get:.1}"));
    if unit.saves() {
        let save = least(|| mean(|_| instance.save()))?;
        said.push(format!("\"save\": {save:.1}"));
    }
    Ok(format!("{{{}}}", said.join(", ")))
}

/// Least result of a few runs.
fn least(mut run: impl FnMut() -> Result<f64, Failed>) -> Result<f64, Failed> {
    const RUNS: usize = 15;
    (0..RUNS).try_fold(f64::INFINITY, |least, _| Ok(least.min(run()?)))
}

/// Nanoseconds of one of many calls.
fn mean(mut call: impl FnMut(u32) -> Result<(), Failed>) -> Result<f64, Failed> {
    const CALLS: u32 = 2000;
    let start = Instant::now();
    (0..CALLS).try_for_each(&mut call)?;
    Ok(start.elapsed().as_secs_f64() / f64::from(CALLS) * 1e9)
}

fn list(items: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", items.into_iter().collect::<Vec<_>>().join(", "))
}

/// A text as JSON; what needs more than these escapes does not come from a description.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace('\n', " "))
}
