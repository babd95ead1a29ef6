//! Milling at so low a speed that a vibration dies out within a tooth period.
//!
//! Each angle then repeats its own wave, of any phase, from tooth to tooth, and the teeth turn little while a vibration
//! answers. Seen from the teeth the gain H of the cut is constant while the same teeth are engaged. With y the displacement
//! in radial and tangential direction at the tooth, a wave of frequency w that grows by mu from tooth to tooth obeys
//! `y = −b G [(1 − 1/mu) H + C (i w + Omega J)] y`, so that `mu = b lambda/(1 + b lambda)` with an eigenvalue lambda of
//! `(I + b G C (i w + Omega J))^−1 G H`. G is the response of the structure between an angle half of the memory behind and
//! one half of it ahead: a mode of compliance g at the angle psi from the tooth has
//!
//! ```text
//! G = 1/2 [ c  s; −s  c ] + 1/2 g(w) [ cos 2psi  sin 2psi; sin 2psi  −cos 2psi ]
//! c = (g(w − Omega) + g(w + Omega))/2      s = (g(w − Omega) − g(w + Omega))/(2 i)
//! ```
//!
//! The depth at which the greatest |mu| over all frequencies and angles is one is the envelope: below it no wave grows
//! anywhere from tooth to tooth, above it waves grow on a part of the arc.
//!
//! *When it bounds the limit.* The structure that is the same in all directions, cut by the same teeth all the time, makes
//! G and H constant; the cut is then a system without periodic coefficients, and the envelope is the least limit over all
//! phases, exactly. In general G changes with twice the angle, and the envelope is the first order of an expansion in the
//! angle by which the teeth turn while a vibration decays. It was compared with the limits of the period map for one mode,
//! two equal and two different modes, immersions of 0.1, 0.5 and 1, damping ratios of 0.01 to 0.3: no limit of 68 lies under
//! it, with a decay by `exp(−3.8)` or more in a pass; a test repeats a part of them. With teeth that stand still instead
//! (`s = 0`) the envelope is 34 % too high in a slot with two modes of 30 % damping, because the tangential force enters
//! through the turn.
//!
//! *Why the period map does not answer.* Where a free vibration decays below the rounding of numbers in one tooth period,
//! the map is nilpotent but for rounding, which then decides about its multipliers. Its exact multipliers can stay within the
//! unit circle up to several times the envelope, while a disturbance grows by many orders before it decays.

use super::Milling;
use super::engagement::Geometry;
use crate::error::ChatterError;
use crate::structure::Mode;
use nalgebra::{Complex, Matrix2};
use std::f64::consts::TAU;
use toolroom_spectral::{Dominant, STEPS};

/// Decay of a free vibration in a tooth period, as a logarithm, from which on the envelope answers: `−ln` of the rounding
/// of numbers, 36.04. In the cuts above the multiplier of the period map was never lost below 37, and mostly above.
const ROUNDING: f64 = 36.0;
/// Oscillations of the fastest mode while teeth cut, over one repetition of the cut, up to which the period map answers
/// (assumption: all stable intervals of a cut of two directions take about two seconds of one processor there).
const MOST_WAVES: f64 = 400.0;
/// Such oscillations up to which depths are sampled in the usual steps; with more, the steps are fewer in proportion, so that
/// the search takes no longer (assumption).
const SAMPLED_WAVES: f64 = 40.0;
/// Fewest steps in which depths are sampled (assumption: the lobes of a slow cut have merged, and its limit is one).
const FEWEST_STEPS: f64 = 12.0;
/// Least decay of a free vibration in a pass of a tooth, as a logarithm, with which the envelope was found to lie under the
/// limit.
const LEAST_DECAY: f64 = 4.0;

/// Angles of a stretch in cut at which waves are looked at (assumption: limits move by less than 1e-3 with twice as many).
const ANGLES: usize = 16;

/// Angle over which the teeth cut without a pause (rad), at most a pitch.
fn pass(cut: &Milling) -> f64 {
    (cut.engagement.exit - cut.engagement.entry).min(TAU / cut.cutter.teeth as f64)
}

/// Greatest angle over which teeth cut in one repetition of the cut (rad): a pass, with a helix or a corner radius, which
/// lengthen it with the depth, the whole pitch, and of unequal teeth all passes of a revolution.
fn cutting_angle(cut: &Milling) -> f64 {
    let pitch = TAU / cut.cutter.teeth as f64;
    let of_tooth = if cut.cutter.is_straight() { pass(cut) } else { pitch };
    if cut.cutter.is_regular() { of_tooth } else { cut.cutter.teeth as f64 * of_tooth }
}

/// Oscillations of the fastest mode that the period map has to resolve at `speed` (rad/s).
fn waves(cut: &Milling, speed: f64) -> f64 {
    cut.modes.iter().map(|mode| mode.natural_frequency).fold(0.0, f64::max) * cutting_angle(cut) / speed
}

/// Logarithm by which the vibration that lasts longest decays while the teeth turn by `angle` (rad) at `speed` (rad/s).
fn decay(cut: &Milling, speed: f64, angle: f64) -> f64 {
    let rate = |mode: &Mode| mode.damping_ratio * mode.angular_frequency();
    cut.modes.iter().map(rate).fold(f64::INFINITY, f64::min) * angle / speed
}

/// Whether the envelope answers at `speed` (rad/s) rather than the period map.
///
/// # Errors
/// [`ChatterError::TooSlow`] where neither does.
pub(super) fn is_slow(cut: &Milling, speed: f64) -> Result<bool, ChatterError> {
    let (waves, in_pass) = (waves(cut, speed), decay(cut, speed, pass(cut)));
    if waves > MOST_WAVES && in_pass < LEAST_DECAY {
        let least_rpm = speed * waves / MOST_WAVES * 60.0 / TAU;
        let greatest_rpm = speed * in_pass / LEAST_DECAY * 60.0 / TAU;
        return Err(ChatterError::TooSlow { waves, least_rpm, greatest_rpm });
    }
    Ok(waves > MOST_WAVES || decay(cut, speed, TAU / cut.cutter.teeth as f64) >= ROUNDING)
}

/// Even steps in which depths are sampled for stable intervals at `speed` (rad/s): all where the envelope answers, which costs
/// little, and where the period map is small.
pub(super) fn steps(cut: &Milling, speed: f64) -> Result<usize, ChatterError> {
    let most = STEPS as f64;
    let fewer = most * SAMPLED_WAVES / waves(cut, speed);
    Ok(if is_slow(cut, speed)? { STEPS } else { fewer.clamp(FEWEST_STEPS, most) as usize })
}

/// A cut whose teeth are at an angle, in the radial and tangential direction of tooth 0.
struct Local {
    gain: Matrix2<Complex<f64>>,
    /// Force over the rate of displacement per depth.
    damping: Matrix2<Complex<f64>>,
    /// Angle of tooth 0 (rad).
    angle: f64,
    /// Speed (rad/s).
    speed: f64,
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
            let local = Local::new(cut, geometry, &teeth, angle, speed);
            let growth = |w: f64| local.growth(cut, w, depth);
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

impl Local {
    fn new(cut: &Milling, geometry: &Geometry, teeth: &[(usize, usize, f64)], angle: f64, speed: f64) -> Self {
        let indentation = cut.force.process_damping / (speed * cut.cutter.diameter / 2.0);
        let (mut gain, mut damping) = (Matrix2::zeros(), Matrix2::zeros());
        let complex = |[a, b, c, d]: [f64; 4]| Matrix2::new(a, b, c, d).map(|entry| Complex::new(entry, 0.0));
        for tooth in teeth {
            gain += complex(geometry.directional(cut, *tooth, angle));
            damping += complex(geometry.radial_dyad(*tooth, angle).map(|entry| entry * indentation));
        }
        let (sine, cosine) = angle.sin_cos();
        let frame = complex([sine, cosine, cosine, -sine]);
        Self { gain: frame * gain * frame, damping: frame * damping * frame, angle, speed }
    }

    /// Response of the structure at frequency `w` (rad/s), seen from the teeth.
    fn response(&self, cut: &Milling, w: f64) -> Matrix2<Complex<f64>> {
        let mut response = Matrix2::zeros();
        for mode in &cut.modes {
            let [x, y] = mode.unit();
            let (sine, cosine) = (2.0 * (x.atan2(y) - self.angle)).sin_cos();
            let at = |w: f64| mode.compliance(w / TAU) * 0.5;
            let (below, above) = (at(w - self.speed), at(w + self.speed));
            let turned = [(below + above) * 0.5, (below - above) * Complex::new(0.0, -0.5)];
            let fixed = at(w);
            response += Matrix2::new(
                turned[0] + fixed * cosine,
                fixed * sine + turned[1],
                fixed * sine - turned[1],
                turned[0] - fixed * cosine,
            );
        }
        response
    }

    /// Greatest modulus of a multiplier of vibrations of frequency `w` (rad/s) at `depth` (m).
    fn growth(&self, cut: &Milling, w: f64, depth: f64) -> f64 {
        let response = self.response(cut, w);
        let one = Complex::new(1.0, 0.0);
        let (rate, turning) = (Complex::new(0.0, w), Complex::new(self.speed, 0.0));
        let derivative = Matrix2::new(rate, -turning, turning, rate);
        let damped = Matrix2::identity() + response * self.damping * derivative * Complex::new(depth, 0.0);
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
            by_speed: None,
            along_path: None,
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
    fn no_limit_of_the_period_map_lies_under_the_envelope() {
        for (immersion, modes, damping_ratio, count) in [
            (1.0, 1, 0.1, 20.4),
            (1.0, 1, 0.1, 35.0),
            (0.5, 1, 0.03, 60.0),
            (0.5, 2, 0.03, 60.0),
            (0.5, 2, 0.1, 20.4),
            (1.0, 2, 0.03, 60.0),
            (1.0, 2, 0.1, 35.0),
            (0.1, 1, 0.01, 60.0),
        ] {
            let cut = cut(immersion, modes, damping_ratio);
            let speed = speed(&cut, count);
            let (envelope, mut at_speed) = (envelope(&cut, speed), cut.at_speed(speed).unwrap());
            assert_eq!(is_slow(&cut, speed), Ok(false));
            let limit = at_speed.limit(8.0 * envelope).unwrap().depth;
            assert!(limit > 0.9999 * envelope, "{immersion} {modes} {damping_ratio} {count} {limit} {envelope}");
        }
    }

    #[test]
    fn equal_modes_in_a_slot_reach_the_envelope() {
        // Two modes of 30 % damping: with teeth that stand still the envelope would be 5.23 mm, above the limit of 3.90 mm.
        for (damping_ratio, count) in [(0.3, 20.4), (0.1, 50.0)] {
            let cut = cut(1.0, 2, damping_ratio);
            let speed = speed(&cut, count);
            let envelope = envelope(&cut, speed);
            let at_speed = cut.at_speed(speed).unwrap();
            let radius = |depth: f64| at_speed.multipliers(depth, 0).unwrap()[0].norm();
            assert!(radius(0.99 * envelope) < 1.0 && radius(1.02 * envelope) > 1.0, "{envelope}");
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
    fn slow_cuts_are_sampled_in_fewer_steps_with_the_same_limit_and_say_so() {
        let slot = cut(1.0, 2, 0.01);
        let greatest = 0.4e-3;
        for (count, due) in [(20.0, STEPS), (80.0, 24), (300.0, 12)] {
            let speed = speed(&slot, count);
            assert_eq!(steps(&slot, speed), Ok(due));
            let mut at_speed = slot.at_speed(speed).unwrap();
            let found = at_speed.stable_intervals(greatest).unwrap();
            let Certificate::Resolution(step) = found.certificate else { panic!("{:?}", found.certificate) };
            assert!((step * due as f64 / greatest - 1.0).abs() < 1e-12, "{step}");
            let depth = found.limit().unwrap().depth;
            if count < 50.0 {
                // Against all multipliers at once; those of the longer passes are too many for a test.
                let radius = |depth: f64| at_speed.multipliers(depth, 0).unwrap()[0].norm();
                assert!(radius(depth * (1.0 - 1e-6)) < 1.0 && radius(depth * (1.0 + 1e-6)) > 1.0, "{depth}");
            }
            let finer = slot.at_speed(speed).unwrap().stable_intervals(1.2 * depth).unwrap();
            assert!((finer.limit().unwrap().depth / depth - 1.0).abs() < 1e-7, "{count} {depth}");
        }
    }

    #[test]
    fn depths_at_which_a_vibration_outgrows_all_numbers_are_unstable_and_cost_no_limit() {
        let mode = |direction, natural_frequency, stiffness| Mode {
            direction,
            natural_frequency,
            damping_ratio: 0.01,
            stiffness,
        };
        let slot = Milling {
            modes: vec![mode([1.0, 0.0], 1150.0, 11e6), mode([0.0, 1.0], 1240.0, 9.6e6)],
            cutter: Cutter::straight(4, 0.012),
            force: MillingForce::new(2389e6, 965e6),
            ..cut(1.0, 2, 0.01)
        };
        let speed = TAU;
        let known = slot.at_speed(speed).unwrap().limit(0.4e-3).unwrap().depth;
        let found = slot.at_speed(speed).unwrap().stable_intervals(6e-3).unwrap();
        assert!(slot.at_speed(speed).unwrap().verdict(6e-3).is_err());
        assert_eq!(found.ends.len(), 1);
        assert!((found.limit().unwrap().depth / known - 1.0).abs() < 1e-6, "{known}");
    }

    #[test]
    fn a_helix_and_unequal_teeth_lengthen_what_a_map_has_to_hold() {
        let straight = cut(0.05, 1, 0.01);
        let mut helical = straight.clone();
        helical.cutter.helix_angle = 0.5;
        let mut unequal = straight.clone();
        unequal.cutter.pitch = vec![3.0, TAU - 3.0];
        let pass = pass(&straight);
        assert!((waves(&helical, 1.0) / waves(&straight, 1.0) - 0.5 * TAU / pass).abs() < 1e-9);
        assert!((waves(&unequal, 1.0) / waves(&straight, 1.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_spindle_out_of_reach_of_both_methods_is_refused_with_the_speeds_that_are_not() {
        let cut = cut(1.0, 2, 0.001);
        let refused = cut.at_speed(speed(&cut, 500.0)).unwrap().limit(1e-3);
        let Err(ChatterError::TooSlow { least_rpm, greatest_rpm, .. }) = refused else { panic!("{refused:?}") };
        assert!((least_rpm - 922.0 * 30.0 / 400.0).abs() < 1e-6, "{least_rpm}");
        assert!(is_slow(&cut, least_rpm * 1.0001 * TAU / 60.0) == Ok(false));
        assert!(is_slow(&cut, greatest_rpm * 0.9999 * TAU / 60.0) == Ok(true));
    }
}
