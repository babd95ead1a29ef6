//! The comparison at several values of one key.

use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_form::significant;

/// Points of a sweep; more are a slip of the step.
const MOST: usize = 1000;

/// A key of a scenario and the values that it takes, each with its unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sweep {
    /// The key, `machine.L.tool_change_time`.
    pub key: String,
    /// Its values as text, such as `1.5 min`.
    pub values: Vec<String>,
}

/// Why there is no sweep.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum SweepError {
    /// Ends and step are in different units.
    #[error("\"{low}\", \"{high}\" and \"{step}\" are not in one unit")]
    Units {
        /// The first value.
        low: String,
        /// The last value.
        high: String,
        /// The step.
        step: String,
    },
    /// No value, or too many.
    #[error("from {low} to {high} by {step} there are no points, or more than {MOST}")]
    Points {
        /// The first value.
        low: String,
        /// The last value.
        high: String,
        /// The step.
        step: String,
    },
    /// A text without a number.
    #[error("`{text}` does not start with a number")]
    NoNumber {
        /// The text.
        text: String,
    },
}

impl SweepError {
    /// The way out.
    pub fn fix(&self) -> &'static str {
        match self {
            Self::Units { .. } => "write all three in the same unit",
            Self::Points { .. } => "LO is at most HI and STEP is positive",
            Self::NoNumber { .. } => "such as \"1 min\"",
        }
    }
}

impl Sweep {
    /// `1 min`, `5 min`, `1 min` to every value between, in the unit as written.
    ///
    /// # Errors
    /// See [`SweepError`].
    pub fn new(key: &str, low: &str, high: &str, step: &str) -> Result<Self, SweepError> {
        let texts = || (low.to_owned(), high.to_owned(), step.to_owned());
        let [(start, unit), (end, end_unit), (width, step_unit)] = [split(low)?, split(high)?, split(step)?];
        if end_unit != unit || step_unit != unit {
            let (low, high, step) = texts();
            return Err(SweepError::Units { low, high, step });
        }
        let count = ((end - start) / width + 1e-9).floor();
        if !(width > 0.0 && count >= 0.0 && count < MOST as f64) {
            let (low, high, step) = texts();
            return Err(SweepError::Points { low, high, step });
        }
        let value = |i: usize| format!("{} {unit}", significant(start + width * i as f64)).trim_end().to_owned();
        Ok(Self { key: key.to_owned(), values: (0..=count as usize).map(value).collect() })
    }

    /// The results for programs: the [`summary`](crate::summary::summary) at each of the first values.
    pub fn json(&self, summaries: &[Value]) -> Value {
        let point = |(value, summary): (&String, &Value)| json!({ "value": value, "summary": summary });
        let points: Vec<Value> = self.values.iter().zip(summaries).map(point).collect();
        json!({ "schema": 1, "key": self.key, "points": points })
    }

    /// The results for a terminal.
    pub fn text(&self, summaries: &[Value]) -> String {
        let mut text = String::new();
        for (value, summary) in self.values.iter().zip(summaries) {
            let _ = writeln!(text, "{} = {value}", self.key);
            for policy in summary["policies"].as_array().into_iter().flatten() {
                let figure = |name: &str| figure(&policy["kpi"], name);
                let _ = writeln!(
                    text,
                    "  {:34} parts/shift {:>16}   cost/part {:>16}   edges/100 parts {:>16}",
                    policy["name"].as_str().unwrap_or_default(),
                    figure("parts_per_shift"),
                    figure("cost_per_part"),
                    figure("edges_per_100_parts"),
                );
            }
        }
        text.trim_end().to_owned()
    }
}

/// Mean and half-width; figures may carry their unit in the key.
fn figure(figures: &Value, name: &str) -> String {
    let found = figures.as_object().into_iter().flatten().find(|(key, _)| key.split(' ').next() == Some(name));
    let Some((_, value)) = found else { return "–".to_owned() };
    match (value["mean"].as_f64(), value["ci95"][1].as_f64()) {
        (Some(mean), Some(high)) => format!("{mean:.2} ± {:.2}", high - mean),
        (Some(mean), None) => format!("{mean:.2}"),
        _ => "–".to_owned(),
    }
}

/// A number and its unit.
fn split(text: &str) -> Result<(f64, &str), SweepError> {
    let text = text.trim();
    let end = text.find(|c: char| c.is_alphabetic() || c == '%' || c.is_whitespace()).unwrap_or(text.len());
    let number = text[..end].parse().map_err(|_| SweepError::NoNumber { text: text.to_owned() })?;
    Ok((number, text[end..].trim()))
}

#[cfg(test)]
mod tests {
    use super::Sweep;

    #[test]
    fn a_sweep_has_its_ends_and_its_unit() {
        let list = |low, high, step| Sweep::new("key", low, high, step).ok().map(|sweep| sweep.values);
        assert_eq!(list("1 min", "2 min", "0.5 min"), Some(vec!["1 min".into(), "1.5 min".into(), "2 min".into()]));
        assert_eq!(list("0.1", "0.3", "0.1"), Some(vec!["0.1".into(), "0.2".into(), "0.3".into()]));
        assert_eq!(list("3 min", "1 min", "1 min"), None);
        assert_eq!(list("1 min", "3 s", "1 min"), None);
        assert_eq!(list("1 min", "3 min", "0 min"), None);
        assert_eq!(list("x", "3 min", "1 min"), None);
    }
}
