//! Grouped bars with error bars.

use super::axis::{Axis, alike};
use super::frame::{self, Entry, Sample};
use super::px::Px;
use super::style::{Colour, GRID, INK, MUTED, Style};
use super::svg::{Anchor, Area, Canvas, FONT, WIDTH, fit, text_width, wrap};
use super::table::{Cell, Table};
use super::{Chart, describe};
use std::fmt::Write;

/// A value with the interval that it lies in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// Lower and upper bound, if known.
    pub interval: Option<(f64, f64)>,
}

impl Estimate {
    /// A value with an interval, of any confidence: the caption has to name it.
    #[must_use]
    pub const fn new(value: f64, low: f64, high: f64) -> Self {
        Self { value, interval: Some((low, high)) }
    }

    /// The bounds, the value itself when none are known.
    pub(crate) fn bounds(&self) -> (f64, f64) {
        self.interval.unwrap_or((self.value, self.value))
    }

    /// Value, lower and upper bound as cells.
    pub(crate) fn cells(&self) -> [Cell; 3] {
        let bound = |b: fn((f64, f64)) -> f64| self.interval.map_or(Cell::Text(String::new()), |i| Cell::Number(b(i)));
        [self.value.into(), bound(|i| i.0), bound(|i| i.1)]
    }
}

impl From<f64> for Estimate {
    fn from(value: f64) -> Self {
        Self { value, interval: None }
    }
}

/// Bars side by side in categories, each with its interval.
///
/// # Examples
/// ```
/// use toolroom_chart::{Axis, Bars, Chart, Estimate, Style};
/// let bars = Bars::new("Output", Axis::linear("Parts", "1/shift"), ["constant", "adaptive"])
///     .series("parts", [Estimate::new(184.2, 181.0, 187.4), 201.6.into()], Style::nth(0));
/// assert_eq!(bars.data().rows().len(), 2);
/// ```
#[derive(Clone, Debug)]
pub struct Bars {
    title: String,
    description: String,
    axis: Axis,
    categories: Vec<String>,
    series: Vec<(String, Vec<Estimate>, Style)>,
    reference: Option<(f64, String)>,
}

impl Bars {
    /// Empty categories over a value axis.
    #[must_use]
    pub fn new<S: Into<String>>(
        title: impl Into<String>,
        values: Axis,
        categories: impl IntoIterator<Item = S>,
    ) -> Self {
        Self {
            title: title.into(),
            description: String::new(),
            axis: values.include(0.0),
            categories: categories.into_iter().map(Into::into).collect(),
            series: Vec::new(),
            reference: None,
        }
    }

    describe!();

    /// Adds a bar to each category, in their order; a missing value is `NAN`.
    #[must_use]
    pub fn series(
        mut self,
        label: impl Into<String>,
        values: impl IntoIterator<Item = Estimate>,
        style: Style,
    ) -> Self {
        self.series.push((label.into(), values.into_iter().take(self.categories.len()).collect(), style));
        self
    }

    /// Sets a labelled reference line, for example the baseline.
    #[must_use]
    pub fn reference(mut self, value: f64, label: impl Into<String>) -> Self {
        self.reference = Some((value, label.into()));
        self
    }
}

const REFERENCE: Style = Style::nth(1).colour(Colour::Ink);

impl Chart for Bars {
    fn title(&self) -> &str {
        &self.title
    }

    fn svg(&self) -> String {
        let estimates = || self.series.iter().flat_map(|s| &s.1);
        let drawn = estimates().filter(|e| self.axis.holds(e.value));
        if drawn.clone().count() == 0 {
            return frame::empty(&self.title, &self.description);
        }
        let values =
            drawn.flat_map(|e| [e.value, e.bounds().0, e.bounds().1]).chain(self.reference.iter().map(|r| r.0));
        let Some(scale) = self.axis.scale(values) else { return frame::empty(&self.title, &self.description) };
        let text = alike(estimates().map(|e| e.value));
        let mut canvas = Canvas::new();
        let mut entries: Vec<Entry> = Vec::new();
        if self.series.len() > 1 {
            let blocks = self.series.iter();
            entries.extend(blocks.map(|(label, _, style)| Entry { label, style: *style, sample: Sample::Block }));
        }
        entries.extend(self.reference.iter().map(|(_, label)| Entry { label, style: REFERENCE, sample: Sample::Line }));
        // Room above the highest bar for its number.
        let top = frame::header(&mut canvas, &self.title, &entries) + 10.0;
        let frame = VerticalFrame::new(&mut canvas, &self.axis, scale, top, 250.0);
        let slot = frame.area.width() / self.categories.len() as f64;
        let bar = (0.76 * slot / self.series.len() as f64).min(64.0);
        let zero = frame.y.at(0.0).unwrap_or(frame.area.bottom);
        for (i, category) in self.categories.iter().enumerate() {
            let middle = frame.area.left + slot * (i as f64 + 0.5);
            for (k, line) in wrap(category, FONT, slot - 6.0).iter().enumerate() {
                canvas.text(middle, frame.area.bottom + 18.0 + 15.0 * k as f64, Anchor::Middle, line);
            }
            for (j, (label, values, style)) in self.series.iter().enumerate() {
                let Some(e) = values.get(i) else { continue };
                let left = middle + bar * (j as f64 - 0.5 * self.series.len() as f64);
                let Some(y) = frame.y.at(e.value) else { continue };
                let area = Area::new(left + 1.5, y.min(zero), left + bar - 1.5, y.max(zero));
                canvas.block(area, style.colour, style.hatch, &format!("{label}, {category}: {}", text(e.value)));
                let (low, high) = e.bounds();
                let ends = frame.y.at(low).zip(frame.y.at(high)).filter(|_| e.interval.is_some());
                if let Some((low, high)) = ends {
                    whisker_up(&mut canvas, left + bar / 2.0, low, high, (bar / 4.0).min(6.0));
                }
                let words = text(e.value);
                if text_width(&words, FONT) < bar.max(0.9 * slot / self.series.len() as f64) + 8.0 {
                    let above = ends.map_or(y, |(a, b)| a.min(b).min(y));
                    let below = ends.map_or(y, |(a, b)| a.max(b).max(y));
                    let height = if e.value < 0.0 { below + 15.0 } else { above - 6.0 };
                    canvas.halo(left + bar / 2.0, height, Anchor::Middle, &words);
                }
            }
        }
        canvas.open(INK);
        canvas.stroke(&format!("M{} {}H{}", Px(frame.area.left), Px(zero), Px(frame.area.right)), 1.0, "");
        canvas.close();
        if let Some(y) = self.reference.as_ref().and_then(|r| frame.y.at(r.0)) {
            canvas.open(INK);
            let d = format!("M{} {}H{}", Px(frame.area.left), Px(y), Px(frame.area.right));
            canvas.stroke(&d, 1.2, REFERENCE.dash.attribute());
            canvas.close();
        }
        let omitted = estimates().filter(|e| !self.axis.holds(e.value)).count();
        let below = frame.area.bottom - 2.0;
        frame::finish(canvas, &self.title, &self.description, below, &frame::omitted(omitted))
    }

    fn data(&self) -> Table {
        let caption = self.axis.caption();
        let mut table = Table::new([
            "category".into(),
            "series".into(),
            caption.clone(),
            format!("lower {caption}"),
            format!("upper {caption}"),
        ]);
        for (i, category) in self.categories.iter().enumerate() {
            for (label, values, _) in &self.series {
                if let Some(e) = values.get(i) {
                    let [value, low, high] = e.cells();
                    table.push([category.as_str().into(), label.as_str().into(), value, low, high]);
                }
            }
        }
        table
    }
}

/// A plot area with a value axis on the left and categories below.
struct VerticalFrame {
    area: Area,
    y: super::axis::Scale,
}

impl VerticalFrame {
    fn new(canvas: &mut Canvas, axis: &Axis, scale: super::axis::Scale, top: f64, height: f64) -> Self {
        let y = scale.on(top + height, top);
        let ticks = axis.marks(&y, 5);
        let widest = ticks.major.iter().map(|(_, l)| text_width(l, FONT)).fold(14.0, f64::max).min(150.0);
        let area = Area::new(34.0 + widest, top, WIDTH - 18.0, top + height);
        let mut grid = String::new();
        for (v, label) in &ticks.major {
            let Some(p) = y.at(*v) else { continue };
            let _ = write!(grid, "M{} {}H{}", Px(area.left), Px(p), Px(area.right));
            canvas.open(MUTED);
            canvas.text(area.left - 7.0, p + 4.0, Anchor::End, &fit(label, FONT, 150.0));
            canvas.close();
        }
        canvas.open(GRID);
        canvas.stroke(&grid, 1.0, "");
        canvas.close();
        let caption = fit(&axis.caption_with(ticks.exponent), FONT, height + 40.0);
        canvas.upright(12.0, f64::midpoint(area.top, area.bottom), &caption);
        Self { area, y }
    }
}

fn whisker_up(canvas: &mut Canvas, x: f64, low: f64, high: f64, half: f64) {
    let [l, r, x, low, high] = [x - half, x + half, x, low, high].map(Px);
    canvas.open(INK);
    canvas.stroke(&format!("M{x} {low}V{high}M{l} {low}H{r}M{l} {high}H{r}"), 1.4, "");
    canvas.close();
}
