//! Modes from measured frequency responses: selection, refinement, uncertainty.

mod columns;
mod search;

use crate::error::DynamicsError;
use crate::fitted_mode::{Estimate, FittedMode};
use crate::frf::Measurement;
use crate::likelihood::{Likelihood, Maximum, RealMode};
use crate::noise::noise_of_hits;
use crate::quality::Quality;
use crate::selection;
use crate::stabilisation::{Pole, stabilisation};
use nalgebra::{Complex, DMatrix};
use search::Search;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Least number of lines for a fit (assumption).
const LEAST_LINES: usize = 20;
/// Greatest number of modes that are found without being requested (assumption).
const MOST_MODES: usize = 12;

/// What the user of a fit decides.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FitOptions {
    /// Averages behind each function; the file's, if left out. Where neither tells, the residuals give the scale.
    pub averages: Option<u32>,
    /// Number of modes, instead of all that are significant.
    pub modes: Option<usize>,
    /// Frequencies (Hz) of the modes to be fitted, instead of all that are significant.
    pub picks: Vec<f64>,
    /// Direction in the plane of the cut of a measurement in one direction; x, if left out.
    pub direction: Option<[f64; 2]>,
}

/// What a fit has found.
#[derive(Clone, Debug)]
pub struct Fit {
    /// Modes by ascending frequency.
    pub modes: Vec<FittedMode>,
    /// Compliance (m/N) of all modes above the range, by name of the pair of directions.
    pub upper: Vec<(&'static str, Estimate)>,
    /// Covariance of natural frequency (Hz), damping ratio and stiffness (N/m) of the first mode, of the second, …
    pub covariance: Vec<Vec<f64>>,
    /// How well the fit describes the measurement, and whether it may be used.
    pub quality: Quality,
    /// Poles of the stabilisation diagram.
    pub poles: Vec<Pole>,
    /// The fitted response (m/N) of every function at every line.
    pub fitted: Vec<Vec<Complex<f64>>>,
}

impl Fit {
    /// Natural frequencies (Hz) of the modes.
    fn frequencies(&self) -> Vec<f64> {
        self.modes.iter().map(|mode| mode.natural_frequency.value).collect()
    }
}

/// Names of pairs of directions by their place among the residuals.
const PAIRS: [&str; 3] = ["xx", "xy", "yy"];

/// Fits real modes to what was measured.
///
/// Columns of poles that are stable over the order of a common denominator are the first modes. All are refined to the
/// greatest likelihood; a mode whose residue differs from zero by less than six standard deviations goes, and further stable
/// poles join where they explain most of what is left, as long as they stand out as much. Variances are those of Bendat and
/// Piersol, `|H|² (1 − γ²)/(2 n γ²)` for real and imaginary part, with the fitted modulus.
///
/// # Errors
/// [`DynamicsError::TooFewLines`], [`DynamicsError::NoDirect`] and [`DynamicsError::NoModes`];
/// [`DynamicsError::Selection`] where the modes that the options ask for are not there. A fit that should not be used is returned
/// with its [`Quality::refusals`].
pub fn fit(measured: &Measurement, options: &FitOptions) -> Result<Fit, DynamicsError> {
    let mut found = as_told(measured, options).map_err(|error| columns::explained(measured, options, error))?;
    columns::tell(measured, options, &mut found);
    let standing_out = || {
        let all = FitOptions { modes: None, picks: Vec::new(), ..options.clone() };
        as_told(measured, &all).map_or_else(|_| Vec::new(), |all| all.frequencies())
    };
    match selection::unmet(&found.frequencies(), options.modes, &options.picks, standing_out) {
        Some(problem) => Err(DynamicsError::Selection { file: measured.source.clone(), problem }),
        None => Ok(found),
    }
}

/// The fit of a measurement whose columns are what their names say.
fn as_told(measured: &Measurement, options: &FitOptions) -> Result<Fit, DynamicsError> {
    let file = || measured.source.clone();
    let lines = measured.frequencies.len();
    if lines < LEAST_LINES {
        return Err(DynamicsError::TooFewLines { file: file(), lines, least: LEAST_LINES });
    }
    if !measured.functions.iter().any(|function| function.is_direct()) {
        return Err(DynamicsError::NoDirect { file: file() });
    }
    selection::check(&measured.frequencies, options.modes, &options.picks)
        .map_err(|problem| DynamicsError::Selection { file: file(), problem })?;
    let averages = options.averages.or(measured.averages);
    let (turned, wrong_signs) = upright(&noise_of_hits(measured, averages));
    let likelihood = Likelihood::new(&turned, f64::from(averages.unwrap_or(1)));
    let known_scale = averages.is_some() && measured.functions.iter().all(|function| function.coherence.is_some());
    let poles = stabilisation(&turned);
    let mut search =
        Search { likelihood, known_scale, range: [measured.frequencies[0], measured.frequencies[lines - 1]] };
    let modes = options.modes.unwrap_or(if options.picks.is_empty() { MOST_MODES } else { options.picks.len() });
    let columns = Search::columns(&poles, &options.picks);
    let forced = options.modes.is_some() || !options.picks.is_empty();
    let mut found = search.modes(&columns, &poles, modes, forced);
    if found.is_none() {
        // Where nothing stands out of the noise, the best that there is tells why it must not be used.
        search.likelihood = Likelihood::new(&turned, f64::from(averages.unwrap_or(1)));
        found = search.modes(&columns, &poles, 1, true);
    }
    let found = found.ok_or_else(|| DynamicsError::NoModes { file: file() })?;
    let maximum = search.finish(found).ok_or_else(|| DynamicsError::NoModes { file: file() })?;
    Ok(described(&search, &turned, maximum, options, poles, wrong_signs))
}

/// The measurement with the sign of every sensor turned so that work is done on the structure at its peaks, and the
/// direct functions of which the sign was wrong.
fn upright(measured: &Measurement) -> (Measurement, Vec<String>) {
    let mut turned = measured.clone();
    let mut wrong = Vec::new();
    for function in measured.functions.iter().filter(|function| function.is_direct()) {
        let ratio = |i: usize| function.coherence.as_ref().map_or(1.0, |c| c[i] / (1.0 - c[i]).max(1e-3));
        let values = function.receptance.iter().enumerate();
        let sum: f64 = values.map(|(i, h)| ratio(i) * h.im / h.norm().max(f64::MIN_POSITIVE)).sum();
        if sum > 0.0 {
            wrong.push(function.name());
            for other in turned.functions.iter_mut().filter(|other| other.response == function.response) {
                other.receptance.iter_mut().for_each(|value| *value = -*value);
            }
        }
    }
    (turned, wrong)
}

/// What a search has found, in the terms of its user.
fn described(
    search: &Search,
    measured: &Measurement,
    maximum: Maximum,
    options: &FitOptions,
    poles: Vec<Pole>,
    wrong_signs: Vec<String>,
) -> Fit {
    let Maximum { model, chi2, freedom, covariance } = &maximum;
    let scale = search.scale(&maximum) * shared_between_lines(measured);
    let per_mode = 2 + search.likelihood.directions.len();
    let mut order: Vec<usize> = (0..model.modes.len()).collect();
    order.sort_by(|a, b| model.modes[*a].frequency.total_cmp(&model.modes[*b].frequency));
    // Frequency (Hz), damping ratio, stiffness and angle of every mode by the parameters of the search.
    let mut slopes = DMatrix::zeros(4 * order.len(), covariance.nrows());
    for (place, r) in order.iter().enumerate() {
        let mode = &model.modes[*r];
        let square: f64 = mode.shape.iter().map(|part| part * part).sum();
        let stiffness = mode.frequency * mode.frequency / square;
        slopes[(4 * place, per_mode * r)] = mode.frequency / TAU;
        slopes[(4 * place + 1, per_mode * r + 1)] = mode.damping_ratio;
        slopes[(4 * place + 2, per_mode * r)] = 2.0 * stiffness;
        for (k, direction) in search.likelihood.directions.iter().enumerate() {
            let column = per_mode * r + 2 + k;
            slopes[(4 * place + 2, column)] = -2.0 * stiffness * mode.shape[*direction] / square;
            let across = if *direction == 0 { -mode.shape[1] } else { mode.shape[0] };
            slopes[(4 * place + 3, column)] = across / square;
        }
    }
    let spread = &slopes * covariance * slopes.transpose() * scale;
    let sd = |i: usize| spread[(i, i)].max(0.0).sqrt();
    let plane = search.likelihood.directions.len() > 1;
    let modes: Vec<FittedMode> = order
        .iter()
        .enumerate()
        .map(|(place, r)| {
            let mode = &model.modes[*r];
            let length = mode.shape[0].hypot(mode.shape[1]);
            let greatest = if mode.shape[0].abs() >= mode.shape[1].abs() { mode.shape[0] } else { mode.shape[1] };
            let direction = match options.direction {
                Some(direction) if !plane => direction,
                _ => mode.shape.map(|part| part / (length * greatest.signum())),
            };
            let estimate = |value, i: usize| Estimate { value, sd: sd(4 * place + i) };
            let (frequency, damping_ratio) = unwindowed(mode, measured.window_decay);
            FittedMode {
                direction,
                direction_sd: plane.then(|| sd(4 * place + 3).min(FRAC_PI_2)),
                natural_frequency: estimate(frequency / TAU, 0),
                damping_ratio: estimate(damping_ratio, 1),
                stiffness: estimate((frequency / length).powi(2), 2),
            }
        })
        .collect();
    let kept: Vec<usize> = (0..4 * modes.len()).filter(|i| i % 4 != 3).collect();
    let pairs = search.likelihood.pairs();
    let first = per_mode * modes.len();
    let upper = pairs.iter().enumerate().map(|(i, pair)| {
        let sd = (covariance[(first + i, first + i)] * scale).max(0.0).sqrt();
        (PAIRS[*pair], Estimate { value: model.upper[*pair], sd })
    });
    let fitted: Vec<Vec<Complex<f64>>> = measured
        .functions
        .iter()
        .map(|f| {
            let (p, q) = (f.response.index(), f.force.index());
            search.likelihood.lines.iter().map(|w| model.receptance(p, q, *w)).collect()
        })
        .collect();
    let reduced_chi2 = search.known_scale.then(|| chi2 / *freedom as f64);
    let variances: Vec<&[f64]> = search.likelihood.targets.iter().map(|target| target.variance.as_slice()).collect();
    let variances = search.known_scale.then_some(variances.as_slice());
    let quality = Quality::new(measured, &fitted, &modes, reduced_chi2, variances, wrong_signs);
    Fit {
        upper: upper.collect(),
        covariance: kept.iter().map(|i| kept.iter().map(|j| spread[(*i, *j)]).collect()).collect(),
        quality,
        poles,
        fitted,
        modes,
    }
}

/// Factor on the variance of what a fit finds by noise that neighbouring lines share under an exponential window. Over a frame of
/// the duration T its square `e^(−2 d t)` has the transform `1/(1 + i pi m/(d T))` m lines away, which is their correlation; that of
/// a line with all others adds up to `d T coth(d T)`. A mode with damping of its own, as every one that is not refused, is as
/// wide as these lines.
fn shared_between_lines(measured: &Measurement) -> f64 {
    let faded = measured.window_decay / measured.step();
    if faded > 0.0 { faded / faded.tanh() } else { 1.0 }
}

/// Undamped natural frequency (rad/s) and damping ratio of a mode without the decay d of an exponential window: at `i w + d` in
/// place of `i w` a mode of frequency w and damping s = zeta w has the square `w² + 2 s d + d²` and the damping `s + d`.
fn unwindowed(mode: &RealMode, decay: f64) -> (f64, f64) {
    let damping = mode.damping_ratio * mode.frequency - decay;
    let square = mode.frequency * mode.frequency - 2.0 * damping * decay - decay * decay;
    let frequency = square.max(f64::MIN_POSITIVE).sqrt();
    (frequency, damping / frequency)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The correlation of noise at one line with that at all others, by the transform of the square of the window.
    #[test]
    fn a_window_makes_lines_share_their_noise() {
        let (decay, duration, samples) = (4.0, 0.5, 4096);
        let lines = || (0..samples).map(|line| f64::from(line) / duration);
        let square = |t: f64| (-2.0 * decay * t).exp();
        let transform = |frequency: f64| -> Complex<f64> {
            let times = (0..samples).map(|i| (f64::from(i) + 0.5) * duration / f64::from(samples));
            times.map(|t| Complex::from_polar(square(t), -TAU * frequency * t)).sum()
        };
        // Lines as far on either side, the correlation with one of them conjugate to that with the other.
        let all: f64 = lines().take(200).skip(1).map(|frequency| 2.0 * transform(frequency).re).sum::<f64>();
        let told = |window_decay| {
            shared_between_lines(&Measurement {
                source: String::new(),
                frequencies: lines().skip(1).take(9).collect(),
                functions: Vec::new(),
                averages: None,
                coherence_digit: 0.0,
                window_decay,
                notes: Vec::new(),
            })
        };
        let summed = 1.0 + all / transform(0.0).re;
        assert!((told(decay) / summed - 1.0).abs() < 5e-3, "{} {summed}", told(decay));
        assert_eq!(told(0.0), 1.0);
    }
}
