//! The report of a gap diagnosis for the engineer of a plant.
//!
//! ```text
//!  Diagnosis ─┐
//!             ├─► Page ─► sentence · pictures · minutes and money ─► report.html, report.md, report.json
//!  Readings ──┘
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Readings`] | every measured value with what the model says of it: as its file stands, calibrated, and with each named effect |
//! | [`Page`] | a process with its diagnosis, readings and rates |
//! | [`sentence()`] | the answer in words, for every verdict |
//! | [`html`], [`markdown`], [`json`] | the three forms; all figures of the first two are in the third |
//!
//! # Not modelled
//! Minutes are those of the recorded operations by their predictions, not of a shop that runs anew: what a shorter cycle does to
//! queues and idle times is not in them. Breakdowns and repairs are facts of their own and are not in the minutes either.

#![deny(clippy::wildcard_enum_match_arm)]

mod catalogue;
mod forms;
mod minutes;
mod pictures;
mod places;
mod readings;
mod sentence;

pub use catalogue::{catalogue_json, catalogue_page, catalogue_text, vocabulary_json, vocabulary_text};
pub use forms::{Page, html, json, markdown};
pub use minutes::{Minutes, Rates, Step};
pub use readings::{Place, ReadChannel, Reading, Readings};
pub use sentence::sentence;

/// Seconds of a day.
const DAY: f64 = 86400.0;
/// Seconds of a week.
const WEEK: f64 = 7.0 * DAY;
