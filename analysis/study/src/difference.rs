//! Two finished runs against each other, from the files that they left.
//!
//! Runs of one seed and one version in which the same machines, tools, operations, sources and
//! failures draw have common random numbers: replication r of the one is paired with replication r of
//! the other, and the interval is that of their differences. Other runs are independent samples.

mod runs;

pub use runs::{RunDifference, RunDifferenceError};

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use toolroom_location::{Located, Location};
use toolroom_scenario::Scenario;
use toolroom_statistics::{CONFIDENCE, Interval, paired, welch};

/// Values of a figure by replication, in the unit of files.
pub type Sample = BTreeMap<u32, f64>;

/// Figures of the shop in every replication, as `kpi.csv` has them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Replications {
    /// By policy and key of the figure, `lead_time [min]`.
    samples: BTreeMap<(String, String), Sample>,
}

/// Why `kpi.csv` cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DifferenceError {
    /// The file cannot be read as a table.
    #[error("{path} cannot be read: {source}")]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the csv crate said.
        source: csv::Error,
    },
    /// A column is missing.
    #[error("{path} has no column `{column}`")]
    NoColumn {
        /// The file.
        path: PathBuf,
        /// The column.
        column: &'static str,
    },
    /// A cell is not the number that it should be.
    #[error("{path}:{line}: `{text}` is no {column}")]
    NoNumber {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// The column.
        column: &'static str,
        /// What stands there.
        text: String,
    },
}

impl Located for DifferenceError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::NoNumber { path, line, .. } => {
                usize::try_from(*line).ok().map(|line| Location::line(path.display(), line))
            }
            Self::Unreadable { path, .. } | Self::NoColumn { path, .. } => Some(Location::of(path.display())),
        }
    }
}

impl Replications {
    /// Name of the file beside the other results.
    pub const FILE: &str = "kpi.csv";

    /// Reads the figures of the shop in the directory of a finished run; those of single machines are
    /// passed over. Figures in `currency` have no unit in their key.
    ///
    /// # Errors
    /// See [`DifferenceError`].
    pub fn read(directory: &Path, currency: &str) -> Result<Self, DifferenceError> {
        let path = directory.join(Self::FILE);
        let unreadable = |source| DifferenceError::Unreadable { path: path.clone(), source };
        let mut reader = csv::Reader::from_path(&path).map_err(unreadable)?;
        let header = reader.headers().map_err(unreadable)?.clone();
        let place = |column: &'static str| {
            let index = header.iter().position(|name| name == column);
            index.ok_or_else(|| DifferenceError::NoColumn { path: path.clone(), column })
        };
        let [policy, replication, machine] = [place("policy")?, place("replication")?, place("machine")?];
        let [kpi, unit, value] = [place("kpi")?, place("unit")?, place("value")?];
        let mut samples: BTreeMap<(String, String), Sample> = BTreeMap::new();
        for row in reader.records() {
            let row = row.map_err(unreadable)?;
            let no_number = |column, cell: usize| DifferenceError::NoNumber {
                path: path.clone(),
                line: row.position().map_or(0, csv::Position::line),
                column,
                text: row[cell].to_owned(),
            };
            if !row[machine].is_empty() {
                continue;
            }
            let number = row[replication].parse().map_err(|_| no_number("replication", replication))?;
            // What is not defined is empty.
            let figure = match &row[value] {
                "" => f64::NAN,
                text => text.parse().map_err(|_| no_number("value", value))?,
            };
            let key = match &row[unit] {
                unit if unit == "1" || unit == currency => row[kpi].to_owned(),
                unit => format!("{} [{unit}]", &row[kpi]),
            };
            samples.entry((row[policy].to_owned(), key)).or_default().insert(number, figure);
        }
        Ok(Self { samples })
    }

    /// Policies in the order of their names.
    pub fn policies(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self.samples.keys().map(|(policy, _)| policy.as_str()).collect();
        names.dedup();
        names
    }

    /// Policies and figures that both have, with their values.
    pub fn common<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = (&'a str, &'a str, &'a Sample, &'a Sample)> {
        self.samples
            .iter()
            .filter_map(|(key, one)| other.samples.get(key).map(|two| (key.0.as_str(), key.1.as_str(), one, two)))
    }
}

/// Why two runs cannot be paired, from their `run.json`; `None` where they drew the same random
/// numbers.
pub fn unpaired(value: &Value, two: &Value) -> Option<String> {
    if value["version"] != two["version"] {
        return Some(format!("versions {} and {} made them", value["version"], two["version"]));
    }
    if value["seed"] != two["seed"] {
        return Some(format!("their seeds are {} and {}", value["seed"], two["seed"]));
    }
    for (run, which) in [(value, "first"), (two, "second")] {
        if !run[STREAMS].is_object() {
            return Some(format!("run.json of the {which} does not say what draws its random numbers"));
        }
    }
    KINDS.iter().find_map(|kind| {
        let names = |run: &Value| -> Vec<String> {
            let list = run[STREAMS][kind].as_array().into_iter().flatten();
            list.map(|name| name.as_str().unwrap_or_default().to_owned()).collect()
        };
        let (value, two) = (names(value), names(two));
        if value == two {
            return None;
        }
        let only = |these: &[String], those: &[String]| these.iter().find(|name| !those.contains(name)).cloned();
        let (what, whose) = (&kind[..kind.len() - 1], "of the");
        Some(match (only(&value, &two), only(&two, &value)) {
            (Some(name), _) => format!("{what} `{name}` {whose} first is not in the second"),
            (None, Some(name)) => format!("{what} `{name}` {whose} second is not in the first"),
            (None, None) => format!("their {kind} differ in number or order"),
        })
    })
}

/// Difference `two − one` of a figure with its 95 % interval: of the paired replications that both
/// have, or of independent samples (Welch).
pub fn difference(one: &Sample, two: &Sample, pair: bool) -> Interval {
    if pair {
        let both = one.iter().filter_map(|(replication, value)| Some((*value, *two.get(replication)?)));
        let (one, two): (Vec<f64>, Vec<f64>) = both.unzip();
        paired(&two, &one, CONFIDENCE).difference
    } else {
        let values = |sample: &Sample| sample.values().copied().collect::<Vec<f64>>();
        welch(&values(two), &values(one), CONFIDENCE)
    }
}

/// Key in `run.json` of everything that draws random numbers.
const STREAMS: &str = "streams";

/// What there is under it.
const KINDS: [&str; 5] = ["machines", "tools", "operations", "sources", "failures"];

/// Everything that draws random numbers in a scenario, in the order by which it draws.
pub(crate) fn streams(scenario: &Scenario) -> Value {
    let operations = scenario
        .parts
        .iter()
        .flat_map(|part| part.operations.iter().map(|operation| format!("{}/{}", part.name, operation.name)));
    let list: [Vec<String>; 5] = [
        scenario.machines.iter().map(|machine| machine.name.clone()).collect(),
        scenario.tools.iter().map(|tool| tool.name.clone()).collect(),
        operations.collect(),
        scenario.arrivals.iter().map(|arrival| arrival.parts_named(&scenario.parts)).collect(),
        scenario.failures.iter().map(|failure| scenario.machines[failure.machine].name.clone()).collect(),
    ];
    KINDS.into_iter().map(str::to_owned).zip(list.map(Value::from)).collect::<serde_json::Map<_, _>>().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use serde_json::json;

    fn run(seed: u64, scenario: &Scenario) -> Value {
        json!({ "version": "1", "seed": seed, "streams": streams(scenario) })
    }

    #[test]
    fn runs_are_paired_where_seed_and_everything_that_draws_agree() {
        let scenario = fixture::scenario();
        assert_eq!(unpaired(&run(1, &scenario), &run(1, &scenario)), None);
        assert_eq!(unpaired(&run(1, &scenario), &run(2, &scenario)).as_deref(), Some("their seeds are 1 and 2"));
        let mut other = scenario.clone();
        other.machines[1].name = "L9".to_owned();
        let message = unpaired(&run(1, &scenario), &run(1, &other));
        assert_eq!(message.as_deref(), Some("machine `L2` of the first is not in the second"));
        let mut more = scenario.clone();
        more.arrivals.push(more.arrivals[0].clone());
        let message = unpaired(&run(1, &scenario), &run(1, &more));
        assert_eq!(message.as_deref(), Some("their sources differ in number or order"));
        let earlier = json!({ "version": "1", "seed": 1 });
        assert!(unpaired(&run(1, &scenario), &earlier).is_some_and(|message| message.contains("of the second")));
    }

    #[test]
    fn pairs_join_by_replication_and_lone_or_undefined_ones_stay_out() {
        let sample = |values: &[(u32, f64)]| values.iter().copied().collect::<Sample>();
        let one = sample(&[(0, 10.0), (1, 20.0), (2, 30.0), (3, f64::NAN), (4, 99.0)]);
        let two = sample(&[(2, 31.5), (1, 21.0), (0, 11.0), (3, 7.0)]);
        let pair = difference(&one, &two, true);
        assert_eq!(pair.count, 3);
        // 1, 1 and 1.5: mean 7/6, standard error 1/6, t(2) = 4.302653.
        assert!((pair.mean - 7.0 / 6.0).abs() < 1e-12 && (pair.half_width - 4.302_653 / 6.0).abs() < 1e-6);
        let apart = difference(&one, &two, false);
        assert!(apart.half_width > 20.0 * pair.half_width);
    }
}
