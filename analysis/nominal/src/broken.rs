//! Edges that have broken, and readings of the rapid stage before.
//!
//! Where wear runs away, its slopes by everything grow without bound: a reading says that the edge
//! has broken, and nothing about the equations before. A few such readings would decide a fit.

use super::constants::{BREAKING, BROKEN};
use super::{Channel, ChannelId, Measured};

/// Share of the growth since the reading before by which growth scatters (assumption).
const RAPID: f64 = 0.1;

/// Takes out what was read while an edge broke and after, times beside; how many rows those are.
pub(super) fn take_out(channels: &mut [(Channel, Vec<f64>)], groups: &[usize]) -> usize {
    let Some((_, wear)) = channels.iter().find(|(channel, _)| channel.id == ChannelId::FlankWear) else { return 0 };
    let count = groups.iter().max().map_or(0, |last| last + 1);
    let (mut before, mut broken) = (vec![0.0; count], vec![false; count]);
    let mut rows = Vec::new();
    for (row, (wear, group)) in wear.iter().zip(groups).enumerate() {
        broken[*group] |= *wear > BROKEN || wear - before[*group] > BREAKING;
        before[*group] = *wear;
        if broken[*group] {
            rows.push(row);
        }
    }
    // What is always so is no break.
    if 2 * rows.len() > groups.len() {
        return 0;
    }
    for (_, values) in channels.iter_mut().filter(|(channel, _)| channel.id != ChannelId::CycleTime) {
        rows.iter().for_each(|row| values[*row] = f64::NAN);
    }
    rows.len()
}

/// Adds the scatter of growth to the errors of wear readings.
pub(super) fn widen(measured: &mut Measured) {
    let Some(wear) = measured.channels.iter().position(|channel| channel.id == ChannelId::FlankWear) else { return };
    for run in &measured.runs {
        let mut before = 0.0;
        for observation in measured.observations[run.clone()].iter_mut().filter(|each| each.channel == wear) {
            let growth: f64 = observation.value - before;
            before = observation.value;
            observation.deviation = observation.deviation.hypot(RAPID * growth.max(0.0));
        }
    }
}
