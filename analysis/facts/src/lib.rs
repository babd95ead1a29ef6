//! Facts: what a log counts and no channel predicts.
//!
//! ```text
//!  recorded times and counts ─┐
//!                             ├─► test against the file's distribution ─► Fact: p, estimate, interval, least seen
//!  Distribution of the file ──┘                                              └─► Finding, where p is below its level
//! ```
//!
//! | module | question |
//! |---|---|
//! | [`count`] | are there as many events as the file says (Poisson, binomial; exact, mid-p)? |
//! | [`renewal`] | the same where intervals are not exponential (replicated counts) |
//! | [`failures`] | time between failures of a machine or pool, with censored exposure; shape of the intervals |
//! | [`times`] | do repairs, setups, changes, handling last and scatter as the file says? |
//! | [`middle`] | do changes and handling last as long as the file says, and would a cause of the catalogue show it? |
//! | [`spread`] | do times scatter as the file says, whatever their middle? |
//! | [`arrivals`] | do as many jobs come, and as evenly? |
//! | [`agreement`] | which machines of a pool share a constant? |
//! | [`scrap`] | are as many pieces scrapped as in the simulated shop (two shares; exact, mid-p)? |
//! | [`survival`] | do edges live as long as simulated ones (log-rank, censored)? |
//! | [`normal_scale`] | where would times of a distribution lie if their logarithms were normal? |
//! | [`waits`] | do queues wait as replicated ones do (days are blocks)? |
//!
//! A fact has no cause: it is a constant of the file that the log contradicts.
//!
//! # Source
//! Mid-p: Lancaster 1961; interval of a rate: Garwood 1936; combination of tests: Fisher 1932;
//! two shares: Fisher 1935; log-rank: Mantel 1966; dispersion of counts: Cox and Lewis 1966.
//!
//! # Not modelled
//! Intervals that depend on each other, failure modes that share a clock, calendars within which a rate
//! changes.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

pub mod agreement;
pub mod arrivals;
mod clock;
pub mod count;
mod fact;
pub mod failures;
pub mod law;
pub mod middle;
pub mod normal_scale;
pub mod renewal;
pub mod scrap;
pub mod spread;
pub mod survival;
pub mod times;
mod told;
pub mod waits;

pub use fact::{Fact, Finding, Quantity, adjusted, findings, slight};
pub use told::{Delay, FactDetail};
