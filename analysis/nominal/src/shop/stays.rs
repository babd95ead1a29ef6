//! Stays of a machine in one state, and what belongs together of them.

use super::state::State;

/// A stay of a machine in a state.
pub(super) struct Stay<'a> {
    pub state: State,
    pub start: f64,
    pub end: f64,
    pub program: &'a str,
    pub operation: String,
    pub tool: &'a str,
    /// Order of its job, empty where that is not recorded.
    pub order: &'a str,
    pub feed: f64,
    /// Pieces that it worked on, 1; NaN where not recorded.
    pub pieces: f64,
    /// Of a stop, and of the nights that interrupt it: length of the whole of it, s; 0 of every other stay.
    pub whole: f64,
    /// Whether a stop begins here.
    pub first: bool,
}

/// Stays in shift, put together where one follows the other at once.
pub(super) fn in_shift(stays: &[Stay<'_>]) -> Vec<(f64, f64)> {
    let mut all: Vec<(f64, f64)> = Vec::new();
    for stay in stays.iter().filter(|stay| !matches!(stay.state, State::OffShift | State::Unknown)) {
        match all.last_mut().filter(|last| last.1 == stay.start) {
            Some(last) => last.1 = stay.end,
            None => all.push((stay.start, stay.end)),
        }
    }
    all
}

/// Gives loading and unloading that bear no name to the operations around them: of several stays the
/// first is the unloading of the operation before; one alone belongs to what follows at once.
pub(super) fn adopt(stays: &mut [Stay<'_>]) {
    let mut place = 0;
    while place < stays.len() {
        let nameless = |stay: &Stay<'_>| stay.state == State::Handling && stay.operation.is_empty();
        let count = stays[place..].iter().take_while(|stay| nameless(stay)).count();
        let end = place + count;
        if count > 0 {
            let before = place.checked_sub(1).map_or_else(String::new, |before| stays[before].operation.clone());
            let after = stays.get(end).map_or_else(String::new, |after| after.operation.clone());
            let unloaded = if after.is_empty() { count } else { (count - 1).min(1) };
            for (place, stay) in stays[place..end].iter_mut().enumerate() {
                stay.operation.clone_from(if place < unloaded { &before } else { &after });
            }
        }
        place = end.max(place + 1);
    }
}

/// Gives every piece of a stop the length of the whole. A repair that is booked in pieces (an alarm, then the repair), or that the
/// end of a shift interrupts, is one: by its first piece alone it would be taken for a short stop.
pub(super) fn join_stops(stays: &mut [Stay<'_>]) {
    let mut place = 0;
    while place < stays.len() {
        if stays[place].state != State::Stopped {
            place += 1;
            continue;
        }
        let (program, mut last) = (stays[place].program, place);
        for (next, stay) in stays.iter().enumerate().skip(place + 1) {
            match stay.state {
                State::Stopped if stay.program == program => last = next,
                State::OffShift => {}
                State::Stopped
                | State::Cutting
                | State::Handling
                | State::ToolChange
                | State::Setup
                | State::Hold
                | State::Idle
                | State::Unknown => break,
            }
        }
        let pieces = &mut stays[place..=last];
        let stopped = pieces.iter().filter(|stay| stay.state == State::Stopped);
        let whole = stopped.map(|stay| stay.end - stay.start).sum();
        pieces.iter_mut().for_each(|stay| stay.whole = whole);
        stays[place].first = true;
        place = last + 1;
    }
}
