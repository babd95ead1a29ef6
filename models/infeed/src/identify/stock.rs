//! The lag from stock.

use super::{Estimate, MeasurementErrors};
use crate::Trial;
use toolroom_process::{ModelError, Number};

/// Deflection at retraction over the infeed per revolution: `Σ K^j, j = m+1 … m+n`, for n
/// revolutions of infeed and m of spark-out.
pub(super) fn deflection_in_infeeds<N: Number>(lag: N, revolutions: f64, spark_out: f64) -> N {
    lag.powf(spark_out + 1.0) * (-lag.powf(revolutions) + 1.0) / (-lag + 1.0)
}

/// Standard deviation of the lag from the stock of one trial, by the errors of gauge, feed and
/// touch: `sd(K) = √(σ_P² + ((n − g) σ_S)² + (h_n σ_n)²) / (S dg/dK)` with
/// `g = K (1 − K^n)/(1 − K)`. A revolution more or less costs the last depth h_n of stock.
///
/// ```
/// use toolroom_infeed::{MeasurementErrors, lag_sd};
/// let sd = lag_sd(0.553, 4.43e-6, 12.0, 0.0, &MeasurementErrors::default());
/// assert!((sd - 0.0306676).abs() < 1e-7);
/// ```
pub fn lag_sd(lag: f64, infeed_per_rev: f64, revolutions: f64, spark_out: f64, errors: &MeasurementErrors) -> f64 {
    let stock_in_infeeds = revolutions - deflection_in_infeeds(lag, revolutions, spark_out);
    let last_depth = infeed_per_rev * (1.0 - lag.powf(revolutions + spark_out));
    let stock = errors.stock.hypot(stock_in_infeeds * errors.infeed_per_rev).hypot(last_depth * errors.revolutions);
    stock / (infeed_per_rev * deflection_slope(lag, revolutions, spark_out))
}

/// The lag K of one trial from its stock: the root of `P = S (n − K^(m+1) (1 − K^n)/(1 − K))`
/// for n revolutions of infeed S and m of spark-out, by bisection.
///
/// # Errors
/// [`ModelError::NoSolution`] unless `0 < P < n S`; the root is unique there.
///
/// # Source
/// Sizyi, Fesenko & Lyubimyi, eq. (7); spark-out by the recursion.
///
/// ```
/// let lag = toolroom_infeed::lag_from_stock(4.43e-6, 16.0, 0.0, 66e-6).unwrap();
/// assert!((lag - 0.524176).abs() < 1e-6);
/// ```
pub fn lag_from_stock(infeed_per_rev: f64, revolutions: f64, spark_out: f64, stock: f64) -> Result<f64, ModelError> {
    let deflection = revolutions - stock / infeed_per_rev;
    if !(deflection > 0.0 && deflection < revolutions && spark_out >= 0.0) {
        let reason = "the stock must lie between nothing and the commanded infeed";
        return Err(ModelError::NoSolution { quantity: "lag", reason });
    }
    Ok(root(|lag| deflection_in_infeeds(lag, revolutions, spark_out) - deflection, 0.0, 1.0))
}

/// Root of a rising function between `low` and `high`, to the last bit.
fn root(rising: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if rising(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Deflection at retraction, m, of a trial whose first stage has `more` revolutions: each stage adds its own, and what the
/// first leaves goes on falling under the second.
fn deflection<N: Number>(trial: &Trial, more: f64, lag: N) -> N {
    let (finish, rest) = (trial.finish_revolutions, trial.spark_out_revolutions);
    let first = deflection_in_infeeds(lag, trial.revolutions + more, finish + rest) * trial.infeed_per_rev;
    if finish == 0.0 {
        return first;
    }
    first + deflection_in_infeeds(lag, finish, rest) * trial.finish_infeed_per_rev
}

/// The lag of a trial with `more` revolutions in its first stage from its stock; `None` where no lag leaves that stock.
pub(super) fn lag_of(trial: &Trial, more: f64) -> Option<f64> {
    let (infeed, revolutions) = (trial.infeed_per_rev, trial.revolutions + more);
    if trial.finish_revolutions == 0.0 {
        return lag_from_stock(infeed, revolutions, trial.spark_out_revolutions, trial.stock_removed?).ok();
    }
    let commanded = infeed * revolutions + trial.finish_infeed_per_rev * trial.finish_revolutions;
    let due = commanded - trial.stock_removed?;
    (due > 0.0 && due < commanded).then(|| root(|lag| deflection(trial, more, lag) - due, 0.0, 1.0))
}

pub(super) fn estimate(trial: &Trial, errors: &MeasurementErrors) -> Option<Estimate> {
    let (infeed, revolutions, spark_out) = (trial.infeed_per_rev, trial.revolutions, trial.spark_out_revolutions);
    let value = lag_of(trial, 0.0)?;
    if trial.finish_revolutions == 0.0 {
        return Some(Estimate { value, sd: lag_sd(value, infeed, revolutions, spark_out, errors) });
    }
    // As for one stage: the errors of gauge and feed, and the last depth for a revolution more or less.
    let (finish, whole) = (trial.finish_infeed_per_rev, trial.finish_revolutions + spark_out);
    let last_depth = finish + (infeed - finish) * value.powf(trial.finish_revolutions);
    let fed = trial.stock_removed? / infeed * errors.infeed_per_rev;
    let stock =
        errors.stock.hypot(fed).hypot(last_depth * value.powf(whole - trial.finish_revolutions) * errors.revolutions);
    Some(Estimate { value, sd: stock / stock_slope(trial, value) })
}

/// One lag for the stock of all trials.
#[derive(Clone, Debug, PartialEq)]
pub struct Pooled {
    /// The lag of least squares, `argmin_K Σ (P_j − S_j (n_j − g))²`.
    pub lag: f64,
    /// Its 95 % interval by Student's t; none for a single trial.
    pub ci95: Option<[f64; 2]>,
    /// Standard deviation of the stock about the fit, m; none for a single trial.
    pub sd_stock: Option<f64>,
    /// Stock less its fit, m, one entry a trial.
    pub residuals: Vec<f64>,
}

/// Pooled estimate over possible trials that all have stock.
pub(super) fn pooled(trials: &[Trial]) -> Option<Pooled> {
    let lags: Vec<f64> = trials.iter().map(|trial| lag_of(trial, 0.0)).collect::<Option<_>>()?;
    let residual = |trial: &Trial, lag: f64| {
        let stock = trial.stock_removed.unwrap_or(f64::NAN);
        if trial.finish_revolutions > 0.0 {
            return stock - (trial.commanded_infeed() - deflection(trial, 0.0, lag));
        }
        let deflection = deflection_in_infeeds(lag, trial.revolutions, trial.spark_out_revolutions);
        stock - trial.infeed_per_rev * (trial.revolutions - deflection)
    };
    // Each residual rises through zero at the lag of its trial, so half the slope of the sum of
    // squares rises from below zero at the least lag to above zero at the greatest.
    let half_slope = |lag: f64| trials.iter().map(|trial| residual(trial, lag) * stock_slope(trial, lag)).sum::<f64>();
    let (least, most) = lags.iter().fold((1.0f64, 0.0f64), |(low, high), lag| (low.min(*lag), high.max(*lag)));
    let lag = root(half_slope, least, most);
    let residuals: Vec<f64> = trials.iter().map(|trial| residual(trial, lag)).collect();
    let freedom = trials.len() - 1;
    let sd_stock =
        (freedom > 0).then(|| (residuals.iter().map(|each| each * each).sum::<f64>() / freedom as f64).sqrt());
    let information = trials.iter().map(|trial| stock_slope(trial, lag).powi(2)).sum::<f64>();
    let ci95 = sd_stock.map(|sd| {
        let half = super::scatter::student(freedom) * sd / information.sqrt();
        [lag - half, lag + half]
    });
    Some(Pooled { lag, ci95, sd_stock, residuals })
}

/// −dP/dK of a trial.
fn stock_slope(trial: &Trial, lag: f64) -> f64 {
    use toolroom_process::num_dual::first_derivative;
    if trial.finish_revolutions > 0.0 {
        return first_derivative(|lag| deflection(trial, 0.0, lag), lag).1;
    }
    trial.infeed_per_rev * deflection_slope(lag, trial.revolutions, trial.spark_out_revolutions)
}

/// d/dK of [`deflection_in_infeeds`].
fn deflection_slope(lag: f64, revolutions: f64, spark_out: f64) -> f64 {
    use toolroom_process::num_dual::first_derivative;
    first_derivative(|lag| deflection_in_infeeds(lag, revolutions, spark_out), lag).1
}
