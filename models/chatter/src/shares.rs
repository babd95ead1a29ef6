//! The share of scattered cuts that is stable, over a grid of speeds and depths.
//!
//! Only on which side of the boundary a point lies is asked. In turning the number of unstable roots tells it at all widths of a
//! speed at once. In milling the spectral radius is looked at in every fourth depth, and between two of them only where it
//! changes its side or, by its slopes, may do so.

use crate::error::{ChatterError, within};
use crate::milling::AtSpeed;
use crate::turning::TurningAtSpeed;
use crate::{Milling, Scatter, Turning};
use rayon::prelude::*;
use std::borrow::Cow;
use toolroom_spectral::may_reach_zero;

/// Depths of the grid in one step in which the spectral radius is sampled at first (assumption; a test compares with every
/// depth).
const STRIDE: usize = 4;

/// Excess that stands for a radius that was not found, which counts as unstable.
const NOT_FOUND: f64 = 1.0;

impl Milling {
    /// Shares of the samples that are stable over a grid of speeds (rad/s) and depths (m), all depths of the first speed
    /// first; a sample whose verdict is not found counts as unstable. Between depths that lie four apart only those are judged
    /// where the spectral radius may change its side, as in [`AtSpeed::stable_intervals`].
    ///
    /// # Errors
    /// As [`Milling::stability_probability`].
    pub fn stability_probabilities(
        &self,
        speeds: &[f64],
        depths: &[f64],
        scatter: &Scatter,
        samples: u64,
        seed: u64,
    ) -> Result<Vec<f64>, ChatterError> {
        shares(samples, [speeds, depths], |sample, speeds| {
            let cut = self.scattered(scatter, seed, sample)?;
            let greatest = depths.iter().copied().fold(0.0, f64::max);
            let column = |speed: &f64| {
                let mut at_speed = cut.at_speed(*speed)?.up_to(greatest);
                stable(depths, |depth| at_speed.side(depth))
            };
            Ok(speeds.par_iter().map(column).collect())
        })
    }
}

impl AtSpeed<'_> {
    /// Logarithm of the spectral radius at `depth` (m), of the right sign.
    fn side(&mut self, depth: f64) -> Result<f64, ChatterError> {
        within("depth", depth, 0.0, f64::MAX)?;
        if depth == 0.0 { Ok(self.uncut_excess()) } else { self.screened_excess(depth) }
    }
}

impl Turning {
    /// Shares of the samples that are stable over a grid of speeds (rad/s) and widths (m), as
    /// [`Milling::stability_probabilities`].
    ///
    /// # Errors
    /// As [`Turning::stability_probability`].
    pub fn stability_probabilities(
        &self,
        speeds: &[f64],
        widths: &[f64],
        scatter: &Scatter,
        samples: u64,
        seed: u64,
    ) -> Result<Vec<f64>, ChatterError> {
        let greatest = widths.iter().copied().fold(0.0, f64::max);
        for width in widths {
            within("width", *width, 0.0, f64::MAX)?;
        }
        shares(samples, [speeds, widths], |sample, speeds| {
            let places = self.scattered(scatter, seed, sample)?.places();
            let column = |speed: &f64| -> Result<Vec<bool>, ChatterError> {
                let mut prepared = Vec::with_capacity(places.len());
                for (_, cut) in &places {
                    prepared.push(TurningAtSpeed::new(Cow::Borrowed(cut), *speed, greatest)?);
                }
                Ok(widths.iter().map(|width| prepared.iter().all(|cut| cut.unstable_roots(*width) == 0)).collect())
            };
            Ok(speeds.par_iter().map(column).collect())
        })
    }
}

/// Which of the depths are stable, where `excess` is positive at those that are not.
fn stable(depths: &[f64], mut excess: impl FnMut(f64) -> Result<f64, ChatterError>) -> Result<Vec<bool>, ChatterError> {
    let mut excess = |depth: f64| match excess(depth) {
        Err(error) if error.is_failed_search() => Ok(NOT_FOUND),
        found => found,
    };
    let Some(last) = depths.len().checked_sub(1) else { return Ok(Vec::new()) };
    let mut order: Vec<usize> = (0..depths.len()).collect();
    order.sort_by(|a, b| depths[*a].total_cmp(&depths[*b]));
    // The last but one tells the slope at the end.
    let mut places: Vec<usize> = (0..last).step_by(STRIDE).chain([last.saturating_sub(1), last]).collect();
    places.dedup();
    let mut found = vec![None; depths.len()];
    for place in &places {
        found[*place] = Some(excess(depths[order[*place]])?);
    }
    let sample = |found: &[Option<f64>], place: usize| found[place].map(|value| (depths[order[place]], value));
    // Steps between samples, each with the samples beside it, the shallowest last.
    let mut steps: Vec<[Option<usize>; 4]> = Vec::new();
    for i in (1..places.len()).rev() {
        let before = i.checked_sub(2).map(|before| places[before]);
        steps.push([before, Some(places[i - 1]), Some(places[i]), places.get(i + 1).copied()]);
    }
    while let Some(step) = steps.pop() {
        let [before, Some(from), Some(to), after] = step else { continue };
        if to - from < 2 {
            continue;
        }
        let known = |place: Option<usize>| place.and_then(|place| sample(&found, place));
        let (Some(left), Some(right)) = (known(Some(from)), known(Some(to))) else { continue };
        let one_side = (left.1 > 0.0) == (right.1 > 0.0);
        if one_side && !may_reach_zero([None, known(before), Some(left), Some(right), known(after), None]) {
            found[from + 1..to].fill(Some(left.1));
            continue;
        }
        let middle = from + (to - from) / 2;
        found[middle] = Some(excess(depths[order[middle]])?);
        steps.push([Some(from), Some(middle), Some(to), after]);
        steps.push([before, Some(from), Some(middle), Some(to)]);
    }
    let mut stable = vec![false; depths.len()];
    for (place, value) in order.into_iter().zip(found) {
        stable[place] = value.is_some_and(|value| value < 0.0);
    }
    Ok(stable)
}

/// Share of samples in which a point is stable, for every point of a grid; a speed without an answer counts as unstable.
fn shares(
    samples: u64,
    [speeds, depths]: [&[f64]; 2],
    columns: impl Fn(u64, &[f64]) -> Result<Vec<Result<Vec<bool>, ChatterError>>, ChatterError>,
) -> Result<Vec<f64>, ChatterError> {
    within("samples", samples as f64, 1.0, 1e9)?;
    let mut counts = vec![0u64; speeds.len() * depths.len()];
    for sample in 0..samples {
        for (column, counts) in columns(sample, speeds)?.into_iter().zip(counts.chunks_exact_mut(depths.len().max(1))) {
            match column {
                Ok(stable) => counts.iter_mut().zip(stable).for_each(|(count, stable)| *count += u64::from(stable)),
                Err(error) if error.is_failed_search() => {}
                Err(error) => return Err(error),
            }
        }
    }
    Ok(counts.into_iter().map(|count| count as f64 / samples as f64).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cutter, Direction, Engagement, MillingForce, Mode};
    use std::f64::consts::TAU;

    const CERTAIN: Scatter = Scatter { natural_frequency: 0.0, damping_ratio: 0.0, coefficients: 0.0 };

    fn even(start: f64, end: f64, count: usize) -> Vec<f64> {
        (0..count).map(|i| start + (end - start) * i as f64 / (count - 1) as f64).collect()
    }

    fn rpm(start: f64, end: f64, count: usize) -> Vec<f64> {
        even(start / 60.0 * TAU, end / 60.0 * TAU, count)
    }

    #[test]
    fn every_depth_of_a_chart_with_islands_is_told_by_few() {
        let mode = |direction, natural_frequency| Mode {
            direction,
            natural_frequency,
            damping_ratio: 0.011,
            stiffness: 1.34e6,
        };
        let helical = Milling {
            modes: vec![mode([1.0, 0.0], 922.0)],
            cutter: Cutter { helix_angle: TAU / 8.0, ..Cutter::straight(2, 0.008) },
            engagement: Engagement::new(0.05, Direction::Down).unwrap(),
            force: MillingForce::new(6e8, 2e8),
            feed_per_tooth: 1e-4,
            by_speed: None,
            along_path: None,
        };
        let slot = Milling {
            modes: vec![mode([1.0, 0.0], 922.0), mode([0.3, 1.0], 1050.0)],
            cutter: Cutter::straight(2, 0.008),
            engagement: Engagement::new(1.0, Direction::Down).unwrap(),
            ..helical.clone()
        };
        for (cut, speeds, greatest) in [(helical, rpm(16_500.0, 18_300.0, 13), 8.5e-3), (slot, rpm(5e3, 2e4, 13), 1e-3)]
        {
            let depths = even(0.0, greatest, 41);
            let shares = cut.stability_probabilities(&speeds, &depths, &CERTAIN, 1, 1).unwrap();
            let chart = cut.lobes(&speeds, &depths).unwrap();
            let judged: Vec<f64> = chart.verdicts.iter().map(|v| if v.unwrap().stable { 1.0 } else { 0.0 }).collect();
            assert_eq!(shares, judged);
            // In any order of the depths.
            let backwards: Vec<f64> = depths.iter().rev().copied().collect();
            let turned = cut.stability_probabilities(&speeds[..1], &backwards, &CERTAIN, 1, 1).unwrap();
            assert!(turned.iter().rev().eq(&shares[..depths.len()]));
        }
    }

    #[test]
    fn widths_of_turning_are_told_as_by_their_verdicts() {
        let mode = |direction, natural_frequency, damping_ratio, stiffness| Mode {
            direction,
            natural_frequency,
            damping_ratio,
            stiffness,
        };
        let modes =
            vec![mode([0.92375, 0.38299], 208.7, 0.0288, 4.364e7), mode([0.99968, 0.02534], 815.0, 0.0119, 7.659e6)];
        let cut = Turning {
            force_angle: 13.6f64.to_radians(),
            process_damping: 6.856e5,
            ..Turning::orthogonal(modes, 1081e6, 0.04)
        };
        let (speeds, widths) = (rpm(2000.0, 2300.0, 9), even(0.0, 2e-3, 31));
        let shares = cut.stability_probabilities(&speeds, &widths, &CERTAIN, 1, 1).unwrap();
        let chart = cut.lobe_chart(&speeds, &widths).unwrap();
        let judged: Vec<f64> = chart.verdicts.iter().map(|v| if v.unwrap().stable { 1.0 } else { 0.0 }).collect();
        assert_eq!(shares, judged);
    }
}
