//! Noise as the data show it: scale, memory and outliers of each channel.

use super::Measured;
use toolroom_statistics::median;

/// Residuals beyond this many standard deviations lose weight (Huber).
pub(crate) const HUBER: f64 = 2.5;
/// A sensor is never believed to be better than this share of its sheet (assumption).
const LEAST_SCALE: f64 = 0.5;
/// Consistency of the median absolute deviation with a normal standard deviation.
pub(crate) const MAD: f64 = 1.4826;
/// Greatest memory that is believed.
const GREATEST_MEMORY: f64 = 0.95;
/// Fewer residuals than these say nothing about a channel's noise.
const FEW: usize = 12;

/// Noise model: AR(1) within a run, a scale on the sensor sheet, weights of outliers.
#[derive(Clone, Debug, PartialEq)]
pub struct Noise {
    /// Scale on the sensor's standard deviation, by channel.
    pub scale: Vec<f64>,
    /// Correlation of neighbours within a run, by channel.
    pub memory: Vec<f64>,
    /// Root of the weight of each whitened value.
    pub weight: Vec<f64>,
}

impl Noise {
    /// The sensor sheet as it stands.
    pub fn of_sheet(measured: &Measured) -> Self {
        let channels = measured.channels.len();
        Self { scale: vec![1.0; channels], memory: vec![0.0; channels], weight: vec![1.0; measured.len()] }
    }

    /// Noise from the residuals of a model rich enough to hold no structure any more; `freedom` is
    /// the share of degrees of freedom that its fit left.
    pub fn estimate(measured: &Measured, residual: &[f64], freedom: f64) -> Self {
        let mut noise = Self::of_sheet(measured);
        let fitted = |run: &&std::ops::Range<usize>| {
            measured.fitted[measured.group_of_row[measured.observations[run.start].row]]
        };
        for channel in 0..measured.channels.len() {
            let runs: Vec<_> = measured
                .runs
                .iter()
                .filter(fitted)
                .filter(|run| measured.observations[run.start].channel == channel)
                .collect();
            let standard = |i: usize| residual[i] / measured.observations[i].deviation;
            let count: usize = runs.iter().map(|run| run.len()).sum();
            if count < FEW {
                continue;
            }
            let (mut product, mut square) = (0.0, 0.0);
            for run in &runs {
                for i in run.start + 1..run.end {
                    let (a, b) = (clipped(standard(i - 1)), clipped(standard(i)));
                    product += a * b;
                    square += 0.5 * (a * a + b * b);
                }
            }
            let memory: f64 = if square > 0.0 { (product / square).clamp(0.0, GREATEST_MEMORY) } else { 0.0 };
            let mut whitened: Vec<f64> = Vec::with_capacity(count);
            for run in &runs {
                whitened.push(standard(run.start).abs());
                let innovation = (1.0 - memory * memory).sqrt();
                whitened.extend(
                    (run.start + 1..run.end).map(|i| ((standard(i) - memory * standard(i - 1)) / innovation).abs()),
                );
            }
            noise.memory[channel] = memory;
            // Most counts of rare events are alike and say nothing about their scatter.
            let scatter = if measured.rare[channel] {
                (whitened.iter().map(|value| value * value).sum::<f64>() / whitened.len() as f64).sqrt()
            } else {
                MAD * median(&mut whitened)
            };
            noise.scale[channel] = (scatter / freedom.max(0.2).sqrt()).max(LEAST_SCALE);
        }
        let white = noise.whiten(measured, residual);
        let weight = |(value, observation): (&f64, &super::Observation)| {
            if measured.rare[observation.channel] { 1.0 } else { (HUBER / value.abs().max(HUBER)).sqrt() }
        };
        noise.weight = white.iter().zip(&measured.observations).map(weight).collect();
        noise
    }

    /// `column` in units of the noise, neighbours uncorrelated.
    pub fn whiten(&self, measured: &Measured, column: &[f64]) -> Vec<f64> {
        let mut white = vec![0.0; column.len()];
        for run in &measured.runs {
            // Most columns move few channels.
            if column[run.clone()].iter().all(|value| *value == 0.0) {
                continue;
            }
            let channel = measured.observations[run.start].channel;
            let (scale, memory) = (self.scale[channel], self.memory[channel]);
            let innovation = (1.0 - memory * memory).sqrt();
            let mut before: Option<f64> = None;
            for i in run.clone() {
                let standard = column[i] / (measured.observations[i].deviation * scale);
                white[i] = match before {
                    None => standard,
                    Some(before) => (standard - memory * before) / innovation,
                } * self.weight[i];
                before = Some(standard);
            }
        }
        white
    }

    /// Standard deviation of an observation's noise, transformed.
    pub fn deviation(&self, measured: &Measured, i: usize) -> f64 {
        let observation = &measured.observations[i];
        observation.deviation * self.scale[observation.channel]
    }
}

/// Outliers may not decide about memory.
fn clipped(value: f64) -> f64 {
    value.clamp(-8.0, 8.0)
}
