//! The pair of Dormand and Prince, for systems whose size is known while running and whose equations may refuse a point.
//!
//! `toolroom_process::ode` has the same pair for our own processes: sizes known while compiling, equations that
//! cannot fail.
//!
//! # Source
//! Dormand & Prince 1980; dense output by Shampine, as in Hairer, Nørsett, Wanner, Solving ODEs I, II.5 and II.6.

/// Times of the stages, shares of the step.
const TIMES: [f64; 7] = [0.0, 0.2, 0.3, 0.8, 8.0 / 9.0, 1.0, 1.0];

/// Weights of earlier slopes in each stage; the last row is the solution.
const WEIGHTS: [[f64; 6]; 7] = [
    [0.0; 6],
    [1.0 / 5.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [3.0 / 40.0, 9.0 / 40.0, 0.0, 0.0, 0.0, 0.0],
    [44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0, 0.0, 0.0, 0.0],
    [19372.0 / 6561.0, -25360.0 / 2187.0, 64448.0 / 6561.0, -212.0 / 729.0, 0.0, 0.0],
    [9017.0 / 3168.0, -355.0 / 33.0, 46732.0 / 5247.0, 49.0 / 176.0, -5103.0 / 18656.0, 0.0],
    [35.0 / 384.0, 0.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0],
];

/// Difference of the solution to the one of fourth order.
const ERROR: [f64; 7] =
    [71.0 / 57600.0, 0.0, -71.0 / 16695.0, 71.0 / 1920.0, -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0];

/// Weights of the term of fourth order in the dense output.
const DENSE: [f64; 7] = [
    -12715105075.0 / 11282082432.0,
    0.0,
    87487479700.0 / 32700410799.0,
    -10690763975.0 / 1880347072.0,
    701980252875.0 / 199316789632.0,
    -1453857185.0 / 822651844.0,
    69997945.0 / 29380423.0,
];

/// A step: slopes of its stages, and its end.
#[derive(Debug)]
pub(super) struct Stages {
    slopes: [Vec<f64>; 7],
    point: Vec<f64>,
    between: Vec<f64>,
}

impl Stages {
    pub fn new(states: usize) -> Self {
        let zero = vec![0.0; states];
        Self { slopes: std::array::from_fn(|_| zero.clone()), point: zero.clone(), between: zero }
    }

    /// The slope at the start of the step.
    pub fn first(&mut self) -> &mut [f64] {
        &mut self.slopes[0]
    }

    /// The state at the end of the step.
    pub fn end(&self) -> &[f64] {
        &self.point
    }

    /// What [`Stages::between`] gave last.
    pub fn last_between(&self) -> &[f64] {
        &self.between
    }

    /// Makes the end of this step the start of the next one.
    pub fn advance(&mut self) {
        self.slopes.swap(0, 6);
    }

    /// A step of `length` from `x`; its error relative to what is tolerated, not a number where `slope` refused a
    /// point (`false`) or gave something that is not finite. `slope` is handed the time as a share of the step.
    pub fn step<Error>(
        &mut self,
        x: &[f64],
        length: f64,
        absolute: &[f64],
        relative: f64,
        mut slope: impl FnMut(f64, &[f64], &mut [f64]) -> Result<bool, Error>,
    ) -> Result<f64, Error> {
        if x.is_empty() {
            return Ok(0.0);
        }
        for stage in 1..TIMES.len() {
            for (i, point) in self.point.iter_mut().enumerate() {
                let weighted = WEIGHTS[stage].iter().zip(&self.slopes).map(|(weight, slope)| weight * slope[i]);
                *point = x[i] + length * weighted.take(stage).sum::<f64>();
            }
            if !slope(TIMES[stage], &self.point, &mut self.slopes[stage])? {
                return Ok(f64::NAN);
            }
        }
        let square = |i: usize| {
            let error = length * ERROR.iter().zip(&self.slopes).map(|(weight, slope)| weight * slope[i]).sum::<f64>();
            (error / (absolute[i] + relative * x[i].abs().max(self.point[i].abs()))).powi(2)
        };
        Ok(((0..x.len()).map(square).sum::<f64>() / x.len() as f64).sqrt())
    }

    /// The state at a share of the step of `length` from `x`.
    pub fn between(&mut self, x: &[f64], length: f64, share: f64) -> &[f64] {
        for (i, value) in self.between.iter_mut().enumerate() {
            let change = self.point[i] - x[i];
            let start = length * self.slopes[0][i] - change;
            let end = change - length * self.slopes[6][i] - start;
            let fourth = length * DENSE.iter().zip(&self.slopes).map(|(weight, slope)| weight * slope[i]).sum::<f64>();
            *value = x[i] + share * (change + (1.0 - share) * (start + share * (end + (1.0 - share) * fourth)));
        }
        &self.between
    }
}

/// A first step from `x` with this slope: the state changes by a hundredth of what matters, as in Hairer, Nørsett,
/// Wanner, II.4, and by the whole way where nothing changes.
pub(super) fn first_step(x: &[f64], slope: &[f64], absolute: &[f64], relative: f64, whole: f64) -> f64 {
    let scaled = |values: &[f64]| {
        let square = |i: usize| (values[i] / (absolute[i] + relative * x[i].abs())).powi(2);
        ((0..values.len()).map(square).sum::<f64>() / values.len().max(1) as f64).sqrt()
    };
    let (size, speed) = (scaled(x), scaled(slope));
    let step = if size < 1e-5 || speed < 1e-5 { 1e-6 } else { 0.01 * size / speed };
    if step.is_finite() { step.min(whole) } else { whole }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decay(_: f64, x: &[f64], k: &mut [f64]) -> Result<bool, ()> {
        k.iter_mut().zip(x).for_each(|(k, x)| *k = -x);
        Ok(true)
    }

    #[test]
    fn a_step_is_of_fifth_order_and_what_lies_within_it_of_fourth() {
        let error = |length: f64| {
            let mut stages = Stages::new(1);
            stages.first()[0] = -1.0;
            stages.step(&[1.0], length, &[1.0], 0.0, decay).expect("no refusal");
            let end = (stages.end()[0] - (-length).exp()).abs();
            (end, (stages.between(&[1.0], length, 0.4)[0] - (-0.4 * length).exp()).abs())
        };
        let (coarse, fine) = (error(0.2), error(0.1));
        // The error of one step is of one order more.
        assert!((5.5..6.5).contains(&(coarse.0 / fine.0).log2()), "{coarse:?} {fine:?}");
        assert!((4.5..5.5).contains(&(coarse.1 / fine.1).log2()), "{coarse:?} {fine:?}");
    }

    #[test]
    fn the_dense_output_meets_both_ends() {
        let mut stages = Stages::new(1);
        stages.first()[0] = -1.0;
        stages.step(&[1.0], 0.5, &[1.0], 0.0, decay).expect("no refusal");
        let end = stages.end()[0];
        assert_eq!(stages.between(&[1.0], 0.5, 0.0)[0], 1.0);
        assert!((stages.between(&[1.0], 0.5, 1.0)[0] - end).abs() < 1e-15);
    }

    #[test]
    fn a_refused_point_is_no_step() {
        let refuse = |_: f64, _: &[f64], _: &mut [f64]| Ok::<bool, ()>(false);
        assert!(Stages::new(1).step(&[1.0], 0.5, &[1.0], 0.0, refuse).expect("no failure").is_nan());
    }
}
