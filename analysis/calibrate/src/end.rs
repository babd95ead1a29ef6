//! How an edge ended.

/// How an edge ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum End {
    /// Worn out.
    Worn,
    /// Chipped.
    Chipped,
    /// Broken.
    Broken,
    /// Still good when the record ends.
    Stopped,
    /// Changed before it was worn out.
    Changed,
}

impl End {
    pub(crate) const ALL: [Self; 5] = [Self::Worn, Self::Chipped, Self::Broken, Self::Stopped, Self::Changed];

    /// Word in records.
    pub fn name(self) -> &'static str {
        match self {
            Self::Worn => "worn",
            Self::Chipped => "chipped",
            Self::Broken => "broken",
            Self::Stopped => "stopped",
            Self::Changed => "changed",
        }
    }
}
