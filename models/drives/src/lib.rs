//! How long part programs take on a machine: its drives, its spindle and its tool changer.
//!
//! | item | what it is |
//! |---|---|
//! | [`Machine`], [`Drives`] | a machine file or a preset: its control; feed drives, spindle and tool changer |
//! | [`Timer`], [`Spent`], [`Part`] | how long blocks take with them, and on what |
//! | [`times()`] | the time of each block of a program |
//! | [`Deviation`] | how a machine differs from the drives that its file states |
//!
//! # Units
//! [`Drives`] are SI, as all records are: m/s, m and s²/m.

#![deny(clippy::wildcard_enum_match_arm)] // a kind of event that comes has to be thought of everywhere
#![allow(clippy::needless_range_loop)] // an axis is an index into several arrays at once

mod deviation;
mod machine;
mod record;
mod spindle;
mod timing;

pub use deviation::Deviation;
pub use machine::{CODES, DRIVES, MACHINE, Machine, PRESETS, drives};
pub use record::Drives;
pub use timing::{Part, Spent, Timer, times};
