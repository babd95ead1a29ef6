//! A predicted tip beside the same assembly as it was measured, and the springs of its joint.

use super::swap_error::SwapError;
use super::tip::Tip;
use nalgebra::{Complex, Matrix3, Vector3};
use serde_json::{Value, json};
use std::fmt::Write as _;
use toolroom_dynamics::{Joint, Measurement};

/// Coherence from which on a measured line counts, as in the quality of a fit.
const CLEAR: f64 = 0.5;
/// Largest peaks that are compared.
const PEAKS: usize = 3;
/// Share of the largest peak from which on another is compared (assumption).
const LEAST_PEAK: f64 = 0.1;
/// Share of a peak to which the response falls on either side of it (assumption: noise on a clear line is less).
const FALLS: f64 = 0.7;
/// Lines over which the springs are sought (assumption: a thousandth of the work of all, on which the answer hardly depends).
const LINES: usize = 400;
/// Radial (N/m) and angular (N m/rad) stiffnesses from which the search starts, softer and stiffer than any holder of tools, and
/// the loss factor (assumptions).
const STARTS: ([f64; 7], [f64; 7], f64) =
    ([3e6, 1e7, 3e7, 1e8, 3e8, 1e9, 3e9], [1e3, 3e3, 1e4, 3e4, 1e5, 3e5, 1e6], 0.02);
/// Best of these starts that are followed.
const FOLLOWED: usize = 4;
/// Greatest number of steps from a start.
const STEPS: usize = 60;
/// Standard deviation of the logarithm of a spring from which on the measurement does not tell it (assumption: a factor of two).
const UNTOLD: f64 = 0.7;

/// Springs of a joint with the standard deviations of the logarithms of radial and angular stiffness and of the loss factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FittedJoint {
    /// The springs.
    pub joint: Joint,
    /// Standard deviations of their logarithms.
    pub sd: [f64; 3],
}

/// A peak of the measured assembly and the nearest one of the predicted: frequency (Hz) and modulus (m/N) of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PeakPair {
    /// Measured.
    pub measured: (f64, f64),
    /// Predicted.
    pub predicted: (f64, f64),
}

/// A predicted tip beside the measured one.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The measured file.
    pub source: String,
    /// Frequencies (Hz) of the lines that both have.
    pub frequencies: Vec<f64>,
    /// Measured response (m/N) there.
    pub measured: Vec<Complex<f64>>,
    /// Predicted response (m/N) there.
    pub predicted: Vec<Complex<f64>>,
    /// The largest peaks, by frequency.
    pub peaks: Vec<PeakPair>,
    /// Norm of the difference over the norm of the measured response.
    pub difference: f64,
    /// The springs that fit best, where they were sought.
    pub joint: Option<FittedJoint>,
}

impl Comparison {
    /// Compares `tip` over `joint` with the direct response of `measured`; with `sought` over the joint that fits it best.
    ///
    /// # Errors
    /// [`SwapError`]: no direct response, no line in common, an infinite receptance.
    pub fn new(tip: &Tip, joint: Option<&Joint>, measured: &Measurement, sought: bool) -> Result<Self, SwapError> {
        let direct = measured.functions.iter().find(|function| function.is_direct()).ok_or(SwapError::NoTip)?;
        let clear = |i: usize| direct.coherence.as_ref().is_none_or(|coherence| coherence[i] >= CLEAR);
        let lines: Vec<(usize, usize)> = measured
            .frequencies
            .iter()
            .enumerate()
            .filter(|(i, _)| clear(*i))
            .filter_map(|(i, frequency)| Some((i, tip.line(*frequency)?)))
            .collect();
        // Fewer lines than springs and a few more tell nothing.
        if lines.len() < 20 {
            return Err(SwapError::NoCommonLines { lines: lines.len() });
        }
        let given: Vec<Complex<f64>> = lines.iter().map(|(i, _)| direct.receptance[*i]).collect();
        let places: Vec<usize> = lines.iter().map(|(_, place)| *place).collect();
        let found = if sought { Some(fitted(tip, &places, &given, joint)?) } else { None };
        let joint = found.as_ref().map(|found| &found.joint).or(joint);
        let predicted = tip.at(&places, joint)?;
        let frequencies: Vec<f64> = places.iter().map(|place| tip.frequencies[*place]).collect();
        let (left, size) = given
            .iter()
            .zip(&predicted)
            .fold((0.0, 0.0), |(left, size), (a, b)| (left + (a - b).norm_sqr(), size + a.norm_sqr()));
        let peaks = pairs(&peaks(&frequencies, &given), &peaks(&frequencies, &predicted));
        let source = measured.source.clone();
        let difference = (left / size).sqrt();
        Ok(Self { source, frequencies, measured: given, predicted, peaks, difference, joint: found })
    }

    /// The comparison for people.
    pub fn text(&self) -> String {
        let mut text = format!("beside {} (measured)\n", self.source);
        text.push_str("peak   measured Hz   predicted Hz   off %   measured um/N   predicted um/N   off %\n");
        for (i, PeakPair { measured: (f, h), predicted: (g, j) }) in self.peaks.iter().enumerate() {
            let off = |a: f64, b: f64| 100.0 * (b / a - 1.0);
            let (f_off, h_off) = (off(*f, *g), off(*h, *j));
            let (h, j) = (1e6 * h, 1e6 * j);
            let _ = writeln!(
                text,
                "{:<6} {f:>11.1}   {g:>12.1}   {f_off:>5.1}   {h:>13.4}   {j:>14.4}   {h_off:>5.1}",
                i + 1
            );
        }
        let _ = writeln!(text, "the prediction is off by {:.1} % of the measured response", 100.0 * self.difference);
        if let Some(FittedJoint { joint, sd }) = &self.joint {
            let _ = writeln!(
                text,
                "\nthe joint that fits best; other tools in the same holder or collet take it into their files:\n[joint]"
            );
            let values = [
                format!("radial = \"{:.4} N/um\"", 1e-6 * joint.radial),
                format!("angular = \"{:.0} N m/rad\"", joint.angular),
                format!("loss_factor = {:.4}", joint.loss_factor),
            ];
            for (value, sd) in values.iter().zip(sd) {
                let said = if *sd < UNTOLD {
                    format!("± {:.1} %", 100.0 * sd)
                } else {
                    "this measurement does not tell it".to_owned()
                };
                let _ = writeln!(text, "{value:<28}   # {said}");
            }
        }
        text
    }

    /// The comparison for programs.
    pub fn json(&self) -> Value {
        let peaks = self.peaks.iter().map(|pair| {
            json!({
                "measured": { "frequency [Hz]": pair.measured.0, "receptance [um/N]": 1e6 * pair.measured.1 },
                "predicted": { "frequency [Hz]": pair.predicted.0, "receptance [um/N]": 1e6 * pair.predicted.1 },
            })
        });
        let joint = self.joint.as_ref().map(|FittedJoint { joint, sd }| {
            json!({
                "radial [N/um]": 1e-6 * joint.radial,
                "angular [N m/rad]": joint.angular,
                "loss_factor": joint.loss_factor,
                "relative_sd": { "radial": sd[0], "angular": sd[1], "loss_factor": sd[2] },
            })
        });
        json!({
            "source": self.source,
            "peaks": peaks.collect::<Vec<_>>(),
            "difference": self.difference,
            "joint": joint,
        })
    }
}

/// Largest peaks of a response by frequency: frequency (Hz) and modulus (m/N). A peak is the greatest value between two
/// that are much less, so that noise makes none.
fn peaks(frequencies: &[f64], values: &[Complex<f64>]) -> Vec<(f64, f64)> {
    let size: Vec<f64> = values.iter().map(|value| value.norm()).collect();
    let greatest = size.iter().copied().fold(0.0, f64::max);
    let mut left: Vec<usize> = (0..size.len()).filter(|i| size[*i] >= LEAST_PEAK * greatest).collect();
    left.sort_by(|a, b| size[*b].total_cmp(&size[*a]));
    let mut found: Vec<usize> = Vec::new();
    for i in left {
        let apart = |other: &usize| {
            let (first, last) = (i.min(*other), i.max(*other));
            size[first..=last].iter().any(|other| *other < FALLS * size[i])
        };
        // At an end of the range nobody knows whether the response falls beyond.
        let falls = |part: &[f64]| part.iter().any(|other| *other < FALLS * size[i]);
        let inner = falls(&size[..i]) && falls(&size[i..]);
        if found.len() < PEAKS && inner && found.iter().all(apart) {
            found.push(i);
        }
    }
    found.sort_unstable();
    found.into_iter().map(|i| (frequencies[i], size[i])).collect()
}

/// Each measured peak with the nearest predicted one.
fn pairs(measured: &[(f64, f64)], predicted: &[(f64, f64)]) -> Vec<PeakPair> {
    let nearest = |peak: &(f64, f64)| {
        let distance = |other: &&(f64, f64)| (other.0 / peak.0).ln().abs();
        predicted.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).copied()
    };
    measured.iter().filter_map(|peak| Some(PeakPair { measured: *peak, predicted: nearest(peak)? })).collect()
}

/// The springs whose response is nearest to the measured one, by the logarithm of their ratio: on the way to the answer peaks stand at other
/// places, and the difference of two sharp peaks says nothing of how far they are apart.
fn fitted(
    tip: &Tip,
    places: &[usize],
    given: &[Complex<f64>],
    known: Option<&Joint>,
) -> Result<FittedJoint, SwapError> {
    let every = places.len().div_ceil(LINES).max(1);
    let thin: Vec<usize> = (0..places.len()).step_by(every).collect();
    let (places, given): (Vec<usize>, Vec<Complex<f64>>) = thin.iter().map(|i| (places[*i], given[*i])).unzip();
    let joint = |p: &Vector3<f64>| Joint { radial: p[0].exp(), angular: p[1].exp(), loss_factor: p[2].exp() };
    let residuals = |p: &Vector3<f64>| -> Result<Vec<f64>, SwapError> {
        let predicted = tip.at(&places, Some(&joint(p)))?;
        Ok(predicted.iter().zip(&given).map(|(a, b)| (a / b).ln()).flat_map(|ratio| [ratio.re, ratio.im]).collect())
    };
    let cost = |residuals: &[f64]| residuals.iter().map(|value| value * value).sum::<f64>();
    let (radial, angular, loss) = STARTS;
    let mut starts: Vec<Vector3<f64>> = radial
        .iter()
        .flat_map(|radial| angular.iter().map(|angular| Vector3::new(radial.ln(), angular.ln(), loss.ln())))
        .collect();
    starts.extend(
        known.map(|known| Vector3::new(known.radial.ln(), known.angular.ln(), known.loss_factor.max(1e-4).ln())),
    );
    let mut ranked: Vec<(f64, Vector3<f64>)> = Vec::new();
    for start in starts {
        ranked.push((cost(&residuals(&start)?), start));
    }
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Option<(f64, Vector3<f64>)> = None;
    for (_, start) in ranked.into_iter().take(FOLLOWED) {
        let found = descended(start, &residuals)?;
        if best.is_none_or(|best| found.0 < best.0) {
            best = Some(found);
        }
    }
    let (least, point) = best.ok_or(SwapError::NoCommonLines { lines: 0 })?;
    let (curvature, _) = normal_equations(&point, &residuals)?;
    let freedom = (2 * given.len() - 3) as f64;
    let covariance = curvature.try_inverse().unwrap_or_else(|| Matrix3::from_diagonal_element(f64::INFINITY));
    let sd = [0, 1, 2].map(|i| {
        let sd = (covariance[(i, i)] * least / freedom).sqrt();
        if sd.is_finite() { sd } else { f64::MAX }
    });
    Ok(FittedJoint { joint: joint(&point), sd })
}

type Residuals<'a> = dyn Fn(&Vector3<f64>) -> Result<Vec<f64>, SwapError> + 'a;

/// Curvature and slope of half the sum of squares, by differences.
fn normal_equations(p: &Vector3<f64>, residuals: &Residuals<'_>) -> Result<(Matrix3<f64>, Vector3<f64>), SwapError> {
    /// Difference of a logarithm: its square is below what rounding leaves of a residual.
    const STEP: f64 = 1e-5;
    let here = residuals(p)?;
    let mut slopes: Vec<Vec<f64>> = Vec::with_capacity(3);
    for i in 0..3 {
        let mut moved = *p;
        moved[i] += STEP;
        slopes.push(residuals(&moved)?.iter().zip(&here).map(|(a, b)| (a - b) / STEP).collect());
    }
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    Ok((Matrix3::from_fn(|i, j| product(&slopes[i], &slopes[j])), Vector3::from_fn(|i, _| product(&slopes[i], &here))))
}

/// Levenberg and Marquardt from a start: the sum of squares and the point.
fn descended(start: Vector3<f64>, residuals: &Residuals<'_>) -> Result<(f64, Vector3<f64>), SwapError> {
    let cost = |p: &Vector3<f64>| Ok::<f64, SwapError>(residuals(p)?.iter().map(|value| value * value).sum());
    // Springs beyond these are rigid, or none; logarithms of loss factors from 1e-4 to 1.
    let [least, greatest] = [[1e4f64.ln(), 1.0, -9.2], [1e12f64.ln(), 1e9f64.ln(), 0.0]];
    let (mut point, mut here) = (start, cost(&start)?);
    let mut damping = 1e-2;
    for _ in 0..STEPS {
        let (mut curvature, slope) = normal_equations(&point, residuals)?;
        for i in 0..3 {
            curvature[(i, i)] += damping * curvature[(i, i)].max(1e-9);
        }
        let Some(step) = curvature.lu().solve(&-slope) else { break };
        let next = Vector3::from_fn(|i, _| (point[i] + step[i].clamp(-1.0, 1.0)).clamp(least[i], greatest[i]));
        let there = cost(&next)?;
        if there < here {
            let settled = here - there < 1e-10 * here;
            (point, here) = (next, there);
            damping = (0.3 * damping).max(1e-9);
            if settled {
                break;
            }
        } else if damping > 1e9 {
            break;
        } else {
            damping *= 5.0;
        }
    }
    Ok((here, point))
}

#[cfg(test)]
mod tests {
    use super::super::tool::Tool;
    use super::super::{blank, tip_of_blank};
    use super::*;
    use std::f64::consts::TAU;
    use toolroom_chatter::Draw;
    use toolroom_dynamics::{
        BaseMode, Direction, FitOptions, FittedMode, Frf, Material, Motion, Receptance, Segment, base, fit,
    };

    /// The spindle of `scenarios/chatter`.
    fn modes() -> [BaseMode; 3] {
        let mode = |[natural_frequency, damping_ratio, stiffness, rotation]: [f64; 4]| BaseMode {
            natural_frequency,
            damping_ratio,
            stiffness,
            rotation,
        };
        [[680.0, 0.045, 42e6, -9.0], [1420.0, 0.03, 65e6, -14.0], [2950.0, 0.025, 90e6, -22.0]].map(mode)
    }

    /// The end mill of `scenarios/chatter`.
    fn mill(joint: Option<Joint>) -> Tool {
        let carbide = Material { youngs_modulus: 580e9, density: 14_500.0, poisson_ratio: 0.24, loss_factor: 0.004 };
        let segments = vec![Segment::rod(0.026, 0.012, 0.8, carbide), Segment::rod(0.014, 0.012, 1.0, carbide)];
        Tool { name: "mill".to_owned(), segments, joint, damper: None }
    }

    fn lines() -> Vec<f64> {
        (0..1284).map(|line| 150.0 + 3.0 * f64::from(line)).collect()
    }

    /// Functions with noise of a share of their greatest modulus, 5 averages, and their coherence.
    fn measured(functions: &[[Direction; 2]], noise: f64, at: impl Fn(f64) -> Vec<Complex<f64>>) -> Measurement {
        let frequencies = lines();
        let values: Vec<Vec<Complex<f64>>> = frequencies.iter().map(|frequency| at(TAU * frequency)).collect();
        let mut draw = Draw::new(3, 0);
        let mut function = |i: usize| {
            let greatest = values.iter().map(|row| row[i].norm()).fold(0.0, f64::max);
            let sd = noise * greatest / 10f64.sqrt();
            let noisy = |row: &Vec<Complex<f64>>| row[i] + Complex::new(sd * draw.normal(), sd * draw.normal());
            let receptance = values.iter().map(noisy).collect();
            let coherence = values.iter().map(|row| 1.0 / (1.0 + (noise * greatest / row[i].norm()).powi(2))).collect();
            let [response, force] = functions[i];
            let motion = Motion::Displacement;
            Frf { response, force, motion, receptance, coherence: Some(coherence), noise: None }
        };
        let functions = (0..functions.len()).map(&mut function).collect();
        Measurement {
            source: "taps".to_owned(),
            frequencies,
            functions,
            averages: Some(5),
            coherence_digit: 1e-12,
            window_decay: 0.0,
            notes: Vec::new(),
        }
    }

    /// Frequency (Hz), damping ratio and stiffness (N/m) of the mode that limits a cut.
    fn limiting(measured: &Measurement) -> [f64; 3] {
        let found = fit(measured, &FitOptions::default()).unwrap();
        let of = |mode: &FittedMode| mode.damping_ratio.value * mode.stiffness.value;
        let mode = found.modes.iter().min_by(|a, b| of(a).total_cmp(&of(b))).unwrap();
        [mode.natural_frequency, mode.damping_ratio, mode.stiffness].map(|part| part.value)
    }

    #[test]
    fn taps_on_a_blank_give_the_modes_that_the_spindle_gives() {
        let steel = Material { youngs_modulus: 205e9, density: 7_850.0, poisson_ratio: 0.29, loss_factor: 0.004 };
        let at = |w: f64| {
            let front = Segment::rod(0.025, 0.016, 1.0, steel).body(w).unwrap();
            let spindle = base(&modes(), w);
            let behind = Segment::rod(0.015, 0.016, 1.0, steel).body(w).unwrap().on(&spindle, None).unwrap();
            let coupling = (front.r22 + behind).try_inverse().unwrap();
            let tip: Receptance = front.r11 - front.r12 * coupling * front.r21;
            [tip, behind * coupling * front.r21, behind * coupling * front.r22].map(|all| all[(0, 0)]).to_vec()
        };
        let cylinder = blank("steel d=16 mm L=40 mm", "25 mm").unwrap();
        let (x, y) = (Direction::X, Direction::Y);
        let tool = mill(Some(Joint { radial: 2e8, angular: 2.5e4, loss_factor: 0.02 }));
        let exact = Tip::of_modes(&modes(), &tool, lines()).unwrap().all(tool.joint.as_ref()).unwrap();
        // The largest modulus and the least real part, with their lines.
        let extremes = |values: &[Complex<f64>]| {
            let size = |i: &usize| values[*i].norm();
            let peak = (0..values.len()).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap();
            let least = (0..values.len()).min_by(|a, b| values[*a].re.total_cmp(&values[*b].re)).unwrap();
            [(peak, values[peak].norm()), (least, values[least].re)]
        };
        for functions in [&[[x, x], [y, x], [y, y]][..], &[[x, x], [y, x]]] {
            let taps = measured(functions, 1e-3, at);
            // Two taps are good up to the highest mode of the spindle, at 2950 Hz.
            let (predicted, _) = tip_of_blank(&taps, None, &cylinder, &tool, [150.0, 2900.0]).unwrap();
            let found = &predicted.functions[0].receptance;
            for ((line, value), (exact_line, exact)) in extremes(found).into_iter().zip(extremes(&exact[..found.len()]))
            {
                assert!(line.abs_diff(exact_line) <= 2 && (value / exact - 1.0).abs() < 0.02, "{value} {exact}");
            }
            // The noise of every line is what its error says.
            let noise = predicted.functions[0].noise.as_ref().unwrap();
            let within = (0..found.len()).filter(|i| (found[*i] - exact[*i]).norm() < 3.0 * noise[*i]).count();
            assert!(functions.len() == 2 || within as f64 > 0.97 * found.len() as f64, "{within} of {}", found.len());
            // The mode that limits the cut is fitted from it, with its uncertainty.
            let [frequency, damping, stiffness] = limiting(&predicted);
            let (_, peak) = extremes(&exact[..found.len()])[0];
            assert!((frequency / 2441.0 - 1.0).abs() < 2e-3, "{frequency}");
            assert!((0.5 / (damping * stiffness) / peak - 1.0).abs() < 0.05, "{damping} {stiffness} {peak}");
            assert_eq!(predicted.notes[0].contains("synthesised"), functions.len() == 2);
            assert!(predicted.notes[1].contains('±'));
        }
        let one = measured(&[[x, x]], 1e-3, at);
        assert_eq!(tip_of_blank(&one, None, &cylinder, &tool, [150.0, 4000.0]).map(|_| ()), Err(SwapError::NoSecond));
    }

    #[test]
    fn the_joint_of_a_measured_assembly_is_found() {
        let joint = Joint { radial: 9e7, angular: 1.2e4, loss_factor: 0.04 };
        let tool = mill(None);
        let tip = Tip::of_modes(&modes(), &tool, lines()).unwrap();
        let x = Direction::X;
        let given = measured(&[[x, x]], 3e-3, |w| {
            vec![tool.body(w).unwrap().on(&base(&modes(), w), Some(&joint)).unwrap()[(0, 0)]]
        });
        let before = Comparison::new(&tip, None, &given, false).unwrap();
        assert!(before.difference > 0.3 && before.joint.is_none(), "{}", before.difference);
        let after = Comparison::new(&tip, None, &given, true).unwrap();
        let found = after.joint.unwrap();
        let pairs = [
            (found.joint.radial, joint.radial),
            (found.joint.angular, joint.angular),
            (found.joint.loss_factor, joint.loss_factor),
        ];
        for ((found, truth), sd) in pairs.iter().zip(found.sd) {
            assert!((found / truth).ln().abs() < 0.05 && sd < 0.05, "{found} {truth} {sd}");
        }
        assert!(after.difference < 0.02 && !after.peaks.is_empty(), "{}", after.difference);
        // A rigid joint has no stiffness that a measurement could tell.
        let rigid =
            measured(&[[x, x]], 3e-3, |w| vec![tool.body(w).unwrap().on(&base(&modes(), w), None).unwrap()[(0, 0)]]);
        let rigid = Comparison::new(&tip, None, &rigid, true).unwrap();
        assert!(rigid.difference < 0.02, "{}", rigid.difference);
        assert!(rigid.text().contains("does not tell"), "{}", rigid.text());
    }
}
