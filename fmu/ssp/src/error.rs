//! Why a system does not run.

use crate::package::SspError;
use toolroom_fmu_import::simulate::SimulateError;
use toolroom_fmu_import::{ArchiveError, LoadError};

/// Why a system does not run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MasterError {
    /// The package.
    #[error(transparent)]
    Package(#[from] SspError),
    /// The package cannot be unpacked.
    #[error(transparent)]
    Archive(#[from] ArchiveError),
    /// No place for its units.
    #[error("the units cannot be unpacked: {0}")]
    Folder(std::io::Error),
    /// A unit that cannot be loaded.
    #[error("{component}: {source}")]
    Load {
        /// Component.
        component: String,
        /// Why.
        source: LoadError,
    },
    /// A start value that its unit does not take.
    #[error("{}{system}: {variable}: {reason}", .place.as_ref().map_or(String::new(), |place| format!("{place}: ")))]
    Start {
        /// File, entry and line, where a package has it.
        place: Option<String>,
        /// System.
        system: String,
        /// Component and variable, as `component.variable`.
        variable: String,
        /// Why.
        reason: String,
    },
    /// A connection that carries no signal.
    #[error("{connection}: {reason}")]
    Connection {
        /// Both ends.
        connection: String,
        /// Why.
        reason: String,
    },
    /// Signals that determine each other at one instant, and do not settle when they are handed on.
    #[error("an algebraic loop that does not settle at {start} s: {signals}")]
    Loop {
        /// The start, s.
        start: f64,
        /// The way round.
        signals: String,
    },
    /// Steps that a unit of fixed steps does not take.
    #[error("{component}: {source}")]
    Steps {
        /// Component.
        component: String,
        /// Why.
        source: Box<SimulateError>,
    },
    /// A component that is not there, or twice, in an order of units.
    #[error("the order of units has to name each of them once: {}", .known.join(", "))]
    Order {
        /// The components.
        known: Vec<String>,
    },
    /// Start, stop and step that give no simulation.
    #[error("from {start} s to {stop} s in steps of {step} s there is nothing to simulate")]
    Experiment {
        /// Start time, s.
        start: f64,
        /// Stop time, s.
        stop: f64,
        /// Step, s.
        step: f64,
    },
    /// A unit that failed; rows before stand.
    #[error("{component}: {source}")]
    Unit {
        /// Component.
        component: String,
        /// Time and call.
        source: Box<SimulateError>,
    },
    /// The results cannot be written.
    #[error("the results cannot be written: {0}")]
    Output(Box<dyn std::error::Error + Send + Sync>),
}

impl MasterError {
    /// Whether the package or what was asked of it is at fault, rather than a unit on its way.
    pub fn is_refusal(&self) -> bool {
        !matches!(self, Self::Unit { .. } | Self::Output(_) | Self::Folder(_))
    }
}
