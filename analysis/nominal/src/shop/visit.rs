//! From events to operations on machines.

use super::state::State;
use super::stays::{Stay, adopt, in_shift, join_stops};
use super::stops::lower_deviation;
use std::collections::{BTreeMap, BTreeSet};
use toolroom_records::Records;
use toolroom_scenario::PieceTimes;
use toolroom_statistics::median;

/// Stops up to this long are short stops, longer ones breakdowns, s (Nakajima 1988 counts minor
/// stoppages up to a few minutes).
pub const SHORT_STOP: f64 = 300.0;
/// A stay in one state of this length or more, s, is no stay but a gap in the log (assumption).
const GAP: f64 = 12.0 * 3600.0;

/// One operation on one machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Visit {
    /// Machine, by index of [`Visits::machines`].
    pub machine: usize,
    /// Program, by index of [`Visits::programs`].
    pub program: usize,
    /// What the log calls it.
    pub operation: String,
    /// The job, where the operation is called `job/operation`; else the operation.
    pub job: String,
    /// From, s.
    pub start: f64,
    /// To, s.
    pub end: f64,
    /// Order of its job, empty where that is not recorded.
    pub order: String,
    /// Pieces that it worked on, 1.
    pub pieces: f64,
    /// Program running, s.
    pub cutting: f64,
    /// Loading and unloading, s.
    pub handling: f64,
    /// Edge changes, s each.
    pub changes: Vec<f64>,
    /// Changing over, s.
    pub setup: f64,
    /// Feed holds, s each.
    pub holds: Vec<f64>,
    /// Short stops, s each.
    pub stops: Vec<f64>,
    /// Mean of programmed over actual feed, less one, while the program ran; 0 where not recorded.
    pub override_excess: f64,
    /// Whether it began with an edge that the machine had not used before.
    pub new_edge: bool,
}

/// Breakdowns of one machine.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Breakdowns {
    /// When they began, s.
    pub times: Vec<f64>,
    /// Time in use that was seen, s.
    pub used: f64,
    /// All time that was seen and in which the machine was not broken down, s.
    pub up: f64,
    /// Repairs that were seen from beginning to end, s.
    pub repairs: Vec<f64>,
    /// Time in use between two breakdowns, s.
    pub used_between: Vec<f64>,
    /// Up time between two breakdowns, s.
    pub up_between: Vec<f64>,
}

/// What an event log holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Visits {
    /// Names of machines.
    pub machines: Vec<String>,
    /// Names of programs.
    pub programs: Vec<String>,
    /// Complete operations, by machine and time.
    pub list: Vec<Visit>,
    /// Time in use between two breakdowns, with the machine and the time of the later one, s.
    pub failure_gaps: Vec<(usize, f64, f64)>,
    /// What is known of the breakdowns of each machine.
    pub breakdowns: Vec<Breakdowns>,
    /// Time in cut of edges that were followed from first to last, with machine and end, s.
    pub edge_lives: Vec<(usize, f64, f64)>,
    /// Time in cut of edges that were followed from their first cut and are still in use, with the machine, s.
    pub edge_ages: Vec<(usize, f64)>,
    /// Breakdowns, nights and what is not known, by machine: from and to, s.
    pub away: Vec<Vec<(f64, f64)>>,
    /// Time in shift, breakdowns included, by machine: from and to, s. A breakdown that goes on after the shift counts whole.
    pub in_shift: Vec<Vec<(f64, f64)>>,
    /// Whether feed overrides are recorded.
    pub overridden: bool,
    /// What the reader found worth saying.
    pub notes: Vec<String>,
}

impl Visit {
    /// How many times as long as that of one piece it takes, 1; those that all have times of their own count one by one.
    pub fn times(&self, pieces: PieceTimes) -> f64 {
        match pieces {
            PieceTimes::Alike | PieceTimes::Own => self.pieces,
            PieceTimes::Together | PieceTimes::OfBatch => 1.0,
        }
    }
}

impl Visits {
    /// The first time from `time` on at which a machine is there, s.
    pub fn working(&self, machine: usize, time: f64) -> f64 {
        let away = &self.away[machine];
        let first = away.partition_point(|(_, to)| *to <= time);
        // A night may follow a breakdown at once.
        away[first..].iter().fold(time, |now, (from, to)| if *from <= now { to.max(now) } else { now })
    }

    /// When a machine has worked for `duration` from `start` on, s.
    pub fn worked(&self, machine: usize, start: f64, duration: f64) -> f64 {
        let away = &self.away[machine];
        let (mut now, mut left) = (start, duration);
        for (from, to) in &away[away.partition_point(|(_, to)| *to <= start)..] {
            if now + left <= *from {
                break;
            }
            left -= (from - now).max(0.0);
            now = to.max(now);
        }
        now + left
    }
}

/// Gathers operations from events.
pub fn visits(events: &Records) -> Visits {
    let mut all = Visits::default();
    let empty = vec![String::new(); events.len()];
    let text = |name: &str| events.texts(name).unwrap_or(&empty);
    let (machines, programs) = (text("machine"), text("program"));
    let names = |texts: &[String]| -> Vec<String> {
        let distinct: BTreeSet<&String> = texts.iter().filter(|text| !text.is_empty()).collect();
        distinct.into_iter().cloned().collect()
    };
    (all.machines, all.programs) = (names(machines), names(programs));
    let nan = vec![f64::NAN; events.len()];
    let [feeds, pieces] = ["feed_override", "quantity"].map(|name| events.numbers(name).unwrap_or(&nan));
    all.overridden = feeds.iter().any(|feed| *feed > 0.0 && (feed - 1.0).abs() > 1e-3);
    let Some(times) = events.numbers("time") else { return all };
    let mut words: BTreeMap<&str, usize> = BTreeMap::new();
    for word in text("state").iter().filter(|word| State::of(word) == State::Unknown) {
        *words.entry(word).or_default() += 1;
    }
    for (word, count) in words.iter().filter(|(word, _)| !word.is_empty() && !word.eq_ignore_ascii_case("unavailable"))
    {
        all.notes.push(format!("state `{word}` is not known ({count} events): taken as unavailable"));
    }
    let (mut gaps, mut cut_off) = (0usize, 0usize);
    for machine in 0..all.machines.len() {
        let rows: Vec<usize> = (0..events.len()).filter(|row| machines[*row] == all.machines[machine]).collect();
        let named = rows.iter().any(|row| !text("operation_id")[*row].is_empty());
        let (mut stays, mut count, mut handled) = (Vec::with_capacity(rows.len()), 0, false);
        for pair in rows.windows(2) {
            let (row, next) = (pair[0], pair[1]);
            let mut state = State::of(&text("state")[row]);
            if times[next] - times[row] >= GAP && !matches!(state, State::OffShift | State::Idle) {
                state = State::Unknown;
                gaps += 1;
            }
            // Without names an operation goes on until the machine is idle, changes its program or is unloaded.
            let resting = matches!(state, State::Idle | State::OffShift | State::Unknown);
            let before = stays.last().is_some_and(|last: &Stay<'_>| last.program == programs[row].as_str());
            let handling = state == State::Handling;
            if !named && (resting || !before || (handled && !handling)) {
                count += 1;
            }
            handled = handling;
            let run_name = || if resting || handling { String::new() } else { format!("{}#{count}", programs[row]) };
            let operation = if named { text("operation_id")[row].clone() } else { run_name() };
            let (start, end) = (times[row], times[next]);
            let (program, tool, feed) = (programs[row].as_str(), text("tool_id")[row].as_str(), feeds[row]);
            let (pieces, order) = (pieces[row], text("order")[row].as_str());
            let (whole, first) = (0.0, false);
            stays.push(Stay { state, start, end, program, operation, tool, order, feed, pieces, whole, first });
        }
        adopt(&mut stays);
        join_stops(&mut stays);
        let gone = |stay: &&Stay<'_>| match stay.state {
            State::Stopped => stay.whole > SHORT_STOP,
            State::OffShift | State::Unknown => true,
            State::Cutting | State::Handling | State::ToolChange | State::Setup | State::Hold | State::Idle => false,
        };
        all.away.push(stays.iter().filter(gone).map(|stay| (stay.start, stay.end)).collect());
        all.in_shift.push(in_shift(&stays));
        cut_off += of_machine(&mut all, machine, &stays);
        breakdowns(&mut all, machine, &stays);
    }
    if gaps > 0 {
        all.notes.push(format!("{gaps} stays of half a day and more are taken as gaps of the log"));
    }
    let early = drop_aborted(&mut all);
    if early > 0 {
        all.notes.push(format!("{early} operations are left out: their program ended early"));
    }
    if cut_off > 0 {
        all.notes.push(format!("{cut_off} operations are left out: not seen from beginning to end"));
    }
    all
}

/// Time in cut over that of the same program on the same machine below which a program did not come to
/// its end (assumption).
const ENDED_EARLY: f64 = 0.8;
/// How many standard deviations of its shorter half below the middle it lies then, too. Assumption: of normal times as many
/// as three of a hundred thousand do; plain work may scatter by itself, and of exponential times none does.
const FAR_BELOW: f64 = 4.0;

/// Time in cut below which a program was broken off, from all `times` of it on one machine.
fn least_whole(times: &mut [f64]) -> f64 {
    let middle = median(times);
    let mut below: Vec<f64> = times.iter().map(|time| middle - time).filter(|distance| *distance >= 0.0).collect();
    (ENDED_EARLY * middle).min(middle - FAR_BELOW * lower_deviation(&mut below))
}

/// Drops operations whose program was broken off; how many. Times at full feed count, both whole and by the piece: which of
/// them is the program's, the log does not say.
fn drop_aborted(all: &mut Visits) -> usize {
    let times_of =
        |visit: &Visit| [1.0, visit.pieces].map(|pieces| visit.cutting / (1.0 + visit.override_excess) / pieces);
    let mut times: BTreeMap<(usize, usize), [Vec<f64>; 2]> = BTreeMap::new();
    // Pieces of an order may share one time: it counts once.
    let mut known: BTreeSet<(usize, usize, &str)> = BTreeSet::new();
    for visit in &all.list {
        if !visit.order.is_empty() && !known.insert((visit.machine, visit.program, &visit.order)) {
            continue;
        }
        let all = times.entry((visit.machine, visit.program)).or_default();
        all.iter_mut().zip(times_of(visit)).for_each(|(all, time)| all.push(time));
    }
    let least: BTreeMap<(usize, usize), [f64; 2]> =
        times.into_iter().map(|(key, times)| (key, times.map(|mut times| least_whole(&mut times)))).collect();
    let before = all.list.len();
    let whole = |(time, least): (f64, f64)| time >= least;
    all.list.retain(|visit| times_of(visit).into_iter().zip(least[&(visit.machine, visit.program)]).any(whole));
    before - all.list.len()
}

/// Adds the operations of a machine; how many were left out.
fn of_machine(all: &mut Visits, machine: usize, stays: &[Stay<'_>]) -> usize {
    let mut left_out = 0;
    let mut seen: BTreeSet<&str> = BTreeSet::new();
    let mut life: BTreeMap<&str, (f64, bool)> = BTreeMap::new();
    let mut last_tool = "";
    let mut place = 0;
    while place < stays.len() {
        if stays[place].operation.is_empty() {
            place += 1;
            continue;
        }
        // Breaks without a name between two stays of one operation belong to it.
        let id = &stays[place].operation;
        let mut end = place + 1;
        let mut next = end;
        while next < stays.len() && (stays[next].operation.is_empty() || stays[next].operation == *id) {
            next += 1;
            if stays[next - 1].operation == *id {
                end = next;
            }
        }
        let inside = &stays[place..end];
        let known = |stay: &Stay<'_>| stay.state != State::Unknown;
        let program = inside.iter().find(|stay| !stay.program.is_empty()).map_or("", |stay| stay.program);
        let mut visit = Visit {
            machine,
            program: all.programs.binary_search_by(|name| name.as_str().cmp(program)).unwrap_or(usize::MAX),
            operation: id.clone(),
            job: id.split_once('/').map_or(id.as_str(), |(job, _)| job).to_owned(),
            start: inside[0].start,
            end: inside[inside.len() - 1].end,
            order: inside.iter().map(|stay| stay.order).find(|order| !order.is_empty()).unwrap_or_default().to_owned(),
            pieces: inside.iter().map(|stay| stay.pieces).fold(1.0, f64::max),
            ..Visit::default()
        };
        let mut slowed = 0.0;
        for stay in inside {
            let time = stay.end - stay.start;
            match stay.state {
                State::Cutting => {
                    visit.cutting += time;
                    if stay.feed > 0.0 {
                        slowed += time * (1.0 - stay.feed);
                    }
                }
                State::Handling => visit.handling += time,
                State::ToolChange => visit.changes.push(time),
                State::Setup => visit.setup += time,
                State::Hold => visit.holds.push(time),
                State::Stopped if stay.first && stay.whole <= SHORT_STOP => visit.stops.push(stay.whole),
                // Neither is time of the operation.
                State::Stopped | State::Idle | State::OffShift | State::Unknown => {}
            }
            if stay.state == State::Cutting && !stay.tool.is_empty() {
                visit.new_edge |= seen.insert(stay.tool);
                // An edge that was in the machine before the log began was not followed.
                let followed = !last_tool.is_empty();
                let entry = life.entry(stay.tool).or_insert((0.0, followed));
                entry.0 += time;
                if stay.tool != last_tool
                    && let Some((cut, true)) = life.get(last_tool).copied()
                {
                    all.edge_lives.push((machine, stay.start, cut));
                }
                last_tool = stay.tool;
            }
        }
        // Time at feed f does f times the work of time at full feed.
        visit.override_excess = if visit.cutting > slowed { slowed / (visit.cutting - slowed) } else { 0.0 };
        let whole = place > 0 && end < stays.len() && inside.iter().all(known) && visit.cutting > 0.0;
        if whole && visit.program != usize::MAX {
            all.list.push(visit)
        } else {
            left_out += 1
        }
        place = end;
    }
    if let Some((cut, true)) = life.get(last_tool).copied() {
        all.edge_ages.push((machine, cut));
    }
    left_out
}

/// Adds the breakdowns of a machine and the times between them.
fn breakdowns(all: &mut Visits, machine: usize, stays: &[Stay<'_>]) {
    let mut breakdowns = Breakdowns::default();
    // Since the last breakdown: time in use, and up.
    let (mut used, mut up) = (f64::NAN, f64::NAN);
    for (place, stay) in stays.iter().enumerate() {
        let time = stay.end - stay.start;
        if stay.state == State::Stopped || stay.whole > SHORT_STOP {
            if stay.first && stay.whole > SHORT_STOP {
                breakdowns.times.push(stay.start);
                if used.is_finite() {
                    all.failure_gaps.push((machine, stay.start, used));
                    breakdowns.used_between.push(used);
                    breakdowns.up_between.push(up);
                }
                (used, up) = (0.0, 0.0);
                let after = stays[place..].iter().find(|other| other.whole == 0.0);
                if after.is_some_and(|after| after.state != State::Unknown) {
                    breakdowns.repairs.push(stay.whole);
                }
            }
            continue;
        }
        match stay.state {
            State::Unknown => (used, up) = (f64::NAN, f64::NAN),
            State::Idle | State::OffShift => {
                up += time;
                breakdowns.up += time;
            }
            State::Cutting | State::Handling | State::ToolChange | State::Setup | State::Hold => {
                (used, up) = (used + time, up + time);
                (breakdowns.used, breakdowns.up) = (breakdowns.used + time, breakdowns.up + time);
            }
            State::Stopped => {}
        }
    }
    all.breakdowns.push(breakdowns);
}
