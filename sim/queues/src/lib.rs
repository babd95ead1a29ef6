//! Queues of waiting jobs, kept in the way that their dispatching rules ask for.
//!
//! | module | what it is |
//! |---|---|
//! | `keys` | the key of a job under each rule: the least goes first |
//! | `queue` | jobs that wait at a machine, and which of them is taken |
//! | `heap` | jobs whose keys stand |
//! | `tournament`, `kinetic` | jobs whose keys move with the clock |
//!
//! What it does not know: machines, operators, stations. Whoever asks for a job gives the facts that the rules look at.

#![deny(clippy::wildcard_enum_match_arm)]

mod entry;
mod heap;
mod keys;
mod kinetic;
mod queue;
mod tournament;

pub use entry::{Facts, Keys, QueueEntry, Ranked};
pub use keys::{Measures, Moment, keys};
pub use kinetic::Plan;
pub use queue::{Queue, QueueKind};
