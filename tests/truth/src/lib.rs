//! Shops with a hidden effect, to check the gap diagnosis blindly.
//!
//! Nothing here knows the process models: forces follow Kienzle with an edge term, temperature
//! saturates, wear is abrasion with an exponential run-in plus diffusion, everything integrated by
//! Runge and Kutta in 24 steps an operation; readings are rounded, noisy with memory and outliers.
//!
//! ```text
//!   Case (effects, strength, seed, world) ─► turning ─► CSV of records
//! ```
//!
//! | type | what it is |
//! |---|---|
//! | [`Case`] | what is hidden in a data set |
//! | [`Hidden`] | one hidden cause, in or out of the catalogue |
//! | [`turning`] | a turning cell |
//!
//! ```
//! use toolroom_truth::{Case, turning};
//! let csv = turning::records(&Case::null(1));
//! assert!(csv.starts_with("operation_id,"));
//! assert!(csv.lines().count() > turning::TOOLS * turning::OPERATIONS / 2);
//! ```
//!
//! # What is not modelled
//! Milling, grinding and the shop's events. Anything that would make the world real: it is as plausible as its author could make it
//! without looking at the models that it tests.

mod noise;
mod steel;
pub mod turning;

/// One hidden cause.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hidden {
    /// Word of the catalogue, or of a cause outside it.
    pub id: &'static str,
    /// Strength: 1 is ordinary.
    pub strength: f64,
}

/// What is hidden in a data set.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// Hidden causes; none in a null case.
    pub hidden: Vec<Hidden>,
    /// Seed of everything random.
    pub seed: u64,
    /// Scatter of wear from edge to edge, standard deviation of the logarithm.
    pub scatter: f64,
    /// A world whose forms differ more from those of common models.
    pub stress: bool,
    /// Data sets of the same shop, one after the other: the first is diagnosed, the second new.
    pub fresh: bool,
}

impl Case {
    /// Nothing hidden.
    pub fn null(seed: u64) -> Self {
        Self { hidden: Vec::new(), seed, scatter: 0.10, stress: false, fresh: false }
    }

    /// One hidden cause.
    pub fn one(id: &'static str, strength: f64, seed: u64) -> Self {
        Self { hidden: vec![Hidden { id, strength }], ..Self::null(seed) }
    }

    /// Two hidden causes of ordinary strength.
    pub fn two(a: &'static str, b: &'static str, seed: u64) -> Self {
        Self { hidden: vec![Hidden { id: a, strength: 1.0 }, Hidden { id: b, strength: 1.0 }], ..Self::null(seed) }
    }

    /// The same shop on new edges.
    #[must_use]
    pub fn on_new_edges(&self) -> Self {
        Self { fresh: true, ..self.clone() }
    }

    /// Strength of a cause; zero where it is not hidden here.
    pub(crate) fn strength(&self, id: &str) -> f64 {
        self.hidden.iter().find(|hidden| hidden.id == id).map_or(0.0, |hidden| hidden.strength)
    }
}
