//! Work in parts: a plan is cut into shards, each leaves a part with a sidecar, parts are merged.
//!
//! ```text
//!  Plan ─► shard k of N ─► part-K.parquet (rows, where there are some)
//!                     └──► part-K.json: hash of the plan, range, hash of the rows, content, hash of all that ─► merge
//! ```
//!
//! A part is written under another name and renamed when it is whole, its sidecar last: what has
//! a sidecar is complete. Running a shard again changes nothing.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod draft;
mod error;
mod fingerprint;
mod journal;
mod merge;
mod plan;
mod run;
mod sidecar;

pub use draft::nothing_more;
pub use error::{ShardError, at};
pub use fingerprint::{FNV_OFFSET, fingerprint, fnv, hash_of};
pub use journal::Journal;
pub use merge::parts;
pub use plan::{Axis, PLAN, Plan, Work, read_plan, write_plan};
pub use run::{Computed, discard, is_done, run};
pub use sidecar::Sidecar;

#[cfg(test)]
mod tests;
