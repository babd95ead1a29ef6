//! What noisy trials of settings say together.
//!
//! ```text
//!  values by setting and replication ──► means under common random numbers, variance of a value
//!        ──► quadratic surface through all, or those around the best where all deny one ──► variance of what the surface leaves out
//!        ──► estimates: the surface, and as much of each point's own deviation as its replications bear out
//! ```
//! The least of many noisy means is mostly a lucky one, and each mean rests on its own replications alone. A surface rests on all
//! of them. It is not the whole truth either: the cost of a part over the wear at which edges are changed has kinks, because edges
//! are changed between passes. The estimate of a point is therefore a weighted mean of the surface and of the point's own mean.
//! [`Shares`] says the same of how many of the edges are lost, for a guard.
//!
//! # Source
//! G. E. P. Box, K. B. Wilson, J. Royal Statistical Society B 13 (1951) 1 (quadratic response surfaces); R. C. Paule, J. Mandel,
//! J. Research NBS 87 (1982) 377 (variance between points from weighted squares); B. Efron, C. Morris, J. American Statistical
//! Association 70 (1975) 311 (shrinkage toward a regression).
//!
//! # What is not modelled
//! Every value has the same variance, and what the surface leaves out at one point says nothing of its neighbours.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod quadratic;
mod share;

use quadratic::{Reading, Surface};
pub use share::{Count, Shares};

/// Sweeps that separate settings from replications; each takes a share of the error that is left, and points share most of
/// their replications.
const SWEEPS: usize = 60;
/// A setting that was tried.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Its place on each axis, in steps of the first grid.
    pub at: Vec<f64>,
    /// What is to be least, in the first replications; the same replications of all trials share their random numbers.
    pub values: Vec<f64>,
}

/// What trials say together.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimates {
    /// Estimated mean of each trial; infinite where a value is not finite or there is none.
    pub means: Vec<f64>,
    /// Variance of a value about the sum of its setting's and its replication's mean.
    pub variance: f64,
    surface: Option<Surface>,
}

impl Estimates {
    /// What `trials` say together.
    ///
    /// # Examples
    /// ```
    /// use toolroom_surface::{Estimates, Trial};
    /// // A parabola, and a replication that is dear for everybody.
    /// let trial = |x: i32| {
    ///     let mean = f64::from((x - 3) * (x - 3));
    ///     Trial { at: vec![f64::from(x)], values: vec![mean, mean + 5.0] }
    /// };
    /// let found = Estimates::from_trials(&(0..7).map(trial).collect::<Vec<_>>());
    /// assert!((found.least(|_| true).unwrap()[0] - 3.0).abs() < 1e-9 && (found.means[5] - found.means[3] - 4.0).abs() < 1e-9);
    /// // Where the best settings may not be taken, the surface is laid around the best of the others.
    /// let trials: Vec<Trial> = (0..7).map(trial).collect();
    /// let found = Estimates::among(&trials, &[true, true, true, false, false, false, false]);
    /// assert!((found.least(|at| at[0] <= 2.5).unwrap()[0] - 2.5).abs() < 1e-9);
    /// ```
    pub fn from_trials(trials: &[Trial]) -> Self {
        Self::among(trials, &vec![true; trials.len()])
    }

    /// The same with the surface around the best of those trials that are `allowed`. The others still tell of the surface.
    pub fn among(trials: &[Trial], allowed: &[bool]) -> Self {
        let (means, variance) = separated(trials);
        let best_of = |values: &[f64]| {
            let of_allowed =
                values.iter().zip(allowed).map(|(value, allowed)| if *allowed { *value } else { f64::INFINITY });
            lowest(&of_allowed.collect::<Vec<_>>())
        };
        let none = Self { means: means.clone(), variance, surface: None };
        let Some(mut best) = best_of(&means) else { return none };
        let readings: Vec<Reading<'_>> = (trials.iter().zip(&means))
            .map(|(trial, mean)| Reading {
                at: &trial.at,
                mean: *mean,
                error: variance / trial.values.len().max(1) as f64,
            })
            .collect();
        let mut found = none;
        // The best by its own mean may be a lucky one: the surface around it says where its neighbours are.
        for _ in 0..3 {
            let Some(surface) = Surface::around(&readings, best) else { return found };
            let mut estimates = means.clone();
            for &place in &surface.fitted {
                estimates[place] = surface.estimate(&readings[place]).0;
            }
            found = Self { means: estimates, variance, surface: Some(surface) };
            let next = best_of(&found.means).unwrap_or(best);
            if next == best {
                break;
            }
            best = next;
        }
        found
    }

    /// Variance of points about the surface; `None` where no surface could be fitted.
    pub fn deviation(&self) -> Option<f64> {
        Some(self.surface.as_ref()?.deviation)
    }

    /// Places an eighth of a step of the first grid apart within the points that the surface fits, and its height there;
    /// none without a surface.
    pub fn heights(&self) -> Vec<(Vec<f64>, f64)> {
        self.surface.as_ref().map_or_else(Vec::new, Surface::heights)
    }

    /// Where the surface is least among the places that are `allowed`; `None` without a surface or such a place.
    pub fn least(&self, allowed: impl Fn(&[f64]) -> bool) -> Option<Vec<f64>> {
        let places = self.heights().into_iter().filter(|(at, _)| allowed(at));
        places.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, _)| at)
    }
}

/// Index of the least finite value.
fn lowest(values: &[f64]) -> Option<usize> {
    (0..values.len()).filter(|place| values[*place].is_finite()).min_by(|a, b| values[*a].total_cmp(&values[*b]))
}

/// Means of the trials as if all had had all replications, and the variance of a value.
fn separated(trials: &[Trial]) -> (Vec<f64>, f64) {
    let usable = |trial: &Trial| !trial.values.is_empty() && trial.values.iter().all(|value| value.is_finite());
    let used: Vec<usize> = (0..trials.len()).filter(|place| usable(&trials[*place])).collect();
    let most = used.iter().map(|place| trials[*place].values.len()).max().unwrap_or(0);
    let mut means = vec![f64::INFINITY; trials.len()];
    let mut of_replication = vec![0.0; most];
    for _ in 0..SWEEPS {
        for &place in &used {
            let values = &trials[place].values;
            let sum = values.iter().zip(&of_replication).map(|(value, shift)| value - shift).sum::<f64>();
            means[place] = sum / values.len() as f64;
        }
        for (replication, shift) in of_replication.iter_mut().enumerate() {
            let of = used.iter().filter_map(|place| Some(trials[*place].values.get(replication)? - means[*place]));
            let (count, sum) = of.fold((0.0, 0.0), |(count, sum), value| (count + 1.0, sum + value));
            *shift = sum / f64::max(count, 1.0);
        }
    }
    let (mut squares, mut count) = (0.0, 0.0);
    for &place in &used {
        for (value, shift) in trials[place].values.iter().zip(&of_replication) {
            squares += (value - shift - means[place]).powi(2);
            count += 1.0;
        }
    }
    let free = count - used.len() as f64 - most as f64 + 1.0;
    (means, if free > 0.0 { squares / free } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers that look like noise of unit variance, the same on every machine.
    struct Noise(u64);

    impl Noise {
        fn next(&mut self) -> f64 {
            let uniform = || {
                self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 11) as f64 / (1_u64 << 53) as f64
            };
            std::iter::repeat_with(uniform).take(12).sum::<f64>() - 6.0
        }
    }

    fn grid() -> Vec<Vec<f64>> {
        (0..6).flat_map(|i| (0..4).map(move |j| vec![f64::from(i), f64::from(j)])).collect()
    }

    fn truth(at: &[f64]) -> f64 {
        34.0 + 0.6 * (at[0] - 2.7).powi(2) + 0.9 * (at[1] - 1.4).powi(2)
    }

    #[test]
    fn the_surface_finds_a_better_setting_than_the_least_of_noisy_means() {
        let (mut by_mean, mut by_estimate) = (0.0, 0.0);
        for seed in 0..60 {
            let mut noise = Noise(seed);
            let shared: Vec<f64> = (0..8).map(|_| 2.0 * noise.next()).collect();
            let trial = |at: Vec<f64>| {
                let mean = truth(&at);
                Trial { values: shared.iter().map(|own| mean + own + 1.5 * noise.next()).collect(), at }
            };
            let trials: Vec<Trial> = grid().into_iter().map(trial).collect();
            let estimates = Estimates::from_trials(&trials);
            let own: Vec<f64> = trials.iter().map(|trial| trial.values.iter().sum::<f64>()).collect();
            let loss = |place: Option<usize>| truth(&trials[place.expect("a trial")].at) - 34.0;
            by_mean += loss(lowest(&own)) / 60.0;
            by_estimate += loss(lowest(&estimates.means)) / 60.0;
        }
        assert!(by_estimate < 0.75 * by_mean, "{by_estimate} against {by_mean}");
    }

    #[test]
    fn a_kink_that_many_replications_bear_out_is_believed_and_a_lucky_mean_is_not() {
        let trials = |replications: usize| -> Vec<Trial> {
            let mut noise = Noise(7);
            let trial = |at: Vec<f64>| {
                let kink = if at == [3.0, 2.0] { -0.8 } else { 0.0 };
                let mean = truth(&at) + kink;
                Trial { values: (0..replications).map(|_| mean + noise.next()).collect(), at }
            };
            grid().into_iter().map(trial).collect()
        };
        let kinked = |trials: &[Trial]| {
            let place = trials.iter().position(|trial| trial.at == [3.0, 2.0]).expect("a trial");
            Estimates::from_trials(trials).means[place] - truth(&[3.0, 2.0])
        };
        assert!((kinked(&trials(400)) + 0.8).abs() < 0.15, "{}", kinked(&trials(400)));
        assert!(kinked(&trials(3)) > -0.6, "{}", kinked(&trials(3)));
    }

    #[test]
    fn settings_without_a_value_are_infinite_and_few_points_have_no_surface() {
        let trial = |x: f64, value: f64| Trial { at: vec![x], values: vec![value] };
        let estimates = Estimates::from_trials(&[trial(0.0, 3.0), trial(1.0, f64::INFINITY), trial(2.0, 1.0)]);
        assert_eq!((estimates.least(|_| true), estimates.means), (None, vec![3.0, f64::INFINITY, 1.0]));
        assert_eq!(Estimates::from_trials(&[]).means, Vec::<f64>::new());
    }
}
