//! Gauss–Legendre nodes on 0 … 1 with the matrices of spectral collocation.

use std::sync::{Arc, OnceLock};

/// Greatest number of nodes in one element.
pub const MAX_NODES: usize = 64;

/// Nodes of one element on 0 … 1 and what collocation needs at them.
#[derive(Debug)]
pub struct Rule {
    /// Nodes, ascending.
    pub nodes: Vec<f64>,
    /// Quadrature weights; they sum to one.
    pub weights: Vec<f64>,
    /// Row j integrates the interpolant from 0 to node j. Row-major.
    pub integration: Vec<f64>,
    /// `integration` applied twice: row j is the double integral up to node j. Row-major.
    pub double_integration: Vec<f64>,
    /// Barycentric weights.
    barycentric: Vec<f64>,
}

impl Rule {
    /// The rule with `n` nodes, computed once for the life of the program.
    pub fn of(n: usize) -> Arc<Self> {
        static RULES: [OnceLock<Arc<Rule>>; MAX_NODES + 1] = [const { OnceLock::new() }; MAX_NODES + 1];
        RULES[n.clamp(1, MAX_NODES)].get_or_init(|| Arc::new(Self::new(n.clamp(1, MAX_NODES)))).clone()
    }

    fn new(n: usize) -> Self {
        let (nodes, weights) = gauss_legendre(n);
        // Legendre polynomials at the nodes times `(2m+1) weight`: column k turns sample k into
        // Legendre coefficients. Row-major by degree.
        let mut transform = vec![0.0; n * n];
        let mut integration = vec![0.0; n * n];
        let integrals: Vec<Vec<f64>> = nodes.iter().map(|t| legendre_integrals(n, *t)).collect();
        for k in 0..n {
            let p = legendre(n, 2.0 * nodes[k] - 1.0);
            for m in 0..n {
                transform[m * n + k] = (2 * m + 1) as f64 * weights[k] * p[m];
            }
        }
        for j in 0..n {
            for k in 0..n {
                integration[j * n + k] = (0..n).map(|m| integrals[j][m] * transform[m * n + k]).sum();
            }
        }
        let mut double_integration = vec![0.0; n * n];
        for j in 0..n {
            for i in 0..n {
                for k in 0..n {
                    double_integration[j * n + k] += integration[j * n + i] * integration[i * n + k];
                }
            }
        }
        // Of Gauss nodes (Wang and Xiang 2012): (−1)^k sqrt((1 − x²) w) up to a common factor.
        let signs = [1.0, -1.0].into_iter().cycle();
        let barycentric = nodes.iter().zip(&weights).zip(signs).map(|((t, w), sign)| sign * (t * (1.0 - t) * w).sqrt());
        let barycentric = barycentric.collect();
        Self { nodes, weights, integration, double_integration, barycentric }
    }

    /// Weights of the samples that interpolate at `t`: the second barycentric formula.
    pub fn interpolation(&self, t: f64) -> Vec<f64> {
        if let Some(place) = self.nodes.iter().position(|node| *node == t) {
            let mut unit = vec![0.0; self.nodes.len()];
            unit[place] = 1.0;
            return unit;
        }
        let mut weights: Vec<f64> = self.nodes.iter().zip(&self.barycentric).map(|(node, b)| b / (t - node)).collect();
        let inverse = 1.0 / weights.iter().sum::<f64>();
        weights.iter_mut().for_each(|weight| *weight *= inverse);
        weights
    }
}

/// Legendre polynomials of degree 0 … n at `x` in −1 … 1.
fn legendre(n: usize, x: f64) -> Vec<f64> {
    let mut p = vec![1.0, x];
    for m in 1..n {
        let m_ = m as f64;
        p.push(((2.0 * m_ + 1.0) * x * p[m] - m_ * p[m - 1]) / (m_ + 1.0));
    }
    p
}

/// Integrals from 0 to `t` of the first `n` Legendre polynomials shifted to 0 … 1.
fn legendre_integrals(n: usize, t: f64) -> Vec<f64> {
    let p = legendre(n, 2.0 * t - 1.0);
    (0..n).map(|m| if m == 0 { t } else { (p[m + 1] - p[m - 1]) / (2.0 * (2 * m + 1) as f64) }).collect()
}

/// Nodes and weights on 0 … 1 by Newton's method from the Chebyshev guess.
fn gauss_legendre(n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut nodes = vec![0.0; n];
    let mut weights = vec![0.0; n];
    for i in 0..n {
        let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
        let mut slope = 0.0;
        for _ in 0..100 {
            let p = legendre(n, x);
            slope = n as f64 * (x * p[n] - p[n - 1]) / (x * x - 1.0);
            let step = p[n] / slope;
            x -= step;
            if step.abs() < 1e-16 {
                break;
            }
        }
        nodes[i] = 0.5 * (1.0 + x);
        weights[i] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
    (nodes, weights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrates_polynomials_exactly() {
        for n in [1, 2, 5, 12, 32, MAX_NODES] {
            let rule = Rule::of(n);
            let top: f64 = rule.nodes.iter().zip(&rule.weights).map(|(t, w)| w * t.powi(2 * n as i32 - 1)).sum();
            assert!((top - 1.0 / (2 * n) as f64).abs() < 1e-13, "{n}: {top}");
            let degree = n as i32 - 1;
            for j in 0..n {
                let row = &rule.integration[j * n..(j + 1) * n];
                let integral: f64 = row.iter().zip(&rule.nodes).map(|(s, t)| s * t.powi(degree)).sum();
                assert!((integral - rule.nodes[j].powi(degree + 1) / f64::from(degree + 1)).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn interpolates_smooth_functions() {
        let rule = Rule::of(16);
        for t in [0.0, 0.3217, rule.nodes[5], 1.0] {
            let weights = rule.interpolation(t);
            let value: f64 = weights.iter().zip(&rule.nodes).map(|(w, t)| w * (3.0 * t).sin()).sum();
            assert!((value - (3.0 * t).sin()).abs() < 1e-13, "{t}");
        }
    }
}
