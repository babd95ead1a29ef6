//! Which kind of file holds the frequency responses.

use crate::csv::read_csv;
use crate::error::DynamicsError;
use crate::frf::Measurement;
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
