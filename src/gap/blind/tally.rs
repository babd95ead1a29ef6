//! Rates of right and wrong answers, with their bounds, against the gates.

use super::judged::{Judged, Mark};
use serde_json::{Value, json};
use std::fmt;
use toolroom_analysis::statistics::clopper_pearson;
use toolroom_truth::Set;

/// Promised score from which an effect has to be found.
const PROMISED: f64 = 5.0;

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
}

impl Tally {
    pub fn new(process: &'static str, judged: &[Judged]) -> Self {
        let own: Vec<&Judged> = judged.iter().filter(|judged| judged.case.process == process).collect();
        let count = |rows: &[&Judged], keep: &dyn Fn(&Judged) -> bool| rows.iter().filter(|row| keep(row)).count();
        let of = |keep: &dyn Fn(&Judged) -> bool| own.iter().copied().filter(|row| keep(row)).collect::<Vec<_>>();
        let marks = Set::ALL
            .into_iter()
            .map(|set| {
                let rows = of(&|row| row.case.set == set);
                (set, Mark::ALL.map(|mark| count(&rows, &|row| row.mark == mark)))
            })
            .filter(|(_, marks)| marks.iter().sum::<usize>() > 0)
            .collect();
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
        let rates = vec![
            rate("wrong, of all attributions", &named, &wrong, 0.03, true),
            rate("nothing hidden, an effect blamed", &nulls, &wrong, 0.02, true),
            rate("outside the catalogue, an effect blamed", &outside, &wrong, 0.05, true),
            rate("exact where a score of 5 was promised", &promised, &|row| row.mark == Mark::Exact, 0.95, false),
        ];
        Self { process, cases: own.len(), marks, rates }
    }

    fn json(&self) -> Value {
        let sets = self.marks.iter().map(|(set, marks)| {
            let marks: serde_json::Map<String, Value> =
                Mark::ALL.iter().zip(marks).map(|(mark, count)| (mark.name().to_owned(), json!(count))).collect();
            json!({ "set": set.name(), "marks": marks })
        });
        let rates = self.rates.iter().map(|rate| {
            json!({
                "name": rate.name, "count": rate.count, "of": rate.of, "ci95": rate.bounds(),
                "gate": rate.gate, "at_most": rate.at_most, "holds": rate.holds(),
            })
        });
        json!({
            "process": self.process, "cases": self.cases,
            "sets": sets.collect::<Vec<_>>(), "rates": rates.collect::<Vec<_>>(),
        })
    }
}

/// Tallies and every case.
pub fn json(tallies: &[Tally], judged: &[Judged]) -> Value {
    let tallies: Vec<Value> = tallies.iter().map(Tally::json).collect();
    let cases: Vec<Value> = judged.iter().map(Judged::json).collect();
    json!({ "schema": 1, "processes": tallies, "cases": cases })
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
        writeln!(f)
    }
}
