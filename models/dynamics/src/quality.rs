//! How good a fit is, and when it must not be used.

mod codes;

use crate::fitted_mode::FittedMode;
use crate::frf::{Frf, Measurement};
pub use codes::REFUSAL_CODES;
use nalgebra::Complex;
use std::f64::consts::TAU;
use std::fmt;

/// Least coherence over the half-power band of the mode that limits the cut: below, three tenths of the motion have
/// another cause than the hammer (assumption, usual in practice).
const LEAST_COHERENCE: f64 = 0.7;
/// Coherence from which on a line counts for residual and reciprocity (assumption).
const CLEAR: f64 = 0.5;
/// Share of its peak that a fitted response may have at an end of the range (assumption: half of a peak is on its flank).
const GREATEST_AT_END: f64 = 0.5;
/// Share of the greatest response below which a direct response without a resonance of its own is none (assumption: what is
/// twenty times as stiff as the softest direction sets no limit).
const STIFF: f64 = 0.05;
/// Least number of lines in a half-power band (assumption: three lines meet a circle without telling its noise).
const LEAST_LINES: f64 = 5.0;
/// Greatest residual of a fit over the measured response (assumption).
pub(crate) const GREATEST_RESIDUAL: f64 = 0.15;
/// Standard deviations by which the noise of a response may be more than its mean (assumption: chance reaches as far once in seven hundred).
const CHANCE: f64 = 3.0;
/// Share of the decay of an exponential window below which the damping of a mode is a small difference (assumption).
const LEAST_OWN_DAMPING: f64 = 0.1;
/// Misfit over degrees of freedom from which on a warning is due: residuals of twice the noise (assumption).
const GREATEST_CHI2: f64 = 4.0;
/// Difference of the two responses xy and yx over their size from which on a warning is due (assumption).
const GREATEST_ASYMMETRY: f64 = 0.2;

/// Stiffness (N/m) of the softest mode below and beyond which a slip of the unit is the usual cause (assumption: slender tools and
/// thin walls have some tenths of N/um, nothing that cuts thousands).
const USUAL_STIFFNESS: [f64; 2] = [5e4, 2e9];

/// Why a fit must not be used.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// The mode that sets the least limit is measured with little coherence.
    LowCoherence {
        /// Its frequency (Hz).
        frequency: f64,
        /// Median coherence over its half-power band.
        coherence: f64,
    },
    /// A resonance is at the end of the range or beyond.
    EdgeOfRange {
        /// The end (Hz), or the fitted frequency beyond it.
        frequency: f64,
    },
    /// A direct response that does work on the hammer at its peaks.
    SensorSign {
        /// The function.
        function: String,
    },
    /// A half-power band with too few lines.
    CoarseFrequency {
        /// Frequency of the mode (Hz).
        frequency: f64,
        /// Lines in the band.
        lines: f64,
    },
    /// Damping that is nearly all of the exponential window.
    WindowDamping {
        /// Frequency of the mode (Hz).
        frequency: f64,
    },
    /// A fit that leaves too much.
    PoorFit {
        /// The function.
        function: String,
        /// Residual over the response.
        residual: f64,
    },
}

impl Refusal {
    /// Its code for programs.
    pub fn code(&self) -> &'static str {
        codes::of(self).0
    }

    /// What the user can do.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::LowCoherence { .. } => "tap harder or with a harder tip, look for loose parts, average more",
            Self::EdgeOfRange { .. } => "measure a wider range of frequencies",
            Self::SensorSign { .. } => "turn the sensor, or swap its axes, and measure again",
            Self::CoarseFrequency { .. } => "record for longer, so that the lines are closer",
            Self::WindowDamping { .. } => "record for longer after every hit",
            Self::PoorFit { .. } => "look at the picture: a joint that rattles, or modes that were not picked",
        }
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LowCoherence { frequency, coherence } => {
                write!(f, "the coherence at the mode of {frequency:.1} Hz, which limits the cut, is {coherence:.2}")
            }
            Self::EdgeOfRange { frequency } => {
                write!(f, "a resonance lies at the edge of the range, at {frequency:.1} Hz")
            }
            Self::SensorSign { function } => {
                write!(f, "the imaginary part of {function} is positive at its peaks: a sensor is turned around")
            }
            Self::CoarseFrequency { frequency, lines } => {
                write!(f, "the half-power band of the mode of {frequency:.1} Hz has {lines:.1} lines")
            }
            Self::WindowDamping { frequency } => {
                write!(f, "nearly all damping of the mode of {frequency:.1} Hz is that of the exponential window")
            }
            Self::PoorFit { function, residual } => {
                write!(f, "the fit of {function} leaves {:.0} % of the response", residual * 100.0)
            }
        }
    }
}

/// How well a fit describes a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// Misfit over degrees of freedom; one where the variances are right. None where the residuals themselves tell the noise,
    /// for want of coherence or averages: it would be one by definition.
    pub reduced_chi2: Option<f64>,
    /// Residual over response of every function, on lines of clear coherence; on all where none is clear.
    pub residuals: Vec<(String, f64)>,
    /// Median coherence over the half-power band of every mode.
    pub coherence: Vec<Option<f64>>,
    /// Difference of xy and yx over their size, on lines of clear coherence.
    pub reciprocity: Option<f64>,
    /// Whether x and y have a mode at one frequency and no response across tells whether the two are one.
    pub unsigned: bool,
    /// Stiffness (N/m) of the softest mode, where no machine has one.
    pub unusual: Option<f64>,
    /// A mistake about the columns of the file with which undone the fit would be good.
    pub mistaken: Option<String>,
    /// Why the fit must not be used, the first reason first.
    pub refusals: Vec<Refusal>,
}

impl Quality {
    pub(crate) fn new(
        measured: &Measurement,
        fitted: &[Vec<Complex<f64>>],
        modes: &[FittedMode],
        reduced_chi2: Option<f64>,
        variances: Option<&[&[f64]]>,
        wrong_signs: Vec<String>,
    ) -> Self {
        // Where no line is clear, all are looked at: what the fit leaves of noise is most of it.
        let clear = |function: &Frf| {
            let all: Vec<usize> = (0..function.receptance.len()).collect();
            let Some(coherence) = &function.coherence else { return all };
            let clear: Vec<usize> = all.iter().copied().filter(|i| coherence[*i] >= CLEAR).collect();
            if clear.is_empty() { all } else { clear }
        };
        let residuals: Vec<(String, f64)> = measured
            .functions
            .iter()
            .zip(fitted)
            .map(|(function, fitted)| {
                (function.name(), difference(clear(function).into_iter(), &function.receptance, fitted))
            })
            .collect();
        let coherence: Vec<Option<f64>> = modes.iter().map(|mode| band_coherence(measured, mode)).collect();
        let mut refusals = Vec::new();
        let flexible = |mode: &FittedMode| {
            let zeta = mode.damping_ratio.value;
            4.0 * mode.stiffness.value * zeta * (1.0 + zeta)
        };
        let limiting = (0..modes.len()).min_by(|a, b| flexible(&modes[*a]).total_cmp(&flexible(&modes[*b])));
        if let Some((mode, Some(coherence))) = limiting.map(|i| (&modes[i], coherence[i]))
            && coherence < LEAST_COHERENCE
        {
            refusals.push(Refusal::LowCoherence { frequency: mode.natural_frequency.value, coherence });
        }
        refusals.extend(edge(measured, fitted, modes));
        refusals.extend(wrong_signs.into_iter().map(|function| Refusal::SensorSign { function }));
        for mode in modes {
            let (frequency, lines) = (mode.natural_frequency.value, band(mode) / measured.step());
            if lines < LEAST_LINES {
                refusals.push(Refusal::CoarseFrequency { frequency, lines });
            }
        }
        for mode in modes {
            let decay = mode.damping_ratio.value * TAU * mode.natural_frequency.value;
            if decay <= LEAST_OWN_DAMPING * measured.window_decay && measured.window_decay > 0.0 {
                refusals.push(Refusal::WindowDamping { frequency: mode.natural_frequency.value });
            }
        }
        let sizes: Vec<f64> = measured.functions.iter().map(|function| norm(&function.receptance)).collect();
        // What noise alone leaves of a response, where it is known: a mode at ten degrees hardly moves in the other direction, and
        // the right model leaves most of what was measured there.
        let noise = |place: usize, function: &Frf| {
            let Some(variance) = variances.and_then(|all| all.get(place)) else { return 0.0 };
            let lines = clear(function);
            // The sum of squares of so many real and imaginary parts, and what chance adds to it.
            let chance = 1.0 + CHANCE / (lines.len() as f64).sqrt();
            let (noise, size) = lines.into_iter().fold((0.0, 0.0), |(noise, size), i| {
                (noise + 2.0 * variance[i], size + function.receptance[i].norm_sqr())
            });
            if size > 0.0 { chance * noise / size } else { 0.0 }
        };
        let poor = (0..residuals.len()).filter(|place| {
            let (function, (_, residual)) = (&measured.functions[*place], &residuals[*place]);
            // Across, what is left matters beside the responses along: of modes along x and y it is noise alone.
            let beside = if function.is_direct() { 1.0 } else { (sizes[*place] / along(measured, &sizes)).min(1.0) };
            (residual * residual - noise(*place, function)).max(0.0).sqrt() * beside > GREATEST_RESIDUAL
        });
        let poor = poor.map(|place| &residuals[place]);
        refusals.extend(
            poor.map(|(function, residual)| Refusal::PoorFit { function: function.clone(), residual: *residual }),
        );
        let crossed = measured.functions.iter().any(|function| !function.is_direct());
        let plane = measured.functions.len() > 1;
        let alike = |a: &FittedMode, b: &FittedMode| {
            let (f, g) = (a.natural_frequency.value, b.natural_frequency.value);
            a.direction != b.direction && (f - g).abs() < a.damping_ratio.value.min(b.damping_ratio.value) * f
        };
        let unsigned = plane && !crossed && modes.windows(2).any(|pair| alike(&pair[0], &pair[1]));
        let (reciprocity, mistaken) = (reciprocity(measured), None);
        let [softest_usual, stiffest_usual] = USUAL_STIFFNESS;
        let softest = modes.iter().map(|mode| mode.stiffness.value).reduce(f64::min);
        let unusual = softest.filter(|stiffness| !(softest_usual..=stiffest_usual).contains(stiffness));
        Self { reduced_chi2, residuals, coherence, reciprocity, unsigned, unusual, mistaken, refusals }
    }

    /// What does not forbid the use of the fit and should be known.
    pub fn warnings(&self) -> Vec<String> {
        let asymmetry = self.reciprocity.filter(|difference| *difference > GREATEST_ASYMMETRY);
        let asymmetry = asymmetry.map(|difference| {
            format!(
                "xy and yx differ by {:.0} %: the structure answers both ways alike, so one is wrong",
                difference * 100.0
            )
        });
        let oblique = self.unsigned.then(|| {
            "neither xy nor yx was measured: where x and y have a mode at one frequency, it is taken as one mode along each; a \
             single mode between x and y would look the same"
                .to_owned()
        });
        let misfit = self.reduced_chi2.filter(|chi2| *chi2 > GREATEST_CHI2).map(|chi2| {
            format!(
                "the fit leaves {:.1} times the noise that coherence and averages tell: coherence that is rounded or not of this \
                 measurement, too many averages told, or what real modes do not describe; the standard deviations grow by it",
                chi2.sqrt()
            )
        });
        let unusual = self.unusual.map(|stiffness| {
            let stiffness = stiffness * 1e-6;
            format!("the softest mode has {stiffness:.3} N/um, as no machine does: is the unit of the response right?")
        });
        self.mistaken.iter().cloned().chain(unusual).chain(asymmetry).chain(oblique).chain(misfit).collect()
    }

    /// `good`, `usable` or `refused`, with the reason.
    pub fn verdict(&self) -> String {
        if let Some(refusal) = self.refusals.first() {
            return format!("refused because {refusal}");
        }
        let worst = self.residuals.iter().map(|(_, residual)| *residual).fold(0.0, f64::max);
        if worst < 0.5 * GREATEST_RESIDUAL && self.warnings().is_empty() {
            "good".to_owned()
        } else {
            "usable".to_owned()
        }
    }
}

/// Half-power bandwidth (Hz).
fn band(mode: &FittedMode) -> f64 {
    2.0 * mode.damping_ratio.value * mode.natural_frequency.value
}

/// Norm of a difference over the norm of the first, on some lines; zero without any.
fn difference(lines: impl Iterator<Item = usize>, one: &[Complex<f64>], other: &[Complex<f64>]) -> f64 {
    let (mut left, mut size) = (0.0, 0.0);
    for i in lines {
        left += (one[i] - other[i]).norm_sqr();
        size += one[i].norm_sqr();
    }
    if size > 0.0 { (left / size).sqrt() } else { 0.0 }
}

fn norm(values: &[Complex<f64>]) -> f64 {
    values.iter().map(Complex::norm_sqr).sum::<f64>().sqrt()
}

/// Geometric mean of the direct responses, of which `sizes` are the norms of all; that of the only one.
fn along(measured: &Measurement, sizes: &[f64]) -> f64 {
    let direct = measured.functions.iter().zip(sizes).filter(|(function, _)| function.is_direct());
    let (count, product) = direct.fold((0.0, 1.0), |(count, product), (_, size)| (count + 1.0, product * size));
    product.powf(1.0 / f64::max(count, 1.0))
}

/// Median coherence over the half-power band of a mode, of the direct function nearest to its direction.
fn band_coherence(measured: &Measurement, mode: &FittedMode) -> Option<f64> {
    let share = |d: usize| mode.direction[d].abs();
    let direct = measured.functions.iter().filter(|function| function.is_direct());
    let nearest = direct.max_by(|a, b| share(a.response.index()).total_cmp(&share(b.response.index())))?;
    let (centre, half) = (mode.natural_frequency.value, 0.5 * band(mode).max(3.0 * measured.step()));
    let values = measured.frequencies.iter().zip(nearest.coherence.as_ref()?);
    let mut inside: Vec<f64> = values.filter(|(f, _)| (*f - centre).abs() <= half).map(|(_, c)| *c).collect();
    inside.sort_by(f64::total_cmp);
    inside.get(inside.len() / 2).copied()
}

/// A resonance at an end of the range or beyond.
fn edge(measured: &Measurement, fitted: &[Vec<Complex<f64>>], modes: &[FittedMode]) -> Option<Refusal> {
    let (first, last) = (*measured.frequencies.first()?, *measured.frequencies.last()?);
    let beyond = modes.iter().map(|mode| mode.natural_frequency.value).find(|f| !(first..=last).contains(f));
    if let Some(frequency) = beyond {
        return Some(Refusal::EdgeOfRange { frequency });
    }
    let direct = || measured.functions.iter().zip(fitted).filter(|(function, _)| function.is_direct());
    let peak = |values: &[Complex<f64>]| values.iter().map(|value| value.norm()).fold(0.0, f64::max);
    let greatest = direct().map(|(_, values)| peak(values)).fold(0.0, f64::max);
    for (_, values) in direct() {
        let peak = peak(values);
        // A direction in which nothing resonates has the compliance of what is beyond the range, the same at both ends.
        if peak < STIFF * greatest {
            continue;
        }
        for (frequency, value) in [(first, values.first()?), (last, values.last()?)] {
            if value.norm() > GREATEST_AT_END * peak {
                return Some(Refusal::EdgeOfRange { frequency });
            }
        }
    }
    None
}

/// Difference of xy and yx over their size, on lines where both are clear.
fn reciprocity(measured: &Measurement) -> Option<f64> {
    let find = |name: &str| measured.functions.iter().find(|function| function.name() == name);
    let (one, other) = (find("xy")?, find("yx")?);
    let clear = |function: &Frf, i: usize| function.coherence.as_ref().is_none_or(|values| values[i] >= CLEAR);
    let lines = (0..measured.frequencies.len()).filter(|i| clear(one, *i) && clear(other, *i));
    let sizes: Vec<f64> = measured.functions.iter().map(|function| norm(&function.receptance)).collect();
    // As what a fit leaves across, a difference matters beside the responses along.
    let beside = (norm(&one.receptance) / along(measured, &sizes)).min(1.0);
    Some(beside * difference(lines, &one.receptance, &other.receptance))
}
