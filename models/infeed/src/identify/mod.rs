//! Lag and stiffnesses of machine and process from plunge trials.

mod advice;
mod force;
mod joint;
mod scatter;
mod stock;

pub(crate) use force::least;

pub use advice::{Advice, revolutions_of_least_error};
pub use force::{ForceFit, fit_force_trace, lag_from_rise, lag_from_spark_out};
pub use joint::Joint;
pub use scatter::{Bootstrap, Scatter};
pub use stock::{Pooled, lag_from_stock, lag_sd};

use crate::basis::Basis;
use crate::{Trial, TrialFault, stiffness_from_k};
use toolroom_process::record;

record! {
    /// Standard deviations of what is measured. Defaults: a gauge with a graduation of 1 um, a
    /// feed to 0.01 um/rev, contact found to 0.1 revolution, force to 2 N.
    ///
    /// # Source
    /// Assumption; the stock scatters by 0.7 um in the trials of Sizyi, Fesenko & Lyubimyi.
    pub struct MeasurementErrors {
        /// Stock.
        stock: Real["m" => "um"] = 0.5e-6, 0.0..=1e-3;
        /// Infeed per revolution.
        infeed_per_rev: Real["m" => "um"] = 0.01e-6, 0.0..=1e-4;
        /// Start of contact, revolutions.
        revolutions: Real = 0.1, 0.0..=10.0;
        /// Force.
        force: Real["N" => "N"] = 2.0, 0.0..=1e4;
    }
}

/// How to identify.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdentifyOptions {
    /// What the lag is taken from.
    pub basis: Basis,
    /// Bootstrap resamples, where there are too many trials to enumerate all.
    pub resamples: usize,
    /// Seed of the resampling.
    pub seed: u64,
    /// Errors of the measurement.
    pub errors: MeasurementErrors,
    /// Whether one impossible trial refuses all; else it is left out by name.
    pub strict: bool,
}

impl Default for IdentifyOptions {
    fn default() -> Self {
        Self { basis: Basis::Both, resamples: 10_000, seed: 1, errors: MeasurementErrors::default(), strict: false }
    }
}

/// A number with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Standard deviation by the errors of the measurement.
    pub sd: f64,
}

/// What one trial says.
#[derive(Clone, Debug, PartialEq)]
pub struct TrialLag {
    /// Name of the trial.
    pub trial_id: String,
    /// Lag K.
    pub lag: Estimate,
    /// Lag from the stock.
    pub from_stock: Option<Estimate>,
    /// Lag from rise and spark-out of the force.
    pub from_force: Option<Estimate>,
    /// Process stiffness Cp = P_y/(S (1 − K^n)), N/m: after n revolutions the force has come to 1 − K^n of its end.
    pub process_stiffness: Option<f64>,
    /// System stiffness J = Cp (1 − K)/K, N/m.
    pub system_stiffness: Option<f64>,
    /// Force ratio P_z/P_y.
    pub force_ratio: Option<f64>,
}

/// Mean lag and stiffness if every trial had another number of revolutions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shifted {
    /// Revolutions added to each trial.
    pub revolutions: f64,
    /// Lags of the trials.
    pub lag: Scatter,
    /// System stiffnesses of the trials, N/m.
    pub system_stiffness: Option<Scatter>,
}

/// Number of revolutions at which stock tells most of the lag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestRevolutions {
    /// Revolutions.
    pub revolutions: u32,
    /// Standard deviation of the lag from one trial of that length.
    pub lag_sd: f64,
}

/// All that the trials say.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// One entry a trial that is possible.
    pub trials: Vec<TrialLag>,
    /// Trials that cannot be and say nothing here, and why.
    pub left_out: Vec<ImpossibleTrial>,
    /// Lag K over the trials.
    pub lag: Scatter,
    /// Process stiffness over the trials, N/m.
    pub process_stiffness: Option<Scatter>,
    /// System stiffness over the trials, N/m.
    pub system_stiffness: Option<Scatter>,
    /// Bootstrap of the mean lag; none for a single trial.
    pub bootstrap: Option<Bootstrap>,
    /// Mean lag without each trial in turn; empty for a single trial.
    pub jackknife: Vec<f64>,
    /// One lag for the stock of all trials; none where a trial has no stock.
    pub pooled: Option<Pooled>,
    /// One machine and one process fitted to every stock and force; none where they do not tell both stiffnesses.
    pub joint: Option<Joint>,
    /// The systematic error of stock: half a revolution less and half a revolution more; none
    /// where the lag is not from stock, or where a trial would become impossible.
    pub half_revolution: [Option<Shifted>; 2],
    /// Length of trial that would tell most.
    pub best: BestRevolutions,
    /// What is wrong with the protocol, and what to do; empty if nothing is.
    pub advice: Vec<Advice>,
}

/// A trial that cannot be.
#[derive(Clone, Debug, PartialEq)]
pub struct ImpossibleTrial {
    /// Name of the trial.
    pub trial_id: String,
    /// Line of the file.
    pub line: Option<usize>,
    /// Why.
    pub fault: TrialFault,
}

impl std::fmt::Display for ImpossibleTrial {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "trial `{}`", self.trial_id)?;
        if let Some(line) = self.line {
            write!(f, " (line {line})")?;
        }
        write!(f, ": {}", self.fault)
    }
}

/// Why trials were refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IdentifyError {
    /// There is none.
    #[error("there is no trial")]
    NoTrials,
    /// Trials that cannot be: one entry a fault.
    #[error("{}", .trials.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Impossible {
        /// Which, and why.
        trials: Vec<ImpossibleTrial>,
    },
}

/// Identifies lag and stiffnesses from plunge trials.
///
/// Each trial gives `K` as the root of `P = S (n − K (1 − K^n)/(1 − K))` or from the shape of
/// its force, `Cp = P_y/(S (1 − K^n))` and `J = Cp (1 − K)/K`. Intervals hold at 95 %. A trial that cannot be is left out
/// by name and reason, and the others go on.
///
/// # Errors
/// [`IdentifyError::Impossible`] with every impossible trial by name, where no other is left or `strict` is set.
///
/// # Source
/// Sizyi, Fesenko & Lyubimyi, eqs. (3), (4), (6), (7); J by eq. (3), which eq. (8) contradicts.
///
/// ```
/// use toolroom_infeed::{IdentifyOptions, identify, paper_trials};
/// let found = identify(&paper_trials(), &IdentifyOptions::default()).unwrap();
/// assert!((found.lag.mean - 0.552914).abs() < 1e-6);
/// ```
pub fn identify(trials: &[Trial], options: &IdentifyOptions) -> Result<Identification, IdentifyError> {
    if trials.is_empty() {
        return Err(IdentifyError::NoTrials);
    }
    let mut lags = Vec::with_capacity(trials.len());
    let mut impossible = Vec::new();
    for trial in trials {
        match trial_lag(trial, options) {
            Ok(lag) => lags.push(lag),
            Err(faults) => impossible.extend(faults.into_iter().map(|fault| ImpossibleTrial {
                trial_id: trial.trial_id.clone(),
                line: trial.line,
                fault,
            })),
        }
    }
    if lags.is_empty() || (options.strict && !impossible.is_empty()) {
        return Err(IdentifyError::Impossible { trials: impossible });
    }
    let possible = |trial: &&Trial| lags.iter().any(|lag| lag.trial_id == trial.trial_id);
    let trials: Vec<Trial> = trials.iter().filter(possible).cloned().collect();
    let trials = trials.as_slice();
    let values: Vec<f64> = lags.iter().map(|trial| trial.lag.value).collect();
    let all = |of: fn(&TrialLag) -> Option<f64>| -> Option<Scatter> {
        let values: Option<Vec<f64>> = lags.iter().map(of).collect();
        Some(Scatter::of(&values?))
    };
    let by_stock = lags.iter().all(|trial| trial.from_stock.is_some());
    let (process, system) = (all(|trial| trial.process_stiffness), all(|trial| trial.system_stiffness));
    // With one sort of readings left out, not every reading counts.
    let joint = process
        .zip(system)
        .filter(|_| options.basis == Basis::Both)
        .and_then(|(process, system)| joint::joint(trials, [process.median, system.median], &options.errors));
    let lag = Scatter::of(&values);
    let shifted = |revolutions| if by_stock { shifted(trials, revolutions) } else { None };
    let infeed_per_rev = trials.iter().map(|trial| trial.infeed_per_rev).sum::<f64>() / trials.len() as f64;
    let mut found = Identification {
        process_stiffness: process,
        system_stiffness: system,
        joint,
        bootstrap: scatter::bootstrap(&values, options.resamples, options.seed),
        jackknife: scatter::jackknife(&values),
        pooled: if by_stock { stock::pooled(trials) } else { None },
        half_revolution: [shifted(-0.5), shifted(0.5)],
        best: revolutions_of_least_error(lag.mean, infeed_per_rev, &options.errors),
        advice: Vec::new(),
        left_out: impossible,
        trials: lags,
        lag,
    };
    found.advice = advice::advice(trials, &found);
    Ok(found)
}

/// The five trials of the paper that the model follows.
///
/// # Source
/// Sizyi, Fesenko & Lyubimyi, table 1 (its first force column is P_y, as the text uses it).
pub fn paper_trials() -> Vec<Trial> {
    const ROWS: [(f64, f64, f64, f64, f64); 5] = [
        (4.43, 66.0, 16.0, 170.0, 80.0),
        (4.42, 64.0, 16.0, 165.0, 78.0),
        (4.46, 75.0, 18.0, 171.0, 82.0),
        (4.44, 70.0, 17.0, 171.0, 80.0),
        (4.30, 68.0, 17.0, 155.0, 72.0),
    ];
    let trial = |(id, (infeed, stock, revolutions, normal, tangential)): (usize, _)| Trial {
        trial_id: id.to_string(),
        machine: Some("3B153U".to_owned()),
        infeed_per_rev: infeed * 1e-6,
        revolutions,
        work_rotation_speed: Some(292.0 / 60.0 * std::f64::consts::TAU),
        stock_removed: Some(stock * 1e-6),
        normal_force: Some(normal),
        tangential_force: Some(tangential),
        ..Trial::default()
    };
    (1..).zip(ROWS).map(trial).collect()
}

fn trial_lag(trial: &Trial, options: &IdentifyOptions) -> Result<TrialLag, Vec<TrialFault>> {
    let faults = trial.faults();
    if !faults.is_empty() {
        return Err(faults);
    }
    let from_stock = match options.basis {
        Basis::Force => None,
        Basis::Both | Basis::Stock => stock::estimate(trial, &options.errors),
    };
    let from_force = match options.basis {
        Basis::Stock => None,
        Basis::Both | Basis::Force => force::estimate(trial, &options.errors),
    };
    let lag = match (from_stock, from_force) {
        (Some(stock), Some(force)) => weighted(stock, force),
        (Some(one), None) | (None, Some(one)) => one,
        (None, None) => return Err(vec![TrialFault::NoLag { basis: options.basis }]),
    };
    let process_stiffness = process_stiffness(trial, lag.value, 0.0);
    Ok(TrialLag {
        trial_id: trial.trial_id.clone(),
        lag,
        from_stock,
        from_force,
        process_stiffness,
        system_stiffness: process_stiffness.map(|stiffness| stiffness_from_k(stiffness, lag.value)),
        force_ratio: trial.tangential_force.zip(trial.normal_force).map(|(tangential, normal)| tangential / normal),
    })
}

/// Cp of a trial, N/m, if it had `more` revolutions: its force has come to `1 − K^n` of its end.
fn process_stiffness(trial: &Trial, lag: f64, more: f64) -> Option<f64> {
    let reached = 1.0 - lag.powf(trial.revolutions + more);
    trial.normal_force.map(|force| force / (trial.infeed_per_rev * reached))
}

/// Mean weighted by the inverse variances.
fn weighted(a: Estimate, b: Estimate) -> Estimate {
    let (wa, wb) = (1.0 / (a.sd * a.sd), 1.0 / (b.sd * b.sd));
    Estimate { value: (wa * a.value + wb * b.value) / (wa + wb), sd: 1.0 / (wa + wb).sqrt() }
}

/// The stock's mean lag with `revolutions` more in each trial.
fn shifted(trials: &[Trial], revolutions: f64) -> Option<Shifted> {
    let lags: Option<Vec<f64>> = trials.iter().map(|trial| stock::lag_of(trial, revolutions)).collect();
    let lags = lags?;
    let stiffness =
        |(trial, lag): (&Trial, &f64)| Some(stiffness_from_k(process_stiffness(trial, *lag, revolutions)?, *lag));
    let stiffnesses: Option<Vec<f64>> = trials.iter().zip(&lags).map(stiffness).collect();
    Some(Shifted {
        revolutions,
        lag: Scatter::of(&lags),
        system_stiffness: stiffnesses.map(|values| Scatter::of(&values)),
    })
}

impl Identification {
    /// The systematic error of stock read half a revolution wrong, as lags from−to.
    ///
    /// Whether the gauge reads the high side of the spiral, its mean or the low side is a matter
    /// of definition that no repetition removes; it is therefore never added to the interval of
    /// the scatter.
    pub fn half_revolution_range(&self) -> Option<[f64; 2]> {
        let [less, more] = &self.half_revolution;
        Some([less.as_ref()?.lag.mean, more.as_ref()?.lag.mean])
    }

    /// The same trials with `revolutions` more each: the effect of another definition of n.
    pub fn shifted(trials: &[Trial], revolutions: f64) -> Option<Shifted> {
        shifted(trials, revolutions)
    }
}
