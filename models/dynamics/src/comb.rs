//! The spindle speed from the comb of its harmonics.

use crate::fft::{hann, transform};

/// Greatest deviation of the true speed from the one that was commanded, relative.
pub(crate) const WITHIN: f64 = 0.03;
/// Harmonics of the spindle that are summed: the sixteenth moves by half of their distance over the range of speeds.
const SPINDLE_HARMONICS: u32 = 16;
/// Harmonics of the teeth that are summed (assumption: beyond, the sound of a cut has faded).
const TOOTH_HARMONICS: u32 = 12;
/// Share of half the sampling rate up to which lines count (assumption: filters against aliasing).
pub(crate) const BAND: f64 = 0.9;
/// Amplitude over the floor of a harmonic that counts (assumption: 20 dB, noise does not reach it).
const CLEAR: f64 = 10.0;
/// Share of the power beside a harmonic that a line of its own holds: one of a pair holds half (assumption).
const OWN: f64 = 0.7;
/// First harmonics of the teeth of which at least half are clear in a comb (assumption).
const FIRST_TEETH: f64 = 6.0;
/// Greatest weight of a line in the mean of the speed, in amplitudes of the floor: beyond, wander and not noise limits it
/// (assumption).
const GREATEST_WEIGHT: f64 = 1e3;

/// Ratios of the true to the supposed speed that are tried where lines are unexplained: speeds or teeth mistaken for one another, or
/// a sampling rate that is half or twice the true one (assumption: others are rare).
const RATIOS: [[u32; 2]; 7] = [[1, 2], [1, 3], [2, 3], [3, 2], [1, 4], [3, 4], [4, 3]];
/// Share of the harmonics of another speed that stand out where it is the true one (assumption).
const MOST: f64 = 0.7;

/// Amplitudes over all samples under Hann's window.
pub(crate) struct WholeSpectrum {
    amplitudes: Vec<f64>,
    /// Distance of the bins (Hz).
    step: f64,
    /// Width of a line (Hz): half of the main lobe.
    width: f64,
}

impl WholeSpectrum {
    pub(crate) fn new(samples: &[f64], rate: f64) -> Self {
        let windowed: Vec<f64> = samples.iter().zip(hann(samples.len())).map(|(x, w)| x * w).collect();
        // The window has a mean of one half and a line half of its amplitude at positive frequencies.
        let scale = 4.0 / samples.len() as f64;
        let amplitudes: Vec<f64> = transform(&windowed).iter().map(|value| scale * value.norm()).collect();
        let step = 0.5 * rate / (amplitudes.len() - 1) as f64;
        Self { amplitudes, step, width: 2.0 * rate / samples.len() as f64 }
    }

    /// Half of the main lobe of a line (Hz).
    pub(crate) fn width(&self) -> f64 {
        self.width
    }

    /// The median amplitude in blocks that are `span` wide (Hz).
    pub(crate) fn floor(&self, span: f64) -> Vec<f64> {
        floor(&self.amplitudes, (span / self.step) as usize)
    }

    /// The place of the greatest amplitude within `reach` of a frequency, between the bins (Hz).
    pub(crate) fn refined(&self, frequency: f64, reach: f64) -> f64 {
        self.greatest(frequency, reach).0
    }

    /// A line of its own within `reach` of a frequency but not within `of_harmonic` of it (Hz): its frequency (Hz) and amplitude.
    /// It holds most of the power there, which neither the skirts of a line at the frequency itself do, whose speed wanders, nor
    /// the pairs of lines that beside a line modulation makes.
    pub(crate) fn beside(&self, frequency: f64, reach: f64, of_harmonic: f64) -> Option<(f64, f64)> {
        let last = self.amplitudes.len() - 2;
        let bin = |frequency: f64| ((frequency / self.step).round().max(1.0) as usize).clamp(1, last);
        let outside = |i: &usize| (self.step * *i as f64 - frequency).abs() > of_harmonic + self.width;
        let near = || (bin(frequency - reach)..=bin(frequency + reach)).filter(outside);
        let top = near().max_by(|a, b| self.amplitudes[*a].total_cmp(&self.amplitudes[*b]))?;
        let power = |i: usize| self.amplitudes[i].powi(2);
        let place = self.step * vertex(&self.amplitudes, top);
        let own = |i: &usize| (self.step * *i as f64 - place).abs() <= self.width + self.step;
        let (line, all) = (near().filter(own).map(power).sum::<f64>(), near().map(power).sum::<f64>());
        let mut around: Vec<f64> = near().map(|i| self.amplitudes[i]).collect();
        around.sort_by(f64::total_cmp);
        let floor = around[around.len() / 2];
        (line > OWN * all && self.amplitudes[top] > CLEAR * floor).then(|| (place, self.amplitudes[top]))
    }

    /// Greatest amplitude within `reach` of a frequency but not within `of_harmonic` of it (Hz), over the one at it: the
    /// geometric mean of both sides. A speed that wanders smears a line to both sides, while the lines of chatter stand on one.
    pub(crate) fn skirt(&self, frequency: f64, reach: f64, of_harmonic: f64) -> f64 {
        // The first side lobe of the window, 3 % of the line, is no wander.
        let side = 0.5 * (reach - of_harmonic - 1.5 * self.width).max(0.0);
        let beside = [-1.0, 1.0].map(|sign| self.greatest(frequency + sign * (reach - side), side).1);
        (beside[0] * beside[1]).sqrt() / self.at(frequency, of_harmonic).max(f64::MIN_POSITIVE)
    }

    /// Greatest amplitude within `of_harmonic` and the width of a line from a frequency (Hz).
    pub(crate) fn at(&self, frequency: f64, of_harmonic: f64) -> f64 {
        self.greatest(frequency, of_harmonic + self.width).1
    }

    /// Greatest amplitude within `reach` of a frequency (Hz), where it stands clear of the floor.
    pub(crate) fn clear(&self, floor: &[f64], frequency: f64, reach: f64) -> Option<f64> {
        let (found, amplitude) = self.greatest(frequency, reach);
        (amplitude > CLEAR * floor[((found / self.step) as usize).min(floor.len() - 1)]).then_some(amplitude)
    }

    /// The median amplitude between two parts of half the sampling rate.
    pub(crate) fn median(&self, parts: [f64; 2]) -> f64 {
        let [first, last] = parts.map(|part| (part * self.amplitudes.len() as f64) as usize);
        let mut band = self.amplitudes[first..last.max(first + 1).min(self.amplitudes.len())].to_vec();
        band.sort_by(f64::total_cmp);
        band[band.len() / 2]
    }

    /// Frequency and amplitude of the greatest bin within `reach` (Hz) of a frequency.
    fn greatest(&self, frequency: f64, reach: f64) -> (f64, f64) {
        let last = self.amplitudes.len() - 2;
        let bin = |frequency: f64| ((frequency / self.step).round().max(1.0) as usize).clamp(1, last);
        let near = bin(frequency - reach)..=bin(frequency + reach);
        let top = near.max_by(|a, b| self.amplitudes[*a].total_cmp(&self.amplitudes[*b])).unwrap_or(1);
        (self.step * vertex(&self.amplitudes, top), self.amplitudes[top])
    }
}

/// The vertex of the parabola through the logarithms of three bins around `top`, in bins.
pub(crate) fn vertex(amplitudes: &[f64], top: usize) -> f64 {
    let [a, b, c] = [top - 1, top, top + 1].map(|i| amplitudes[i].max(f64::MIN_POSITIVE).ln());
    let bend = a - 2.0 * b + c;
    if bend < 0.0 { top as f64 + (0.5 * (a - c) / bend).clamp(-0.5, 0.5) } else { top as f64 }
}

/// The median of every block of `block` bins, for every bin.
pub(crate) fn floor(amplitudes: &[f64], block: usize) -> Vec<f64> {
    let blocks = (amplitudes.len() / block.max(1)).max(1);
    let mut found = Vec::with_capacity(amplitudes.len());
    for i in 0..blocks {
        let part = &amplitudes[i * amplitudes.len() / blocks..(i + 1) * amplitudes.len() / blocks];
        let mut sorted = part.to_vec();
        sorted.sort_by(f64::total_cmp);
        let median = sorted[sorted.len() / 2].max(f64::MIN_POSITIVE);
        found.extend(part.iter().map(|_| median));
    }
    found
}

/// Harmonics of spindle and teeth.
pub(crate) struct Comb {
    /// Revolutions in a second.
    pub spindle_frequency: f64,
    /// Teeth of the cutter.
    pub teeth: u32,
}

impl Comb {
    /// The comb whose lines stand highest above the floor on a logarithmic scale, near the `commanded` revolutions in a second;
    /// `None` where most of the
    /// first lines of the teeth are missing.
    pub(crate) fn find(spectrum: &WholeSpectrum, commanded: f64, teeth: u32) -> Option<Self> {
        let highest = BAND * spectrum.step * (spectrum.amplitudes.len() - 1) as f64;
        let of_teeth = (1..=TOOTH_HARMONICS).map(|k| k * teeth).filter(|k| *k > SPINDLE_HARMONICS);
        let orders: Vec<f64> = (1..=SPINDLE_HARMONICS)
            .chain(of_teeth)
            .map(f64::from)
            .filter(|k| k * commanded * (1.0 + WITHIN) < highest)
            .collect();
        let greatest = orders.last()?;
        let floor = spectrum.floor(4.0 * commanded);
        let heights: Vec<f64> = spectrum
            .amplitudes
            .iter()
            .zip(&floor)
            .map(|(amplitude, floor)| (amplitude / floor).max(1.0).ln())
            .collect();
        let at = |frequency: f64| heights[((frequency / spectrum.step).round() as usize).min(heights.len() - 1)];
        // A quarter of the width of the highest line from speed to speed.
        let steps = (2.0 * WITHIN * commanded * greatest / (0.25 * spectrum.width)).ceil().max(1.0) as usize;
        let speed = |i: usize| commanded * (1.0 + WITHIN * (2.0 * i as f64 / steps as f64 - 1.0));
        let score = |i: usize| orders.iter().map(|k| at(k * speed(i))).sum::<f64>();
        let scores: Vec<f64> = (0..=steps).map(score).collect();
        let best = speed((0..=steps).max_by(|a, b| scores[*a].total_cmp(&scores[*b]))?);
        let first = |k: f64| k % f64::from(teeth) == 0.0 && k <= FIRST_TEETH * f64::from(teeth);
        let (mut lines, mut sums) = (0, [0.0; 2]);
        for k in &orders {
            let (frequency, amplitude) = spectrum.greatest(k * best, spectrum.width);
            let height = amplitude / floor[((frequency / spectrum.step) as usize).min(floor.len() - 1)];
            if height > CLEAR {
                let weight = height.min(GREATEST_WEIGHT);
                sums[0] += weight * k * frequency;
                sums[1] += weight * k * k;
                lines += usize::from(first(*k));
            }
        }
        let due = orders.iter().filter(|k| first(**k)).count();
        (lines > 0 && 2 * lines >= due).then(|| Self { spindle_frequency: sums[0] / sums[1], teeth })
    }

    /// Another spindle frequency, in a ratio of small numbers to this one, of which the line at `frequency` (Hz) is a harmonic and
    /// whose harmonics that are none of this comb mostly stand out: then the cutter turns at that speed.
    ///
    /// Lines of chatter do not look like that. They lie in at most two places from one tooth frequency to the next, and so on
    /// few of those harmonics, unless the cutter has one tooth, of which nothing is said.
    pub(crate) fn other(&self, spectrum: &WholeSpectrum, frequency: f64) -> Option<f64> {
        if self.teeth < 2 {
            return None;
        }
        let floor = spectrum.floor(4.0 * self.spindle_frequency);
        let highest = BAND * spectrum.step * (spectrum.amplitudes.len() - 1) as f64;
        let clear = |at: f64| spectrum.clear(&floor, at, spectrum.width).is_some();
        let found = RATIOS.into_iter().find(|[above, below]| {
            let spindle = self.spindle_frequency * f64::from(*above) / f64::from(*below);
            let order = (frequency / spindle).round();
            let own: Vec<f64> = (1..=SPINDLE_HARMONICS)
                .filter(|k| !(k * above).is_multiple_of(*below))
                .map(|k| f64::from(k) * spindle)
                .filter(|at| *at < highest)
                .collect();
            let standing = own.iter().filter(|at| clear(**at)).count();
            (frequency - order * spindle).abs() < 2.0 * spectrum.width
                && standing as f64 > MOST * own.len().max(1) as f64
        });
        found.map(|[above, below]| self.spindle_frequency * f64::from(above) / f64::from(below))
    }
}
