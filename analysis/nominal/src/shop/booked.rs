//! Short stops that a log books: those that the file's breakdowns explain, and those that are usual.

use super::nominal::Station;
use super::visit::{SHORT_STOP, Visit};
use toolroom_facts::times::share_above;

/// Booked short stops that are usual, 1/s of time in cut (assumption). No file states their rate, so that a log with fewer
/// of them, or with a single one, contradicts nothing.
const USUAL: f64 = 0.2 / 3600.0;

/// Breakdowns during `visits` to a machine that the file lets expect with a repair so short that a log does not tell it from a
/// short stop (count).
pub(super) fn short_repairs(station: Option<&Station>, visits: &[&Visit]) -> f64 {
    let others = |visit: &Visit| visit.changes.iter().chain(&visit.holds).sum::<f64>();
    let used: f64 = visits.iter().map(|visit| visit.cutting + visit.handling + visit.setup + others(visit)).sum();
    let failures = station.map_or(&[][..], |station| &station.failures);
    let short = failures
        .iter()
        .map(|mode| (1.0 - share_above(&mode.time_to_repair, SHORT_STOP)) * used / mode.time_between.mean());
    short.filter(|count| count.is_finite()).sum()
}

/// Rate of short stops beside those repairs, as far as it is usual, 1/s of time in cut: what the log shows, at most
/// [`USUAL`]. Of each block its booked stops and its short repairs (count) and its time in cut, s.
pub(super) fn usual(blocks: impl Iterator<Item = [f64; 3]>) -> f64 {
    let counted = blocks.filter(|[stops, ..]| stops.is_finite());
    let (stops, time) = counted.fold((0.0, 0.0), |(stops, time), [booked, short_repairs, cutting]| {
        (stops + booked - short_repairs, time + cutting)
    });
    if time > 0.0 { (stops / time).clamp(0.0, USUAL) } else { USUAL }
}
