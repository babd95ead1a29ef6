//! A value over two axes.

use super::axis::{Axis, Scale};
use super::frame::{self, Entry, Frame, Sample};
use super::layer::{Form, Layer, label_references};
use super::lobes::StabilityLobes;
use super::px::Px;
use super::style::{Colour, Hatch, Style};
use super::svg::{Anchor, Area, Canvas, FONT, WIDTH, fit, rectangle};
use super::table::Table;
use super::{Chart, describe};
use std::fmt::Write;

/// How values become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColourMap {
    /// Dark blue to yellow, evenly lighter: for amounts.
    ///
    /// # Source
    /// Cividis: Nuñez, Anderton and Renslow, PLoS ONE 13 (2018) e0199239; ten of its colours.
    Sequential,
    /// Blue over white to vermillion, white at zero: for residuals. The anchors are the Okabe–Ito
    /// colours, straight lines between them an assumption.
    Diverging,
}

/// Distinct colours of a map.
const LEVELS: usize = 32;
/// Finest grid that is drawn; finer ones are averaged over blocks.
const MOST_CELLS: (usize, usize) = (200, 120);

impl ColourMap {
    fn level(self, level: usize) -> String {
        const CIVIDIS: [u32; 10] =
            [0x00224e, 0x123570, 0x3b496c, 0x575d6d, 0x707173, 0x8a8678, 0xa59c74, 0xc3b369, 0xe1cc55, 0xfee838];
        const DIVERGING: [u32; 3] = [0x0072b2, 0xf4f4f4, 0xd55e00];
        let anchors: &[u32] = if self == Self::Sequential { &CIVIDIS } else { &DIVERGING };
        let position = level as f64 / (LEVELS - 1) as f64 * (anchors.len() - 1) as f64;
        let i = (position as usize).min(anchors.len() - 2);
        let mix = |shift: u32| {
            let channel = |c: u32| f64::from((c >> shift) & 0xff);
            (channel(anchors[i]) + (position - i as f64) * (channel(anchors[i + 1]) - channel(anchors[i]))).round()
                as u8
        };
        format!("#{:02x}{:02x}{:02x}", mix(16), mix(8), mix(0))
    }
}

/// A grid of values as colours with a colour bar; lines and points can lie on top.
///
/// # Shape
/// `values[row * columns.len() + column]`, rows along y.
///
/// # Examples
/// ```
/// use toolroom_chart::{Axis, Chart, ColourMap, HeatMap};
/// let axes = [Axis::linear("Speed", "rpm"), Axis::linear("Depth of cut", "mm"), Axis::linear("Residual", "N")];
/// let map = HeatMap::new("Residuals", axes, [1000.0, 2000.0], [0.5, 1.0], [1.0, 2.0, -3.0, 4.0]).colours(ColourMap::Diverging);
/// assert_eq!(map.data().rows().len(), 4);
/// ```
#[derive(Clone, Debug)]
pub struct HeatMap {
    title: String,
    description: String,
    x: Axis,
    y: Axis,
    value: Axis,
    columns: Vec<f64>,
    rows: Vec<f64>,
    values: Vec<f64>,
    colours: ColourMap,
    /// What a missing value is called, where each of them has to be seen.
    missing: Option<String>,
    layers: Vec<Layer>,
}

impl HeatMap {
    /// A map of `values` over cells centred on `columns` and `rows`; the axes are x, y and value.
    /// Values that are missing or not finite are hatched.
    #[must_use]
    pub fn new(
        title: impl Into<String>,
        [x, y, value]: [Axis; 3],
        columns: impl IntoIterator<Item = f64>,
        rows: impl IntoIterator<Item = f64>,
        values: impl IntoIterator<Item = f64>,
    ) -> Self {
        Self {
            title: title.into(),
            description: String::new(),
            x,
            y,
            value,
            columns: columns.into_iter().collect(),
            rows: rows.into_iter().collect(),
            values: values.into_iter().collect(),
            colours: ColourMap::Sequential,
            missing: None,
            layers: Vec::new(),
        }
    }

    describe!();

    /// Sets the colours.
    #[must_use]
    pub fn colours(mut self, colours: ColourMap) -> Self {
        self.colours = colours;
        self
    }

    /// Names missing values in the legend and shows each of them: where a grid is too fine to be drawn cell by
    /// cell, a block with one missing value is hatched as a whole instead of averaged over the others.
    #[must_use]
    pub fn missing(mut self, label: impl Into<String>) -> Self {
        self.missing = Some(label.into());
        self
    }

    /// Adds a line on top, for example a stability limit.
    #[must_use]
    pub fn line(self, label: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>, style: Style) -> Self {
        self.on_top(label, points, Form::Line, style)
    }

    /// Adds points on top, for example operating points.
    #[must_use]
    pub fn scatter(self, label: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>, style: Style) -> Self {
        self.on_top(label, points, Form::Scatter, style)
    }

    /// Adds stability boundaries and operating points on top.
    #[must_use]
    pub fn lobes(mut self, lobes: &StabilityLobes) -> Self {
        self.layers.extend(lobes.layers());
        self
    }

    fn on_top(
        mut self,
        label: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
        form: Form,
        style: Style,
    ) -> Self {
        self.layers.push(Layer::Points { label: label.into(), points: points.into_iter().collect(), form, style });
        self
    }

    fn value(&self, row: usize, column: usize) -> f64 {
        self.values.get(row * self.columns.len() + column).copied().filter(|&v| self.value.holds(v)).unwrap_or(f64::NAN)
    }

    /// The scale of the values over the colour bar; a diverging map is symmetric about zero.
    fn value_scale(&self) -> Option<Scale> {
        let used = self.columns.len().saturating_mul(self.rows.len());
        let values = self.values.iter().copied().take(used).filter(|&v| self.value.holds(v));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if low > high {
            return None;
        }
        let bounds = match self.colours {
            ColourMap::Diverging => [-low.abs().max(high.abs()), low.abs().max(high.abs())],
            ColourMap::Sequential => [low, high],
        };
        // Without padding: the ends of the bar are the extremes of the data.
        self.value.clone().default_range(bounds[0], bounds[1]).scale(bounds)
    }

    /// Averages of blocks of cells: their positions as ranges of indices, and their values.
    fn blocks(&self, columns: &[usize], rows: &[usize]) -> Vec<Vec<f64>> {
        let (wide, tall) = (columns.len().div_ceil(MOST_CELLS.0), rows.len().div_ceil(MOST_CELLS.1));
        let mean = |rows: &[usize], columns: &[usize]| {
            let values = rows.iter().flat_map(|&r| columns.iter().map(move |&c| (r, c))).map(|(r, c)| self.value(r, c));
            if self.missing.is_some() && values.clone().any(|value| !value.is_finite()) {
                return f64::NAN;
            }
            let (sum, n) = values.filter(|v| v.is_finite()).fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
            sum / n
        };
        rows.chunks(tall.max(1)).map(|r| columns.chunks(wide.max(1)).map(|c| mean(r, c)).collect()).collect()
    }

    fn draw_cells(&self, canvas: &mut Canvas, frame: &Frame, columns: &[usize], rows: &[usize], scale: Scale) {
        let blocks = self.blocks(columns, rows);
        let xs = edges(
            columns.iter().filter_map(|&c| frame.x.at(self.columns[c])).collect(),
            MOST_CELLS.0,
            (frame.area.left, frame.area.right),
        );
        let ys = edges(
            rows.iter().filter_map(|&r| frame.y.at(self.rows[r])).collect(),
            MOST_CELLS.1,
            (frame.area.bottom, frame.area.top),
        );
        let level = |v: f64| scale.at(v).map(|share| (share.clamp(0.0, 1.0) * (LEVELS - 1) as f64).round() as usize);
        let mut paths = vec![String::new(); LEVELS];
        for (row, y) in blocks.iter().zip(ys.windows(2)) {
            let mut c = 0;
            while c < row.len() {
                // Neighbours of one colour are one rectangle.
                let here = level(row[c]);
                let end = (c + 1..row.len()).find(|&k| level(row[k]) != here).unwrap_or(row.len());
                if let Some(path) = here.and_then(|l| paths.get_mut(l)) {
                    let [a, b, top, bottom] = [xs[c], xs[end], y[0], y[1]].map(Px);
                    let _ = write!(path, "M{a} {top}H{b}V{bottom}H{a}z");
                }
                c = end;
            }
        }
        for (l, path) in paths.iter().enumerate() {
            canvas.fill(path, 1.0, Some(&self.colours.level(l)));
        }
    }

    fn draw_bar(&self, canvas: &mut Canvas, area: Area, scale: Scale) {
        let bar = Area::new(area.right + 18.0, area.top, area.right + 34.0, area.bottom);
        let step = bar.height() / LEVELS as f64;
        for l in 0..LEVELS {
            let bottom = bar.bottom - step * l as f64;
            canvas.fill(
                &rectangle(Area::new(bar.left, bottom - step, bar.right, bottom)),
                1.0,
                Some(&self.colours.level(l)),
            );
        }
        let scale = scale.on(bar.bottom, bar.top);
        let ticks = self.value.marks(&scale, (bar.height() / 48.0) as usize + 1);
        for (v, label) in &ticks.major {
            if let Some(y) = scale.at(*v) {
                canvas.grid(&format!("M{} {}h5", Px(bar.right), Px(y)));
                canvas.muted(bar.right + 8.0, y + 4.0, Anchor::Start, &fit(label, FONT, 60.0));
            }
        }
        let caption = fit(&self.value.caption_with(ticks.exponent), FONT, bar.height() + 40.0);
        canvas.upright(WIDTH - 8.0, f64::midpoint(bar.top, bar.bottom), &caption);
    }
}

/// Indices of the values that an axis holds, in increasing order of the value.
fn drawable(axis: &Axis, values: &[f64]) -> Vec<usize> {
    let mut indices: Vec<usize> = (0..values.len()).filter(|&i| axis.holds(values[i])).collect();
    indices.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    indices
}

/// Borders of the blocks of cells: half way, in pixels, between neighbouring centres.
fn edges(centres: Vec<f64>, most: usize, whole: (f64, f64)) -> Vec<f64> {
    let n = centres.len();
    if n < 2 {
        return vec![whole.0, whole.1];
    }
    let mut edges = vec![1.5 * centres[0] - 0.5 * centres[1]];
    edges.extend(centres.windows(2).map(|w| f64::midpoint(w[0], w[1])));
    edges.push(1.5 * centres[n - 1] - 0.5 * centres[n - 2]);
    let size = n.div_ceil(most);
    let mut blocks: Vec<f64> = edges[..n].iter().copied().step_by(size).collect();
    blocks.push(edges[n]);
    blocks
}

impl Chart for HeatMap {
    fn title(&self) -> &str {
        &self.title
    }

    fn svg(&self) -> String {
        let (columns, rows) = (drawable(&self.x, &self.columns), drawable(&self.y, &self.rows));
        let span = |axis: &Axis, values: &[f64], order: &[usize]| {
            let ends = [values[*order.first()?], values[*order.last()?]];
            axis.clone().around(ends, order.len()).scale(ends)
        };
        let scales =
            span(&self.x, &self.columns, &columns).zip(span(&self.y, &self.rows, &rows)).zip(self.value_scale());
        let Some(((x, y), value)) = scales else { return frame::empty(&self.title, &self.description) };
        let missing = rows
            .iter()
            .flat_map(|&r| columns.iter().map(move |&c| (r, c)))
            .filter(|&(r, c)| !self.value(r, c).is_finite())
            .count();
        let absent = Style::IDLE.hatch(Hatch::Slash);
        let mut canvas = Canvas::new();
        let mut entries: Vec<Entry> = self.layers.iter().filter_map(Layer::entry).collect();
        if missing > 0 {
            entries.push(Entry {
                label: self.missing.as_deref().unwrap_or("no value"),
                style: absent,
                sample: Sample::Block,
            });
        }
        let top = frame::header(&mut canvas, &self.title, &entries);
        let mut frame = frame::axes(&mut canvas, (&self.x, x), (&self.y, y), (top, 320.0), 92.0);
        frame.on_colour = true;
        canvas.open_window(frame.area);
        if missing > 0 {
            canvas.block(frame.area, Colour::Grey, absent.hatch, "");
        }
        self.draw_cells(&mut canvas, &frame, &columns, &rows, value.on(0.0, 1.0));
        for layer in &self.layers {
            layer.draw(&mut canvas, &frame);
        }
        canvas.close_window();
        label_references(&mut canvas, &frame, &self.layers);
        self.draw_bar(&mut canvas, frame.area, value);
        let omitted = self.layers.iter().map(|l| l.omitted(&self.x, &self.y)).sum();
        frame::finish(canvas, &self.title, &self.description, frame.area.bottom, &frame::omitted(omitted))
    }

    fn data(&self) -> Table {
        let mut table = Table::new([self.x.caption(), self.y.caption(), self.value.caption()]);
        for (r, &y) in self.rows.iter().enumerate() {
            for (c, &x) in self.columns.iter().enumerate() {
                table.push([x.into(), y.into(), self.value(r, c).into()]);
            }
        }
        table
    }
}
