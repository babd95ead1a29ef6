//! A plot of y against x.

use super::axis::Axis;
use super::frame::{self, Entry};
use super::layer::{Form, Layer, label_references};
use super::lobes::StabilityLobes;
use super::strip::{self, Strip};
use super::style::Style;
use super::svg::Canvas;
use super::table::Table;
use super::{Chart, describe};

/// Lines, bands, steps, points and columns over two axes.
///
/// # Examples
/// ```
/// use toolroom_chart::{Axis, Chart, Plot, Style};
/// let plot = Plot::new("Wear", Axis::linear("Time", "min"), Axis::linear("Flank wear VB", "mm"))
///     .line("median", [(0.0, 0.0), (9.0, 0.3)], Style::nth(0))
///     .horizontal(0.3, "VB limit");
/// assert!(plot.svg().contains("Flank wear VB [mm]"));
/// ```
#[derive(Clone, Debug)]
pub struct Plot {
    title: String,
    description: String,
    x: Axis,
    y: Axis,
    height: f64,
    layers: Vec<Layer>,
    strips: Vec<Strip>,
}

impl Plot {
    /// An empty plot.
    #[must_use]
    pub fn new(title: impl Into<String>, x: Axis, y: Axis) -> Self {
        Self {
            title: title.into(),
            description: String::new(),
            x,
            y,
            height: 300.0,
            layers: Vec::new(),
            strips: Vec::new(),
        }
    }

    describe!();

    /// The height of the plot area in pixels, 300 unless told.
    #[must_use]
    pub fn height(mut self, pixels: f64) -> Self {
        self.height = pixels.clamp(80.0, 1200.0);
        self
    }

    fn points(mut self, label: impl Into<String>, points: Vec<(f64, f64)>, form: Form, style: Style) -> Self {
        self.layers.push(Layer::Points { label: label.into(), points, form, style });
        self
    }

    /// Adds a line. A value that is not finite interrupts it; an empty label keeps it out of the
    /// legend.
    #[must_use]
    pub fn line(self, label: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>, style: Style) -> Self {
        self.points(label, points.into_iter().collect(), Form::Line, style)
    }

    /// Adds a path: a line that may run back, drawn through all points that can be told apart. A point that is not finite begins it
    /// anew and is not counted as left out.
    #[must_use]
    pub fn path(self, label: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>, style: Style) -> Self {
        self.points(label, points.into_iter().collect(), Form::Path, style)
    }

    /// Adds a line with a marker at each point.
    #[must_use]
    pub fn marked_line(
        self,
        label: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
        style: Style,
    ) -> Self {
        self.points(label, points.into_iter().collect(), Form::LineOfPoints, style)
    }

    /// Adds a staircase: each value holds until the next point.
    #[must_use]
    pub fn step(self, label: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>, style: Style) -> Self {
        self.points(label, points.into_iter().collect(), Form::Step, style)
    }

    /// Adds points.
    #[must_use]
    pub fn scatter(self, label: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>, style: Style) -> Self {
        self.points(label, points.into_iter().collect(), Form::Scatter, style)
    }

    /// Adds stability boundaries and operating points.
    #[must_use]
    pub fn lobes(mut self, lobes: &StabilityLobes) -> Self {
        self.layers.extend(lobes.layers());
        self
    }

    /// Adds a band of (x, lower, upper).
    #[must_use]
    pub fn band(
        mut self,
        label: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64, f64)>,
        style: Style,
    ) -> Self {
        self.layers.push(Layer::Band { label: label.into(), points: points.into_iter().collect(), style });
        self
    }

    /// Adds columns of (from, to, height) standing on zero, as [`Histogram`](super::Histogram)
    /// makes them.
    #[must_use]
    pub fn columns(
        mut self,
        label: impl Into<String>,
        columns: impl IntoIterator<Item = (f64, f64, f64)>,
        style: Style,
    ) -> Self {
        self.layers.push(Layer::Columns { label: label.into(), columns: columns.into_iter().collect(), style });
        self
    }

    /// Adds a colour strip above the plot: what is in force from where to where along the
    /// horizontal axis, as intervals (from, to, kind). Kinds of one label share their legend entry.
    #[must_use]
    pub fn strip(
        mut self,
        label: impl Into<String>,
        kinds: impl IntoIterator<Item = (String, Style)>,
        intervals: impl IntoIterator<Item = (f64, f64, usize)>,
    ) -> Self {
        self.strips.push(Strip::new(label.into(), kinds.into_iter().collect(), intervals.into_iter().collect()));
        self
    }

    /// Adds a labelled reference line across the plot.
    #[must_use]
    pub fn horizontal(mut self, value: f64, label: impl Into<String>) -> Self {
        self.layers.push(Layer::Horizontal { value, label: label.into() });
        self
    }

    /// Adds a labelled reference line up the plot.
    #[must_use]
    pub fn vertical(mut self, value: f64, label: impl Into<String>) -> Self {
        self.layers.push(Layer::Vertical { value, label: label.into() });
        self
    }
}

impl Chart for Plot {
    fn title(&self) -> &str {
        &self.title
    }

    fn svg(&self) -> String {
        let scales = self.layers.iter().any(|l| l.drawable(&self.x, &self.y)).then(|| {
            let xs = self.x.scale(self.layers.iter().flat_map(Layer::xs))?;
            Some((xs, self.y.scale(self.layers.iter().flat_map(Layer::ys))?))
        });
        let Some(Some((xs, ys))) = scales else { return frame::empty(&self.title, &self.description) };
        let mut canvas = Canvas::new();
        let entries: Vec<Entry> =
            self.layers.iter().filter_map(Layer::entry).chain(strip::entries(&self.strips)).collect();
        let top = frame::header(&mut canvas, &self.title, &entries);
        let below = top + strip::height(&self.strips);
        let frame = frame::axes(&mut canvas, (&self.x, xs), (&self.y, ys), (below, self.height), 0.0);
        strip::draw(&self.strips, &mut canvas, &frame, top);
        canvas.open_window(frame.area);
        for layer in &self.layers {
            layer.draw(&mut canvas, &frame);
        }
        canvas.close_window();
        label_references(&mut canvas, &frame, &self.layers);
        let omitted = self.layers.iter().map(|l| l.omitted(&self.x, &self.y)).sum();
        let mut remark = frame::omitted(omitted);
        if self.layers.iter().any(Layer::thinned) {
            remark = format!("{remark} Points that nearly cover each other are drawn once.").trim_start().to_owned();
        }
        frame::finish(canvas, &self.title, &self.description, frame.area.bottom, &remark)
    }

    fn data(&self) -> Table {
        let banded = self.layers.iter().any(|l| matches!(l, Layer::Band { .. }));
        let mut columns = vec!["series".to_owned(), self.x.caption(), self.y.caption()];
        if banded {
            columns.push(format!("upper {}", self.y.caption()));
        }
        let mut table = Table::new(columns);
        for layer in &self.layers {
            layer.tabulate(&mut table);
        }
        for strip in &self.strips {
            strip.tabulate(&mut table);
        }
        table
    }
}
