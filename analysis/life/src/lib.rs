//! Tool lives: what a sample of them says about the life of the next edge.
//!
//! ```text
//!  lives, censored or not ─► Sample ─► fit ─► Law: R(t), hazard, B10, residual life
//!       (a CSV file,            │       ├──► profile intervals, AICc, Anderson–Darling
//!        a Monte Carlo study)   │       └──► replacement: best age, cost per time
//!                               ├──► survival: Kaplan–Meier, Turnbull
//!                               ├──► bootstrap: bands of all of these
//!                               └──► regression: extended Taylor law with prediction bands
//! ```
//!
//! | module | what it does |
//! |---|---|
//! | [`sample`] | lives: failed, right-censored, between two inspections; weights |
//! | [`law`] | Weibull with two and three parameters, lognormal, normal, gamma, inverse Gaussian, competing risks |
//! | [`fit`] | maximum likelihood, profile-likelihood intervals, AICc |
//! | [`goodness`] | Anderson–Darling distance, its p by parametric bootstrap |
//! | [`survival`] | reliability without a law |
//! | [`bootstrap`] | refits to resampled data, bands |
//! | [`regression`] | life against speed, feed, depth and groups |
//! | [`replacement`] | when an edge is best replaced, by age or in blocks |
//! | [`analysis`] | all of it in one go |
//! | [`measured`] | lives and wear readings from CSV files |
//! | [`measured_study`] | laws of measured lives and of their groups, with text, JSON and report |
//! | [`picture`], [`page`] | the same as charts, report sections and JSON |
//! | [`study`] | Monte Carlo studies |
//! | [`mod@file`] | files of such studies |
//! | [`maximise`] | the search that the fits use |
//!
//! Times are in any one unit; results come in the same.

#![deny(clippy::wildcard_enum_match_arm)]

pub mod analysis;
pub mod bootstrap;
mod claims;
pub mod file;
pub mod fit;
pub mod goodness;
pub mod law;
pub mod maximise;
pub mod measured;
mod measured_error;
pub mod measured_study;
mod normal;
pub mod page;
pub mod picture;
pub mod regression;
pub mod replacement;
pub mod sample;
pub mod study;
pub mod survival;

pub use claims::claims;
