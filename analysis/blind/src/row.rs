//! One case with its answer, as a line of the table of all cases.

use crate::BlindError;
use serde::{Deserialize, Serialize};
use std::path::Path;
use toolroom_process::table::{csv_of, defined};

/// How right an answer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// Every hidden cause is named, itself or in the class of a named one, and nothing else.
    Exact,
    /// Some of the hidden causes are named, and nothing else.
    Partly,
    /// Something is named that was not hidden.
    Wrong,
    /// "Something is there, nothing of the catalogue."
    Unknown,
    /// "Something may be there, such data cannot show it."
    Masked,
    /// No gap was seen.
    NoGap,
}

impl Mark {
    /// Every mark, best first.
    pub const ALL: [Self; 6] = [Self::Exact, Self::Partly, Self::Wrong, Self::Unknown, Self::Masked, Self::NoGap];

    /// The mark in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::Partly => "partly",
            Self::Wrong => "wrong",
            Self::Unknown => "unknown",
            Self::Masked => "masked",
            Self::NoGap => "no gap",
        }
    }
}

/// What was hidden, what was answered. Numbers of several effects are joined by ` + `; what stands
/// beside a single one is empty elsewhere.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Which parts of the method took part.
    pub method: String,
    /// Process of the case.
    pub process: String,
    /// Name of the set.
    pub set: String,
    /// Seed of the case.
    pub seed: u64,
    /// Hidden causes with their strengths.
    pub hidden: String,
    /// Size of a single hidden effect as its generator has it, display unit.
    #[serde(serialize_with = "defined")]
    pub hidden_size: Option<f64>,
    /// Score that the design of the records promised for the hidden cause of its size; of several,
    /// the least. Nothing where nothing of the catalogue is hidden.
    #[serde(serialize_with = "defined")]
    pub promised_z: Option<f64>,
    /// How right the answer is.
    pub mark: Mark,
    /// Effects that were named.
    pub named: String,
    /// Effects that the data cannot tell from them.
    pub class: String,
    /// Where or when they act.
    pub shape: String,
    /// Size of a single named effect, in `unit`, with its 90 % interval.
    #[serde(serialize_with = "defined")]
    pub size: Option<f64>,
    /// Lower end of the interval of the size.
    #[serde(serialize_with = "defined")]
    pub size_low: Option<f64>,
    /// Upper end of the interval of the size.
    #[serde(serialize_with = "defined")]
    pub size_high: Option<f64>,
    /// Unit of the sizes.
    pub unit: String,
    /// Size that new edges ask for.
    #[serde(serialize_with = "defined")]
    pub size_on_new_edges: Option<f64>,
    /// Probabilities of the named effects.
    pub probability: String,
    /// Their scores.
    pub z: String,
    /// Closure as the diagnosis says, with its 90 % interval.
    #[serde(serialize_with = "defined")]
    pub closed: Option<f64>,
    /// Lower end of the interval of the closure.
    #[serde(serialize_with = "defined")]
    pub closed_low: Option<f64>,
    /// Upper end of the interval of the closure.
    #[serde(serialize_with = "defined")]
    pub closed_high: Option<f64>,
    /// The same measured on new edges.
    #[serde(serialize_with = "defined")]
    pub closed_on_new_edges: Option<f64>,
    /// On new edges, over the channels that the hidden effect touches: by what was named, and by the
    /// hidden effect, had it been known.
    #[serde(serialize_with = "defined")]
    pub closed_by_named: Option<f64>,
    /// By the hidden effect.
    #[serde(serialize_with = "defined")]
    pub closed_by_hidden: Option<f64>,
    /// Notes of the diagnosis.
    pub notes: String,
    /// Groups over their usual number.
    #[serde(default = "once")]
    pub times: usize,
    /// How far the equations of the shop are off.
    #[serde(default)]
    pub form: f64,
    /// Effects of the last model that was not named.
    #[serde(default)]
    pub not_named: String,
    /// Rules that stood against it, joined by a space.
    #[serde(default)]
    pub rules: String,
}

fn once() -> usize {
    1
}

impl Row {
    /// Whether `value` lies in an interval; `None` without one.
    fn within(value: Option<f64>, low: Option<f64>, high: Option<f64>) -> Option<bool> {
        Some(low? <= value? && value? <= high?)
    }

    /// Whether the interval of the closure holds what was found on new edges.
    pub fn closure_covered(&self) -> Option<bool> {
        Self::within(self.closed_on_new_edges, self.closed_low, self.closed_high)
    }

    /// Whether the interval of the size holds the size that new edges ask for.
    pub fn size_covered(&self) -> Option<bool> {
        Self::within(self.size_on_new_edges, self.size_low, self.size_high)
    }

    /// What would be named without `rule`, where that alone stood against it.
    pub fn without(&self, rule: &str) -> Option<Mark> {
        if self.rules != rule {
            return None;
        }
        let hidden: Vec<&str> = self.hidden.split(" + ").filter_map(|cause| cause.split(' ').next()).collect();
        let named: Vec<&str> = self.not_named.split(" + ").collect();
        let all_hidden = named.iter().all(|id| hidden.contains(id));
        Some(match (all_hidden, hidden.iter().all(|id| named.contains(id))) {
            (true, true) => Mark::Exact,
            (true, false) => Mark::Partly,
            (false, _) => Mark::Wrong,
        })
    }

    /// Whether one cause of the catalogue is hidden and nothing else.
    pub fn single(&self) -> bool {
        self.hidden_size.is_some()
    }
}

/// All rows as CSV.
pub(crate) fn csv(rows: &[Row]) -> String {
    csv_of(rows).expect("a row holds numbers and texts")
}

/// Rows of a finished run.
pub(crate) fn read(directory: &Path) -> Result<Vec<Row>, BlindError> {
    let path = directory.join("cases.csv");
    let failed = |source: csv::Error| BlindError::Unreadable { path: path.clone(), source };
    csv::Reader::from_path(&path).map_err(failed)?.deserialize().map(|row| row.map_err(failed)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_reads_back_the_same() {
        let text = "x, \"y\"".to_owned();
        let row = Row {
            method: "whole".to_owned(),
            process: "turning".to_owned(),
            set: "null, heavier scatter".to_owned(),
            seed: 100_017,
            hidden: String::new(),
            hidden_size: None,
            promised_z: Some(0.1 + 0.2),
            mark: Mark::NoGap,
            named: String::new(),
            class: String::new(),
            shape: text.clone(),
            size: Some(-1e-7),
            size_low: None,
            size_high: None,
            unit: String::new(),
            size_on_new_edges: None,
            probability: String::new(),
            z: String::new(),
            closed: None,
            closed_low: Some(0.25),
            closed_high: Some(0.75),
            closed_on_new_edges: Some(0.75),
            closed_by_named: None,
            closed_by_hidden: None,
            notes: text,
            times: 5,
            form: 0.02,
            not_named: "run_in + wear_force".to_owned(),
            rules: "closure".to_owned(),
        };
        let directory = tempfile::tempdir().expect("a directory");
        let table = csv(std::slice::from_ref(&row));
        std::fs::write(directory.path().join("cases.csv"), table).expect("a file");
        assert_eq!(read(directory.path()).ok(), Some(vec![row.clone()]));
        assert_eq!((row.without("closure"), row.without("size")), (Some(Mark::Wrong), None));
        let right = Row { hidden: "run_in x1 + wear_force x2".to_owned(), ..row.clone() };
        assert_eq!(right.without("closure"), Some(Mark::Exact));
        assert_eq!((row.closure_covered(), row.size_covered()), (Some(true), None));
    }
}
