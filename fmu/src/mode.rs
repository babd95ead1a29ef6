//! Where an instance is in its life.

use std::fmt;

/// State of the FMI state machine. Both versions share it; a co-simulation unit of FMI 2.0 that
/// is ready for a step is in [`Mode::Step`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Made, not initialised.
    Instantiated,
    /// Initialization Mode.
    Initialization,
    /// Event Mode.
    Event,
    /// Continuous-Time Mode of Model Exchange.
    Continuous,
    /// Step Mode of Co-Simulation.
    Step,
    /// Terminated.
    Terminated,
}

impl Mode {
    /// Number in a serialised state.
    pub(crate) fn code(self) -> u8 {
        self as u8
    }

    /// The mode of a number.
    pub(crate) fn from_code(code: u8) -> Option<Self> {
        let all =
            [Self::Instantiated, Self::Initialization, Self::Event, Self::Continuous, Self::Step, Self::Terminated];
        all.into_iter().find(|mode| mode.code() == code)
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Instantiated => "the instantiated state",
            Self::Initialization => "Initialization Mode",
            Self::Event => "Event Mode",
            Self::Continuous => "Continuous-Time Mode",
            Self::Step => "Step Mode",
            Self::Terminated => "the terminated state",
        })
    }
}
