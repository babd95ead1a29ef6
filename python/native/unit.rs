//! Processes as FMI units.

use crate::failure::Failure;
use pyo3::prelude::*;
use std::path::PathBuf;
use toolroom::fmu::{Binary, Platform, Version, file_name, own_set, package, units};

/// Packages a process for this machine: file name and contents of each version of the standard.
#[pyfunction]
#[pyo3(signature = (model, versions, parameters, library))]
pub fn export_fmu(
    model: &str,
    versions: Vec<u32>,
    parameters: Vec<PathBuf>,
    library: Option<PathBuf>,
) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let Some(unit) = units().find(|entry| entry.name == model) else {
        let known: Vec<&str> = units().map(|entry| entry.name).collect();
        return Err(Failure::argument(format_args!("there is no model \"{model}\""), known.join(", ")));
    };
    let read = |path: &PathBuf| {
        own_set(unit, path).map_err(|error| Failure::argument(format_args!("{}: {error}", path.display()), error.fix()))
    };
    let sets = parameters.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    let platform = Platform::host().ok_or_else(|| Failure::work("units are not made for this machine"))?;
    let library = match library {
        Some(path) => std::fs::read(&path).map_err(|error| Failure::file(&path, &error))?,
        None => embedded()?,
    };
    let binaries = [Binary { platform, library }];
    let mut made = Vec::new();
    for number in versions {
        let version = match number {
            2 => Version::Two,
            3 => Version::Three,
            other => return Err(Failure::argument(format_args!("FMI {other} is not exported"), "2 or 3")),
        };
        let bytes = package(unit, version, &binaries, &sets).map_err(Failure::work)?;
        made.push((file_name(unit.describe(), version), bytes));
    }
    Ok(made)
}

/// The library inside this package.
#[cfg(feature = "embedded-units")]
fn embedded() -> Result<Vec<u8>, Failure> {
    toolroom::unit_library().map_err(Failure::work)
}

/// The library inside this package.
#[cfg(not(feature = "embedded-units"))]
fn embedded() -> Result<Vec<u8>, Failure> {
    Err(Failure::argument(
        "the library of exported units is not in this package",
        "build it with the feature `embedded-units`, or name the library that `cargo build -p toolroom-fmu` makes",
    ))
}
