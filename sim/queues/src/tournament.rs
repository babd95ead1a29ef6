//! A tournament of waiting jobs whose keys move along lines.
//!
//! Each match keeps the line of its winner and until when its result holds. Those of both sides of a match stand side by
//! side in memory, so that a match is played without looking at the jobs, but where rounding may hide which key is lesser.

use super::entry::{Facts, Keys, QueueEntry};
use super::keys::{Moment, key};
use std::cmp::Ordering;
use toolroom_scenario::{DispatchRule, KeyOptions};

/// A job in a tournament.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    pub waiting: QueueEntry,
    pub facts: Facts,
    /// Keys under the rules; only those behind that of the tournament are used.
    pub keys: Keys,
}

/// What a tournament is played for.
pub struct Game {
    pub rule: DispatchRule,
    /// Number of rules up to and with it.
    pub played: usize,
    /// Whether it is that of jobs with slack under [`DispatchRule::Atc`].
    pub early: bool,
    /// Where on their lines the jobs are: the time, s, or one over the look-ahead, 1/s.
    pub at: f64,
}

/// A key as long as it is linear, without what it has in common with others of its tournament.
#[derive(Clone, Copy, Debug)]
struct Line {
    slope: f64,
    intercept: f64,
    /// Where it bends.
    end: f64,
}

impl Line {
    /// Its value at a place, and how much of that rounding may hide.
    #[inline]
    fn at(&self, at: f64) -> (f64, f64) {
        let rise = self.slope * at;
        (rise + self.intercept, MARGIN * (rise.abs() + self.intercept.abs()))
    }
}

impl Game {
    /// First key of a job, without what it has in common with others of its tournament, rounded as it is where jobs are
    /// compared one by one.
    fn value(&self, entry: &Entry) -> f64 {
        if self.early {
            let line = self.line(entry);
            return line.slope * self.at + line.intercept;
        }
        let Facts { weight, time, .. } = entry.facts;
        if self.rule == DispatchRule::Atc {
            return -weight / time.max(f64::MIN_POSITIVE);
        }
        let moment = Moment { now: self.at, ..Moment::default() };
        key(self.rule, entry.waiting.since.seconds(), &entry.facts, &moment)
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
                let [wait, look_ahead] = KeyOptions::COVERT_KB;
                let ahead = (look_ahead * wait * work_left).max(f64::MIN_POSITIVE);
                let rising = line(-worth / ahead, worth * (full / ahead - 1.0), full);
                bends(full - ahead, level(0.0), bends(full, rising, level(-worth)))
            }
            DispatchRule::Atc if self.early => {
                line(due - work_left, (time.max(f64::MIN_POSITIVE) / weight).ln(), f64::INFINITY)
            }
            DispatchRule::Atc
            | DispatchRule::AtcWithSetups
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
            | DispatchRule::MostOperations => level(self.value(entry)),
        }
    }

    fn order(&self, a: &Entry, b: &Entry) -> Ordering {
        let first = self.value(a).total_cmp(&self.value(b));
        let others = a.keys.iter().zip(&b.keys).skip(self.played).map(|(a, b)| a.total_cmp(b));
        let arrival = |entry: &Entry| (entry.waiting.since, entry.waiting.number);
        others.fold(first, Ordering::then).then_with(|| arrival(a).cmp(&arrival(b)))
    }

    /// From where to where the order of two jobs stays as it is here.
    #[inline]
    fn holds(&self, a: &Line, b: &Line) -> (f64, f64) {
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

/// Share within which rounding may hide where two lines cross, or which of two keys is the lesser: some 10⁵ roundings.
const MARGIN: f64 = 1e-10;

/// No job.
const NOBODY: u32 = u32::MAX;

/// Jobs that are compared one by one before the matches: their lines stand side by side in memory.
const HEAT: usize = u16::BITS as usize;

/// The best of jobs, and until when each match has its result.
#[derive(Clone, Debug)]
pub struct Tournament<N> {
    /// What its jobs have in common; `None` while it has none.
    pub name: Option<N>,
    /// Jobs by place.
    entries: Vec<Option<Entry>>,
    /// Their lines.
    lines: Vec<Line>,
    /// Places without a job.
    free: Vec<u32>,
    /// Which places of each heat have a job; the number of heats is a power of two.
    heats: Vec<u16>,
    /// Matches from the final, number 1, on, then the heats; those before number i are 2i and 2i + 1.
    matches: Vec<Match>,
}

/// A match or a heat.
#[derive(Clone, Copy, Debug)]
struct Match {
    /// Line of the winner: a match is decided by what stands in the two before it.
    line: Line,
    /// From where to where all results up to it hold.
    holds: (f64, f64),
    /// Place of the winner.
    winner: u32,
}

/// The line of nobody, and of a job whose line is not known yet.
const NO_LINE: Line = Line { slope: 0.0, intercept: 0.0, end: f64::NEG_INFINITY };
/// A match that has to be played.
const OPEN: Match = Match { line: NO_LINE, holds: (f64::INFINITY, f64::NEG_INFINITY), winner: NOBODY };
/// A match without jobs.
const EMPTY: Match = Match { line: NO_LINE, holds: (f64::NEG_INFINITY, f64::INFINITY), winner: NOBODY };

impl Match {
    #[inline]
    fn holds_at(&self, at: f64) -> bool {
        self.holds.0 <= at && at <= self.holds.1
    }

    #[inline]
    fn is_open(&self) -> bool {
        self.holds.0 > self.holds.1
    }
}

/// What two intervals have in common.
#[inline]
fn both(one: (f64, f64), other: (f64, f64)) -> (f64, f64) {
    (one.0.max(other.0), one.1.min(other.1))
}

impl<N> Tournament<N> {
    pub fn from_name(name: N) -> Self {
        let (entries, lines, free) = (Vec::new(), Vec::new(), Vec::new());
        Self { name: Some(name), entries, lines, free, heats: Vec::new(), matches: Vec::new() }
    }

    /// Whether no job is in it.
    pub fn is_empty(&self) -> bool {
        self.free.len() == self.entries.len()
    }

    /// The job in a place.
    pub fn entry(&self, place: u32) -> Option<&Entry> {
        self.entries.get(place as usize)?.as_ref()
    }

    /// A job comes; its place.
    pub fn insert(&mut self, entry: Entry) -> u32 {
        let place = self.free.pop().unwrap_or_else(|| {
            if self.entries.len() == self.heats.len() * HEAT {
                self.heats.resize((2 * self.heats.len()).max(1), 0);
                self.matches = vec![OPEN; 2 * self.heats.len()];
            }
            self.entries.push(None);
            self.lines.push(NO_LINE);
            (self.entries.len() - 1) as u32
        });
        self.entries[place as usize] = Some(entry);
        self.lines[place as usize] = NO_LINE;
        self.heats[place as usize / HEAT] |= 1 << (place as usize % HEAT);
        self.open(place);
        place
    }

    /// A job goes.
    pub fn remove(&mut self, place: u32) -> Option<Entry> {
        let entry = self.entries.get_mut(place as usize)?.take()?;
        self.free.push(place);
        self.heats[place as usize / HEAT] &= !(1 << (place as usize % HEAT));
        self.open(place);
        Some(entry)
    }

    /// The matches of a place have to be played again. Whatever is open has only open matches after it.
    fn open(&mut self, place: u32) {
        let mut knot = self.heats.len() + place as usize / HEAT;
        while knot > 0 && !self.matches[knot].is_open() {
            self.matches[knot] = OPEN;
            knot /= 2;
        }
    }

    /// The job that goes first.
    pub fn winner(&mut self, game: &Game) -> Option<&Entry> {
        if self.entries.is_empty() {
            return None;
        }
        self.hold(1, game);
        self.entries.get(self.matches[1].winner as usize)?.as_ref()
    }

    /// Plays a match again where its result does not hold any more.
    fn hold(&mut self, knot: usize, game: &Game) {
        if self.matches[knot].holds_at(game.at) {
            return;
        }
        let heats = self.heats.len();
        if knot >= heats {
            self.matches[knot] = self.run(knot - heats, game);
            return;
        }
        self.hold(2 * knot, game);
        self.hold(2 * knot + 1, game);
        let (one, other) = (&self.matches[2 * knot], &self.matches[2 * knot + 1]);
        let common = both(one.holds, other.holds);
        self.matches[knot] = if other.winner == NOBODY {
            Match { holds: common, ..*one }
        } else if one.winner == NOBODY {
            Match { holds: common, ..*other }
        } else {
            let holds = both(common, game.holds(&one.line, &other.line));
            let first = self.is_before((one.winner, &one.line), (other.winner, &other.line), game);
            Match { holds, ..if first { *one } else { *other } }
        };
    }

    /// Compares the jobs of a heat.
    fn run(&mut self, heat: usize, game: &Game) -> Match {
        let taken = self.heats[heat];
        let places = || (0..HEAT).filter(|bit| taken >> bit & 1 == 1).map(|bit| heat * HEAT + bit);
        for place in places() {
            if game.at > self.lines[place].end
                && let Some(entry) = &self.entries[place]
            {
                self.lines[place] = game.line(entry);
            }
        }
        let played = |place: usize| (place as u32, &self.lines[place]);
        let first =
            places().reduce(|one, other| if self.is_before(played(one), played(other), game) { one } else { other });
        let Some(winner) = first else { return EMPTY };
        let line = self.lines[winner];
        let others = places().filter(|place| *place != winner).map(|place| game.holds(&line, &self.lines[place]));
        Match { line, holds: others.fold((f64::NEG_INFINITY, line.end), both), winner: winner as u32 }
    }

    /// Whether a job goes before another, each by its place and its line: by the lines, and where rounding may hide which is
    /// lesser, by all keys.
    #[inline]
    fn is_before(&self, (place, line): (u32, &Line), (other, others): (u32, &Line), game: &Game) -> bool {
        let ((a, rounding), (b, hidden)) = (line.at(game.at), others.at(game.at));
        if (a - b).abs() > rounding + hidden {
            return a < b;
        }
        let entry = |place: u32| self.entries[place as usize].as_ref().expect("who is compared waits");
        game.order(entry(place), entry(other)).is_le()
    }
}
