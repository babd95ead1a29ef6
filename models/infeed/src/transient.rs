//! The lag in closed form: stock, revolutions, time constants.

use toolroom_process::Number;

/// Stock removed after `revolutions` of constant infeed from rest,
/// `P = S (n − K (1 − K^n)/(1 − K))`.
///
/// # Source
/// Sizyi, Fesenko & Lyubimyi, eq. (6).
///
/// ```
/// let stock = toolroom_infeed::stock_after(4.43e-6, 16.0, 0.553);
/// assert!((stock / 65.3999e-6 - 1.0f64).abs() < 1e-6);
/// ```
pub fn stock_after<N: Number>(infeed_per_rev: N, revolutions: N, lag: N) -> N {
    infeed_per_rev * (revolutions - lag * (-lag.powd(revolutions) + 1.0) / (-lag + 1.0))
}

/// Revolutions after which a step response has come to `share` of its end,
/// `n = ln(1 − share)/ln K`.
///
/// ```
/// assert!((toolroom_infeed::revolutions_to(0.95, 0.553) - 5.05696f64).abs() < 1e-5);
/// ```
pub fn revolutions_to<N: Number>(share: N, lag: N) -> N {
    (-share + 1.0).ln() / lag.ln()
}

/// What is left after `revolutions` of a deviation of the surface that returns at the same
/// place each revolution (a step, or waviness with a whole number of lobes), `e K^n`.
///
/// ```
/// let left = toolroom_infeed::deviation_after(20e-6, 4.0, 0.553);
/// assert!((left - 1.87038e-6f64).abs() < 1e-11);
/// ```
pub fn deviation_after<N: Number>(deviation: N, revolutions: N, lag: N) -> N {
    deviation * lag.powd(revolutions)
}

/// Time constant that matches the steady lag behind a ramp, `T K/(1 − K) = Cp/(J n_w)`, the
/// "grinding time constant" of the literature. `rotation_period` is T = 1/n_w.
///
/// ```
/// let tau = toolroom_infeed::lag_time_constant(60.0 / 292.0, 0.553);
/// assert!((tau - 0.254206f64).abs() < 1e-6);
/// ```
pub fn lag_time_constant<N: Number>(rotation_period: N, lag: N) -> N {
    rotation_period * lag / (-lag + 1.0)
}

/// Time constant that matches the decay in spark-out, `−T/ln K`. It exceeds
/// [`lag_time_constant`] by about half a revolution.
///
/// ```
/// let tau = toolroom_infeed::decay_time_constant(60.0 / 292.0, 0.553);
/// assert!((tau - 0.346861f64).abs() < 1e-6);
/// ```
pub fn decay_time_constant<N: Number>(rotation_period: N, lag: N) -> N {
    -rotation_period / lag.ln()
}
