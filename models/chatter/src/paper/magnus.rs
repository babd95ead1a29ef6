//! Fourth-order Magnus integration of linear systems with periodic coefficients.

use nalgebra::SMatrix;

/// Matrix exponential by Taylor series after scaling, squared back.
///
/// ```
/// use nalgebra::Matrix2;
/// let rotation = toolroom_chatter::paper::expm(&Matrix2::new(0.0, -1.0, 1.0, 0.0));
/// assert!((rotation[(0, 0)] - 1f64.cos()).abs() < 1e-14);
/// ```
pub fn expm<const N: usize>(a: &SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    // Below a norm of 1/2 the thirteenth power is under 1e-13 of the first.
    let norm = a.abs().row_sum().max().max(a.abs().column_sum().max());
    let halvings = if norm > 0.5 { (norm / 0.5).log2().ceil() as i32 } else { 0 };
    let scaled = a * 0.5f64.powi(halvings);
    let mut result = SMatrix::<f64, N, N>::identity();
    for k in (1..=13).rev() {
        result = SMatrix::identity() + scaled * result / f64::from(k);
    }
    for _ in 0..halvings {
        result *= result;
    }
    result
}

/// State transition over `period` of `z' = coefficients(t) z`, in `steps` equal steps.
///
/// `Omega = h/2 (A1 + A2) − √3/12 h² [A1, A2]` with `A` at the two Gauss points of the step.
/// The exponential makes it safe for stiff systems: a vanishing lag needs no smaller steps.
pub fn monodromy<const N: usize>(
    coefficients: impl Fn(f64) -> SMatrix<f64, N, N>,
    period: f64,
    steps: usize,
) -> SMatrix<f64, N, N> {
    let h = period / steps as f64;
    let gauss = 3f64.sqrt() / 6.0;
    (0..steps).fold(SMatrix::identity(), |phi, step| {
        let middle = (step as f64 + 0.5) * h;
        let (a1, a2) = (coefficients(middle - gauss * h), coefficients(middle + gauss * h));
        let omega = (a1 + a2) * (h / 2.0) - (a1 * a2 - a2 * a1) * (gauss / 2.0 * h * h);
        expm(&omega) * phi
    })
}
