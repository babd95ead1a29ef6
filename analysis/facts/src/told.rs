//! What a fact is told from: the shifts in which alone it holds, and the effect of the catalogue that does the same.

use serde_json::{Value, json};

/// An effect of the catalogue that adds to every time what a log has too much.
#[derive(Clone, Debug, PartialEq)]
pub struct Delay {
    /// Its id.
    pub effect: &'static str,
    /// What it adds, s.
    pub size: f64,
    /// Standard error of that, s.
    pub standard_error: f64,
    /// Whether the log tells it from a constant; else both are one class.
    pub told: bool,
}

/// Where a fact holds, what else would show it, and whether a file can follow it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FactDetail {
    /// Shifts in which alone it was tested; all, if empty.
    pub shifts: Vec<String>,
    /// The effect that does the same; `None` where there is none, or where the log refuses it.
    pub delay: Option<Delay>,
    /// Whether the file has no constant that does the same: what several of them bring about together, or none.
    pub ownerless: bool,
}

impl FactDetail {
    /// What to say behind the fact.
    pub fn words(&self) -> String {
        match &self.delay {
            Some(own) if own.told => format!(
                "; missing effect: {} of {:.1} s ({:.1} … {:.1}), which no constant does",
                own.effect,
                own.size,
                own.size - NINETY * own.standard_error,
                own.size + NINETY * own.standard_error
            ),
            Some(own) => format!("; the data do not distinguish it from {} of {:.1} s", own.effect, own.size),
            None => String::new(),
        }
    }

    /// The keys that it adds to the entry of a fact called `name`.
    pub fn add_to(&self, entry: &mut Value, name: &str) {
        if !self.shifts.is_empty() {
            entry["shifts"] = json!(self.shifts);
        }
        if let Some(own) = &self.delay {
            entry["class"] = if own.told { json!([own.effect]) } else { json!([name, own.effect]) };
            entry["added"] = json!({ "value": own.size, "unit": "s", "se": own.standard_error });
        }
    }
}

/// Half the width of a 90 % interval in standard errors. Derivation: normal quantile.
const NINETY: f64 = 1.645;
