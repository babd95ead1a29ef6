//! How far a fitted law is from its lives.

use super::fit::{Fit, refit};
use super::law::Law;
use super::sample::{Observation, Sample};
use super::survival::{Step, kaplan_meier};
use rand::RngExt;
use rayon::prelude::*;
use std::collections::BTreeMap;
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
/// complete lives. An end between inspections is spread between them as the law has it, so that many lives in classes are no
/// farther from their law than the lives themselves.
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
    let complete = steps.last().is_some_and(|step| step.survival == 0.0);
    let ramps = ramps(sample, &steps);
    let last = ramps.iter().map(|ramp| ramp.end).fold(sample.range().1, f64::max);
    // Where F_n changes: by how much it jumps there, and by how much its slope over F.
    let mut changes = vec![(last, 0.0, 0.0)];
    for Ramp { begin, end, rise } in ramps {
        let width = law.failed(end) - law.failed(begin);
        if width > NARROW {
            changes.push((begin, 0.0, rise / width));
            changes.push((end, 0.0, -rise / width));
        } else {
            changes.push((0.5 * (begin + end), rise, 0.0));
        }
    }
    changes.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Where F_n = A + (B + 1) u, ∫ (F_n - u)²/(u (1 - u)) du = A² ln u - (A + B)² ln(1 - u) - B² u.
    let mut total = 0.0;
    let (mut from, mut from_survival, mut share, mut slope) = (0.0, 1.0, 0.0_f64, 0.0);
    for (age, jump, bend) in changes {
        let (to, to_survival) = (law.failed(age).max(1e-300), law.survival(age).max(1e-300));
        if to > from {
            let (origin, rise) = (share - slope * from, slope - 1.0);
            if from > 0.0 {
                total += origin * origin * f64::ln(to / from);
            }
            total -= (origin + rise).powi(2) * f64::ln(to_survival / from_survival) + rise * rise * (to - from);
            share += slope * (to - from);
        }
        (from, from_survival, share, slope) = (to, to_survival, share + jump, slope + bend);
    }
    if complete {
        // To the end of the law, where F_n is 1.
        total += -f64::ln(from) - from_survival;
    }
    sample.size() * total
}

/// Share of a law below which a class is a point (1): the terms of a steeper rise cancel beyond the digits of a number.
const NARROW: f64 = 1e-6;

/// A rise of the estimate F_n from one age to another; at one age where its ends were seen as they happened.
struct Ramp {
    begin: f64,
    end: f64,
    rise: f64,
}

/// The rises of the estimate: each of its steps between the inspections of its ends.
fn ramps(sample: &Sample, steps: &[Step]) -> Vec<Ramp> {
    let span = |(life, _): &(Observation, f64)| match *life {
        Observation::Between(low, high) => Some((life.age().to_bits(), (low, high))),
        Observation::Failed(_) | Observation::Censored(_) => None,
    };
    let spans: BTreeMap<u64, (f64, f64)> = sample.lives().iter().filter_map(span).collect();
    let mut survival = 1.0;
    let ramp = |step: &Step| {
        let (begin, end) = spans.get(&step.age.to_bits()).copied().unwrap_or((step.age, step.age));
        let rise = survival - step.survival;
        survival = step.survival;
        Ramp { begin, end, rise }
    };
    steps.iter().map(ramp).collect()
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
        // The law from which the lives were drawn is near the one that fits them.
        let again = refit(&drawn, fitted)?;
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
    use crate::fit::fit;
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
    fn lives_in_classes_are_no_farther_from_their_law_than_the_lives_themselves() {
        let law = Law::Lognormal { median: 64.0, sigma: 0.25 };
        let mut stream = Streams::new(3, 0).open(Entity::named("lives"), Purpose::Tool);
        let ages: Vec<f64> = (0..20_000).map(|_| law.quantile(stream.random())).collect();
        let exact = anderson_darling(&Sample::new(ages.iter().map(|age| Failed(*age))).unwrap(), &law);
        let mut classes = BTreeMap::new();
        ages.iter().for_each(|age| *classes.entry((age / 4.0).floor() as u32).or_insert(0.0) += 1.0);
        let class = |(class, weight): (u32, f64)| {
            (Observation::Between(4.0 * f64::from(class), 4.0 * f64::from(class + 1)), weight)
        };
        let in_classes = anderson_darling(&Sample::weighted(classes.into_iter().map(class)).unwrap(), &law);
        // In the middle of its class each end would add some n times the mean square of a twelfth of a class.
        assert!(exact < 3.0 && (in_classes - exact).abs() < 0.5, "{in_classes} for {exact}");
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
