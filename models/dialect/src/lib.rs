//! What the languages of part programs share: which of them a text is in, the expressions of all, and the faults of blocks.
//!
//! | item | what it is |
//! |---|---|
//! | [`Dialect`], [`Detector`], [`Conflict`] | the language of a control, found from the text |
//! | [`Expression`], [`Parser`], [`Variables`] | expressions: one tree, one evaluation and one parser for all languages |
//! | [`Fault`] | what is wrong in a block, before it is known where the block stands |
//!
//! # What is not modelled
//! Statements and motions: the crate `toolroom-program` reads and follows them.

#![deny(clippy::wildcard_enum_match_arm)] // a language that comes has to be thought of everywhere

mod detect;
mod expression;
mod fault;

pub use detect::{Conflict, Detector, Dialect};
pub use expression::{Expression, Function, Operator, Parser, Variables, equal};
pub use fault::Fault;
