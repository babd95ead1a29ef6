//! Linear algebra of evidence over normal equations.
//!
//! ```text
//!  whitened columns by group ─► Gram (groups' own factors eliminated) ─► solution, evidence, marginal likelihood
//! ```
//!
//! [`amplitudes`] estimates how large groups of columns are, and [`matern_columns`] gives those of a smooth process.
//!
//! Nothing here knows a model or a channel: what is asked of a [`Gram`] is how well some of its columns explain the last
//! one, in all groups and in those that were left out.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod amplitude;
mod evidence;
mod factor;
mod gram;
mod kernel;
mod matrix;

pub use amplitude::amplitudes;
pub use evidence::{
    EFFECT_PRIOR, Evidence, Factored, evidence, gain, left_out_solutions, marginal, predictive_gain, solution, within,
};
pub use factor::{Factor, factor};
pub use gram::{Batch, Fold, Gram};
pub use kernel::matern_columns;
pub use matrix::{crossed, part, part_column, squared};
