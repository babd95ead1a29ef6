//! Watching a shop for a change, block by block, with a promised rate of false alarms.
//!
//! ```text
//!  value of a block ─► rank among all blocks of its stream ─► normal score ─► e-detector ─► alarm ─► date of the change
//!  count of a block, expected count ─────────────────────────────────────────────┘
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`conformal_score`] | normal score of a randomised rank: standard normal under any exchangeable noise |
//! | [`Detector`], [`RareDetector`] | Shiryaev–Roberts statistics of scores, and of counts |
//! | [`Change`] | posterior of the block after which the scores moved |
//! | [`Watch`] | streams with their state, resumable and idempotent; looks at the records of a nominal model |
//! | [`Look`] | what a look has shown |
//!
//! The statistic of a detector less the number of its blocks is a martingale for every null distribution, so that an
//! alarm at the threshold A comes within t blocks with probability t/A at most, without any table.
//!
//! # Source
//! e-detectors: Shin, Ramdas and Rinaldo 2022; conformal martingales: Vovk, Gammerman and Shafer 2005; Roberts 1966.
//!
//! # Not modelled
//! Trends within the null (wear that nobody resets), seasons, streams that share one cause: each is watched by itself.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod blocks;
mod change;
mod conformal;
mod detector;
mod look;
mod watch;

pub use blocks::time_column;
pub use change::Change;
pub use conformal::conformal_score;
pub use detector::{Detector, RareDetector};
pub use look::Look;
pub use watch::{Alarm, Block, FEWEST_BLOCKS, Reading, StateError, Watch};

/// Every code of the faults of a watch, with its explanation.
pub const CODES: &[(&str, &str)] = &[(
    "watch-state",
    "`toolroom gap watch --state FILE` goes on where the last look stopped. The file belongs to one model with one set of values: with another one the ranks in it would mean something else. Give another file to begin anew, or the model that the state was begun with.",
)];
