//! Edges that have broken, and readings of the rapid stage before.
//!
//! Where wear runs away, its slopes by everything grow without bound: a reading says that the edge
//! has broken, and nothing about the equations before. A few such readings would decide a fit.

use super::constants::{BREAKING, BROKEN};
use super::{Channel, ChannelId, Measured};

/// Share of the growth since the reading before by which growth scatters (assumption).
const RAPID: f64 = 0.1;

/// How much faster than the model says an edge wears that breaks (1). Assumption: edges of one kind scatter by a fifth, and
/// where wear speeds up a land may grow half as fast again as that.
const SUDDEN: f64 = 3.0;
/// Share of the growth that the model says of rows in which wear runs away, from which the records bear it out (1).
/// Assumption.
const BORNE_OUT: f64 = 0.5;

/// Takes out what was read while an edge broke and after, times beside; how many rows those are.
///
/// `grown` tells how much the land grows in a row from a land at its start, m, where it is known how edges scatter. Which
/// rows wear rapidly is then told from what was read before them. A row that is left out because of its own reading would
/// leave behind only rows whose reading is low, and the model would seem to predict too much.
pub(super) fn take_out(
    channels: &mut [(Channel, Vec<f64>)],
    groups: &[usize],
    grown: Option<&dyn Fn(usize, f64) -> f64>,
) -> usize {
    let Some((_, wear)) = channels.iter().find(|(channel, _)| channel.id == ChannelId::FlankWear) else { return 0 };
    let rows = grown.and_then(|grown| foreseen(wear, groups, grown)).unwrap_or_else(|| read(wear, groups));
    // What is always so is no break.
    if 2 * rows.len() > groups.len() {
        return 0;
    }
    for (_, values) in channels.iter_mut().filter(|(channel, _)| channel.id != ChannelId::CycleTime) {
        rows.iter().for_each(|row| values[*row] = f64::NAN);
    }
    rows.len()
}

/// Rows in which the land that was read is that of a broken edge, or grew like one, and those after them.
fn read(wear: &[f64], groups: &[usize]) -> Vec<usize> {
    let count = groups.iter().max().map_or(0, |last| last + 1);
    let (mut before, mut broken) = (vec![0.0; count], vec![false; count]);
    let is_broken = |(wear, group): (&f64, &usize)| {
        broken[*group] |= *wear > BROKEN || wear - before[*group] > BREAKING;
        before[*group] = *wear;
        broken[*group]
    };
    let of_row: Vec<bool> = wear.iter().zip(groups).map(is_broken).collect();
    (0..of_row.len()).filter(|row| of_row[*row]).collect()
}

/// Rows in which an edge was to be expected to break by what was read before, or broke although it was not, and those after
/// them; none where edges do not wear as fast in such rows as `grown` says, so that it cannot be relied on.
fn foreseen(wear: &[f64], groups: &[usize], grown: &dyn Fn(usize, f64) -> f64) -> Option<Vec<usize>> {
    let count = groups.iter().max().map_or(0, |last| last + 1);
    // The land that was last read, and what it should have become by now.
    let (mut last, mut now, mut broken) = (vec![0.0_f64; count], vec![0.0_f64; count], vec![false; count]);
    let (mut expected_of_rapid, mut read_of_rapid) = (0.0, 0.0);
    let mut rows = Vec::new();
    for (row, (wear, group)) in wear.iter().zip(groups).enumerate() {
        let (last, now, broken) = (&mut last[*group], &mut now[*group], &mut broken[*group]);
        let growth = if *broken { 0.0 } else { grown(row, *now) };
        let rapid = !*broken && (growth > BREAKING || *now + growth > BROKEN);
        *now += growth;
        if wear.is_finite() {
            let (expected, read) = (*now - *last, wear - *last);
            if rapid {
                expected_of_rapid += expected;
                read_of_rapid += read;
            }
            *broken |= read > BREAKING && read > SUDDEN * expected;
            (*last, *now) = (*wear, *wear);
        }
        *broken |= rapid;
        if *broken {
            rows.push(row);
        }
    }
    (read_of_rapid >= BORNE_OUT * expected_of_rapid).then_some(rows)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Transform;
    use toolroom_records::Sensor;

    /// Two edges of four rows: evenly worn by 0.05 mm a row, then fast.
    const GROUPS: [usize; 8] = [0, 0, 0, 0, 1, 1, 1, 1];

    /// Where the land is beyond 0.14 mm, edges wear by 0.2 mm a row.
    fn grown(_: usize, land: f64) -> f64 {
        if land > 0.14e-3 { 0.2e-3 } else { 0.05e-3 }
    }

    fn wear(ends: [f64; 2]) -> Vec<f64> {
        [0.05, 0.1, 0.15, ends[0], 0.05, 0.1, 0.15, ends[1]].map(|land| land * 1e-3).to_vec()
    }

    #[test]
    fn rows_that_wear_rapidly_are_left_out_whatever_was_read_in_them() {
        assert_eq!(foreseen(&wear([0.37, 0.29]), &GROUPS, &grown), Some(vec![3, 7]));
        // By their own reading only one of them would be, and the other would seem to have worn too little.
        assert_eq!(read(&wear([0.37, 0.29]), &GROUPS), [3]);
    }

    #[test]
    fn an_edge_that_breaks_without_a_warning_is_left_out_from_there_on() {
        let even = |_: usize, _: f64| 0.05e-3;
        let mut wear = wear([0.2, 0.2]);
        wear[5] = 0.31e-3;
        assert_eq!(foreseen(&wear, &GROUPS, &even), Some(vec![5, 6, 7]));
        // An unread row says nothing: two rows may grow by twice as much.
        wear[5] = f64::NAN;
        wear[6] = 0.19e-3;
        assert_eq!(foreseen(&wear, &GROUPS, &even), Some(Vec::new()));
    }

    #[test]
    fn rapid_wear_that_only_the_model_has_leaves_the_records_as_they_are() {
        assert_eq!(foreseen(&wear([0.2, 0.21]), &GROUPS, &grown), None);
        let (id, transform, sensor) =
            (ChannelId::FlankWear, Transform::Linear, Sensor { absolute: 0.0, relative: 0.0, resolution: 0.0 });
        let mut channels = vec![(Channel { id, display: "mm", unit: "m", transform, sensor }, wear([0.2, 0.21]))];
        assert_eq!(take_out(&mut channels, &GROUPS, Some(&grown)), 0);
        assert_eq!(channels[0].1, wear([0.2, 0.21]));
    }
}
