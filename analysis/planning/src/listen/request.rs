//! What is reported of a recorded cut, as it is written on a command line.

use toolroom_dynamics::DynamicsError;
use toolroom_location::{Located, Location};
use toolroom_process::unit;

/// Why a record was not listened to.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ListenError {
    /// A text that is no spindle speed.
    #[error("--speed: {0}")]
    Speed(String),
    /// A lobes file of something else.
    #[error("the lobes file describes no milling; teeth are heard in milling alone")]
    NoMilling,
    /// Two numbers of teeth.
    #[error("--teeth says {told} teeth, the cutter of the lobes file has {drawn}")]
    Teeth {
        /// Teeth of the command.
        told: u32,
        /// Teeth of the lobes file.
        drawn: usize,
    },
    /// A record that cannot be read or understood.
    #[error(transparent)]
    Record(#[from] DynamicsError),
}

impl Located for ListenError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Record(error) => error.location(),
            Self::Speed(..) | Self::NoMilling | Self::Teeth { .. } => None,
        }
    }
}

/// What is reported of a recorded cut.
#[derive(Clone, Copy, Debug)]
pub struct ListenRequest<'a> {
    /// Teeth of the cutter.
    pub teeth: u32,
    /// Spindle speed with its unit.
    pub speed: &'a str,
}

impl ListenRequest<'_> {
    /// The spindle speed (rad/s).
    pub(super) fn spindle_speed(&self) -> Result<f64, ListenError> {
        let speed = unit::quantity(self.speed, "rad/s").map_err(|error| ListenError::Speed(error.to_string()))?;
        if speed.is_finite() && speed > 0.0 {
            Ok(speed)
        } else {
            Err(ListenError::Speed(format!("the speed must be positive, is {}", self.speed)))
        }
    }
}
