//! The gap diagnosis from files to documents.
//!
//! ```text
//!  MODEL.toml … ─► tables: each model with its records ─► GapStudy ─► diagnosis.json, predictions, report
//!  DATA ─────────┘                                                        │ applied to the model
//!                                                                         ▼
//!                                       Figures: recorded shop, nominal model, model with the effects
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`tables()`], [`Table`] | which model reads which table of a data set |
//! | [`GapStudy`], [`GapRequest`] | the diagnosis of a data set, with its documents |
//! | [`figures()`], [`Figure`] | what the effects do to the key figures of a shop |
//! | [`Replicated`], [`Closed`] | how far a key figure closes, with its interval |
//! | [`recorded()`] | a simulated run as the sensors of its file would have recorded it |
//! | [`recovery()`], [`rates()`] | whether what simulated shops hide is found again, counted over many runs |
//! | [`user_effects()`], [`usable()`] | effects of users from their files; that they give values in recorded operations |
//! | [`GapStudyError`] | why there is none, and the likely fix |
//!
//! # What is not modelled
//! Nothing is written here: documents are handed out as texts, the records of a recovery study to whoever puts them into
//! files. Reading Parquet is left to the caller, who hands in a reader.

#![deny(clippy::wildcard_enum_match_arm)]

mod closed;
mod constants;
mod error;
mod figures;
mod jobs;
mod known;
mod machines;
mod parts;
mod rates;
mod recorded;
mod recovery;
mod request;
mod study;
mod tables;
mod user_effects;

pub use closed::{Closed, Replicated};
pub use error::GapStudyError;
pub use figures::{Figure, figures, table};
pub use rates::{RecoveryRate, rates, rates_table};
pub use recorded::{RECORDED, recorded};
pub use recovery::{
    ClosedFigure, FileWriter, Finding, GivenName, HiddenEntry, RecoveredLog, RecoveryRequest, recovery,
};
pub use request::{GapRequest, Reading};
pub use study::{GapStudy, NAMES};
pub use tables::{Table, tables};
pub use user_effects::{UserEffectsError, usable, user_effects};
