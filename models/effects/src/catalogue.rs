//! The catalogue row of an effect.

use toolroom_process::Field;

/// What is known about one effect before any measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CatalogueEntry {
    /// Stable word in files, on the command line and in diagnoses.
    pub id: &'static str,
    /// One line for people.
    pub title: &'static str,
    /// The strength: unit, range, meaning. Never negative, neutral at zero.
    pub size: &'static Field,
    /// Measured channels that the effect moves, by their column name.
    pub channels: &'static [Touched],
    /// Where the effect shows: the covariate that it follows.
    pub regime: &'static str,
    /// What it is most easily mistaken for.
    pub confounder: &'static str,
    /// The experiment that tells the two apart.
    pub separating_test: &'static str,
    /// Paper and equation, or `assumption`.
    pub source: &'static str,
    /// Processes that it acts on, by [`Process::NAME`](toolroom_process::Process::NAME).
    pub processes: &'static [&'static str],
}

/// One channel that an effect moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Touched {
    /// Column name.
    pub channel: &'static str,
    /// Which way.
    pub sign: Sign,
}

/// Which way a channel moves as the size of an effect grows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Its values rise.
    Rises,
    /// Its values fall.
    Falls,
}

/// `channel` rises.
pub(crate) const fn rises(channel: &'static str) -> Touched {
    Touched { channel, sign: Sign::Rises }
}

/// `channel` falls.
pub(crate) const fn falls(channel: &'static str) -> Touched {
    Touched { channel, sign: Sign::Falls }
}
