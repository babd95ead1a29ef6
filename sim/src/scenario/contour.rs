//! Contours that mills run, and the regimes that policies choose for them.

/// How spindle speeds and feeds of a contour are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContourRule {
    /// The handbook regime: one table feed for the whole contour.
    HandbookOneFeed,
    /// The handbook regime with a feed override for each section.
    HandbookPerSection,
    /// The one spindle speed and feed of least cost.
    BestConstant,
    /// Least time, section by section.
    Time,
    /// Least cost, section by section.
    Cost,
}
