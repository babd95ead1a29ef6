//! Searches over cutting speed.

/// The argument in `[low, high]` at which a function of one variable is greatest: the best of
/// `points` spaced evenly in the logarithm, then the root of the slope beside it.
///
/// `f` gives the value and something with the sign of its slope. Where the best point is an
/// end of the range, that end is the answer.
pub(crate) fn greatest(low: f64, high: f64, points: u32, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    let argument = |i: u32| grid(low, high, points, i);
    let mut best = (0, f64::NEG_INFINITY);
    for i in 0..points {
        let value = f(argument(i)).0;
        if value > best.1 {
            best = (i, value);
        }
    }
    let i = best.0;
    let (left, right) = (argument(i.saturating_sub(1)), argument((i + 1).min(points - 1)));
    // At an end of the range the optimum may still lie inside the first or last interval.
    if i == 0 && f(low).1 <= 0.0 {
        return low;
    }
    if i == points - 1 && f(high).1 >= 0.0 {
        return high;
    }
    root(left, right, |x| f(x).1)
}

/// Point `i` of `points` in `[low, high]`, evenly spaced in the logarithm.
pub(crate) fn grid(low: f64, high: f64, points: u32, i: u32) -> f64 {
    if i + 1 == points { high } else { low * (high / low).powf(f64::from(i) / f64::from(points - 1)) }
}

/// Accuracy of [`root`], relative to the upper end of the bracket.
const ROOT_ACCURACY: f64 = 1e-14;

/// Root in `[low, high]` of a function that is positive at `low` and negative at `high`, by
/// interpolation, truncation and projection: as safe as bisection, a handful of calls on smooth
/// functions. A function without a change of sign gives an end of the bracket.
///
/// # Source
/// Oliveira & Takahashi, ACM Transactions on Mathematical Software 47 (2020) 5, with
/// kappa_1 = 0.2/(high - low), kappa_2 = 2, n_0 = 1 as recommended there.
pub(crate) fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut at_low, mut at_high) = (f(low), f(high));
    if !(at_low > 0.0 && at_high < 0.0) {
        return if at_low > 0.0 { high } else { low };
    }
    let accuracy = ROOT_ACCURACY * high;
    let width = high - low;
    let mut radius = accuracy * (width / accuracy).log2().ceil().max(0.0).exp2();
    while high - low > accuracy {
        let middle = 0.5 * (low + high);
        let falsi = (at_low * high - at_high * low) / (at_low - at_high);
        let side = (middle - falsi).signum();
        let truncation = 0.2 / width * (high - low).powi(2);
        let truncated = if truncation <= (middle - falsi).abs() { falsi + side * truncation } else { middle };
        let reach = radius - 0.5 * (high - low);
        let next = if (truncated - middle).abs() <= reach { truncated } else { middle - side * reach };
        // Rounding may put the point on an end of a tiny bracket.
        let next = if next > low && next < high { next } else { middle };
        if next <= low || next >= high {
            break;
        }
        let value = f(next);
        if value > 0.0 {
            (low, at_low) = (next, value);
        } else if value < 0.0 {
            (high, at_high) = (next, value);
        } else {
            return next;
        }
        radius *= 0.5;
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    #[test]
    fn a_root_costs_few_calls_and_is_exact() {
        let calls = Cell::new(0);
        let counted = |x: f64| {
            calls.set(calls.get() + 1);
            1.0 - x * x * x
        };
        assert!((root(0.2, 6.0, counted) - 1.0).abs() < 1e-13);
        assert!(calls.get() < 20, "{} calls", calls.get());
    }

    #[test]
    fn kinks_and_missing_roots_are_answered() {
        let kink = |x: f64| if x < 0.3 { 1.0 } else { -1e-9 };
        assert!((root(0.0, 1.0, kink) - 0.3).abs() < 1e-12);
        assert_eq!(root(0.0, 1.0, |_| 1.0), 1.0);
        assert_eq!(root(0.0, 1.0, |_| -1.0), 0.0);
    }
}
