//! The answer to "is this cut stable?".

use crate::structure::Mode;
use nalgebra::Complex;
use std::f64::consts::{PI, TAU};
use toolroom_spectral::Dominant;

/// How a cut is, or would first become, unstable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ChatterKind {
    /// All multipliers lie inside the unit circle.
    Stable,
    /// A complex pair has left it: vibration at a frequency of its own.
    Hopf,
    /// A real multiplier has left it at −1: period doubling.
    Flip,
    /// Unstable by modulated parameters although stable on average.
    Parametric,
}

/// Verdict of one operating point: a few numbers, cheap to keep.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StabilityVerdict {
    /// Greatest modulus of a Floquet multiplier over [`StabilityVerdict::period`].
    pub spectral_radius: f64,
    /// Whether the spectral radius is below one.
    pub stable: bool,
    /// How the dominant multiplier leaves the unit circle.
    pub kind: ChatterKind,
    /// Argument of the dominant multiplier (rad), 0 … π.
    pub multiplier_angle: f64,
    /// Time that the multiplier spans (s): a tooth period in milling, a revolution in turning.
    pub period: f64,
    /// Frequency of the vibration (Hz): of the line that is nearest to a structural mode.
    pub chatter_frequency: f64,
    /// `1 − depth/stability_limit`, where the limit was computed.
    pub margin: Option<f64>,
    /// Residual of the eigenvalue, relative to it.
    pub residual: f64,
}

impl StabilityVerdict {
    /// Verdict of a dominant multiplier over `period` (s).
    pub(crate) fn from_multiplier(multiplier: Complex<f64>, period: f64, residual: f64) -> Self {
        let spectral_radius = multiplier.norm();
        let angle = multiplier.arg().abs();
        let stable = spectral_radius < 1.0;
        let kind = match (stable, PI - angle < 1e-6) {
            (true, _) => ChatterKind::Stable,
            (false, true) => ChatterKind::Flip,
            (false, false) => ChatterKind::Hopf,
        };
        let chatter_frequency = angle / (TAU * period);
        Self {
            spectral_radius,
            stable,
            kind,
            multiplier_angle: angle,
            period,
            chatter_frequency,
            margin: None,
            residual,
        }
    }

    /// Names the line that excites `modes` most as the chatter frequency.
    pub(crate) fn name_frequency(&mut self, modes: &[Mode]) {
        // Every mode answers most to the line nearest to it.
        let base = self.multiplier_angle / (TAU * self.period);
        let nearest = |mode: &Mode| {
            [base, -base]
                .map(|base| (((mode.natural_frequency - base) * self.period).round() / self.period + base).abs())
        };
        let answer = |line: f64| modes.iter().map(|mode| mode.compliance(line).norm()).sum::<f64>();
        let mut most = 0.0;
        for line in modes.iter().flat_map(nearest) {
            let compliance = answer(line);
            if compliance > most {
                (most, self.chatter_frequency) = (compliance, line);
            }
        }
    }

    /// From the multiplier of `revolutions` to that of one of them: of several roots the one with the
    /// least argument.
    pub(crate) fn spread_over(&mut self, revolutions: u32) {
        let count = f64::from(revolutions);
        self.spectral_radius = self.spectral_radius.powf(1.0 / count);
        self.multiplier_angle /= count;
        self.period /= count;
    }

    /// The frequencies that the vibration can show (Hz), ascending up to `greatest`:
    /// `|± angle/(2 pi period) + j/period|` for every whole j.
    ///
    /// # Examples
    /// ```
    /// use toolroom_chatter::paper::{Preset, Reduced};
    /// let chuck = Reduced::from_preset(Preset::F0_120Hz, 0.0);
    /// let lines = chuck.verdict(0.3, 2.0).unwrap().chatter_frequencies(500.0);
    /// assert!((lines[0] - 120.0).abs() < 1e-6 && (lines[1] - 360.0).abs() < 1e-6);
    /// ```
    pub fn chatter_frequencies(&self, greatest: f64) -> Vec<f64> {
        let base = self.multiplier_angle / (TAU * self.period);
        let mut lines = Vec::new();
        let mut order = 0.0;
        while order / self.period - base <= greatest.min(1e6 / self.period) {
            for line in [order / self.period - base, order / self.period + base] {
                if (0.0..=greatest).contains(&line) {
                    lines.push(line);
                }
            }
            order += 1.0;
        }
        lines.sort_by(f64::total_cmp);
        lines.dedup_by(|a, b| (*a - *b).abs() <= 1e-9 * b.abs());
        lines
    }
}

/// The depth at which a cut becomes unstable.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StabilityLimit {
    /// Depth of cut (m).
    pub depth: f64,
    /// How the cut becomes unstable there.
    pub kind: ChatterKind,
    /// Frequency of the vibration that sets in (Hz).
    pub chatter_frequency: f64,
}

impl StabilityLimit {
    /// From the multiplier of modulus one over `period` at the limit.
    pub(crate) fn new(depth: f64, modes: &[Mode], dominant: Dominant, period: f64) -> Self {
        // Just outside the unit circle, to be classified as the instability that it becomes.
        let multiplier = dominant.value / dominant.value.norm() * (1.0 + 1e-9);
        let mut verdict = StabilityVerdict::from_multiplier(multiplier, period, dominant.residual);
        verdict.name_frequency(modes);
        Self { depth, kind: verdict.kind, chatter_frequency: verdict.chatter_frequency }
    }
}
