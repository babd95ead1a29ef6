//! A single point of a chart: where it is, as people write it, and its verdict.

use super::cut::{AlongPath, Cut};
use super::judgement::Vibration;
use super::{Judgement, LobesFile};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use toolroom_chatter::{ChatterError, Probability, SpeedVariation, WorstPhase};
use toolroom_dynamics::Measurement;
use toolroom_form::significant;
use toolroom_modes::{MeasuredError, MeasuredLimit, measured_limit, measured_milling_limit};
use toolroom_process::unit;

/// A text that is no place in a chart.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct PlaceError {
    message: String,
    example: &'static str,
}

impl PlaceError {
    /// A place that would do, as after `--at`.
    pub fn fix(&self) -> String {
        format!("write for example --at {}", self.example)
    }
}

impl Cut {
    /// The place on both axes of the chart, SI, of two quantities with their units. The speed of a chuck is a ratio, or
    /// the spindle speed that gives it.
    ///
    /// # Errors
    /// [`PlaceError`]: no quantity of the axis, a speed that is not positive, a negative depth.
    pub fn place(&self, speed: &str, depth: &str) -> Result<(f64, f64), PlaceError> {
        let example = match self {
            Self::Chuck(_) | Self::Lathe(_) => "1 0.3",
            Self::ChipLag(_) => "\"40 us\" \"1.9 N/um\"",
            Self::Milling(..) | Self::Turning(..) => "\"5000 rpm\" \"0.5 mm\"",
        };
        let refuse = |message: String| PlaceError { message, example };
        let quantity = |text, unit| unit::quantity(text, unit).map_err(|error| refuse(error.to_string()));
        // A ratio, or a spindle speed over that of ratio one.
        let ratio = |per_speed: f64| match unit::quantity(speed, "rad/s") {
            Ok(spindle) => Ok(per_speed * spindle),
            Err(_) => quantity(speed, "1"),
        };
        let x = match self {
            Self::Chuck(chuck) => ratio(3.0 / chuck.natural_frequency())?,
            Self::Lathe(lathe) => ratio(1.0 / lathe.reference_frequency())?,
            Self::Milling(..) | Self::Turning(..) | Self::ChipLag(_) => quantity(speed, self.axes().speed.si)?,
        };
        // A cut may come without lag.
        let least = if matches!(self, Self::ChipLag(_)) { 0.0 } else { f64::MIN_POSITIVE };
        if !(x.is_finite() && x >= least) {
            return Err(refuse(format!("the speed must be positive, is {speed}")));
        }
        let y = quantity(depth, self.axes().depth.si)?;
        if !(y.is_finite() && y >= 0.0) {
            return Err(refuse(format!("the depth must not be negative, is {depth}")));
        }
        Ok((x, y))
    }
}

/// The verdict at one place of a chart, for people and programs.
#[derive(Clone, Debug)]
pub struct PointVerdict<'a> {
    file: &'a LobesFile,
    judgement: Judgement,
    /// The limit straight from a measured response, and none where no neutral vibration lies in its band.
    measured: Option<Option<MeasuredLimit>>,
    /// Probability that the point is stable, where a file says how well the constants are known.
    probability: Option<Probability>,
    /// Load and limits.
    load: Map<String, Value>,
    /// The worst phase of a varying speed, of milling.
    worst: Option<WorstPhase>,
    /// Stability along the path, where the modes change on it.
    path: Option<AlongPath>,
}

/// Samples behind a probability: its standard error is at most 2.5 %.
const SAMPLES: u64 = 400;
/// Seed of these samples.
const SEED: u64 = 1;

/// The 95 % interval of a probability from [`SAMPLES`] samples (E. B. Wilson, Journal of the American Statistical Association 22 (1927)
/// 209, recalled).
pub(super) fn interval(probability: Probability) -> [f64; 2] {
    const NORMAL: f64 = 1.96;
    let share = NORMAL * NORMAL / SAMPLES as f64;
    let reach = (probability.standard_error.powi(2) + 0.25 * share / SAMPLES as f64).sqrt() * NORMAL;
    [-reach, reach].map(|reach| ((probability.value + 0.5 * share + reach) / (1.0 + share)).clamp(0.0, 1.0))
}

/// Difference of the limits of modes and of the measured response from which on a warning is due (assumption).
pub const GREATEST_DIFFERENCE: f64 = 0.05;

/// Key of the limits along the path: pairs of position and stability limit.
const ALONG_PATH: &str = "limits_along_path [mm]";

impl LobesFile {
    /// Probability that the cut is stable at a speed (rad/s) and depth (m), the constants scattering as the file says; none where it
    /// says nothing of them, and at a speed that varies.
    ///
    /// # Errors
    /// As the verdict there.
    pub(super) fn stability_probability(
        &self,
        (speed, depth): (f64, f64),
    ) -> Result<Option<Probability>, ChatterError> {
        let Some(scatter) = &self.scatter else { return Ok(None) };
        match &self.cut {
            Cut::Milling(cut, None) => cut.stability_probability(speed, depth, scatter, SAMPLES, SEED).map(Some),
            Cut::Turning(cut, None) => cut.stability_probability(speed, depth, scatter, SAMPLES, SEED).map(Some),
            Cut::Milling(..) | Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => Ok(None),
        }
    }
}

impl<'a> PointVerdict<'a> {
    /// Judges a place, SI, on both axes of the chart of `file`.
    ///
    /// # Errors
    /// [`ChatterError`] where the model refuses a value, or finds no result.
    pub fn new(file: &'a LobesFile, (speed, depth): (f64, f64)) -> Result<Self, ChatterError> {
        let mut judgement = file.cut.judge(speed, depth, &file.chart)?;
        // Of teeth that run out those that reach less far cut thin chips, which a vibration leaves: the series, in which every
        // tooth stays in its cut, was off by 13 % there.
        let runs_out = matches!(&file.cut, Cut::Milling(cut, None) if cut.cutter.runout > 0.0) && file.feed.is_some();
        if (!judgement.verdict.stable || runs_out) && depth > 0.0 {
            let settled = file.settled(speed, depth).ok();
            let of_series = judgement.vibration.and_then(|vibration| vibration.surface_location_error);
            let simulated = settled.as_ref().map(|settled| Vibration {
                surface_location_error: of_series,
                ..Vibration::simulated(&file.cut, (speed, depth), settled)
            });
            // Beyond the limit what is not simulated has no amplitude; a stable cut has that of the series.
            judgement.vibration = if judgement.verdict.stable { simulated.or(judgement.vibration) } else { simulated };
        }
        let probability = file.stability_probability((speed, depth))?;
        let load = file.load_json(speed, depth, judgement.verdict.stable)?;
        let worst = match &file.cut {
            Cut::Milling(cut, Some(variation)) if depth > 0.0 => {
                let free = SpeedVariation { phase: None, ..*variation };
                cut.at_varying_speed(speed, free)?.worst_phase(depth)?
            }
            Cut::Milling(..) | Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => None,
        };
        let path = file.cut.along_path(speed, depth, judgement.searched.min(file.chart.depth.end.max(2.0 * depth)))?;
        Ok(Self { file, judgement, measured: None, probability, load, worst, path })
    }

    /// Puts the limit straight from a measured response beside that of the modes.
    ///
    /// # Errors
    /// [`MeasuredError`]: a cut that is none at constant speed, a missing function, no clear lines.
    pub fn beside(mut self, measured: &Measurement) -> Result<Self, MeasuredError> {
        let Judgement { speed, searched, .. } = self.judgement;
        self.measured = Some(match &self.file.cut {
            Cut::Turning(cut, None) => measured_limit(measured, cut, speed)?,
            Cut::Milling(cut, None) => measured_milling_limit(measured, cut, speed, searched)?,
            Cut::Milling(..) | Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => {
                return Err(MeasuredError::Process);
            }
        });
        Ok(self)
    }

    /// Limit of the modes over that of the measured response, less one.
    fn difference(&self) -> Option<f64> {
        Some(self.judgement.limit? / self.measured??.depth - 1.0)
    }

    /// That modes and measured response disagree.
    pub fn warning(&self) -> Option<String> {
        let difference = self.difference().filter(|difference| difference.abs() > GREATEST_DIFFERENCE)?;
        Some(format!(
            "the limit of the modes differs by {:+.1} % from that of the measured response: look at the fit",
            difference * 100.0
        ))
    }

    /// For programs.
    pub fn json(&self) -> Map<String, Value> {
        let mut object = Map::from_iter([("schema".to_owned(), json!(1)), ("name".to_owned(), json!(self.file.name))]);
        object.extend(self.judgement.json(&self.file.cut));
        object.extend(self.load.clone());
        if let Some(worst) = self.worst {
            object.insert("worst_phase [deg]".to_owned(), json!(worst.phase.to_degrees()));
            object.insert("phase_spread".to_owned(), json!(worst.spread));
        }
        if let Some(path) = &self.path {
            let limits: Vec<Value> =
                path.limits.iter().map(|(at, limit)| json!([at * 1e3, limit.map(|depth| depth * 1e3)])).collect();
            object.insert("worst_position [mm]".to_owned(), json!(path.worst * 1e3));
            object.insert(ALONG_PATH.to_owned(), json!(limits));
        }
        if let Some(probability) = self.probability {
            object.insert("p_stable".to_owned(), json!(probability.value));
        }
        if let Some(measured) = self.measured {
            object.insert("measured_limit [mm]".to_owned(), json!(measured.map(|limit| limit.depth * 1e3)));
            object.insert("measured_frequency [Hz]".to_owned(), json!(measured.map(|limit| limit.frequency)));
            object.insert("measured_difference".to_owned(), json!(self.difference()));
        }
        object
    }

    /// For a terminal: one value a line.
    pub fn text(&self) -> String {
        let mut text = self.file.title.clone();
        for (name, value) in self.json().iter().filter(|(name, _)| !matches!(name.as_str(), "schema" | "name")) {
            let value = match value {
                Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), significant),
                Value::String(text) => text.clone(),
                Value::Null => "none".to_owned(),
                Value::Array(intervals) if name == "stable_intervals [mm]" => {
                    let end =
                        |interval: &Value, side: usize| interval[side].as_f64().map_or_else(String::new, significant);
                    let interval = |interval: &Value| format!("{}–{}", end(interval, 0), end(interval, 1));
                    intervals.iter().map(interval).collect::<Vec<_>>().join(", ")
                }
                Value::Array(places) if name == ALONG_PATH => {
                    let _ = write!(text, "\n  {name}");
                    for place in places {
                        let at = place[0].as_f64().map_or_else(String::new, significant);
                        let limit = place[1].as_f64().map_or_else(|| "none".to_owned(), significant);
                        let _ = write!(text, "\n  {:28} {limit:>24}", format!("  at {at} mm"));
                    }
                    continue;
                }
                Value::Object(vibration) => {
                    for (name, value) in vibration {
                        let ends = |value: &Value| {
                            let ends = value.as_array()?.iter().filter_map(Value::as_f64).map(significant);
                            Some(ends.collect::<Vec<_>>().join("–"))
                        };
                        let word = || {
                            let word = value.as_str().map(str::to_owned);
                            word.or_else(|| ends(value)).unwrap_or_else(|| value.to_string())
                        };
                        let value = value.as_f64().map_or_else(word, significant);
                        let _ = write!(text, "\n  {name:28} {value:>24}");
                    }
                    continue;
                }
                Value::Array(broken) if name == "limits_broken" => {
                    let words: Vec<&str> = broken.iter().filter_map(Value::as_str).collect();
                    if words.is_empty() { "none".to_owned() } else { words.join(", ") }
                }
                // The lines are many; the strongest has a row of its own.
                Value::Array(lines) => format!("{} lines, with --json", lines.len()),
                Value::Bool(_) => value.to_string(),
            };
            let _ = write!(text, "\n  {name:28} {value:>24}");
        }
        text
    }
}
