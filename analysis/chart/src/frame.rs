//! What all charts share: title, legend, plot area, axes and the words "no data".

use super::axis::{Axis, Scale};
use super::px::Px;
use super::style::{MUTED, Style};
use super::svg::{Anchor, Area, Canvas, FONT, WIDTH, fit, text_width};
use std::fmt::Write;

/// Where titles and legends start.
const LEFT: f64 = 2.0;
/// Distance of the plot area from the right border.
const RIGHT: f64 = 18.0;
/// Space under the plot area for tick labels and the caption.
const BELOW: f64 = 46.0;

/// Radius of a marker.
pub(crate) const MARKER: f64 = 3.5;

/// What stands beside a label in the legend.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sample {
    Line,
    LineOfPoints,
    Points,
    Block,
    Band,
}

/// One legend entry.
pub(crate) struct Entry<'a> {
    pub label: &'a str,
    pub style: Style,
    pub sample: Sample,
}

/// Draws the title and the legend; returns the y below them.
pub(crate) fn header(canvas: &mut Canvas, title: &str, entries: &[Entry]) -> f64 {
    canvas.heading(LEFT, 22.0, &fit(title, 15.5, WIDTH - 16.0));
    let mut y = 36.0;
    if entries.is_empty() {
        return y;
    }
    let (mut x, line) = (LEFT, 20.0);
    for e in entries {
        let label = fit(e.label, FONT, 340.0);
        let width = 34.0 + text_width(&label, FONT) + 16.0;
        if x + width > WIDTH && x > LEFT {
            x = LEFT;
            y += line;
        }
        sample(canvas, e, x, y + 8.0);
        canvas.text(x + 34.0, y + 12.0, Anchor::Start, &label);
        x += width;
    }
    y + line + 6.0
}

fn sample(canvas: &mut Canvas, e: &Entry, x: f64, y: f64) {
    let style = e.style;
    let area = Area::new(x + 2.0, y - 6.0, x + 28.0, y + 6.0);
    match e.sample {
        Sample::Block => {
            canvas.block(area, style.colour, style.hatch, "");
            return;
        }
        Sample::Band => {
            canvas.open(style.colour.paint());
            canvas.fill(&super::svg::rectangle(area), 0.2, None);
            let d = format!(
                "M{} {}H{}M{} {}H{}",
                Px(area.left),
                Px(area.top),
                Px(area.right),
                Px(area.left),
                Px(area.bottom),
                Px(area.right)
            );
            canvas.stroke(&d, 1.0, style.dash.attribute());
            canvas.close();
            return;
        }
        Sample::Line | Sample::LineOfPoints | Sample::Points => {}
    }
    canvas.open(style.colour.paint());
    if e.sample != Sample::Points {
        canvas.stroke(&format!("M{} {}h30", Px(x), Px(y)), 2.0, style.dash.attribute());
    }
    if e.sample != Sample::Line {
        points(canvas, [(x + 15.0, y)], style);
    }
    canvas.close();
}

/// The outlines of markers at pixel positions.
pub(crate) fn markers(at: impl IntoIterator<Item = (f64, f64)>, style: Style, radius: f64) -> String {
    at.into_iter().fold(String::new(), |mut d, (x, y)| {
        style.marker.append(&mut d, x, y, radius);
        d
    })
}

/// Draws markers at pixel positions in the current colour.
pub(crate) fn points(canvas: &mut Canvas, at: impl IntoIterator<Item = (f64, f64)>, style: Style) {
    fill_markers(canvas, &markers(at, style, MARKER), style);
}

/// Draws outlines of markers in the current colour.
pub(crate) fn fill_markers(canvas: &mut Canvas, d: &str, style: Style) {
    if style.marker.filled() {
        canvas.fill(d, 1.0, None);
    } else {
        canvas.stroke(d, 1.8, "");
    }
}

/// A plot area with two scales.
pub(crate) struct Frame {
    pub area: Area,
    pub x: Scale,
    pub y: Scale,
    /// True on a heat map: lines and points need a rim to be seen.
    pub on_colour: bool,
}

impl Frame {
    /// The pixel position of a point, `None` when an axis has no place for it.
    pub fn at(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        Some((self.x.at(x)?, self.y.at(y)?))
    }
}

/// Draws grid and axes for a plot of `height` pixels below `top`; `reserve` pixels stay free on
/// the right.
pub(crate) fn axes(
    canvas: &mut Canvas,
    (x_axis, x): (&Axis, Scale),
    (y_axis, y): (&Axis, Scale),
    (top, height): (f64, f64),
    reserve: f64,
) -> Frame {
    let bottom = top + 8.0 + height;
    let y = y.on(bottom, top + 8.0);
    let ticks = y_axis.marks(&y, (height / 48.0) as usize + 1);
    let widest = ticks.major.iter().map(|(_, l)| text_width(l, FONT)).fold(14.0, f64::max).min(150.0);
    let left = 34.0 + widest;
    let area = Area::new(left, top + 8.0, WIDTH - RIGHT - reserve, bottom);

    let mut grid = String::new();
    for v in &ticks.minor {
        if let Some(p) = y.at(*v) {
            let _ = write!(grid, "M{} {}H{}", Px(left), Px(p), Px(area.right));
        }
    }
    for (v, _) in &ticks.major {
        if let Some(p) = y.at(*v) {
            let _ = write!(grid, "M{} {}H{}", Px(left), Px(p), Px(area.right));
        }
    }
    canvas.grid(&grid);
    let mut last = f64::INFINITY;
    for (v, label) in &ticks.major {
        if let Some(p) = y.at(*v).filter(|p| (last - p).abs() > FONT + 1.0) {
            canvas.muted(left - 7.0, p + 4.0, Anchor::End, &fit(label, FONT, 150.0));
            last = p;
        }
    }

    canvas.upright(
        12.0,
        f64::midpoint(area.top, bottom),
        &fit(&y_axis.caption_with(ticks.exponent), FONT, height + 40.0),
    );
    let x = x_ruler(canvas, x_axis, x, area);
    Frame { area, x, y, on_colour: false }
}

/// Draws the horizontal axis of a plot area with its grid.
pub(crate) fn x_ruler(canvas: &mut Canvas, axis: &Axis, scale: Scale, area: Area) -> Scale {
    let scale = scale.on(area.left, area.right);
    let mut wanted = (area.width() / 75.0) as usize + 1;
    let mut ticks = axis.marks(&scale, wanted);
    // Long labels need wider steps.
    while wanted > 2 && crowded(&ticks.major, &scale) {
        wanted -= 1;
        ticks = axis.marks(&scale, wanted);
    }
    let mut grid = String::new();
    for v in ticks.minor.iter().chain(ticks.major.iter().map(|(v, _)| v)) {
        if let Some(p) = scale.at(*v) {
            let _ = write!(grid, "M{} {}V{}", Px(p), Px(area.top), Px(area.bottom));
        }
    }
    canvas.grid(&grid);
    canvas.open(MUTED);
    canvas.stroke(&format!("M{} {}V{}H{}", Px(area.left), Px(area.top), Px(area.bottom), Px(area.right)), 1.0, "");
    canvas.close();
    let mut end = f64::NEG_INFINITY;
    for (v, label) in &ticks.major {
        let half = text_width(label, FONT) / 2.0;
        if let Some(p) = scale.at(*v).filter(|p| p - half > end + 6.0) {
            canvas.muted(p.min(WIDTH - 2.0 - half), area.bottom + 17.0, Anchor::Middle, label);
            end = p + half;
        }
    }

    let caption = fit(&axis.caption_with(ticks.exponent), FONT, WIDTH - 40.0);
    let half = text_width(&caption, FONT) / 2.0 + 4.0;
    let middle = f64::midpoint(area.left, area.right).min(WIDTH - half).max(half);
    canvas.text(middle, area.bottom + 37.0, Anchor::Middle, &caption);
    scale
}

fn crowded(ticks: &[(f64, String)], scale: &Scale) -> bool {
    ticks.windows(2).any(|pair| {
        let [(a, la), (b, lb)] = pair else { return false };
        let (Some(a), Some(b)) = (scale.at(*a), scale.at(*b)) else { return false };
        b - a < (text_width(la, FONT) + text_width(lb, FONT)) / 2.0 + 8.0
    })
}

/// Ends a chart with a plot area that ends at `bottom`, with a remark about what is not shown.
pub(crate) fn finish(mut canvas: Canvas, title: &str, description: &str, bottom: f64, remark: &str) -> String {
    let mut height = bottom + BELOW;
    if !remark.is_empty() {
        canvas.muted(WIDTH - RIGHT, height + 10.0, Anchor::End, &fit(remark, FONT, WIDTH - 40.0));
        height += 18.0;
    }
    let description = [description, remark].iter().filter(|s| !s.is_empty()).copied().collect::<Vec<_>>().join(" ");
    canvas.finish(title, &description, height)
}

/// A chart without anything to draw: it says so.
pub(crate) fn empty(title: &str, description: &str) -> String {
    let mut canvas = Canvas::new();
    let top = header(&mut canvas, title, &[]);
    let area = Area::new(LEFT, top, WIDTH - LEFT, top + 120.0);
    canvas.grid(&super::svg::rectangle(area));
    canvas.muted(WIDTH / 2.0, f64::midpoint(area.top, area.bottom) + 4.0, Anchor::Middle, "no data");
    canvas.finish(title, &format!("{description} No data."), area.bottom + 8.0)
}

/// The remark on values without a place on the axes.
pub(crate) fn omitted(count: usize) -> String {
    match count {
        0 => String::new(),
        1 => "1 value without a place on the axes is not drawn.".to_owned(),
        n => format!("{n} values without a place on the axes are not drawn."),
    }
}
