//! What can lie on a plot area: lines, bands, steps, points, columns and reference lines.

use super::axis::Axis;
use super::frame::{Entry, Frame, MARKER, Sample, fill_markers, markers};
use super::px::Px;
use super::style::{Colour, INK, PAPER, Style};
use super::svg::{Anchor, Area, Canvas, FONT, fit, text_width};
use super::table::{Cell, Table};
use std::fmt::Write;

/// How a series of points is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    Line,
    /// A line that may run back on itself and begins anew behind what is not finite.
    Path,
    Step,
    Scatter,
    LineOfPoints,
}

#[derive(Clone, Debug)]
pub(crate) enum Layer {
    Points { label: String, points: Vec<(f64, f64)>, form: Form, style: Style },
    Band { label: String, points: Vec<(f64, f64, f64)>, style: Style },
    Columns { label: String, columns: Vec<(f64, f64, f64)>, style: Style },
    Horizontal { value: f64, label: String },
    Vertical { value: f64, label: String },
}

impl Layer {
    /// The values on the horizontal axis, without reference lines.
    pub fn xs(&self) -> Vec<f64> {
        match self {
            Self::Points { points, .. } => points.iter().map(|p| p.0).collect(),
            Self::Band { points, .. } => points.iter().map(|p| p.0).collect(),
            Self::Columns { columns, .. } => columns.iter().flat_map(|c| [c.0, c.1]).collect(),
            Self::Vertical { value, .. } => vec![*value],
            Self::Horizontal { .. } => Vec::new(),
        }
    }

    /// The values on the vertical axis.
    pub fn ys(&self) -> Vec<f64> {
        match self {
            Self::Points { points, .. } => points.iter().map(|p| p.1).collect(),
            Self::Band { points, .. } => points.iter().flat_map(|p| [p.1, p.2]).collect(),
            Self::Columns { columns, .. } => columns.iter().flat_map(|c| [0.0, c.2]).collect(),
            Self::Horizontal { value, .. } => vec![*value],
            Self::Vertical { .. } => Vec::new(),
        }
    }

    /// True when the layer holds data that the axes can show.
    pub fn drawable(&self, x: &Axis, y: &Axis) -> bool {
        let is_data = !matches!(self, Self::Horizontal { .. } | Self::Vertical { .. });
        is_data && self.len() > self.omitted(x, y)
    }

    /// Rows of data that an axis has no place for.
    pub fn omitted(&self, x: &Axis, y: &Axis) -> usize {
        match self {
            Self::Points { form: Form::Path, .. } => 0,
            Self::Points { points, .. } => points.iter().filter(|p| !(x.holds(p.0) && y.holds(p.1))).count(),
            Self::Band { points, .. } => {
                points.iter().filter(|p| !(x.holds(p.0) && y.holds(p.1) && y.holds(p.2))).count()
            }
            Self::Columns { columns, .. } => {
                columns.iter().filter(|c| !(x.holds(c.0) && x.holds(c.1) && c.2.is_finite())).count()
            }
            Self::Horizontal { value, .. } => usize::from(!y.holds(*value)),
            Self::Vertical { value, .. } => usize::from(!x.holds(*value)),
        }
    }

    /// True when points that nearly cover each other are drawn once.
    pub fn thinned(&self) -> bool {
        matches!(self, Self::Points { form: Form::Scatter | Form::LineOfPoints, .. }) && self.len() > MOST_POINTS
    }

    fn len(&self) -> usize {
        match self {
            Self::Points { points, .. } => points.len(),
            Self::Band { points, .. } => points.len(),
            Self::Columns { columns, .. } => columns.len(),
            Self::Horizontal { .. } | Self::Vertical { .. } => 0,
        }
    }

    /// The legend entry; reference lines are labelled in the plot.
    pub fn entry(&self) -> Option<Entry<'_>> {
        let (label, style, sample) = match self {
            Self::Points { label, style, form, .. } => {
                let sample = match form {
                    Form::Line | Form::Path | Form::Step => Sample::Line,
                    Form::LineOfPoints => Sample::LineOfPoints,
                    Form::Scatter => Sample::Points,
                };
                (label, style, sample)
            }
            Self::Band { label, style, .. } => (label, style, Sample::Band),
            Self::Columns { label, style, .. } => (label, style, Sample::Block),
            Self::Horizontal { .. } | Self::Vertical { .. } => return None,
        };
        (!label.is_empty()).then_some(Entry { label, style: *style, sample })
    }

    /// Appends the rows of data, in the columns series, x, y, upper.
    pub fn tabulate(&self, table: &mut Table) {
        let mut row = |label: &str, x: f64, y: f64, upper: Option<f64>| {
            table.push([label.into(), x.into(), y.into(), upper.map_or(Cell::Text(String::new()), Cell::Number)]);
        };
        match self {
            Self::Points { label, points, form, .. } => {
                let shown = |p: &&(f64, f64)| *form != Form::Path || (p.0.is_finite() && p.1.is_finite());
                points.iter().filter(shown).for_each(|p| row(label, p.0, p.1, None));
            }
            Self::Band { label, points, .. } => points.iter().for_each(|p| row(label, p.0, p.1, Some(p.2))),
            Self::Columns { label, columns, .. } => {
                for c in columns {
                    row(label, f64::midpoint(c.0, c.1), c.2, None);
                }
            }
            Self::Horizontal { value, label } => {
                table.push([label.as_str().into(), "".into(), (*value).into()]);
            }
            Self::Vertical { value, label } => table.push([label.as_str().into(), (*value).into()]),
        }
    }

    /// Draws everything but the words of reference lines.
    pub fn draw(&self, canvas: &mut Canvas, frame: &Frame) {
        match self {
            Self::Points { points: p, form, style, .. } => draw_points(canvas, frame, p, *form, *style),
            Self::Band { points, style, .. } => draw_band(canvas, frame, points, *style),
            Self::Columns { columns, style, .. } => {
                for &(from, to, height) in columns {
                    let (Some(a), Some(b)) = (frame.x.at(from), frame.x.at(to)) else { continue };
                    let Some(top) = frame.y.at(height) else { continue };
                    let zero = frame.y.at(0.0).unwrap_or(frame.area.bottom);
                    let gap = if b - a > 4.0 { 0.5 } else { 0.0 };
                    let area = Area::new(a + gap, top.min(zero), b - gap, top.max(zero));
                    canvas.block(area, style.colour, style.hatch, "");
                }
            }
            Self::Horizontal { value, .. } => {
                if let Some(y) = frame.y.at(*value) {
                    reference(canvas, &format!("M{} {}H{}", Px(frame.area.left), Px(y), Px(frame.area.right)));
                }
            }
            Self::Vertical { value, .. } => {
                if let Some(x) = frame.x.at(*value) {
                    reference(canvas, &format!("M{} {}V{}", Px(x), Px(frame.area.top), Px(frame.area.bottom)));
                }
            }
        }
    }
}

fn reference(canvas: &mut Canvas, d: &str) {
    canvas.open(INK);
    canvas.stroke(d, 1.2, " stroke-dasharray=\"7 3\"");
    canvas.close();
}

/// Writes the words of the reference lines, clear of each other and of the lines where that is
/// possible.
pub(crate) fn label_references(canvas: &mut Canvas, frame: &Frame, layers: &[Layer]) {
    let a = frame.area;
    let line = |l: &Layer| match l {
        Layer::Horizontal { value, .. } => frame.y.at(*value).map(|y| Area::new(a.left, y, a.right, y)),
        Layer::Vertical { value, .. } => frame.x.at(*value).map(|x| Area::new(x, a.top, x, a.bottom)),
        Layer::Points { .. } | Layer::Band { .. } | Layer::Columns { .. } => None,
    };
    let lines: Vec<Area> = layers.iter().filter_map(line).collect();
    let mut labels: Vec<Area> = Vec::new();
    for layer in layers {
        let (Layer::Horizontal { label, .. } | Layer::Vertical { label, .. }) = layer else { continue };
        let Some(place) = line(layer) else { continue };
        let text = fit(label, FONT, a.width() / 2.5);
        let w = text_width(&text, FONT);
        let spots: Vec<(f64, f64)> = if matches!(layer, Layer::Horizontal { .. }) {
            let columns = [a.right - w - 6.0, a.left + 6.0, f64::midpoint(a.left, a.right) - w / 2.0];
            columns.iter().flat_map(|&x| [(x, place.top - 5.0), (x, place.top + 14.0)]).collect()
        } else {
            let rows = (0..6).map(|row| a.top + 14.0 + 16.0 * f64::from(row));
            rows.flat_map(|y| [(place.left + 6.0, y), (place.left - 6.0 - w, y)]).collect()
        };
        let cover = |&(x, y): &(f64, f64)| Area::new(x - 3.0, y - FONT, x + w + 3.0, y + 3.0);
        let inside = |spot: &&(f64, f64)| {
            let c = cover(spot);
            c.left > a.left - 4.0 && c.right < a.right + 4.0 && c.top > a.top - 3.0 && c.bottom < a.bottom + 3.0
        };
        let cost = |spot: &&(f64, f64)| {
            let c = cover(spot);
            let hits = |list: &[Area]| list.iter().filter(|o| c.touches(o)).count();
            10 * hits(&labels) + hits(&lines)
        };
        if let Some(&(x, y)) = spots.iter().filter(inside).min_by_key(cost) {
            labels.push(cover(&(x, y)));
            canvas.halo(x, y, Anchor::Start, &text);
        }
    }
}

/// Splits at what cannot be drawn.
fn runs<T: Copy, P>(points: &[T], place: impl Fn(T) -> Option<P>) -> Vec<Vec<P>> {
    let mut runs = vec![Vec::new()];
    for &p in points {
        match place(p) {
            Some(at) => runs.last_mut().expect("never empty").push(at),
            None if runs.last().is_some_and(|r| !r.is_empty()) => runs.push(Vec::new()),
            None => {}
        }
    }
    runs.retain(|r| !r.is_empty());
    runs
}

/// Longest list of points that is drawn as it is.
const MOST_POINTS: usize = 3000;

/// Thins a polyline to first, lowest, highest and last of each chunk: the envelope survives.
pub(crate) fn thin(run: &[(f64, f64)]) -> Vec<(f64, f64)> {
    if run.len() <= MOST_POINTS {
        return run.to_vec();
    }
    let mut out = Vec::with_capacity(MOST_POINTS);
    for chunk in run.chunks(run.len().div_ceil(MOST_POINTS / 4)) {
        let by_height = |a: &&usize, b: &&usize| chunk[**a].1.total_cmp(&chunk[**b].1);
        let indices: Vec<usize> = (0..chunk.len()).collect();
        let low = indices.iter().min_by(by_height).copied().unwrap_or(0);
        let high = indices.iter().max_by(by_height).copied().unwrap_or(0);
        let mut keep = [0, low.min(high), low.max(high), chunk.len() - 1];
        keep.sort_unstable();
        let mut last = None;
        for i in keep {
            if last != Some(i) {
                out.push(chunk[i]);
                last = Some(i);
            }
        }
    }
    out
}

/// Leaves out points of a path that lie within this many pixels of the last one drawn.
const NEAR: f64 = 0.3;

fn sparse(run: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut out: Vec<(f64, f64)> = Vec::new();
    for (i, point) in run.iter().enumerate() {
        let far = out.last().is_none_or(|last| (last.0 - point.0).hypot(last.1 - point.1) > NEAR);
        if far || i + 1 == run.len() {
            out.push(*point);
        }
    }
    out
}

fn polyline(run: &[(f64, f64)]) -> String {
    let mut d = String::new();
    for (i, &(x, y)) in run.iter().enumerate() {
        let _ = write!(d, "{}{} {}", if i == 0 { 'M' } else { 'L' }, Px(x), Px(y));
    }
    d
}

fn staircase(run: &[(f64, f64)]) -> String {
    let mut d = String::new();
    for (i, &(x, y)) in run.iter().enumerate() {
        let _ = if i == 0 { write!(d, "M{} {}", Px(x), Px(y)) } else { write!(d, "H{}V{}", Px(x), Px(y)) };
    }
    d
}

fn draw_points(canvas: &mut Canvas, frame: &Frame, data: &[(f64, f64)], form: Form, style: Style) {
    let runs = runs(data, |p| frame.at(p));
    let mut line = String::new();
    if form != Form::Scatter {
        for run in &runs {
            line.push_str(&match form {
                Form::Step => staircase(&thin(run)),
                Form::Path => polyline(&sparse(run)),
                Form::Line | Form::LineOfPoints | Form::Scatter => polyline(&thin(run)),
            });
        }
    }
    // A single point draws no line; it gets its marker so that it does not vanish.
    let lone = runs.iter().all(|r| r.len() == 1);
    let mut marked: Vec<(f64, f64)> = Vec::new();
    if lone || matches!(form, Form::Scatter | Form::LineOfPoints) {
        marked = runs.concat();
    }
    let mut cell = 1.0;
    while marked.len() > MOST_POINTS {
        // Markers this close hide each other.
        let at = |p: &(f64, f64)| ((p.0 / cell) as i64, (p.1 / cell) as i64);
        marked.sort_by_key(at);
        marked.dedup_by_key(|p| at(p));
        cell *= 1.5;
    }
    let outlines = markers(marked, style, if frame.on_colour { 1.5 * MARKER } else { MARKER });
    if frame.on_colour {
        canvas.open(PAPER);
        canvas.stroke(&line, 4.5, " stroke-linejoin=\"round\"");
        canvas.stroke(&outlines, 5.0, "");
        canvas.close();
    }
    canvas.open(style.colour.paint());
    canvas.stroke(&line, 2.0, &format!(" stroke-linejoin=\"round\"{}", style.dash.attribute()));
    fill_markers(canvas, &outlines, style);
    canvas.close();
}

fn draw_band(canvas: &mut Canvas, frame: &Frame, data: &[(f64, f64, f64)], style: Style) {
    let place = |(x, low, high)| Some((frame.x.at(x)?, frame.y.at(low)?, frame.y.at(high)?));
    canvas.open(style.colour.paint());
    for run in runs(data, place) {
        let lower = thin(&run.iter().map(|p| (p.0, p.1)).collect::<Vec<_>>());
        let mut upper = thin(&run.iter().map(|p| (p.0, p.2)).collect::<Vec<_>>());
        canvas.stroke(
            &(polyline(&lower) + &polyline(&upper)),
            1.0,
            &format!(" opacity=\"0.7\"{}", style.dash.attribute()),
        );
        let mut d = polyline(&lower);
        upper.reverse();
        d.push_str(&polyline(&upper).replacen('M', "L", 1));
        d.push('z');
        canvas.fill(&d, if style.colour == Colour::Grey { 0.35 } else { 0.2 }, None);
    }
    canvas.close();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinning_keeps_ends_and_extremes() {
        let mut run: Vec<(f64, f64)> = (0..100_000).map(|i| (f64::from(i), (f64::from(i) * 0.1).sin())).collect();
        run[54_321].1 = 7.0;
        run[12_345].1 = -7.0;
        let thin = thin(&run);
        assert!(thin.len() <= MOST_POINTS + 4);
        assert_eq!((thin[0], *thin.last().expect("not empty")), (run[0], run[99_999]));
        assert!(thin.contains(&run[54_321]) && thin.contains(&run[12_345]));
        assert!(thin.windows(2).all(|w| w[0].0 < w[1].0));
    }

    #[test]
    fn a_gap_in_the_data_is_a_gap_in_the_line() {
        let data = [(0.0, 1.0), (1.0, f64::NAN), (2.0, 1.0), (3.0, 1.0)];
        let place = |p: (f64, f64)| p.1.is_finite().then_some(p);
        assert_eq!(runs(&data, place).iter().map(Vec::len).collect::<Vec<_>>(), [1, 2]);
    }
}
