//! What a command writes, and what it leaves alone.
//!
//! | place | who |
//! |---|---|
//! | a folder of results (`--out`) | [`OutputDir`]: a draft, a list of files with hashes, a lock |
//! | a single file that an option names | [`Files`]: a list beside the file |
//! | work that is not complete | [`OutputDir::journal`]: what is finished, for going on |
//! | an end by SIGINT or SIGTERM, or for memory | [`signals`]: no draft and no lock stays |
//! | the bound of memory | [`memory`] |
//! | the faults of a file | [`shown_faults`], [`json_faults`], [`json_refusal`] |
//! | any other error | [`codes`], [`json_error`] |
//! | how far long work is | [`Bar`], [`progress`] |
//!
//! Nothing that toolroom did not write is replaced or removed, but by force; an input of the command never.
//!
//! # What is not modelled
//! A file system that loses what was renamed when the power fails: files are not written through to the disk.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

pub mod codes;
mod error;
mod excerpt;
mod files;
mod folder;
mod lines;
mod listed;
mod lock;
pub mod memory;
pub mod progress;
mod provenance;
mod reported;
pub mod signals;

pub use error::OutputError;
pub use excerpt::{json_faults, json_refusal, shown_faults};
pub use files::{Draft, Files};
pub use folder::OutputDir;
pub use lines::fitted;
pub use progress::Bar;
pub use provenance::{provenance, quoted};
pub use reported::{bounded, json_error};
