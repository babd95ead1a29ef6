//! What a gap diagnosis has found, as values of a model.
//!
//! ```text
//!  Diagnosed ─► Applied: posterior mode without form allowance ─► diagnosis.json, predictions
//!                                                                        │
//!  scenario.toml ────────────────────────────────────────────────► edit ─┴─► scenario with it
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Applied`] | calibration and sizes that a scenario can hold, and what they predict |
//! | [`document`] | `diagnosis.json`, schema 2 |
//! | [`apply`] | the text of a model with what a diagnosis has found |
//! | [`marked`] | a model with a mark, by which the next application knows that it may replace it |
//! | [`model_hash`] | the hash by which a diagnosis knows the model that it read |
//! | [`bake()`] | the parameter set of a tool with what a scenario states and calibrates of it |
//! | [`grew()`] | channels from which a model is farther with it than before |
//! | [`predictions()`] | what a model predicts of records, without a fit |
//!
//! # The applied point
//! The posterior mode beside a form allowance decides which effect is named; part of the calibration then sits in
//! terms that no scenario has. What is applied is therefore fitted anew on all fitted groups with allowance, form
//! tolerance and every surface at zero that a scenario cannot hold.
//!
//! # Source
//! Calibration without the discrepancy term: Tuo & Wu 2015 (L2 calibration).
//!
//! # What is not applied
//! Scatter, tails and skewness of the blocks of a shop's log, and the coefficients of empirical models.

#![deny(clippy::wildcard_enum_match_arm)]

mod applied;
mod bake;
mod constants;
mod difference;
mod document;
mod edit;
mod effects;
mod error;
mod grew;
mod hash;
mod mark;
mod predict;
mod program;
mod scope;
mod values;

pub use applied::{Applied, AppliedEffect, Constant, applied_to};
pub use bake::{BakeError, Baked, bake};
pub use difference::changed_lines;
pub use document::{PredictionRow, Process, SCHEMA, document, point_json, predictions_of, scope_json};
pub use edit::{Changes, Request, apply};
pub use error::ApplyError;
pub use grew::{Grew, grew};
pub use hash::model_hash;
pub use mark::{is_marked, marked};
pub use predict::{Prediction, predictions};
