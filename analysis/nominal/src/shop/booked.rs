//! Short stops that a log books: those that the file's breakdowns explain, and those that are usual.

use super::block::Block;
use super::figure::Figure;
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
/// [`USUAL`].
pub(super) fn usual(blocks: &[Block]) -> f64 {
    let counted = blocks.iter().filter(|block| block.values[Figure::StopCount].is_finite());
    let (stops, time) = counted.fold((0.0, 0.0), |(stops, time), block| {
        (stops + block.values[Figure::StopCount] - block.short_repairs, time + block.cutting)
    });
    if time > 0.0 { (stops / time).clamp(0.0, USUAL) } else { USUAL }
}
