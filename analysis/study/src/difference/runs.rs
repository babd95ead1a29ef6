//! The key figures that differ between two finished runs.

use super::{DifferenceError, Replications, difference, unpaired};
use crate::results::{FinishedRun, FinishedRunError};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use toolroom_form::significant;
use toolroom_location::{Located, Location};
use toolroom_statistics::{CONFIDENCE, Interval, t_interval};

/// Why two runs cannot be compared.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunDifferenceError {
    /// Not the directory of a finished run.
    #[error(transparent)]
    Run(#[from] FinishedRunError),
    /// The table of its figures.
    #[error(transparent)]
    Figures(#[from] DifferenceError),
}

impl Located for RunDifferenceError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Run(error) => error.location(),
            Self::Figures(error) => error.location(),
        }
    }
}

/// A figure that is not the same in both runs.
#[derive(Clone, Debug)]
struct Row {
    policy: String,
    kpi: String,
    one: f64,
    two: f64,
    difference: Interval,
}

/// Share of a key figure below which a difference is the rounding of sums that were added in another order:
/// 10⁴ times the spacing of double precision (assumption: no figure is a sum of cancelling terms).
const ROUNDING: f64 = 1e-12;

/// Whether a difference of figures of this size is only rounding, in its mean and in every replication.
fn is_rounding(difference: &Interval, size: f64) -> bool {
    difference.mean.abs() <= ROUNDING * size && difference.half_width <= ROUNDING * size
}

/// What differs between two finished runs.
#[derive(Clone, Debug)]
pub struct RunDifference {
    directories: [PathBuf; 2],
    identical: bool,
    unpaired_because: Option<String>,
    currencies: [String; 2],
    rows: Vec<Row>,
    /// Policies that only one of the runs has.
    alone: [Vec<String>; 2],
}

impl RunDifference {
    /// Reads two directories of results and compares them.
    ///
    /// # Errors
    /// See [`RunDifferenceError`].
    pub fn read(directories: [&Path; 2]) -> Result<Self, RunDifferenceError> {
        let [one, two] = [FinishedRun::read(directories[0])?, FinishedRun::read(directories[1])?];
        let identical = one.summary["digest"] == two.summary["digest"];
        let currencies = [&one, &two].map(|run| run.summary["currency"].as_str().unwrap_or_default().to_owned());
        // Money of two currencies is not compared: its figures keep their units and find no partner.
        let money = if currencies[0] == currencies[1] { currencies[0].as_str() } else { "" };
        let [left, right] = [Replications::read(directories[0], money)?, Replications::read(directories[1], money)?];
        let unpaired_because = unpaired(&one.run, &two.run);
        let mut rows = Vec::new();
        for (policy, kpi, a, b) in left.common(&right) {
            let [one, two] =
                [a, b].map(|sample| t_interval(&Vec::from_iter(sample.values().copied()), CONFIDENCE).mean);
            if one.is_finite() && two.is_finite() && one != two {
                let difference = difference(a, b, unpaired_because.is_none());
                if is_rounding(&difference, one.abs().max(two.abs())) {
                    continue;
                }
                rows.push(Row { policy: policy.to_owned(), kpi: kpi.to_owned(), one, two, difference });
            }
        }
        let only = |these: &Replications, those: &Replications| -> Vec<String> {
            let others = those.policies();
            these.policies().into_iter().filter(|name| !others.contains(name)).map(str::to_owned).collect()
        };
        let alone = [only(&left, &right), only(&right, &left)];
        let directories = directories.map(Path::to_owned);
        Ok(Self { directories, identical, unpaired_because, currencies, rows, alone })
    }

    /// The differences for programs.
    pub fn json(&self) -> Value {
        let row = |row: &Row| {
            let Interval { mean, count, .. } = row.difference;
            let ends = [row.difference.low(), row.difference.high()];
            let difference = json!({ "mean": mean, "ci95": ends, "n": count });
            json!({ "policy": row.policy, "kpi": row.kpi, "one": row.one, "two": row.two, "difference": difference })
        };
        json!({
            "schema": 1,
            "identical": self.identical,
            "paired": self.unpaired_because.is_none(),
            "unpaired_because": self.unpaired_because,
            "currencies": self.currencies,
            "differences": self.rows.iter().map(row).collect::<Vec<_>>(),
            "policies_only_in_one": self.alone[0],
            "policies_only_in_two": self.alone[1],
        })
    }

    /// The differences for a terminal.
    pub fn text(&self) -> String {
        let mut text = String::new();
        if !self.rows.is_empty() {
            let _ = match &self.unpaired_because {
                None => writeln!(text, "paired by replication on common random numbers, 95 % t intervals"),
                Some(because) => writeln!(text, "not paired, as {because}; 95 % Welch intervals"),
            };
        }
        let mut last: &str = "";
        for row in &self.rows {
            if row.policy != last {
                let _ = writeln!(text, "{}", row.policy);
            }
            last = &row.policy;
            let change = 100.0 * (row.two - row.one) / row.one.abs();
            let change = if change.is_finite() { format!("{change:+.1} %") } else { String::new() };
            let within = row.difference.half_width.is_finite() && !row.difference.excludes(0.0);
            let note = if within { "   within the interval" } else { "" };
            let _ = writeln!(
                text,
                "  {:34} {:>12} → {:>12} {change:>10}   {}{note}",
                row.kpi,
                significant(row.one),
                significant(row.two),
                shown(&row.difference),
            );
        }
        for (names, dir) in self.alone.iter().zip(&self.directories) {
            if !names.is_empty() {
                let _ = writeln!(text, "only in {}: {}", dir.display(), names.join(", "));
            }
        }
        let [currency, other] = &self.currencies;
        if currency != other {
            let _ = writeln!(text, "money is not compared: {currency} and {other}");
        }
        if text.is_empty() {
            text = if self.identical { "identical runs" } else { "no key figure differs" }.to_owned();
        }
        text.trim_end().to_owned()
    }
}

/// `-0.295 ± 0.057`: two digits of the half-width; the mean alone where there is none.
fn shown(difference: &Interval) -> String {
    let half_width = difference.half_width;
    if !half_width.is_finite() {
        return significant(difference.mean);
    }
    let lead = half_width.log10().floor();
    if !(-8.0..4.0).contains(&lead) {
        return format!("{} ± {}", significant(difference.mean), significant(half_width));
    }
    let digits = (1.0 - lead).max(0.0) as usize;
    format!("{:+.digits$} ± {half_width:.digits$}", difference.mean)
}

#[cfg(test)]
mod tests {
    use super::is_rounding;
    use toolroom_statistics::Interval;

    #[test]
    fn the_rounding_of_sums_is_no_difference() {
        let interval = |mean, half_width| Interval { mean, half_width, count: 20 };
        assert!(is_rounding(&interval(2.2e-17, 8.5e-17), 0.8));
        // Replications that differ are shown, though their mean does not.
        assert!(!is_rounding(&interval(2.2e-17, 1e-6), 0.8));
        assert!(!is_rounding(&interval(-1e-6, 0.0), 0.8));
    }
}
