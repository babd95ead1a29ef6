//! What an edge does in a pass, apart from the shop about it.
//!
//! A pass is planned as a whole on a copy of the edge's state, up to its end or the loss of the edge, and planned again for a
//! shorter time when it is interrupted. The shop says when passes begin and end; nothing here knows jobs, queues or a clock.
//!
//! | module | what it is |
//! |---|---|
//! | [`cut`] | [`Segment`]: a stretch of cutting under one command, planned on a process |
//! | [`edge`] | [`Edge`]: what is mounted in a machine, and what is drawn for it |
//! | [`ports`] | where the quantities of the shop sit in the slices of a process |
//! | [`program`] | [`Program`]: commands that change at set instants of one pass |
//! | [`reaction`] | [`Reaction`]: what a machine has learnt about chatter |
//! | [`tool_plan`] | a tool as the engine sees it, and how long its passes take |
//! | [`vibration`] | [`Vibration`](vibration::Vibration): the stretches in which a segment is unstable |
//! | [`workpiece`] | [`Piece`], [`Surface`]: a workpiece as its operation finds and leaves it |

#![deny(clippy::wildcard_enum_match_arm)]

pub mod cut;
pub mod cut_fault;
pub mod edge;
pub mod ports;
pub mod program;
pub mod reaction;
pub mod tool_plan;
pub mod vibration;
pub mod workpiece;

pub use cut::Segment;
pub use edge::Edge;
pub use program::{Block, Program};
pub use reaction::Reaction;
pub use workpiece::{Piece, Surface};
