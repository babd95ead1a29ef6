//! Rates of right and wrong answers, with their bounds, against the gates.

use crate::method::{PARTS, WHOLE};
use crate::row::{Mark, Row};
use serde_json::{Value, json};
use std::fmt;
use toolroom_statistics::clopper_pearson;
use toolroom_truth::{GENERATORS, Set};

/// Promised score from which an effect has to be found.
const PROMISED: f64 = 5.0;

/// Share of the oracle's closure that the gate asks for.
const OF_ORACLE: f64 = 0.9;

/// So many of so many, with a bound that may not be crossed.
pub struct Rate {
    /// What is counted.
    pub name: &'static str,
    /// Cases for which it holds.
    pub count: usize,
    /// Cases that count.
    pub of: usize,
    /// The gate: at most, or at least.
    pub gate: f64,
    /// Whether the gate is an upper bound.
    pub at_most: bool,
}

impl Rate {
    fn from_name(name: &'static str, answers: &[bool], gate: f64, at_most: bool) -> Self {
        Self { name, count: answers.iter().filter(|yes| **yes).count(), of: answers.len(), gate, at_most }
    }

    /// The share.
    pub fn value(&self) -> f64 {
        self.count as f64 / self.of as f64
    }

    /// Exact 95 % bounds (Clopper and Pearson).
    pub fn bounds(&self) -> [f64; 2] {
        clopper_pearson(self.count, self.of, 0.95)
    }

    /// The sign before the gate.
    pub fn sign(&self) -> &'static str {
        if self.at_most { "≤" } else { "≥" }
    }

    /// Whether the gate is kept; always without cases.
    pub fn holds(&self) -> bool {
        self.of == 0 || if self.at_most { self.value() <= self.gate } else { self.value() >= self.gate }
    }
}

/// Closure on new edges over the channels that the hidden effect touches, mean of all cases where an
/// effect was hidden and one named.
pub struct Closed {
    /// Cases that count.
    pub cases: usize,
    /// By what was named.
    pub named: f64,
    /// By the hidden effect, had it been known.
    pub hidden: f64,
}

impl Closed {
    fn of(rows: &[&Row]) -> Option<Self> {
        let both: Vec<(f64, f64)> =
            rows.iter().filter_map(|row| Some((row.closed_by_named?, row.closed_by_hidden?))).collect();
        let count = both.len() as f64;
        let mean = |value: &dyn Fn(&(f64, f64)) -> f64| both.iter().map(value).sum::<f64>() / count;
        (!both.is_empty()).then(|| Self {
            cases: both.len(),
            named: mean(&|both| both.0),
            hidden: mean(&|both| both.1),
        })
    }

    /// Share of the oracle's closure.
    pub fn share(&self) -> f64 {
        self.named / self.hidden
    }

    /// Whether the gate is kept.
    pub fn holds(&self) -> bool {
        self.share() >= OF_ORACLE
    }

    /// Least share of the oracle's closure.
    pub const GATE: f64 = OF_ORACLE;
}

/// Answers by set.
pub type Marks = Vec<(Set, [usize; 6])>;

/// All answers of a process.
pub struct Tally {
    /// The process.
    pub process: &'static str,
    /// How many cases there are.
    pub cases: usize,
    /// Answers by set.
    pub marks: Marks,
    /// Rates against their gates.
    pub rates: Vec<Rate>,
    /// Closure on new edges; `None` without a case that was named.
    pub closed: Option<Closed>,
    /// What is wrong, or missed though it was promised: hidden cause, set, answer.
    pub failures: Vec<[String; 3]>,
}

impl Tally {
    /// One for each process that has cases.
    pub fn of_processes(rows: &[Row]) -> Vec<Self> {
        let tally_of = |process: &'static str| {
            let of_process: Vec<&Row> =
                rows.iter().filter(|row| row.process == process && row.method == WHOLE).collect();
            (!of_process.is_empty()).then(|| Self::of(process, &of_process))
        };
        GENERATORS.iter().filter_map(|generator| tally_of(generator.process)).collect()
    }

    fn of(process: &'static str, rows: &[&Row]) -> Self {
        let tests_of = |keep: &dyn Fn(&Row) -> bool, test: &dyn Fn(&Row) -> bool| -> Vec<bool> {
            rows.iter().filter(|row| keep(row)).map(|row| test(row)).collect()
        };
        let wrong = |row: &Row| row.mark == Mark::Wrong;
        let missed = |row: &Row| row.single() && matches!(row.mark, Mark::Unknown | Mark::Masked | Mark::NoGap);
        let promised = |row: &Row| row.promised_z.is_some_and(|z| z >= PROMISED);
        let covered =
            |test: &dyn Fn(&Row) -> Option<bool>| rows.iter().filter_map(|row| test(row)).collect::<Vec<bool>>();
        let named = tests_of(&|row| !row.named.is_empty() && row.promised_z.is_some(), &wrong);
        let nulls = tests_of(&|row| row.hidden.is_empty(), &wrong);
        let outside = tests_of(&|row| row.set == Set::Outside.name(), &wrong);
        let exact = tests_of(&|row| row.single() && promised(row), &|row| row.mark == Mark::Exact);
        let missed_though = tests_of(&missed, &promised);
        let rates = vec![
            Rate::from_name("wrong, of all attributions", &named, 0.03, true),
            Rate::from_name("nothing hidden, an effect blamed", &nulls, 0.02, true),
            Rate::from_name("outside the catalogue, an effect blamed", &outside, 0.05, true),
            Rate::from_name("exact where it was promised", &exact, 0.95, false),
            Rate::from_name("missed although it was promised", &missed_though, 0.0, true),
            Rate::from_name(
                "90 % interval holds the closure on new edges",
                &covered(&Row::closure_covered),
                0.80,
                false,
            ),
            Rate::from_name("90 % interval holds the size of new edges", &covered(&Row::size_covered), 0.80, false),
        ];
        let failed = rows.iter().filter(|row| wrong(row) || (missed(row) && promised(row)));
        let failure = |row: &&Row| {
            let answer = if wrong(row) { format!("named {}", row.named) } else { format!("“{}”", row.mark.name()) };
            [row.hidden.clone(), row.set.clone(), answer]
        };
        let failures = failed.map(failure).collect();
        Self { process, cases: rows.len(), marks: marks(rows), rates, closed: Closed::of(rows), failures }
    }

    fn json(&self) -> Value {
        let rates = self.rates.iter().map(|rate| {
            json!({
                "name": rate.name, "count": rate.count, "of": rate.of, "ci95": rate.bounds(),
                "gate": rate.gate, "at_most": rate.at_most, "holds": rate.holds(),
            })
        });
        let closed = self.closed.as_ref().map(|closed| {
            json!({
                "cases": closed.cases, "by_named": closed.named, "by_hidden": closed.hidden, "share": closed.share(),
                "gate": Closed::GATE, "holds": closed.holds(),
            })
        });
        json!({
            "process": self.process, "cases": self.cases, "closure_on_new_edges": closed,
            "sets": sets(&self.marks), "rates": rates.collect::<Vec<_>>(),
        })
    }
}

/// Answers of the method with a part left out, or of the whole method on the same cases.
pub struct Ablation {
    /// What is left of the method.
    pub method: &'static str,
    /// The process.
    pub process: &'static str,
    /// Answers by set.
    pub marks: Marks,
}

impl Ablation {
    /// One for each process and method; none where nothing was left out.
    pub fn of_processes(rows: &[Row]) -> Vec<Self> {
        let mut list = Vec::new();
        for process in GENERATORS.iter().map(|generator| generator.process) {
            let of_process = |row: &&Row| row.process == process;
            let reduced: Vec<&Row> = rows.iter().filter(of_process).filter(|row| row.method != WHOLE).collect();
            let tried = |row: &&Row| reduced.iter().any(|reduced| reduced.seed == row.seed);
            for method in std::iter::once(WHOLE).chain(PARTS.map(|(name, _)| name)) {
                let cases: Vec<&Row> =
                    rows.iter().filter(of_process).filter(|row| row.method == method).filter(tried).collect();
                list.push(Self { method, process, marks: marks(&cases) });
            }
        }
        list.retain(|ablation| !ablation.marks.is_empty());
        list
    }

    /// Cases of the sets that `keep` takes, and those of them with one of `answers`.
    pub fn count(&self, keep: &[Set], answers: &[Mark]) -> [usize; 2] {
        let counted = self.marks.iter().filter(|(set, _)| keep.contains(set));
        let answered = |mark: &(Mark, &usize)| answers.contains(&mark.0);
        counted.fold([0, 0], |[all, some], (_, counts)| {
            let matching: usize = Mark::ALL.into_iter().zip(counts).filter(answered).map(|(_, count)| count).sum();
            [all + counts.iter().sum::<usize>(), some + matching]
        })
    }
}

fn marks(rows: &[&Row]) -> Marks {
    let count = |set: Set, mark: Mark| rows.iter().filter(|row| row.set == set.name() && row.mark == mark).count();
    let sets = Set::ALL.into_iter().map(|set| (set, Mark::ALL.map(|mark| count(set, mark))));
    sets.filter(|(_, marks)| marks.iter().sum::<usize>() > 0).collect()
}

impl fmt::Display for Ablation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} · {}", self.process, self.method)?;
        for (set, marks) in &self.marks {
            let answers = Mark::ALL.iter().zip(marks).filter(|(_, count)| **count > 0);
            let answers: Vec<String> = answers.map(|(mark, count)| format!("{count} {}", mark.name())).collect();
            write!(f, "\n  {:24} {}", set.name(), answers.join(", "))?;
        }
        Ok(())
    }
}

/// Tallies and ablations.
pub(crate) fn json(tallies: &[Tally], ablations: &[Ablation]) -> Value {
    let tallies: Vec<Value> = tallies.iter().map(Tally::json).collect();
    let ablation = |ablation: &Ablation| json!({ "process": ablation.process, "method": ablation.method, "sets": sets(&ablation.marks) });
    json!({ "schema": 1, "processes": tallies, "ablations": ablations.iter().map(ablation).collect::<Vec<_>>() })
}

fn sets(marks: &Marks) -> Vec<Value> {
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
            let (value, verdict) = (100.0 * rate.value(), if rate.holds() { "" } else { "   NOT KEPT" });
            write!(f, "\n{:44} {:>3} of {:<3} {value:5.1} % [{low:.1}, {high:.1}]", rate.name, rate.count, rate.of)?;
            write!(f, "  gate {} {:.0} %{verdict}", rate.sign(), 100.0 * rate.gate)?;
        }
        if let Some(closed) = &self.closed {
            let [named, hidden] = [closed.named, closed.hidden].map(|share| 100.0 * share);
            let verdict = if closed.holds() { "" } else { "   NOT KEPT" };
            write!(f, "\nclosed on new edges, mean of {} cases: {named:.1} % by what was named, ", closed.cases)?;
            write!(f, "{hidden:.1} % by the hidden effect: {:.2}  gate ≥ {}{verdict}", closed.share(), Closed::GATE)?;
        }
        writeln!(f)
    }
}
