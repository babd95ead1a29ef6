//! Lobes files: what vibrates around a cut, the range of a stability chart, operating points.
//!
//! `toolroom lobes` draws them; a tool of a scenario names one as its `structure`.

mod keys;
mod read;

pub use keys::LOBES;
pub use read::{read, resolve};

use toolroom_chatter::paper::Reduced;
use toolroom_chatter::{Axis, Bar, Milling, Turning};

/// What a lobes file says.
#[derive(Clone, Debug)]
pub struct LobesFile {
    /// Short name.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// What vibrates.
    pub cut: LobesCut,
    /// What is drawn.
    pub chart: Chart,
    /// Operating points.
    pub points: Vec<Point>,
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
    /// A workpiece in a chuck of three jaws.
    Chuck(Reduced),
}

/// Range and resolution of a chart.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Spindle speed, rad/s; speed ratio of a chuck.
    pub speed: Axis,
    /// Depth of cut, m; modulation of a chuck.
    pub depth: Axis,
    /// Whether only the boundary is wanted.
    pub boundary_only: bool,
    /// Other lags whose boundaries are drawn beside, s.
    pub lags: Vec<f64>,
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
