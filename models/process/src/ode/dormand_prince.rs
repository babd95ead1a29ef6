//! One step of the Dormand–Prince 5(4) pair, its error and its dense output.

use super::Tolerance;

/// One step of the pair: its end, its error and the slopes within it.
pub(super) struct Step<const D: usize> {
    pub end: [f64; D],
    error: [f64; D],
    k3: [f64; D],
    k4: [f64; D],
    k5: [f64; D],
    k6: [f64; D],
    pub k7: [f64; D],
}

/// Coefficients of the Dormand–Prince 5(4) pair with first-same-as-last.
pub(super) fn dormand_prince<const D: usize>(
    rhs: &mut impl FnMut(f64, &[f64; D]) -> [f64; D],
    t: f64,
    y: &[f64; D],
    k1: &[f64; D],
    h: f64,
) -> Step<D> {
    let k2 = rhs(t + h / 5.0, &std::array::from_fn(|i| y[i] + h * (k1[i] / 5.0)));
    let k3 = rhs(t + 0.3 * h, &std::array::from_fn(|i| y[i] + h * (3.0 / 40.0 * k1[i] + 9.0 / 40.0 * k2[i])));
    let k4 = rhs(
        t + 0.8 * h,
        &std::array::from_fn(|i| y[i] + h * (44.0 / 45.0 * k1[i] - 56.0 / 15.0 * k2[i] + 32.0 / 9.0 * k3[i])),
    );
    let k5 = rhs(
        t + 8.0 / 9.0 * h,
        &std::array::from_fn(|i| {
            y[i] + h
                * (19372.0 / 6561.0 * k1[i] - 25360.0 / 2187.0 * k2[i] + 64448.0 / 6561.0 * k3[i]
                    - 212.0 / 729.0 * k4[i])
        }),
    );
    let k6 = rhs(
        t + h,
        &std::array::from_fn(|i| {
            y[i] + h
                * (9017.0 / 3168.0 * k1[i] - 355.0 / 33.0 * k2[i] + 46732.0 / 5247.0 * k3[i] + 49.0 / 176.0 * k4[i]
                    - 5103.0 / 18656.0 * k5[i])
        }),
    );
    let end: [f64; D] = std::array::from_fn(|i| {
        y[i] + h
            * (35.0 / 384.0 * k1[i] + 500.0 / 1113.0 * k3[i] + 125.0 / 192.0 * k4[i] - 2187.0 / 6784.0 * k5[i]
                + 11.0 / 84.0 * k6[i])
    });
    let k7 = rhs(t + h, &end);
    let error = std::array::from_fn(|i| {
        h * (71.0 / 57600.0 * k1[i] - 71.0 / 16695.0 * k3[i] + 71.0 / 1920.0 * k4[i] - 17253.0 / 339200.0 * k5[i]
            + 22.0 / 525.0 * k6[i]
            - k7[i] / 40.0)
    });
    Step { end, error, k3, k4, k5, k6, k7 }
}

impl<const D: usize> Step<D> {
    /// Root mean square of the error in units of the tolerance; at most 1 is accepted.
    pub fn error_norm(&self, y: &[f64; D], tolerance: &Tolerance<D>) -> f64 {
        let mut sum = 0.0;
        for (i, start) in y.iter().enumerate() {
            let scale = tolerance.absolute[i] + tolerance.relative * start.abs().max(self.end[i].abs());
            sum += (self.error[i] / scale).powi(2);
        }
        (sum / D as f64).sqrt()
    }

    /// The polynomial over the step.
    pub fn dense(&self, y: &[f64; D], k1: &[f64; D], h: f64) -> Dense<D> {
        let rise: [f64; D] = std::array::from_fn(|i| self.end[i] - y[i]);
        let bend: [f64; D] = std::array::from_fn(|i| h * k1[i] - rise[i]);
        Dense {
            start: *y,
            rise,
            bend,
            third: std::array::from_fn(|i| rise[i] - h * self.k7[i] - bend[i]),
            fourth: std::array::from_fn(|i| {
                h * (-12715105075.0 / 11282082432.0 * k1[i] + 87487479700.0 / 32700410799.0 * self.k3[i]
                    - 10690763975.0 / 1880347072.0 * self.k4[i]
                    + 701980252875.0 / 199316789632.0 * self.k5[i]
                    - 1453857185.0 / 822651844.0 * self.k6[i]
                    + 69997945.0 / 29380423.0 * self.k7[i])
            }),
        }
    }
}

/// Fourth-order polynomial over one step.
pub(super) struct Dense<const D: usize> {
    start: [f64; D],
    rise: [f64; D],
    bend: [f64; D],
    third: [f64; D],
    fourth: [f64; D],
}

impl<const D: usize> Dense<D> {
    /// State at a `share` of the step, 0 … 1.
    pub fn at(&self, share: f64) -> [f64; D] {
        let rest = 1.0 - share;
        std::array::from_fn(|i| {
            self.start[i]
                + share * (self.rise[i] + rest * (self.bend[i] + share * (self.third[i] + rest * self.fourth[i])))
        })
    }
}
