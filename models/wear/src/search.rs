//! Searches over cutting speed.

/// The argument in `[low, high]` at which a function of one variable is greatest: the best of
/// `points` spaced evenly in the logarithm, then the root of the slope beside it.
///
/// `f` gives the value and something with the sign of its slope. Where the best point is an
/// end of the range, that end is the answer.
pub(crate) fn greatest(low: f64, high: f64, points: u32, f: impl Fn(f64) -> (f64, f64)) -> f64 {
    let at = |i: u32| grid(low, high, points, i);
    let mut best = (0, f64::NEG_INFINITY);
    for i in 0..points {
        let value = f(at(i)).0;
        if value > best.1 {
            best = (i, value);
        }
    }
    let i = best.0;
    let (left, right) = (at(i.saturating_sub(1)), at((i + 1).min(points - 1)));
    // At an end of the range the optimum may still lie inside the first or last interval.
    if i == 0 && f(low).1 <= 0.0 {
        return low;
    }
    if i == points - 1 && f(high).1 >= 0.0 {
        return high;
    }
    bisect(left, right, |x| f(x).1)
}

/// Point `i` of `points` in `[low, high]`, evenly spaced in the logarithm.
pub(crate) fn grid(low: f64, high: f64, points: u32, i: u32) -> f64 {
    if i + 1 == points { high } else { low * (high / low).powf(f64::from(i) / f64::from(points - 1)) }
}

/// Root in `[low, high]` of a function that is positive at `low` and negative at `high`, to 1e-14.
pub(crate) fn bisect(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..60 {
        if high - low <= 1e-14 * high {
            break;
        }
        let middle = 0.5 * (low + high);
        if f(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
