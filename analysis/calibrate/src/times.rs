//! How long an edge was cutting in each row of its records.

use crate::data_error::DataError;
use toolroom_records::Records;

/// Time of each row of an edge: minutes of cutting, or without them the operations since the row before, counted by
/// `sequence`; `place_of` a row is where it stands in the file.
pub(crate) fn times(
    records: &Records,
    rows: &[usize],
    edge: &str,
    place_of: &dyn Fn(usize) -> String,
) -> Result<Vec<f64>, DataError> {
    let value = |what: String| DataError::Value { edge: edge.to_owned(), what };
    if let Some(time) = records.numbers("cutting_time").filter(|time| time.iter().any(|time| time.is_finite())) {
        let minutes = |row: &usize| {
            let minutes = time[*row] / 60.0;
            let usable = minutes >= 0.0 && minutes.is_finite();
            let place = || place_of(*row);
            usable
                .then_some(minutes)
                .ok_or_else(|| value(format!("{}: a cutting_time of {minutes} min cannot be used", place())))
        };
        return rows.iter().map(minutes).collect();
    }
    if let Some(path) = path(records) {
        let speed = records.numbers("cutting_speed").ok_or_else(|| DataError::NoColumn("cutting_speed".to_owned()))?;
        let minutes = |row: &usize| {
            let minutes = path[*row] / speed[*row] / 60.0;
            let usable = minutes >= 0.0 && minutes.is_finite();
            usable
                .then_some(minutes)
                .ok_or_else(|| value(format!("{}: a path_length of {} m cannot be used", place_of(*row), path[*row])))
        };
        return rows.iter().map(minutes).collect();
    }
    let sequence = records.numbers("sequence").ok_or_else(|| DataError::NoColumn("cutting_time".to_owned()))?;
    let mut before = 0.0;
    rows.iter()
        .map(|row| {
            let passed = sequence[*row] - before;
            before = sequence[*row];
            let usable = passed > 0.0 && passed.is_finite();
            let place = || place_of(*row);
            usable.then_some(passed).ok_or_else(|| value(format!("{}: sequence {before} twice, or below 1", place())))
        })
        .collect()
}

/// Cutting path of each operation of turning, m, where it stands in place of the time in cut.
pub(crate) fn path(records: &Records) -> Option<&[f64]> {
    let path = records.numbers("path_length").filter(|path| path.iter().any(|path| path.is_finite()))?;
    // In milling a path is that of the centre of the cutter, which takes no part in the time of an edge in cut.
    records.numbers("feed_per_tooth").is_none().then_some(path)
}
