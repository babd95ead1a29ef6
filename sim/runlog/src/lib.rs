//! What a run of a shop leaves behind.
//!
//! | module | what it is |
//! |---|---|
//! | [`runlog`] | the tables of a run: one row for each fact, in SI |
//! | [`recorder`] | who writes them down: [`RunLog`](runlog::RunLog), nobody, or whoever counts while a shop runs |

#![deny(clippy::wildcard_enum_match_arm)]

mod log_event;
pub mod recorder;
pub mod runlog;
mod whole_job;
