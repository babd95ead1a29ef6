//! Universal files: frequency responses, spectra and signals over time in data set 58, ASCII and binary, units from data set 164.
//!
//! # Source
//! The data sets 58, 58b and 164 as documented by the Structural Dynamics Research Laboratory of the University of
//! Cincinnati. Numbers are read by column, since fixed-width numbers may touch, and by blanks where that fails. The bytes of a
//! binary block are counted by what its record promises, not by the count in its header, which some programs get wrong.

mod function;
mod response;
mod sets;
mod spectra;
#[cfg(test)]
mod tests;
mod time;

use crate::coherence::CoherenceTable;
use crate::error::DynamicsError;
use crate::frf::Measurement;
use crate::hammer::{HammerOptions, responses};
use crate::record::long_enough;

/// Whether the bytes begin as a universal file does: with a line that holds `-1` alone.
pub(crate) fn is_universal(bytes: &[u8]) -> bool {
    let first =
        bytes.split(|byte| *byte == b'\n').find(|line| !line.iter().all(u8::is_ascii_whitespace)).unwrap_or(&[]);
    first.trim_ascii() == b"-1"
}

/// Reads frequency responses from a universal file; `file` is its name in messages.
///
/// Functions of type 4 (response) are taken with their coherence (6). Where there is none, responses are made of auto (2) and
/// cross spectra (3), or, where the file holds signals over time (1) alone, of the hits in them; every hit may be stored by
/// itself. Directions 1 and 2 are x and y, a negative one turns the sign. What is left out the notes say.
///
/// # Errors
/// [`DynamicsError`] with file and line of the data set that cannot be read.
pub fn read_uff(file: &str, bytes: &[u8], options: &HammerOptions) -> Result<Measurement, DynamicsError> {
    let sets = sets::Sets::read(file, bytes)?;
    if time::only_time(&sets) {
        responses(&long_enough(time::record(&sets)?)?, options)
    } else {
        response::measurement(sets, options.estimator)
    }
}

/// The coherence functions (6) of a universal file.
///
/// # Errors
/// As [`read_uff`]; a file without coherence.
pub(crate) fn read_coherence_uff(file: &str, bytes: &[u8]) -> Result<CoherenceTable, DynamicsError> {
    response::coherence(sets::Sets::read(file, bytes)?)
}
