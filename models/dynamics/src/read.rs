//! Which kind of file holds the measurement.

use crate::csv::{read_csv, read_csv_by_speed};
use crate::error::DynamicsError;
use crate::frf::Measurement;
use crate::hammer::{HammerOptions, responses};
use crate::record::{FullScale, is_record, read_record};
use crate::uff::{is_universal, read_uff};

/// What is told of a tap test beside its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TapOptions {
    /// What full scale of every channel of a sound file means.
    pub scales: Vec<FullScale>,
    /// How responses are worked out of a record over time.
    pub hammer: HammerOptions,
}

/// Frequency responses from the bytes of a file; `file` is its name in messages. A universal file begins with a line that holds
/// `-1` alone; a sound file and a table with a column of time are records of hits; every other file is taken for a table of
/// responses.
///
/// # Errors
/// [`DynamicsError`] with the place of the first fault.
pub fn measure(file: &str, bytes: &[u8], options: &TapOptions) -> Result<Measurement, DynamicsError> {
    if is_universal(bytes) {
        read_uff(file, bytes, &options.hammer)
    } else if is_record(bytes) {
        responses(&read_record(file, bytes, &options.scales)?, &options.hammer)
    } else {
        read_csv(file, &String::from_utf8_lossy(bytes))
    }
}

/// Frequency responses at several spindle speeds (rad/s), ascending, of a table that has a column `spindle_speed [rpm]`; none of
/// any other file.
///
/// # Errors
/// [`DynamicsError`] with the place of the first fault of such a table.
pub fn measure_by_speed(file: &str, bytes: &[u8]) -> Result<Option<Vec<(f64, Measurement)>>, DynamicsError> {
    let text = String::from_utf8_lossy(bytes);
    let header = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
    if is_record(bytes) || !header.contains("spindle_speed") {
        return Ok(None);
    }
    read_csv_by_speed(file, &text)
}
