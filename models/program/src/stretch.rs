//! Parts of a program that can be timed one by one.

use crate::{Block, Program};
use std::ops::Range;

/// What a stretch of blocks does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StretchKind {
    /// A tool change with everything before and behind it that is no cut.
    Change,
    /// Auxiliary functions: spindle, coolant, program end.
    Auxiliary,
    /// Holes by canned cycles.
    Holes,
    /// Motions.
    Motion,
}

/// Blocks of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// What they do.
    pub kind: StretchKind,
    /// Indices of the blocks in [`Program::blocks`].
    pub blocks: Range<usize>,
}

fn kind(block: &Block) -> Option<StretchKind> {
    if block.tool_change {
        Some(StretchKind::Change)
    } else if block.auxiliary {
        Some(StretchKind::Auxiliary)
    } else if block.holes > 0 {
        Some(StretchKind::Holes)
    } else {
        // A motion from a place that only the machine knows has no length of its own.
        let moves = block.motions.iter().any(|motion| motion.nominal(1.0) > 0.0);
        moves.then_some(StretchKind::Motion)
    }
}

impl Program {
    /// Stretches of the program: tool changes, auxiliary functions, holes, and motions of at least
    /// `least` s each at a rapid speed of each axis of `rapid_speed` m/s, where there are so many.
    ///
    /// ```
    /// use toolroom_program::{Control, Program};
    /// let program = Program::read("T1 M6\nG21 G0 X0 Y0 Z1\nG1 Z0 F60\nX10\nX20\nG81 Z-1 R1 X30\nG80\nM30", &Control::default()).unwrap();
    /// let lengths: Vec<usize> = program.stretches(10.0, 0.5).iter().map(|stretch| stretch.blocks.len()).collect();
    /// // Where the first rapid starts is not known: it takes no time of its own.
    /// assert_eq!(lengths, [2, 2, 1, 2, 1]);
    /// ```
    pub fn stretches(&self, least: f64, rapid_speed: f64) -> Vec<Stretch> {
        let mut list: Vec<Stretch> = Vec::new();
        let mut time = 0.0;
        for (index, block) in self.blocks.iter().enumerate() {
            let last = list.last_mut();
            // A block that does nothing goes with those before it.
            let kind_here = kind(block).or(last.as_ref().map(|last| last.kind)).unwrap_or(StretchKind::Auxiliary);
            let joins = last.as_ref().is_some_and(|last| match (last.kind, kind_here) {
                (StretchKind::Motion, StretchKind::Motion) => time < least,
                (StretchKind::Change | StretchKind::Auxiliary, StretchKind::Change | StretchKind::Auxiliary) => true,
                (before, after) => before == after,
            });
            match last {
                Some(last) if joins => {
                    last.blocks.end = index + 1;
                    if kind_here == StretchKind::Change {
                        last.kind = StretchKind::Change;
                    }
                }
                _ => {
                    list.push(Stretch { kind: kind_here, blocks: index..index + 1 });
                    time = 0.0;
                }
            }
            time += block.nominal(rapid_speed);
        }
        list
    }
}
