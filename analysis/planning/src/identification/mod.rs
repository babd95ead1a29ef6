//! Lag and stiffnesses of plunge grinding from trials.
//!
//! ```text
//!  trials ──► IdentificationStudy ──┬── summary ──► JSON for programs
//!                                   ├── text    ──► lines for a terminal
//!                                   └── files   ──► table, JSON, report with pictures
//! ```

mod files;
mod picture;
mod tables;
mod text;

use crate::change::{ChangeError, assign, parts};
use toolroom_infeed::{Identification, IdentifyError, IdentifyOptions, MeasurementErrors, Trial, identify};

pub use tables::{Table, TrialsError};

/// The files of every identification.
pub const NAMES: &[&str] = &["trials.csv", "identify.json", "report.html"];

/// Trials and what they say.
pub struct IdentificationStudy {
    /// Name of the study.
    pub title: String,
    /// The trials that are possible, in their order.
    pub trials: Vec<Trial>,
    /// Errors of measurement, and what is identified from.
    pub options: IdentifyOptions,
    /// Lag, stiffnesses and their intervals.
    pub identification: Identification,
}

impl IdentificationStudy {
    /// Identifies lag and stiffnesses from `trials`.
    ///
    /// # Errors
    /// [`IdentifyError`]: trials that cannot be, or too few of them.
    pub fn new(title: impl Into<String>, trials: Vec<Trial>, options: IdentifyOptions) -> Result<Self, IdentifyError> {
        let found = identify(&trials, &options)?;
        let possible = |trial: &Trial| found.trials.iter().any(|lag| lag.trial_id == trial.trial_id);
        let trials = trials.into_iter().filter(possible).collect();
        Ok(Self { title: title.into(), trials, options, identification: found })
    }
}

/// Errors of measurement with changes to those that are assumed, `name=value`.
///
/// # Errors
/// [`ChangeError`]: a measurement that there is none of, or a value that it refuses.
///
/// ```
/// let errors = toolroom_planning::identification::measurement_errors(&["stock=1 um".to_owned()]).unwrap();
/// assert_eq!(errors.stock, 1e-6);
/// assert!(toolroom_planning::identification::measurement_errors(&["stok=1 um".to_owned()]).is_err());
/// ```
pub fn measurement_errors(changes: &[String]) -> Result<MeasurementErrors, ChangeError> {
    let mut errors = MeasurementErrors::default();
    for change in changes {
        let (name, value) = parts(change)?;
        assign(&mut errors, name, value)?;
    }
    Ok(errors)
}
