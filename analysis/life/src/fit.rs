//! Maximum likelihood.

use super::law::{Dimension, Family, Law};
use super::maximise::{Maximum, maximise, maximise_near, profile};
use super::normal;
use super::sample::{Observation, Sample, SampleError};
use statrs::function::gamma::gamma;

/// Logarithms beyond which a parameter is no longer a number worth searching.
const FARTHEST: f64 = 30.0;

/// Least scatter of wear-out in a competition of risks, and greatest shape of chipping. Narrower or
/// steeper, a risk would settle on one single life, where the likelihood has no bound (assumption:
/// chipping comes by chance or slowly rising, wear-out scatters by more than 5 %).
const NARROWEST: f64 = 0.05;
const STEEPEST: f64 = 4.0;

/// A law fitted to lives.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The most likely law of its family.
    pub law: Law,
    /// Logarithm of its likelihood.
    pub log_likelihood: f64,
    /// Sum of the weights.
    pub size: f64,
    /// Unit of lives in the search: ages are divided by it.
    unit: f64,
    peak: Maximum,
}

/// A number with its profile-likelihood interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimated {
    /// Most likely value.
    pub value: f64,
    /// Lower end; 0 or minus infinity where the data do not bound it.
    pub low: f64,
    /// Upper end; infinite where the data do not bound it.
    pub high: f64,
}

/// Fits the law of `family` that makes `sample` most likely.
///
/// A life that ended gives `ln f(t)`, a censored one `ln R(t)`, one between inspections
/// `ln (F(b) - F(a))`, each times its weight.
///
/// # Validity
/// The shape of a Weibull law with three parameters is kept above 1: below, its likelihood is
/// infinite where the location meets the shortest life. Between 1 and 2 the usual theory of
/// intervals does not hold for it (Smith 1985). The location is not below 0. Of competing risks
/// the wear-out scatters by more than 0.05 and chipping has a shape below 4, for the same reason.
///
/// # Errors
/// [`SampleError::AllCensored`], [`SampleError::TooFew`].
///
/// # Source
/// W. Q. Meeker, L. A. Escobar, Statistical Methods for Reliability Data (1998), ch. 8; R. L.
/// Smith, Biometrika 72 (1985) 67.
///
/// # Examples
/// ```
/// use toolroom_life::{fit::fit, law::Family, sample::{Observation::Failed, Sample}};
/// let sample = Sample::new([10.0, 20.0, 40.0].map(Failed))?;
/// let fit = fit(&sample, Family::Lognormal)?;
/// // Median: geometric mean; sigma: root of the mean squared deviation of the logarithms.
/// assert!((fit.law.quantile(0.5) - 20.0).abs() < 1e-6);
/// # Ok::<(), toolroom_life::sample::SampleError>(())
/// ```
pub fn fit(sample: &Sample, family: Family) -> Result<Fit, SampleError> {
    sample.suffices(family.parameters())?;
    let (unit, starts) = starts(sample, family);
    let climb = |sample: &Sample, start: &[f64]| maximise(&|x| log_likelihood(sample, &law(family, x, unit)), start);
    let best_of = |tops: Vec<Maximum>| tops.into_iter().max_by(|a, b| a.value.total_cmp(&b.value));
    // Which of several tops is the highest is seen on fewer classes already, and only the highest are climbed on all of them.
    let coarse = if starts.len() > 1 { sample.coarser(JOINED) } else { None };
    let best = match &coarse {
        None => best_of(starts.iter().filter_map(|start| climb(sample, start)).collect()),
        Some(coarse) => {
            let tops = highest(starts.iter().filter_map(|start| climb(coarse, start)).collect());
            best_of(tops.iter().filter_map(|top| climb(sample, &top.at)).collect())
        }
    };
    match best {
        Some(peak) => Ok(Fit::new(sample, family, unit, peak)),
        None => Err(SampleError::NoMaximum),
    }
}

/// Classes that are one while the highest of several tops is sought (assumption: with forty classes over the range of the lives
/// a top moves by less than its standard error).
const JOINED: usize = 4;
/// Log-likelihood below that of the highest top within which another one is climbed on all classes (assumption: joining classes
/// moves tops against each other by less).
const NEARLY: f64 = 3.0;
/// Distance of parameters below which two searches have ended at the same top: they are logarithms, and one per cent is far
/// below what the data tell of them (assumption).
const SAME: f64 = 0.01;

/// The tops that may be the highest on all classes, each of them once.
fn highest(mut tops: Vec<Maximum>) -> Vec<Maximum> {
    tops.sort_by(|a, b| b.value.total_cmp(&a.value));
    let bound = tops.first().map_or(f64::NAN, |top| top.value - NEARLY);
    let mut kept: Vec<Maximum> = Vec::new();
    for top in tops.into_iter().filter(|top| top.value >= bound) {
        let same = |known: &Maximum| known.at.iter().zip(&top.at).all(|(a, b)| (a - b).abs() < SAME);
        if !kept.iter().any(same) {
            kept.push(top);
        }
    }
    kept
}

/// The same from a law that is near already: a refit to resampled lives.
pub(super) fn refit(sample: &Sample, start_fit: &Fit) -> Option<Fit> {
    let family = start_fit.law.family();
    sample.suffices(family.parameters()).ok()?;
    let likelihood = |x: &[f64]| log_likelihood(sample, &law(family, x, start_fit.unit));
    let peak = maximise_near(&likelihood, &start_fit.peak.at, &start_fit.peak.information);
    let settled = peak.filter(|peak| peak.at.iter().all(|x| x.abs() < FARTHEST));
    settled.map(|peak| Fit::new(sample, family, start_fit.unit, peak)).or_else(|| fit(sample, family).ok())
}

/// Logarithm of the likelihood of a law.
pub fn log_likelihood(sample: &Sample, law: &Law) -> f64 {
    // Classes follow one another: the upper end of one is the lower end of the next.
    let mut last = (f64::NAN, (0.0, 0.0));
    let mut of_life = |life: &Observation| match *life {
        Observation::Failed(age) => law.ln_density(age),
        Observation::Censored(age) => law.ln_survival(age),
        Observation::Between(low, high) => {
            let below = if low == last.0 { last.1 } else { law.shares(low) };
            let above = law.shares(high);
            last = (high, above);
            let share = if above.0 < 0.5 { above.0 - below.0 } else { below.1 - above.1 };
            share.ln()
        }
    };
    sample.lives().iter().map(|(life, weight)| weight * of_life(life)).sum()
}

impl Fit {
    fn new(sample: &Sample, family: Family, unit: f64, peak: Maximum) -> Self {
        Self { law: law(family, &peak.at, unit), log_likelihood: peak.value, size: sample.size(), unit, peak }
    }

    /// Akaike's criterion, corrected for small samples; infinite where the sample is too small
    /// for the correction. Less is better.
    ///
    /// # Source
    /// C. M. Hurvich, C.-L. Tsai, Biometrika 76 (1989) 297.
    pub fn aicc(&self) -> f64 {
        let k = self.law.family().parameters() as f64;
        let free = self.size - k - 1.0;
        if free <= 0.0 { f64::INFINITY } else { 2.0 * (k - self.log_likelihood) + 2.0 * k * (k + 1.0) / free }
    }

    /// Whether the usual theory holds: not where a Weibull law with three parameters starts so
    /// steeply that its location follows the shortest life alone, nor where a risk of two is at
    /// the bound of what it may be. Such a fit describes the lives and predicts little.
    pub fn regular(&self) -> bool {
        match self.law {
            Law::Weibull3 { shape, .. } => shape > 2.0,
            Law::CompetingRisks { wear_sigma, chipping_shape, .. } => {
                wear_sigma > 1.02 * NARROWEST && chipping_shape < 0.98 * STEEPEST
            }
            Law::Weibull { .. }
            | Law::Lognormal { .. }
            | Law::Normal { .. }
            | Law::Gamma { .. }
            | Law::InverseGaussian { .. } => true,
        }
    }

    /// Profile-likelihood intervals of the parameters, in the order of [`Law::parameters`].
    pub fn parameters(&self, sample: &Sample, confidence: f64) -> Vec<(&'static str, Estimated, Dimension)> {
        let family = self.law.family();
        let likelihood = |x: &[f64]| log_likelihood(sample, &law(family, x, self.unit));
        let drop = drop(confidence);
        let ends: Vec<[Law; 2]> = (0..family.parameters())
            .map(|i| {
                let (low, high) = profile(&likelihood, &self.peak, i, drop);
                [low, high].map(|end| {
                    let mut x = self.peak.at.clone();
                    x[i] = end;
                    law(family, &x, self.unit)
                })
            })
            .collect();
        let read = |law: &Law, i: usize| law.parameters()[i].1;
        let parameter = |(i, (name, value, dimension)): (usize, (&'static str, f64, Dimension))| {
            let search = search_of(family, i);
            let [low, high] = [0, 1].map(|side| read(&ends[search][side], i));
            (name, Estimated { value, low: low.min(high), high: high.max(low) }, dimension)
        };
        self.law.parameters().into_iter().enumerate().map(parameter).collect()
    }

    /// The age that a share of edges does not reach, with its profile-likelihood interval;
    /// `None` for competing risks, whose quantile is no parameter of a search.
    pub fn quantile(&self, sample: &Sample, share: f64, confidence: f64) -> Option<Estimated> {
        let family = self.law.family();
        let value = self.law.quantile(share);
        // The first parameter of the search is exchanged for the quantile.
        let with = |x: &[f64]| -> Option<Law> {
            let mut start = x.to_vec();
            start[0] = match family {
                Family::CompetingRisks => return None,
                Family::Normal => x[0] - x[1].exp() * normal::quantile(share),
                Family::Weibull | Family::Weibull3 | Family::Lognormal | Family::Gamma | Family::InverseGaussian => {
                    let quantile = x[0].exp() * self.unit;
                    start[0] = 0.0;
                    let one = law(family, &start, self.unit);
                    let location = if let Law::Weibull3 { location, .. } = one { location } else { 0.0 };
                    ((quantile - location) / (one.quantile(share) - location)).ln()
                }
            };
            Some(law(family, &start, self.unit))
        };
        let likelihood = |x: &[f64]| with(x).map_or(f64::NAN, |law| log_likelihood(sample, &law));
        let mut start = self.peak.at.clone();
        start[0] = if family == Family::Normal { value / self.unit } else { (value / self.unit).ln() };
        let peak = maximise(&likelihood, &start)?;
        let (low, high) = profile(&likelihood, &peak, 0, drop(confidence));
        let age = |x: f64| if family == Family::Normal { x * self.unit } else { x.exp() * self.unit };
        Some(Estimated { value, low: age(low), high: age(high) })
    }
}

/// Half the quantile of chi square with one degree of freedom.
fn drop(confidence: f64) -> f64 {
    0.5 * normal::quantile(0.5 + 0.5 * confidence).powi(2)
}

/// The search parameter behind a parameter of [`Law::parameters`].
fn search_of(family: Family, parameter: usize) -> usize {
    match family {
        // These list their shape first, the search has the level first.
        Family::Weibull | Family::Weibull3 | Family::Gamma => [1, 0, 2][parameter],
        Family::Lognormal | Family::Normal | Family::InverseGaussian | Family::CompetingRisks => parameter,
    }
}

/// The law at a point of the search: levels as logarithms over `unit`, shapes as logarithms.
fn law(family: Family, x: &[f64], unit: f64) -> Law {
    let level = unit * x[0].exp();
    match family {
        Family::Weibull => Law::Weibull { scale: level, shape: x[1].exp() },
        // A location of 0 to 1 times the shortest life, which is the unit.
        Family::Weibull3 => {
            Law::Weibull3 { scale: level, shape: 1.0 + x[1].exp(), location: unit / (1.0 + (-x[2]).exp()) }
        }
        Family::Lognormal => Law::Lognormal { median: level, sigma: x[1].exp() },
        Family::Normal => Law::Normal { mean: unit * x[0], deviation: unit * x[1].exp() },
        // Mean and shape are nearly orthogonal, scale and shape are not; the scale is the level
        // all the same, so that it has a profile.
        Family::Gamma => Law::Gamma { scale: level, shape: x[1].exp() },
        Family::InverseGaussian => Law::InverseGaussian { mean: level, shape: unit * x[1].exp() },
        Family::CompetingRisks => Law::CompetingRisks {
            wear_median: level,
            wear_sigma: NARROWEST + x[1].exp(),
            chipping_shape: STEEPEST / (1.0 + (-x[2]).exp()),
            chipping_scale: unit * x[3].exp(),
        },
    }
}

/// Unit and starting points of the search, from the moments of the ages as if all had ended.
fn starts(sample: &Sample, family: Family) -> (f64, Vec<Vec<f64>>) {
    let size = sample.size();
    let mean =
        |f: &dyn Fn(f64) -> f64| sample.lives().iter().map(|(life, weight)| weight * f(life.age())).sum::<f64>() / size;
    let centre = mean(&f64::ln);
    // A share `ended` of all edges has been seen to end: the level lies the higher, the less, and
    // the more of the scatter is out of sight.
    let ended = (sample.ended() / size).max(0.001);
    let lift = -0.5 * ended.ln();
    let sigma = mean(&|age| (age.ln() - centre).powi(2)).sqrt().max(0.4 * lift).clamp(0.02, 3.0);
    let average = mean(&|age| age);
    let deviation = mean(&|age| (age - average).powi(2)).sqrt().max(0.4 * lift * average).max(1e-3 * average);
    let unit = centre.exp();
    let shape = (1.28 / sigma).ln();
    match family {
        Family::Weibull => (unit, vec![vec![lift + 0.5772 * sigma / 1.28, shape]]),
        Family::Weibull3 => {
            // The latest age that every edge is known to have reached bounds the location.
            let earliest = |life: &Observation| match *life {
                Observation::Failed(age) | Observation::Censored(age) => age,
                Observation::Between(_, high) => high,
            };
            let lives = sample.lives().iter().filter(|(life, _)| life.ended());
            let unit = lives.map(|(life, _)| earliest(life)).fold(f64::INFINITY, f64::min);
            let start = |share: f64| {
                let left = (centre.exp() - share * unit).max(0.05 * centre.exp());
                let shape = (1.28 * left / (sigma * centre.exp()) - 1.0).max(0.2);
                vec![(left / unit).ln() + lift + 0.3 * sigma, shape.ln(), (share / (1.0 - share)).ln()]
            };
            (unit, [0.05, 0.5, 0.9].map(start).to_vec())
        }
        Family::Lognormal => (unit, vec![vec![lift, sigma.ln()]]),
        Family::Normal => (average, vec![vec![1.0 + lift, (deviation / average).ln()]]),
        Family::Gamma => {
            let shape = sigma.powi(-2);
            (unit, vec![vec![lift - shape.ln(), shape.ln()]])
        }
        Family::InverseGaussian => {
            let cv = (deviation / average).max(0.02);
            (average, vec![vec![lift, lift - 2.0 * cv.ln()]])
        }
        Family::CompetingRisks => {
            // Wear-out above, a few early chippings; or chipping throughout.
            let wear = |level: f64, sigma: f64, shape: f64, scale: f64| {
                let steepness = -(STEEPEST / shape - 1.0).ln();
                vec![level, (sigma - NARROWEST).max(0.02).ln(), steepness, (scale / gamma(1.0 + shape.recip())).ln()]
            };
            // The likelihood has several tops, of which the highest may lie under any of these.
            let mut starts = Vec::new();
            for (level, share) in [(0.3, 0.6), (0.5, 1.0), (0.0, 1.0), (0.8, 0.3)] {
                for (shape, scale) in [(1.5, 1.5), (2.0, 0.5), (1.2, 3.0)] {
                    starts.push(wear(lift + level * sigma, share * sigma, shape, scale));
                }
            }
            (unit, starts)
        }
    }
}

#[cfg(test)]
mod tests;
