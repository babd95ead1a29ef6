//! Constants by which the diagnosis decides.

/// Score at which an effect counts as detectable.
pub(super) const DETECTABLE: f64 = 5.0;
/// Score, at the size that was fitted, that a named effect needs: smaller ones are as often the
/// work of causes that no catalogue has (blind checks on shops that were used for development).
pub(super) const CONVINCING: f64 = 4.5;
