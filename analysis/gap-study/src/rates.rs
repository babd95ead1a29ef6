//! Rates of a recovery study, with exact bounds.

use crate::recovery::{HiddenEntry, RecoveredLog};
use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_gap::GapVerdict;
use toolroom_statistics::clopper_pearson;

/// Share of what the truth closes of a key figure that has to be closed (1). Source: the gate of the closure of key figures.
const OF_TRUTH: f64 = 0.8;
/// Least share of a figure that the truth has to close by itself for it to count (1). Assumption: where the truth does not
/// close a gap, chance made that gap.
const CLOSES: f64 = 0.5;

/// So many of so many.
#[derive(Clone, Debug, PartialEq)]
pub struct RecoveryRate {
    /// What is counted.
    pub name: String,
    /// Cases for which it holds.
    pub count: usize,
    /// Cases that count.
    pub of: usize,
}

impl RecoveryRate {
    fn from_name(name: impl Into<String>, answers: impl IntoIterator<Item = bool>) -> Self {
        let (count, of) = answers.into_iter().fold((0, 0), |(count, of), yes| (count + usize::from(yes), of + 1));
        Self { name: name.into(), count, of }
    }

    /// Exact 95 % bounds (Clopper and Pearson).
    pub fn bounds(&self) -> [f64; 2] {
        clopper_pearson(self.count, self.of, 0.95)
    }

    /// For programs.
    pub fn json(&self) -> Value {
        json!({ "name": self.name, "count": self.count, "of": self.of, "ci95": self.bounds() })
    }
}

/// Every rate that the logs tell; those without a case are left out.
pub fn rates(entries: &[HiddenEntry], logs: &[RecoveredLog]) -> Vec<RecoveryRate> {
    let verdict = |wanted: GapVerdict| logs.iter().map(move |log| log.verdict == wanted);
    let mut rates = vec![
        RecoveryRate::from_name("no_gap", verdict(GapVerdict::NoGap)),
        RecoveryRate::from_name("an effect named wrongly", logs.iter().map(RecoveredLog::wrong)),
        RecoveryRate::from_name("a constant named by a fact", logs.iter().map(|log| !log.facts.is_empty())),
    ];
    for other in GapVerdict::ALL.into_iter().filter(|own| *own != GapVerdict::NoGap) {
        rates.push(RecoveryRate::from_name(other.name(), verdict(other)));
    }
    for (i, entry) in entries.iter().enumerate() {
        let place = if entry.scope.is_everywhere() { String::new() } else { format!(" ({})", entry.scope.words()) };
        let words = format!("{}{place}", entry.id);
        let own = || logs.iter().map(move |log| log.hidden[i]);
        rates.push(RecoveryRate::from_name(format!("{words} found"), own().map(|own| own.found)));
        rates.push(RecoveryRate::from_name(format!("{words}: scope right"), own().filter_map(|own| own.scope)));
        rates.push(RecoveryRate::from_name(
            format!("{words}: interval holds the size"),
            own().filter_map(|own| own.covered),
        ));
    }
    if entries.len() > 1 {
        let all = logs.iter().map(|log| log.hidden.iter().all(|own| own.found));
        rates.push(RecoveryRate::from_name("everything hidden found", all));
    }
    let fresh = || logs.iter().filter_map(|log| log.fresh);
    rates.push(RecoveryRate::from_name(
        "no_gap on fresh records by the applied model",
        fresh().map(|own| own.0 == GapVerdict::NoGap),
    ));
    rates.push(RecoveryRate::from_name("an effect named on fresh records", fresh().map(|own| own.1 > 0)));
    let mut names: Vec<&String> = logs.iter().flat_map(|log| &log.figures).map(|own| &own.name).collect();
    names.sort();
    names.dedup();
    for name in names {
        let own = || logs.iter().flat_map(|log| &log.figures).filter(move |own| own.name == *name);
        let told = own().filter(|own| own.truth >= CLOSES).map(|own| own.applied >= OF_TRUTH * own.truth);
        rates.push(RecoveryRate::from_name(format!("{name} closes 0.8 of what the truth closes"), told));
        rates.push(RecoveryRate::from_name(format!("gap of {name} grows"), own().map(|own| own.grew)));
    }
    rates.retain(|rate| rate.of > 0);
    rates
}

/// The rates as people read them.
pub fn rates_table(entries: &[HiddenEntry], logs: &[RecoveredLog]) -> String {
    let mut text = format!("{} logs; hidden: ", logs.len());
    let words = |entry: &HiddenEntry| {
        let place = if entry.scope.is_everywhere() { String::new() } else { format!(" ({})", entry.scope.words()) };
        let unit = if entry.unit == "1" { String::new() } else { format!(" {}", entry.unit) };
        format!("{} {:.4}{unit}{place}", entry.id, entry.size)
    };
    let all: Vec<String> = entries.iter().map(words).collect();
    text += &if all.is_empty() { "nothing".to_owned() } else { all.join("; ") };
    for rate in rates(entries, logs) {
        let [low, high] = rate.bounds().map(|bound| 100.0 * bound);
        let _ =
            write!(text, "\n{:66} {:3} of {:3}   exact 95 %: {low:.1} to {high:.1} %", rate.name, rate.count, rate.of);
    }
    for log in logs.iter().filter(|log| log.wrong()) {
        let wrong = log.named.iter().filter(|own| !own.right);
        let words = |own: &crate::recovery::GivenName| {
            format!(
                "{}{} {:.3} (probability {:.2})",
                own.class[0],
                if own.shape.is_empty() { String::new() } else { format!(" ({})", own.shape) },
                own.size,
                own.probability
            )
        };
        let list: Vec<String> = wrong.map(words).collect();
        let _ = write!(text, "\nseed {}: named wrongly {}", log.seed, list.join(", "));
    }
    text
}
