//! Numerical methods that several rooms need.
//!
//! | function | what it finds |
//! |---|---|
//! | [`order_quantile`] | the value below which a share of a sample lies |
//! | [`rank_quantile`] | the least value of a sample that a share of it does not exceed |
//! | [`inverse`] | the value at which a distribution function reaches a share |
//! | [`gamma_quantile`] | the same for the gamma distribution |
//! | [`beta_quantile`] | the same for the beta distribution |

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod inverse;
mod quantile;

pub use inverse::{beta_quantile, gamma_quantile, inverse};
pub use quantile::{order_quantile, rank_quantile};
