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

use super::dispatch::{ATC_LOOK_AHEAD, COVERT_LOOK_AHEAD, COVERT_WAIT, Moment, key};
use super::queue::{Facts, Keys, Ranked, Waiting};
use std::cmp::{Ordering, Reverse};
use std::collections::{BTreeMap, BinaryHeap};
use toolroom_kernel::SimTime;
use toolroom_scenario::DispatchRule;

/// The jobs of a queue.
#[derive(Clone, Debug)]
pub(super) struct Kinetic {
    rule: DispatchRule,
    /// A tournament for each kind of jobs.
    groups: Vec<Tournament>,
    /// Their places by what their jobs have in common.
    named: BTreeMap<Common, usize>,
    /// Where each job is, by its slot: the tournament and the place in it.
    places: BTreeMap<u32, (usize, u32)>,
    /// Sum of the times of the jobs, s.
    total: f64,
    /// When jobs lose their slack under [`DispatchRule::Atc`], with their slots and numbers.
    ripening: BinaryHeap<Reverse<(SimTime, u32, u32)>>,
}

/// What the jobs of a tournament have in common: station of the next operation, setup group and bits of its time,
/// or whether they have slack.
type Common = (u32, u64);

/// Jobs with slack, under [`DispatchRule::Atc`].
const EARLY: Common = (0, 0);
/// Those without.
const LATE: Common = (1, 0);

impl Kinetic {
    pub fn of(rule: DispatchRule) -> Self {
        Self {
            rule,
            groups: Vec::new(),
            named: BTreeMap::new(),
            places: BTreeMap::new(),
            total: 0.0,
            ripening: BinaryHeap::new(),
        }
    }

    /// Number of jobs.
    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// A job comes; `keys` are its keys under the rules, of which all but the first stand.
    pub fn join(&mut self, waiting: Waiting, facts: Facts, keys: Keys) {
        let common = if self.rule.looks_ahead() {
            (facts.next_station.map_or(0, |station| station + 1), 0)
        } else if self.rule == DispatchRule::LeastSetup {
            (facts.setup_group, facts.setup_time.to_bits())
        } else if self.rule == DispatchRule::Atc {
            // Where that is no time of the run, the job never loses its slack or never had any.
            let ripe = SimTime::from_seconds(facts.due - facts.work_left);
            if let Ok(ripe_time) = ripe {
                self.ripening.push(Reverse((ripe_time, waiting.slot, waiting.number)));
            }
            if ripe.is_err() && facts.due < facts.work_left { LATE } else { EARLY }
        } else {
            (0, 0)
        };
        self.total += facts.time;
        self.put(common, Entry { waiting, facts, keys });
    }

    fn put(&mut self, common: Common, entry: Entry) {
        let groups = &mut self.groups;
        let group = *self.named.entry(common).or_insert_with(|| {
            groups.push(Tournament::default());
            groups.len() - 1
        });
        let slot = entry.waiting.slot;
        let place = self.groups[group].insert(entry);
        self.places.insert(slot, (group, place));
    }

    /// A job is gone.
    pub fn leave(&mut self, slot: u32) -> Option<Waiting> {
        let (group, place) = self.places.remove(&slot)?;
        let entry = self.groups[group].remove(place)?;
        // No rounding stays where nobody waits.
        self.total = if self.places.is_empty() { 0.0 } else { self.total - entry.facts.time };
        Some(entry.waiting)
    }

    /// Takes out the job that goes first at a time, s; `keys` gives the keys of a job at this moment from the mean time
    /// of all.
    pub fn take(&mut self, now: f64, keys: impl Fn(&Waiting, &Facts, f64) -> Keys) -> Option<Waiting> {
        let mean = self.total / self.places.len() as f64;
        self.ripen(now);
        let early = self.named.get(&EARLY).copied();
        let mut best: Option<Ranked> = None;
        for (index, group) in self.groups.iter_mut().enumerate() {
            let early = self.rule == DispatchRule::Atc && Some(index) == early;
            let look_ahead = (ATC_LOOK_AHEAD * mean).max(f64::MIN_POSITIVE);
            let game = Game { rule: self.rule, early, at: if early { 1.0 / look_ahead } else { now } };
            let Some(entry) = group.winner(&game) else { continue };
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
            let Some(&(group, place)) = self.places.get(&slot) else { continue };
            let same =
                self.groups[group].entries[place as usize].as_ref().is_some_and(|own| own.waiting.number == number);
            if !same || self.named.get(&EARLY) != Some(&group) {
                continue;
            }
            if let Some(entry) = self.groups[group].remove(place) {
                self.put(LATE, entry);
            }
        }
    }
}

/// A job in a tournament.
#[derive(Clone, Copy, Debug)]
struct Entry {
    waiting: Waiting,
    facts: Facts,
    /// Keys under the rules; the first is not used.
    keys: Keys,
}

/// What a tournament is played for.
struct Game {
    rule: DispatchRule,
    /// Whether it is that of jobs with slack under [`DispatchRule::Atc`].
    early: bool,
    /// Where on their lines the jobs are: the time, s, or one over the look-ahead, 1/s.
    at: f64,
}

/// A key as long as it is linear.
#[derive(Clone, Copy, Debug)]
struct Line {
    slope: f64,
    intercept: f64,
    /// Where it bends.
    end: f64,
}

impl Game {
    /// First key of a job, without what it has in common with others of its tournament.
    fn value(&self, entry: &Entry) -> f64 {
        let Facts { weight, time, .. } = entry.facts;
        if self.early {
            let line = self.line(entry);
            line.slope * self.at + line.intercept
        } else if self.rule == DispatchRule::Atc {
            -weight / time.max(f64::MIN_POSITIVE)
        } else {
            let moment = Moment { now: self.at, ..Moment::default() };
            key(self.rule, entry.waiting.since.seconds(), &entry.facts, &moment)
        }
    }

    fn line(&self, entry: &Entry) -> Line {
        let Facts { time, work_left, operations_left, due, operation_due, weight, .. } = entry.facts;
        let line = |slope, intercept, end| Line { slope, intercept, end };
        let bends = |at: f64, before: Line, after: Line| if self.at < at { Line { end: at, ..before } } else { after };
        let level = |value: f64| line(0.0, value, f64::INFINITY);
        match self.rule {
            DispatchRule::CriticalRatio => {
                let work = work_left.max(f64::MIN_POSITIVE);
                line(-1.0 / work, due / work, f64::INFINITY)
            }
            DispatchRule::SlackPerOperation => {
                line(-1.0 / operations_left, (due - work_left) / operations_left, f64::INFINITY)
            }
            DispatchRule::ModifiedDueDate => bends(due - work_left, level(due), line(1.0, work_left, f64::INFINITY)),
            DispatchRule::ModifiedOperationDue => {
                bends(operation_due - time, level(operation_due), line(1.0, time, f64::INFINITY))
            }
            DispatchRule::TimeNextQueueAndSlack => {
                let turn = due - work_left;
                bends(turn, level(time), line(-1.0, time + turn, f64::INFINITY))
            }
            DispatchRule::Covert => {
                let (worth, full) = (weight / time.max(f64::MIN_POSITIVE), due - work_left);
                let ahead = (COVERT_LOOK_AHEAD * COVERT_WAIT * work_left).max(f64::MIN_POSITIVE);
                let rising = line(-worth / ahead, worth * (full / ahead - 1.0), full);
                bends(full - ahead, level(0.0), bends(full, rising, level(-worth)))
            }
            DispatchRule::Atc if self.early => {
                line(due - work_left, (time.max(f64::MIN_POSITIVE) / weight).ln(), f64::INFINITY)
            }
            DispatchRule::Atc
            | DispatchRule::WorkInNextQueue
            | DispatchRule::TimeAndNextQueue
            | DispatchRule::TimesAndNextQueue
            | DispatchRule::LeastSetup
            | DispatchRule::Fifo
            | DispatchRule::Lifo
            | DispatchRule::Random
            | DispatchRule::FirstReleased
            | DispatchRule::Priority
            | DispatchRule::ShortestProcessingTime
            | DispatchRule::WeightedShortestTime
            | DispatchRule::LongestProcessingTime
            | DispatchRule::ShortestRemaining
            | DispatchRule::LongestRemaining
            | DispatchRule::EarliestDueDate
            | DispatchRule::EarliestOperationDue
            | DispatchRule::Slack
            | DispatchRule::FewestOperations
            | DispatchRule::MostOperations => level(0.0),
        }
    }

    fn order(&self, a: &Entry, b: &Entry) -> Ordering {
        let first = self.value(a).total_cmp(&self.value(b));
        let others = a.keys.iter().zip(&b.keys).skip(1).map(|(a, b)| a.total_cmp(b));
        let arrival = |entry: &Entry| (entry.waiting.since, entry.waiting.number);
        others.fold(first, Ordering::then).then_with(|| arrival(a).cmp(&arrival(b)))
    }

    /// From where to where the order of two jobs stays as it is here.
    fn holds(&self, a: &Entry, b: &Entry) -> (f64, f64) {
        let (a, b) = (self.line(a), self.line(b));
        let end = a.end.min(b.end);
        if a.slope == b.slope {
            return (f64::NEG_INFINITY, end);
        }
        let cross = (b.intercept - a.intercept) / (a.slope - b.slope);
        // Keys are rounded where lines meet: there they are compared every time.
        let margin = MARGIN * (cross.abs() + self.at.abs());
        if cross > self.at + margin {
            (f64::NEG_INFINITY, end.min(cross - margin))
        } else if cross < self.at - margin {
            (cross + margin, end)
        } else {
            (self.at, self.at)
        }
    }
}

/// Relative distance from the crossing of two lines within which rounding may hide it: some 10⁵ roundings.
const MARGIN: f64 = 1e-10;

/// No job.
const NOBODY: u32 = u32::MAX;

/// The best of jobs, and until when each match has its result.
#[derive(Clone, Debug, Default)]
struct Tournament {
    /// Jobs by place; their number is a power of two.
    entries: Vec<Option<Entry>>,
    /// Places without a job.
    free: Vec<u32>,
    /// Matches from the final, number 1, on; those of number i and its two before it are i, 2i and 2i + 1.
    matches: Vec<Match>,
}

/// A match.
#[derive(Clone, Copy, Debug)]
struct Match {
    /// Place of the winner.
    winner: u32,
    /// From where to where all results up to it hold.
    holds: (f64, f64),
}

/// A match that has to be played.
const OPEN: Match = Match { winner: NOBODY, holds: (f64::INFINITY, f64::NEG_INFINITY) };
/// A match without jobs.
const EMPTY: Match = Match { winner: NOBODY, holds: (f64::NEG_INFINITY, f64::INFINITY) };

impl Tournament {
    fn insert(&mut self, entry: Entry) -> u32 {
        if self.free.is_empty() {
            let old = self.entries.len();
            let size = (2 * old).max(2);
            self.entries.resize(size, None);
            self.free.extend((old as u32..size as u32).rev());
            self.matches = vec![OPEN; size];
        }
        let place = self.free.pop().expect("there is room now");
        self.entries[place as usize] = Some(entry);
        self.open(place);
        place
    }

    fn remove(&mut self, place: u32) -> Option<Entry> {
        let entry = self.entries[place as usize].take()?;
        self.free.push(place);
        self.open(place);
        Some(entry)
    }

    /// The matches of a place have to be played again.
    fn open(&mut self, place: u32) {
        let mut node = (self.entries.len() + place as usize) / 2;
        while node > 0 {
            self.matches[node] = OPEN;
            node /= 2;
        }
    }

    fn winner(&mut self, game: &Game) -> Option<Entry> {
        if self.entries.is_empty() {
            return None;
        }
        let winner = self.play(1, game).winner;
        self.entries.get(winner as usize).copied().flatten()
    }

    /// Result of a match, played again where it does not hold any more.
    fn play(&mut self, node: usize, game: &Game) -> Match {
        let size = self.entries.len();
        if node >= size {
            let place = node - size;
            let winner = if self.entries[place].is_some() { place as u32 } else { NOBODY };
            return Match { winner, ..EMPTY };
        }
        let (from, to) = self.matches[node].holds;
        if from <= game.at && game.at <= to {
            return self.matches[node];
        }
        let (one, other) = (self.play(2 * node, game), self.play(2 * node + 1, game));
        let common = (one.holds.0.max(other.holds.0), one.holds.1.min(other.holds.1));
        let entry = |place: u32| self.entries.get(place as usize).and_then(Option::as_ref);
        let result = match (entry(one.winner), entry(other.winner)) {
            (Some(a), Some(b)) => {
                let interval = game.holds(a, b);
                let winner = if game.order(a, b).is_le() { one.winner } else { other.winner };
                Match { winner, holds: (common.0.max(interval.0), common.1.min(interval.1)) }
            }
            (Some(_), None) => Match { winner: one.winner, holds: common },
            (None, _) => Match { winner: other.winner, holds: common },
        };
        self.matches[node] = result;
        result
    }
}

#[cfg(test)]
mod tests {
    use super::super::dispatch::keys as keys_under;
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
            next_time: pick(28, 9),
            next_station: [None, Some(0), Some(1)][((draw >> 32) % 3) as usize],
            setup_group: ((draw >> 34) % 3) as u32,
            setup_time: ((draw >> 36) % 3) as f64,
            ..Facts::default()
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]
        #[test]
        fn a_tournament_takes_the_jobs_that_a_look_at_all_takes(
            rule in 0usize..11, second in any::<bool>(), whole in any::<bool>(),
            steps in prop::collection::vec((any::<u64>(), 0u32..4), 1..120)
        ) {
            let mut rules = vec![RULES[rule]];
            rules.extend(second.then_some(DispatchRule::ShortestProcessingTime));
            let (mut scan, mut kinetic) = (Queue::of(QueueKind::Scan), Queue::of(QueueKind::Kinetic(RULES[rule])));
            let mut now = 0.0;
            let mut gone: Vec<u32> = Vec::new();
            for (number, &(draw, what)) in (0u32..).zip(&steps) {
                now += ((draw >> 40) % 5) as f64;
                if what < 2 {
                    let waiting = Waiting { since: SimTime::from_seconds(now).unwrap(), number, slot: number, operation: 0 };
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
                    let keys = |waiting: &Waiting, facts: &Facts, mean_time: f64| {
                        let next_work = facts.next_station.map_or(0.0, |station| ((draw >> (8 * station)) % 6) as f64);
                        let setup = if facts.setup_group as u64 == draw % 3 { 0.0 } else { facts.setup_time };
                        keys_under(&rules, waiting.since.seconds(), facts, &Moment { now, mean_time, next_work, setup })
                    };
                    let here = |waiting: &Waiting| !gone.contains(&waiting.slot);
                    let one = scan.take(now, here, keys).map(|waiting| waiting.number);
                    let other = kinetic.take(now, here, keys).map(|waiting| waiting.number);
                    prop_assert_eq!(one, other, "{:?} at {}", RULES[rule], now);
                }
            }
        }
    }
}
