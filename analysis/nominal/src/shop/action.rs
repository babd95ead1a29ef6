//! What a candidate does to a block.

use toolroom_scenario::Scope;

/// What a candidate does to a block.
pub(super) enum Action {
    /// Longer cutting, by share, on blocks by weight.
    Slower(Vec<f64>),
    /// Longer cutting by the overrides that are recorded; the share that they add to the time of all operations.
    Overridden(f64),
    /// Longer handling on blocks by weight, s.
    Delay(Vec<f64>),
    /// Longer changes of edges.
    Change(Vec<f64>),
    /// Short stops that show in cutting times only, on blocks by weight.
    Stops(Vec<f64>),
    /// Short stops that are booked.
    Booked,
    /// Time per hold; the holds of an operation in the mean.
    Hold(f64),
    /// Inverse of the acceleration, by program.
    Acceleration(Vec<f64>),
    /// Later changes of edges.
    Policy,
    /// Regular breakdowns.
    Breakdowns,
}

impl Action {
    /// What distinguishes a candidate from others of its effect, for people: where it acts, or what of the records it follows.
    pub fn shape(&self, scope: &Scope) -> String {
        match self {
            Self::Overridden(_) => "as recorded".to_owned(),
            Self::Booked => "booked".to_owned(),
            Self::Slower(_)
            | Self::Delay(_)
            | Self::Change(_)
            | Self::Stops(_)
            | Self::Hold(_)
            | Self::Acceleration(_)
            | Self::Policy
            | Self::Breakdowns => scope.words(),
        }
    }
}
