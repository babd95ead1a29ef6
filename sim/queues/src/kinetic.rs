//! Queues whose order changes while jobs wait, without looking at all of them for a decision.
//!
//! Under most rules the key of a job is a piecewise linear function of the clock. A tournament of all jobs keeps
//! with each of its matches until when its result holds: when the two lines meet, or one of them bends. A decision
//! plays again only the matches whose time is up (kinetic tournament). Where a key has a term that is the same for
//! many jobs, such as the work that waits for their next operation, these jobs have a tournament of their own, and a
//! decision compares the winners.
//!
//! Under [`DispatchRule::Atc`] the clock moves the logarithms of the keys of all jobs with slack alike; their
//! order hangs on the mean time in the queue. They have a tournament in which this mean takes the place of the clock;
//! those without slack have one in which nothing changes.
//!
//! # Source
//! J. Basch, L. J. Guibas, J. Hershberger, Data structures for mobile data, Journal of Algorithms 31 (1999) 1.

use super::entry::{Facts, Keys, QueueEntry, Ranked};
use super::heap::ordered;
use super::tournament::{Entry, Game, Tournament};
use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use toolroom_kernel::SimTime;
use toolroom_scenario::{DispatchRule, KeyOptions, MOST_RULES};

/// Which of the rules of a queue the tournaments are played for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// Rules before it whose keys stand: jobs with the same keys under them are a level.
    ahead: usize,
    /// A rule between them under which all jobs of a tournament have the same key.
    outer: Option<DispatchRule>,
    rule: DispatchRule,
}

impl Plan {
    /// How a queue of rules is kept; `None` where two of them change in ways that no tournament follows.
    pub fn of(rules: &[DispatchRule]) -> Option<Self> {
        let ahead = rules.iter().take_while(|rule| rule.stands()).count();
        let stand = |rules: &[DispatchRule]| rules.iter().all(|rule| rule.stands());
        match &rules[ahead..] {
            [rule, rest @ ..] if stand(rest) => Some(Self { ahead, outer: None, rule: *rule }),
            [outer @ (DispatchRule::LeastSetup | DispatchRule::WorkInNextQueue), rule, rest @ ..]
                if !rule.stands() && stand(rest) =>
            {
                Some(Self { ahead, outer: Some(*outer), rule: *rule })
            }
            _ => None,
        }
    }

    /// Number of rules up to and with that of the tournaments.
    fn played(&self) -> usize {
        self.ahead + usize::from(self.outer.is_some()) + 1
    }
}

/// The jobs of a queue.
#[derive(Clone, Debug)]
pub struct Kinetic {
    plan: Plan,
    /// A tournament for each kind of jobs.
    groups: Vec<Tournament<Name>>,
    /// Their places by what their jobs have in common; none is without jobs where there are levels.
    named: BTreeMap<Name, u32>,
    /// Those of them that have no name.
    unnamed: Vec<u32>,
    /// Where each job is, by its slot: the tournament and the place in it.
    places: Vec<(u32, u32)>,
    /// Number of jobs.
    count: usize,
    /// Sum of the times of the jobs, s.
    total: f64,
    /// When jobs lose their slack under [`DispatchRule::Atc`], with their slots and numbers.
    ripening: BinaryHeap<Reverse<(SimTime, u32, u32)>>,
}

/// What the jobs of a tournament have in common. The least level goes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Name {
    /// Keys under the rules that go before, in the order of whole numbers.
    level: [u64; MOST_RULES - 1],
    /// Under the rule between.
    outer: Common,
    /// Under that of the tournament.
    inner: Common,
}

/// What jobs have in common under a rule: station of the next operation, setup group and bits of its time,
/// or whether they have slack.
type Common = (u32, u64);

/// Where a job is that does not wait.
const NOWHERE: (u32, u32) = (u32::MAX, u32::MAX);

/// Jobs with slack, under [`DispatchRule::Atc`].
const EARLY: Common = (0, 0);
/// Those without.
const LATE: Common = (1, 0);

/// Jobs that lose their slack, from which on those that are gone are looked for.
const RIPENING: usize = 64;

/// What a job has in common with others under a rule.
fn common(rule: DispatchRule, facts: &Facts) -> Common {
    if rule.looks_ahead() {
        (facts.next_station.map_or(0, |station| station + 1), 0)
    } else if rule == DispatchRule::LeastSetup {
        (facts.setup_group, facts.setup_time.to_bits())
    } else if rule == DispatchRule::Atc && SimTime::from_seconds(facts.due - facts.work_left).is_err() {
        // Where that is no time of the run, the job never loses its slack or never had any.
        if facts.due < facts.work_left { LATE } else { EARLY }
    } else {
        EARLY
    }
}

impl Kinetic {
    pub fn from_plan(plan: Plan) -> Self {
        Self {
            plan,
            groups: Vec::new(),
            named: BTreeMap::new(),
            unnamed: Vec::new(),
            places: Vec::new(),
            count: 0,
            total: 0.0,
            ripening: BinaryHeap::new(),
        }
    }

    /// Number of jobs.
    pub fn len(&self) -> usize {
        self.count
    }

    /// A job comes; `keys` are its keys under the rules, of which those stand that are no tournament's.
    pub fn join(&mut self, waiting: QueueEntry, facts: Facts, keys: Keys) {
        let Plan { ahead, outer, rule } = self.plan;
        let mut level = [0; MOST_RULES - 1];
        level.iter_mut().zip(&keys[..ahead]).for_each(|(each, key)| *each = ordered(*key));
        let outer = outer.map_or((0, 0), |outer| common(outer, &facts));
        if rule == DispatchRule::Atc
            && let Ok(ripe_time) = SimTime::from_seconds(facts.due - facts.work_left)
        {
            if self.ripening.len() > 2 * self.count + RIPENING {
                let (places, groups) = (&self.places, &self.groups);
                self.ripening.retain(|Reverse((_, slot, number))| {
                    entry_of(places, groups, *slot).is_some_and(|entry| entry.waiting.number == *number)
                });
            }
            self.ripening.push(Reverse((ripe_time, waiting.slot, waiting.number)));
        }
        self.total += facts.time;
        self.count += 1;
        self.put(Name { level, outer, inner: common(rule, &facts) }, Entry { waiting, facts, keys });
    }

    fn put(&mut self, name: Name, entry: Entry) {
        let (groups, unnamed) = (&mut self.groups, &mut self.unnamed);
        let group = *self.named.entry(name).or_insert_with(|| {
            if let Some(group) = unnamed.pop() {
                groups[group as usize].name = Some(name);
                return group;
            }
            groups.push(Tournament::from_name(name));
            (groups.len() - 1) as u32
        });
        let slot = entry.waiting.slot as usize;
        let place = self.groups[group as usize].insert(entry);
        if self.places.len() <= slot {
            self.places.resize(slot + 1, NOWHERE);
        }
        self.places[slot] = (group, place);
    }

    /// A job is gone.
    pub fn leave(&mut self, slot: u32) -> Option<QueueEntry> {
        let (_, entry) = self.pull(slot)?;
        self.count -= 1;
        // No rounding stays where nobody waits.
        self.total = if self.count == 0 { 0.0 } else { self.total - entry.facts.time };
        Some(entry.waiting)
    }

    /// Takes a job out of its tournament.
    fn pull(&mut self, slot: u32) -> Option<(Name, Entry)> {
        let (group, place) = std::mem::replace(self.places.get_mut(slot as usize)?, NOWHERE);
        let tournament = self.groups.get_mut(group as usize)?;
        let (name, entry) = (tournament.name?, tournament.remove(place)?);
        if self.plan.ahead > 0 && tournament.is_empty() {
            tournament.name = None;
            self.named.remove(&name);
            self.unnamed.push(group);
        }
        Some((name, entry))
    }

    /// Takes out the job that goes first at a time, s; `keys` gives the keys of a job at this moment from the mean time
    /// of all.
    pub fn take(&mut self, now: f64, keys: impl Fn(&QueueEntry, &Facts, f64) -> Keys) -> Option<QueueEntry> {
        let mean = self.total / self.count as f64;
        self.ripen(now);
        let look_ahead = (KeyOptions::ATC_K * mean).max(f64::MIN_POSITIVE);
        let level = self.named.keys().next()?.level;
        let mut best: Option<Ranked> = None;
        for (name, group) in &self.named {
            if name.level != level {
                break; // those of the least level go first
            }
            let early = self.plan.rule == DispatchRule::Atc && name.inner == EARLY;
            let at = if early { 1.0 / look_ahead } else { now };
            let game = Game { rule: self.plan.rule, played: self.plan.played(), early, at };
            let Some(entry) = self.groups[*group as usize].winner(&game) else { continue };
            if self.named.len() == 1 {
                let slot = entry.waiting.slot; // there is nobody to compare it with
                return self.leave(slot);
            }
            let ranked = Ranked { keys: keys(&entry.waiting, &entry.facts, mean), waiting: entry.waiting };
            if best.is_none_or(|best| ranked < best) {
                best = Some(ranked);
            }
        }
        self.leave(best?.waiting.slot)
    }

    /// Jobs that have lost their slack go to those without.
    fn ripen(&mut self, now: f64) {
        while let Some(&Reverse((time, slot, number))) = self.ripening.peek() {
            if time.seconds() > now {
                return;
            }
            self.ripening.pop();
            let same = |entry: &Entry| entry.waiting.number == number;
            if entry_of(&self.places, &self.groups, slot).is_some_and(same)
                && let Some((name, entry)) = self.pull(slot)
            {
                self.put(Name { inner: LATE, ..name }, entry);
            }
        }
    }
}

/// The job of a slot, if it waits.
fn entry_of<'a>(places: &[(u32, u32)], groups: &'a [Tournament<Name>], slot: u32) -> Option<&'a Entry> {
    let &(group, place) = places.get(slot as usize)?;
    groups.get(group as usize)?.entry(place)
}

#[cfg(test)]
mod tests {
    use super::super::keys::{Measures, Moment, keys as keys_under};
    use super::super::queue::{Queue, QueueKind};
    use super::*;
    use proptest::prelude::*;

    const RULES: [DispatchRule; 11] = [
        DispatchRule::SlackPerOperation,
        DispatchRule::CriticalRatio,
        DispatchRule::ModifiedDueDate,
        DispatchRule::ModifiedOperationDue,
        DispatchRule::WorkInNextQueue,
        DispatchRule::TimeAndNextQueue,
        DispatchRule::TimesAndNextQueue,
        DispatchRule::TimeNextQueueAndSlack,
        DispatchRule::Atc,
        DispatchRule::Covert,
        DispatchRule::LeastSetup,
    ];

    /// Rules that go before.
    const BEFORE: [&[DispatchRule]; 5] = [
        &[],
        &[DispatchRule::Priority],
        &[DispatchRule::LeastSetup],
        &[DispatchRule::WorkInNextQueue],
        &[DispatchRule::Priority, DispatchRule::LeastSetup],
    ];
    /// Rules that follow.
    const AFTER: [Option<DispatchRule>; 3] =
        [None, Some(DispatchRule::ShortestProcessingTime), Some(DispatchRule::EarliestDueDate)];

    /// A job of small whole numbers, so that many keys are equal.
    fn facts(draw: u64, whole: bool) -> Facts {
        let pick =
            |place: u32, below: u64| ((draw >> place) % below) as f64 + if whole { 0.0 } else { draw as f64 * 1e-19 };
        let (time, rest) = (1.0 + pick(0, 9), pick(4, 20));
        Facts {
            time,
            work_left: time + rest,
            operations_left: 1.0 + ((draw >> 9) % 4) as f64,
            due: pick(12, 120),
            operation_due: pick(19, 80),
            weight: 1.0 + ((draw >> 26) % 3) as f64,
            priority: ((draw >> 45) % 3) as f64,
            next_time: pick(28, 9),
            next_station: [None, Some(0), Some(1)][((draw >> 32) % 3) as usize],
            setup_group: ((draw >> 34) % 3) as u32,
            setup_time: ((draw >> 36) % 3) as f64,
            ..Facts::default()
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(600))]
        #[test]
        fn a_tournament_takes_the_jobs_that_a_look_at_all_takes(
            (before, rule, after) in (0usize..5, 0usize..11, 0usize..3), whole in any::<bool>(),
            steps in prop::collection::vec((any::<u64>(), 0u32..4), 1..120)
        ) {
            let mut rules = BEFORE[before].to_vec();
            rules.push(RULES[rule]);
            rules.extend(AFTER[after]);
            rules.truncate(MOST_RULES);
            let Some(plan) = Plan::of(&rules) else { return Ok(()) };
            let (mut scan, mut kinetic) = (Queue::from_queue_kind(QueueKind::Scan), Queue::from_queue_kind(QueueKind::Kinetic(plan)));
            let mut now = 0.0;
            let mut gone: Vec<u32> = Vec::new();
            for (number, &(draw, what)) in (0u32..).zip(&steps) {
                now += ((draw >> 40) % 5) as f64;
                if what < 2 {
                    let waiting = QueueEntry { since: SimTime::from_seconds(now).unwrap(), number, slot: number, operation: 0 };
                    let standing_facts = facts(draw, whole);
                    let standing = |facts: &Facts| keys_under(&rules, now, facts, &Moment::default());
                    for queue in [&mut scan, &mut kinetic] {
                        queue.join(waiting, || standing_facts, standing, |_| true);
                    }
                } else if what == 2 && number > 0 {
                    // Another machine takes a job.
                    let slot = (draw % u64::from(number)) as u32;
                    kinetic.leave(slot);
                    gone.push(slot);
                } else {
                    let keys = |waiting: &QueueEntry, facts: &Facts, mean: Measures| {
                        let next_work = facts.next_station.map_or(0.0, |station| ((draw >> (8 * station)) % 6) as f64);
                        let setup = if facts.setup_group as u64 == draw % 3 { 0.0 } else { facts.setup_time };
                        keys_under(&rules, waiting.since.seconds(), facts, &Moment { now, mean, next_work, setup, ..Moment::default() })
                    };
                    let here = |waiting: &QueueEntry| !gone.contains(&waiting.slot);
                    let measures = |facts: &Facts| Measures { time: facts.time, setup: 0.0 };
                    let one = scan.take(now, here, measures, keys).map(|waiting| waiting.number);
                    let other = kinetic.take(now, here, measures, keys).map(|waiting| waiting.number);
                    prop_assert_eq!(one, other, "{:?} at {}", rules, now);
                }
            }
        }
    }
}
