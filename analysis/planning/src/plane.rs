//! Pictures of paths in true proportion.

use toolroom_chart::Axis;

/// Width of a plot area with short tick labels, pixels.
const WIDTH: f64 = 705.0;
/// Least and greatest height of a picture, pixels.
const HEIGHT: (f64, f64) = (150.0, 420.0);

/// Both axes with a margin, and the height of a picture in which a unit of one is as long as a unit of the other. Too tall or
/// too flat for the page, the shorter axis gets more room.
pub(crate) fn in_proportion(
    (across, left, right): (Axis, f64, f64),
    (up, low, high): (Axis, f64, f64),
) -> (Axis, Axis, f64) {
    let margin = (0.05 * (right - left).max(high - low)).max(1e-3);
    let (mut tall, mut wide) = (high - low + 2.0 * margin, right - left + 2.0 * margin);
    let height = (WIDTH * tall / wide).clamp(HEIGHT.0, HEIGHT.1);
    let proportion = WIDTH / height;
    if wide / tall < proportion {
        wide = tall * proportion;
    } else {
        tall = wide / proportion;
    }
    let around = |axis: Axis, middle: f64, span: f64| axis.range(middle - 0.5 * span, middle + 0.5 * span);
    (around(across, 0.5 * (left + right), wide), around(up, 0.5 * (low + high), tall), height)
}
