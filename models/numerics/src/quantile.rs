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
