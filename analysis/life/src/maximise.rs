//! Newton's method for log-likelihoods of a few parameters.

use nalgebra::{DMatrix, DVector};

/// Step of the central differences; parameters are of the order of one.
const STEP: f64 = 1e-4;
/// Gain of the log-likelihood below which the search ends.
const SETTLED: f64 = 1e-9;
/// Steps after which a search without result ends.
const STEPS: usize = 200;

/// Distance at which an end of a profile is given up: parameters are logarithms.
const FARTHEST: f64 = 60.0;

/// Where a search ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Maximum {
    /// Parameters.
    pub at: Vec<f64>,
    /// Value there.
    pub value: f64,
    /// Negative second derivatives, the observed information.
    pub information: DMatrix<f64>,
}

impl Maximum {
    /// Inverse of the information, the approximate covariance; `None` where it is singular.
    pub fn covariance(&self) -> Option<DMatrix<f64>> {
        self.information.clone().cholesky().map(|factor| factor.inverse())
    }

    /// Approximate standard error of a parameter; infinite where the information is singular.
    pub fn standard_error(&self, parameter: usize) -> f64 {
        self.covariance().map_or(f64::INFINITY, |covariance| covariance[(parameter, parameter)].sqrt())
    }
}

/// Maximises `f` from `start` by Newton steps with Levenberg's damping, derivatives by central
/// differences. Values that are not finite count as infinitely bad. `None` where the start is
/// such a point.
///
/// # Source
/// K. Levenberg, Quarterly of Applied Mathematics 2 (1944) 164; step and tolerance assumptions.
///
/// # Examples
/// ```
/// let peak = toolroom_life::maximise::maximise(&|x| -(x[0] - 2.0).powi(2), &[0.0]).unwrap();
/// assert!((peak.at[0] - 2.0).abs() < 1e-6 && (peak.standard_error(0) - 0.5f64.sqrt()).abs() < 1e-6);
/// ```
pub fn maximise(f: &dyn Fn(&[f64]) -> f64, start: &[f64]) -> Option<Maximum> {
    let finite = |x: &[f64]| Some(f(x)).filter(|value| value.is_finite());
    let mut point = start.to_vec();
    let mut value = finite(&point)?;
    let mut damping = 0.0;
    for _ in 0..STEPS {
        let (gradient, information) = derivatives(f, &point, value);
        if !gradient.iter().chain(information.iter()).all(|entry| entry.is_finite()) {
            return Some(Maximum { at: point, value, information });
        }
        let settled = SETTLED + 1e-13 * value.abs();
        let mut moved = false;
        // Damping grows until the step climbs; it ends at steps below rounding.
        for _ in 0..40 {
            let mut damped = information.clone();
            for i in 0..point.len() {
                damped[(i, i)] += damping * information[(i, i)].abs().max(1e-6);
            }
            if let Some(factor) = damped.cholesky() {
                let mut step = factor.solve(&gradient);
                let gain = 0.5 * gradient.dot(&step);
                if gain < settled {
                    return Some(Maximum { at: point, value, information });
                }
                // A parameter is a logarithm or a ratio: two units are far.
                let longest = step.amax();
                if longest > 2.0 {
                    step *= 2.0 / longest;
                }
                let trial: Vec<f64> = point.iter().zip(step.iter()).map(|(x, dx)| x + dx).collect();
                if let Some(better) = finite(&trial).filter(|better| *better > value) {
                    (point, value, moved) = (trial, better, true);
                    damping = if damping < 1e-6 { 0.0 } else { damping / 10.0 };
                    break;
                }
            }
            damping = if damping == 0.0 { 1e-3 } else { 4.0 * damping };
        }
        if !moved {
            return Some(Maximum { at: point, value, information });
        }
    }
    let information = derivatives(f, &point, value).1;
    Some(Maximum { at: point, value, information })
}

/// Steps with second derivatives that are held (assumption: as dear as a search anew).
const HELD: usize = 12;

/// The same from a place near to a maximum whose second derivatives `held` is known to be those of the neighbourhood: most
/// of the work of [`maximise`] is to find these anew at every step. Here each step corrects them by the change of the gradient.
/// Where that leads nowhere, and where `held` is of another size, it is [`maximise`].
///
/// The result has `held` as its information.
///
/// # Source
/// The method of Broyden, Fletcher, Goldfarb and Shanno: J. Nocedal, S. J. Wright, Numerical Optimization (2006), section 6.1.
pub fn maximise_near(f: &dyn Fn(&[f64]) -> f64, start: &[f64], held: &DMatrix<f64>) -> Option<Maximum> {
    let anew = || maximise(f, start);
    let size = start.len();
    let Some(factor) = held.clone().cholesky().filter(|_| held.nrows() == size) else { return anew() };
    let mut inverse = factor.inverse();
    let mut point = start.to_vec();
    let mut value = f(&point);
    let mut slope = gradient(&sides(f, &point));
    for _ in 0..HELD {
        let step = &inverse * &slope;
        if 0.5 * slope.dot(&step) < SETTLED {
            return Some(Maximum { at: point, value, information: held.clone() });
        }
        let trial: Vec<f64> = point.iter().zip(step.iter()).map(|(x, dx)| x + dx).collect();
        let better = f(&trial);
        // A value that is no number is not better either.
        if better.is_nan() || better <= value {
            break;
        }
        let next = gradient(&sides(f, &trial));
        let change = &slope - &next;
        let product = step.dot(&change);
        if product > 0.0 {
            let left = DMatrix::identity(size, size) - &step * change.transpose() / product;
            inverse = &left * inverse * left.transpose() + &step * step.transpose() / product;
        }
        (point, value, slope) = (trial, better, next);
    }
    anew()
}

/// Values a step below and above along each parameter.
fn sides(f: &dyn Fn(&[f64]) -> f64, at: &[f64]) -> Vec<(f64, f64)> {
    let moved = |i: usize, dx: f64| {
        let mut x = at.to_vec();
        x[i] += dx;
        f(&x)
    };
    (0..at.len()).map(|i| (moved(i, -STEP), moved(i, STEP))).collect()
}

fn gradient(sides: &[(f64, f64)]) -> DVector<f64> {
    DVector::from_iterator(sides.len(), sides.iter().map(|(below, above)| (above - below) / (2.0 * STEP)))
}

/// Gradient and negative second derivatives.
fn derivatives(f: &dyn Fn(&[f64]) -> f64, at: &[f64], value: f64) -> (DVector<f64>, DMatrix<f64>) {
    let n = at.len();
    let sides = sides(f, at);
    let gradient = gradient(&sides);
    let mut information = DMatrix::zeros(n, n);
    for i in 0..n {
        information[(i, i)] = (2.0 * value - sides[i].0 - sides[i].1) / (STEP * STEP);
        for j in 0..i {
            let corner = |a: f64, b: f64| {
                let mut x = at.to_vec();
                x[i] += a * STEP;
                x[j] += b * STEP;
                f(&x)
            };
            let mixed =
                (corner(1.0, 1.0) - corner(1.0, -1.0) - corner(-1.0, 1.0) + corner(-1.0, -1.0)) / (4.0 * STEP * STEP);
            (information[(i, j)], information[(j, i)]) = (-mixed, -mixed);
        }
    }
    (gradient, information)
}

/// The range of a parameter in which the greatest value over the others stays within `drop` of
/// the maximum: a profile-likelihood interval, where `drop` is half a quantile of chi square.
/// Infinite on a side where the profile never falls so far within 60 units.
///
/// # Source
/// D. J. Venzon, S. H. Moolgavkar, Applied Statistics 37 (1988) 87 (intervals; the search is
/// plain bisection).
pub fn profile(f: &dyn Fn(&[f64]) -> f64, peak: &Maximum, parameter: usize, drop: f64) -> (f64, f64) {
    let others: Vec<f64> = peak.at.iter().enumerate().filter(|(i, _)| *i != parameter).map(|(_, x)| *x).collect();
    let held = peak.information.clone().remove_row(parameter).remove_column(parameter);
    // By how much the others move with the parameter near to the peak.
    let coupled = peak.information.column(parameter).remove_row(parameter);
    let drift = held.clone().cholesky().map(|factor| -factor.solve(&coupled));
    let side = |sign: f64| {
        let mut nuisance = others.clone();
        let mut last = peak.at[parameter];
        let mut excess = |value: f64| {
            let inner = |x: &[f64]| {
                let mut all = x.to_vec();
                all.insert(parameter, value);
                f(&all)
            };
            if let Some(drift) = &drift {
                let moved = nuisance.iter().zip(drift.iter()).map(|(x, slope)| x + slope * (value - last));
                let moved: Vec<f64> = moved.collect();
                if inner(&moved) > inner(&nuisance) {
                    nuisance = moved;
                }
            }
            last = value;
            let best = match maximise_near(&inner, &nuisance, &held) {
                Some(best) if !nuisance.is_empty() => {
                    nuisance = best.at;
                    best.value
                }
                _ => inner(&nuisance),
            };
            if best.is_finite() { best - (peak.value - drop) } else { -drop }
        };
        let width = (2.0 * drop).sqrt() * peak.standard_error(parameter);
        let centre = peak.at[parameter];
        let (mut near, mut near_excess) = (0.0, drop);
        let mut far = if width.is_finite() { width.clamp(1e-9, 5.0) } else { 0.5 };
        let mut far_excess = excess(centre + sign * far);
        while far_excess > 0.0 {
            (near, near_excess) = (far, far_excess);
            far *= 1.5;
            if far > FARTHEST {
                return sign * f64::INFINITY;
            }
            far_excess = excess(centre + sign * far);
        }
        // Illinois variant of false position: brackets like bisection, converges like the secant.
        for _ in 0..60 {
            if far - near < 1e-7 * far {
                break;
            }
            let middle = (near * far_excess - far * near_excess) / (far_excess - near_excess);
            let middle_excess = excess(centre + sign * middle);
            if middle_excess.abs() < 1e-7 {
                (near, far) = (middle, middle);
            } else if middle_excess > 0.0 {
                (near, near_excess) = (middle, middle_excess);
                far_excess *= 0.5;
            } else {
                (far, far_excess) = (middle, middle_excess);
                near_excess *= 0.5;
            }
        }
        centre + sign * 0.5 * (near + far)
    };
    (side(-1.0), side(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curved_ridge_is_climbed_from_afar() {
        // Rosenbrock's valley upside down.
        let f = |x: &[f64]| -(1.0 - x[0]).powi(2) - 100.0 * (x[1] - x[0] * x[0]).powi(2);
        let peak = maximise(&f, &[-1.2, 1.0]).unwrap();
        assert!((peak.at[0] - 1.0).abs() < 1e-4 && (peak.at[1] - 1.0).abs() < 1e-4, "{peak:?}");
    }

    #[test]
    fn the_profile_of_a_quadratic_is_its_normal_interval() {
        // Correlation 0.6: the profile sees the marginal deviation 1, not the conditional 0.8.
        let f = |x: &[f64]| -0.5 * (x[0] * x[0] - 1.2 * x[0] * x[1] + x[1] * x[1]) / (1.0 - 0.36);
        let peak = maximise(&f, &[0.3, -0.2]).unwrap();
        let (low, high) = profile(&f, &peak, 0, 0.5);
        assert!((low + 1.0).abs() < 1e-5 && (high - 1.0).abs() < 1e-5, "{low} {high}");
    }

    #[test]
    fn near_a_known_maximum_held_derivatives_lead_to_the_same_place_for_less() {
        let calls = std::cell::Cell::new(0);
        let f = |x: &[f64]| {
            calls.set(calls.get() + 1);
            -(x[0] - 2.0).powi(2) - (x[1] + x[0]).powi(2) - 0.1 * (x[0] - 2.0).powi(3)
        };
        let known = maximise(&|x: &[f64]| -(x[0] - 2.0).powi(2) - (x[1] + x[0]).powi(2), &[0.0, 0.0]).unwrap();
        let start = [2.1, -1.9];
        let held = maximise_near(&f, &start, &known.information).unwrap();
        let few = calls.replace(0);
        let anew = maximise(&f, &start).unwrap();
        assert!(held.at.iter().zip(&anew.at).all(|(a, b)| (a - b).abs() < 1e-4), "{held:?} {anew:?}");
        assert!(few < calls.get(), "{few} against {}", calls.get());
        // Of another place nothing is known.
        let other = maximise_near(&f, &start, &DMatrix::identity(1, 1)).unwrap();
        assert_eq!(other, anew);
    }

    #[test]
    fn a_start_without_a_value_is_refused() {
        assert_eq!(maximise(&|_| f64::NAN, &[0.0]), None);
    }
}
