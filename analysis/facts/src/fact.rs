//! What is said of a fact.

use crate::count::LEVEL;
use crate::told::FactDetail;
use serde_json::{Value, json};

/// Factor on a constant below which a rejected fact is no finding (1). Assumption: a planner does not move a
/// figure by less than a tenth.
const MATTERS: f64 = 1.1;

/// What was counted or timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Time on the failure clock between two breakdowns.
    TimeBetweenFailures,
    /// Weibull shape of those times: above 1 breakdowns come more regularly than by chance.
    FailureShape,
    /// Wall-clock time of a repair.
    TimeToRepair,
    /// Changing over.
    SetupTime,
    /// Changing an edge.
    ToolChangeTime,
    /// Loading and unloading of one operation.
    HandlingTime,
    /// Standard deviation of the logarithm of loading and unloading.
    HandlingScatter,
    /// Share of parts that are scrapped.
    Scrap,
    /// Time between two orders of a source.
    ArrivalInterval,
    /// Time in cut of an edge.
    EdgeLife,
    /// Wait of a job before a pool of machines.
    QueueWait,
    /// Natural frequencies of what vibrates around a cut.
    NaturalFrequency,
    /// Depth at which cuts become unstable: stiffness times damping over the coefficient of the force.
    StabilityLimit,
}

impl Quantity {
    /// Word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::TimeBetweenFailures => "time_between_failures",
            Self::FailureShape => "failure_shape",
            Self::TimeToRepair => "time_to_repair",
            Self::SetupTime => "setup_time",
            Self::ToolChangeTime => "tool_change_time",
            Self::HandlingTime => "handling_time",
            Self::HandlingScatter => "handling_scatter",
            Self::Scrap => "scrap",
            Self::ArrivalInterval => "arrival_interval",
            Self::EdgeLife => "edge_life",
            Self::QueueWait => "queue_wait",
            Self::NaturalFrequency => "natural_frequency",
            Self::StabilityLimit => "stability_limit",
        }
    }

    /// Words for people.
    pub fn words(self) -> &'static str {
        match self {
            Self::TimeBetweenFailures => "time between failures",
            Self::FailureShape => "shape of the times between failures",
            Self::TimeToRepair => "time to repair",
            Self::SetupTime => "setup time",
            Self::ToolChangeTime => "tool change time",
            Self::HandlingTime => "handling time",
            Self::HandlingScatter => "scatter of handling times",
            Self::Scrap => "share of scrap",
            Self::ArrivalInterval => "time between arrivals",
            Self::EdgeLife => "life of edges",
            Self::QueueWait => "wait",
            Self::NaturalFrequency => "natural frequency (dynamics drift)",
            Self::StabilityLimit => "depth of the stability limit (dynamics drift)",
        }
    }

    /// Whether it is a constant of a file. A wait follows from everything else and is none.
    pub fn is_constant(self) -> bool {
        match self {
            Self::TimeBetweenFailures
            | Self::FailureShape
            | Self::TimeToRepair
            | Self::SetupTime
            | Self::ToolChangeTime
            | Self::HandlingTime
            | Self::HandlingScatter
            | Self::Scrap
            | Self::ArrivalInterval
            | Self::EdgeLife
            | Self::NaturalFrequency
            | Self::StabilityLimit => true,
            Self::QueueWait => false,
        }
    }

    /// A value with its unit: durations in the unit (s, min or h) that people would use for `like`, shares in per cent,
    /// shapes as they are.
    pub fn with_unit(self, value: f64, like: f64) -> String {
        if !value.is_finite() {
            return "unknown".to_owned();
        }
        match self {
            Self::FailureShape => digits(value),
            Self::HandlingScatter | Self::Scrap => format!("{} %", digits(100.0 * value)),
            Self::NaturalFrequency => format!("{} Hz", digits(value)),
            Self::StabilityLimit => format!("{} mm", digits(1e3 * value)),
            Self::TimeBetweenFailures
            | Self::TimeToRepair
            | Self::SetupTime
            | Self::ToolChangeTime
            | Self::HandlingTime
            | Self::ArrivalInterval
            | Self::EdgeLife
            | Self::QueueWait => duration(value, like),
        }
    }
}

/// Three significant digits.
fn digits(value: f64) -> String {
    let places = if value == 0.0 { 0 } else { (2 - value.abs().log10().floor() as i32).clamp(0, 9) };
    format!("{value:.0$}", places as usize)
}

/// A duration of `seconds` in the unit that people would use for one `like` it.
fn duration(seconds: f64, like: f64) -> String {
    match like {
        like if like >= 7200.0 => format!("{} h", digits(seconds / 3600.0)),
        like if like >= 180.0 => format!("{} min", digits(seconds / 60.0)),
        _ => format!("{} s", digits(seconds)),
    }
}

/// A fact that was tested.
#[derive(Clone, Debug, PartialEq)]
pub struct Fact {
    /// What.
    pub quantity: Quantity,
    /// Where: a machine, a pool, a source.
    pub place: String,
    /// Whether that is a pool of several machines.
    pub pooled: bool,
    /// In which shifts alone, and what effect of the catalogue would show the same.
    pub told: FactDetail,
    /// Events, times or parts that were seen.
    pub count: u64,
    /// How many the file lets expect; of times as many as were seen.
    pub expected: f64,
    /// Probability of something as far from the file by chance.
    pub p: f64,
    /// The tests behind it, each with its own probability.
    pub tests: Vec<(&'static str, f64)>,
    /// What the file says, SI.
    pub model: f64,
    /// What was seen, SI; infinite where nothing happened.
    pub estimate: f64,
    /// Its 90 % interval, SI.
    pub ci90: [f64; 2],
    /// Least factors, downwards and upwards, that the fact alone would have shown at a level of 1 % with a power of
    /// 90 %: on the rate of what is counted, on the middle of what is timed.
    pub least_seen: [f64; 2],
}

impl Fact {
    /// Estimate over what the file says.
    pub fn factor(&self) -> f64 {
        self.estimate / self.model
    }

    /// Whether the fact contradicts its file at `level`, by as much as matters. Where the level agrees the
    /// scatter or the regularity must do so, which are tests of their own.
    pub fn is_rejected(&self, level: f64) -> bool {
        let far = self.is_far();
        let other = self.tests.iter().any(|(name, p)| !matches!(*name, "middle" | "level") && *p < level);
        self.p < level && (far || other)
    }

    /// Whether it lies more than what matters from its file.
    pub fn is_far(&self) -> bool {
        !(1.0 / MATTERS..=MATTERS).contains(&self.factor())
    }

    /// Whether it is the work of an effect, and of no constant of the file.
    pub fn is_cause(&self) -> bool {
        self.told.delay.as_ref().is_some_and(|own| own.told)
    }

    /// Where it holds: machines, and the shifts if those are not all.
    pub fn shown_place(&self) -> String {
        let shifts = &self.told.shifts;
        let shifts = if shifts.is_empty() { String::new() } else { format!(" in shift {}", shifts.join(", ")) };
        format!("{}{shifts}", self.place)
    }

    /// The fact in one sentence without a full stop.
    pub fn words(&self) -> String {
        let Self { quantity, count, .. } = self;
        let value = |value| quantity.with_unit(value, self.model);
        let recorded = if self.estimate.is_finite() {
            format!("{} recorded ({} … {})", value(self.estimate), value(self.ci90[0]), value(self.ci90[1]))
        } else {
            format!("none recorded (at least {})", value(self.ci90[0]))
        };
        let place = self.shown_place();
        format!(
            "{} of {place}: {recorded}, {} in the model; {count} seen, p {:.2e}{}",
            quantity.words(),
            value(self.model),
            self.p,
            self.told.words()
        )
    }

    /// The entry of `facts` in `diagnosis.json`; `rejected` by [`Fact::is_rejected`].
    pub fn json(&self, rejected: bool) -> Value {
        let number = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
        let mut entry = json!({
            "fact": self.quantity.name(), "where": self.place, "n": self.count, "expected": number(self.expected),
            "p": number(self.p),
            "tests": self.tests.iter().map(|(name, p)| ((*name).to_owned(), number(*p)))
                .collect::<serde_json::Map<_, _>>(),
            "estimate": self.quantity.with_unit(self.estimate, self.model),
            "model": self.quantity.with_unit(self.model, self.model),
            "ci90": self.ci90.map(|end| self.quantity.with_unit(end, self.model)),
            "factor": number(self.factor()), "factor_ci90": self.ci90.map(|end| number(end / self.model)),
            "least_seen": self.least_seen.map(number), "rejected": rejected,
        });
        self.told.add_to(&mut entry, self.quantity.name());
        entry
    }
}

/// A fact that contradicts its file.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Place in the list of facts.
    pub fact: usize,
    /// Whether it is a constant of the file; a wait is none, and has an unknown cause, and neither is what an effect does.
    pub constant: bool,
    /// What is said of it.
    pub words: String,
}

/// Share of the level of a quantity that goes to the places that hold several machines (1; assumption: a file gives one
/// law to a pool, and a machine of its own is the exception).
const POOLED: f64 = 0.75;

/// The levels at which facts are tested: [`LEVEL`] is shared by the quantities, and within one by its places
/// (weighted Bonferroni), so that a true file is contradicted in at most one log of a hundred.
fn levels(facts: &[Fact]) -> Vec<f64> {
    let first = |index: &usize| facts[..*index].iter().all(|other| other.quantity != facts[*index].quantity);
    let quantities = (0..facts.len()).filter(first).count();
    let level = |fact: &Fact| {
        let alike = || facts.iter().filter(|other| other.quantity == fact.quantity);
        let pooled = alike().filter(|other| other.pooled).count();
        let single = alike().count() - pooled;
        let share = match (pooled, single) {
            (0, single) => 1.0 / single as f64,
            (pooled, 0) => 1.0 / pooled as f64,
            (pooled, _) if fact.pooled => POOLED / pooled as f64,
            (_, single) => (1.0 - POOLED) / single as f64,
        };
        LEVEL * share / quantities as f64
    };
    facts.iter().map(level).collect()
}

/// The facts that contradict their file at the level that is theirs among all that were tested.
pub fn findings(facts: &[Fact]) -> Vec<Finding> {
    let levels = levels(facts);
    let rejected = facts.iter().enumerate().filter(|(index, fact)| fact.is_rejected(levels[*index]));
    let finding = |(index, fact): (usize, &Fact)| Finding {
        fact: index,
        constant: fact.quantity.is_constant() && !fact.is_cause(),
        words: fact.words(),
    };
    rejected.map(finding).collect()
}

/// Probability of each fact as if it were the only one that was tested: multiplied by its share of the level, at most 1.
pub fn adjusted(facts: &[Fact]) -> Vec<f64> {
    facts.iter().zip(levels(facts)).map(|(fact, level)| (fact.p * LEVEL / level).min(1.0)).collect()
}

/// The facts that contradict their file at their level, by less than matters.
pub fn slight(facts: &[Fact]) -> Vec<&Fact> {
    let below = |(fact, level): (&Fact, f64)| fact.p < level && !fact.is_rejected(level);
    facts.iter().zip(levels(facts)).filter(|(fact, level)| below((fact, *level))).map(|(fact, _)| fact).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fact(estimate: f64, p: f64) -> Fact {
        Fact {
            quantity: Quantity::TimeBetweenFailures,
            place: "L1".to_owned(),
            pooled: false,
            told: FactDetail::default(),
            count: 10,
            expected: 20.0,
            p,
            tests: vec![("level", p)],
            model: 8.0 * 3600.0,
            estimate: estimate * 3600.0,
            ci90: [9.4327 * 3600.0, 29.4909 * 3600.0],
            least_seen: [0.5, 1.6],
        }
    }

    #[test]
    fn a_fact_says_what_was_recorded_and_what_the_file_has() {
        let words = fact(16.0, 0.0158).words();
        assert_eq!(
            words,
            "time between failures of L1: 16.0 h recorded (9.43 h … 29.5 h), 8.00 h in the model; 10 seen, p 1.58e-2"
        );
        let entry = fact(f64::INFINITY, 1e-4).json(true);
        assert_eq!((&entry["factor"], &entry["estimate"]), (&Value::Null, &json!("unknown")));
    }

    #[test]
    fn what_is_sure_but_small_is_no_finding_and_the_level_is_shared() {
        assert!(findings(&[fact(8.5, 1e-9)]).is_empty());
        assert_eq!(slight(&[fact(8.5, 1e-9)]).len(), 1);
        assert!(slight(&[fact(16.0, 1e-9)]).is_empty() && slight(&[fact(8.5, 0.5)]).is_empty());
        assert_eq!(findings(&[fact(16.0, 0.004)]).len(), 1);
        assert!(findings(&[fact(16.0, 0.004), fact(8.0, 0.9), fact(8.0, 0.9)]).is_empty());
        let pool = Fact { pooled: true, ..fact(16.0, 0.004) };
        assert_eq!(findings(&[pool, fact(8.0, 0.9), fact(8.0, 0.9)]).len(), 1);
        let mut wide = fact(8.0, 1e-6);
        wide.tests.push(("scatter", 1e-7));
        assert_eq!(findings(&[wide]).len(), 1);
    }
}
