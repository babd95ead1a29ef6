//! Intervals in rows: paired differences, or the swings of a sensitivity study.

use super::axis::{Axis, alike};
use super::bars::Estimate;
use super::frame::{self, Entry, Sample, points};
use super::px::Px;
use super::rows::Rows;
use super::style::{INK, Style};
use super::svg::{Anchor, Canvas, FONT, fit};
use super::table::Table;
use super::{Chart, describe};

/// A value with its interval in each row, against a reference such as "no difference".
///
/// # Examples
/// ```
/// use toolroom_chart::{Axis, Chart, Estimate, Intervals};
/// let chart = Intervals::new("Adaptive against constant", Axis::linear("Difference", "%"))
///     .reference(0.0, "no difference")
///     .row("parts / shift", Estimate::new(9.4, 8.1, 10.8));
/// assert!(chart.svg().contains("no difference"));
/// ```
#[derive(Clone, Debug)]
pub struct Intervals {
    title: String,
    description: String,
    axis: Axis,
    rows: Vec<(String, Estimate)>,
    reference: Option<(f64, String)>,
    tornado: Option<[String; 2]>,
}

impl Intervals {
    /// Without rows yet.
    #[must_use]
    pub fn new(title: impl Into<String>, axis: Axis) -> Self {
        Self { title: title.into(), description: String::new(), axis, rows: Vec::new(), reference: None, tornado: None }
    }

    describe!();

    /// Adds a row.
    #[must_use]
    pub fn row(mut self, label: impl Into<String>, estimate: impl Into<Estimate>) -> Self {
        self.rows.push((label.into(), estimate.into()));
        self
    }

    /// Sets the labelled reference line.
    #[must_use]
    pub fn reference(mut self, value: f64, label: impl Into<String>) -> Self {
        self.reference = Some((value, label.into()));
        self
    }

    /// Draws bars instead, from the value to either bound, the widest at the top: a tornado. The
    /// bounds are then the results at a low and at a high input, and these are their labels.
    #[must_use]
    pub fn tornado(mut self, low: impl Into<String>, high: impl Into<String>) -> Self {
        self.tornado = Some([low.into(), high.into()]);
        self
    }

    fn ordered(&self) -> Vec<&(String, Estimate)> {
        let mut rows: Vec<_> = self.rows.iter().collect();
        if self.tornado.is_some() {
            let swing = |e: &Estimate| if e.value.is_finite() { (e.bounds().1 - e.bounds().0).abs() } else { -1.0 };
            rows.sort_by(|a, b| swing(&b.1).total_cmp(&swing(&a.1)));
        }
        rows
    }
}

const LOW: Style = Style::nth(0);
const HIGH: Style = Style::nth(1);

impl Chart for Intervals {
    fn title(&self) -> &str {
        &self.title
    }

    fn svg(&self) -> String {
        let rows = self.ordered();
        let shown: Vec<_> = rows.iter().filter(|r| self.axis.holds(r.1.value)).collect();
        let values = shown.iter().flat_map(|r| [r.1.value, r.1.bounds().0, r.1.bounds().1]);
        let scale = self.axis.scale(values.chain(self.reference.iter().map(|r| r.0)));
        let Some(scale) = scale.filter(|_| !shown.is_empty()) else {
            return frame::empty(&self.title, &self.description);
        };
        let text = alike(shown.iter().flat_map(|r| [r.1.value, r.1.bounds().0, r.1.bounds().1]));
        let mut canvas = Canvas::new();
        let entries: Vec<Entry> = match &self.tornado {
            Some([low, high]) => vec![
                Entry { label: low, style: LOW, sample: Sample::Block },
                Entry { label: high, style: HIGH, sample: Sample::Block },
            ],
            None => Vec::new(),
        };
        let top = frame::header(&mut canvas, &self.title, &entries) + 14.0;
        let labels = rows.iter().map(|r| r.0.as_str());
        let layout = Rows::new(&mut canvas, labels, (&self.axis, scale), (top, 30.0), 150.0);
        if let Some((value, label)) = &self.reference
            && let Some(x) = layout.x.at(*value)
        {
            canvas.open(INK);
            let d = format!("M{} {}V{}", Px(x), Px(layout.area.top), Px(layout.area.bottom));
            canvas.stroke(&d, 1.2, " stroke-dasharray=\"7 3\"");
            canvas.close();
            canvas.halo(x, layout.area.top - 5.0, Anchor::Middle, &fit(label, FONT, 260.0));
        }
        for (i, (label, e)) in rows.iter().enumerate() {
            let Some(place) = layout.x.at(e.value) else { continue };
            let (y, (low, high)) = (layout.middle(i), e.bounds());

            if self.tornado.is_some() {
                for (bound, style) in [(low, LOW), (high, HIGH)] {
                    if let Some(area) = layout.block(i, e.value, bound, 0.66) {
                        canvas.block(area, style.colour, style.hatch, &format!("{label}: {}", text(bound)));
                    }
                }
            } else {
                canvas.open(LOW.colour.paint());
                if let (Some(a), Some(b)) = (layout.x.at(low), layout.x.at(high)) {
                    let [y0, y1, y2] = [Px(y), Px(y - 5.0), Px(y + 5.0)];
                    canvas.stroke(&format!("M{a} {y0}H{b}M{a} {y1}V{y2}M{b} {y1}V{y2}", a = Px(a), b = Px(b)), 2.0, "");
                }
                points(&mut canvas, [(place, y)], LOW);
                canvas.close();
            }
            let words = match (e.interval, self.tornado.is_some()) {
                (Some((a, b)), true) => format!("{} … {}", text(a), text(b)),
                (Some((a, b)), false) => format!("{} ({} … {})", text(e.value), text(a), text(b)),
                (None, _) => text(e.value),
            };
            canvas.text(layout.area.right + 8.0, y + 4.0, Anchor::Start, &fit(&words, FONT, 158.0));
        }
        let omitted = rows.len() - shown.len();
        frame::finish(canvas, &self.title, &self.description, layout.area.bottom, &frame::omitted(omitted))
    }

    fn data(&self) -> Table {
        let caption = self.axis.caption();
        let [low, high] = self.tornado.clone().unwrap_or(["lower".into(), "upper".into()]);
        let mut table = Table::new(["row".to_owned(), caption, low, high]);
        for (label, e) in self.ordered() {
            let [value, low, high] = e.cells();
            table.push([label.as_str().into(), value, low, high]);
        }
        table
    }
}
