//! Motions whose feed is not planned.

/// Why motions at feed keep the feed of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum AsProgrammed {
    /// Straight down, threads, canned cycles, rotary axes: their forces are not modelled.
    Motion,
    /// The spindle stands or turns counterclockwise.
    Spindle,
    /// The tool has no parameter set: its feed is never raised in material.
    Tool,
}

impl AsProgrammed {
    /// In words.
    pub fn reason(self) -> &'static str {
        match self {
            Self::Motion => "straight down, canned cycles, threads or rotary axes",
            Self::Spindle => "the spindle does not turn clockwise",
            Self::Tool => "the tool has no parameter set, so it is not made faster in material",
        }
    }
}
