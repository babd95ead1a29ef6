//! The characteristic function of one mode under regular teeth at constant speed.
//!
//! A vibration that grows by the multiplier mu from tooth period to tooth period leaves a surface that
//! is `1/mu` of itself, so that the cut is one of the force `−z h(t) q` with `z = depth (1 − 1/mu)`:
//! no delay is left. In the coordinates A, B of `q = exp(−zeta w t) (A cos w_d t + B sin w_d t)`,
//! `A' = z eta sin(w_d t) r`, `B' = −z eta cos(w_d t) r`, `r = A cos(w_d t) + B sin(w_d t)`, nothing
//! moves in free flight, and the trace of the transition over a period is the power series `P(z)`
//! of the time-ordered integrals, whose determinant is `d = exp(−2 zeta w tau)` by Liouville. So
//! `mu² − P(z) mu + d = 0`, in `nu = 1/mu` a polynomial `1 − nu P(depth (1 − nu)) + d nu²`.

use super::Milling;
use super::engagement::Geometry;
use crate::response::Modal;
use nalgebra::Complex;
use std::sync::Arc;
use toolroom_spectral::{Dominant, Root, Rule, least_root};

/// Greatest order of the series.
const MAX_ORDER: usize = 100;
/// Terms below this share of the tolerance are dropped.
const NEGLIGIBLE: f64 = 1e-3;

/// A stretch in cut at the nodes of its rule.
struct Stretch {
    rule: Arc<Rule>,
    /// cos and sin of the damped vibration.
    phase: Vec<[f64; 2]>,
    /// Quadrature weight times the share of the strength.
    weight: Vec<f64>,
    /// `r` of the next order at a node (row) by `r` at the nodes (column): columns of [`LANES`] rows.
    kernel: Vec<[f64; LANES]>,
    /// `r` of the last order from A = 1 and from B = 1 at the start.
    r: [Vec<f64>; 2],
    /// Working storage for the next.
    next: [Vec<f64>; 2],
}

/// Rows of the kernel that are summed at once, so that no sum waits for the last.
const LANES: usize = 4;

/// The characteristic function, its series worked out as far as the depths so far need it.
pub(super) struct Characteristic {
    stretches: Vec<Stretch>,
    /// `∫ |eta| dt` per depth: the unit of the argument of the series.
    strength: f64,
    /// `exp(−zeta w tau)` times cos and sin of `w_d tau`.
    turn: [f64; 2],
    determinant: f64,
    /// The series, and by order the greatest entry of its integrals anywhere in the period.
    series: Vec<f64>,
    greatest: Vec<f64>,
    polynomial: Vec<f64>,
    rest: Vec<f64>,
    /// The last root, where the next search begins.
    last: Option<Complex<f64>>,
    /// Argument and tolerance at which the series cancelled.
    cancelled: Option<(f64, f64)>,
}

impl Characteristic {
    /// Of one `modal` over a tooth period `length` (s) at `speed` (rad/s); `gain` projects a matrix
    /// of the cut onto the mode. `stiffening` is the factor by which the cut quickens the vibration;
    /// `extra` nodes are added to each stretch.
    pub fn new(
        cut: &Milling,
        geometry: &Geometry,
        modal: &Modal,
        gain: impl Fn([f64; 4]) -> f64,
        speed: f64,
        stiffening: f64,
        extra: usize,
    ) -> Self {
        let w = modal.frequency;
        let damped = w * (1.0 - modal.damping_ratio * modal.damping_ratio).sqrt();
        let scale = w * w / (modal.stiffness * damped);
        let mut stretches = Vec::new();
        let mut strength = 0.0;
        for pair in geometry.breaks.windows(2) {
            let teeth = geometry.cutting(pair[0], pair[1]);
            if teeth.is_empty() {
                continue;
            }
            // Half of what vibrations, free and quickened, and teeth turn.
            let radians = (damped * 0.5 * (1.0 + stiffening) / speed + 1.0) * (pair[1] - pair[0]);
            let parts = (radians / MOST_RADIANS).ceil().max(1.0);
            let rule = Rule::of((6.0 + 1.2 * radians / parts).ceil() as usize + extra);
            let turn = (pair[1] - pair[0]) / parts;
            for part in 0..parts as usize {
                let from = pair[0] + turn * part as f64;
                let mut stretch = Stretch::new(rule.clone());
                for (j, node) in rule.nodes.iter().enumerate() {
                    let angle = from + turn * node;
                    let mut sum = [0.0; 4];
                    for tooth in &teeth {
                        let matrix = geometry.directional(cut, *tooth, angle);
                        sum.iter_mut().zip(matrix).for_each(|(sum, entry)| *sum += entry);
                    }
                    let (sin, cos) = (damped * (angle - geometry.origin) / speed).sin_cos();
                    stretch.phase[j] = [cos, sin];
                    stretch.weight[j] = scale * gain(sum) * turn / speed;
                    strength += (stretch.weight[j] * rule.weights[j]).abs();
                }
                stretches.push(stretch);
            }
        }
        let length = geometry.span / speed;
        let decay = (-modal.damping_ratio * w * length).exp();
        let (sin, cos) = (damped * length).sin_cos();
        let strength = if strength > 0.0 { strength } else { 1.0 };
        stretches.iter_mut().for_each(|stretch| stretch.finish(strength));
        let with_first = |first| {
            let mut orders = Vec::with_capacity(24);
            orders.push(first);
            orders
        };
        Self {
            stretches,
            strength,
            turn: [decay * cos, decay * sin],
            determinant: decay * decay,
            series: with_first(2.0 * decay * cos),
            greatest: with_first(1.0),
            polynomial: Vec::with_capacity(24),
            rest: Vec::with_capacity(24),
            last: None,
            cancelled: None,
        }
    }

    /// Dominant multiplier at `depth` (m), if its relative error is at most `tolerance`; `None`
    /// where the series cancels or two multipliers are one.
    pub fn dominant(&mut self, depth: f64, tolerance: f64) -> Option<Dominant> {
        let reach = depth * self.strength;
        // Without cutting the multipliers have the modulus sqrt(d).
        let mut radius = self.last.map_or(1.0 / self.determinant.sqrt().sqrt(), |last| last.norm_sqr()).sqrt();
        loop {
            let order = self.order(reach * (1.0 + radius), tolerance)?;
            self.expand(reach, order);
            let root = least_root(&self.polynomial, self.last, &mut self.rest)?;
            let modulus = root.at.norm_sqr().sqrt();
            if modulus > 1.01 * radius && self.order(reach * (1.0 + modulus), tolerance)? > order {
                radius = modulus;
                continue;
            }
            let residual = self.residual(&root, reach, order, tolerance);
            self.last = Some(root.at);
            return (residual <= tolerance).then(|| Dominant { value: root.at.inv(), residual });
        }
    }

    /// Relative error of a root: by its last step, and by what rounding and the terms that were dropped
    /// can do to the polynomial.
    fn residual(&self, root: &Root, reach: f64, order: usize, tolerance: f64) -> f64 {
        let modulus = root.at.norm_sqr().sqrt();
        let argument = reach * (1.0 + modulus);
        let size = self.series[..=order].iter().rev().fold(0.0, |sum, p| sum * argument + p.abs());
        let error = modulus * (f64::EPSILON * size + NEGLIGIBLE * tolerance) / root.slope;
        root.step.powi(2).max(error)
    }

    /// Order up to which the series counts at `argument`; `None` where rounding of its terms exceeds
    /// the `tolerance`.
    fn order(&mut self, argument: f64, tolerance: f64) -> Option<usize> {
        if self.cancelled.is_some_and(|(from, at)| argument >= from && tolerance <= at) {
            return None;
        }
        let (mut power, mut size) = (1.0, 0.0);
        for order in 0..MAX_ORDER {
            if order == self.series.len() {
                self.extend();
            }
            let term = self.greatest[order] * power;
            if term <= NEGLIGIBLE * tolerance {
                return Some(order);
            }
            size += term;
            if f64::EPSILON * size > tolerance {
                break;
            }
            power *= argument;
        }
        self.cancelled = Some((argument, tolerance));
        None
    }

    /// The next order.
    fn extend(&mut self) {
        // A and B from A = 1 and from B = 1.
        let (mut a, mut b) = ([0.0; 2], [0.0; 2]);
        let mut greatest: f64 = 0.0;
        for Stretch { phase, weight, kernel, r, next, .. } in &mut self.stretches {
            let (start_a, start_b) = (a, b);
            let [from_a, from_b] = r;
            for (((weight, [cos, sin]), from_a), from_b) in weight.iter().zip(&*phase).zip(&*from_a).zip(&*from_b) {
                for (side, r) in [from_a, from_b].into_iter().enumerate() {
                    a[side] += weight * sin * r;
                    b[side] -= weight * cos * r;
                }
            }
            for (block, rows) in kernel.chunks_exact(phase.len()).enumerate() {
                let mut sums = [[0.0; LANES]; 2];
                for ((column, from_a), from_b) in rows.iter().zip(&*from_a).zip(&*from_b) {
                    for lane in 0..LANES {
                        sums[0][lane] += column[lane] * from_a;
                        sums[1][lane] += column[lane] * from_b;
                    }
                }
                for (next, sums) in next.iter_mut().zip(&sums) {
                    next[block * LANES..][..LANES].copy_from_slice(sums);
                }
            }
            for (j, [cos, sin]) in phase.iter().enumerate() {
                for (side, next) in next.iter_mut().enumerate() {
                    next[j] += cos * start_a[side] + sin * start_b[side];
                }
                greatest = greatest.max(next[0][j].abs() + next[1][j].abs());
            }
            std::mem::swap(r, next);
        }
        let [cos, sin] = self.turn;
        self.series.push(cos * (a[0] + b[1]) + sin * (b[0] - a[1]));
        self.greatest.push(greatest.max(a[0].abs() + b[0].abs() + a[1].abs() + b[1].abs()));
    }

    /// The polynomial in `nu = 1/mu`, from the series up to `order`.
    fn expand(&mut self, reach: f64, order: usize) {
        self.polynomial.clear();
        self.polynomial.push(1.0);
        let mut power = 1.0;
        for p in &self.series[..=order] {
            self.polynomial.push(p * power);
            power *= reach;
        }
        // P(reach (1 − nu)) about nu = 0: Taylor's shift by one.
        let terms = &mut self.polynomial[1..];
        for first in 0..order {
            for j in (first..order).rev() {
                terms[j] += terms[j + 1];
            }
        }
        terms.iter_mut().step_by(2).for_each(|term| *term = -*term);
        if self.polynomial.len() < 3 {
            self.polynomial.resize(3, 0.0);
        }
        self.polynomial[2] += self.determinant;
    }
}

/// Radians in one stretch, at most: an order costs the square of the nodes of each, and the ends of
/// many short stretches are known better than those of a long one.
const MOST_RADIANS: f64 = 10.0;

impl Stretch {
    fn new(rule: Arc<Rule>) -> Self {
        let n = rule.nodes.len();
        let none = || [Vec::new(), Vec::new()];
        Self { rule, phase: vec![[0.0; 2]; n], weight: vec![0.0; n], kernel: Vec::new(), r: none(), next: none() }
    }

    /// From the gain at the nodes to weights and kernel.
    fn finish(&mut self, strength: f64) {
        let n = self.weight.len();
        self.weight.iter_mut().for_each(|weight| *weight /= strength);
        self.kernel = vec![[0.0; LANES]; n.div_ceil(LANES) * n];
        for (j, (row, [cos, sin])) in self.rule.integration.chunks_exact(n).zip(&self.phase).enumerate() {
            let columns = &mut self.kernel[j / LANES * n..][..n];
            for (((column, s), [c, z]), weight) in columns.iter_mut().zip(row).zip(&self.phase).zip(&self.weight) {
                column[j % LANES] = s * weight * (cos * z - sin * c);
            }
        }
        self.weight.iter_mut().zip(&self.rule.weights).for_each(|(weight, w)| *weight *= w);
        let rows = n.div_ceil(LANES) * LANES;
        for side in 0..2 {
            self.r[side] = self.phase.iter().map(|phase| phase[side]).collect();
            self.r[side].resize(rows, 0.0);
            self.next[side] = vec![0.0; rows];
        }
    }
}
