//! What is measured beside a cut.

/// What the machine measures in cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measurement<N = f64> {
    /// Spindle power without idle power, W.
    pub spindle_power: N,
    /// Feed force, N.
    pub feed_force: N,
    /// Thermo-EMF, V.
    pub thermo_emf: N,
}
