//! Whether the scores of a model are what the model says of them: standard normal.
//!
//! A score is a residual in units of what the model predicts for its scatter. [`Statistics`] sums the
//! scores of a channel up in six numbers, each of which grows with one kind of misfit. [`judge`] holds
//! all numbers of all channels against those of data sets that the model drew itself, and
//! answers with one probability for everything that was asked.
//!
//! | item | what it is |
//! |---|---|
//! | [`Design`] | a linear model of groups, and the scores of groups that it predicts from the others |
//! | [`Channel`] | how the scores of a channel lie: groups in sequence, covariates |
//! | [`Statistics`] | six numbers of the scores of a channel |
//! | [`Structured`] | how much of the scores of a channel has an order |
//! | [`judge`] | one probability over all of them, and one of each |
//! | [`interpolated`] | the size of a deviation that has a given power |
//!
//! # Source
//! Refitted parametric bootstrap: Bayarri & Berger 2000 on why posterior predictive probabilities will
//! not do. The greatest of standardised statistics: Westfall & Young 1993, with differences from the
//! median over the upper spread in place of ranks, which tie. Anderson & Darling 1954.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod design;
mod judged;
mod statistics;
mod structured;

pub use design::{Design, Group};
pub use judged::{Judged, interpolated, judge};
pub use statistics::{Channel, Statistic, Statistics};
pub use structured::Structured;
