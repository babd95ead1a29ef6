//! What the log of a shop counts, against what its file says.
//!
//! Handling, edge changes and programmed times are channels with a calibration of their own, and are no facts here, but
//! for the scatter of handling.

use super::constants::UNEXPLAINED_QUEUE;
use super::job_facts::{Jobs, WITHOUT_JOBS};
use super::queue::{QueueScore, occasion, pools_of, queues};
use super::{Diagnosis, EffectId, Fitness, GapVerdict, Part};
use std::collections::BTreeMap;
use toolroom_facts::agreement::{agreeing, same_middle, same_rate};
use toolroom_facts::failures::{History, shape, time_between};
use toolroom_facts::spread::spread;
use toolroom_facts::survival::{Life, lives};
use toolroom_facts::times::{share_above, times};
use toolroom_facts::waits::{Waits, waits};
use toolroom_facts::{Fact, Quantity, adjusted, findings, slight};
use toolroom_nominal::Declarations;
use toolroom_nominal::shop::{Breakdowns, SHORT_STOP, Shop, Station, Visit, Visits, visits};
use toolroom_records::Records;
use toolroom_scenario::{Distribution, FailureClock, FailureMode, ShopEffect};

/// Prior standard deviation of the logarithm of the life of edges on one machine: that of the wear rate and that of a
/// machine, as in the calibration of the channel `edge_life`.
const LIFE: f64 = 0.18;

/// Tests the facts of a log, adds them to what is said of it, and takes back what they contradict: a constant of
/// the file that the log rejects, or a queue that nothing explains, leaves no `no_gap`. `jobs` are those that came, where
/// the data hold them; `stated` is what the file says beside the plan.
pub fn add_facts(
    shop: &Shop,
    records: &Records,
    jobs: Option<&Jobs>,
    stated: &Declarations,
    diagnosis: &mut Diagnosis,
    seed: u64,
) {
    let seen = visits(records);
    let scores = queues(shop, &seen, stated, diagnosis, &jobs.map(Jobs::came).unwrap_or_default(), seed);
    let named = |id: EffectId| diagnosis.effects.iter().any(|effect| effect.id == id);
    let explained = !diagnosis.effects.is_empty();
    let mut facts = of_failures(shop, &seen, named(EffectId::BREAKDOWN_SHAPE), seed);
    if !named(EffectId::TOOL_CHANGE_POLICY) {
        facts.extend(of_edges(shop, &seen));
    }
    // What adds to every handling makes its relative scatter smaller.
    if !named(EffectId::OPERATOR_DELAY) {
        facts.extend(of_handling(shop, &seen, stated));
    }
    facts.extend(scores.iter().filter_map(|score| of_queue(score, explained)));
    diagnosis.notes.extend(scores.iter().map(|score| score.words(explained)));
    diagnosis.notes.extend(unreplicated(shop, &seen));
    match jobs {
        Some(jobs) => facts.extend(jobs.facts(shop, records, diagnosis, seed)),
        None => diagnosis.notes.push(WITHOUT_JOBS.to_owned()),
    }
    let queues = scores.iter().filter_map(|score| {
        let (fit, fact) = (score.fit(explained), of_queue(score, explained)?);
        (fit.score.abs() > UNEXPLAINED_QUEUE).then(|| (fact.words(), fact.is_far()))
    });
    take_back(diagnosis, facts, queues.collect());
}

/// Adds facts to a diagnosis, and takes back that there is no gap where they contradict the file. `doubts` are off beside
/// them, in words, and whether by as much as matters.
pub(super) fn take_back(diagnosis: &mut Diagnosis, facts: Vec<Fact>, doubts: Vec<(String, bool)>) {
    if let Some(fit) = &mut diagnosis.fit {
        add_to(fit, &facts);
    }
    diagnosis.findings = findings(&facts);
    diagnosis.facts = facts;
    let quiet = matches!(diagnosis.verdict, GapVerdict::NoGap | GapVerdict::Masked | GapVerdict::Small);
    if quiet && !diagnosis.findings.is_empty() {
        let constant = diagnosis.findings.iter().any(|finding| finding.constant);
        diagnosis.verdict = if constant { GapVerdict::Constant } else { GapVerdict::Unknown };
    }
    if diagnosis.verdict == GapVerdict::NoGap {
        let slight = slight(&diagnosis.facts).into_iter().map(|fact| (fact.words(), false));
        let doubts: Vec<(String, bool)> = slight.chain(doubts).collect();
        if !doubts.is_empty() {
            let far = doubts.iter().any(|(_, far)| *far);
            diagnosis.verdict = if far { GapVerdict::Unknown } else { GapVerdict::Small };
            let words = |(words, far): (String, bool)| {
                format!("{words}: {}", if far { "no cause is known" } else { "off for certain, by less than matters" })
            };
            diagnosis.notes.extend(doubts.into_iter().map(words));
        }
    }
}

/// Makes facts part of a test: a right file fails that of the channels and that of the facts once in a hundred each.
fn add_to(fit: &mut Fitness, facts: &[Fact]) {
    let part = |fact: &Fact| Part {
        what: fact.quantity.name(),
        test: "fact",
        follows: fact.place.clone(),
        p: fact.p,
        statistic: fact.factor(),
    };
    fit.parts.extend(facts.iter().map(part));
    fit.parts.sort_by(|a, b| a.p.total_cmp(&b.p));
    fit.p = adjusted(facts).into_iter().fold(fit.p, f64::min);
}

/// The one way in which a machine breaks down; none where several run side by side.
fn only(station: &Station) -> Option<&FailureMode> {
    match &station.failures[..] {
        [mode] => Some(mode),
        _ => None,
    }
}

fn same(a: &FailureMode, b: &FailureMode) -> bool {
    a.clock == b.clock && a.time_between == b.time_between && a.time_to_repair == b.time_to_repair
}

/// Times between failures and to repair: of all machines with one law together as far as they agree, and of each machine.
pub(super) fn of_failures(shop: &Shop, visits: &Visits, shaped: bool, seed: u64) -> Vec<Fact> {
    let mut pools: Vec<Pool<'_>> = Vec::new();
    for (machine, name) in visits.machines.iter().enumerate() {
        let Some(mode) = shop.station(name).and_then(only) else { continue };
        let own = (name.as_str(), &visits.breakdowns[machine]);
        match pools.iter_mut().find(|pool| same(pool.mode, mode)) {
            Some(pool) => pool.machines.push(own),
            None => pools.push(Pool { mode, machines: vec![own] }),
        }
    }
    let of_pool = |pool: &Pool<'_>| -> Vec<Fact> {
        // The shape of a machine alone is asked where it has no pool.
        let shaped = |places: &[usize]| shaped || places.len() < pool.machines.len().min(2);
        let between = pool.facts(pool.rate_groups(), |places| pool.of_rate(places, shaped(places), seed));
        between.into_iter().chain(pool.facts(pool.repair_groups(), |places| pool.of_repair(places))).collect()
    };
    pools.iter().flat_map(of_pool).collect()
}

/// Machines that break down by one law.
struct Pool<'a> {
    mode: &'a FailureMode,
    /// Name and breakdowns of each.
    machines: Vec<(&'a str, &'a Breakdowns)>,
}

impl Pool<'_> {
    /// The facts of every group of machines, and of each machine of the first one.
    fn facts(&self, groups: Vec<Vec<usize>>, of: impl Fn(&[usize]) -> Vec<Fact>) -> Vec<Fact> {
        let alone = groups.first().filter(|group| group.len() > 1).cloned().unwrap_or_default();
        groups.into_iter().chain(alone.into_iter().map(|place| vec![place])).flat_map(|group| of(&group)).collect()
    }

    /// The machines that break down as often as each other, and those that do not; counts that are not Poisson's are not compared.
    fn rate_groups(&self) -> Vec<Vec<usize>> {
        if !matches!(self.mode.time_between, Distribution::Exponential { .. }) {
            return vec![(0..self.machines.len()).collect()];
        }
        let seen = |place: &usize| {
            let breakdowns = self.machines[*place].1;
            (breakdowns.times.len() as u64, self.exposure(breakdowns))
        };
        agreeing(self.machines.len(), |places| {
            same_rate(&places.iter().map(seen).filter(|own| own.1 > 0.0).collect::<Vec<_>>())
        })
    }

    /// The machines whose repairs last as long as each other's, and those whose do not.
    fn repair_groups(&self) -> Vec<Vec<usize>> {
        let repairs = |place: &usize| self.machines[*place].1.repairs.as_slice();
        agreeing(self.machines.len(), |places| same_middle(&places.iter().map(repairs).collect::<Vec<_>>()))
    }

    fn exposure(&self, breakdowns: &Breakdowns) -> f64 {
        if self.mode.clock == FailureClock::Busy { breakdowns.used } else { breakdowns.up }
    }

    fn place(&self, places: &[usize]) -> String {
        places.iter().map(|place| self.machines[*place].0).collect::<Vec<_>>().join(", ")
    }

    /// Level and shape of the times between failures.
    fn of_rate(&self, places: &[usize], shaped: bool, seed: u64) -> Vec<Fact> {
        let (mode, busy) = (self.mode, self.mode.clock == FailureClock::Busy);
        let all = || places.iter().map(|place| self.machines[*place].1);
        let between = |own: &Breakdowns| if busy { own.used_between.clone() } else { own.up_between.clone() };
        let history = History {
            place: self.place(places),
            pooled: places.len() > 1,
            failures: all().map(|own| own.times.len() as u64).sum(),
            exposure: all().map(|own| self.exposure(own)).sum(),
            intervals: all().flat_map(between).collect(),
        };
        // Only what is repaired for longer than a short stop is told from one.
        let visible = share_above(&mode.time_to_repair, SHORT_STOP);
        let exponential = matches!(mode.time_between, Distribution::Exponential { .. });
        // Counts of several clocks that are not exponential have no law of one.
        let level =
            (exponential || places.len() == 1).then(|| time_between(&history, &mode.time_between, visible, seed));
        let shape = if shaped { None } else { shape(&history, &mode.time_between, seed) };
        level.flatten().into_iter().chain(shape).collect()
    }

    fn of_repair(&self, places: &[usize]) -> Vec<Fact> {
        let repairs: Vec<f64> =
            places.iter().flat_map(|place| self.machines[*place].1.repairs.iter().copied()).collect();
        let law = &self.mode.time_to_repair;
        let repair = times(Quantity::TimeToRepair, &self.place(places), &repairs, law, 0.0, SHORT_STOP);
        repair.into_iter().map(|fact| Fact { pooled: places.len() > 1, ..fact }).collect()
    }
}

/// Lives of the edges of every machine.
fn of_edges(shop: &Shop, visits: &Visits) -> Vec<Fact> {
    let lives_of = |(machine, name): (usize, &String)| {
        let ended = visits.edge_lives.iter().filter(|own| own.0 == machine);
        let ages = visits.edge_ages.iter().filter(|own| own.0 == machine);
        let mut recorded: Vec<Life> = ended.map(|own| Life { time: own.2, ended: true }).collect();
        recorded.extend(ages.map(|own| Life { time: own.1, ended: false }));
        lives(name, &recorded, &shop.station(name)?.lives, LIFE)
    };
    visits.machines.iter().enumerate().filter_map(lives_of).collect()
}

/// Says before which pools of a log waits are not tested, and why: by the first of its machines that has a reason.
fn unreplicated(shop: &Shop, seen: &Visits) -> impl Iterator<Item = String> {
    let mut reasons: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for pool in pools_of(seen) {
        let reason = pool.iter().find_map(|name| shop.station(name).and_then(|station| station.queueing));
        if let Some(reason) = reason {
            reasons.entry(reason).or_default().extend(pool);
        }
    }
    reasons.into_iter().map(|(reason, names)| format!("not tested: waits before {}: {reason}", names.join(", ")))
}

/// How loading and unloading scatters at every machine, among operations of one program in one shift. Delays of operators
/// that the file states are no part of it.
fn of_handling(shop: &Shop, visits: &Visits, stated: &Declarations) -> Vec<Fact> {
    let late = |visit: &Visit| -> f64 {
        let place = occasion(shop, visits, visit);
        let delays =
            stated.deviations.iter().filter(|own| own.effect == ShopEffect::OperatorDelay && own.scope.holds(&place));
        delays.map(|own| own.size).sum()
    };
    let times_of = |(machine, name): (usize, &String)| {
        let mut alike: BTreeMap<(usize, String), Vec<f64>> = BTreeMap::new();
        for visit in visits.list.iter().filter(|visit| visit.machine == machine) {
            let handling = visit.handling - late(visit);
            if handling > 0.0 {
                alike.entry((visit.program, shop.shift(name, visit.start))).or_default().push(handling);
            }
        }
        let recorded: Vec<Vec<f64>> = alike.into_values().collect();
        spread(Quantity::HandlingScatter, name, &recorded, &shop.station(name)?.handling)
    };
    visits.machines.iter().enumerate().filter_map(times_of).collect()
}

fn of_queue(score: &QueueScore, explained: bool) -> Option<Fact> {
    let fit = score.fit(explained);
    let place = score.machines.join(", ");
    waits(&place, &Waits { count: score.waits as u64, days: &fit.days, score: fit.score, scores: &fit.scores })
}
