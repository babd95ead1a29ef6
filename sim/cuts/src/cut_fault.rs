//! Why a cut could not be planned.

use toolroom_process::ModelError;

/// Why a segment could not be planned.
#[derive(Debug)]
pub enum CutFault {
    /// The model refused.
    Model(ModelError),
    /// The model raises events and does not move.
    Stuck,
}

/// Events in a row without progress after which a process counts as stuck.
pub const STUCK: u32 = 64;
