//! Every neutral vibration of a turning cut at one speed, isolated by bounds on derivatives.
//!
//! The characteristic function is `1 + b L(s)`, linear in the width, so that the frequencies of neutral vibrations do
//! not depend on the width: they are the zeros of `Im L(i w)` where `Re L < 0`, each at the width `−1/Re L`. An
//! interval of frequencies holds no zero, or exactly one, or is halved (Moore, Interval Analysis, 1966, with bounds of
//! the derivatives in place of intervals).

use super::line::{Bounds, LoopGain, Value};
use crate::verdict::{ChatterKind, StabilityLimit};
use std::collections::BinaryHeap;
use std::f64::consts::TAU;

/// Relative width of an interval that is not halved any more: two zeros that close are one touch.
const FINEST: f64 = 1e-13;

/// A neutral vibration.
#[derive(Clone, Copy, Debug)]
pub(super) struct NeutralVibration {
    /// Width of cut (m).
    pub width: f64,
    /// Angular frequency (rad/s).
    pub frequency: f64,
    /// By how many the unstable roots grow when the width passes: 2, −2, or 0 where the boundary is only touched.
    pub change: i32,
}

impl NeutralVibration {
    pub fn limit(&self) -> StabilityLimit {
        let chatter_frequency = self.frequency / TAU;
        StabilityLimit { depth: self.width, kind: ChatterKind::Hopf, chatter_frequency }
    }
}

/// The neutral vibrations of a cut at one speed.
pub(super) struct Crossings<'a> {
    line: &'a LoopGain,
}

/// What an interval of frequencies holds.
enum Content {
    Nothing,
    /// One zero.
    One(NeutralVibration),
    /// Not known yet; greatest `1/b` in it.
    Unknown(f64),
}

/// The neutral vibration of least width so far.
struct Best {
    /// `1/b` of it, or of the greatest width that counts.
    least_inverse: f64,
    vibration: Option<NeutralVibration>,
}

/// An interval that waits in a queue, the one with the least possible width of cut first.
struct Waiting {
    greatest_inverse_width: f64,
    from: f64,
    to: f64,
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Waiting {}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.greatest_inverse_width
            .total_cmp(&other.greatest_inverse_width)
            .then_with(|| other.from.total_cmp(&self.from))
    }
}

impl<'a> Crossings<'a> {
    pub fn new(line: &'a LoopGain) -> Self {
        Self { line }
    }

    /// All neutral vibrations up to the width `greatest` (m), by ascending width.
    pub fn up_to(&self, greatest: f64) -> Vec<NeutralVibration> {
        let least_inverse = 1.0 / greatest;
        let mut found = Vec::new();
        let mut open = self.pieces(greatest);
        while let Some((from, to)) = open.pop() {
            match self.content(from, to, least_inverse) {
                Content::Nothing => {}
                Content::One(vibration) => found.push(vibration),
                Content::Unknown(_) => {
                    let middle = 0.5 * (from + to);
                    open.extend([(middle, to), (from, middle)]);
                }
            }
        }
        found.sort_by(|a, b| a.width.total_cmp(&b.width));
        found
    }

    /// The neutral vibration of least width up to `greatest` (m): there the cut becomes unstable first.
    pub fn least(&self, greatest: f64) -> Option<NeutralVibration> {
        let mut best = Best { least_inverse: 1.0 / greatest, vibration: None };
        let mut open = BinaryHeap::new();
        for (from, to) in self.pieces(greatest) {
            open.extend(self.look(from, to, &mut best));
        }
        while let Some(Waiting { greatest_inverse_width, from, to }) = open.pop() {
            if greatest_inverse_width <= best.least_inverse {
                break;
            }
            let middle = 0.5 * (from + to);
            open.extend(self.look(from, middle, &mut best));
            open.extend(self.look(middle, to, &mut best));
        }
        best.vibration
    }

    /// Looks at an interval for a vibration of less width than the `best`; the interval where it is not known yet.
    fn look(&self, start: f64, end: f64, best: &mut Best) -> Option<Waiting> {
        match self.content(start, end, best.least_inverse) {
            Content::Nothing => None,
            Content::One(vibration) => {
                // The boundary that is only touched is no limit.
                if vibration.change != 0 {
                    *best = Best { least_inverse: 1.0 / vibration.width, vibration: Some(vibration) };
                }
                None
            }
            Content::Unknown(greatest_inverse_width) => Some(Waiting { greatest_inverse_width, from: start, to: end }),
        }
    }

    /// Intervals between the resonances that together hold every neutral vibration up to `greatest` (m).
    fn pieces(&self, greatest: f64) -> Vec<(f64, f64)> {
        let mut edges = vec![0.0];
        edges.extend(self.line.resonances());
        edges.push(self.line.highest_frequency(greatest));
        edges.dedup();
        edges.windows(2).rev().map(|pair| (pair[0], pair[1])).collect()
    }

    /// What the interval holds of widths whose inverse is at least `least_inverse`.
    fn content(&self, start: f64, end: f64, least_inverse: f64) -> Content {
        let (middle, half) = (0.5 * (start + end), 0.5 * (end - start));
        let value = self.line.at(middle);
        let Bounds { greatest_inverse_width, damped, slope, curvature, .. } = self.line.bounds(middle, half, &value);
        let off_axis = value.gain.im.abs() > slope * half;
        if damped || off_axis || greatest_inverse_width < least_inverse || value.gain.re - slope * half > -least_inverse
        {
            return Content::Nothing;
        }
        if value.slope.im.abs() > curvature * half {
            // Monotone: one zero if the ends differ in sign.
            let ends = [self.line.at(start), self.line.at(end)];
            if (ends[0].gain.im > 0.0) == (ends[1].gain.im > 0.0) {
                return Content::Nothing;
            }
            let change = if value.slope.im > 0.0 { 2 } else { -2 };
            return self.neutral(self.zero(start, end, ends[1].gain.im > 0.0), change, least_inverse);
        }
        if half <= FINEST * middle {
            return self.neutral((middle, value), 0, least_inverse);
        }
        Content::Unknown(greatest_inverse_width)
    }

    fn neutral(&self, (frequency, value): (f64, Value), change: i32, least_inverse: f64) -> Content {
        let inverse = -value.gain.re;
        if inverse < least_inverse {
            return Content::Nothing;
        }
        Content::One(NeutralVibration { width: 1.0 / inverse, frequency, change })
    }

    /// The only zero of `Im L` in an interval, by Newton's method kept within a bracket.
    fn zero(&self, mut start: f64, mut end: f64, rises: bool) -> (f64, Value) {
        let mut w = 0.5 * (start + end);
        loop {
            let value = self.line.at(w);
            if (value.gain.im > 0.0) == rises {
                end = w
            } else {
                start = w
            }
            let newton = w - value.gain.im / value.slope.im;
            let next = if newton > start && newton < end { newton } else { 0.5 * (start + end) };
            if (next - w).abs() <= 4.0 * f64::EPSILON * w || next == start || next == end {
                return (w, value);
            }
            w = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Mode, Turning};
    use nalgebra::Complex;
    use proptest::prelude::*;

    impl Crossings<'_> {
        /// Number of unstable roots at the width `width` (m) by the argument principle, adaptively along the axis:
        /// independent of the neutral vibrations.
        fn winding(&self, width: f64) -> i64 {
            let mut turned = 0.0;
            let mut open = self.pieces(width);
            while let Some((from, to)) = open.pop() {
                let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
                let value = self.line.at(middle);
                let bounds = self.line.bounds(middle, half, &value);
                let far = |value: Value| Complex::new(1.0, 0.0) + value.gain * width;
                // Within a disc that leaves out zero the argument has one branch.
                if far(value).norm() > width * bounds.slope * half || half <= FINEST * middle {
                    turned += (far(self.line.at(to)) / far(self.line.at(from))).arg();
                } else {
                    open.extend([(middle, to), (from, middle)]);
                }
            }
            -(turned / std::f64::consts::PI).round() as i64
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]
        #[test]
        fn the_books_close_between_all_neutral_vibrations(
            modes in proptest::collection::vec((-0.7..0.7f64, 100.0..1500.0f64, 0.008..0.06f64, 4e6..6e7f64), 1..5),
            force_angle in 0.0..1.0f64,
            process_damping in prop_oneof![Just(0.0), 3e4..1e6f64],
            speed in 30.0..1500.0f64,
        ) {
            let modes = modes.iter().map(|(turn, natural_frequency, damping_ratio, stiffness)| Mode {
                direction: [turn.cos(), turn.sin()],
                natural_frequency: *natural_frequency,
                damping_ratio: *damping_ratio,
                stiffness: *stiffness,
            });
            let cut = Turning { force_angle, process_damping, ..Turning::orthogonal(modes.collect(), 1.5e9, 0.04) };
            let line = LoopGain::new(&cut, speed).unwrap();
            let crossings = Crossings::new(&line);
            let found = crossings.up_to(2e-2 * line.stiff_width());
            let mut unstable = 0;
            for pair in found.windows(2) {
                unstable += pair[0].change;
                if pair[1].width > pair[0].width * (1.0 + 1e-9) {
                    let middle = 0.5 * (pair[0].width + pair[1].width);
                    prop_assert_eq!(i64::from(unstable), crossings.winding(middle), "{} m", middle);
                }
            }
        }
    }
}
