//! Period map of a linear system whose delay equals its period.

use crate::error::ChatterError;
use nalgebra::{Complex, DMatrix, SMatrix};
use toolroom_spectral::{Rule, dense_eigenvalues};

/// Floquet multipliers of `z' = a(t) z + b(t) y(t − period)`, `y = c z`, the greatest first.
///
/// Gauss–Legendre collocation on `elements` equal elements of `nodes` nodes each; the map acts
/// on the D delayed signals at the nodes and on the state at the end of the period. It is meant
/// for smooth coefficients and a few dozen oscillations, where it converges exponentially.
///
/// # Errors
/// A vibration that outgrows all numbers within the period.
///
/// ```
/// use nalgebra::{Matrix1, Matrix1x2, Matrix2, Matrix2x1};
/// use std::f64::consts::TAU;
/// // Delayed Mathieu equation x'' + 0.1 x' + (3 + 2 cos t) x = −0.15 x(t − 2 pi).
/// let a = |t: f64| Matrix2::new(0.0, 1.0, -3.0 - 2.0 * t.cos(), -0.1);
/// let b = |_: f64| Matrix2x1::new(0.0, -0.15);
/// let c = Matrix1x2::new(1.0, 0.0);
/// let dominant = toolroom_chatter::paper::delayed_multipliers(a, b, &c, TAU, 3, 14).unwrap()[0];
/// assert!((dominant.norm() - 0.512052284).abs() < 1e-8);
/// ```
pub fn delayed_multipliers<const N: usize, const D: usize>(
    a: impl Fn(f64) -> SMatrix<f64, N, N>,
    b: impl Fn(f64) -> SMatrix<f64, N, D>,
    c: &SMatrix<f64, D, N>,
    period: f64,
    elements: usize,
    nodes: usize,
) -> Result<Vec<Complex<f64>>, ChatterError> {
    let rule = Rule::of(nodes);
    let n = rule.nodes.len();
    let h = period / elements as f64;
    let signals = elements * n * D;
    let size = signals + N;
    // Columns: the delayed signals, then the state; `state` is the state at the element's start
    // as a function of them.
    let mut map = DMatrix::zeros(size, size);
    let mut state = DMatrix::zeros(N, size);
    state.view_mut((0, signals), (N, N)).fill_with_identity();
    for element in 0..elements {
        let mut system = DMatrix::identity(n * N, n * N);
        let mut rates = DMatrix::zeros(n * N, size);
        for j in 0..n {
            let t = (element as f64 + rule.nodes[j]) * h;
            let (at, bt) = (a(t), b(t));
            for k in 0..n {
                let mut block = system.view_mut((j * N, k * N), (N, N));
                block -= at * (h * rule.integration[j * n + k]);
            }
            rates.rows_mut(j * N, N).copy_from(&(at * &state));
            let mut delayed = rates.view_mut((j * N, (element * n + j) * D), (N, D));
            delayed += bt;
        }
        // A Gauss collocation matrix of a short element is far from singular.
        let Some(rates) = system.lu().solve(&rates) else { continue };
        for j in 0..n {
            let mut at_node = state.clone();
            for k in 0..n {
                at_node += rates.rows(k * N, N) * (h * rule.integration[j * n + k]);
            }
            map.rows_mut((element * n + j) * D, D).copy_from(&(c * at_node));
        }
        for k in 0..n {
            state += rates.rows(k * N, N) * (h * rule.weights[k]);
        }
    }
    map.rows_mut(signals, N).copy_from(&state);
    Ok(dense_eigenvalues(map)?)
}
