//! Rates of right and wrong answers, with their bounds, against the gates.

use super::judged::{Judged, Mark};
use super::shrunk::Shrunk;
use serde_json::{Value, json};
use std::fmt;
use toolroom_analysis::statistics::clopper_pearson;
use toolroom_truth::Set;

/// Promised score from which an effect has to be found.
const PROMISED: f64 = 5.0;

/// Share of the oracle's closure that the gate asks for.
const OF_ORACLE: f64 = 0.9;

/// So many of so many, with a bound that may not be crossed.
pub struct Rate {
    pub name: &'static str,
    pub count: usize,
    pub of: usize,
    /// The gate: at most, or at least.
    pub gate: f64,
    pub at_most: bool,
}

impl Rate {
    fn value(&self) -> f64 {
        self.count as f64 / self.of as f64
    }

    fn bounds(&self) -> [f64; 2] {
        clopper_pearson(self.count, self.of, 0.95)
    }

    fn holds(&self) -> bool {
        self.of == 0 || if self.at_most { self.value() <= self.gate } else { self.value() >= self.gate }
    }
}

/// All answers of a process.
pub struct Tally {
    pub process: &'static str,
    pub cases: usize,
    /// Answers by set.
    pub marks: Vec<(Set, [usize; 6])>,
    pub rates: Vec<Rate>,
    /// Closure on new edges by what was named, as a share of that by what was hidden; NaN where
    /// nothing was named.
    pub of_oracle: f64,
}

impl Tally {
    pub fn new(process: &'static str, judged: &[Judged]) -> Self {
        let own: Vec<&Judged> = judged.iter().filter(|judged| judged.case.process == process).collect();
        let count = |rows: &[&Judged], keep: &dyn Fn(&Judged) -> bool| rows.iter().filter(|row| keep(row)).count();
        let of = |keep: &dyn Fn(&Judged) -> bool| own.iter().copied().filter(|row| keep(row)).collect::<Vec<_>>();
        let marks = marks(&own);
        let named = of(&|row| !row.named.is_empty() && row.promised.is_some());
        let nulls = of(&|row| row.case.hidden.is_empty());
        let outside = of(&|row| row.case.set == Set::Outside);
        let single = |row: &Judged| row.case.hidden.len() == 1 && row.promised.is_some();
        let promised = of(&|row| single(row) && row.promised.is_some_and(|z| z >= PROMISED));
        let wrong = |row: &Judged| row.mark == Mark::Wrong;
        let rate = |name, rows: &[&Judged], keep: &dyn Fn(&Judged) -> bool, gate, at_most| Rate {
            name,
            count: count(rows, keep),
            of: rows.len(),
            gate,
            at_most,
        };
        let closures = of(&|row| row.shrunk.is_some());
        let sum = |value: &dyn Fn(&Shrunk) -> f64| {
            closures.iter().filter_map(|row| row.shrunk.as_ref()).map(value).sum::<f64>()
        };
        let of_oracle = sum(&|shrunk| shrunk.attributed) / sum(&|shrunk| shrunk.oracle);
        let missed = of(&|row| single(row) && matches!(row.mark, Mark::Unknown | Mark::Masked | Mark::NoGap));
        let covered = |row: &Judged| row.shrunk.as_ref().is_some_and(Shrunk::covered);
        let rates = vec![
            rate("wrong, of all attributions", &named, &wrong, 0.03, true),
            rate("nothing hidden, an effect blamed", &nulls, &wrong, 0.02, true),
            rate("outside the catalogue, an effect blamed", &outside, &wrong, 0.05, true),
            rate("exact where a score of 5 was promised", &promised, &|row| row.mark == Mark::Exact, 0.95, false),
            rate(
                "missed although a score of 5 was promised",
                &missed,
                &|row| row.promised.is_some_and(|z| z >= PROMISED),
                0.0,
                true,
            ),
            rate("90 % interval holds the closure on new edges", &closures, &covered, 0.80, false),
        ];
        Self { process, cases: own.len(), marks, rates, of_oracle }
    }

    fn json(&self) -> Value {
        let rates = self.rates.iter().map(|rate| {
            json!({
                "name": rate.name, "count": rate.count, "of": rate.of, "ci95": rate.bounds(),
                "gate": rate.gate, "at_most": rate.at_most, "holds": rate.holds(),
            })
        });
        json!({
            "process": self.process, "cases": self.cases,
            "closure_of_oracle": self.of_oracle.is_finite().then_some(self.of_oracle),
            "sets": sets(&self.marks), "rates": rates.collect::<Vec<_>>(),
        })
    }
}

/// Answers of the method with a part left out.
pub struct Ablation {
    pub name: &'static str,
    pub process: &'static str,
    pub marks: Vec<(Set, [usize; 6])>,
}

/// Answers by set.
fn marks(rows: &[&Judged]) -> Vec<(Set, [usize; 6])> {
    let count = |set: Set, mark: Mark| rows.iter().filter(|row| row.case.set == set && row.mark == mark).count();
    let sets = Set::ALL.into_iter().map(|set| (set, Mark::ALL.map(|mark| count(set, mark))));
    sets.filter(|(_, marks)| marks.iter().sum::<usize>() > 0).collect()
}

impl Ablation {
    /// One for each process.
    pub fn of_processes<'a>(name: &'static str, judged: impl IntoIterator<Item = &'a Judged>) -> Vec<Self> {
        let judged: Vec<&Judged> = judged.into_iter().collect();
        let of = |process: &'static str| {
            let own: Vec<&Judged> = judged.iter().copied().filter(|judged| judged.case.process == process).collect();
            Self { name, process, marks: marks(&own) }
        };
        let processes = toolroom_truth::GENERATORS.iter().map(|generator| of(generator.process));
        processes.filter(|ablation| !ablation.marks.is_empty()).collect()
    }
}

impl fmt::Display for Ablation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} · {}", self.process, self.name)?;
        for (set, marks) in &self.marks {
            let answers = Mark::ALL.iter().zip(marks).filter(|(_, count)| **count > 0);
            let answers: Vec<String> = answers.map(|(mark, count)| format!("{count} {}", mark.name())).collect();
            write!(f, "\n  {:24} {}", set.name(), answers.join(", "))?;
        }
        Ok(())
    }
}

/// Tallies, ablations and every case.
pub fn json(tallies: &[Tally], ablations: &[Ablation], judged: &[Judged]) -> Value {
    let tallies: Vec<Value> = tallies.iter().map(Tally::json).collect();
    let cases: Vec<Value> = judged.iter().map(Judged::json).collect();
    let ablation = |ablation: &Ablation| json!({ "process": ablation.process, "method": ablation.name, "sets": sets(&ablation.marks) });
    let ablations: Vec<Value> = ablations.iter().map(ablation).collect();
    json!({ "schema": 1, "processes": tallies, "ablations": ablations, "cases": cases })
}

fn sets(marks: &[(Set, [usize; 6])]) -> Vec<Value> {
    let one = |(set, marks): &(Set, [usize; 6])| {
        let marks: serde_json::Map<String, Value> =
            Mark::ALL.iter().zip(marks).map(|(mark, count)| (mark.name().to_owned(), json!(count))).collect();
        json!({ "set": set.name(), "marks": marks })
    };
    marks.iter().map(one).collect()
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} · {} cases", self.process, self.cases)?;
        write!(f, "{:24}", "")?;
        Mark::ALL.iter().try_for_each(|mark| write!(f, "{:>9}", mark.name()))?;
        for (set, marks) in &self.marks {
            write!(f, "\n{:24}", set.name())?;
            marks.iter().try_for_each(|count| write!(f, "{count:>9}"))?;
        }
        for rate in self.rates.iter().filter(|rate| rate.of > 0) {
            let [low, high] = rate.bounds().map(|bound| 100.0 * bound);
            let sign = if rate.at_most { "≤" } else { "≥" };
            let verdict = if rate.holds() { "" } else { "   NOT KEPT" };
            write!(
                f,
                "\n{:44} {:>3} of {:<3} {:5.1} % [{low:.1}, {high:.1}]",
                rate.name,
                rate.count,
                rate.of,
                100.0 * rate.value()
            )?;
            write!(f, "  gate {sign} {:.0} %{verdict}", 100.0 * rate.gate)?;
        }
        if self.of_oracle.is_finite() {
            let verdict = if self.of_oracle >= OF_ORACLE { "" } else { "   NOT KEPT" };
            write!(f, "\nclosure on new edges, of what the hidden effect itself closes: {:.2}", self.of_oracle)?;
            write!(f, "  gate ≥ {OF_ORACLE}{verdict}")?;
        }
        writeln!(f)
    }
}
