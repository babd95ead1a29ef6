//! Vibration modes from a tap test, or of a tool on a spindle that was tapped: fit, text, tables, pictures and the structure
//! file.

#![deny(clippy::wildcard_enum_match_arm)]

mod assembly;
mod blank;
mod files;
mod measured;
mod particles;
mod picture;
mod records;
mod request;
mod speeds;
mod spindle;
mod swap;
mod swap_error;
mod text;
mod tip;
mod tool;
mod update;
mod update_error;

pub use assembly::{Comparison, FittedJoint, PeakPair};
pub use blank::{blank, tip_of_blank};
pub use files::{NAMES, WindowedError, table};
pub use measured::{MeasuredError, MeasuredLimit, measured_limit, measured_milling_limit};
pub use records::{CutsError, RecordedCuts, read_cuts};
pub use request::{Request, RequestError, range, scatter};
pub use speeds::{SpeedStudy, SpeedsError};
pub use spindle::{Spindle, TappedBlank};
pub use swap::{tip, tip_at};
pub use swap_error::SwapError;
pub use text::{read as summary, read_json as json};
pub use tip::Tip;
pub use tool::{TOOL, Tool, read_tool};
pub use update::{Learnt, ModesUpdate, UpdateOptions};
pub use update_error::UpdateError;

use toolroom_chart::page::Provenance;
use toolroom_dynamics::{DynamicsError, Fit, FitOptions, Measurement, Scatter, StructureText, fit};

/// Modes fitted to a measurement.
#[derive(Debug)]
pub struct ModesStudy {
    /// Name of the structure.
    pub name: String,
    /// What was measured.
    pub measured: Measurement,
    /// What was found.
    pub fit: Fit,
    /// What is added to the uncertainty of the fit.
    pub scatter: Scatter,
    /// The same assembly as it was measured, where these are the modes of a predicted tip.
    pub comparison: Option<Comparison>,
}

impl ModesStudy {
    /// Fits modes to a measurement.
    ///
    /// # Errors
    /// [`DynamicsError`] where no mode can be found.
    pub fn new(
        name: String,
        measured: Measurement,
        options: &FitOptions,
        scatter: Scatter,
    ) -> Result<Self, DynamicsError> {
        let fit = fit(&measured, options)?;
        Ok(Self { name, measured, fit, scatter, comparison: None })
    }

    /// The structure file, with the command and the digests of the files that it was made of.
    pub fn structure(&self, provenance: &Provenance) -> String {
        let digests = provenance.inputs.iter().map(|(name, digest)| format!("{name} ({digest})"));
        let source = format!("{} of {}", provenance.command, digests.collect::<Vec<_>>().join(", "));
        StructureText { name: &self.name, fit: &self.fit, source: &source, scatter: self.scatter }.to_string()
    }
}
