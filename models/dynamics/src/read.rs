//! Which kind of file holds the measurement.

use crate::csv::{read_csv, read_csv_by_speed};
use crate::error::DynamicsError;
use crate::frf::Measurement;
use crate::hammer::{HammerOptions, responses};
use crate::record::{FullScale, is_record, read_record};
use crate::uff::read_uff;

/// Reads frequency responses from the bytes of a file: a universal file begins with a line that holds `-1` alone, everything
/// else is taken for a table. `file` is its name in messages.
///
/// # Errors
/// [`DynamicsError`] with the place of the first fault.
pub fn read(file: &str, bytes: &[u8]) -> Result<Measurement, DynamicsError> {
    let first =
        bytes.split(|byte| *byte == b'\n').find(|line| !line.iter().all(u8::is_ascii_whitespace)).unwrap_or(&[]);
    if first.trim_ascii() == b"-1" { read_uff(file, bytes) } else { read_csv(file, &String::from_utf8_lossy(bytes)) }
}

/// What is told of a tap test beside its file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TapOptions {
    /// What full scale of every channel of a sound file means.
    pub scales: Vec<FullScale>,
    /// How responses are worked out of a record over time.
    pub hammer: HammerOptions,
}

/// Frequency responses from a file that holds them, as [`read`], or a record of hits over time.
///
/// # Errors
/// [`DynamicsError`] with the place of the first fault.
pub fn measure(file: &str, bytes: &[u8], options: &TapOptions) -> Result<Measurement, DynamicsError> {
    if is_record(bytes) {
        responses(&read_record(file, bytes, &options.scales)?, &options.hammer)
    } else {
        read(file, bytes)
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
