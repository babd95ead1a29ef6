//! Cycles of lathes in G code system A.

mod blocks;
mod boxes;
mod drilling;
mod pockets;
mod profile;
mod repeating;

pub(super) use blocks::TwoBlocks;
pub(super) use boxes::Turned;
pub(super) use drilling::Drilling;
