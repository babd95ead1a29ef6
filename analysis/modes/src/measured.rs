//! The limit of a cut straight from the measured response: a cross-check of fitted modes.
//!
//! # Turning
//! A neutral vibration of frequency w has `1 + b L(i w) = 0` with `L = G [K (1 − e^(−i w tau)) + i w C/V]` and the measured
//! response G, from the force to the chip thickness. Its width is `b = −1/Re L` where `Im L = 0` and `Re L < 0`. G between the
//! lines is a natural cubic spline of its real and imaginary part.
//!
//! # Milling
//! The neutral depths at a frequency are eigenvalues over the harmonics of the tooth-passing frequency
//! ([`Milling::limit_of_response`]). Harmonics outside the band take the real part of its first line below it, which is the
//! static compliance there, and fall with `1/w²` above it (assumption).
//!
//! # Domain
//! Lines around the greatest response, as far as the coherence does not stay below 0.5 for three lines. In turning neutral
//! vibrations outside are not seen, so that the limit is at most too high there.

use super::SpeedsError;
use nalgebra::Complex;
use std::f64::consts::TAU;
use toolroom_chatter::{ChatterError, Milling, Sampling, Turning};
use toolroom_dynamics::{Direction, Frf, Measurement};

/// Coherence below which a line says little.
const CLEAR: f64 = 0.5;
/// Lines in a row of low coherence that end the band.
const ENDING: usize = 3;
/// Samples between two lines, and at least in a wave of the delay (assumption: the sign of Im L changes less often).
const SAMPLES: f64 = 8.0;
const PER_WAVE: f64 = 60.0;

/// Why a measured response gives no limit.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeasuredError {
    /// A cut of another kind.
    #[error("a limit straight from a measured response is worked out for milling and turning at constant speed alone")]
    Process,
    /// A function that the cut needs was not measured.
    #[error("the cut needs the response {function}, which was not measured")]
    Missing {
        /// Directions of response and force.
        function: &'static str,
    },
    /// Hardly a line of clear coherence.
    #[error("fewer than ten lines have a coherence of 0.5 and more")]
    Unclear,
    /// A table at several spindle speeds that says nothing of this one.
    #[error(transparent)]
    Speeds(#[from] SpeedsError),
    /// A cut whose modes change along its path, of which the response was measured at one place.
    #[error(
        "the modes of this cut change along its path; put the response beside a lobes file with the modes of its place"
    )]
    Path,
    /// The model refused the cut.
    #[error(transparent)]
    Refused(#[from] ChatterError),
}

/// A limit from the measured response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredLimit {
    /// Least unstable width (m).
    pub depth: f64,
    /// Frequency of the neutral vibration (Hz).
    pub frequency: f64,
}

/// Least unstable width of `cut` at `spindle_speed` (rad/s) with the measured response in place of its modes; none where no
/// neutral vibration lies in the measured band.
///
/// # Errors
/// [`MeasuredError`]: a missing function, no clear lines.
pub fn measured_limit(
    measured: &Measurement,
    cut: &Turning,
    spindle_speed: f64,
) -> Result<Option<MeasuredLimit>, MeasuredError> {
    if cut.along_path.is_some() {
        return Err(MeasuredError::Path);
    }
    let find = |response: Direction, force: Direction| {
        measured.functions.iter().find(|function| function.response == response && function.force == force)
    };
    let direct = find(Direction::X, Direction::X).ok_or(MeasuredError::Missing { function: "xx" })?;
    let (sine, cosine) = cut.force_angle.sin_cos();
    let cross = find(Direction::X, Direction::Y).or_else(|| find(Direction::Y, Direction::X));
    if sine.abs() > 1e-9 && cross.is_none() {
        return Err(MeasuredError::Missing { function: "xy" });
    }
    let band = clear_band(direct);
    if band.len() < 10 {
        return Err(MeasuredError::Unclear);
    }
    let lines: Vec<f64> = measured.frequencies[band.clone()].iter().map(|frequency| TAU * frequency).collect();
    let oriented = |i: usize| {
        let across = cross.map_or(0.0.into(), |cross| cross.receptance[i] * sine);
        direct.receptance[i] * cosine + across
    };
    let real = Spline::new(&lines, band.clone().map(|i| oriented(i).re).collect());
    let imaginary = Spline::new(&lines, band.map(|i| oriented(i).im).collect());
    let period = TAU / spindle_speed;
    let damping = cut.process_damping / (spindle_speed * cut.diameter / 2.0);
    // Real and imaginary part of L.
    let gain = |w: f64| {
        let (sine, cosine) = (w * period).sin_cos();
        let (a, b) = (cut.force_slope() * (1.0 - cosine), cut.force_slope() * sine + w * damping);
        let (re, im) = (real.at(w), imaginary.at(w));
        [re * a - im * b, re * b + im * a]
    };
    let (first, last) = (lines[0], lines[lines.len() - 1]);
    let step = ((last - first) / (lines.len() - 1) as f64 / SAMPLES).min(TAU / period / PER_WAVE);
    let count = ((last - first) / step).ceil() as usize;
    let place = |i: usize| first + (last - first) * i as f64 / count as f64;
    let mut least: Option<MeasuredLimit> = None;
    let mut before = gain(place(0))[1];
    for i in 1..=count {
        let after = gain(place(i))[1];
        if before * after <= 0.0 && before != after {
            let w = bisect(|w| gain(w)[1], place(i - 1), place(i));
            let depth = -1.0 / gain(w)[0];
            if depth > 0.0 && least.is_none_or(|least| depth < least.depth) {
                least = Some(MeasuredLimit { depth, frequency: w / TAU });
            }
        }
        before = after;
    }
    Ok(least)
}

/// Lines of a measured response between which a limit of milling is sought: a resonance has five lines and more in its
/// half-power band, so that half a line turns it by a tenth of its own width at most.
const LINES: f64 = 0.5;

/// Least unstable depth of milling up to `greatest` (m) at `spindle_speed` (rad/s) with the measured response in place of the
/// modes of `cut`; none where no neutral vibration lies below it.
///
/// # Errors
/// [`MeasuredError`]: a missing function, no clear lines, a cut with unequal pitch or runout.
pub fn measured_milling_limit(
    measured: &Measurement,
    cut: &Milling,
    spindle_speed: f64,
    greatest: f64,
) -> Result<Option<MeasuredLimit>, MeasuredError> {
    if cut.along_path.is_some() {
        return Err(MeasuredError::Path);
    }
    let find = |response: Direction, force: Direction| {
        let found = measured.functions.iter().find(|function| function.response == response && function.force == force);
        found.map(|function| Band::new(measured, function)).transpose()
    };
    let (xx, yy) = (find(Direction::X, Direction::X)?, find(Direction::Y, Direction::Y)?);
    let (xy, yx) = (find(Direction::X, Direction::Y)?, find(Direction::Y, Direction::X)?);
    // A direction in which no mode moves need not be measured.
    for (direction, band, function) in [(0, &xx, "xx"), (1, &yy, "yy")] {
        let moves = |mode: &toolroom_chatter::Mode| {
            mode.direction[direction].abs() > 1e-6 * mode.direction[0].hypot(mode.direction[1])
        };
        if band.is_none() && cut.modes.iter().any(moves) {
            return Err(MeasuredError::Missing { function });
        }
    }
    let bands = [xx, xy.clone().or_else(|| yx.clone()), yx.or(xy), yy];
    let highest = bands.iter().flatten().map(|band| band.last()).fold(0.0, f64::max);
    if highest == 0.0 {
        return Err(MeasuredError::Missing { function: "xx" });
    }
    let line = match &measured.frequencies[..] {
        [first, .., last] => TAU * (last - first) / (measured.frequencies.len() - 1) as f64,
        _ => return Err(MeasuredError::Unclear),
    };
    let response =
        |w: f64| bands.each_ref().map(|band| band.as_ref().map_or(Complex::new(0.0, 0.0), |band| band.at(w)));
    let sampling = Sampling { step: LINES * line, highest };
    let found = cut.limit_of_response(spindle_speed, greatest, sampling, &response)?;
    Ok(found.map(|limit| MeasuredLimit { depth: limit.depth, frequency: limit.chatter_frequency }))
}

/// A measured function within its clear band, and what is taken beyond.
#[derive(Clone)]
struct Band {
    lines: Vec<f64>,
    real: Spline,
    imaginary: Spline,
}

impl Band {
    fn new(measured: &Measurement, function: &Frf) -> Result<Self, MeasuredError> {
        let band = clear_band(function);
        if band.len() < 10 {
            return Err(MeasuredError::Unclear);
        }
        let lines: Vec<f64> = measured.frequencies[band.clone()].iter().map(|frequency| TAU * frequency).collect();
        let part = |of: fn(&Complex<f64>) -> f64| {
            Spline::new(&lines, function.receptance[band.clone()].iter().map(of).collect())
        };
        let (real, imaginary) = (part(|h| h.re), part(|h| h.im));
        Ok(Self { real, imaginary, lines })
    }

    fn last(&self) -> f64 {
        self.lines[self.lines.len() - 1]
    }

    fn at(&self, w: f64) -> Complex<f64> {
        let (first, last) = (self.lines[0], self.last());
        let known = |w: f64| Complex::new(self.real.at(w), self.imaginary.at(w));
        if w < first {
            Complex::new(self.real.at(first), 0.0)
        } else if w > last {
            known(last) * (last / w).powi(2)
        } else {
            known(w)
        }
    }
}

/// The lines around the greatest response, up to where the coherence stays low.
fn clear_band(function: &Frf) -> std::ops::Range<usize> {
    let count = function.receptance.len();
    let Some(coherence) = &function.coherence else { return 0..count };
    let size = |i: usize| if coherence[i] >= CLEAR { function.receptance[i].norm() } else { 0.0 };
    let top = (0..count).max_by(|a, b| size(*a).total_cmp(&size(*b))).unwrap_or(0);
    let low = |i: &usize| coherence[*i] < CLEAR;
    let ends = |mut lines: Vec<usize>| {
        let cut = lines.windows(ENDING).position(|window| window.iter().all(low)).unwrap_or(lines.len());
        lines.truncate(cut);
        lines.last().copied().unwrap_or(top)
    };
    ends((0..=top).rev().collect())..ends((top..count).collect()) + 1
}

/// A zero between two places with values of opposite sign.
fn bisect(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let sign = f(low) > 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (f(middle) > 0.0) == sign { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// A natural cubic spline.
#[derive(Clone)]
struct Spline {
    places: Vec<f64>,
    values: Vec<f64>,
    /// Second derivatives.
    bends: Vec<f64>,
}

impl Spline {
    fn new(places: &[f64], values: Vec<f64>) -> Self {
        // Thomas's algorithm on the tridiagonal equations of the second derivatives, which are zero at the ends.
        let count = values.len();
        let (mut above, mut bends) = (vec![0.0; count], vec![0.0; count]);
        for i in 1..count - 1 {
            let (left, right) = (places[i] - places[i - 1], places[i + 1] - places[i]);
            let pivot = 2.0 * (left + right) - left * above[i - 1];
            above[i] = right / pivot;
            let turn = (values[i + 1] - values[i]) / right - (values[i] - values[i - 1]) / left;
            bends[i] = (6.0 * turn - left * bends[i - 1]) / pivot;
        }
        for i in (1..count - 1).rev() {
            bends[i] -= above[i] * bends[i + 1];
        }
        Self { places: places.to_vec(), values, bends }
    }

    fn at(&self, place: f64) -> f64 {
        let right = self.places.partition_point(|known| *known < place).clamp(1, self.places.len() - 1);
        let (left, width) = (right - 1, self.places[right] - self.places[right - 1]);
        let (a, b) = ((self.places[right] - place) / width, (place - self.places[left]) / width);
        let bend = |share: f64, i: usize| (share.powi(3) - share) * self.bends[i];
        a * self.values[left] + b * self.values[right] + (bend(a, left) + bend(b, right)) * width * width / 6.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_chatter::{Cutter, Engagement, MillingForce, Mode};
    use toolroom_dynamics::Motion;

    #[test]
    fn milling_from_a_table_without_noise_has_the_limit_of_its_modes() {
        let modes = vec![mode(612.4, 0.0312, 22.4e6, 0.0), mode(1184.7, 0.0187, 9.6e6, 0.0)];
        let measured = table(&modes);
        let cut = Milling {
            modes,
            cutter: Cutter::straight(4, 0.012),
            engagement: Engagement::new(0.25, toolroom_chatter::Direction::Down).unwrap(),
            force: MillingForce::new(1.8e9, 6e8),
            feed_per_tooth: 0.0,
            by_speed: None,
            along_path: None,
        };
        for rpm in [4200.0, 5400.0] {
            let speed = rpm / 60.0 * TAU;
            let expected = cut.at_speed(speed).unwrap().limit(20e-3).unwrap();
            let found = measured_milling_limit(&measured, &cut, speed, 20e-3).unwrap().unwrap();
            assert!((found.depth / expected.depth - 1.0).abs() < 5e-3, "{rpm} {found:?} {expected:?}");
        }
        let mut across = cut.clone();
        across.modes[0].direction = [0.0, 1.0];
        let refused = measured_milling_limit(&measured, &across, 500.0, 1e-2);
        assert_eq!(refused, Err(MeasuredError::Missing { function: "yy" }));
    }

    fn mode(natural_frequency: f64, damping_ratio: f64, stiffness: f64, angle: f64) -> Mode {
        let (sine, cosine) = f64::to_radians(angle).sin_cos();
        Mode { direction: [cosine, sine], natural_frequency, damping_ratio, stiffness }
    }

    fn table(modes: &[Mode]) -> Measurement {
        let frequencies: Vec<f64> = (50..2000).map(|i| 2.0 * f64::from(i)).collect();
        let functions = [(Direction::X, Direction::X), (Direction::X, Direction::Y)].map(|(response, force)| Frf {
            response,
            force,
            motion: Motion::Displacement,
            receptance: frequencies
                .iter()
                .map(|frequency| {
                    let share = |mode: &Mode| mode.direction[response.index()] * mode.direction[force.index()];
                    modes.iter().map(|mode| mode.compliance(*frequency) * share(mode)).sum()
                })
                .collect(),
            coherence: None,
            noise: None,
        });
        Measurement {
            source: "table".to_owned(),
            frequencies,
            functions: functions.to_vec(),
            averages: None,
            coherence_digit: 0.0,
            window_decay: 0.0,
            notes: Vec::new(),
        }
    }

    #[test]
    fn a_table_without_noise_has_the_limits_of_its_modes() {
        let modes =
            vec![mode(612.4, 0.0312, 22.4e6, 0.0), mode(1184.7, 0.0187, 9.6e6, 30.0), mode(2361.0, 0.0241, 31e6, 0.0)];
        let measured = table(&modes);
        for (force_angle, process_damping) in [(0.0, 0.0), (0.4, 0.0), (0.4, 2e5)] {
            let cut = Turning { force_angle, process_damping, ..Turning::orthogonal(modes.clone(), 1.2e9, 0.05) };
            for rpm in [4200.0, 5400.0, 7150.0] {
                let speed = rpm / 60.0 * TAU;
                let (found, expected) =
                    (measured_limit(&measured, &cut, speed).unwrap().unwrap(), cut.limit(speed).unwrap());
                assert!((found.depth / expected.depth - 1.0).abs() < 2e-5, "{rpm} {found:?} {expected:?}");
            }
        }
        let mut without = measured;
        without.functions.truncate(1);
        let cut = Turning { force_angle: 0.4, ..Turning::orthogonal(modes, 1.2e9, 0.05) };
        assert_eq!(measured_limit(&without, &cut, 500.0), Err(MeasuredError::Missing { function: "xy" }));
    }
}
