//! A fit as a structure file.

use crate::fit::Fit;
use crate::fitted_mode::{Estimate, FittedMode};
use std::fmt::{self, Write as _};

/// Standard deviations that belong to a measurement as such, relative: what changes from tap to tap and from mounting to
/// mounting. They are added to those of the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// Of the natural frequency.
    pub natural_frequency: f64,
    /// Of the damping ratio.
    pub damping_ratio: f64,
    /// Of the stiffness.
    pub stiffness: f64,
}

impl Scatter {
    /// None: the uncertainty of the fit alone.
    pub const NONE: Self = Self { natural_frequency: 0.0, damping_ratio: 0.0, stiffness: 0.0 };
    /// Half a percent, ten percent and five percent: an assumption.
    pub const ASSUMED: Self = Self { natural_frequency: 0.005, damping_ratio: 0.1, stiffness: 0.05 };
}

/// The text of a structure file.
pub struct StructureText<'a> {
    /// Name of the structure.
    pub name: &'a str,
    /// What was fitted.
    pub fit: &'a Fit,
    /// The measured file, its digest and the command, as comments of the source.
    pub source: &'a str,
    /// What is added to the uncertainty of the fit.
    pub scatter: Scatter,
}

impl fmt::Display for StructureText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, fit, source, scatter } = self;
        writeln!(f, "schema = 1\nname = {}\n\n[measurement]", quoted(name))?;
        writeln!(f, "source = {}", quoted(source))?;
        writeln!(f, "quality = {}", quoted(&fit.quality.verdict()))?;
        for (i, mode) in fit.modes.iter().enumerate() {
            write!(f, "\n[[mode]]\n{}", mode_keys(i + 1, mode, *scatter))?;
        }
        writeln!(f, "\n# Compliance of all modes above the measured range.\n[residual]")?;
        for (pair, upper) in &fit.upper {
            writeln!(f, "upper_{pair} = \"{} m/N\"", digits(upper.value, upper.sd))?;
        }
        writeln!(f, "\n# Of the fit alone, in Hz, 1 and N/m.\n[covariance]")?;
        let names: Vec<String> = (1..=fit.modes.len())
            .flat_map(|i| ["natural_frequency", "damping_ratio", "stiffness"].map(|key| format!("\"m{i}.{key}\"")))
            .collect();
        writeln!(f, "names = [{}]", names.join(", "))?;
        let mut rows = String::new();
        for row in &fit.covariance {
            let cells: Vec<String> = row.iter().map(|value| format!("{value:.6e}")).collect();
            writeln!(rows, "  [{}],", cells.join(", "))?;
        }
        writeln!(f, "matrix = [\n{rows}]")
    }
}

/// The keys of a mode in a structure file, whatever table they stand in: its name from its number, and what was fitted with
/// `scatter` added to its uncertainty.
pub fn mode_keys(number: usize, mode: &FittedMode, scatter: Scatter) -> String {
    let [x, y] = mode.direction;
    let frequency = widened(mode.natural_frequency, scatter.natural_frequency);
    let damping = widened(mode.damping_ratio, scatter.damping_ratio);
    let stiffness = widened(mode.stiffness, scatter.stiffness);
    format!(
        "name = \"m{number}\"\ndirection = [{x:.5}, {y:.5}]\n\
         natural_frequency = {{ value = \"{} Hz\", sd = \"{} Hz\" }}\n\
         damping_ratio = {{ value = {}, sd = {} }}\n\
         stiffness = {{ value = \"{} N/m\", sd = \"{} N/m\" }}\n",
        frequency.0, frequency.1, damping.0, damping.1, stiffness.0, stiffness.1
    )
}

/// A value and its standard deviation with a relative one added, each with the digits that count.
fn widened(estimate: Estimate, relative: f64) -> (String, String) {
    let sd = estimate.sd.hypot(relative * estimate.value);
    (digits(estimate.value, estimate.sd), digits(sd, 0.01 * sd))
}

/// A number with two digits more than its standard deviation leaves.
fn digits(value: f64, sd: f64) -> String {
    let places = if sd > 0.0 && value != 0.0 { (value.abs() / sd).log10().ceil() as i32 + 2 } else { 9 };
    let places = usize::try_from(places.clamp(2, 15)).unwrap_or(9);
    let text = format!("{value:.*e}", places);
    // Numbers of a usual size are easier to read without a power.
    match text.parse::<f64>() {
        Ok(number) if (1e-4..1e15).contains(&number.abs()) => format!("{number}"),
        _ => text,
    }
}

/// A text as a string of a structure file, on one line.
pub fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\"").replace(['\n', '\r'], " "))
}
