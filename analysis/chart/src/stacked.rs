//! Stacked horizontal bars: how each machine spends its time.

use super::axis::{Axis, number};
use super::frame::{self, Entry, Sample};
use super::rows::Rows;
use super::style::Style;
use super::svg::{Canvas, FONT, text_width};
use super::table::Table;
use super::{Chart, describe};

/// One bar per row, divided into kinds: state times per machine, or an OEE loss breakdown.
///
/// # Examples
/// ```
/// use toolroom_chart::{Axis, Chart, StackedBars, Style};
/// let bars = StackedBars::new("State times", Axis::linear("Share of the shift", "%"))
///     .kind("cutting", Style::nth(0))
///     .kind("idle", Style::IDLE)
///     .row("L1", [62.0, 38.0]);
/// assert_eq!(bars.data().rows().len(), 1);
/// ```
#[derive(Clone, Debug)]
pub struct StackedBars {
    title: String,
    description: String,
    axis: Axis,
    kinds: Vec<(String, Style)>,
    rows: Vec<(String, Vec<f64>)>,
}

impl StackedBars {
    /// Without kinds and rows yet.
    #[must_use]
    pub fn new(title: impl Into<String>, axis: Axis) -> Self {
        Self {
            title: title.into(),
            description: String::new(),
            axis: axis.include(0.0),
            kinds: Vec::new(),
            rows: Vec::new(),
        }
    }

    describe!();

    /// Adds a kind; its place decides which value of a row belongs to it.
    #[must_use]
    pub fn kind(mut self, label: impl Into<String>, style: Style) -> Self {
        self.kinds.push((label.into(), style));
        self
    }

    /// Adds a row with one value per kind. Values that are negative or not finite count as zero.
    #[must_use]
    pub fn row(mut self, label: impl Into<String>, values: impl IntoIterator<Item = f64>) -> Self {
        self.rows.push((label.into(), values.into_iter().collect()));
        self
    }
}

/// What can be stacked.
fn positive(value: f64) -> f64 {
    if value.is_finite() { value.max(0.0) } else { 0.0 }
}

impl Chart for StackedBars {
    fn title(&self) -> &str {
        &self.title
    }

    fn svg(&self) -> String {
        let totals = self.rows.iter().map(|(_, v)| v.iter().take(self.kinds.len()).copied().map(positive).sum::<f64>());
        let any = totals.clone().any(|t| t > 0.0);
        let Some(scale) = self.axis.scale(totals).filter(|_| any) else {
            return frame::empty(&self.title, &self.description);
        };
        let mut canvas = Canvas::new();
        let entries: Vec<Entry> =
            self.kinds.iter().map(|(label, style)| Entry { label, style: *style, sample: Sample::Block }).collect();
        let top = frame::header(&mut canvas, &self.title, &entries);
        let place = (top, Rows::height(self.rows.len(), 34.0));
        let rows = Rows::new(&mut canvas, self.rows.iter().map(|r| r.0.as_str()), (&self.axis, scale), place, 0.0);
        let mut omitted = 0;
        for (i, (label, values)) in self.rows.iter().enumerate() {
            let mut from = 0.0;
            for ((kind, style), &value) in self.kinds.iter().zip(values) {
                omitted += usize::from(!(value.is_finite() && value >= 0.0));
                let to = from + positive(value);
                if let Some(area) = rows.block(i, from, to, 0.72).filter(|a| a.width() > 0.0) {
                    let text = number(value, 3);
                    canvas.block(area, style.colour, style.hatch, &format!("{label}, {kind}: {text}"));
                    if text_width(&text, FONT) + 8.0 < area.width() {
                        let middle = f64::midpoint(area.left, area.right);
                        canvas.inside(middle, rows.middle(i) + 4.0, &text, style.colour, style.hatch);
                    }
                }
                from = to;
            }
        }
        frame::finish(canvas, &self.title, &self.description, rows.area.bottom, &frame::omitted(omitted))
    }

    fn data(&self) -> Table {
        let unit = self.axis.caption();
        let mut table =
            Table::new(std::iter::once(unit).chain(self.kinds.iter().map(|k| k.0.clone())).collect::<Vec<_>>());
        for (label, values) in &self.rows {
            table.push(std::iter::once(label.as_str().into()).chain(values.iter().map(|&v| v.into())));
        }
        table
    }
}
