//! Noise as the data show it: scale, memory and outliers of each channel.

use super::{Measured, Observation, Transform};
use std::sync::Arc;
use toolroom_innovations::{Chain, Filter};
pub(crate) use toolroom_nominal::{HUBER, MAD};
use toolroom_statistics::median;

/// A sensor is never believed to be better than this share of its sheet (assumption).
const LEAST_SCALE: f64 = 0.5;
/// Greatest memory that is believed.
const GREATEST_MEMORY: f64 = 0.95;
/// Fewer residuals than these say nothing about a channel's noise.
const FEW: usize = 12;

/// Noise model: what scatters from row to row, a scale on the sensor sheet, memory from one innovation of a run to the
/// next (AR(1)), weights of outliers.
#[derive(Clone, Debug)]
pub struct Noise {
    /// Scale on the sensor's standard deviation, by channel.
    pub scale: Vec<f64>,
    /// Correlation of neighbours within a run, by channel.
    pub memory: Vec<f64>,
    /// Root of the weight of each whitened value.
    pub weight: Vec<f64>,
    /// Standard deviation of each observation by the sensor sheet, transformed.
    deviations: Arc<Vec<f64>>,
    /// How each group scatters from row to row, with the deviations of the sheet; empty where nothing is known of it.
    pub(super) chains: Arc<Vec<Chain>>,
    /// The filters of the chains at the scales.
    filters: Arc<Vec<Filter>>,
}

impl Noise {
    /// The sensor sheet as it stands, and what is known of the scatter from row to row.
    pub fn of_sheet(measured: &Measured, chains: Vec<Chain>) -> Self {
        let deviations = measured.observations.iter().map(|observation| observation.deviation).collect();
        Self::of_deviations(measured, deviations, chains)
    }

    /// The same with the sheet read at what a model predicts instead of at what was read: `residual` is what it leaves.
    /// The share of a deviation that grows with the value would else weigh a low reading more than a high one.
    pub(super) fn at_predictions(measured: &Measured, residual: &[f64], chains: Vec<Chain>) -> Self {
        let deviation = |(observation, residual): (&Observation, &f64)| {
            let channel = &measured.channels[observation.channel];
            let predicted = observation.value - residual;
            let deviation_of = |transformed: f64| match channel.transform {
                Transform::Linear => channel.sensor.deviation(transformed),
                Transform::Log => channel.sensor.deviation(transformed.exp()) / transformed.exp(),
            };
            // What else an observation scatters by stays.
            let other = observation.deviation.powi(2) - deviation_of(observation.value).powi(2);
            (other.max(0.0) + deviation_of(predicted).powi(2)).sqrt()
        };
        let deviations = measured.observations.iter().zip(residual).map(deviation).collect();
        Self::of_deviations(measured, deviations, chains)
    }

    /// The same with the scatter of channels of which nobody states it as `read` has it from the records; a sensor is not
    /// better than its sheet here.
    #[must_use]
    pub(super) fn with_unstated(mut self, measured: &Measured, read: &Self) -> Self {
        let unstated = (0..measured.channels.len()).filter(|channel| measured.unstated[*channel]);
        unstated.for_each(|channel| self.scale[channel] = read.scale[channel].max(1.0));
        self.filter(measured);
        self
    }

    /// The same with these factors on the sensors, by channel.
    #[must_use]
    pub(super) fn scaled(mut self, measured: &Measured, scale: &[f64]) -> Self {
        self.scale.copy_from_slice(scale);
        self.filter(measured);
        self
    }

    fn of_deviations(measured: &Measured, deviations: Vec<f64>, chains: Vec<Chain>) -> Self {
        let channels = measured.channels.len();
        let mut noise = Self {
            scale: vec![1.0; channels],
            memory: vec![0.0; channels],
            weight: vec![1.0; measured.len()],
            deviations: Arc::new(deviations),
            chains: Arc::new(chains),
            filters: Arc::default(),
        };
        noise.filter(measured);
        noise
    }

    /// Sets the filters to the scales.
    fn filter(&mut self, measured: &Measured) {
        let scaled = |chain: &Chain| {
            let mut chain = chain.clone();
            for reading in chain.rows.iter_mut().flat_map(|row| &mut row.readings) {
                reading.deviation = self.deviation(measured, reading.place);
            }
            Filter::new(&chain)
        };
        self.filters = Arc::new(self.chains.iter().map(scaled).collect());
    }

    /// Mean share of the predicted variance of each channel that is its sensor's.
    fn shares(&self, measured: &Measured) -> Vec<f64> {
        let mut sums = vec![(0.0, 0.0); measured.channels.len()];
        for (place, share) in self.filters.iter().flat_map(Filter::shares) {
            let sum = &mut sums[measured.observations[place].channel];
            *sum = (sum.0 + share, sum.1 + 1.0);
        }
        sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { 1.0 }).collect()
    }

    /// Noise from the residuals of a model rich enough to hold no structure any more; `freedom` is
    /// the share of degrees of freedom that its fit left. The scatter from row to row is that of `before`.
    pub fn estimate(measured: &Measured, residual: &[f64], freedom: f64, before: &Self) -> Self {
        let mut noise = Self::of_sheet(measured, Vec::new());
        noise.chains = before.chains.clone();
        noise.filter(measured);
        let shares = noise.shares(measured);
        let standardised = noise.standardised(measured, residual);
        let fitted = |run: &&std::ops::Range<usize>| {
            measured.fitted[measured.group_of_row[measured.observations[run.start].row]]
        };
        for (channel, share) in shares.into_iter().enumerate() {
            let runs: Vec<_> = measured
                .runs
                .iter()
                .filter(fitted)
                .filter(|run| measured.observations[run.start].channel == channel)
                .collect();
            let standard = |i: usize| standardised[i];
            let scatters = |i: &usize| !measured.exact[*i];
            let count: usize = runs.iter().map(|run| (**run).clone().filter(scatters).count()).sum();
            if count < FEW {
                continue;
            }
            let (mut product, mut square) = (0.0, 0.0);
            for run in &runs {
                for i in (run.start + 1..run.end).filter(|i| scatters(i) && scatters(&(i - 1))) {
                    let (a, b) = (clipped(standard(i - 1)), clipped(standard(i)));
                    product += a * b;
                    square += 0.5 * (a * a + b * b);
                }
            }
            let memory: f64 = if square > 0.0 { (product / square).clamp(0.0, GREATEST_MEMORY) } else { 0.0 };
            let mut whitened: Vec<f64> = Vec::with_capacity(count);
            for run in &runs {
                let innovation = (1.0 - memory * memory).sqrt();
                let white = |i: usize| match i.checked_sub(1).filter(|before| run.contains(before)) {
                    Some(before) => ((standard(i) - memory * standard(before)) / innovation).abs(),
                    None => standard(i).abs(),
                };
                whitened.extend((**run).clone().filter(scatters).map(white));
            }
            noise.memory[channel] = memory;
            // Most counts of rare events are alike and say nothing about their scatter.
            let scatter = if measured.rare[channel] {
                (whitened.iter().map(|value| value * value).sum::<f64>() / whitened.len() as f64).sqrt()
            } else {
                MAD * median(&mut whitened)
            };
            // What the chain scatters by stays as it is: the sensor makes up for the rest.
            let square = 1.0 + ((scatter * scatter / freedom.max(0.2)) - 1.0) / share;
            noise.scale[channel] = square.max(LEAST_SCALE * LEAST_SCALE).sqrt();
        }
        noise.filter(measured);
        let white = noise.whiten(measured, residual);
        let weight = |(value, observation): (&f64, &Observation)| {
            if measured.rare[observation.channel] { 1.0 } else { (HUBER / value.abs().max(HUBER)).sqrt() }
        };
        noise.weight = white.iter().zip(&measured.observations).map(weight).collect();
        noise
    }

    /// `column` in units of the noise, neighbours uncorrelated.
    pub fn whiten(&self, measured: &Measured, column: &[f64]) -> Vec<f64> {
        let (mut standard, mut white) = (vec![0.0; column.len()], vec![0.0; column.len()]);
        (0..measured.spans.len())
            .for_each(|group| self.whiten_group(measured, group, column, &mut standard, &mut white));
        white
    }

    /// The same in the span of one group of `white`, which is as long as `column`; so is `standard`, which holds what is
    /// worked out on the way.
    pub fn whiten_group(
        &self,
        measured: &Measured,
        group: usize,
        column: &[f64],
        standard: &mut [f64],
        white: &mut [f64],
    ) {
        self.standardise(measured, group, column, standard);
        for run in measured.runs_of(group) {
            // Most columns move few channels.
            if standard[run.clone()].iter().all(|value| *value == 0.0) {
                white[run.clone()].fill(0.0);
                continue;
            }
            let memory = self.memory[measured.observations[run.start].channel];
            let innovation = (1.0 - memory * memory).sqrt();
            let mut before: Option<f64> = None;
            for i in run.clone() {
                white[i] = match before {
                    None => standard[i],
                    Some(before) => (standard[i] - memory * before) / innovation,
                } * self.weight[i];
                before = Some(standard[i]);
            }
        }
    }

    /// `column` in units of the predicted standard deviation, what rows have in common taken out; memory within a run
    /// is left.
    fn standardised(&self, measured: &Measured, column: &[f64]) -> Vec<f64> {
        let mut standard = vec![0.0; column.len()];
        (0..measured.spans.len()).for_each(|group| self.standardise(measured, group, column, &mut standard));
        standard
    }

    /// The same in the span of one group.
    fn standardise(&self, measured: &Measured, group: usize, column: &[f64], standard: &mut [f64]) {
        let span = measured.spans[group].clone();
        // Many columns move few groups.
        if column[span.clone()].iter().all(|value| *value == 0.0) {
            standard[span].fill(0.0);
            return;
        }
        match self.filters.get(group) {
            Some(filter) => filter.whiten(column, standard),
            None => span.for_each(|i| standard[i] = column[i] / self.deviation(measured, i)),
        }
    }

    /// Standard deviation of an observation's noise, transformed.
    pub fn deviation(&self, measured: &Measured, i: usize) -> f64 {
        self.deviations[i] * self.scale[measured.observations[i].channel]
    }
}

/// Factors on the sensor sheet, by channel, for a design that is judged before it is diagnosed: 1, but where nobody states
/// how much a channel scatters and its readings show it. They are held against what the model leaves of them, `residual`,
/// about the median of each run, so that neither a constant that is off nor an effect of some operations counts.
pub(super) fn unstated_scales(measured: &Measured, residual: &[f64]) -> Vec<f64> {
    let scale = |channel: usize| {
        // One value throughout is the place of readings that are yet to come.
        let mut values = measured.observations.iter().filter(|own| own.channel == channel).map(|own| own.value);
        let first = values.next();
        if values.all(|value| Some(value) == first) {
            return 1.0;
        }
        let runs = measured.runs.iter().filter(|run| measured.observations[run.start].channel == channel);
        let (mut far, mut medians) = (Vec::new(), 0.0);
        for run in runs {
            let mut of_run: Vec<f64> =
                run.clone().map(|place| residual[place] / measured.observations[place].deviation).collect();
            let middle = median(&mut of_run);
            far.extend(of_run.iter().map(|value| (value - middle).abs()));
            medians += 1.0;
        }
        let count = far.len() as f64;
        // Every median takes a degree of freedom.
        let freedom = (count / (count - medians)).sqrt();
        if far.len() < FEW || !freedom.is_finite() { 1.0 } else { (MAD * freedom * median(&mut far)).max(1.0) }
    };
    (0..measured.channels.len()).map(|own| if measured.unstated[own] { scale(own) } else { 1.0 }).collect()
}

/// Outliers may not decide about memory.
fn clipped(value: f64) -> f64 {
    value.clamp(-8.0, 8.0)
}
