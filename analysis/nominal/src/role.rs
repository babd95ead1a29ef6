//! What a number that calibration moves stands for.

/// What a parameter or a surface of a nominal model stands for: which words a scenario has for it, and whether what it takes
/// up is a finding.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Role {
    /// A constant of the model, or the level of a channel.
    Constant,
    /// The time of loading and unloading.
    HandlingTime,
    /// The gain of a sensor at the machine of this name.
    MachineGain(String),
    /// The form error that the fixture of the part of this name leaves.
    Fixture(String),
    /// What the form of the equations may be off by.
    Allowance,
}

impl Role {
    /// Whether it is part of the form allowance rather than of the calibration.
    pub fn is_allowance(&self) -> bool {
        *self == Self::Allowance
    }

    /// Whether it is the gain of a sensor.
    pub fn is_gain(&self) -> bool {
        matches!(self, Self::MachineGain(_))
    }
}
