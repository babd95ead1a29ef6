//! Reliability without a law.

use super::normal;
use super::sample::{Observation, Sample};

/// One step of a nonparametric reliability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Age of the step.
    pub age: f64,
    /// Share of edges that live beyond it.
    pub survival: f64,
    /// Lower end of the pointwise interval; NaN where none is known.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Kaplan–Meier estimate with Greenwood's variance on the log-log scale, which keeps the interval
/// within 0 and 1. An end between inspections counts in the middle between them; use
/// [`turnbull`] where that is too coarse.
///
/// # Source
/// E. L. Kaplan, P. Meier, J. Am. Stat. Assoc. 53 (1958) 457; J. D. Kalbfleisch, R. L. Prentice,
/// The Statistical Analysis of Failure Time Data (1980), §1.3.
///
/// # Examples
/// ```
/// use toolroom_life::{sample::{Observation::*, Sample}, survival::kaplan_meier};
/// let sample = Sample::new([Failed(1.0), Censored(2.0), Failed(3.0), Failed(4.0)])?;
/// let steps = kaplan_meier(&sample, 0.95);
/// assert_eq!(steps.iter().map(|step| step.survival).collect::<Vec<_>>(), [0.75, 0.375, 0.0]);
/// # Ok::<(), toolroom_life::sample::SampleError>(())
/// ```
pub fn kaplan_meier(sample: &Sample, confidence: f64) -> Vec<Step> {
    let mut lives: Vec<(f64, bool, f64)> =
        sample.lives().iter().map(|(life, weight)| (life.age(), life.ended(), *weight)).collect();
    // Of equal ages the ends come first: who is censored then was still at risk.
    lives.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    let z = normal::quantile(0.5 + 0.5 * confidence);
    let mut at_risk = sample.size();
    let (mut survival, mut greenwood) = (1.0, 0.0);
    let mut steps = Vec::new();
    let mut i = 0;
    while i < lives.len() {
        let age = lives[i].0;
        let same = lives[i..].iter().take_while(|life| life.0 == age).count();
        let ends: f64 = lives[i..i + same].iter().filter(|life| life.1).map(|life| life.2).sum();
        if ends > 0.0 {
            // Rounding of weights must not leave a sliver alive.
            let left = if at_risk - ends < 1e-9 * sample.size() { 0.0 } else { at_risk - ends };
            survival *= left / at_risk;
            greenwood += ends / (at_risk * left);
            let (mut low, mut high) = (f64::NAN, f64::NAN);
            if survival > 0.0 && survival < 1.0 {
                let spread = (z * greenwood.sqrt() / f64::ln(survival)).abs();
                low = survival.powf(spread.exp());
                high = survival.powf((-spread).exp());
            }
            steps.push(Step { age, survival, low, high });
        }
        at_risk -= lives[i..i + same].iter().map(|life| life.2).sum::<f64>();
        i += same;
    }
    steps
}

/// Rounds of the expectation–maximisation at most.
const ROUNDS: usize = 20_000;

/// Turnbull's estimate for lives between inspections: the most likely distribution, by
/// expectation–maximisation. Steps lie at the upper ends of the innermost intervals; no
/// intervals are given, since the usual ones do not hold.
///
/// # Source
/// B. W. Turnbull, J. R. Stat. Soc. B 38 (1976) 290.
pub fn turnbull(sample: &Sample) -> Vec<Step> {
    let intervals: Vec<(f64, f64, f64)> = sample
        .lives()
        .iter()
        .map(|(life, weight)| match *life {
            Observation::Failed(age) => (age, age, *weight),
            Observation::Censored(age) => (age, f64::INFINITY, *weight),
            Observation::Between(low, high) => (low, high, *weight),
        })
        .collect();
    // Innermost intervals: a lower end followed at once by an upper end. Intervals are open below,
    // so that at equal ages an upper end comes before a lower one, but an exact age is both.
    let mut ends: Vec<(f64, u8)> = Vec::new();
    for &(low, high, _) in &intervals {
        let exact = low == high;
        ends.push((low, if exact { 1 } else { 3 }));
        ends.push((high, if exact { 2 } else { 0 }));
    }
    ends.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    ends.dedup();
    let opens = |kind: u8| kind == 1 || kind == 3;
    let cells: Vec<(f64, f64)> = ends
        .windows(2)
        .filter(|pair| opens(pair[0].1) && !opens(pair[1].1))
        .map(|pair| (pair[0].0, pair[1].0))
        .collect();
    let holds = |cell: &(f64, f64), life: &(f64, f64, f64)| {
        if life.0 == life.1 {
            cell.0 == life.0 && cell.1 == life.0
        } else {
            cell.0 >= life.0 && cell.1 <= life.1 && !(cell.0 == cell.1 && cell.0 == life.0)
        }
    };
    let members: Vec<Vec<usize>> =
        intervals.iter().map(|life| (0..cells.len()).filter(|cell| holds(&cells[*cell], life)).collect()).collect();
    let mut mass = vec![1.0 / cells.len() as f64; cells.len()];
    let size = sample.size();
    for _ in 0..ROUNDS {
        let mut next = vec![0.0; cells.len()];
        for (life, cells) in intervals.iter().zip(&members) {
            let total: f64 = cells.iter().map(|cell| mass[*cell]).sum();
            if total > 0.0 {
                cells.iter().for_each(|cell| next[*cell] += life.2 * mass[*cell] / (total * size));
            }
        }
        let change = mass.iter().zip(&next).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        mass = next;
        if change < 1e-10 {
            break;
        }
    }
    let mut survival = 1.0;
    let step = |(cell, mass): (&(f64, f64), &f64)| {
        survival -= mass;
        Step { age: cell.1, survival: survival.max(0.0), low: f64::NAN, high: f64::NAN }
    };
    cells.iter().zip(&mass).map(step).filter(|step| step.age.is_finite()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use Observation::{Between, Censored, Failed};

    #[test]
    fn remission_times_give_the_published_estimate() {
        // Freireich et al. 1963, 6-MP group; Kaplan–Meier in Kalbfleisch & Prentice, table 1.2.
        let ends = [6.0, 6.0, 6.0, 7.0, 10.0, 13.0, 16.0, 22.0, 23.0].map(Failed);
        let censored = [6.0, 9.0, 10.0, 11.0, 17.0, 19.0, 20.0, 25.0, 32.0, 32.0, 34.0, 35.0].map(Censored);
        let sample = Sample::new(ends.into_iter().chain(censored)).unwrap();
        let steps = kaplan_meier(&sample, 0.95);
        let expected = [0.857, 0.807, 0.753, 0.690, 0.627, 0.538, 0.448];
        for (step, expected) in steps.iter().zip(expected) {
            assert!((step.survival - expected).abs() < 6e-4, "{step:?}");
        }
        // Log-log interval at 6: 0.620 to 0.952 (survival::survfit of R, conf.type = "log-log").
        assert!((steps[0].low - 0.620).abs() < 1e-3 && (steps[0].high - 0.952).abs() < 1e-3, "{:?}", steps[0]);
    }

    #[test]
    fn without_inspections_turnbull_is_kaplan_meier() {
        let sample =
            Sample::new([Failed(1.0), Censored(2.0), Failed(3.0), Censored(3.0), Failed(4.0), Failed(5.0)]).unwrap();
        let (one, other) = (turnbull(&sample), kaplan_meier(&sample, 0.9));
        assert_eq!(one.len(), other.len());
        for (a, b) in one.iter().zip(&other) {
            assert!(a.age == b.age && (a.survival - b.survival).abs() < 1e-8, "{a:?} {b:?}");
        }
    }

    #[test]
    fn overlapping_inspections_share_their_mass() {
        // (0, 2], (1, 3], (2, 4]: the cells (1, 2] and (2, 3] explain all three with halves each
        // for the middle one; the outer ones are fixed.
        let sample = Sample::new([Between(0.0, 2.0), Between(1.0, 3.0), Between(2.0, 4.0)]).unwrap();
        let steps = turnbull(&sample);
        assert_eq!(steps.iter().map(|step| step.age).collect::<Vec<_>>(), [2.0, 3.0]);
        assert!((steps[0].survival - 0.5).abs() < 1e-6 && steps[1].survival < 1e-6, "{steps:?}");
    }
}
