//! From one total to another, step by step.

use super::axis::{Axis, alike};
use super::bars::Estimate;
use super::frame::{self, Entry, Sample};
use super::px::Px;
use super::rows::Rows;
use super::style::{Colour, Hatch, INK, MUTED, Style};
use super::svg::{Anchor, Area, Canvas, FONT, fit};
use super::table::Table;
use super::{Chart, describe};

/// A waterfall: totals stand on zero, changes hang between the totals.
///
/// # Examples
/// ```
/// use toolroom_chart::{Axis, Chart, Waterfall};
/// let gap = Waterfall::new("Where the gap comes from", Axis::linear("RMS residual", "N"))
///     .total("baseline", 42.0)
///     .change("tool wear", -25.0)
///     .total("unexplained", 17.0);
/// assert_eq!(gap.data().rows().len(), 3);
/// ```
#[derive(Clone, Debug)]
pub struct Waterfall {
    title: String,
    description: String,
    axis: Axis,
    steps: Vec<Step>,
    reference: Option<(f64, String)>,
}

#[derive(Clone, Debug)]
struct Step {
    label: String,
    amount: Estimate,
    total: bool,
}

impl Waterfall {
    /// Without steps yet.
    #[must_use]
    pub fn new(title: impl Into<String>, axis: Axis) -> Self {
        Self {
            title: title.into(),
            description: String::new(),
            axis: axis.include(0.0),
            steps: Vec::new(),
            reference: None,
        }
    }

    describe!();

    fn step(mut self, label: impl Into<String>, amount: impl Into<Estimate>, total: bool) -> Self {
        self.steps.push(Step { label: label.into(), amount: amount.into(), total });
        self
    }

    /// Adds a total: the level from which the next changes start.
    #[must_use]
    pub fn total(self, label: impl Into<String>, level: impl Into<Estimate>) -> Self {
        self.step(label, level, true)
    }

    /// Adds a change of the level; the interval is that of the change.
    #[must_use]
    pub fn change(self, label: impl Into<String>, amount: impl Into<Estimate>) -> Self {
        self.step(label, amount, false)
    }

    /// Sets a labelled reference line, for example the noise floor.
    #[must_use]
    pub fn reference(mut self, value: f64, label: impl Into<String>) -> Self {
        self.reference = Some((value, label.into()));
        self
    }

    /// (from, to) of each step; a step that is not finite changes nothing.
    fn levels(&self) -> Vec<(f64, f64)> {
        let mut level = 0.0;
        let walk = self.steps.iter().map(|s| {
            let from = if s.total { 0.0 } else { level };
            if s.amount.value.is_finite() {
                level = from + s.amount.value;
            }
            (from, level)
        });
        walk.collect()
    }
}

const TOTAL: Style = Style::nth(0);
const LESS: Style = Style::nth(2).hatch(Hatch::Backslash);
const MORE: Style = Style::nth(1).hatch(Hatch::Slash);

impl Chart for Waterfall {
    fn title(&self) -> &str {
        &self.title
    }

    fn svg(&self) -> String {
        let levels = self.levels();
        let shown = |i: usize| self.axis.holds(self.steps[i].amount.value) && levels[i].1.is_finite();
        let bounds = |i: usize| {
            let (low, high) = self.steps[i].amount.bounds();
            let from = levels[i].0;
            [from, levels[i].1, from + low, from + high]
        };
        let values = (0..levels.len()).filter(|&i| shown(i)).flat_map(bounds);
        let any = (0..levels.len()).any(shown);
        let scale = self.axis.scale(values.chain(self.reference.iter().map(|r| r.0)));
        let Some(scale) = scale.filter(|_| any) else { return frame::empty(&self.title, &self.description) };
        let text = alike(self.steps.iter().map(|s| s.amount.value));
        let mut canvas = Canvas::new();
        let entries = [("level", TOTAL), ("decrease", LESS), ("increase", MORE)];
        let entries = entries.map(|(label, style)| Entry { label, style, sample: Sample::Block });
        let top = frame::header(&mut canvas, &self.title, &entries);
        let labels = self.steps.iter().map(|s| s.label.as_str());
        // Room right of the longest bar for its number.
        let rows = Rows::new(&mut canvas, labels, (&self.axis, scale), (top + 14.0, 32.0), 64.0);
        for (i, step) in self.steps.iter().enumerate().filter(|&(i, _)| shown(i)) {
            let (from, to) = levels[i];
            let style = match (step.total, to >= from) {
                (true, _) => TOTAL,
                (false, true) => MORE,
                (false, false) => LESS,
            };
            let Some(area) = rows.block(i, from, to, 0.62) else { continue };
            let area = Area { right: area.right.max(area.left + 1.0), ..area };
            canvas.block(area, style.colour, style.hatch, &step.label);
            let mut right = area.right;
            if let Some((low, high)) = step.amount.interval
                && let (Some(a), Some(b)) = (rows.x.at(from + low), rows.x.at(from + high))
            {
                let y = rows.middle(i);
                canvas.open(INK);
                let [y1, y2] = [Px(y - 4.0), Px(y + 4.0)];
                canvas.stroke(
                    &format!("M{a} {y}H{b}M{a} {y1}V{y2}M{b} {y1}V{y2}", a = Px(a), b = Px(b), y = Px(y)),
                    1.4,
                    "",
                );
                canvas.close();
                right = right.max(a).max(b);
            }
            let sign = if !step.total && step.amount.value > 0.0 { "+" } else { "" };
            let words = format!("{sign}{}", text(step.amount.value));
            canvas.halo(right + 6.0, rows.middle(i) + 4.0, Anchor::Start, &words);
            if i + 1 < self.steps.len()
                && let Some(x) = rows.x.at(to)
            {
                canvas.open(MUTED);
                canvas.stroke(
                    &format!("M{} {}V{}", Px(x), Px(area.bottom), Px(rows.middle(i + 1) + 10.0)),
                    1.0,
                    " stroke-dasharray=\"2 2\"",
                );
                canvas.close();
            }
        }
        if let Some((value, label)) = &self.reference
            && let Some(x) = rows.x.at(*value)
        {
            canvas.open(Colour::Ink.paint());
            let d = format!("M{} {}V{}", Px(x), Px(rows.area.top), Px(rows.area.bottom));
            canvas.stroke(&d, 1.2, " stroke-dasharray=\"7 3\"");
            canvas.close();
            canvas.halo(x, rows.area.top - 5.0, Anchor::Middle, &fit(label, FONT, 260.0));
        }
        let omitted = (0..self.steps.len()).filter(|&i| !shown(i)).count();
        frame::finish(canvas, &self.title, &self.description, rows.area.bottom, &frame::omitted(omitted))
    }

    fn data(&self) -> Table {
        let caption = self.axis.caption();
        let columns = [
            "step".to_owned(),
            format!("change or level: {caption}"),
            "lower".into(),
            "upper".into(),
            "level after".into(),
        ];
        let mut table = Table::new(columns);
        for (step, (_, to)) in self.steps.iter().zip(self.levels()) {
            let [value, low, high] = step.amount.cells();
            table.push([step.label.as_str().into(), value, low, high, to.into()]);
        }
        table
    }
}
