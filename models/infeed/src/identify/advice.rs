//! How well a protocol tells the lag, and how to do better.

use super::stock::lag_sd;
use super::{BestRevolutions, Identification, MeasurementErrors};
use crate::Trial;
use crate::trial::Rounded;

/// Revolutions, without spark-out, at which the stock of one trial tells most of the lag.
///
/// ```
/// use toolroom_infeed::{MeasurementErrors, revolutions_of_least_error};
/// assert_eq!(revolutions_of_least_error(0.553, 4.43e-6, &MeasurementErrors::default()).revolutions, 12);
/// ```
pub fn revolutions_of_least_error(lag: f64, infeed_per_rev: f64, errors: &MeasurementErrors) -> BestRevolutions {
    // Far beyond the end of the transient nothing is learnt any more.
    let longest = (20.0 + 10.0 * settled(lag)).clamp(20.0, 1e4) as u32;
    let sd = |revolutions: u32| lag_sd(lag, infeed_per_rev, f64::from(revolutions), 0.0, errors);
    let sds = (2..=longest).map(|revolutions| BestRevolutions { revolutions, lag_sd: sd(revolutions) });
    let first = BestRevolutions { revolutions: 2, lag_sd: sd(2) };
    sds.fold(first, |best, each| if each.lag_sd < best.lag_sd { each } else { best })
}

/// Revolutions after which the transient is at 98 %.
fn settled(lag: f64) -> f64 {
    0.02f64.ln() / lag.ln()
}

/// A weakness of a protocol, and its cure.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Advice {
    /// The lag cannot be told from these trials.
    #[error(
        "the lag is not identified: its 95 % half width {half_width:.3} leaves the system stiffness unknown to \
         {stiffness:.0} %; record the force and add a spark-out: its decay gives the lag without stock, infeed or revolutions"
    )]
    NotIdentified {
        /// Half width of the interval of the lag.
        half_width: Rounded,
        /// Relative half width of the stiffness, %.
        stiffness: Rounded,
    },
    /// No scatter can be seen.
    #[error("a single trial shows no scatter; repeat it, three times at least")]
    SingleTrial,
    /// The definition of n matters more than the scatter.
    #[error(
        "half a revolution more or less moves the lag by {less:.3} to {more:.3}, scatter by {scatter:.3} only; find contact \
         with the spindle encoder, and gauge at the angle of retraction or after one revolution of spark-out"
    )]
    HalfRevolution {
        /// Change by half a revolution less.
        less: Rounded,
        /// Change by half a revolution more.
        more: Rounded,
        /// 95 % half width by scatter or, where that is more, by the errors of the measurement.
        scatter: Rounded,
    },
    /// All trials have about the same length.
    #[error(
        "all trials have {least} to {most} revolutions: wheel wear, feed scale and a late start look like lag; grind \
         4, 8, 16 and 30 revolutions"
    )]
    OneLength {
        /// Least revolutions.
        least: Rounded,
        /// Most revolutions.
        most: Rounded,
    },
    /// Trials far from the best length.
    #[error(
        "the trials are shorter than the {settled} revolutions of the transient; the best length is {best} revolutions"
    )]
    TooShort {
        /// Revolutions to 98 %.
        settled: Rounded,
        /// Best revolutions.
        best: u32,
    },
    /// Stiffnesses are not known.
    #[error("without normal_force the lag alone is known; measure it for the stiffnesses of process and system")]
    NoForce,
    /// Stock and force contradict each other.
    #[error(
        "stock says {stock:.4}, force {force:.4}, {z:.1} standard deviations apart: start of contact, stock by another \
         definition, wheel wear or a threshold force"
    )]
    StockAgainstForce {
        /// Mean lag from stock.
        stock: Rounded,
        /// Mean lag from force.
        force: Rounded,
        /// Their distance in standard deviations.
        z: Rounded,
    },
    /// Several machines in one set.
    #[error("the trials are of several machines ({machines}): their mean is of no machine; identify each alone")]
    SeveralMachines {
        /// Their names.
        machines: String,
    },
}

/// Relative half width of J above which it counts as not identified (assumption).
const UNKNOWN_STIFFNESS: f64 = 0.5;
/// Standard deviations apart at which two sources contradict each other.
const CONTRADICTION: f64 = 3.0;
/// Ratio of longest to shortest trial below which all have one length (assumption).
const ONE_LENGTH: f64 = 1.5;

pub(super) fn advice(trials: &[Trial], identification: &Identification) -> Vec<Advice> {
    let mut advice = Vec::new();
    let lag = identification.lag.mean;
    let measured =
        identification.trials.iter().map(|trial| trial.lag.sd.powi(2)).sum::<f64>().sqrt() / trials.len() as f64;
    let by_scatter = identification.lag.ci95.map(|[low, high]| 0.5 * (high - low));
    // Trials may agree by chance better than their errors allow.
    let half_width = by_scatter.unwrap_or(0.0).max(2.0 * measured);
    // dJ/J = dK/(K (1 − K)).
    let stiffness = half_width / (lag * (1.0 - lag));
    if stiffness.is_nan() || stiffness > UNKNOWN_STIFFNESS {
        let stiffness = Rounded(100.0 * stiffness);
        advice.push(Advice::NotIdentified { half_width: Rounded(half_width), stiffness });
    }
    if trials.len() == 1 {
        advice.push(Advice::SingleTrial);
    }
    // The force tells its lag without a count of revolutions.
    let by_stock_alone = identification.trials.iter().all(|trial| trial.from_force.is_none());
    if let Some([less, more]) = identification.half_revolution_range().filter(|_| by_stock_alone)
        && (lag - less).max(more - lag) > half_width
    {
        let (less, more) = (Rounded(less - lag), Rounded(more - lag));
        advice.push(Advice::HalfRevolution { less, more, scatter: Rounded(half_width) });
    }
    let lengths = || trials.iter().map(|trial| trial.revolutions);
    let (least, most) = (lengths().fold(f64::INFINITY, f64::min), lengths().fold(0.0, f64::max));
    let by_stock = identification.trials.iter().all(|trial| trial.from_stock.is_some());
    if by_stock && trials.len() > 1 && most < ONE_LENGTH * least {
        advice.push(Advice::OneLength { least: Rounded(least), most: Rounded(most) });
    }
    if by_stock && most < settled(lag) {
        advice.push(Advice::TooShort { settled: Rounded(settled(lag).ceil()), best: identification.best.revolutions });
    }
    if identification.process_stiffness.is_none() {
        advice.push(Advice::NoForce);
    }
    advice.extend(contradiction(identification));
    let mut machines: Vec<&str> = trials.iter().filter_map(|trial| trial.machine.as_deref()).collect();
    machines.sort_unstable();
    machines.dedup();
    if machines.len() > 1 {
        advice.push(Advice::SeveralMachines { machines: machines.join(", ") });
    }
    advice
}

/// Stock against force over the trials that have both.
fn contradiction(identification: &Identification) -> Option<Advice> {
    let both = || identification.trials.iter().filter_map(|trial| trial.from_stock.zip(trial.from_force));
    let n = both().count() as f64;
    let (stock, force, variance) = both().fold((0.0, 0.0, 0.0), |(stock, force, variance), (a, b)| {
        (stock + a.value / n, force + b.value / n, variance + (a.sd * a.sd + b.sd * b.sd) / (n * n))
    });
    let z = (stock - force).abs() / variance.sqrt();
    (z > CONTRADICTION).then_some(Advice::StockAgainstForce {
        stock: Rounded(stock),
        force: Rounded(force),
        z: Rounded(z),
    })
}
