//! What happened when, one row per machine.

use super::axis::Axis;
use super::frame::{self, Entry, Sample, points};
use super::rows::Rows;
use super::style::Style;
use super::svg::{Area, Canvas, FONT, text_width};
use super::table::{Cell, Table};
use super::{Chart, describe};

/// Widest list of intervals per row that is drawn one by one.
const MOST_INTERVALS: usize = 1500;

#[derive(Clone, Debug)]
struct Interval {
    row: usize,
    kind: usize,
    from: f64,
    to: f64,
    label: String,
}

/// Intervals on rows, coloured and hatched by kind, with marks for instants such as tool changes.
///
/// Rows, kinds and kinds of marks are addressed by the order in which they were added.
///
/// # Examples
/// ```
/// use toolroom_chart::{Axis, Chart, Gantt, Style};
/// let gantt = Gantt::new("One shift", Axis::linear("Time", "h"), ["L1", "L2"])
///     .kind("cutting", Style::nth(0))
///     .mark_kind("tool change", Style::nth(2))
///     .interval(0, 0, 0.0, 1.5, "part 1")
///     .mark(0, 0, 1.5);
/// assert_eq!(gantt.data().rows().len(), 2);
/// ```
#[derive(Clone, Debug)]
pub struct Gantt {
    title: String,
    description: String,
    axis: Axis,
    rows: Vec<String>,
    kinds: Vec<(String, Style)>,
    mark_kinds: Vec<(String, Style)>,
    intervals: Vec<Interval>,
    marks: Vec<(usize, usize, f64)>,
}

impl Gantt {
    /// Empty rows over a time axis.
    #[must_use]
    pub fn new<S: Into<String>>(title: impl Into<String>, time: Axis, rows: impl IntoIterator<Item = S>) -> Self {
        Self {
            title: title.into(),
            description: String::new(),
            axis: time,
            rows: rows.into_iter().map(Into::into).collect(),
            kinds: Vec::new(),
            mark_kinds: Vec::new(),
            intervals: Vec::new(),
            marks: Vec::new(),
        }
    }

    describe!();

    /// Adds a kind of intervals.
    #[must_use]
    pub fn kind(mut self, label: impl Into<String>, style: Style) -> Self {
        self.kinds.push((label.into(), style));
        self
    }

    /// Adds a kind of marks.
    #[must_use]
    pub fn mark_kind(mut self, label: impl Into<String>, style: Style) -> Self {
        self.mark_kinds.push((label.into(), style));
        self
    }

    /// Adds an interval. The label is written where it fits and shown on hovering.
    #[must_use]
    pub fn interval(mut self, row: usize, kind: usize, start: f64, end: f64, label: impl Into<String>) -> Self {
        self.intervals.push(Interval { row, kind, from: start, to: end, label: label.into() });
        self
    }

    /// Adds a mark at an instant.
    #[must_use]
    pub fn mark(mut self, row: usize, kind: usize, time: f64) -> Self {
        self.marks.push((row, kind, time));
        self
    }

    fn shows(&self, v: &Interval) -> bool {
        let known = v.row < self.rows.len() && v.kind < self.kinds.len();
        known && self.axis.holds(v.from) && self.axis.holds(v.to) && v.from <= v.to
    }

    fn shows_mark(&self, &(row, kind, time): &(usize, usize, f64)) -> bool {
        row < self.rows.len() && kind < self.mark_kinds.len() && self.axis.holds(time)
    }

    /// Intervals of row `i` that are drawn: all of them, or what fills most of each half pixel.
    fn drawn(&self, i: usize, rows: &Rows) -> Vec<(Area, usize, &str)> {
        let here = || self.intervals.iter().filter(|v| v.row == i && self.shows(v));
        let area = |v: &Interval| rows.block(i, v.from, v.to, 0.7);
        if here().count() <= MOST_INTERVALS {
            return here().filter_map(|v| Some((area(v)?, v.kind, v.label.as_str()))).collect();
        }
        const CELL: f64 = 0.5;
        let cells = (rows.area.width() / CELL).ceil() as usize;
        let mut share = vec![vec![0.0; self.kinds.len()]; cells];
        for v in here() {
            let Some(a) = area(v) else { continue };
            let [from, to] = [a.left, a.right].map(|x| (x - rows.area.left) / CELL);
            for (cell, share) in share.iter_mut().enumerate().take(to.ceil() as usize).skip(from as usize) {
                share[v.kind] += (to.min(cell as f64 + 1.0) - from.max(cell as f64)).max(0.0);
            }
        }
        let winner = |s: &Vec<f64>| {
            let best = (0..s.len()).max_by(|&a, &b| s[a].total_cmp(&s[b]))?;
            (s[best] > 0.1).then_some(best)
        };
        let mut out: Vec<(Area, usize, &str)> = Vec::new();
        let (top, bottom) = rows
            .block(i, self.intervals[0].from, self.intervals[0].from, 0.7)
            .map_or((0.0, 0.0), |a| (a.top, a.bottom));
        for (cell, share) in share.iter().enumerate() {
            let Some(kind) = winner(share) else { continue };
            let left = rows.area.left + CELL * cell as f64;
            match out.last_mut() {
                Some((area, k, _)) if *k == kind && left - area.right < 1e-6 => area.right = left + CELL,
                _ => out.push((Area::new(left, top, left + CELL, bottom), kind, "")),
            }
        }
        out
    }
}

impl Chart for Gantt {
    fn title(&self) -> &str {
        &self.title
    }

    fn svg(&self) -> String {
        let times = self.intervals.iter().filter(|v| self.shows(v)).flat_map(|v| [v.from, v.to]);
        let marks = self.marks.iter().filter(|m| self.shows_mark(m)).map(|m| m.2);
        let Some(scale) = self.axis.scale(times.chain(marks)) else {
            return frame::empty(&self.title, &self.description);
        };
        let mut canvas = Canvas::new();
        let kinds = self.kinds.iter().map(|(label, style)| Entry { label, style: *style, sample: Sample::Block });
        let marks = self.mark_kinds.iter().map(|(label, style)| Entry { label, style: *style, sample: Sample::Points });
        let top = frame::header(&mut canvas, &self.title, &kinds.chain(marks).collect::<Vec<_>>());
        let place = (top, Rows::height(self.rows.len(), 38.0));
        let rows = Rows::new(&mut canvas, self.rows.iter().map(String::as_str), (&self.axis, scale), place, 0.0);
        for i in 0..self.rows.len() {
            for (area, kind, label) in self.drawn(i, &rows) {
                let style = self.kinds[kind].1;
                // Half a pixel at least: what happened must be seen.
                let area = Area { right: area.right.max(area.left + 0.5), ..area };
                canvas.block(area, style.colour, style.hatch, label);
                if !label.is_empty() && text_width(label, FONT) + 8.0 < area.width() {
                    let middle = f64::midpoint(area.left, area.right);
                    canvas.inside(middle, rows.middle(i) + 4.0, label, style.colour, style.hatch);
                }
            }
        }
        for (kind, (_, style)) in self.mark_kinds.iter().enumerate() {
            let here = self.marks.iter().filter(|m| m.1 == kind && self.shows_mark(m));
            // On the upper edge of the bar, clear of the labels in it.
            let places = here.filter_map(|m| Some((rows.x.at(m.2)?, rows.middle(m.0) - 13.0)));
            let mut places: Vec<(f64, f64)> = places.collect();
            places.dedup_by_key(|p| (p.0.round(), p.1.round()));
            canvas.open(style.colour.paint());
            points(&mut canvas, places, *style);
            canvas.close();
        }
        let omitted = self.intervals.iter().filter(|v| !self.shows(v)).count()
            + self.marks.iter().filter(|m| !self.shows_mark(m)).count();
        frame::finish(canvas, &self.title, &self.description, rows.area.bottom, &frame::omitted(omitted))
    }

    fn data(&self) -> Table {
        let name = |list: &[(String, Style)], i: usize| list.get(i).map_or(String::new(), |k| k.0.clone());
        let row = |i: usize| self.rows.get(i).cloned().unwrap_or_default();
        let unit = self.axis.unit();
        let column = |word: &str| if unit.is_empty() { word.to_owned() } else { format!("{word} [{unit}]") };
        let mut table =
            Table::new(["row".to_owned(), "kind".to_owned(), column("from"), column("to"), "label".to_owned()]);
        for v in &self.intervals {
            let kind = name(&self.kinds, v.kind);
            table.push([row(v.row).into(), kind.into(), v.from.into(), v.to.into(), v.label.as_str().into()]);
        }
        for &(i, kind, time) in &self.marks {
            table.push([row(i).into(), name(&self.mark_kinds, kind).into(), time.into(), Cell::Number(time)]);
        }
        table
    }
}
