//! Colour strips above a plot: what is in force along the horizontal axis.

use super::frame::{Entry, Frame, Sample};
use super::style::Style;
use super::svg::{Anchor, Area, Canvas, FONT, fit};
use super::table::Table;
use std::collections::BTreeSet;

/// Height of a strip with its distance from what is below.
const ROW: f64 = 20.0;
/// Height of the coloured area itself.
const BAR: f64 = 14.0;
/// Room for the label left of the area.
const LABEL: f64 = 60.0;

/// Intervals of a few kinds.
#[derive(Clone, Debug)]
pub(crate) struct Strip {
    label: String,
    kinds: Vec<(String, Style)>,
    intervals: Vec<(f64, f64, usize)>,
}

impl Strip {
    /// Neighbours of one kind become one interval.
    pub fn new(label: String, kinds: Vec<(String, Style)>, given: Vec<(f64, f64, usize)>) -> Self {
        let mut intervals: Vec<(f64, f64, usize)> = Vec::new();
        for (from, to, kind) in given {
            match intervals.last_mut() {
                Some(last) if last.2 == kind && last.1 == from => last.1 = to,
                _ if kind < kinds.len() && from.is_finite() && to.is_finite() => intervals.push((from, to, kind)),
                _ => {}
            }
        }
        Self { label, kinds, intervals }
    }

    /// Intervals in pixels; of more than there are pixels, the kind in the middle of each pixel.
    fn pixels(&self, frame: &Frame) -> Vec<(f64, f64, usize)> {
        let placed = self.intervals.iter().filter_map(|(from, to, kind)| {
            let within = |x: f64| x.clamp(frame.area.left, frame.area.right);
            Some((within(frame.x.at(*from)?), within(frame.x.at(*to)?), *kind))
        });
        let placed: Vec<(f64, f64, usize)> = placed.collect();
        let columns = frame.area.width().ceil() as usize;
        if placed.len() <= columns {
            return placed;
        }
        let mut merged: Vec<(f64, f64, usize)> = Vec::new();
        let mut index = 0;
        for column in 0..columns {
            let (left, right) = (frame.area.left + column as f64, frame.area.left + column as f64 + 1.0);
            while index + 1 < placed.len() && placed[index].1 < left + 0.5 {
                index += 1;
            }
            match merged.last_mut() {
                Some(last) if last.2 == placed[index].2 => last.1 = right,
                _ => merged.push((left, right, placed[index].2)),
            }
        }
        merged
    }

    /// Appends the intervals to the data of the plot: label and kind, from, to.
    pub fn tabulate(&self, table: &mut Table) {
        for (from, to, kind) in &self.intervals {
            let label = format!("{}: {}, from and to", self.label, self.kinds[*kind].0);
            table.push([label.into(), (*from).into(), (*to).into()]);
        }
    }
}

/// Height that the strips take above the plot area.
pub(crate) fn height(strips: &[Strip]) -> f64 {
    ROW * strips.len() as f64
}

/// The legend of all strips: each kind that occurs once.
pub(crate) fn entries(strips: &[Strip]) -> Vec<Entry<'_>> {
    let mut seen = BTreeSet::new();
    let used = strips.iter().flat_map(|strip| {
        let kinds: BTreeSet<usize> = strip.intervals.iter().map(|interval| interval.2).collect();
        kinds.into_iter().map(|kind| &strip.kinds[kind])
    });
    used.filter(|(label, _)| seen.insert(label.as_str()))
        .map(|(label, style)| Entry { label, style: *style, sample: Sample::Block })
        .collect()
}

/// Draws the strips from `top` down.
pub(crate) fn draw(strips: &[Strip], canvas: &mut Canvas, frame: &Frame, top: f64) {
    for (i, strip) in strips.iter().enumerate() {
        let y = top + ROW * i as f64 + 4.0;
        canvas.muted(frame.area.left - 5.0, y + 0.5 * BAR + 4.0, Anchor::End, &fit(&strip.label, FONT, LABEL));
        for (from, to, kind) in strip.pixels(frame) {
            let (label, style) = &strip.kinds[kind];
            canvas.block(Area::new(from, y, to.max(from + 0.5), y + BAR), style.colour, style.hatch, label);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Axis, Chart, Plot, Style};

    fn plot(count: usize) -> Plot {
        let kinds = ["accuracy", "tool_life"].iter().enumerate().map(|(i, kind)| ((*kind).to_owned(), Style::nth(i)));
        let intervals = (0..count).map(|i| (i as f64, (i + 1) as f64, (i / 2) % 2));
        Plot::new("Feed", Axis::linear("Way", "mm"), Axis::linear("Feed", "mm/min"))
            .line("plan", [(0.0, 1.0), (count as f64, 2.0)], Style::nth(0))
            .strip("limit", kinds, intervals)
    }

    #[test]
    fn neighbours_of_one_kind_are_one_interval_and_every_kind_is_in_the_legend() {
        let plot = plot(8);
        let strips = plot.data().rows().iter().filter(|row| format!("{row:?}").contains("from and to")).count();
        assert_eq!(strips, 4);
        let svg = plot.svg();
        assert!(svg.matches("accuracy").count() >= 3 && svg.contains("tool_life"), "{svg}");
    }

    #[test]
    fn a_strip_of_many_intervals_stays_small() {
        assert!(plot(50_000).svg().len() < 400_000);
    }
}
