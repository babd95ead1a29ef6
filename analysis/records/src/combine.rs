//! How the samples of an operation become one number.

/// How the samples of an operation become one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Combine {
    /// Their mean.
    Mean,
    /// Their median.
    Median,
    /// The first that is there.
    First,
    /// The last that is there.
    Last,
    /// The least.
    Min,
    /// The greatest.
    Max,
    /// Their sum.
    Sum,
}

pub(super) const COMBINES: &[&str] = &["mean", "median", "first", "last", "min", "max", "sum"];

impl Combine {
    pub(super) fn named(name: &str) -> Option<Self> {
        let all = [Self::Mean, Self::Median, Self::First, Self::Last, Self::Min, Self::Max, Self::Sum];
        COMBINES.iter().position(|known| *known == name).map(|i| all[i])
    }
}
