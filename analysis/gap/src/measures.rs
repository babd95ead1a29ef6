//! How far a gap shrinks, in numbers that say different things about the same readings.
//!
//! A sum is what a planner asks for, and one reading may rule it; so the readings that stand far apart are named and the
//! sum is shown without them, too. A root mean square asks for the spread, a robust loss for the ordinary reading.

use super::constants::{BEYOND_ALIKE, CLOSABLE, FAR_READING, FEWEST_ALIKE};
use super::noise::HUBER;
use super::number::number;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use toolroom_statistics::median;

/// What two models leave of one reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualPair {
    /// Residual of the model without effects.
    pub before: f64,
    /// Residual with them.
    pub after: f64,
    /// Standard deviation of its noise, in the same unit.
    pub deviation: f64,
    /// Median size of the residuals of the same thing, else of its kind, in the same unit.
    pub usual: f64,
}

impl ResidualPair {
    /// The same in standard deviations of the noise.
    pub fn standardised(self) -> Self {
        let [before, after, usual] = [self.before, self.after, self.usual].map(|value| value / self.deviation);
        Self { before, after, deviation: 1.0, usual }
    }
}

/// What is usual of each of the residuals `before`: their median size among readings of the same thing (`repeats`), where
/// at least [`FEWEST_ALIKE`] are, else among those of one kind. A stretch of a program that takes longer than the model
/// says in every piece does not stand apart, however long it is.
pub fn usual(before: &[f64], repeats: &[Option<usize>], kinds: &[usize]) -> Vec<f64> {
    let medians = |of: &dyn Fn(usize) -> Option<usize>, fewest: usize| -> BTreeMap<usize, f64> {
        let mut sizes: BTreeMap<usize, Vec<f64>> = BTreeMap::new();
        for (i, value) in before.iter().enumerate() {
            of(i).into_iter().for_each(|own| sizes.entry(own).or_default().push(value.abs()));
        }
        sizes.retain(|_, sizes| sizes.len() >= fewest);
        sizes.into_iter().map(|(own, mut sizes)| (own, median(&mut sizes))).collect()
    };
    let alike = medians(&|i| repeats.get(i).copied().flatten(), FEWEST_ALIKE);
    let of_kind = medians(&|i| kinds.get(i).copied(), 1);
    let usual_of = |i: usize| {
        let same = repeats.get(i).copied().flatten().and_then(|repeat| alike.get(&repeat));
        same.or_else(|| of_kind.get(kinds.get(i)?)).copied().unwrap_or(f64::INFINITY)
    };
    (0..before.len()).map(usual_of).collect()
}

/// Measures of how far a gap shrinks; `NaN` where there is no gap of that kind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// `1 − |Σ after| / |Σ before|`.
    pub mean: f64,
    /// The same without the readings that stand apart.
    pub mean_without_apart: f64,
    /// `1 −` the ratio of root mean squares.
    pub rms: f64,
    /// `1 −` the root of the ratio of mean Huber losses.
    pub robust: f64,
    /// Share of the mean square above the noise that is closed, without the readings that stand apart, at most 1. No
    /// number where less than a fifth of the mean square lies above the noise.
    pub of_closable: f64,
}

/// Places of the readings that stand apart: far off before and after, and by much more than is usual of their like.
pub fn apart(readings: &[ResidualPair]) -> Vec<usize> {
    let far = |own: &ResidualPair| {
        own.before.abs().min(own.after.abs()) > FAR_READING * own.deviation
            && own.before.abs() > BEYOND_ALIKE * own.usual
    };
    (0..readings.len()).filter(|i| far(&readings[*i])).collect()
}

impl Measures {
    /// Of a gap of which nothing is known.
    pub(super) const UNKNOWN: Self =
        Self { mean: f64::NAN, mean_without_apart: f64::NAN, rms: f64::NAN, robust: f64::NAN, of_closable: f64::NAN };

    /// Of readings, each with what two models leave of it.
    pub fn of(readings: &[ResidualPair]) -> Self {
        let apart = apart(readings);
        let ordinary: Vec<ResidualPair> =
            readings.iter().enumerate().filter(|(i, _)| !apart.contains(i)).map(|(_, own)| *own).collect();
        let mean = |readings: &[ResidualPair]| {
            let sum = |of: fn(&ResidualPair) -> f64| readings.iter().map(of).sum::<f64>().abs();
            1.0 - sum(|own| own.after) / sum(|own| own.before)
        };
        let total = |readings: &[ResidualPair], of: &dyn Fn(&ResidualPair) -> f64| readings.iter().map(of).sum::<f64>();
        let ratio = |of: &dyn Fn(f64, f64) -> f64| {
            let after = total(readings, &|own| of(own.after, own.deviation));
            (after / total(readings, &|own| of(own.before, own.deviation))).sqrt()
        };
        let square = |of: fn(&ResidualPair) -> f64| total(&ordinary, &|own| of(own).powi(2));
        let (before, after, floor) = (square(|own| own.before), square(|own| own.after), square(|own| own.deviation));
        let closable = before - floor;
        Self {
            mean: mean(readings),
            mean_without_apart: mean(&ordinary),
            rms: 1.0 - ratio(&|residual, _| residual * residual),
            robust: 1.0 - ratio(&|residual, deviation| huber(residual / deviation)),
            of_closable: if closable > CLOSABLE * before { ((before - after) / closable).min(1.0) } else { f64::NAN },
        }
    }

    /// The measures as `closure` of `diagnosis.json` shows them.
    pub(super) fn json(&self) -> Value {
        json!({
            "mean": number(self.mean), "mean_without_apart": number(self.mean_without_apart), "rms": number(self.rms),
            "robust": number(self.robust), "of_closable": number(self.of_closable),
        })
    }
}

/// Huber's loss of a standardised residual: linear where the noise counts a reading less, too.
fn huber(standard: f64) -> f64 {
    let size = standard.abs();
    if size <= HUBER { 0.5 * size * size } else { HUBER * (size - 0.5 * HUBER) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn readings(before: [f64; 8], after: [f64; 8]) -> Vec<ResidualPair> {
        let usual = usual(&before, &[], &[0; 8])[0];
        let left = |(before, after): (f64, f64)| ResidualPair { before, after, deviation: 1.0, usual };
        before.into_iter().zip(after).map(left).collect()
    }

    const BEFORE: [f64; 8] = [6.0, 5.2, 4.1, 5.8, 120.0, 4.7, 5.5, 6.3];
    const AFTER: [f64; 8] = [0.4, -0.6, 0.9, 0.2, 114.5, -0.3, 0.5, 0.7];

    #[test]
    fn one_reading_rules_the_sum_and_the_others_show_what_is_closed() {
        let all = readings(BEFORE, AFTER);
        assert_eq!(apart(&all), [4]);
        let found = Measures::of(&all);
        // By hand: 1 − 116.3/157.6, 1 − 1.8/37.6; losses by Huber 284.225 and 369.
        let golden = [
            (found.mean, 0.262056),
            (found.mean_without_apart, 0.952128),
            (found.rms, 0.0524909),
            (found.robust, 0.122357),
        ];
        for (found, golden) in golden {
            assert!((found / golden - 1.0).abs() < 2e-6, "{found} instead of {golden}");
        }
        assert_eq!(found.of_closable, 1.0, "1.024 of what lies above the noise is all of it");
    }

    #[test]
    fn what_is_usual_for_one_kind_is_far_for_another() {
        let before: Vec<f64> = BEFORE.into_iter().chain([110.0, 118.0, 125.0]).collect();
        let places = |repeats: &[Option<usize>], kinds: &[usize]| {
            let usual = usual(&before, repeats, kinds).into_iter();
            let left =
                |(before, usual): (&f64, f64)| ResidualPair { before: *before, after: 100.0, deviation: 1.0, usual };
            apart(&before.iter().zip(usual).map(left).collect::<Vec<_>>())
        };
        let mut kinds = [0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1];
        assert_eq!(places(&[], &kinds), [4]);
        kinds[4] = 1;
        assert!(places(&[], &kinds).is_empty());
        // A stretch of a kind whose others are well predicted, off in each of three pieces; in one of them by far more.
        let mut repeats = [None; 11];
        repeats[8..].fill(Some(7));
        assert_eq!(places(&repeats, &[0; 11]), [4]);
        repeats[3..5].fill(Some(7));
        assert!(places(&repeats, &[0; 11]).is_empty(), "the fifth is one of the stretch");
        repeats = [None; 11];
        repeats[8..10].fill(Some(7));
        assert_eq!(places(&repeats, &[0; 11])[..], [4, 8, 9, 10], "two alike say nothing");
    }

    #[test]
    fn without_a_gap_above_the_noise_there_is_no_share_of_it() {
        let noise = readings([1.0, -1.0, 1.1, -0.9, 1.0, -1.0, 0.9, -1.1], AFTER);
        assert!(Measures::of(&noise).of_closable.is_nan());
        assert!(Measures::of(&[]).mean.is_nan() && apart(&[]).is_empty());
    }

    #[test]
    fn the_unit_of_the_readings_does_not_matter() {
        let all = readings(BEFORE, AFTER);
        for unit in [1e-6, 60.0, 1e3] {
            let scaled: Vec<ResidualPair> = all
                .iter()
                .map(|own| ResidualPair {
                    before: unit * own.before,
                    after: unit * own.after,
                    deviation: unit * own.deviation,
                    usual: unit * own.usual,
                })
                .collect();
            assert_eq!(apart(&scaled), apart(&all));
            let (a, b) = (Measures::of(&scaled), Measures::of(&all));
            for (a, b) in [(a.mean, b.mean), (a.rms, b.rms), (a.robust, b.robust), (a.of_closable, b.of_closable)] {
                assert!((a - b).abs() < 1e-9);
            }
        }
    }
}
