//! The blind benchmark of the gap diagnosis: effects that are hidden in shops of other equations.
//!
//! Every case is a shop of `toolroom-truth`, whose equations, integrator and noise are none of the models'. It is
//! diagnosed with the shipped nominal model of its process; what was hidden is looked at only afterwards.
//!
//! ```text
//!  Selection ──► cases ──► diagnose ──► Row, one a case ──► Benchmark: rates against gates, ablation
//! ```
//!
//! # What is not modelled
//! A case says how right a diagnosis is on simulated shops; it says nothing about shops whose noise is of another kind.

#![deny(clippy::wildcard_enum_match_arm)]

mod benchmark;
mod error;
mod judged;
mod markdown;
mod method;
mod power;
mod reliability;
mod row;
mod selection;
mod shrunk;
mod tally;

pub use benchmark::{Benchmark, NAMES, diagnose, gather};
pub use error::BlindError;
pub use power::{Power, power};
pub use reliability::{Bin, Blamed, blamed, calibration_error, reliability};
pub use row::{Mark, Row};
pub use selection::Selection;
pub use tally::{Ablation, Closed, Rate, Tally};
