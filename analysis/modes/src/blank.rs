//! A tool on a spindle of which taps at two points of a blank are known.

use super::swap_error::SwapError;
use super::tip::Tip;
use super::tool::{MATERIALS, Tool};
use nalgebra::Complex;
use std::f64::consts::TAU;
use toolroom_dynamics::{Blank, BlankResponse, Direction, Frf, Measurement, Motion, Segment};
use toolroom_process::unit;

/// Share of a response by which it is moved to see what its noise does; the tip is nearly linear in so small a change.
const STEP: f64 = 1e-6;
/// Longest blank (m) (assumption: none is longer than a spindle).
const LONGEST: f64 = 2.0;

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
        if found > 0.0 && found <= LONGEST { Ok(found) } else { Err(refused(format!("{flag}: {text} is no length"))) }
    };
    let dimensions = rest.trim_start().strip_prefix("d=").and_then(|rest| rest.split_once("L="));
    let Some((diameter, reach)) = dimensions else {
        return Err(refused(format!("--blank: `{text}` lacks d= and L= in this order")));
    };
    let segment = Segment::rod(length("--blank L", reach)?, length("--blank d", diameter)?, 1.0, known.1);
    let second = length("--second", second)?;
    if second > segment.length {
        let [second, length] = [second, segment.length].map(|length| 1e3 * length);
        return Err(refused(format!("--second: {second} mm from the tip lie beyond the blank of {length} mm")));
    }
    Ok(Blank { segment, second })
}

/// Receptance at the tip of `tool` on the spindle that held `blank` while it was tapped, at the measured lines within `range`
/// (Hz), with the noise that the taps leave in it, where their coherence and number of averages tell it; and the tool and the
/// spindle at these lines, for another joint.
///
/// # Errors
/// [`SwapError`]: taps that lack the second point, no line within the range, a receptance that is infinite.
pub fn tip_of_blank(
    tapped: &Measurement,
    averages: Option<u32>,
    blank: &Blank,
    tool: &Tool,
    range: [f64; 2],
) -> Result<(Measurement, Tip), SwapError> {
    if tapped.window_decay > 0.0 {
        return Err(SwapError::Windowed);
    }
    let find = |names: &[&str]| tapped.functions.iter().find(|function| names.contains(&function.name().as_str()));
    let tip = find(&["xx"]).ok_or(SwapError::NoTip)?;
    let across = find(&["yx"]).or_else(|| find(&["xy"])).ok_or(SwapError::NoSecond)?;
    let second = find(&["yy"]);
    let taps: Vec<&Frf> = [Some(tip), Some(across), second].into_iter().flatten().collect();
    let averages = averages.or(tapped.averages).map_or(1.0, f64::from);
    let lines: Vec<usize> =
        (0..tapped.frequencies.len()).filter(|i| (range[0]..=range[1]).contains(&tapped.frequencies[*i])).collect();
    if lines.is_empty() {
        return Err(SwapError::NoLines { from: range[0], to: range[1] });
    }
    let (mut receptance, mut noise) = (Vec::new(), Vec::new());
    let (mut bodies, mut faces) = (Vec::new(), Vec::new());
    for i in &lines {
        let frequency = tapped.frequencies[*i];
        let w = TAU * frequency;
        let infinite = || SwapError::Infinite { frequency };
        let body = tool.body(w).ok_or_else(infinite)?;
        let at = |values: &[Complex<f64>]| {
            let found = body.on(&blank.face(&told(values), w)?, tool.joint.as_ref())?[(0, 0)];
            (found.re.is_finite() && found.im.is_finite()).then_some(found)
        };
        let values: Vec<Complex<f64>> = taps.iter().map(|function| function.receptance[*i]).collect();
        let value = at(&values).ok_or_else(infinite)?;
        faces.push(blank.face(&told(&values), w).ok_or_else(infinite)?);
        let mut variance = Some(0.0);
        for (j, function) in taps.iter().enumerate() {
            let mut moved = values.clone();
            let step = STEP * moved[j].norm().max(f64::MIN_POSITIVE);
            moved[j] += step;
            // The tip is an analytic function of each response: real and imaginary noise act alike.
            let slope = (at(&moved).ok_or_else(infinite)? - value).norm() / step;
            variance = variance.zip(deviation(function, *i, averages)).map(|(sum, sd)| sum + (slope * sd).powi(2));
        }
        bodies.push(body);
        receptance.push(value);
        noise.push(variance.map(f64::sqrt));
    }
    let frequencies: Vec<f64> = lines.iter().map(|i| tapped.frequencies[*i]).collect();
    let noise: Option<Vec<f64>> = noise.into_iter().collect();
    let mut notes = vec![if second.is_some() {
        "the spindle behind the blank follows from 11, 21 and 22".to_owned()
    } else {
        "the second point was not tapped itself: what a moment turns is synthesised, theta/M = (theta/F)²/(y/F), which is good to some \
         percent up to the highest mode of the spindle and wrong beyond; 22 in the table tells it"
            .to_owned()
    }];
    notes.extend(noise.as_ref().map(|noise| uncertainty(&frequencies, &receptance, noise)));
    // The coherence that as many averages with this noise would show.
    let coherent = |(value, sd): (&Complex<f64>, &f64)| {
        let share = 2.0 * averages * sd * sd / value.norm_sqr().max(f64::MIN_POSITIVE);
        1.0 / (1.0 + share)
    };
    let coherence = noise.as_ref().map(|noise| receptance.iter().zip(noise).map(coherent).collect());
    let motion = Motion::Displacement;
    let function = Frf { response: Direction::X, force: Direction::X, motion, receptance, coherence, noise };
    let measured = Measurement {
        source: format!("{} on the spindle behind the blank of {}", tool.name, tapped.source),
        frequencies: frequencies.clone(),
        functions: vec![function],
        // The noise is known, what modes with viscous damping leave is not: the residuals of the fit give the scale.
        averages: None,
        coherence_digit: 0.0,
        window_decay: 0.0,
        notes,
    };
    Ok((measured, Tip { frequencies, bodies, faces }))
}

/// The taps of a line: the tip, the second point, and the second point itself where it was tapped.
fn told(values: &[Complex<f64>]) -> BlankResponse {
    BlankResponse { tip: values[0], across: values[1], second: values.get(2).copied() }
}

/// Standard deviation (m/N) of the real and of the imaginary part of a response at a line, where the file tells it.
fn deviation(function: &Frf, line: usize, averages: f64) -> Option<f64> {
    if let Some(noise) = &function.noise {
        return Some(noise[line]);
    }
    let coherence = function.coherence.as_ref()?[line].clamp(1e-9, 1.0);
    Some(function.receptance[line].norm() * ((1.0 - coherence) / (2.0 * averages * coherence)).sqrt())
}

/// What the noise of the taps leaves uncertain at the tip of the tool, in words.
fn uncertainty(frequencies: &[f64], receptance: &[Complex<f64>], noise: &[f64]) -> String {
    let least = (0..receptance.len()).min_by(|a, b| receptance[*a].re.total_cmp(&receptance[*b].re)).unwrap_or(0);
    let part =
        |i: usize| format!("{:.4} ± {:.4} um/N at {:.0} Hz", 1e6 * receptance[i].re, 1e6 * noise[i], frequencies[i]);
    format!(
        "by the noise of the taps a single line of the real part at the tip is {}, and at its least {}",
        part(0),
        part(least)
    )
}
