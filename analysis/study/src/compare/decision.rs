//! Does adapting or planning pay? On cost per part, against the best rival that does neither.
//!
//! Fair rivals are the best constant speeds for path, life, rate and cost, Makarov's optimum speed
//! at a stated wear, and a speed schedule without feedback; a constant speed that was merely given
//! is a rival too, but beating it proves little. An oracle that knows the true wear is a bound, it
//! neither wins nor loses.
//!
//! Where no policy sets a speed, grinding cycles that follow the measured force and contours that are
//! planned section by section take the place of adaptive speed; fixed cycles, handbook regimes and the
//! best constant setting are their rivals.

use super::PolicyResult;
use crate::figure::{decimals, plain, signed};
use crate::study::Study;
use toolroom_process::unit::convert;
use toolroom_scenario::{ContourRule, GrindingRule, PolicyRule, Scenario, SpeedChoice, SpeedRule, Work};
use toolroom_statistics::{CONFIDENCE, Interval, paired};

/// Part of a policy in the decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Role {
    /// A speed programmed or given by hand.
    Given,
    /// A constant speed that is best for something.
    BestConstant(&'static str),
    /// Constant speed by Makarov's law at this flank wear, m.
    Makarov(f64),
    /// Speed against path, without feedback.
    Schedule,
    /// Follows what it measures.
    Adaptive,
    /// A grinding cycle designed once, for this dulling.
    FixedCycle(f64),
    /// A grinding cycle that follows the measured force.
    AdaptiveCycle,
    /// A contour at a handbook regime.
    Handbook,
    /// A contour planned for something.
    Planned(&'static str),
    /// Follows the true wear.
    Oracle,
}

/// Part that a policy plays in a scenario.
pub fn role(policy: &PolicyRule, scenario: &Scenario) -> Role {
    let of_speed = of_speed(&policy.speed);
    if of_speed != Role::Given {
        return of_speed;
    }
    let work = || scenario.parts.iter().flat_map(|part| &part.operations).map(|operation| &operation.work);
    let contour = work().find_map(|work| if let Work::Contour(work) = work { Some(work.rule) } else { None });
    let cycles = work().any(|work| matches!(work, Work::Cycle(_)));
    match (policy.grinding, contour.map(|rule| policy.contour.unwrap_or(rule))) {
        (GrindingRule::Fixed { dulling }, None) if cycles => Role::FixedCycle(dulling),
        (GrindingRule::ForceAdaptive { .. } | GrindingRule::TimeConstantAdaptive { .. }, _) if cycles => {
            Role::AdaptiveCycle
        }
        (_, Some(ContourRule::HandbookOneFeed | ContourRule::HandbookPerSection)) => Role::Handbook,
        (_, Some(ContourRule::BestConstant)) => Role::BestConstant("cost"),
        (_, Some(ContourRule::Time)) => Role::Planned("time"),
        (_, Some(ContourRule::Cost)) => Role::Planned("cost"),
        (_, None) => of_speed,
    }
}

/// Part that a speed rule plays.
fn of_speed(speed: &SpeedRule) -> Role {
    match speed {
        SpeedRule::Programmed | SpeedRule::Constant(SpeedChoice::Given(_)) => Role::Given,
        SpeedRule::Constant(SpeedChoice::BestPath) => Role::BestConstant("path"),
        SpeedRule::Constant(SpeedChoice::BestLife) => Role::BestConstant("life"),
        SpeedRule::Constant(SpeedChoice::BestRate) => Role::BestConstant("rate"),
        SpeedRule::Constant(SpeedChoice::BestCost) => Role::BestConstant("cost"),
        SpeedRule::Constant(SpeedChoice::Makarov(wear)) => Role::Makarov(*wear),
        SpeedRule::Schedule => Role::Schedule,
        SpeedRule::MinimumWear { .. } | SpeedRule::SetIncrement { .. } | SpeedRule::Productivity { .. } => {
            Role::Adaptive
        }
        SpeedRule::Oracle => Role::Oracle,
    }
}

impl Role {
    /// In words.
    pub fn describe(&self) -> String {
        match self {
            Self::Given => "given speed".to_owned(),
            Self::BestConstant(aim) => format!("best constant speed for {aim}"),
            Self::Makarov(wear) => {
                format!("Makarov speed at {:.2} mm of wear", convert(*wear, "m", "mm"))
            }
            Self::Schedule => "schedule without feedback".to_owned(),
            Self::Adaptive => "adaptive".to_owned(),
            Self::FixedCycle(dulling) => format!("one cycle, designed for {dulling:.2} times a dressed wheel"),
            Self::AdaptiveCycle => "cycle that follows the force".to_owned(),
            Self::Handbook => "handbook regime".to_owned(),
            Self::Planned(aim) => format!("contour planned for {aim}"),
            Self::Oracle => "oracle with the true wear".to_owned(),
        }
    }

    /// Whether it is what the decision is about.
    fn is_candidate(&self) -> bool {
        matches!(self, Self::Adaptive | Self::AdaptiveCycle | Self::Planned(_))
    }

    fn is_rival(&self) -> bool {
        !self.is_candidate() && *self != Self::Oracle
    }

    /// What wins or loses.
    fn word(&self) -> &'static str {
        if matches!(self, Self::Planned(_)) { "planning" } else { "adaptive" }
    }
}

/// How adaptive speed does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// Cheaper than every rival.
    Wins,
    /// Dearer than the best rival.
    Loses,
    /// The interval of the difference contains zero.
    NoDifference,
    /// No adaptive policy, no rival, or too few replications for an interval.
    Undecided,
}

impl Outcome {
    /// Name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Wins => "wins",
            Self::Loses => "loses",
            Self::NoDifference => "no_difference",
            Self::Undecided => "undecided",
        }
    }
}

/// The decision.
#[derive(Clone, Debug, PartialEq)]
pub struct Decision {
    /// How the best adaptive policy does.
    pub outcome: Outcome,
    /// The adaptive policy of least cost, by position.
    pub adaptive: Option<usize>,
    /// The rival of least cost, by position.
    pub rival: Option<usize>,
    /// Paired difference of cost per part, adaptive − rival.
    pub difference: Option<Interval>,
    /// In one line.
    pub line: String,
    /// What else has to be said: the other adaptive policies, the baselines that are missing.
    pub notes: Vec<String>,
}

impl Decision {
    pub(super) fn new(scenario: &Scenario, study: &Study, policies: &[PolicyResult]) -> Self {
        let cost = study.index("cost_per_part").unwrap_or(0);
        let cheapest = |of: fn(&Role) -> bool| {
            let candidates = policies.iter().enumerate().filter(|(_, policy)| of(&policy.role));
            candidates
                .filter(|(_, policy)| policy.kpis[cost].mean.is_finite())
                .min_by(|(_, a), (_, b)| a.kpis[cost].mean.total_cmp(&b.kpis[cost].mean))
                .map(|(position, _)| position)
        };
        let adaptive = cheapest(Role::is_candidate);
        let rival = cheapest(Role::is_rival);
        let mut notes = fairness(policies);
        let (Some(best), Some(other)) = (adaptive, rival) else {
            let line = if !policies.iter().any(|policy| policy.role.is_candidate()) {
                "no adaptive policy in this study: nothing to decide".to_owned()
            } else if !policies.iter().any(|policy| policy.role.is_rival()) {
                "no constant or scheduled speed in this study: nothing to compare adaptive speed with".to_owned()
            } else {
                "no good part was made: cost per part is not defined".to_owned()
            };
            return Self { outcome: Outcome::Undecided, adaptive, rival, difference: None, line, notes };
        };
        let against =
            |policy: usize| paired(&study.values(policy, cost), &study.values(other, cost), CONFIDENCE).difference;
        let difference = against(best);
        let outcome = judge(&difference);
        let verdict = match outcome {
            Outcome::Wins => format!("{} wins", policies[best].role.word()),
            Outcome::Loses => format!("{} loses", policies[best].role.word()),
            Outcome::NoDifference => "no difference".to_owned(),
            Outcome::Undecided => "undecided (one replication has no interval)".to_owned(),
        };
        let digits = decimals(policies[other].kpis[cost].mean, difference.half_width);
        let line = format!(
            "{verdict} on cost per part: {} {} against {} {} {} ({}), difference {}",
            policies[best].name,
            plain(policies[best].kpis[cost].mean, digits),
            policies[other].name,
            plain(policies[other].kpis[cost].mean, digits),
            scenario.currency,
            policies[other].role.describe(),
            with_interval(&difference),
        );
        for (position, policy) in policies.iter().enumerate() {
            let difference = against(position);
            if position != best && policy.role.is_candidate() && judge(&difference) == Outcome::Loses {
                notes.push(format!(
                    "{} loses to {}: {}",
                    policy.name,
                    policies[other].name,
                    with_interval(&difference)
                ));
            }
        }
        Self { outcome, adaptive, rival, difference: Some(difference), line, notes }
    }
}

fn judge(difference: &Interval) -> Outcome {
    if difference.half_width.is_nan() {
        Outcome::Undecided
    } else if !difference.excludes(0.0) {
        Outcome::NoDifference
    } else if difference.mean < 0.0 {
        Outcome::Wins
    } else {
        Outcome::Loses
    }
}

fn with_interval(interval: &Interval) -> String {
    let digits = decimals(interval.mean, interval.half_width);
    let mean = signed(interval.mean, digits);
    if interval.half_width.is_finite() {
        format!("{mean} (95 % CI {} … {})", signed(interval.low(), digits), signed(interval.high(), digits))
    } else {
        mean
    }
}

/// Which fair baselines stand beside the adaptive policies, and which do not.
fn fairness(policies: &[PolicyResult]) -> Vec<String> {
    if policies.iter().all(|policy| policy.role != Role::Adaptive) {
        return Vec::new();
    }
    type Wanted = (&'static str, fn(&Role) -> bool);
    let wanted: [Wanted; 4] = [
        ("best constant speed for cost", |role| matches!(role, Role::BestConstant("cost"))),
        ("Makarov speed", |role| matches!(role, Role::Makarov(_))),
        ("schedule without feedback", |role| *role == Role::Schedule),
        ("oracle", |role| *role == Role::Oracle),
    ];
    let found = |(_, is): &&Wanted| policies.iter().any(|policy| is(&policy.role));
    let list = |present: bool| -> Vec<&str> {
        wanted.iter().filter(|entry| found(entry) == present).map(|(name, _)| *name).collect()
    };
    let mut notes = Vec::new();
    if !list(true).is_empty() {
        notes.push(format!("fair baselines in this study: {}", list(true).join(", ")));
    }
    if !list(false).is_empty() {
        notes.push(format!("fair baselines missing: {}", list(false).join(", ")));
    }
    notes
}
