//! Stability under uncertain constants: probability and robust speeds.

use crate::axis::Axis;
use crate::error::{ChatterError, within};
use crate::{Milling, Mode, PathModes, SpeedModes, Turning};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Relative standard deviations of the constants of a cut; each constant is lognormal about its
/// nominal value, every mode for itself.
///
/// # Source
/// Independent lognormal scatter is an assumption; 1 to 3 % in frequency, 20 to 30 % in damping and
/// 10 to 20 % in coefficients are usual for tap tests and force models.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Scatter {
    /// Of the natural frequencies, at constant modal mass.
    pub natural_frequency: f64,
    /// Of the damping ratios.
    pub damping_ratio: f64,
    /// Of the cutting-force coefficients.
    pub coefficients: f64,
}

/// A probability from samples.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Probability {
    /// Share of the samples.
    pub value: f64,
    /// Standard error of the share.
    pub standard_error: f64,
}

/// A spindle speed with the probability that it is stable.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RobustSpeed {
    /// Spindle speed (rad/s).
    pub spindle_speed: f64,
    /// Probability of stability there.
    pub probability: Probability,
}

impl Milling {
    /// The cut with its constants scattered, the same for the same `seed` and `sample`.
    ///
    /// # Errors
    /// Deviations outside 0 … 1.
    pub fn scattered(&self, scatter: &Scatter, seed: u64, sample: u64) -> Result<Self, ChatterError> {
        scatter.check()?;
        let mut draw = Draw::new(seed, sample);
        let mut cut = self.clone();
        draw.scatter(&mut cut.modes, (cut.by_speed.as_mut(), cut.along_path.as_mut()), scatter);
        cut.force.tangential *= draw.factor(scatter.coefficients);
        // Radial and axial force are one on the face of the tooth, and scatter together.
        let factor = draw.factor(scatter.coefficients);
        cut.force.radial *= factor;
        cut.force.axial *= factor;
        Ok(cut)
    }

    /// Probability that `depth` (m) at `spindle_speed` (rad/s) is stable.
    ///
    /// # Errors
    /// As [`Milling::verdict`] and [`Milling::scattered`]; no samples.
    pub fn stability_probability(
        &self,
        spindle_speed: f64,
        depth: f64,
        scatter: &Scatter,
        samples: u64,
        seed: u64,
    ) -> Result<Probability, ChatterError> {
        share_stable(samples, |sample| {
            let cut = self.scattered(scatter, seed, sample)?;
            Ok(cut.at_speed(spindle_speed)?.screen(depth)?.stable)
        })
    }

    /// Whether at least the share `required` of the samples is stable at `depth` (m) and `spindle_speed` (rad/s): as
    /// [`Milling::stability_probability`], for less work. A sample whose verdict is not found counts as unstable.
    ///
    /// # Errors
    /// As [`Milling::stability_probability`].
    pub fn is_probably_stable(
        &self,
        (spindle_speed, depth): (f64, f64),
        scatter: &Scatter,
        samples: u64,
        seed: u64,
        required: f64,
    ) -> Result<bool, ChatterError> {
        reaches(samples, required, |sample| {
            let cut = self.scattered(scatter, seed, sample)?;
            Ok(cut.at_speed(spindle_speed)?.screen(depth)?.stable)
        })
    }

    /// The first of `speeds` (rad/s) among those at which `depth` (m) is stable most probably: as [`Milling::robust_speeds`]
    /// ranks them, for less work. A sample is judged only where its speed can still be better than those before it; one
    /// whose verdict is not found counts as unstable. None of no speeds.
    ///
    /// # Errors
    /// As [`Milling::stability_probability`].
    pub fn most_probably_stable(
        &self,
        speeds: &[f64],
        depth: f64,
        scatter: &Scatter,
        samples: u64,
        seed: u64,
    ) -> Result<Option<f64>, ChatterError> {
        most_probable(speeds, samples, |speed, sample| {
            let cut = self.scattered(scatter, seed, sample)?;
            Ok(cut.at_speed(speed)?.screen(depth)?.stable)
        })
    }

    /// Speeds of `speed` with the probability that `depth` (m) is stable there, the most probable
    /// first; of equals the one whose neighbours are the most probable. The same samples judge
    /// every speed.
    ///
    /// # Errors
    /// As [`Milling::stability_probability`]; an axis that is none.
    pub fn robust_speeds(
        &self,
        speed: &Axis,
        depth: f64,
        scatter: &Scatter,
        samples: u64,
        seed: u64,
    ) -> Result<Vec<RobustSpeed>, ChatterError> {
        ranked(speed, |speed| self.stability_probability(speed, depth, scatter, samples, seed))
    }
}

impl Turning {
    /// The cut with its constants scattered, the same for the same `seed` and `sample`.
    ///
    /// # Errors
    /// Deviations outside 0 … 1.
    pub fn scattered(&self, scatter: &Scatter, seed: u64, sample: u64) -> Result<Self, ChatterError> {
        scatter.check()?;
        let mut draw = Draw::new(seed, sample);
        let mut cut = self.clone();
        draw.scatter(&mut cut.modes, (cut.by_speed.as_mut(), cut.along_path.as_mut()), scatter);
        cut.cutting_coefficient *= draw.factor(scatter.coefficients);
        Ok(cut)
    }

    /// Probability that `width` (m) at `spindle_speed` (rad/s) is stable.
    ///
    /// # Errors
    /// As [`Turning::verdict`] and [`Turning::scattered`]; no samples.
    ///
    /// # Examples
    /// ```
    /// use toolroom_chatter::{Mode, Scatter, Turning};
    /// let mode = Mode { direction: [1.0, 0.0], natural_frequency: 540.9, damping_ratio: 0.038, stiffness: 6.48e6 };
    /// let cut = Turning::orthogonal(vec![mode], 1384e6, 0.035);
    /// let scatter = Scatter { natural_frequency: 0.02, damping_ratio: 0.2, coefficients: 0.1 };
    /// let limit = cut.limit(600.0).unwrap().depth;
    /// let probable = |width| cut.stability_probability(600.0, width, &scatter, 100, 1).unwrap().value;
    /// assert!(probable(0.5 * limit) > 0.95 && probable(2.0 * limit) < 0.05);
    /// ```
    pub fn stability_probability(
        &self,
        spindle_speed: f64,
        width: f64,
        scatter: &Scatter,
        samples: u64,
        seed: u64,
    ) -> Result<Probability, ChatterError> {
        share_stable(samples, |sample| {
            let cut = self.scattered(scatter, seed, sample)?;
            cut.is_stable(spindle_speed, width)
        })
    }

    /// Whether at least the share `required` of the samples is stable at `width` (m) and `spindle_speed` (rad/s): as
    /// [`Turning::stability_probability`], for less work. A sample whose verdict is not found counts as unstable.
    ///
    /// # Errors
    /// As [`Turning::stability_probability`].
    pub fn is_probably_stable(
        &self,
        (spindle_speed, width): (f64, f64),
        scatter: &Scatter,
        samples: u64,
        seed: u64,
        required: f64,
    ) -> Result<bool, ChatterError> {
        reaches(samples, required, |sample| self.scattered(scatter, seed, sample)?.is_stable(spindle_speed, width))
    }

    /// The first of `speeds` (rad/s) among those at which `width` (m) is stable most probably: as [`Turning::robust_speeds`]
    /// ranks them, for less work. A sample is judged only where its speed can still be better than those before it; one
    /// whose verdict is not found counts as unstable. None of no speeds.
    ///
    /// # Errors
    /// As [`Turning::stability_probability`].
    pub fn most_probably_stable(
        &self,
        speeds: &[f64],
        width: f64,
        scatter: &Scatter,
        samples: u64,
        seed: u64,
    ) -> Result<Option<f64>, ChatterError> {
        most_probable(speeds, samples, |speed, sample| self.scattered(scatter, seed, sample)?.is_stable(speed, width))
    }

    /// Speeds of `speed` with the probability that `width` (m) is stable there, ordered as by
    /// [`Milling::robust_speeds`].
    ///
    /// # Errors
    /// As [`Turning::stability_probability`]; an axis that is none.
    pub fn robust_speeds(
        &self,
        speed: &Axis,
        width: f64,
        scatter: &Scatter,
        samples: u64,
        seed: u64,
    ) -> Result<Vec<RobustSpeed>, ChatterError> {
        ranked(speed, |speed| self.stability_probability(speed, width, scatter, samples, seed))
    }
}

impl Scatter {
    fn check(&self) -> Result<(), ChatterError> {
        within("natural_frequency scatter", self.natural_frequency, 0.0, 1.0)?;
        within("damping_ratio scatter", self.damping_ratio, 0.0, 1.0)?;
        within("coefficients scatter", self.coefficients, 0.0, 1.0)?;
        Ok(())
    }
}

/// Share of samples that are stable.
fn share_stable(
    samples: u64,
    stable: impl Fn(u64) -> Result<bool, ChatterError> + Sync + Send,
) -> Result<Probability, ChatterError> {
    within("samples", samples as f64, 1.0, 1e9)?;
    let stable: Result<Vec<bool>, ChatterError> = (0..samples).into_par_iter().map(stable).collect();
    let value = stable?.into_iter().filter(|stable| *stable).count() as f64 / samples as f64;
    Ok(Probability { value, standard_error: (value * (1.0 - value) / samples as f64).sqrt() })
}

/// Samples that are judged at once before the answer is looked at.
const AT_ONCE: u64 = 32;

/// Whether the share of stable samples is `required` at least, asking no more samples than that takes.
fn reaches(
    samples: u64,
    required: f64,
    stable: impl Fn(u64) -> Result<bool, ChatterError> + Sync + Send,
) -> Result<bool, ChatterError> {
    within("samples", samples as f64, 1.0, 1e9)?;
    let due = (required * samples as f64).ceil() as u64;
    let (mut judged, mut found) = (0, 0);
    while judged < samples {
        let end = (judged + AT_ONCE).min(samples);
        let judge = |sample: u64| match stable(sample) {
            Err(error) if error.is_failed_search() => Ok(false),
            outcome => outcome,
        };
        let outcomes: Result<Vec<bool>, ChatterError> = (judged..end).into_par_iter().map(judge).collect();
        found += outcomes?.into_iter().filter(|stable| *stable).count() as u64;
        judged = end;
        if found >= due || samples - judged < due - found {
            break;
        }
    }
    Ok(found >= due)
}

/// Samples that are judged at once before it is asked whether a speed can still be the best: few, since most speeds are
/// given up after some.
const AT_ONCE_BEST: u64 = 8;

/// The first speed with the most stable samples.
fn most_probable(
    speeds: &[f64],
    samples: u64,
    stable: impl Fn(f64, u64) -> Result<bool, ChatterError> + Sync + Send,
) -> Result<Option<f64>, ChatterError> {
    within("samples", samples as f64, 1.0, 1e9)?;
    let mut best: Option<(f64, u64)> = None;
    for speed in speeds {
        let (mut judged, mut found) = (0, 0);
        let beaten = |found: u64, judged: u64| best.is_some_and(|(_, most)| found + samples - judged <= most);
        while judged < samples && !beaten(found, judged) {
            let end = (judged + AT_ONCE_BEST).min(samples);
            let judge = |sample: u64| match stable(*speed, sample) {
                Err(error) if error.is_failed_search() => Ok(false),
                outcome => outcome,
            };
            let outcomes: Result<Vec<bool>, ChatterError> = (judged..end).into_par_iter().map(judge).collect();
            found += outcomes?.into_iter().filter(|stable| *stable).count() as u64;
            judged = end;
        }
        if !beaten(found, judged) {
            best = Some((*speed, found));
        }
    }
    Ok(best.map(|(speed, _)| speed))
}

/// Speeds by their probability; of equals the one with the most probable neighbours first.
fn ranked(
    speed: &Axis,
    probability: impl Fn(f64) -> Result<Probability, ChatterError>,
) -> Result<Vec<RobustSpeed>, ChatterError> {
    let speeds = speed.values("speed")?;
    let mut ranked = Vec::with_capacity(speeds.len());
    for spindle_speed in speeds {
        ranked.push(RobustSpeed { spindle_speed, probability: probability(spindle_speed)? });
    }
    let values: Vec<f64> = ranked.iter().map(|r| r.probability.value).collect();
    let neighbourhood = |i: usize| {
        let (from, to) = (i.saturating_sub(3), (i + 4).min(values.len()));
        values[from..to].iter().sum::<f64>() / (to - from) as f64
    };
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| {
        values[*b].total_cmp(&values[*a]).then(neighbourhood(*b).total_cmp(&neighbourhood(*a))).then(a.cmp(b))
    });
    Ok(order.into_iter().map(|i| ranked[i]).collect())
}

/// Normal numbers by counter: the n-th draw of a key is always the same.
#[derive(Clone, Debug)]
pub struct Draw {
    key: u64,
    counter: u64,
}

impl Draw {
    /// The draws of `sample` under `seed`.
    pub fn new(seed: u64, sample: u64) -> Self {
        Self { key: seed ^ sample.wrapping_mul(0x9E37_79B9_7F4A_7C15), counter: 0 }
    }

    /// Scatters every mode for itself, at constant modal mass; a mode by speed or along a path alike everywhere.
    fn scatter(
        &mut self,
        modes: &mut [Mode],
        (by_speed, along_path): (Option<&mut SpeedModes>, Option<&mut PathModes>),
        scatter: &Scatter,
    ) {
        let factors: Vec<(f64, f64)> = modes
            .iter()
            .map(|_| {
                let frequency = self.factor(scatter.natural_frequency);
                (frequency, self.factor(scatter.damping_ratio))
            })
            .collect();
        let other = |number: usize, mode: &Mode| {
            let Some((frequency, damping)) = factors.get(number).copied() else { return *mode };
            Mode {
                natural_frequency: mode.natural_frequency * frequency,
                stiffness: mode.stiffness * frequency * frequency,
                damping_ratio: (mode.damping_ratio * damping).min(0.99),
                ..*mode
            }
        };
        for (number, mode) in modes.iter_mut().enumerate() {
            *mode = other(number, mode);
        }
        if let Some(table) = by_speed {
            *table = table.map(other);
        }
        if let Some(path) = along_path {
            *path = path.map(other);
        }
    }

    /// Uniform in 0 … 1, zero excluded (SplitMix64, Steele, Lea and Flood 2014).
    pub fn uniform(&mut self) -> f64 {
        self.counter += 1;
        let mut z = self.key.wrapping_add(self.counter.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64 + f64::EPSILON / 4.0
    }

    /// Standard normal (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let (u, v) = (self.uniform(), self.uniform());
        (-2.0 * u.ln()).sqrt() * (TAU * v).cos()
    }

    /// Lognormal factor of mean one with the relative standard deviation `deviation`.
    fn factor(&mut self, deviation: f64) -> f64 {
        let normal = self.normal();
        let sigma = (1.0 + deviation * deviation).ln().sqrt();
        (sigma * normal - 0.5 * sigma * sigma).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_have_the_stated_mean_and_deviation() {
        let mut draw = Draw { key: 42, counter: 0 };
        let factors: Vec<f64> = (0..40_000).map(|_| draw.factor(0.2)).collect();
        let mean = factors.iter().sum::<f64>() / factors.len() as f64;
        let variance = factors.iter().map(|f| (f - mean).powi(2)).sum::<f64>() / factors.len() as f64;
        assert!((mean - 1.0).abs() < 0.005 && (variance.sqrt() - 0.2).abs() < 0.005, "{mean} {}", variance.sqrt());
    }
}
