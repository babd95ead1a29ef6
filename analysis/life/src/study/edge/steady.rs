//! A life in which nothing but wear changes: quadrature over wear.

use super::chips::{Chips, share_at};
use super::cubic::Cubic;
use super::noise::Clock;
use super::{Edge, LEVELS, Outcome, STRETCH, collapse, level_share};
use crate::study::{End, Study};
use std::sync::LazyLock;
use toolroom_kernel::Stream;
use toolroom_wear::{Contact, Pair};

/// Inner node of the 4-point Gauss–Lobatto rule on -1 … 1, which also takes both ends, so that
/// panels share values.
const NODE: f64 = 0.447_213_595_499_957_9;
/// Over half the panel: weights of the integral; of the cubic through the values at the nodes, the
/// weights of its integral over the first half, and of its value in the middle.
const WEIGHTS: [f64; 4] = [1.0 / 6.0, 5.0 / 6.0, 5.0 / 6.0, 1.0 / 6.0];
const FIRST_HALF: [f64; 4] =
    [0.177_083_333_333_333_34, 0.766_052_288_151_008_7, 0.067_281_045_182_324_5, -0.010_416_666_666_666_666];
const AT_MIDDLE: [f64; 4] = [-0.125, 0.625, 0.625, -0.125];

/// A life at one speed where nothing changes from pass to pass.
///
/// The wear noise multiplies the rate of wear, so that it only stretches time: the life without
/// noise is the integral of the noise factor over the life with it.
///
/// Chipping ends a life and changes nothing before: most edges are spared by a bound on the hazard
/// of the life without it, and only for the others the hazard is followed.
pub(super) fn life(study: &Study, pair: &Pair, edge: &Edge, speed: f64, stream: &mut Stream, parts: u32) -> Outcome {
    let cut = edge.mean_cut().at_speed(speed);
    let contact = pair.contact(&cut);
    let chips = Chips { chipping: pair.chipping, added: cut.chipping_rate };
    let course = Course { study, pair, edge, contact, speed, limit: study.wear_at_end(pair), parts };
    if edge.initial_wear >= course.limit {
        return course.done(0.0, edge.initial_wear, study.limit_kind(pair), [0.0; LEVELS]);
    }
    if !chips.happen() {
        return course.run(None, stream);
    }
    let unharmed = course.run(None, &mut stream.clone());
    let spared = course.greatest_hazard(&chips, &unharmed) < edge.resistance;
    if spared { unharmed } else { course.run(Some(&chips), stream) }
}

/// The life of an edge in one cut.
struct Course<'a> {
    study: &'a Study,
    pair: &'a Pair,
    edge: &'a Edge,
    contact: Contact<'a>,
    speed: f64,
    /// Wear at which the edge is spent, m.
    limit: f64,
    parts: u32,
}

impl Course<'_> {
    fn done(&self, time: f64, wear: f64, end: End, passages: [f64; LEVELS]) -> Outcome {
        let (path, weight) = (self.speed * time, self.edge.weight);
        Outcome { life: time, path, flank_wear: wear, end, weight, passages }
    }

    /// No less than the hazard that a life gathers: exact in path, the land at the upper level.
    fn greatest_hazard(&self, chips: &Chips, life: &Outcome) -> f64 {
        let (mut hazard, mut before) = (0.0, 0.0);
        for (level, passage) in life.passages.iter().enumerate() {
            let power = chips.power(self.speed * passage.min(life.life));
            hazard += (power - before) * chips.aged(self.limit * level_share(level));
            before = power;
        }
        hazard
    }

    fn run(&self, chips: Option<&Chips>, stream: &mut Stream) -> Outcome {
        let Self { study, pair, edge, contact, speed, limit, parts } = self;
        let (speed, limit, parts) = (*speed, *limit, *parts);
        // Levels are evenly spaced in the variable of quadrature, unless run-in is much narrower.
        let (even, run_in) = (limit / STRETCH, pair.curve_scale());
        let scale = if run_in > 0.5 * even { even } else { run_in };
        let longest = study.ends.time.min(study.ends.path / speed);
        let mut passages = [f64::INFINITY; LEVELS];
        let (mut hazard, mut power, mut clock) = (0.0, 0.0, Clock::new(&study.scatter, stream));
        let (mut from, mut time) = (edge.initial_wear, 0.0);
        let mut at_start = pace(contact, speed, scale, 1.0 + from / scale);
        for (level, part) in (0..LEVELS).flat_map(|level| (1..=parts).map(move |part| (level, part))) {
            let below = if level == 0 { 0.0 } else { level_share(level - 1) };
            let share = below + (level_share(level) - below) * f64::from(part) / f64::from(parts);
            let whole = part == parts;
            let mut to = limit * if whole { level_share(level) } else { share };
            if to <= from {
                if whole {
                    passages[level] = 0.0;
                }
                continue;
            }
            let hot = pair.temperature.collapse_temperature;
            let collapses = contact.steady_temperature(to) > hot;
            if collapses {
                to = collapse(contact, hot, from, to);
            }
            let tabulated = parts == 1 && from == limit * below && !collapses && scale == even;
            let nodes = if tabulated { WHOLE[level] } else { Nodes::between(1.0 + from / scale, 1.0 + to / scale) };
            let panel = Panel::new(contact, speed, scale, &nodes, at_start);
            at_start = panel.paces[2];
            let squares = chips.map(|_| panel.squares(scale, from, to));
            let (mut stop, mut kind) = (f64::INFINITY, End::Time);
            let mut last = (0.0, time);
            let end = clock.advance(panel.duration, stream, |advanced, time| {
                let (Some(chips), Some(squares)) = (chips, &squares) else { return };
                let aged = |advanced: f64| {
                    let half = panel.first_half;
                    let square = if advanced < half {
                        squares[0].at(advanced / half)
                    } else {
                        squares[1].at((advanced - half) / (panel.duration - half))
                    };
                    chips.aged(square.sqrt() - scale)
                };
                // Within a part wear advances evenly, but for its own effect on itself.
                let (before, now) = (last, (advanced, time));
                let reached = |share: f64| {
                    let between = |start: f64, end: f64| start + share * (end - start);
                    (chips.power(speed * between(before.1, now.1)), aged(between(before.0, now.0)))
                };
                let first = (power, aged(before.0));
                let gathered = |share: f64| chips.over([first, reached(0.5 * share), reached(share)]);
                let whole = gathered(1.0);
                if hazard < edge.resistance && hazard + whole >= edge.resistance {
                    let share = share_at(edge.resistance - hazard, gathered);
                    (stop, kind) = (before.1 + share * (now.1 - before.1), End::Chipping);
                }
                (hazard, power, last) = (hazard + whole, reached(1.0).0, now);
            });
            if end.min(stop) > longest {
                stop = longest;
                kind = if study.ends.time <= study.ends.path / speed { End::Time } else { End::Path };
            }
            if stop.is_finite() {
                return self.done(stop, from + (stop - time) / (end - time) * (to - from), kind, passages);
            }
            if collapses {
                return self.done(end, to, End::Collapse, passages);
            }
            if whole {
                passages[level] = end;
            }
            (from, time) = (to, end);
        }
        self.done(time, limit, study.limit_kind(pair), passages)
    }
}

/// Where a panel is evaluated: stretches of the land, 1 + h/scale, evenly spaced in their logarithm.
#[derive(Clone, Copy)]
struct Nodes {
    /// Half the width of the panel in the logarithm of the stretch.
    half: f64,
    /// At the inner nodes and at the end.
    stretches: [f64; 3],
    /// In the middle.
    middle: f64,
}

/// The panels between levels, which are evenly spaced in the logarithm of the stretch.
static WHOLE: LazyLock<[Nodes; LEVELS]> = LazyLock::new(|| {
    let bound = |level: usize| 1.0 + STRETCH * if level == 0 { 0.0 } else { level_share(level - 1) };
    std::array::from_fn(|level| Nodes::between(bound(level), bound(level + 1)))
});

impl Nodes {
    fn between(start: f64, end: f64) -> Self {
        let (a, b) = (start.ln(), end.ln());
        let (centre, half) = (0.5 * (a + b), 0.5 * (b - a));
        let time_at = |node: f64| (centre + half * node).exp();
        Self { half, stretches: [time_at(-NODE), time_at(NODE), end], middle: time_at(0.0) }
    }
}

/// Time per logarithm of the stretch without noise, s.
fn pace(contact: &Contact<'_>, speed: f64, scale: f64, stretch: f64) -> f64 {
    scale * stretch / contact.steady_wear(scale * (stretch - 1.0)).rate(speed)
}

/// Time without noise from one wear to another: Gauss–Lobatto in the logarithm of the stretch.
struct Panel {
    /// s.
    duration: f64,
    /// Time to the middle, s.
    first_half: f64,
    /// Stretch in the middle.
    middle: f64,
    /// Paces at start, middle and end, s.
    paces: [f64; 3],
}

impl Panel {
    fn new(contact: &Contact<'_>, speed: f64, scale: f64, nodes: &Nodes, start: f64) -> Self {
        let inner = nodes.stretches.map(|stretch| pace(contact, speed, scale, stretch));
        let paces = [start, inner[0], inner[1], inner[2]];
        let sum = |weights: [f64; 4]| weights.iter().zip(paces).map(|(weight, pace)| weight * pace).sum::<f64>();
        Self {
            duration: nodes.half * sum(WEIGHTS),
            first_half: nodes.half * sum(FIRST_HALF),
            middle: nodes.middle,
            paces: [start, sum(AT_MIDDLE), inner[2]],
        }
    }

    /// The square of the land with its offset, which runs in evenly, over the two halves.
    fn squares(&self, scale: f64, start: f64, end: f64) -> [Cubic; 2] {
        let lands = [start + scale, scale * self.middle, end + scale];
        let squares = lands.map(|land| land * land);
        let half = |i: usize, duration: f64| {
            // d (h + scale)²/d ln stretch = 2 (h + scale)²
            let slope = |k: usize| 2.0 * squares[k] * duration / self.paces[k];
            Cubic { ends: [squares[i], squares[i + 1]], slopes: [slope(i), slope(i + 1)] }
        };
        [half(0, self.first_half), half(1, self.duration - self.first_half)]
    }
}
