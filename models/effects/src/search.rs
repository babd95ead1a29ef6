//! How a diagnosis looks for an effect.

/// How the diagnosis looks for an effect in records of one process, or why it does not.
///
/// Sizes are ordinary ones, SI: the scale of steps and priors. They and the values of shapes are assumptions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Search {
    /// At its default shape, around this size.
    Size(f64),
    /// At its default shape, around a share of the median of a recorded column.
    ShareOfMedian {
        /// Column of the records.
        column: &'static str,
        /// Size over the median.
        share: f64,
    },
    /// At its default shape, around the size that makes a given change where a quantity of the [`Context`](crate::Context) is
    /// greatest. Records in which the quantity does not vary cannot show the effect.
    AtGreatest {
        /// Field of the context.
        quantity: &'static str,
        /// Size times the greatest value.
        change: f64,
        /// The same of the greatest size that is admitted; infinite where the range of the size is the only bound.
        most: f64,
    },
    /// At several values of one parameter of its shape.
    Values {
        /// The parameter.
        parameter: &'static str,
        /// Its values, SI.
        values: &'static [f64],
        /// Column that tells the values apart, and the only value that is tried where the column does not vary.
        told_by: Option<(&'static str, f64)>,
        /// Size.
        size: f64,
    },
    /// In windows over the range of a column, with the width of the catalogue and a narrow one.
    Window {
        /// Column of the records.
        column: &'static str,
        /// Parameter that is the middle of the window.
        centre: &'static str,
        /// Parameter that is its width, and the narrow width.
        width: (&'static str, f64),
        /// Number of windows over the range.
        count: usize,
        /// Size.
        size: f64,
    },
    /// At its default shape, where a recorded column falls below a bound.
    Below {
        /// Column of the records.
        column: &'static str,
        /// Bound, SI.
        bound: f64,
        /// Size.
        size: f64,
    },
    /// Lot by lot: [`Context::lot_deviation`](crate::Context::lot_deviation) is 1 on the rows of one lot.
    Lots(f64),
    /// Coolant by coolant, as a factor 1 − size on the process stiffness of grinding on the rows of one coolant.
    CoolantStiffness(f64),
    /// Once for wheels that find contact with each part, once for wheels that are positioned by command since the
    /// dressing.
    WheelPosition {
        /// Size of the first.
        each_part: f64,
        /// Size of the second; what a wheel loses adds up over the parts.
        since_dressing: f64,
    },
    /// By shapes that the diagnosis of shop logs, part programs or power laws makes from what they record.
    Shaped,
    /// Not at all, and why.
    Untried(&'static str),
}
