//! Part programs as shops have them: read in the languages of six controls, followed block by block.
//!
//! ```text
//!  text ─► Dialect ─► statements ─► Run: an iterator of Events ─► Program: Blocks of Motions
//!                     Control ───────┘
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Dialect`] | the language of a control, found from the text |
//! | [`Control`], [`Units`] | what a control adds to the words: units, block skip, times of M codes, tools |
//! | [`Source`] | the text of a program, in memory or in its file |
//! | [`Run`], [`ModalState`], [`FeedMode`] | a program that runs: events in order, in bounded memory, and what holds in it |
//! | [`Event`], [`EventKind`], [`Motion`], [`Path`], [`Arc`], [`Offset`] | what happens |
//! | [`Blocks`], [`Block`], [`Program`], [`Stretch`] | the blocks of a program, one after the other or all |
//! | [`ProgramError`] | line, column, language, word and fix of what is not understood |
//!
//! A word that is not understood could move an axis or take time. So every word of a block has to be understood, or
//! the program is refused.
//!
//! # Units
//! Lengths and positions are mm and degrees, as in programs; angles of arcs are rad, times s, speeds of the spindle rpm.
//! What a machine adds to the times is `toolroom-drives`; a `rapid_speed` is SI. `toolroom-post` writes the motions for another
//! control.
//!
//! # What is not modelled
//! Motions of five axes with control of the tool's tip, tilted planes, probing, contour cycles of the controls, mill-turn.
//! Reference points and work offsets that a program does not state: axes that come from there count as standing.

#![deny(clippy::wildcard_enum_match_arm)] // a kind of event or word that comes has to be thought of everywhere
#![allow(clippy::needless_range_loop)] // an axis is an index into several arrays at once

mod block;
mod control;
mod error;
mod frame;
mod hole;
mod iso;
mod joint;
mod kernel;
mod klartext;
mod lathe;
mod library;
mod motion;
mod offset;
mod run;
mod siemens;
mod stretch;

pub use block::{Action, Block, Blocks, Program};
pub use control::{Control, Units};
pub use error::ProgramError;
pub use kernel::FeedMode;
pub use motion::{AXES, Arc, Axes, Event, EventKind, Motion, Offset, PLANES, Path, Purpose, Sense, plane_code};
pub use run::{ModalState, Run};
pub use stretch::{Stretch, StretchKind};
pub use toolroom_dialect::{Conflict, Dialect};
pub use toolroom_pages::Source;
