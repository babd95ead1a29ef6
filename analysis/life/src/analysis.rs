//! Everything that a sample of lives says, in one go.

use super::bootstrap::{self, Banded};
use super::fit::{Estimated, Fit, fit};
use super::goodness::{self, Goodness};
use super::law::{Dimension, Family, Law};
use super::replacement::{Costs, Failing, Replacement};
use super::sample::{Sample, SampleError};
use super::survival::{Step, kaplan_meier, turnbull};
use rayon::prelude::*;

/// What is to be worked out.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// Families to fit.
    pub families: Vec<Family>,
    /// Confidence of every interval and band.
    pub confidence: f64,
    /// Resampled refits behind the bands.
    pub bootstrap: u32,
    /// Samples of the test of fit; 0 leaves the p out.
    pub goodness: u32,
    /// Costs of replacement.
    pub costs: Costs,
    /// The same lives in which only failures have ended, where not every end is one: those that came to a limit that is seen
    /// were replaced as planned.
    pub failures: Option<Sample>,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for Request {
    /// Every family, 90 % intervals, 500 refits, 199 samples, a failure costs five replacements.
    fn default() -> Self {
        Self {
            families: Family::ALL.to_vec(),
            confidence: 0.9,
            bootstrap: 500,
            goodness: 199,
            costs: Costs { planned: 1.0, failure: 5.0 },
            failures: None,
            seed: 1,
        }
    }
}

/// A law fitted, with what is known of it.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// The fit.
    pub fit: Fit,
    /// Parameters with profile-likelihood intervals.
    pub parameters: Vec<(&'static str, Estimated, Dimension)>,
    /// Distance from the lives and its p; none where no test was requested.
    pub goodness: Option<Goodness>,
    /// Distance from the lives.
    pub distance: f64,
}

/// A number with its bootstrap interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Of the fitted law.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// How far a sample reaches: beyond it a law says what nobody has seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampleReach {
    /// Greatest age that was observed.
    pub last: f64,
    /// Share of edges that were still good then, by the estimate without a law.
    pub good: f64,
    /// Mean life up to that age, without a law.
    pub restricted_mean: f64,
}

impl SampleReach {
    fn from_sample(sample: &Sample, empirical: &[Step]) -> Self {
        let last = sample.range().1;
        let (mut from, mut good, mut restricted_mean) = (0.0, 1.0, 0.0);
        for step in empirical.iter().filter(|step| step.age <= last) {
            restricted_mean += good * (step.age - from);
            (from, good) = (step.age, step.survival);
        }
        restricted_mean += good * (last - from);
        Self { last, good, restricted_mean }
    }

    /// Whether an age of a law is one that was observed.
    pub fn reaches(&self, age: f64) -> bool {
        age <= self.last || self.good < 1e-9
    }

    /// Whether the mean life is one of what was observed: not where so many edges outlived the
    /// observation that its tail decides.
    pub fn reaches_mean(&self) -> bool {
        self.good <= TAIL
    }
}

/// Share of edges that may outlive the observation while a mean life is still stated (assumption: the
/// tail of a law then moves the mean by less than its usual interval).
const TAIL: f64 = 0.05;

/// What a sample says.
#[derive(Clone, Debug)]
pub struct Analysis {
    /// Laws, the most credible by AICc first; those that are not regular come last, see
    /// [`Fit::regular`].
    pub fits: Vec<Fitted>,
    /// Families that the sample does not determine, and why.
    pub refused: Vec<(Family, SampleError)>,
    /// How far the lives reach.
    pub reach: SampleReach,
    /// Reliability without a law: Kaplan–Meier, or Turnbull where ends lie between inspections.
    pub empirical: Vec<Step>,
    /// Laws of the resampled lives, of the family of the first fit.
    pub resampled: Vec<Law>,
    /// Reliability of the first fit.
    pub reliability: Vec<Banded>,
    /// Hazard of the first fit.
    pub hazard: Vec<Banded>,
    /// Mean residual life of the first fit.
    pub residual_life: Vec<Banded>,
    /// Age that 10 % of edges do not reach.
    pub b10: Interval,
    /// Mean life.
    pub mean: Interval,
    /// Replacement by age.
    pub by_age: Replacement,
    /// Interval of the best age.
    pub best_age: (f64, f64),
    /// Interval of its cost rate.
    pub best_cost: (f64, f64),
    /// Cost rate over the age of replacement.
    pub cost: Vec<Banded>,
    /// Replacement in blocks.
    pub in_blocks: Replacement,
    /// Whether edges that come to a limit are replaced there as planned, so that only other ends are failures.
    pub limit_is_seen: bool,
}

impl Analysis {
    /// What happens to edges that are not replaced before, in words.
    pub fn until_the_end(&self) -> &'static str {
        if self.limit_is_seen { "using edges up to their limit" } else { "running to failure" }
    }

    /// Whether the lives say when to replace: the best age is one that was observed, or running to failure
    /// is best and the mean life known.
    pub fn replacement_seen(&self) -> bool {
        if self.by_age.age.is_finite() { self.reach.reaches(self.by_age.age) } else { self.reach.reaches_mean() }
    }
}

/// Ages of a curve.
const POINTS: usize = 60;

/// Analyses a sample.
///
/// # Errors
/// [`SampleError`] where no family at all can be fitted.
///
/// # Examples
/// ```
/// use toolroom_life::analysis::{Request, analyse};
/// use toolroom_life::sample::{Observation::Failed, Sample};
/// let sample = Sample::new([11.0, 15.0, 18.0, 22.0, 25.0, 31.0].map(Failed))?;
/// let request = Request { bootstrap: 50, goodness: 0, ..Request::default() };
/// let analysis = analyse(&sample, &request)?;
/// assert!(analysis.b10.low < analysis.b10.value && analysis.b10.value < analysis.b10.high);
/// # Ok::<(), toolroom_life::sample::SampleError>(())
/// ```
pub fn analyse(sample: &Sample, request: &Request) -> Result<Analysis, SampleError> {
    let (mut fits, mut refused) = (Vec::new(), Vec::new());
    let tried: Vec<_> = request.families.par_iter().map(|family| (*family, fit(sample, *family))).collect();
    for (family, fitted) in tried {
        match fitted {
            Ok(fitted) => fits.push(fitted),
            Err(error) => refused.push((family, error)),
        }
    }
    if fits.is_empty() {
        // What not even the simplest law finds in them.
        let simplest = refused.into_iter().min_by_key(|(family, _)| family.parameters());
        return Err(simplest.map_or(SampleError::Empty, |(_, error)| error));
    }
    // Regular fits first; of equally credible laws the one with fewer parameters.
    fits.sort_by(|a, b| {
        let parameters = |fit: &Fit| fit.law.family().parameters();
        let credible = a.aicc().total_cmp(&b.aicc()).then(parameters(a).cmp(&parameters(b)));
        b.regular().cmp(&a.regular()).then(credible)
    });
    let best = fits[0].clone();
    let law = best.law;
    let resampled = bootstrap::laws(sample, &best, request.bootstrap, request.seed);
    let fits = fits
        .into_par_iter()
        .map(|fit| Fitted {
            parameters: fit.parameters(sample, request.confidence),
            goodness: (request.goodness > 0).then(|| goodness::test(sample, &fit, request.goodness, request.seed)),
            distance: goodness::anderson_darling(sample, &fit.law),
            fit,
        })
        .collect();
    let interval = |of: &dyn Fn(&Law) -> f64| {
        let (low, high) = bootstrap::interval(&resampled, request.confidence, of);
        Interval { value: of(&law), low, high }
    };
    let end = law.quantile(0.995).max(sample.range().1);
    let ages: Vec<f64> = (1..=POINTS).map(|i| end * i as f64 / POINTS as f64).collect();
    type Curve<'a> = &'a (dyn Fn(&Law, &[f64]) -> Vec<f64> + Sync);
    let band = |of: Curve<'_>| bootstrap::band(&law, &resampled, &ages, request.confidence, of);
    let by_age =
        |of: fn(&Law, f64) -> f64| move |law: &Law, ages: &[f64]| ages.iter().map(|age| of(law, *age)).collect();
    let costs = request.costs;
    let failures = request.failures.as_ref().map(|sample| law_of(sample, &request.families));
    let failing = match &failures {
        None => Failing::Every,
        Some(None) => Failing::Never,
        Some(Some(law)) => Failing::By(law),
    };
    let best_of: Vec<Replacement> = resampled.par_iter().map(|law| costs.best_age_of(law, failing)).collect();
    let empirical = if sample.inspected() { turnbull(sample) } else { kaplan_meier(sample, request.confidence) };
    let spread =
        |of: fn(&Replacement) -> f64| bootstrap::quantiles(best_of.iter().map(of).collect(), request.confidence);
    Ok(Analysis {
        refused,
        reach: SampleReach::from_sample(sample, &empirical),
        empirical,
        reliability: band(&by_age(Law::survival)),
        hazard: band(&by_age(Law::hazard)),
        residual_life: band(&Law::residual_lives),
        b10: interval(&|law| law.quantile(0.1)),
        mean: interval(&Law::mean),
        by_age: costs.best_age_of(&law, failing),
        best_age: spread(|best| best.age),
        best_cost: spread(|best| best.cost_rate),
        cost: band(&|law: &Law, ages: &[f64]| costs.at_ages(law, failing, ages)),
        in_blocks: costs.best_blocks(&law, failing),
        limit_is_seen: request.failures.is_some(),
        fits,
        resampled,
    })
}

/// The most credible law of failures; `None` where there are too few for any.
fn law_of(sample: &Sample, families: &[Family]) -> Option<Law> {
    let fits: Vec<Fit> = families.par_iter().filter_map(|family| fit(sample, *family).ok()).collect();
    let regular = fits.iter().filter(|fit| fit.regular());
    regular.min_by(|a, b| a.aicc().total_cmp(&b.aicc())).map(|fit| fit.law)
}
