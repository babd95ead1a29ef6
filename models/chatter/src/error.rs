//! Why a stability question was refused.

use std::f64::consts::TAU;

/// Why a stability question was refused.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChatterError {
    /// A quantity that must be a finite number is not.
    #[error("{quantity} is {value}, not a finite number")]
    NotFinite {
        /// What was given.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// A quantity that must be positive is zero or negative.
    #[error("{quantity} must be positive, is {value}")]
    NotPositive {
        /// What was given.
        quantity: &'static str,
        /// Its value.
        value: f64,
    },
    /// A quantity outside its range.
    #[error("{quantity} must lie in {min} … {max}, is {value}")]
    OutOfRange {
        /// What was given.
        quantity: &'static str,
        /// Its value.
        value: f64,
        /// Least value.
        min: f64,
        /// Greatest value.
        max: f64,
    },
    /// A spindle speed at which nobody measured.
    #[error(
        "no modes were measured at a spindle speed of {} rpm; the table of modes has {} to {} rpm",
        rpm(*speed), rpm(*least), rpm(*greatest)
    )]
    SpeedOutsideTable {
        /// The speed (rad/s).
        speed: f64,
        /// Least speed of the table (rad/s).
        least: f64,
        /// Greatest speed of the table (rad/s).
        greatest: f64,
    },
    /// A range that ends before it starts.
    #[error("range of {quantity} must ascend, runs from {start} to {end}")]
    EmptyRange {
        /// What was given.
        quantity: &'static str,
        /// First value.
        start: f64,
        /// Last value.
        end: f64,
    },
    /// An axis needs two points at least.
    #[error("{quantity} needs at least 2 points, has {points}")]
    TooFewPoints {
        /// The axis.
        quantity: &'static str,
        /// How many it has.
        points: usize,
    },
    /// Nothing can vibrate.
    #[error("the structure has no mode that moves the cut")]
    NoModes,
    /// The engagement is empty or no tooth reaches the work.
    #[error("no tooth is in cut")]
    NoTeethInCut,
    /// The structure is not stable even without cutting.
    #[error("the structure is unstable without cutting: damping ratio {damping_ratio}")]
    UnstableStructure {
        /// Damping ratio of the mode.
        damping_ratio: f64,
    },
    /// The stable range has no upper end within the depths that were searched.
    #[error("stable at every depth up to {searched} m")]
    NoLimit {
        /// Greatest depth that was searched (m).
        searched: f64,
    },
    /// The spindle is too slow for the period map and too fast for the envelope of the lobes.
    #[error(
        "the spindle is too slow for the period map and too fast for the envelope of the lobes: the fastest mode swings \
         {waves:.0} times while teeth cut in one repetition of the cut, and the least damped one hardly decays in a pass; ask \
         above {least_rpm:.3} rpm or \
         below {greatest_rpm:.3} rpm, or leave out modes of little compliance that are the fastest or the least damped"
    )]
    TooSlow {
        /// Oscillations of the fastest mode while teeth cut, in one repetition of the cut.
        waves: f64,
        /// Spindle speed (rpm) from which on the period map answers.
        least_rpm: f64,
        /// Spindle speed (rpm) up to which the envelope answers.
        greatest_rpm: f64,
    },
    /// A varying speed that is so low that a period of its variation holds too many oscillations.
    #[error(
        "a period of the speed variation holds {waves:.0} oscillations of the fastest mode, and a period map of more than \
         {greatest:.0} takes too long; ask above {least_rpm:.1} rpm, for fewer revolutions in a period, or in milling for one \
         `phase`, which is answered at lower speeds"
    )]
    TooManyOscillations {
        /// Oscillations of the fastest mode in a period of the variation.
        waves: f64,
        /// How many are worked out.
        greatest: f64,
        /// Mean spindle speed (rpm) from which on there are no more than that.
        least_rpm: f64,
    },
    /// The eigenvalue iteration did not reach its tolerance; nothing is reported instead.
    #[error("the dominant multiplier was not found: residual {residual}")]
    NotConverged {
        /// Residual of the best candidate.
        residual: f64,
    },
}

impl From<toolroom_spectral::NotConverged> for ChatterError {
    fn from(toolroom_spectral::NotConverged { residual }: toolroom_spectral::NotConverged) -> Self {
        Self::NotConverged { residual }
    }
}

impl ChatterError {
    /// Whether the search for an answer failed at one point. Every other error refuses the question itself, at this
    /// point and all others.
    pub fn is_failed_search(&self) -> bool {
        match self {
            Self::NotConverged { .. } | Self::TooSlow { .. } | Self::TooManyOscillations { .. } => true,
            Self::NotFinite { .. }
            | Self::NotPositive { .. }
            | Self::OutOfRange { .. }
            | Self::SpeedOutsideTable { .. }
            | Self::EmptyRange { .. }
            | Self::TooFewPoints { .. }
            | Self::NoModes
            | Self::NoTeethInCut
            | Self::UnstableStructure { .. }
            | Self::NoLimit { .. } => false,
        }
    }
}

/// A speed (rad/s) as people read it: rpm to a tenth, because an entered speed does not survive the conversion exactly.
fn rpm(speed: f64) -> f64 {
    (speed * 600.0 / TAU).round() / 10.0
}

/// `value` if it is finite.
pub(crate) fn finite(quantity: &'static str, value: f64) -> Result<f64, ChatterError> {
    if value.is_finite() { Ok(value) } else { Err(ChatterError::NotFinite { quantity, value }) }
}

/// `value` if it is finite and positive.
pub(crate) fn positive(quantity: &'static str, value: f64) -> Result<f64, ChatterError> {
    finite(quantity, value)?;
    if value > 0.0 { Ok(value) } else { Err(ChatterError::NotPositive { quantity, value }) }
}

/// `value` if it is finite and within `min..=max`.
pub(crate) fn within(quantity: &'static str, value: f64, min: f64, max: f64) -> Result<f64, ChatterError> {
    finite(quantity, value)?;
    if (min..=max).contains(&value) { Ok(value) } else { Err(ChatterError::OutOfRange { quantity, value, min, max }) }
}
