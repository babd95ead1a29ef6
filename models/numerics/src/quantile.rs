//! Quantiles of samples.

/// The value below which a `share` (0 to 1) of ascending values lies, linear between neighbours; NaN
/// without values.
///
/// # Source
/// Type 7 of R. J. Hyndman, Y. Fan, The American Statistician 50 (1996) 361.
///
/// # Examples
/// ```
/// use toolroom_numerics::order_quantile;
/// assert_eq!(order_quantile(&[1.0, 2.0, 4.0], 0.75), 3.0);
/// assert!(order_quantile(&[], 0.5).is_nan());
/// ```
pub fn order_quantile(ascending: &[f64], share: f64) -> f64 {
    let Some(last) = ascending.len().checked_sub(1) else { return f64::NAN };
    let place = share * last as f64;
    let below = (place.floor() as usize).min(last);
    let above = (below + 1).min(last);
    ascending[below] + (place - below as f64) * (ascending[above] - ascending[below])
}

/// The least of ascending values that a `share` (0 to 1) of them do not exceed: one of the values, never one between two; NaN
/// without values.
///
/// # Source
/// Type 1 of R. J. Hyndman, Y. Fan, The American Statistician 50 (1996) 361: the inverse of the empirical distribution.
///
/// # Examples
/// ```
/// use toolroom_numerics::rank_quantile;
/// assert_eq!(rank_quantile(&[1.0, 2.0, 4.0], 0.5), 2.0);
/// assert_eq!(rank_quantile(&[1.0, 2.0, 4.0], 0.95), 4.0);
/// assert!(rank_quantile(&[], 0.5).is_nan());
/// ```
pub fn rank_quantile(ascending: &[f64], share: f64) -> f64 {
    let place = (share * ascending.len() as f64).ceil() as usize;
    ascending.get(place.max(1) - 1).copied().unwrap_or(f64::NAN)
}
