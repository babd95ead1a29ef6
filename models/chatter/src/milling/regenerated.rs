//! Forced vibration where teeth differ: each finds the surface of one that moved otherwise.
//!
//! Where all teeth are alike a stable cut moves the same in every tooth period, so that a tooth finds its own motion in the surface
//! and regeneration drops out. With runout or unequal pitch the motion repeats after a revolution only, and the chip changes by
//! `u(t) − u(t − tau)`: the harmonics of the force depend on those of the motion. They are solved for together.

use super::Milling;
use super::engagement::Geometry;
use crate::error::ChatterError;
use nalgebra::{Complex, DMatrix, DVector, Matrix2, Vector2};

/// Harmonics of the tooth-passing frequency that are summed; of the spindle's where teeth differ.
pub(super) const HARMONICS: usize = 200;

/// Harmonics of the revolution up to this share of the fastest mode's frequency answer each other (assumption: beyond it a mode
/// moves by an eighth of its static compliance).
const SHARE: f64 = 3.0;

/// Number of harmonics beyond which only those up to a third above the fastest mode are taken: the system has four times as many
/// unknowns.
const MANY: f64 = 64.0;

/// What the force changes by for each motion: Fourier coefficients over a revolution of the directional matrix of the teeth that
/// find a surface of a given age.
pub(super) struct Regeneration {
    /// Delay (rad) and coefficients 0, 1, … (N/m); those of negative numbers are the conjugates.
    gains: Vec<(f64, Vec<Matrix2<Complex<f64>>>)>,
    /// Harmonics that answer each other at most.
    most: usize,
}

/// Motion and force of a stable cut, harmonics 0, 1, … of a revolution.
pub(super) struct Settled {
    /// Displacement (m).
    pub motion: Vec<Vector2<Complex<f64>>>,
    /// Force (N).
    pub force: Vec<Vector2<Complex<f64>>>,
}

impl Regeneration {
    /// Of a cut at `depth` (m); none where teeth are alike.
    pub fn of(cut: &Milling, geometry: &Geometry, depth: f64) -> Option<Self> {
        if cut.cutter.is_regular() {
            return None;
        }
        let mut gains: Vec<(f64, Vec<Matrix2<Complex<f64>>>)> = Vec::new();
        let count = 2 * HARMONICS + 1;
        geometry.over_panels(count, |angle, share| {
            let turn = Complex::from_polar(1.0, -(angle - geometry.origin));
            for tooth in geometry.cutting(angle - 1e-12, angle + 1e-12) {
                let delay = geometry.teeth[tooth.0].1[tooth.1].delay;
                let h = geometry.directional(cut, tooth, angle).map(|entry| depth * entry * share);
                let matrix = Matrix2::new(h[0], h[1], h[2], h[3]);
                let index = gains.iter().position(|(each, _)| (each - delay).abs() < 1e-9).unwrap_or_else(|| {
                    gains.push((delay, vec![Matrix2::zeros(); count]));
                    gains.len() - 1
                });
                let mut factor = Complex::new(1.0, 0.0);
                for gain in &mut gains[index].1 {
                    *gain += matrix.map(|entry| factor * entry);
                    factor *= turn;
                }
            }
        });
        Some(Self { gains, most: HARMONICS })
    }

    /// Change of force `number` for the motion of harmonic `of`.
    fn entry(&self, number: i64, of: i64) -> Matrix2<Complex<f64>> {
        let k = number - of;
        self.gains.iter().fold(Matrix2::zeros(), |sum, (delay, coefficients)| {
            let gain = coefficients.get(k.unsigned_abs() as usize).copied().unwrap_or_default();
            let gain = if k < 0 { gain.map(|entry| entry.conj()) } else { gain };
            let change = Complex::new(1.0, 0.0) - Complex::from_polar(1.0, -(of as f64) * delay);
            sum + gain.map(|entry| change * entry)
        })
    }

    /// Motion and force under the harmonics of the static force `forces` (N) with the structure's `responses` (m/N) to them, at
    /// `spindle_speed` (rad/s).
    ///
    /// # Errors
    /// [`ChatterError::NotConverged`] where the harmonics have no solution, at a limit of stability.
    pub fn settle(
        &self,
        cut: &Milling,
        spindle_speed: f64,
        forces: &[Vector2<Complex<f64>>],
        responses: &[Matrix2<Complex<f64>>],
    ) -> Result<Settled, ChatterError> {
        let fastest = cut.modes.iter().map(|mode| mode.angular_frequency()).fold(0.0, f64::max) / spindle_speed;
        let wanted = (SHARE * fastest).ceil().min(MANY.max((4.0 / 3.0 * fastest).ceil()));
        let taken = (wanted.max(4.0 * cut.cutter.teeth as f64) as usize).min(self.most);
        let size = 2 * taken + 1;
        let number = |i: usize| i as i64 - taken as i64;
        let signed = |series: &[Vector2<Complex<f64>>], r: i64| {
            let c = series[r.unsigned_abs() as usize];
            if r < 0 { c.map(|entry| entry.conj()) } else { c }
        };
        let response = |r: i64| {
            let g = responses[r.unsigned_abs() as usize];
            if r < 0 { g.map(|entry| entry.conj()) } else { g }
        };
        let mut matrix = DMatrix::<Complex<f64>>::identity(2 * size, 2 * size);
        let mut right = DVector::<Complex<f64>>::zeros(2 * size);
        for i in 0..size {
            let g = response(number(i));
            let static_part = g * signed(forces, number(i));
            (right[2 * i], right[2 * i + 1]) = (static_part[0], static_part[1]);
            for j in 0..size {
                let block = g * self.entry(number(i), number(j));
                for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    matrix[(2 * i + a, 2 * j + b)] += block[(a, b)];
                }
            }
        }
        let solved = matrix.lu().solve(&right).filter(|u| u.iter().all(|entry| entry.re.is_finite()));
        let solved = solved.ok_or(ChatterError::NotConverged { residual: f64::INFINITY })?;
        let found = |i: usize| Vector2::new(solved[2 * i], solved[2 * i + 1]);
        // What lies beyond is driven by what was found and drives nothing.
        let force: Vec<Vector2<Complex<f64>>> = (0..forces.len())
            .map(|r| {
                let change = |i: usize| self.entry(r as i64, number(i)) * found(i);
                (0..size).fold(forces[r], |sum, i| sum - change(i))
            })
            .collect();
        let motion = force.iter().zip(responses).map(|(force, response)| response * force).collect();
        Ok(Settled { motion, force })
    }
}

impl Geometry {
    /// Hands nodes (rad) and weights, the share of the repetition, of a quadrature that resolves `harmonics` of it to `add`.
    pub(super) fn over_panels(&self, harmonics: usize, mut add: impl FnMut(f64, f64)) {
        let rule = toolroom_spectral::Rule::of(48);
        for pair in self.breaks.windows(2) {
            // The highest harmonic turns far within a stretch: panels keep the quadrature exact.
            let panels = ((pair[1] - pair[0]) / self.span * harmonics as f64 / 8.0).ceil().max(1.0) as usize;
            let length = (pair[1] - pair[0]) / panels as f64;
            for panel in 0..panels {
                let from = pair[0] + length * panel as f64;
                for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
                    add(from + node * length, weight * length / self.span);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cutter, Direction, Engagement, MillingForce, Mode};
    use std::f64::consts::TAU;

    /// Two teeth with a runout as great as most of the feed, below the limit of stability.
    fn runout() -> Milling {
        let mode = |direction, frequency, damping, stiffness: f64| {
            let w = TAU * frequency;
            Mode::from_mass(direction, frequency, damping, stiffness / (w * w))
        };
        let mut cutter = Cutter::straight(2, 0.012);
        cutter.runout = 20e-6;
        cutter.runout_angle = 146.697_710_616_f64.to_radians();
        let mut force = MillingForce::new(1.636_985_894e9, 183.568_984e6);
        force.edge_tangential = 7.484_876_669e3;
        force.edge_radial = 1.817_054_27e3;
        Milling {
            modes: vec![mode([1.0, 0.0], 1_331.754_917_6, 0.03, 2e7), mode([0.0, 1.0], 1_455.050_745_4, 0.035, 2.2e7)],
            cutter,
            engagement: Engagement::new(0.3, Direction::Up).expect("sound"),
            force,
            feed_per_tooth: 79.487_556_696e-6,
            by_speed: None,
            along_path: None,
        }
    }

    #[test]
    fn teeth_that_differ_find_each_others_surface() {
        let (cut, speed, depth) = (runout(), 40_891.0 / 60.0 * TAU, 9.1108e-3);
        let forced = cut.forced(speed, depth).expect("stable");
        let settings = crate::SimulationSettings { steps: 300, periods: 600, observed: 60, kick: 0.0 };
        let run = cut.simulate(speed, depth, &settings).expect("a cut");
        for axis in 0..2 {
            let (told, seen) = (forced.peak_to_peak[axis], run.peak_to_peak(axis));
            assert!((told / seen - 1.0).abs() < 0.03, "{axis}: {told} {seen}");
            let (told, seen) = (forced.greatest_force[axis], run.greatest_force(axis));
            assert!((told / seen - 1.0).abs() < 0.03, "{axis}: {told} N {seen} N");
        }
        // Without it the motion and the force are others.
        let geometry = Geometry::new(&cut, depth, false).expect("a cut");
        let force = |i: usize| cut.static_force(&geometry, depth, geometry.origin + TAU * i as f64 / 1000.0);
        let greatest = (0..1000).map(|i| force(i)[1].abs()).fold(0.0, f64::max);
        assert!(greatest > 1.15 * forced.greatest_force[1], "{greatest} {:?}", forced.greatest_force);
        let errors = cut.surface_errors(&[speed], &[depth]).expect("stable");
        assert!((errors[0] - cut.material_left(&forced)).abs() < 1e-12);
    }

    /// The motion is that of the force which it has, with the change of the chip that it makes.
    #[test]
    fn motion_and_force_belong_together_where_the_pitch_is_unequal() {
        let mut cut = runout();
        cut.cutter.runout = 0.0;
        cut.cutter.pitch = vec![2.6, TAU - 2.6];
        let (speed, depth) = (40_891.0 / 60.0 * TAU, 6e-3);
        let moved = cut.forced(speed, depth).expect("a cut").displacement;
        let geometry = Geometry::new(&cut, depth, false).expect("a cut");
        let angle = |i: usize| geometry.origin + TAU * i as f64 / moved.len() as f64;
        let there = |i: f64| moved[(i.round() as isize).rem_euclid(moved.len() as isize) as usize];
        let force: Vec<[f64; 2]> = (0..moved.len())
            .map(|i| {
                let mut force = cut.static_force(&geometry, depth, angle(i));
                for tooth in geometry.cutting(angle(i) - 1e-12, angle(i) + 1e-12) {
                    let h = geometry.directional(&cut, tooth, angle(i));
                    let back = geometry.teeth[tooth.0].1[tooth.1].delay / TAU * moved.len() as f64;
                    let before = there(i as f64 - back);
                    let [x, y] = [moved[i][0] - before[0], moved[i][1] - before[1]];
                    force[0] -= depth * (h[0] * x + h[1] * y);
                    force[1] -= depth * (h[2] * x + h[3] * y);
                }
                force
            })
            .collect();
        let harmonic = |series: &[[f64; 2]], r: usize| {
            let term = |(i, v): (usize, &[f64; 2])| {
                let turn = Complex::from_polar(1.0 / moved.len() as f64, -TAU * (r * i) as f64 / moved.len() as f64);
                Vector2::new(turn * v[0], turn * v[1])
            };
            series.iter().enumerate().map(term).fold(Vector2::zeros(), |sum, each| sum + each)
        };
        let greatest = (1..8).map(|r| harmonic(&moved, r).norm()).fold(0.0, f64::max);
        for r in 0..8 {
            let driven = cut.frequency_response(r as f64 * speed / TAU) * harmonic(&force, r);
            let off = (driven - harmonic(&moved, r)).norm() / greatest;
            assert!(off < 0.01, "harmonic {r}: {off}");
        }
        // Harmonics of the revolution, which equal teeth do not have, are there.
        assert!(harmonic(&moved, 1).norm() > 1e-3 * greatest);
    }
}
