//! Does adapting or planning pay? On cost per part, against the best rival that does neither.
//!
//! A verdict about adaptivity is given between tuned rules only ([`crate::tune`]); without tuning the decision says how the rules
//! do as they are set. Fair rivals are the best constant speeds for path, life, rate and cost, Makarov's optimum speed
//! at a stated wear, and a speed schedule without feedback; a constant speed that was merely given
//! is a rival too, but beating it proves little. An oracle that knows the true wear is a bound, it
//! neither wins nor loses.
//!
//! Where no policy sets a speed, grinding cycles that follow the measured force and contours that are
//! planned section by section take the place of adaptive speed; fixed cycles, handbook regimes and the
//! best constant setting are their rivals.

use super::PolicyResult;
use crate::figure::{decimals, plain, signed};
use crate::kpi::Better;
use crate::study::Study;
use crate::tune::{TunedPolicy, Tuning};
use std::mem::discriminant;
use toolroom_process::unit::convert;
use toolroom_scenario::{ContourRule, GrindingRule, Knowledge, PolicyRule, Scenario, SpeedPart, SpeedRule, Work};
use toolroom_statistics::{CONFIDENCE, Interval, paired, student};

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
    /// Follows the true wear, or more.
    Oracle(Knowledge),
}

/// Part that a policy plays in a scenario.
pub fn role(policy: &PolicyRule, scenario: &Scenario) -> Role {
    let of_speed = match policy.knowledge() {
        Knowledge::Sensors => of_speed(&policy.speed),
        known @ (Knowledge::Wear | Knowledge::Edge) => Role::Oracle(known),
    };
    // Without a lathe a rule that works its speed out has no model to do so, and cuts as programmed.
    if of_speed != Role::Given && scenario.tools.iter().any(|tool| tool.process.takes_speed_commands()) {
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
        (_, None) => Role::Given,
    }
}

/// Part that a speed rule plays.
fn of_speed(speed: &SpeedRule) -> Role {
    match speed.entry().part {
        SpeedPart::Given => Role::Given,
        SpeedPart::Best(aim) => Role::BestConstant(aim),
        SpeedPart::Makarov(flank_wear) => Role::Makarov(flank_wear),
        SpeedPart::Schedule => Role::Schedule,
        SpeedPart::Adaptive => Role::Adaptive,
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
            Self::Oracle(Knowledge::Edge) => "oracle with the true wear and the factors of the edge".to_owned(),
            Self::Oracle(Knowledge::Wear | Knowledge::Sensors) => "oracle with the true wear".to_owned(),
        }
    }

    /// Whether it is what the decision is about.
    fn is_candidate(&self) -> bool {
        matches!(self, Self::Adaptive | Self::AdaptiveCycle | Self::Planned(_))
    }

    fn is_rival(&self) -> bool {
        !self.is_candidate() && !matches!(self, Self::Oracle(_))
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
    /// Confidence of that interval: that of one of all the rules that were tuned, where the best of them was picked.
    pub confidence: f64,
    /// In one line.
    pub line: String,
    /// What else has to be said: the other adaptive policies, the baselines that are missing.
    pub notes: Vec<String>,
}

impl Decision {
    pub(super) fn new(scenario: &Scenario, study: &Study, policies: &[PolicyResult]) -> Self {
        let tuning = study.tuning.as_deref();
        let objective = tuning.map_or("cost_per_part", |tuning| tuning.objective.as_str());
        let index = study.index(objective).unwrap_or(0);
        let kpi = &study.kpis[index];
        // Less is better for all that is reported below.
        let sign = if kpi.definition.better == Better::More { -1.0 } else { 1.0 };
        let eligible = |position: usize| {
            let name = policies[position].name.as_str();
            tuning.is_none_or(|tuning| tuning.of(name).is_some_and(TunedPolicy::is_tuned))
        };
        // Rules that tuning may give a policy for changing edges: one, or all that there are.
        let change = |position: usize| {
            let rule = &scenario.policies[policies[position].policy];
            (!rule.chooses_change()).then(|| discriminant(&rule.tool_change))
        };
        let best_of = |of: &dyn Fn(usize, &Role) -> bool| {
            let candidates = policies.iter().enumerate();
            candidates
                .filter(|(position, policy)| of(*position, &policy.role) && eligible(*position))
                .filter(|(_, policy)| policy.kpis[index].mean.is_finite())
                .min_by(|(_, a), (_, b)| (sign * a.kpis[index].mean).total_cmp(&(sign * b.kpis[index].mean)))
                .map(|(position, _)| position)
        };
        let adaptive = best_of(&|_, role| role.is_candidate());
        // Tuned rules are compared where they may change edges by the same rules, whose settings were tuned for all of them.
        let rival = best_of(&|position, role| {
            role.is_rival()
                && (tuning.is_none() || adaptive.is_none_or(|adaptive| change(adaptive) == change(position)))
        });
        let mut notes = fairness(policies);
        notes.extend(tuning.map_or_else(|| vec![NOT_TUNED.to_owned()], standing_as_given));
        let (Some(best), Some(other)) = (adaptive, rival) else {
            let there = |of: fn(&Role) -> bool| {
                policies.iter().enumerate().any(|(position, policy)| of(&policy.role) && eligible(position))
            };
            let line = if !there(Role::is_candidate) {
                best_of(&|_, role| role.is_rival())
                    .and_then(|best| leading(scenario, study, policies, (index, sign), best))
                    .unwrap_or_else(|| "no adaptive policy in this study: nothing to decide".to_owned())
            } else if !there(Role::is_rival) {
                "no constant or scheduled speed in this study: nothing to compare adaptive speed with".to_owned()
            } else if kpi.definition.id == "cost_per_part" {
                "no good part was made: cost per part is not defined".to_owned()
            } else {
                "no rival that changes edges by the same rule".to_owned()
            };
            let outcome = Outcome::Undecided;
            return Self { outcome, adaptive, rival, difference: None, confidence: CONFIDENCE, line, notes };
        };
        // Among several adaptive rules the best is picked: its interval is that of one of so many (Bonferroni).
        let picked_from =
            policies.iter().enumerate().filter(|(at, policy)| policy.role.is_candidate() && eligible(*at));
        let family = if tuning.is_some() { picked_from.count().max(1) } else { 1 };
        let confidence = 1.0 - (1.0 - CONFIDENCE) / family as f64;
        let against = |policy: usize| {
            let difference = paired(&study.samples(policy, index), &study.samples(other, index), confidence).difference;
            difference.scaled(kpi.definition.display_scale())
        };
        let difference = against(best);
        let outcome = judge(&difference.scaled(sign));
        let mean = |position: usize| kpi.definition.display_scale() * policies[position].kpis[index].mean;
        let digits = decimals(mean(other), difference.half_width);
        let unit = shown_unit(scenario, kpi.definition.display);
        let tuned_constant = tuning.is_some() && policies[other].role == Role::Given;
        let rival_role =
            if tuned_constant { "constant speed, tuned".to_owned() } else { policies[other].role.describe() };
        let line = format!(
            "{} on {}: {} {} against {} {}{unit} ({}), difference {}",
            verdict(outcome, policies[best].role.word(), tuning.is_some(), (&difference, study.replications)),
            kpi.definition.title.replace(" / ", " per "),
            policies[best].name,
            plain(mean(best), digits),
            policies[other].name,
            plain(mean(other), digits),
            rival_role,
            with_interval(&difference, confidence),
        );
        for (position, policy) in policies.iter().enumerate() {
            let difference = against(position);
            let listed = position != best && policy.role.is_candidate() && eligible(position);
            if listed && judge(&difference.scaled(sign)) == Outcome::Loses {
                let told = with_interval(&difference, confidence);
                notes.push(format!("{} loses to {}: {told}", policy.name, policies[other].name));
            }
        }
        let gain = |position: usize| sign * (mean(other) - mean(position));
        let is_certain = |position: usize| judge(&against(position).scaled(sign)) == Outcome::Wins;
        notes.extend(bounds(scenario, policies, &gain, &is_certain));
        Self { outcome, adaptive, rival, difference: Some(difference), confidence, line, notes }
    }

    /// Differences of the decision replication by replication, adaptive − rival, in the unit of `difference`; empty without one.
    pub fn pairs(&self, study: &Study) -> Vec<f64> {
        let (Some(adaptive), Some(rival), Some(_)) = (self.adaptive, self.rival, &self.difference) else {
            return Vec::new();
        };
        let objective = study.tuning.as_deref().map_or("cost_per_part", |tuning| tuning.objective.as_str());
        let Some(index) = study.index(objective) else { return Vec::new() };
        let scale = study.kpis[index].definition.display_scale();
        let [one, other] = [adaptive, rival].map(|policy| study.samples(policy, index));
        one.iter().zip(other).map(|(one, other)| scale * (one - other)).collect()
    }

    /// The difference with its interval of 95 %, whatever the decision was made by.
    pub fn plain_difference(&self) -> Option<Interval> {
        self.difference.map(|difference| {
            let freedom = difference.count as f64 - 1.0;
            let factor = student(CONFIDENCE, freedom) / student(self.confidence, freedom);
            Interval { half_width: difference.half_width * factor, ..difference }
        })
    }
}

/// The unit of a figure behind its number.
fn shown_unit(scenario: &Scenario, display: &str) -> String {
    match display {
        "currency" => format!(" {}", scenario.currency),
        "1" => String::new(),
        unit => format!(" {unit}"),
    }
}

/// The best of policies of which none is adaptive, as in milling, against the first; against the next best where it is the
/// first. `None` for a single policy.
fn leading(
    scenario: &Scenario,
    study: &Study,
    policies: &[PolicyResult],
    (index, sign): (usize, f64),
    best: usize,
) -> Option<String> {
    let definition = &study.kpis[index].definition;
    let mean = |position: usize| definition.display_scale() * policies[position].kpis[index].mean;
    let others = (0..policies.len()).filter(|&other| other != best && mean(other).is_finite());
    let next = others.min_by(|&a, &b| (sign * mean(a)).total_cmp(&(sign * mean(b))));
    let other = if best == 0 { next? } else { 0 };
    let difference = paired(&study.samples(best, index), &study.samples(other, index), CONFIDENCE).difference;
    let difference = difference.scaled(definition.display_scale());
    let digits = decimals(mean(other), difference.half_width);
    let resolved = match judge(&difference.scaled(sign)) {
        Outcome::NoDifference => match needed(&difference, study.replications) {
            Some(replications) => format!("; not resolved (needs about {replications} replications)"),
            None => "; not resolved".to_owned(),
        },
        Outcome::Wins | Outcome::Loses | Outcome::Undecided => String::new(),
    };
    Some(format!(
        "no policy is adaptive. Best on {}: {} {} against {} {}{}, difference {}{resolved}",
        definition.title.replace(" / ", " per "),
        policies[best].name,
        plain(mean(best), digits),
        policies[other].name,
        plain(mean(other), digits),
        shown_unit(scenario, definition.display),
        with_interval(&difference, CONFIDENCE),
    ))
}

/// What an untuned comparison does not say.
const NOT_TUNED: &str = "settings are those of the file: whether adapting pays is decided between tuned rules (--tune)";

/// The outcome in words.
fn verdict(outcome: Outcome, word: &str, tuned: bool, (difference, replications): (&Interval, u32)) -> String {
    match (outcome, tuned) {
        (Outcome::Wins, true) => format!("{word} pays"),
        (Outcome::Loses, true) => format!("{word} loses"),
        (Outcome::Wins, false) => format!("{word} wins as set"),
        (Outcome::Loses, false) => format!("{word} loses as set"),
        (Outcome::NoDifference, _) => match needed(difference, replications) {
            Some(replications) => format!("not resolved (needs about {replications} replications)"),
            None => "not resolved".to_owned(),
        },
        (Outcome::Undecided, _) => "undecided (one replication has no interval)".to_owned(),
    }
}

/// Replications, as `--replications` counts them, after which the interval of so many would exclude zero, two digits; `None` where
/// the difference is nothing but noise, and beyond a hundred thousand. An interval over draws of parameters counts the draws,
/// each of several replications.
fn needed(difference: &Interval, replications: u32) -> Option<u64> {
    let ratio = difference.half_width / difference.mean;
    let count = f64::from(replications) * ratio * ratio;
    if !(count.is_finite() && count < 1e5) {
        return None;
    }
    let unit = 10_f64.powf((count.log10().floor() - 1.0).max(0.0));
    Some(((count / unit).ceil() * unit) as u64)
}

/// Policies that are no rivals because they were not tuned.
fn standing_as_given(tuning: &Tuning) -> Vec<String> {
    let given = tuning.policies.iter().filter_map(|policy| Some((&policy.name, policy.given.as_ref()?)));
    given.map(|(name, reason)| format!("{name} stands as given and is no rival: {reason}")).collect()
}

/// What the rules that know more gain over the rival, and the share of it that the same rule reaches with its sensors. A gain that
/// is not told from chance bounds nothing: shares of it would be any number.
fn bounds(
    scenario: &Scenario,
    policies: &[PolicyResult],
    gain: &dyn Fn(usize) -> f64,
    is_certain: &dyn Fn(usize) -> bool,
) -> Vec<String> {
    let rule = |position: usize| &scenario.policies[policies[position].policy];
    let law = |position: usize| {
        let speed = rule(position).speed;
        let law = if speed == SpeedRule::Oracle { SpeedRule::MinimumWear } else { speed };
        discriminant(&law)
    };
    let oracles = (0..policies.len()).filter(|&position| matches!(policies[position].role, Role::Oracle(_)));
    let told = oracles.filter_map(|oracle| {
        let real =
            (0..policies.len()).find(|&real| policies[real].role == Role::Adaptive && law(real) == law(oracle))?;
        let (most, reached) = (gain(oracle), gain(real));
        let share = 100.0 * reached / most;
        (most > 0.0 && share.is_finite() && is_certain(oracle)).then(|| {
            let reached = match share {
                share if share <= 0.0 => "nothing".to_owned(),
                share if share >= 100.0 => "all".to_owned(),
                share => format!("{} %", plain(share, 0)),
            };
            format!(
                "{} bounds {}: it gains {} over the rival, of which {reached} is reached",
                policies[oracle].name,
                policies[real].name,
                plain(most, decimals(most, f64::NAN)),
            )
        })
    });
    told.collect()
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

fn with_interval(interval: &Interval, confidence: f64) -> String {
    let digits = decimals(interval.mean, interval.half_width);
    let mean = signed(interval.mean, digits);
    if interval.half_width.is_finite() {
        let per_cent = plain(100.0 * confidence, usize::from(confidence != CONFIDENCE));
        format!("{mean} ({per_cent} % CI {} … {})", signed(interval.low(), digits), signed(interval.high(), digits))
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
        ("oracle", |role| matches!(role, Role::Oracle(_))),
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
