//! Motions through a stock of heights over a grid.

use crate::cutting::{Cut, Encounter, Look, MARGIN, Sums};
use crate::engaged::Engaged;
use crate::front::Place;
use crate::load::{Load, Tool, wear_rate};
use crate::map::Map;
use std::f64::consts::PI;
use toolroom_contour::Point;
use toolroom_program::Motion;

/// Steps at whose ends and middle the engagement is looked at, as a share of the cutter's radius.
const STEP: f64 = 0.1;
/// Steps of a motion at most; they are longer on very long ones (assumption).
const STEPS: f64 = 1e5;
/// Width in columns below which what goes is the rounding of walls to columns and not a cut: a twentieth (assumption; the stamps of
/// two ways along one wall differ by less).
const WIDTH: f64 = 0.05;
/// Share of a motion over which its direction is measured.
const AHEAD: f64 = 1e-6;

impl Map {
    /// Moves a tool through the heights.
    pub(crate) fn motion(&mut self, motion: &Motion, tool: &Tool, speed: f64, mut look: Option<&mut Look<'_>>) -> Cut {
        let mut cut = Cut::default();
        let at = |share: f64| {
            let axes = if share >= 1.0 { motion.end } else { motion.position(share) };
            (Point { x: 1e-3 * axes[0], y: 1e-3 * axes[1] }, 1e-3 * axes[2])
        };
        // The way in the plane, by its chords: an arc in another plane does not move evenly over it.
        const CHORDS: u32 = 64;
        let length: f64 = (0..CHORDS)
            .map(|i| at(f64::from(i) / f64::from(CHORDS)).0.distance(at(f64::from(i + 1) / f64::from(CHORDS)).0))
            .sum();
        if length < 1e-9 {
            return self.straight_down(motion, tool);
        }
        let feed = if motion.rapid || motion.time <= 0.0 { 0.0 } else { 1e-3 * motion.length / motion.time };
        let steps = (length / (STEP * tool.radius).max(self.cell())).ceil().clamp(1.0, STEPS);
        let step = length / steps;
        let mut sums = Sums::default();
        let mut heading = at(0.0).0.heading_to(at(AHEAD).0);
        let mut first: Option<Engaged> = None;
        for i in 0..steps as u32 {
            let (from, to) = (f64::from(i) / steps, f64::from(i + 1) / steps);
            let middle = 0.5 * (from + to);
            let place = |share: f64, heading: f64| {
                let (centre, bottom) = at(share);
                Place { centre, radius: tool.radius, bottom, heading }
            };
            let turn = |share: f64, before: f64| {
                let (back, ahead) = (at((share - AHEAD).max(0.0)).0, at((share + AHEAD).min(1.0)).0);
                if back.distance(ahead) > 0.0 { back.heading_to(ahead) } else { before }
            };
            let begin = first.take().unwrap_or_else(|| self.engaged(tool, &place(from, heading), 0.0));
            let mut gone = self.sweep(tool, at, (from, middle), 0.5 * step);
            heading = turn(middle, heading);
            let halfway = self.engaged(tool, &place(middle, heading), 0.0);
            let slack = 0.5 * step + 0.5 * self.cell();
            let bound = self.engaged(tool, &place(middle, heading), slack);
            gone += self.sweep(tool, at, (middle, to), 0.5 * step);
            heading = turn(to, heading);
            let end = self.engaged(tool, &place(to, heading), 0.0);
            first = Some(end.clone());
            cut.removed += gone;
            if let Some(holder) = &tool.holder {
                let (centre, tip) = at(to);
                cut.holder |= self.over(centre, holder.radius, tip + holder.overhang) > 0.0;
            }
            let samples = [&begin, &halfway, &end];
            let depth = samples.into_iter().map(Engaged::depth).fold(0.0, f64::max);
            if gone <= WIDTH * self.cell() * depth * step || bound.layers.is_empty() {
                sums.air += step;
                if let Some(look) = &mut look {
                    let near = !self.engaged(tool, &place(middle, heading), MARGIN).layers.is_empty();
                    look(from, to, if near { Encounter::Near } else { Encounter::Air });
                }
                continue;
            }
            if let Some(look) = &mut look {
                look(from, to, Encounter::Cut(&bound, samples, tool));
            }
            cut.take(samples, &bound);
            sums.take(samples, step, |engaged| wear_rate(engaged, tool, feed, speed));
            if let Some(load) = Load::most(&bound, samples, tool, feed, speed) {
                cut.load = Some(cut.load.map_or(load, |before| before.max(load)));
            }
        }
        sums.settle(&mut cut, length, 1e-3 * motion.length, feed);
        cut.crash = motion.rapid && sums.way > 0.0;
        cut
    }

    /// A motion along Z alone.
    fn straight_down(&mut self, motion: &Motion, tool: &Tool) -> Cut {
        let (from, to) = (1e-3 * motion.start[2], 1e-3 * motion.end[2]);
        let centre = Point { x: 1e-3 * motion.end[0], y: 1e-3 * motion.end[1] };
        let mut cut = Cut { air: 1.0, ..Cut::default() };
        if to < from && !motion.unknown {
            cut.depth = self.over(centre, tool.radius, to);
            cut.removed = self.stamp(tool, centre, to);
            // More than the rounding of a wall to columns.
            cut.plunge = cut.removed > PI * tool.radius * WIDTH * self.cell() * (from - to).min(cut.depth);
            cut.air = f64::from(u8::from(!cut.plunge));
            cut.crash = motion.rapid && cut.plunge;
        }
        if let Some(holder) = &tool.holder {
            cut.holder = self.over(centre, holder.radius, to.min(from) + holder.overhang) > 0.0;
        }
        cut
    }
}
