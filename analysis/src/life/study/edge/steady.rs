//! A life in which nothing but wear changes: quadrature over wear.

use super::chips::{Chips, share_at};
use super::cubic::Cubic;
use super::noise::Clock;
use super::{Edge, LEVELS, Outcome, collapse, level_share};
use crate::life::study::{End, Study};
use toolroom_sim::Stream;
use toolroom_wear::{Contact, Cut, Pair};

/// Nodes and weights of the 4-point Gauss–Legendre rule. Of the cubic through the values at the
/// nodes: the weights of its integral over the first half, and of its values at start and middle.
const NODES: [f64; 4] =
    [-0.861_136_311_594_052_6, -0.339_981_043_584_856_26, 0.339_981_043_584_856_26, 0.861_136_311_594_052_6];
const WEIGHTS: [f64; 4] =
    [0.347_854_845_137_453_85, 0.652_145_154_862_546_1, 0.652_145_154_862_546_1, 0.347_854_845_137_453_85];
const FIRST_HALF: [f64; 4] =
    [0.352_211_875_877_324_1, 0.609_831_878_967_724_4, 0.042_313_275_894_822_03, -0.004_357_030_739_870_302];
const AT_START: [f64; 4] =
    [1.526_788_125_457_266_4, -0.813_632_449_486_927, 0.400_761_520_311_650_35, -0.113_917_196_281_989_93];
const AT_MIDDLE: [f64; 4] =
    [-0.092_326_598_440_728_81, 0.592_326_598_440_728_8, 0.592_326_598_440_728_8, -0.092_326_598_440_728_81];

/// A life at one speed where nothing changes from pass to pass.
///
/// The wear noise multiplies the rate of wear, so that it only stretches time: the life without
/// noise is the integral of the noise factor over the life with it.
pub(super) fn life(study: &Study, pair: &Pair, edge: &Edge, speed: f64, stream: &mut Stream, parts: u32) -> Outcome {
    let cut = Cut { hardness: edge.cut.hardness * edge.batch_hardness, ..edge.cut }.at_speed(speed);
    let contact = pair.contact(&cut);
    let (limit, scale) = (study.wear_at_end(pair), study.run_in(pair));
    let chips = Chips { chipping: pair.chipping, added: cut.chipping_rate };
    let longest = study.ends.time.min(study.ends.path / speed);
    let mut passages = [f64::INFINITY; LEVELS];
    let (mut hazard, mut power, mut clock) = (0.0, 0.0, Clock::new(&study.scatter, stream));
    let (mut from, mut time) = (edge.initial_wear.min(0.999 * limit), 0.0);
    let done = |time: f64, wear: f64, end: End, passages: [f64; LEVELS]| Outcome {
        life: time,
        path: speed * time,
        flank_wear: wear,
        end,
        weight: edge.weight,
        passages,
    };
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
            to = collapse(&contact, hot, from, to);
        }
        let panel = Panel::new(&contact, speed, scale, from, to);
        let squares = panel.squares(scale, from, to);
        let aged = |advanced: f64| {
            let half = panel.first_half;
            let square = if advanced < half {
                squares[0].at(advanced / half)
            } else {
                squares[1].at((advanced - half) / (panel.duration - half))
            };
            chips.aged(square.sqrt() - scale)
        };
        let (mut stop, mut kind) = (f64::INFINITY, End::Time);
        let mut last = (0.0, time);
        let end = clock.advance(panel.duration, stream, |advanced, time| {
            if !chips.happen() {
                return;
            }
            // Within a part wear advances evenly, but for its own effect on itself.
            let (before, now) = (last, (advanced, time));
            let at = |share: f64| {
                let between = |start: f64, end: f64| start + share * (end - start);
                (chips.power(speed * between(before.1, now.1)), aged(between(before.0, now.0)))
            };
            let first = (power, aged(before.0));
            let gathered = |share: f64| chips.over([first, at(0.5 * share), at(share)]);
            let whole = gathered(1.0);
            if hazard < edge.resistance && hazard + whole >= edge.resistance {
                let share = share_at(edge.resistance - hazard, gathered);
                (stop, kind) = (before.1 + share * (now.1 - before.1), End::Chipping);
            }
            (hazard, power, last) = (hazard + whole, at(1.0).0, now);
        });
        if end.min(stop) > longest {
            stop = longest;
            kind = if study.ends.time <= study.ends.path / speed { End::Time } else { End::Path };
        }
        if stop.is_finite() {
            return done(stop, from + (stop - time) / (end - time) * (to - from), kind, passages);
        }
        if collapses {
            return done(end, to, End::Collapse, passages);
        }
        if whole {
            passages[level] = end;
        }
        (from, time) = (to, end);
    }
    done(time, limit, study.limit_kind(pair), passages)
}

/// Time without noise from one wear to another: Gauss–Legendre in x = ln(1 + h/scale).
struct Panel {
    /// s.
    duration: f64,
    /// Time to the middle, s.
    first_half: f64,
    /// x in the middle.
    middle: f64,
    /// Time per x at start, middle and end, s.
    paces: [f64; 3],
}

impl Panel {
    fn new(contact: &Contact<'_>, speed: f64, scale: f64, from: f64, to: f64) -> Self {
        let (a, b) = ((from / scale).ln_1p(), (to / scale).ln_1p());
        let (centre, half) = (0.5 * (a + b), 0.5 * (b - a));
        let mut panel = Self { duration: 0.0, first_half: 0.0, middle: centre, paces: [0.0; 3] };
        for (i, node) in NODES.iter().enumerate() {
            let stretch = (centre + half * node).exp();
            let pace = scale * stretch / contact.steady_wear(scale * (stretch - 1.0)).rate(speed);
            panel.duration += half * WEIGHTS[i] * pace;
            panel.first_half += half * FIRST_HALF[i] * pace;
            for (sum, weight) in panel.paces.iter_mut().zip([AT_START[i], AT_MIDDLE[i], AT_START[3 - i]]) {
                *sum += weight * pace;
            }
        }
        panel
    }

    /// The square of the land with its offset, which runs in evenly, over the two halves of x.
    fn squares(&self, scale: f64, from: f64, to: f64) -> [Cubic; 2] {
        let lands = [from + scale, scale * self.middle.exp(), to + scale];
        let squares = lands.map(|land| land * land);
        let half = |i: usize, duration: f64| {
            // d (h + scale)²/dx = 2 (h + scale)²
            let slope = |k: usize| 2.0 * squares[k] * duration / self.paces[k];
            Cubic { ends: [squares[i], squares[i + 1]], slopes: [slope(i), slope(i + 1)] }
        };
        [half(0, self.first_half), half(1, self.duration - self.first_half)]
    }
}
