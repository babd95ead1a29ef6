//! Lobes files: what vibrates around a cut, the range of a stability chart, operating points.
//!
//! `toolroom lobes` draws them; a tool of a scenario names one as its `structure`. The modes can stand in a structure file of
//! their own, as a tap test has found them, and the coefficients of the cutting force in a coefficient file.
//!
//! # What is not modelled
//! Nothing is computed here. The crate `toolroom-chatter` says what its models leave out.

#![deny(clippy::wildcard_enum_match_arm)]

mod coefficients;
mod keys;
mod pair;
mod read;
mod structure;
mod tapped;
#[cfg(test)]
mod tests;
mod words;

pub use coefficients::{COEFFICIENTS, CoefficientFile, read_coefficients};
pub use keys::LOBES;
pub use read::{parse, read};
pub use structure::{STRUCTURE, Structure, read_structure};
pub use words::LobesProcess;

use std::path::PathBuf;
use toolroom_chatter::paper::{FiveDegrees, Reduced};
use toolroom_chatter::{Axis, Bar, Milling, Scatter, SpeedVariation, Turning};

/// What a lobes file says.
#[derive(Clone, Debug)]
pub struct LobesFile {
    /// Short name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// What vibrates.
    pub cut: LobesCut,
    /// How the spindle speed varies about its mean.
    pub variation: Option<SpeedVariation>,
    /// What is drawn.
    pub chart: Chart,
    /// Operating points.
    pub points: Vec<Point>,
    /// How well the constants are known, where this file or its structure file says so.
    pub scatter: Option<Scatter>,
    /// What machine, tool and drawing allow.
    pub limits: Limits,
    /// Feed per tooth in milling, per revolution in turning (m), where it is given.
    pub feed: Option<f64>,
    /// Measured responses that the structure file names, for a limit straight from them.
    pub table: Option<PathBuf>,
}

/// What machine, tool and drawing allow; left out: anything.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Mean power at the spindle (W).
    pub power: Option<f64>,
    /// Mean torque at the spindle (N m).
    pub torque: Option<f64>,
    /// Greatest resultant force on the tool (N).
    pub force: Option<f64>,
    /// Greatest error of the surface location, either way (m).
    pub surface_error: Option<f64>,
}

/// A cut without its operating point.
#[derive(Clone, Debug)]
pub enum LobesCut {
    /// A milling cutter.
    Milling(Milling),
    /// A turned cut.
    Turning {
        /// All modes but the bar's.
        cut: Turning,
        /// A slender workpiece and the place of the tool on it (m from the jaws).
        bar: Option<(Bar, f64)>,
    },
    /// A workpiece in a chuck of three jaws, over speed ratio and modulation.
    Chuck(Reduced),
    /// The same without modulation, over chip-formation lag and cutting stiffness.
    ChipLag(Reduced),
    /// Tool and workpiece in a chuck of three jaws, over speed ratio and modulation.
    Lathe(Box<FiveDegrees>),
}

/// Keys of the two axes of the chart of a process, and their units in files and for people.
pub fn axes(process: LobesProcess) -> [(&'static str, &'static str, &'static str); 2] {
    match process {
        LobesProcess::Chuck | LobesProcess::Lathe => [("speed_ratio", "1", "1"), ("modulation", "1", "1")],
        LobesProcess::ChipLag => [("chip_lag", "s", "us"), ("cutting_stiffness", "N/m", "N/um")],
        LobesProcess::Milling | LobesProcess::Turning => {
            [("spindle_speed", "rad/s", "rpm"), ("depth_of_cut", "m", "mm")]
        }
    }
}

/// Range and resolution of a chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Spindle speed, rad/s; speed ratio of a chuck or lathe; chip-formation lag, s.
    pub speed: Axis,
    /// Depth of cut, m; modulation of a chuck or lathe; cutting stiffness, N/m.
    pub depth: Axis,
    /// Whether only the boundary is wanted.
    pub boundary_only: bool,
    /// Whose boundaries are drawn beside: other lags of a chuck, s, or other first harmonics of
    /// the allowance of a lathe.
    pub beside: Vec<f64>,
}

/// An operating point, in the units of [`Chart`].
#[derive(Clone, Debug)]
pub struct Point {
    /// Name in tables.
    pub name: String,
    /// As [`Chart::speed`].
    pub speed: f64,
    /// As [`Chart::depth`].
    pub depth: f64,
}
