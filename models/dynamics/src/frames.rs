//! The spectrum of a sound in overlapping frames.

use crate::comb::{floor, vertex};
use crate::fft::{hann, transform};

/// Bins over which the floor is a median: four times the distance of spindle lines, which fill a quarter of it.
const FLOOR: usize = 64;
/// Standard deviations of a normal variable that noise exceeds once in 300 000 bins.
const SURE: f64 = 4.5;
/// Share of independent frames among half overlapping ones under Hann's window (P. D. Welch, IEEE Transactions on Audio and
/// Electroacoustics 15 (1967) 70, recalled).
const INDEPENDENT: f64 = 0.9;

/// Decibels of a ratio of amplitudes.
pub(crate) fn level(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

/// Frames that overlap by half.
pub(crate) struct Frames<'a> {
    samples: &'a [f64],
    rate: f64,
    /// Samples of a frame.
    length: usize,
    /// Root mean square of the amplitude in every bin.
    amplitudes: Vec<f64>,
    floor: Vec<f64>,
    count: usize,
}

impl<'a> Frames<'a> {
    /// Frames of `duration` (s), or of the whole record where it is shorter.
    pub(crate) fn new(samples: &'a [f64], rate: f64, duration: f64) -> Self {
        let length = ((duration * rate).ceil() as usize).clamp(4, samples.len().max(4));
        let window: Vec<f64> = hann(length).collect();
        let mut power: Vec<f64> = Vec::new();
        let mut count = 0;
        for start in (0..=samples.len().saturating_sub(length)).step_by((length / 2).max(1)) {
            let windowed: Vec<f64> = samples[start..].iter().zip(&window).map(|(x, w)| x * w).collect();
            let spectrum = transform(&windowed);
            power.resize(spectrum.len(), 0.0);
            power.iter_mut().zip(&spectrum).for_each(|(power, value)| *power += value.norm_sqr());
            count += 1;
        }
        let scale = 4.0 / length as f64 / f64::from(count).sqrt();
        let amplitudes: Vec<f64> = power.iter().map(|power| scale * power.sqrt()).collect();
        // Zeros after a frame make bins narrower than lines.
        let fine = (2 * amplitudes.len()).div_ceil(length);
        let floor = floor(&amplitudes, FLOOR * fine);
        Self { samples, rate, length, amplitudes, floor, count: count as usize }
    }

    /// Distance of independent bins (Hz).
    pub(crate) fn step(&self) -> f64 {
        self.rate / self.length as f64
    }

    /// Duration of a frame (s).
    pub(crate) fn duration(&self) -> f64 {
        self.length as f64 / self.rate
    }

    /// Distance of the bins that are computed (Hz).
    fn bin(&self) -> f64 {
        0.5 * self.rate / (self.amplitudes.len() - 1) as f64
    }

    /// The sample at a time (s).
    pub(crate) fn sample(&self, time: f64) -> usize {
        (time * self.rate) as usize
    }

    /// Level above the median (dB) that noise hardly reaches in any bin: by Wilson and Hilferty the power of k frames is that of
    /// a cube of a normal variable.
    pub(crate) fn false_alarm_level(&self) -> f64 {
        let frames = (INDEPENDENT * self.count as f64).max(1.0);
        let small = 1.0 / (9.0 * frames);
        let (median, highest) = ((1.0 - small).powi(3), (1.0 - small + SURE * small.sqrt()).powi(3));
        0.5 * level(highest / median)
    }

    /// Frequency (Hz), amplitude and floor of every peak that stands `level` (dB) above the floor, from `lowest` (Hz) on.
    pub(crate) fn peaks(&self, lowest: f64, threshold: f64) -> Vec<(f64, f64, f64)> {
        let around = (self.amplitudes.len() * 2).div_ceil(self.length).max(1);
        let first = ((lowest / self.bin()) as usize).max(around);
        let highest = |i: usize| self.amplitudes[i - around..=i + around].iter().copied().fold(0.0, f64::max);
        (first..self.amplitudes.len().saturating_sub(around))
            .filter(|i| level(self.amplitudes[*i] / self.floor[*i]) > threshold && self.amplitudes[*i] >= highest(*i))
            .map(|i| (self.bin() * vertex(&self.amplitudes, i), self.amplitudes[i], self.floor[i]))
            .collect()
    }

    /// Greatest amplitude within `width` (Hz) of a frequency and the floor there; `None` beyond the spectrum.
    pub(crate) fn around(&self, frequency: f64, width: f64) -> Option<(f64, f64)> {
        let bin = |frequency: f64| (frequency.max(0.0) / self.bin()).round() as usize;
        let (first, last) = (bin(frequency - width), bin(frequency + width));
        let part = self.amplitudes.get(first..=last)?;
        Some((part.iter().copied().fold(0.0, f64::max), self.floor[bin(frequency)]))
    }

    /// When the line at a frequency has grown to a share of its greatest amplitude (s): the middle of the first frame that has
    /// it; 0 where that is the first frame.
    pub(crate) fn onset(&self, frequency: f64, share: f64) -> f64 {
        let window: Vec<f64> = hann(self.length).collect();
        let turn = std::f64::consts::TAU * frequency / self.rate;
        let amplitude = |start: usize| {
            let (mut re, mut im) = (0.0, 0.0);
            for (i, (x, w)) in self.samples[start..].iter().zip(&window).enumerate() {
                let (sine, cosine) = (turn * i as f64).sin_cos();
                re += x * w * cosine;
                im += x * w * sine;
            }
            f64::hypot(re, im)
        };
        let starts: Vec<usize> =
            (0..=self.samples.len().saturating_sub(self.length)).step_by((self.length / 8).max(1)).collect();
        let amplitudes: Vec<f64> = starts.iter().map(|start| amplitude(*start)).collect();
        let greatest = amplitudes.iter().copied().fold(0.0, f64::max);
        let first = amplitudes.iter().position(|amplitude| *amplitude >= share * greatest).unwrap_or(0);
        if first == 0 { 0.0 } else { (starts[first] + self.length / 2) as f64 / self.rate }
    }
}
