//! Part programs as shops have them: read in the languages of six controls, followed block by block, timed.
//!
//! ```text
//!  text ─► Dialect ─► statements ─► Run: an iterator of Events ─► Program: Blocks of Motions ─► times(Drives)
//!                     Control ───────┘
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Dialect`] | the language of a control, found from the text |
//! | [`Control`], [`Units`] | what a control adds to the words: units, block skip, times of M codes, tools |
//! | [`Run`] | a program that runs: events in order, in bounded memory |
//! | [`Event`], [`EventKind`], [`Motion`], [`Path`], [`Arc`], [`Offset`] | what happens |
//! | [`Blocks`], [`Block`], [`Program`], [`Stretch`] | the blocks of a program, one after the other or all |
//! | [`Machine`], [`Drives`] | a machine file or a preset: its control; feed drives, spindle and tool changer |
//! | [`Timer`], [`Spent`], [`Part`] | how long blocks take with them, and on what |
//! | [`post()`], [`Post`] | a program in the words of another control |
//! | [`ProgramError`] | line, column, language, word and fix of what is not understood |
//!
//! A word that is not understood could move an axis or take time. So every word of a block has to be understood, or
//! the program is refused.
//!
//! # Units
//! Lengths and positions are mm and degrees, as in programs; angles of arcs are rad, times s, speeds of the spindle rpm.
//! [`Drives`] and `rapid_speed` are SI, as all records are: m/s, m and s²/m.
//!
//! # What is not modelled
//! Motions of five axes with control of the tool's tip, tilted planes, probing, contour cycles of the controls, mill-turn.
//! Reference points and work offsets that a program does not state: axes that come from there count as standing.

#![deny(clippy::wildcard_enum_match_arm)] // a kind of event or word that comes has to be thought of everywhere
#![allow(clippy::needless_range_loop)] // an axis is an index into several arrays at once

mod block;
mod control;
mod dialect;
mod drives;
mod error;
mod expression;
mod frame;
mod hole;
mod iso;
mod kernel;
mod klartext;
mod lathe;
mod library;
mod machine;
mod motion;
mod offset;
mod post;
mod run;
mod siemens;
mod spindle;
mod stretch;
mod timing;

pub use block::{Action, Block, Blocks, Program};
pub use control::{Control, Units};
pub use dialect::{Conflict, Dialect};
pub use drives::Drives;
pub use error::ProgramError;
pub use machine::{CODES, DRIVES, MACHINE, Machine, PRESETS, drives};
pub use motion::{AXES, Arc, Axes, Event, EventKind, Motion, Offset, Path, Purpose, Sense};
pub use post::{Post, post};
pub use run::Run;
pub use stretch::{Stretch, StretchKind};
pub use timing::{Part, Spent, Timer};
