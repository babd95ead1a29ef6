//! Charts of rows: a label on the left, something horizontal on the right.

use super::axis::{Axis, Scale};
use super::frame;
use super::svg::{Anchor, Area, Canvas, FONT, WIDTH, fit, text_width};

/// The plot area right of the labels.
pub(crate) struct Rows {
    pub area: Area,
    pub x: Scale,
    row: f64,
}

/// Rows of the usual height (assumption: as many fill half a screen).
const USUAL_ROWS: usize = 12;

impl Rows {
    /// Height of each of `count` rows, px: the usual one up to a dozen; more share the place of those, but no row is lower
    /// than its label.
    pub fn height(count: usize, usual: f64) -> f64 {
        (usual * USUAL_ROWS as f64 / count.max(USUAL_ROWS) as f64).max(FONT + 9.0)
    }

    /// Draws labels and axis for rows of `row` pixels; `reserve` pixels stay free on the right.
    pub fn new<'a>(
        canvas: &mut Canvas,
        labels: impl Iterator<Item = &'a str> + Clone,
        (axis, scale): (&Axis, Scale),
        (top, row): (f64, f64),
        reserve: f64,
    ) -> Self {
        let widest = labels.clone().map(|l| text_width(l, FONT)).fold(30.0, f64::max).min(230.0);
        let count = labels.clone().count();
        let area = Area::new(widest + 18.0, top, WIDTH - 18.0 - reserve, top + row * count as f64 + 6.0);
        let x = frame::x_ruler(canvas, axis, scale, area);
        let rows = Self { area, x, row };
        for (i, label) in labels.enumerate() {
            canvas.text(area.left - 9.0, rows.middle(i) + 4.0, Anchor::End, &fit(label, FONT, widest + 1.0));
        }
        rows
    }

    /// The vertical middle of row `i`.
    pub fn middle(&self, i: usize) -> f64 {
        self.area.top + 3.0 + self.row * (i as f64 + 0.5)
    }

    /// The rectangle between two values in row `i`, `share` of the row high.
    pub fn block(&self, i: usize, start: f64, end: f64, share: f64) -> Option<Area> {
        let (a, b) = (self.x.at(start)?, self.x.at(end)?);
        let half = 0.5 * share * self.row;
        let within = |x: f64| x.clamp(self.area.left, self.area.right);
        Some(Area::new(within(a.min(b)), self.middle(i) - half, within(a.max(b)), self.middle(i) + half))
    }
}
