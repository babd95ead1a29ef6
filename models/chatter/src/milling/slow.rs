//! Milling at so low a speed that a mode swings hundreds of times while a tooth cuts.
//!
//! The teeth then turn little while a vibration answers, and what a tooth finds at an angle is what the tooth before left
//! there: each angle repeats its own wave, of any phase. With the gain H of the teeth frozen at an angle a wave that
//! grows by mu from tooth to tooth obeys `det(I + b [(1 − 1/mu) G(i w) H + i w G(i w) C]) = 0`, so that
//! `mu = b lambda/(1 + b lambda)` with an eigenvalue lambda of `(I + i w b G C)^−1 G H`. The depth at which its
//! greatest modulus over all frequencies and angles is one, `b = −1/(2 Re lambda)` without damping by the cut, is the
//! envelope: below it no wave grows anywhere from tooth to tooth, above it waves grow on a part of the arc. The
//! multipliers of the whole period can lie within the unit circle beyond that depth, but the period map is so far from
//! normal there that disturbances grow by many orders before they decay and rounding decides about the multipliers.
//!
//! Freezing the teeth needs vibrations that die out before the teeth have turned: where two modes of 1 % damping turn with
//! the teeth by 0.2 rad in that time, the true limit is half of the envelope. Between that regime and that of the period
//! map the question is refused.

use super::Milling;
use super::engagement::Geometry;
use crate::error::ChatterError;
use crate::krylov::Dominant;
use crate::structure::Mode;
use nalgebra::{Complex, Matrix2};
use std::f64::consts::TAU;

/// Oscillations of the fastest mode in one pass of a tooth up to which the period map answers (assumption: a limit takes
/// about a second there, and rounding begins to decide about its multipliers).
const MOST_WAVES: f64 = 400.0;
/// Angle (rad) by which the teeth may turn while a vibration decays, for the envelope to answer (assumption).
const MOST_TURN: f64 = 0.02;

/// Angles at which a stretch in cut is frozen.
const ANGLES: usize = 16;

/// Oscillations of the fastest mode while the teeth cut without a pause, at `speed` (rad/s).
fn waves(cut: &Milling, speed: f64) -> f64 {
    let fastest = cut.modes.iter().map(|mode| mode.natural_frequency).fold(0.0, f64::max);
    let pass = (cut.engagement.exit - cut.engagement.entry).min(TAU / cut.cutter.teeth as f64);
    fastest * pass / speed
}

/// Whether the envelope answers at `speed` (rad/s) rather than the period map.
///
/// # Errors
/// [`ChatterError::TooSlow`] where neither does.
pub(super) fn is_slow(cut: &Milling, speed: f64) -> Result<bool, ChatterError> {
    let waves = waves(cut, speed);
    let decay = |mode: &Mode| mode.damping_ratio * mode.angular_frequency();
    let turn = speed / cut.modes.iter().map(decay).fold(f64::INFINITY, f64::min);
    match (waves > MOST_WAVES, turn <= MOST_TURN) {
        (false, _) => Ok(false),
        (true, true) => Ok(true),
        (true, false) => Err(ChatterError::TooSlow { waves, turn }),
    }
}

/// A cut whose teeth stand still at an angle.
struct Frozen {
    gain: Matrix2<Complex<f64>>,
    damping: Matrix2<Complex<f64>>,
}

/// The dominant multiplier of a slow cut over the span of its geometry at `depth` (m) and `speed` (rad/s).
pub(super) fn dominant(cut: &Milling, geometry: &Geometry, speed: f64, depth: f64) -> Dominant {
    let frequencies = frequencies(cut);
    let mut best = (0.0, 0.0);
    for pair in geometry.breaks.windows(2) {
        let teeth = geometry.cutting(pair[0], pair[1]);
        if teeth.is_empty() {
            continue;
        }
        for step in 0..ANGLES {
            let angle = pair[0] + (pair[1] - pair[0]) * (step as f64 + 0.5) / ANGLES as f64;
            let frozen = Frozen::new(cut, geometry, &teeth, angle, speed);
            let growth = |w: f64| frozen.growth(cut, w, depth);
            let values: Vec<f64> = frequencies.iter().map(|w| growth(*w)).collect();
            let Some(top) = (0..values.len()).max_by(|i, j| values[*i].total_cmp(&values[*j])) else { continue };
            if values[top] < 0.5 * best.0 {
                continue;
            }
            let range = (frequencies[top.saturating_sub(1)], frequencies[(top + 1).min(values.len() - 1)]);
            let (w, value) = peak(growth, range);
            if value > best.0 {
                best = (value, w);
            }
        }
    }
    let (radius, w) = best;
    let tooth_periods = geometry.span * cut.cutter.teeth as f64 / TAU;
    let multiplier = Complex::from_polar(radius.powf(tooth_periods), w * geometry.span / speed);
    Dominant { value: multiplier, residual: 1.0 / waves(cut, speed) }
}

impl Frozen {
    fn new(cut: &Milling, geometry: &Geometry, teeth: &[(usize, usize, f64)], angle: f64, speed: f64) -> Self {
        let indentation = cut.force.process_damping / (speed * cut.cutter.diameter / 2.0);
        let (mut gain, mut damping) = (Matrix2::zeros(), Matrix2::zeros());
        let complex = |[a, b, c, d]: [f64; 4]| Matrix2::new(a, b, c, d).map(|entry| Complex::new(entry, 0.0));
        for tooth in teeth {
            gain += complex(geometry.directional(cut, *tooth, angle));
            damping += complex(geometry.radial_dyad(*tooth, angle).map(|entry| entry * indentation));
        }
        Self { gain, damping }
    }

    /// Greatest modulus of a multiplier of vibrations of frequency `w` (rad/s) at `depth` (m).
    fn growth(&self, cut: &Milling, w: f64, depth: f64) -> f64 {
        let mut response = Matrix2::zeros();
        for mode in &cut.modes {
            let [x, y] = mode.unit();
            let compliance = mode.compliance(w / TAU);
            response += Matrix2::new(x * x, x * y, x * y, y * y).map(|entry| compliance * entry);
        }
        let one = Complex::new(1.0, 0.0);
        let damped = Matrix2::identity() + response * self.damping * Complex::new(0.0, w * depth);
        let Some(inverse) = damped.try_inverse() else { return 0.0 };
        let loop_gain = inverse * response * self.gain * Complex::new(depth, 0.0);
        let (half, determinant) = (loop_gain.trace() * 0.5, loop_gain.determinant());
        let root = (half * half - determinant).sqrt();
        [half + root, half - root].map(|gain| (gain / (one + gain)).norm()).into_iter().fold(0.0, f64::max)
    }
}

/// Frequencies (rad/s) that resolve every resonance and what the cut makes of it, ascending.
fn frequencies(cut: &Milling) -> Vec<f64> {
    let fastest = cut.modes.iter().map(|mode| mode.angular_frequency()).fold(0.0, f64::max);
    let mut grid: Vec<f64> = (1..=60).map(|i| 3.0 * fastest * f64::from(i) / 60.0).collect();
    for mode in &cut.modes {
        for i in -20..=80 {
            let x = f64::from(i) / 20.0;
            grid.push(mode.angular_frequency() * (1.0 + 4.0 * mode.damping_ratio * x * x.abs()));
        }
    }
    grid.retain(|w| *w > 0.0);
    grid.sort_by(f64::total_cmp);
    grid.dedup();
    grid
}

/// The greatest value of `f` in a range that holds one peak, by golden section.
fn peak(f: impl Fn(f64) -> f64, (mut a, mut b): (f64, f64)) -> (f64, f64) {
    let ratio = 0.5 * (5f64.sqrt() - 1.0);
    let (mut c, mut d) = (b - ratio * (b - a), a + ratio * (b - a));
    let (mut fc, mut fd) = (f(c), f(d));
    while b - a > 1e-9 * b {
        if fc > fd {
            (b, d, fd) = (d, c, fc);
            c = b - ratio * (b - a);
            fc = f(c);
        } else {
            (a, c, fc) = (c, d, fd);
            d = a + ratio * (b - a);
            fd = f(d);
        }
    }
    if fc > fd { (c, fc) } else { (d, fd) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Certificate, Cutter, Direction, Engagement, MillingForce};

    fn cut(immersion: f64, modes: usize, damping_ratio: f64) -> Milling {
        let mode = |axis| Mode::from_mass(axis, 922.0, damping_ratio, 0.03993);
        Milling {
            modes: [[1.0, 0.0], [0.0, 1.0]].into_iter().take(modes).map(mode).collect(),
            cutter: Cutter::straight(2, 0.02),
            engagement: Engagement::new(immersion, Direction::Down).unwrap(),
            force: MillingForce::new(6e8, 2e8),
            feed_per_tooth: 0.1e-3,
        }
    }

    /// The speed at which a pass of a tooth holds so many waves.
    fn speed(cut: &Milling, count: f64) -> f64 {
        waves(cut, 1.0) / count
    }

    fn envelope(cut: &Milling, speed: f64) -> f64 {
        let geometry = Geometry::new(cut, 0.0, false).unwrap();
        let (mut below, mut above) = (1e-6, 1e-1);
        while above - below > 1e-9 * above {
            let middle = 0.5 * (below + above);
            let radius = dominant(cut, &geometry, speed, middle).value.norm();
            if radius < 1.0 { below = middle } else { above = middle }
        }
        below
    }

    #[test]
    fn the_envelope_lies_under_the_limits_where_vibrations_die_out_at_once() {
        for (immersion, modes, damping_ratio) in [(1.0, 1, 0.05), (0.5, 2, 0.05)] {
            let cut = cut(immersion, modes, damping_ratio);
            for count in [20.4, 50.0] {
                let speed = speed(&cut, count);
                let envelope = envelope(&cut, speed);
                let limit = match cut.at_speed(speed).unwrap().limit(8.0 * envelope) {
                    Ok(limit) => limit.depth,
                    // Where the map is far from normal a limit is refused instead of told inexactly.
                    Err(ChatterError::NotConverged { .. }) if count > 40.0 => continue,
                    Err(error) => panic!("{error}"),
                };
                assert!(limit > 0.97 * envelope, "{immersion} {modes} {damping_ratio} {count} {limit} {envelope}");
            }
        }
    }

    #[test]
    fn the_slowest_spindles_are_answered_at_once() {
        for rpm in [1.0, 5.0] {
            let cut = cut(1.0, 2, 0.05);
            let mut at_speed = cut.at_speed(rpm / 60.0 * TAU).unwrap();
            let found = at_speed.stable_intervals(1e-3).unwrap();
            assert_eq!(found.certificate, Certificate::Envelope);
            let limit = found.limit().unwrap();
            assert!((limit.depth / envelope(&cut, rpm / 60.0 * TAU) - 1.0).abs() < 1e-6, "{}", limit.depth);
            let verdict = at_speed.verdict(0.5 * limit.depth).unwrap();
            assert!(verdict.stable && verdict.spectral_radius < 1.0 && limit.kind == crate::ChatterKind::Hopf);
        }
    }
    #[test]
    fn a_spindle_between_both_methods_is_refused() {
        let cut = cut(1.0, 2, 0.011);
        let speed = speed(&cut, 600.0);
        let refused = cut.at_speed(speed).unwrap().limit(1e-3);
        assert!(matches!(refused, Err(ChatterError::TooSlow { .. })), "{refused:?}");
    }
}
