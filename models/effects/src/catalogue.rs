//! The catalogue row of an effect.

use crate::Search;
use toolroom_process::Field;

/// What is known about one effect before any measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CatalogueEntry {
    /// Stable word in files, on the command line and in diagnoses.
    pub id: &'static str,
    /// One line for people.
    pub title: &'static str,
    /// The strength: unit, range, meaning. Neutral at zero; negative only where a change goes either way.
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
    /// Processes that it acts on, by [`Process::NAME`](toolroom_process::Process::NAME), and how the diagnosis
    /// looks for it in records of each.
    pub processes: &'static [(&'static str, Search)],
}

impl CatalogueEntry {
    /// How the diagnosis looks for the effect in records of a process; `None` where it does not act.
    ///
    /// ```
    /// use toolroom_effects::{Effect, Search};
    /// let chipping = Effect::named("chipping").unwrap().entry();
    /// assert!(matches!(chipping.search("turning"), Some(Search::Untried(_))));
    /// assert_eq!(chipping.search("infeed"), None);
    /// ```
    pub fn search(&self, process: &str) -> Option<Search> {
        self.processes.iter().find(|(name, _)| *name == process).map(|(_, search)| *search)
    }

    /// Names of the processes that it acts on.
    pub fn process_names(&self) -> impl Iterator<Item = &'static str> {
        self.processes.iter().map(|(name, _)| *name)
    }
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

/// Who looks for an effect on modes in the place of a search of its own.
pub(crate) const BY_CUTS_THAT_CHATTERED: Search = Search::Untried(
    "asked by `dynamics_drift`, of the cuts that chattered and their frequencies; no other channel of a cut reads it",
);

/// `channel` falls.
pub(crate) const fn falls(channel: &'static str) -> Touched {
    Touched { channel, sign: Sign::Falls }
}
