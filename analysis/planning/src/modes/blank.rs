//! A tool on a spindle of which taps at two points of a blank are known.

use super::swap::SwapError;
use super::tool::{MATERIALS, Tool};
use nalgebra::{Complex, DMatrix, DVector};
use std::f64::consts::TAU;
use toolroom_chatter::Draw;
use toolroom_dynamics::{
    Blank, BlankResponse, Body, Direction, Fit, FittedMode, Frf, Measurement, Motion, Segment, chain,
};
use toolroom_process::unit;

/// Draws of the modes of the blank behind a standard deviation (assumption: it is then known to 9 %).
const DRAWS: u64 = 64;
/// Seed of these draws.
const SEED: u64 = 20;

/// A blank as it is written on a command line: `steel d=16 mm L=40 mm`, and the distance of the second point from the tip.
///
/// # Errors
/// [`SwapError::Blank`] with what is wrong.
pub fn blank(text: &str, second: &str) -> Result<Blank, SwapError> {
    let refused = |reason: String| SwapError::Blank { reason };
    let (material, rest) = text.trim().split_once(char::is_whitespace).unwrap_or((text, ""));
    let known = MATERIALS.iter().find(|(name, _)| *name == material).ok_or_else(|| {
        let names: Vec<&str> = MATERIALS.iter().map(|(name, _)| *name).collect();
        refused(format!("--blank: there is no material `{material}`; {} are", names.join(", ")))
    })?;
    let length = |flag: &str, text: &str| {
        let found = unit::quantity(text.trim(), "m").map_err(|error| refused(format!("{flag}: {error}")))?;
        // Ten metres are beyond any spindle.
        if found > 0.0 && found < 10.0 { Ok(found) } else { Err(refused(format!("{flag}: {text} is no length"))) }
    };
    let rest = rest.trim_start();
    let (diameter, reach) = match (rest.strip_prefix("d="), rest.split_once("L=")) {
        (Some(_), Some((diameter, reach))) => (&diameter["d=".len()..], reach),
        _ => return Err(refused(format!("--blank: `{text}` lacks d= and L= in this order"))),
    };
    let segment = Segment {
        length: length("--blank L", reach)?,
        diameter: length("--blank d", diameter)?,
        inner_diameter: 0.0,
        bending_factor: 1.0,
        inertia_factor: 1.0,
        material: known.1,
    };
    let second = length("--second", second)?;
    if second > segment.length {
        return Err(refused(format!(
            "--second: the second point is {} mm from the tip of a blank of {} mm",
            1e3 * second,
            1e3 * segment.length
        )));
    }
    Ok(Blank { segment, second })
}

/// Receptance at the tip of `tool` on the spindle that held `blank` while it was tapped, at the measured lines within `range` (Hz),
/// with what the taps leave uncertain in its notes.
///
/// The responses are those of `fit`, the modes of the blank, whose noise is less than that of the taps.
///
/// # Errors
/// [`SwapError`]: taps that lack the second point, no line within the range, a receptance that is infinite.
pub fn tip_of_blank(
    tapped: &Measurement,
    fit: &Fit,
    blank: &Blank,
    tool: &Tool,
    range: [f64; 2],
) -> Result<Measurement, SwapError> {
    let place = |names: &[&str]| {
        let found = tapped.functions.iter().position(|function| names.contains(&function.name().as_str()));
        found.map(|index| (index, &fit.fitted[index]))
    };
    let (_, tip) = place(&["xx"]).ok_or(SwapError::NoTip)?;
    let (_, across) = place(&["yx"]).or_else(|| place(&["xy"])).ok_or(SwapError::NoSecond)?;
    let second = place(&["yy"]).map(|(_, values)| values);
    let lines: Vec<usize> =
        (0..tapped.frequencies.len()).filter(|i| (range[0]..=range[1]).contains(&tapped.frequencies[*i])).collect();
    if lines.is_empty() {
        return Err(SwapError::NoLines { from: range[0], to: range[1] });
    }
    let infinite = |frequency: f64| SwapError::Infinite { frequency };
    let bodies: Vec<Body> = lines
        .iter()
        .map(|i| chain(&tool.segments, TAU * tapped.frequencies[*i]).ok_or(infinite(tapped.frequencies[*i])))
        .collect::<Result<_, _>>()?;
    // `moved` is what a draw of the modes adds to the responses of the fit.
    let at = |line: usize, moved: [Complex<f64>; 3]| {
        let (i, w) = (lines[line], TAU * tapped.frequencies[lines[line]]);
        let response = BlankResponse {
            tip: tip[i] + moved[0],
            across: across[i] + moved[1],
            second: second.map(|values| values[i] + moved[2]),
        };
        let found = bodies[line].on(&blank.face(&response, w)?, tool.joint.as_ref())?[(0, 0)];
        (found.re.is_finite() && found.im.is_finite()).then_some(found)
    };
    let none = [Complex::new(0.0, 0.0); 3];
    let receptance: Vec<_> = (0..lines.len())
        .map(|line| at(line, none).ok_or(infinite(tapped.frequencies[lines[line]])))
        .collect::<Result<_, _>>()?;
    let mut notes = vec![if second.is_some() {
        "the spindle behind the blank follows from 11, 21 and 22".to_owned()
    } else {
        "the second point was not tapped itself: what a moment turns is synthesised, theta/M = (theta/F)²/(y/F), which costs some \
         percent and more beyond the frequencies of the blank; 22 in the table would tell it"
            .to_owned()
    }];
    notes.push(spread(fit, &lines, tapped, &receptance, at));
    let frequencies = lines.iter().map(|i| tapped.frequencies[*i]).collect();
    let function = Frf {
        response: Direction::X,
        force: Direction::X,
        motion: Motion::Displacement,
        receptance,
        coherence: None,
        noise: None,
    };
    Ok(Measurement {
        source: format!("{} on the spindle behind the blank of {}", tool.name, tapped.source),
        frequencies,
        functions: vec![function],
        averages: None,
        coherence_digit: 0.0,
        window_decay: 0.0,
        notes,
    })
}

/// What the noise of the taps leaves uncertain at the tip of the tool, in words.
fn spread(
    fit: &Fit,
    lines: &[usize],
    tapped: &Measurement,
    receptance: &[Complex<f64>],
    at: impl Fn(usize, [Complex<f64>; 3]) -> Option<Complex<f64>>,
) -> String {
    let lowest = (0..receptance.len()).min_by(|a, b| receptance[*a].re.total_cmp(&receptance[*b].re)).unwrap_or(0);
    let mut drawn: [Vec<f64>; 2] = [Vec::new(), Vec::new()];
    for number in 0..DRAWS {
        let modes = draw(fit, &mut Draw::new(SEED, number));
        let found: Vec<f64> = [0, lowest]
            .into_iter()
            .filter_map(|line| {
                let w = TAU * tapped.frequencies[lines[line]];
                let nominal: Vec<Mode> = fit.modes.iter().map(Mode::of).collect();
                let moved = [(0, 0), (1, 0), (1, 1)]
                    .map(|(p, q)| receptance_of(&modes, p, q, w) - receptance_of(&nominal, p, q, w));
                at(line, moved).map(|value| value.re)
            })
            .collect();
        if let [first, least] = found[..] {
            drawn[0].push(first);
            drawn[1].push(least);
        }
    }
    let with_sd = |line: usize, values: &[f64]| {
        let value = receptance[line].re;
        let sd = (values.iter().map(|draw| (draw - value).powi(2)).sum::<f64>() / values.len().max(1) as f64).sqrt();
        format!("{:.4} ± {:.4} um/N at {:.0} Hz", 1e6 * value, 1e6 * sd, tapped.frequencies[lines[line]])
    };
    format!(
        "by the noise of the taps the real part at the tip is {} and, where it is least, {}",
        with_sd(0, &drawn[0]),
        with_sd(lowest, &drawn[1])
    )
}

/// A mode of the blank: natural frequency (rad/s), damping ratio, stiffness (N/m), share of either point.
struct Mode {
    frequency: f64,
    damping_ratio: f64,
    stiffness: f64,
    shape: [f64; 2],
}

impl Mode {
    fn of(mode: &FittedMode) -> Self {
        Self {
            frequency: TAU * mode.natural_frequency.value,
            damping_ratio: mode.damping_ratio.value,
            stiffness: mode.stiffness.value,
            shape: mode.direction,
        }
    }
}

/// The modes with errors as their covariance has them; the ratio of the two points is taken as independent of the rest.
fn draw(fit: &Fit, random: &mut Draw) -> Vec<Mode> {
    let count = fit.covariance.len();
    let scale: Vec<f64> = (0..count).map(|i| fit.covariance[i][i].max(0.0).sqrt().max(f64::MIN_POSITIVE)).collect();
    let correlation = DMatrix::from_fn(count, count, |i, j| {
        // A ten-millionth more on the diagonal keeps rounding from making the matrix indefinite.
        fit.covariance[i][j] / (scale[i] * scale[j]) + if i == j { 1e-7 } else { 0.0 }
    });
    let normal = DVector::from_fn(count, |_, _| random.normal());
    let errors = correlation.cholesky().map_or_else(|| normal.clone(), |root| root.l() * &normal);
    let mut found: Vec<Mode> = fit.modes.iter().map(Mode::of).collect();
    for (r, mode) in found.iter_mut().enumerate() {
        let error = |k: usize| if 3 * r + k < count { errors[3 * r + k] * scale[3 * r + k] } else { 0.0 };
        mode.frequency += TAU * error(0);
        mode.damping_ratio += error(1);
        mode.stiffness += error(2);
        let turned = random.normal();
        let (sine, cosine) = (turned * fit.modes[r].direction_sd.unwrap_or(0.0)).sin_cos();
        let [x, y] = mode.shape;
        mode.shape = [x * cosine - y * sine, x * sine + y * cosine];
    }
    found
}

/// Response (m/N) of point `p` under a force at point `q` at `w` (rad/s).
fn receptance_of(modes: &[Mode], p: usize, q: usize, w: f64) -> Complex<f64> {
    modes
        .iter()
        .map(|mode| {
            let wr = mode.frequency;
            let denominator = Complex::new(wr * wr - w * w, 2.0 * mode.damping_ratio * wr * w);
            mode.shape[p] * mode.shape[q] * wr * wr / mode.stiffness / denominator
        })
        .sum()
}
