//! Terms that describe a gap of which no cause is known: **empirical, not a cause**.
//!
//! ```text
//!  records ─► seen quantities ─► library of terms ─► choice beside the discrepancy ─► closure on groups that had no part in it
//!                                                          │
//!                                                          ▼
//!                             proposed.toml: effects of a user, kind = "empirical";  the point with them, for `gap apply`
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`proposed()`] | what describes the gap of a process |
//! | [`Proposed`] | the terms as a file, as an entry of `diagnosis.json`, in words, and as a point that can be applied |
//!
//! Every term is written in the language of effects that users define, so that whoever reads the file sees all of it, and may
//! run, point, diagnose and predict with it. A term holds its value at the ends of the range in which its quantity was recorded.
//!
//! # What is not modelled
//! Terms of grinding, of logs of shops, of part programs and of empirical models; roughness, vibration and times, which no
//! effect of a user moves; the time of day.

#![deny(clippy::wildcard_enum_match_arm)]

mod library;
mod proposed;
mod seen;

pub use proposed::{DescriptionRequest, NOTHING, Proposed, is_open, proposed};
