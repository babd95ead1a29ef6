//! Effects that a diagnosis does not try.

use super::EffectId;

/// An effect of the process that the diagnosis did not try.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Untried {
    /// The effect.
    pub id: EffectId,
    /// Why.
    pub reason: String,
}
