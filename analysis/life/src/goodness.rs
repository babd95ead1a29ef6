//! How far a fitted law is from its lives.

use super::fit::{Fit, fit};
use super::law::Law;
use super::sample::{Observation, Sample};
use super::survival::{Step, kaplan_meier};
use rand::RngExt;
use rayon::prelude::*;
use toolroom_kernel::{Entity, Purpose, Streams};

/// Distance and how often chance alone gives a greater one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goodness {
    /// Anderson–Darling distance A².
    pub distance: f64,
    /// Share of samples drawn from the fitted law, fitted again, that are farther from it.
    pub p: f64,
    /// Samples drawn.
    pub samples: u32,
}

/// Anderson–Darling distance of a law from the Kaplan–Meier estimate F_n,
/// `A² = n ∫ (F_n - F)²/(F (1 - F)) dF` up to the last age observed; the classical statistic for
/// complete lives. An end between inspections counts in the middle between them.
///
/// # Source
/// T. W. Anderson, D. A. Darling, J. Am. Stat. Assoc. 49 (1954) 765; censored lives as in A. N.
/// Pettitt, M. A. Stephens, Biometrika 63 (1976) 291.
///
/// # Examples
/// ```
/// use toolroom_life::{goodness::anderson_darling, law::Law, sample::{Observation::Failed, Sample}};
/// let law = Law::Weibull { shape: 1.0, scale: 1.0 };
/// let sample = Sample::new([Failed(law.quantile(0.5))])?;
/// assert!((anderson_darling(&sample, &law) - (2.0 * 2f64.ln() - 1.0)).abs() < 1e-12);
/// # Ok::<(), toolroom_life::sample::SampleError>(())
/// ```
pub fn anderson_darling(sample: &Sample, law: &Law) -> f64 {
    let steps = kaplan_meier(sample, 0.9);
    let last = sample.range().1;
    let complete = steps.last().is_some_and(|step| step.survival == 0.0);
    // ∫ (c - u)²/(u (1 - u)) du = c² ln u - (1 - c)² ln(1 - u) - u.
    let mut total = 0.0;
    let (mut from, mut from_survival, mut share) = (0.0, 1.0, 0.0);
    let ends = steps.iter().map(|step| (step.age, 1.0 - step.survival)).chain((!complete).then_some((last, 1.0)));
    for (age, next) in ends {
        let (to, to_survival) = (law.failed(age).max(1e-300), law.survival(age).max(1e-300));
        if share > 0.0 {
            total += share * share * (to / from).ln();
        }
        total -= (1.0 - share).powi(2) * (to_survival / from_survival).ln() + (to - from);
        (from, from_survival, share) = (to, to_survival, next);
    }
    if complete {
        // To the end of the law, where F_n is 1.
        total += -f64::ln(from) - from_survival;
    }
    sample.size() * total
}

/// Tests the fit by drawing `samples` samples from it, observed as the lives were: censored like
/// them, inspected at the same ages.
///
/// Ages of censoring are drawn from their own Kaplan–Meier estimate. Where ends lie between
/// inspections, all edges are taken as inspected at all ages of the sample: finer than it was
/// where edges were inspected at ages of their own.
///
/// # Source
/// W. Stute, W. González Manteiga, M. Presedo Quindimil, Metrika 40 (1993) 243 (parametric
/// bootstrap of statistics with estimated parameters).
pub fn test(sample: &Sample, fitted: &Fit, samples: u32, seed: u64) -> Goodness {
    let distance = anderson_darling(sample, &fitted.law);
    let plan = Observing::from_sample(sample);
    let streams = Streams::new(seed, 0);
    let farther = (0..samples).into_par_iter().filter_map(|i| {
        let mut stream = streams.at(Entity::named("goodness of fit"), Purpose::Measurement, u64::from(i));
        let lives = (0..plan.count).map(|_| plan.observe(fitted.law.quantile(stream.random()), stream.random()));
        let drawn = Sample::new(lives.collect::<Vec<_>>()).ok()?;
        let again = fit(&drawn, fitted.law.family()).ok()?;
        Some(anderson_darling(&drawn, &again.law) >= distance)
    });
    let outcomes: Vec<bool> = farther.collect();
    let count = outcomes.iter().filter(|farther| **farther).count();
    // The sample itself is one of those drawn (Davison and Hinkley 1997, §4.2).
    let p = (count + 1) as f64 / (outcomes.len() + 1) as f64;
    Goodness { distance, p, samples: u32::try_from(outcomes.len()).unwrap_or(u32::MAX) }
}

/// How lives of a sample were observed.
struct Observing {
    count: usize,
    /// Kaplan–Meier estimate of the age of censoring; empty where nothing is censored.
    censoring: Vec<Step>,
    /// Ages of inspection; empty where ends were seen as they happened.
    inspections: Vec<f64>,
}

impl Observing {
    fn from_sample(sample: &Sample) -> Self {
        let mirrored = sample.lives().iter().map(|(life, weight)| match *life {
            Observation::Censored(age) => (Observation::Failed(age), *weight),
            Observation::Failed(_) | Observation::Between(..) => (Observation::Censored(life.age()), *weight),
        });
        let censored = sample.lives().iter().any(|(life, _)| !life.ended());
        let censoring = Sample::weighted(mirrored).ok().filter(|_| censored);
        let mut inspections: Vec<f64> = Vec::new();
        for (life, _) in sample.lives() {
            if let Observation::Between(low, high) = life {
                inspections.extend([*low, *high]);
            }
        }
        inspections.sort_by(f64::total_cmp);
        inspections.dedup();
        Self {
            count: sample.size().round().max(1.0) as usize,
            censoring: censoring.map_or_else(Vec::new, |mirrored| kaplan_meier(&mirrored, 0.9)),
            inspections,
        }
    }

    /// What is seen of an edge with this life, whose observation stops with rank `u`.
    fn observe(&self, life: f64, u: f64) -> Observation {
        let life = life.max(f64::MIN_POSITIVE);
        let stop = self.censoring.iter().find(|step| step.survival <= u).map_or(f64::INFINITY, |step| step.age);
        if life > stop {
            return Observation::Censored(stop);
        }
        if self.inspections.is_empty() {
            return Observation::Failed(life);
        }
        let after = self.inspections.partition_point(|age| *age < life);
        let low = if after == 0 { 0.0 } else { self.inspections[after - 1] };
        match self.inspections.get(after) {
            Some(high) if *high > low => Observation::Between(low, *high),
            _ => Observation::Censored(low.max(f64::MIN_POSITIVE)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Family;
    use Observation::{Censored, Failed};

    #[test]
    fn complete_lives_give_the_classical_statistic() {
        let law = Law::Weibull { shape: 1.7, scale: 9.0 };
        let ages = [2.0, 3.5, 4.0, 7.7, 8.1, 12.0, 15.5];
        let sample = Sample::new(ages.map(Failed)).unwrap();
        let n = ages.len() as f64;
        let sum: f64 = (0..ages.len())
            .map(|i| {
                let weight = (2 * i + 1) as f64;
                weight * (law.failed(ages[i]).ln() + law.ln_survival(ages[ages.len() - 1 - i]))
            })
            .sum();
        assert!((anderson_darling(&sample, &law) - (-n - sum / n)).abs() < 1e-12);
    }

    #[test]
    fn p_is_uniform_where_the_law_is_right_and_small_where_it_is_wrong() {
        let truth = Law::Weibull { shape: 2.0, scale: 30.0 };
        let draw = |k: u64, law: &Law| {
            let mut stream = Streams::new(5, k).open(Entity::named("lives"), Purpose::Tool);
            let lives = (0..40).map(|_| {
                let life = law.quantile(stream.random());
                if life > 38.0 { Censored(38.0) } else { Failed(life) }
            });
            Sample::new(lives.collect::<Vec<_>>()).unwrap()
        };
        let p = |k: u64, law: &Law| {
            let sample = draw(k, law);
            test(&sample, &fit(&sample, Family::Weibull).unwrap(), 99, k).p
        };
        let right: Vec<f64> = (0..60).map(|k| p(k, &truth)).collect();
        let mean = right.iter().sum::<f64>() / right.len() as f64;
        // Standard error of the mean of 60 uniform numbers: 0.037.
        assert!((mean - 0.5).abs() < 0.12, "{mean}");
        // A life that starts late, with an early peak, is no Weibull of two parameters.
        let wrong = Law::Weibull3 { shape: 1.01, scale: 5.0, location: 20.0 };
        let rejected = (0..20).filter(|k| p(*k, &wrong) < 0.05).count();
        assert!(rejected >= 16, "{rejected} of 20");
    }
}
