//! Turning as an FMI 3.0 unit: its description and documentation; a library of a platform is added as a `Binary`.
#![allow(clippy::print_stdout)] // a program

use std::error::Error;
use toolroom::fmu::{Version, file_name, package, units};

/// Runs the example.
pub fn main() -> Result<(), Box<dyn Error>> {
    let unit = units().find(|unit| unit.name == "turning").ok_or("no unit of turning")?;
    let description = unit.describe();
    let bytes = package(unit, Version::Three, &[], &[])?;
    let name = file_name(description, Version::Three);
    println!("{name}: {} variables, {} bytes without a library", description.variables.len(), bytes.len());
    Ok(())
}
