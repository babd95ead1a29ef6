//! The lag from the shape of the force: its rise under infeed, its decay in spark-out.

use super::{Estimate, MeasurementErrors, weighted};
use crate::{ForceSample, Trial};

/// The lag K from the revolutions in which the force has come to 95 %, `0.05^(1/n)`.
///
/// ```
/// assert!((toolroom_infeed::lag_from_rise(5.05696) - 0.553).abs() < 1e-6);
/// ```
pub fn lag_from_rise(rise_revolutions: f64) -> f64 {
    0.05f64.powf(1.0 / rise_revolutions)
}

/// The lag K from the share of the force that is left after `revolutions` of spark-out,
/// `share^(1/m)`. A threshold force is taken for lag.
///
/// ```
/// assert!((toolroom_infeed::lag_from_spark_out(0.0935191, 4.0) - 0.553).abs() < 1e-6);
/// ```
pub fn lag_from_spark_out(share: f64, revolutions: f64) -> f64 {
    share.powf(1.0 / revolutions)
}

/// What a recorded force says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceFit {
    /// Lag K.
    pub lag: Estimate,
    /// Force to which the rise tends, where there is one.
    pub steady_force: Option<f64>,
    /// Force to which spark-out tends: the threshold force.
    pub floor: Option<f64>,
}

/// Fits `a + b K^x` to the rise and `c + d K^x` to spark-out, with one K for both and free
/// a, b, c, d: neither a late start nor a zero error nor a threshold force falls into the lag.
/// Between whole revolutions the force runs straight, as constant infeed makes it.
///
/// `revolutions` is the end of infeed; the first revolution is left out, because contact may
/// begin within it. None where too few samples are left, or no lag fits better than its limits.
///
/// ```
/// use toolroom_infeed::{ForceSample, fit_force_trace};
/// let at = |i: i32| ForceSample { revolution: i.into(), force: 170.0 * (1.0 - 0.553f64.powi(i)) };
/// let fit = fit_force_trace(&(1..=10).map(at).collect::<Vec<_>>(), 10.0, 2.0).unwrap();
/// assert!((fit.lag.value - 0.553).abs() < 1e-6);
/// ```
pub fn fit_force_trace(samples: &[ForceSample], revolutions: f64, force_error: f64) -> Option<ForceFit> {
    let rise: Vec<ForceSample> =
        samples.iter().filter(|sample| (1.0..=revolutions).contains(&sample.revolution)).copied().collect();
    let decay: Vec<ForceSample> = samples
        .iter()
        .filter(|sample| sample.revolution > revolutions)
        .map(|sample| ForceSample { revolution: sample.revolution - revolutions, ..*sample })
        .collect();
    // Two numbers describe a block; one with no more samples says nothing of the lag.
    let blocks: Vec<&[ForceSample]> = [&rise[..], &decay[..]].into_iter().filter(|block| block.len() > 2).collect();
    let used: usize = blocks.iter().map(|block| block.len()).sum();
    let freedom = used.checked_sub(2 * blocks.len() + 1).filter(|freedom| *freedom > 0 && used > 0)?;
    let misfit = |lag: f64| blocks.iter().map(|block| Line::through(block, lag).squares).sum::<f64>();
    let lag = least(misfit)?;
    let step = (1e-3 * lag).min(1e-3 * (1.0 - lag));
    let curvature = (misfit(lag + step) - 2.0 * misfit(lag) + misfit(lag - step)) / (step * step);
    let variance = (misfit(lag) / freedom as f64).max(force_error * force_error);
    if curvature <= 0.0 {
        return None;
    }
    let end = |block: &[ForceSample]| (block.len() > 2).then(|| Line::through(block, lag).end);
    Some(ForceFit {
        lag: Estimate { value: lag, sd: (2.0 * variance / curvature).sqrt() },
        steady_force: end(&rise),
        floor: end(&decay),
    })
}

/// The straight line `end + slope φ(x)` through a block of samples, where φ is `K^x` at whole
/// revolutions and straight between them.
struct Line {
    end: f64,
    squares: f64,
}

impl Line {
    fn through(block: &[ForceSample], lag: f64) -> Self {
        let n = block.len() as f64;
        let (mut x1, mut y1, mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        // Powers advance with the sorted samples instead of being taken anew for each.
        let (mut whole, mut power) = (0.0, 1.0);
        for sample in block {
            while sample.revolution >= whole + 1.0 {
                whole += 1.0;
                power *= lag;
            }
            let part = sample.revolution - whole;
            let x = power * (1.0 - part + part * lag);
            x1 += x;
            y1 += sample.force;
            xx += x * x;
            xy += x * sample.force;
            yy += sample.force * sample.force;
        }
        let (xx, xy, yy) = (xx - x1 * x1 / n, xy - x1 * y1 / n, yy - y1 * y1 / n);
        let slope = if xx > 0.0 { xy / xx } else { 0.0 };
        Self { end: (y1 - slope * x1) / n, squares: (yy - slope * xy).max(0.0) }
    }
}

/// The lag of least misfit: a scan of the open interval, then golden sections. None where the
/// least lies at its ends.
pub(crate) fn least(misfit: impl Fn(f64) -> f64) -> Option<f64> {
    const SCAN: usize = 200;
    let lag = |i: usize| i as f64 / SCAN as f64;
    let values: Vec<f64> = (1..SCAN).map(|i| misfit(lag(i))).collect();
    let (least, _) = values.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1))?;
    if least == 0 || least == values.len() - 1 {
        return None;
    }
    let (mut low, mut high) = (lag(least), lag(least + 2));
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
    let (mut fa, mut fb) = (misfit(a), misfit(b));
    while high - low > 1e-12 {
        if fa < fb {
            (high, b, fb) = (b, a, fa);
            a = high - golden * (high - low);
            fa = misfit(a);
        } else {
            (low, a, fa) = (a, b, fb);
            b = low + golden * (high - low);
            fb = misfit(b);
        }
    }
    Some(0.5 * (low + high))
}

/// The lag of a trial from its recorded force, else from the 95 % rise and the force that
/// spark-out leaves.
pub(super) fn estimate(trial: &Trial, errors: &MeasurementErrors) -> Option<Estimate> {
    // Behind the first stage a finish stage holds the force up: only the rise tells the lag by itself.
    let single = trial.finish_revolutions == 0.0;
    let within = |sample: &&ForceSample| single || sample.revolution <= trial.revolutions;
    let trace: Vec<ForceSample> = trial.force_trace.iter().filter(within).copied().collect();
    if let Some(fit) = fit_force_trace(&trace, trial.revolutions, errors.force) {
        return Some(fit.lag);
    }
    let rise = trial.rise_revolutions.map(|revolutions| {
        let value = lag_from_rise(revolutions);
        Estimate { value, sd: value * -(0.05f64.ln()) / (revolutions * revolutions) * errors.revolutions }
    });
    let spark_out =
        trial.force_after_spark_out.zip(trial.normal_force).filter(|_| single && trial.spark_out_revolutions > 0.0);
    let decay = spark_out.map(|(after, steady)| {
        let value = lag_from_spark_out(after / steady, trial.spark_out_revolutions);
        let relative = (errors.force / after).hypot(errors.force / steady);
        Estimate { value, sd: value * relative / trial.spark_out_revolutions }
    });
    match (rise, decay) {
        (Some(rise), Some(decay)) => Some(weighted(rise, decay)),
        (one, other) => one.or(other),
    }
}
