//! A single point of a chart: where it is, as people write it, and its verdict.

use super::cut::Cut;
use super::{Judgement, LobesFile};
use serde_json::{Map, Value, json};
use std::fmt::Write;
use toolroom_chatter::ChatterError;
use toolroom_form::significant;
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
}

impl<'a> PointVerdict<'a> {
    /// Judges a place, SI, on both axes of the chart of `file`.
    ///
    /// # Errors
    /// [`ChatterError`] where the model refuses a value, or finds no result.
    pub fn new(file: &'a LobesFile, (speed, depth): (f64, f64)) -> Result<Self, ChatterError> {
        Ok(Self { file, judgement: file.cut.judge(speed, depth, &file.chart)? })
    }

    /// For programs.
    pub fn json(&self) -> Map<String, Value> {
        let mut object = Map::from_iter([("schema".to_owned(), json!(1)), ("name".to_owned(), json!(self.file.name))]);
        object.extend(self.judgement.json(&self.file.cut));
        object
    }

    /// For a terminal: one value a line.
    pub fn text(&self) -> String {
        let mut text = self.file.title.clone();
        for (name, value) in &self.judgement.json(&self.file.cut) {
            let value = match value {
                Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), significant),
                Value::String(text) => text.clone(),
                Value::Null => "none".to_owned(),
                // The lines are many; the strongest has a row of its own.
                Value::Array(lines) => format!("{} lines, with --json", lines.len()),
                Value::Bool(_) | Value::Object(_) => value.to_string(),
            };
            let _ = write!(text, "\n  {name:28} {value:>24}");
        }
        text
    }
}
