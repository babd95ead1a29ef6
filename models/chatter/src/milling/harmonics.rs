//! Limits of milling from the response of the structure at single frequencies: measured or of modes.
//!
//! A neutral vibration is `Σ U_r e^(i (w + r w_t) t)` with w_t the tooth-passing frequency. With `H_k` and `D_k` the Fourier
//! coefficients of the directional matrix and of the radial dyad, `V` the cutting speed and G the response,
//!
//! ```text
//!  F_s = −b Σ_r [(1 − e^(−i w tau)) H_(s−r) + i (w + r w_t) (C_i/V) D_(s−r)] G(w + r w_t) F_r
//! ```
//!
//! is linear in the depth b: at a given w every neutral depth is `−1/lambda` of the matrix in brackets times G. Those that are
//! real and positive are neutral; w runs over half of a tooth-passing frequency, at whose end period doubling lies.
//!
//! With a helix the directional matrix is the mean over the lag of the teeth, which follows from the depth. At a lag that is held the
//! neutral depths are eigenvalues as before; a depth is a limit where it is the least neutral one at its own lag. The first
//! such depth is sought in even steps and narrowed down: an island thinner than a step can be missed.
//!
//! # Source
//! Budak and Altintas, Analytical prediction of chatter stability in milling (1998), the multi-frequency solution; solved for
//! the depth as an eigenvalue.

use super::Milling;
use super::engagement::Geometry;
use crate::error::{ChatterError, positive};
use crate::verdict::{ChatterKind, StabilityLimit};
use nalgebra::{Complex, DMatrix};
use std::f64::consts::{PI, TAU};
use toolroom_spectral::Rule;

/// The response of a structure (m/N) in (feed, normal) at a frequency (rad/s) above zero: xx, xy, yx, yy.
pub type Response<'a> = dyn Fn(f64) -> [Complex<f64>; 4] + 'a;

/// Change of the limit from one number of harmonics to the next that ends the search.
const TOLERANCE: f64 = 1e-3;
/// Harmonics beyond the highest frequency that are taken first, and most harmonics of all.
const BEYOND: usize = 2;
const MOST: usize = 40;
/// Halvings by which a crossing is narrowed down.
const HALVINGS: u32 = 40;
/// Depths at which a helical cut is judged on the way to its limit, and the share of a step to which that is narrowed down.
const STEPS: usize = 24;
const NARROW: f64 = 1e-3;
/// Share of a real eigenvalue that rounding leaves imaginary at half of the tooth-passing frequency.
const REAL: f64 = 1e-7;

/// How a response is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampling {
    /// Step in frequency (rad/s) over which the response hardly turns.
    pub step: f64,
    /// Highest frequency (rad/s) at which the structure answers.
    pub highest: f64,
}

impl Milling {
    /// Least unstable depth up to `greatest` (m) at `spindle_speed` (rad/s) with `response` in place of the modes; none where
    /// no neutral vibration lies below it.
    ///
    /// # Errors
    /// A cut that is none; runout or unequal pitch; an eigenvalue that was not found.
    pub fn limit_of_response(
        &self,
        spindle_speed: f64,
        greatest: f64,
        sampling: Sampling,
        response: &Response<'_>,
    ) -> Result<Option<StabilityLimit>, ChatterError> {
        self.check()?;
        self.only_cylinder()?;
        positive("spindle_speed", spindle_speed)?;
        positive("greatest depth", greatest)?;
        positive("step", sampling.step)?;
        let within = |quantity, value: f64| {
            if value == 0.0 { Ok(()) } else { Err(ChatterError::OutOfRange { quantity, value, min: 0.0, max: 0.0 }) }
        };
        within("unequal pitch or runout of a limit from a response", f64::from(u8::from(!self.cutter.is_regular())))?;
        let tooth = self.cutter.teeth as f64 * spindle_speed;
        let mut harmonics = ((sampling.highest / tooth).ceil() as usize + BEYOND).min(MOST);
        // The least neutral depth at the lag of a depth.
        let least = |depth: f64, greatest: f64, harmonics: usize| {
            Harmonics::new(self, spindle_speed, depth, harmonics, response)?.least(greatest, sampling.step)
        };
        let mut bracket = [0.0, greatest];
        if self.cutter.helix_angle != 0.0 {
            let place = |i: usize| greatest * i as f64 / STEPS as f64;
            let mut end = None;
            for i in 1..=STEPS {
                if least(place(i), place(i), harmonics)?.is_some() {
                    end = Some(i);
                    break;
                }
            }
            // A limit between two steps is narrowed down with every number of harmonics; one step more on either side is
            // where it may move.
            let Some(end) = end else { return Ok(None) };
            bracket = [place(end.saturating_sub(2)), place((end + 1).min(STEPS))];
        }
        let mut last: Option<Option<StabilityLimit>> = None;
        loop {
            let found = if self.cutter.helix_angle == 0.0 {
                least(0.0, greatest, harmonics)?
            } else {
                narrowed(bracket, greatest / STEPS as f64 * NARROW, |depth| least(depth, 2.0 * depth, harmonics))?
            };
            let settled = match (&last, &found) {
                (Some(None), None) => true,
                (Some(Some(last)), Some(found)) => (found.depth / last.depth - 1.0).abs() < TOLERANCE,
                (None, _) | (Some(None), Some(_)) | (Some(Some(_)), None) => false,
            };
            if settled || harmonics >= MOST {
                return Ok(found);
            }
            last = Some(found);
            harmonics = (harmonics + harmonics / 2 + 1).min(MOST);
        }
    }
}

/// The first depth in a bracket that is the least neutral one at its own lag, to `width` (m); `least` tells the least neutral
/// depth at the lag of a depth, up to twice that depth.
fn narrowed(
    [low, high]: [f64; 2],
    width: f64,
    least: impl Fn(f64) -> Result<Option<StabilityLimit>, ChatterError>,
) -> Result<Option<StabilityLimit>, ChatterError> {
    // The three steps of the bracket, from below.
    let part = |i: usize| low + (high - low) * i as f64 / 3.0;
    let mut before = low;
    for i in 1..=3 {
        let mut after = part(i);
        let Some(mut found) = least(after)?.filter(|found| found.depth <= after) else {
            before = after;
            continue;
        };
        while after - before > width {
            let middle = 0.5 * (before + after);
            match least(middle)?.filter(|found| found.depth <= middle) {
                Some(nearer) => (after, found) = (middle, nearer),
                None => before = middle,
            }
        }
        return Ok(Some(StabilityLimit { depth: after, ..found }));
    }
    Ok(None)
}

/// The equations at one speed and lag of the teeth.
struct Harmonics<'a> {
    /// Tooth-passing frequency (rad/s).
    tooth: f64,
    /// Frequencies w + r w_t for r from −count − 1 to count.
    count: usize,
    /// Fourier coefficients of the directional matrix and of the damping by the cut, orders −2 count − 1 to 2 count + 1.
    gain: Vec<[Complex<f64>; 4]>,
    damping: Option<Vec<[Complex<f64>; 4]>>,
    response: &'a Response<'a>,
}

/// An eigenvalue −1/b at a frequency.
type Branch = Complex<f64>;

impl<'a> Harmonics<'a> {
    fn new(
        cut: &Milling,
        spindle_speed: f64,
        depth: f64,
        count: usize,
        response: &'a Response<'a>,
    ) -> Result<Self, ChatterError> {
        let geometry = Geometry::new(cut, depth, false)?;
        let orders = 2 * count + 1;
        let scale = cut.force.process_damping / (spindle_speed * cut.cutter.diameter / 2.0);
        let mut gain = vec![[Complex::new(0.0, 0.0); 4]; 2 * orders + 1];
        let mut damping = gain.clone();
        let rule = Rule::of(24);
        for pair in geometry.breaks.windows(2) {
            // The highest order turns an eighth of a circle or so between two nodes.
            let panels = ((pair[1] - pair[0]) / geometry.span * orders as f64 / 2.0).ceil().max(1.0) as usize;
            let length = (pair[1] - pair[0]) / panels as f64;
            for panel in 0..panels {
                for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
                    let angle = pair[0] + length * (panel as f64 + node);
                    let share = weight * length / geometry.span;
                    let turn = Complex::from_polar(1.0, -TAU * (angle - geometry.origin) / geometry.span);
                    let (mut directional, mut dyad) = ([0.0; 4], [0.0; 4]);
                    for tooth in geometry.cutting(angle - 1e-12, angle + 1e-12) {
                        let (h, d) = (geometry.directional(cut, tooth, angle), geometry.radial_dyad(tooth, angle));
                        for i in 0..4 {
                            directional[i] += h[i];
                            dyad[i] += d[i] * scale;
                        }
                    }
                    let mut factor = turn.powi(-(orders as i32)) * share;
                    for (gain, damping) in gain.iter_mut().zip(&mut damping) {
                        for i in 0..4 {
                            gain[i] += factor * directional[i];
                            damping[i] += factor * dyad[i];
                        }
                        factor *= turn;
                    }
                }
            }
        }
        let tooth = cut.cutter.teeth as f64 * spindle_speed;
        Ok(Self { tooth, count, gain, damping: (scale > 0.0).then_some(damping), response })
    }

    /// Eigenvalues −1/b at frequency w, those of depths beyond `greatest` left out.
    fn branches(&self, w: f64, greatest: f64) -> Result<Vec<Branch>, ChatterError> {
        let size = 2 * self.count + 2;
        let frequency = |r: usize| w + (r as f64 - self.count as f64 - 1.0) * self.tooth;
        let delay = 1.0 - Complex::from_polar(1.0, -w * TAU / self.tooth);
        let orders = 2 * self.count + 1;
        let mut matrix = DMatrix::zeros(2 * size, 2 * size);
        for r in 0..size {
            let w = frequency(r);
            let mut g = (self.response)(w.abs());
            if w < 0.0 {
                g = g.map(|g| g.conj());
            }
            for s in 0..size {
                let order = s + orders - r;
                let mut force = self.gain[order].map(|gain| gain * delay);
                if let Some(damping) = &self.damping {
                    for (force, damping) in force.iter_mut().zip(damping[order]) {
                        *force += damping * Complex::new(0.0, w);
                    }
                }
                let [a, b, c, d] = force;
                matrix[(2 * s, 2 * r)] = a * g[0] + b * g[2];
                matrix[(2 * s, 2 * r + 1)] = a * g[1] + b * g[3];
                matrix[(2 * s + 1, 2 * r)] = c * g[0] + d * g[2];
                matrix[(2 * s + 1, 2 * r + 1)] = c * g[1] + d * g[3];
            }
        }
        let schur = nalgebra::linalg::Schur::try_new(matrix, 1e-12, 10_000)
            .ok_or(ChatterError::NotConverged { residual: f64::NAN })?;
        // The triangular factor of a complex matrix has the eigenvalues on its diagonal.
        let values = schur.unpack().1.diagonal();
        // A branch that is a little beyond may come back between two frequencies.
        Ok(values.iter().copied().filter(|value| value.norm() > 0.5 / greatest).collect())
    }

    /// The least neutral depth up to `greatest`.
    fn least(&self, greatest: f64, step: f64) -> Result<Option<StabilityLimit>, ChatterError> {
        let half = 0.5 * self.tooth;
        let steps = (half / step).ceil().max(8.0) as usize;
        let place = |i: usize| half * i as f64 / steps as f64;
        let mut least: Option<StabilityLimit> = None;
        let mut keep = |depth: f64, w: f64, kind: ChatterKind| {
            if depth > 0.0 && depth <= greatest && least.is_none_or(|least| depth < least.depth) {
                let chatter_frequency = self.loudest(w) / TAU;
                least = Some(StabilityLimit { depth, kind, chatter_frequency });
            }
        };
        // At w = 0 nothing regenerates.
        let mut before = self.branches(place(1) * 1e-3, greatest)?;
        let mut from = place(1) * 1e-3;
        for i in 1..=steps {
            let to = place(i);
            let after = self.branches(to, greatest)?;
            if i < steps {
                for value in &after {
                    let Some(earlier) = nearest(&before, *value) else { continue };
                    if earlier.im * value.im < 0.0 && value.re < 0.0 {
                        let (w, value) = self.crossing((from, earlier), (to, *value), greatest)?;
                        keep(-1.0 / value.re, w, ChatterKind::Hopf);
                    }
                }
            } else {
                for value in after.iter().filter(|value| value.im.abs() < REAL * value.norm() && value.re < 0.0) {
                    keep(-1.0 / value.re, to, ChatterKind::Flip);
                }
            }
            (before, from) = (after, to);
        }
        Ok(least)
    }

    /// Where a branch is real between two frequencies.
    fn crossing(
        &self,
        mut low: (f64, Branch),
        mut high: (f64, Branch),
        greatest: f64,
    ) -> Result<(f64, Branch), ChatterError> {
        for _ in 0..HALVINGS {
            if (high.1.im - low.1.im).abs() < 1e-12 * low.1.norm() || (high.0 - low.0) < 1e-10 * high.0 {
                break;
            }
            // The secant where it stays well inside, else the middle.
            let share = (low.1.im / (low.1.im - high.1.im)).clamp(0.1, 0.9);
            let w = low.0 + share * (high.0 - low.0);
            let expected = low.1 + (high.1 - low.1) * share;
            let Some(value) = nearest(&self.branches(w, greatest)?, expected) else { break };
            if (value.im > 0.0) == (low.1.im > 0.0) { low = (w, value) } else { high = (w, value) }
        }
        let share = if low.1.im == high.1.im { 0.5 } else { low.1.im / (low.1.im - high.1.im) };
        Ok((low.0 + share * (high.0 - low.0), low.1 + (high.1 - low.1) * share))
    }

    /// The frequency (rad/s) of the vibration at w at which the structure answers most.
    fn loudest(&self, w: f64) -> f64 {
        let size = |at: f64| (self.response)(at.abs()).iter().map(|g| g.norm_sqr()).sum::<f64>();
        let orders = -(self.count as i64) - 1..=self.count as i64;
        let places = orders.map(|r| (w + r as f64 * self.tooth).abs()).filter(|at| *at > 1e-9 * self.tooth);
        places.max_by(|a, b| size(*a).total_cmp(&size(*b))).unwrap_or(PI)
    }
}

/// The branch that is nearest to a value.
fn nearest(branches: &[Branch], value: Complex<f64>) -> Option<Branch> {
    branches.iter().copied().min_by(|a, b| (a - value).norm().total_cmp(&(b - value).norm()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cutter, Direction, Engagement, MillingForce, Mode};

    fn cut(both: bool, immersion: f64, process_damping: f64) -> Milling {
        let mut modes = vec![Mode::from_mass([1.0, 0.0], 922.0, 0.011, 0.03993)];
        if both {
            modes.push(Mode::from_mass([0.0, 1.0], 922.0, 0.011, 0.03993));
        }
        Milling {
            modes,
            cutter: Cutter::straight(2, 0.02),
            engagement: Engagement::new(immersion, Direction::Down).unwrap(),
            force: MillingForce { process_damping, ..MillingForce::new(6e8, 2e8) },
            feed_per_tooth: 0.0,
            by_speed: None,
            along_path: None,
        }
    }

    /// Hopf and flip, low and full immersion, with process damping: the collocation's limits from responses alone.
    #[test]
    fn the_response_of_modes_has_the_limits_of_the_modes() {
        for (both, immersion, damping, rpm) in [
            (false, 1.0, 0.0, 10_000.0),
            (false, 0.05, 0.0, 16_000.0),
            (true, 0.05, 0.0, 16_000.0),
            (true, 0.5, 0.0, 12_000.0),
            (true, 0.5, 2e4, 12_000.0),
        ] {
            let cut = cut(both, immersion, damping);
            let speed = rpm / 60.0 * TAU;
            let expected = cut.at_speed(speed).unwrap().limit(12e-3).unwrap();
            let response = |w: f64| {
                let g = cut.frequency_response(w / TAU);
                [g[(0, 0)], g[(0, 1)], g[(1, 0)], g[(1, 1)]]
            };
            let sampling = Sampling { step: 5.0 * TAU, highest: 1200.0 * TAU };
            let found = cut.limit_of_response(speed, 12e-3, sampling, &response).unwrap().unwrap();
            assert!((found.depth / expected.depth - 1.0).abs() < 2e-3, "{rpm} {found:?} {expected:?}");
            assert_eq!(found.kind, expected.kind, "{rpm} {immersion}");
            assert!(
                (found.chatter_frequency / expected.chatter_frequency - 1.0).abs() < 1e-2,
                "{found:?} {expected:?}"
            );
        }
    }

    /// Islands of a helical cutter, against the ends of its stable intervals by collocation: 1.78988805 and 6.24774127 mm.
    #[test]
    fn the_response_of_modes_has_the_limits_of_a_helical_cutter() {
        let mut island = cut(false, 0.05, 0.0);
        island.modes =
            vec![Mode { direction: [1.0, 0.0], natural_frequency: 922.0, damping_ratio: 0.011, stiffness: 1.34e6 }];
        island.cutter = Cutter { helix_angle: 45f64.to_radians(), ..Cutter::straight(2, 0.008) };
        let response = |w: f64| {
            let g = island.frequency_response(w / TAU);
            [g[(0, 0)], g[(0, 1)], g[(1, 0)], g[(1, 1)]]
        };
        let sampling = Sampling { step: 5.0 * TAU, highest: 1200.0 * TAU };
        for (rpm, expected, greatest) in [(17_850.0, 1.789_888_05e-3, 4e-3), (16_800.0, 6.247_741_27e-3, 8e-3)] {
            let speed = rpm / 60.0 * TAU;
            let found = island.limit_of_response(speed, greatest, sampling, &response).unwrap().unwrap();
            assert!((found.depth / expected - 1.0).abs() < 2e-3, "{rpm} {found:?}");
            assert_eq!(found.kind, ChatterKind::Flip, "{rpm}");
        }
        let quiet = island.limit_of_response(17_850.0 / 60.0 * TAU, 1.7e-3, sampling, &response).unwrap();
        assert!(quiet.is_none(), "{quiet:?}");
        // A common helix with modes in both directions, at a Hopf limit.
        let mut common = cut(true, 0.5, 2e4);
        common.cutter.helix_angle = 0.5;
        let speed = 12_000.0 / 60.0 * TAU;
        let expected = common.at_speed(speed).unwrap().limit(6e-3).unwrap();
        let response = |w: f64| {
            let g = common.frequency_response(w / TAU);
            [g[(0, 0)], g[(0, 1)], g[(1, 0)], g[(1, 1)]]
        };
        let found = common.limit_of_response(speed, 6e-3, sampling, &response).unwrap().unwrap();
        assert!((found.depth / expected.depth - 1.0).abs() < 4e-3, "{found:?} {expected:?}");
    }

    #[test]
    fn teeth_at_unequal_pitch_are_refused() {
        let mut cut = cut(false, 0.5, 0.0);
        cut.cutter.pitch = vec![3.0, TAU - 3.0];
        let sampling = Sampling { step: 30.0, highest: 6e3 };
        let zero = |_| [Complex::new(0.0, 0.0); 4];
        let refused = cut.limit_of_response(500.0, 1e-3, sampling, &zero);
        assert!(matches!(refused, Err(ChatterError::OutOfRange { .. })), "{refused:?}");
    }
}
