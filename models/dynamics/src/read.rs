//! Which kind of file holds the measurement.

use crate::coherence::CoherenceTable;
use crate::csv::{read_coherence_csv, read_csv, read_csv_by_speed};
use crate::error::DynamicsError;
use crate::frf::Measurement;
use crate::hammer::{HammerOptions, responses};
use crate::record::{FullScale, is_record, read_record};
use crate::uff::{is_universal, read_coherence_uff, read_uff};

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

/// Reads the coherence in a table with `frequency [Hz]` and `coherence` (`xx.coherence`, `yx.coherence`, …, in % where it says so),
/// or in a universal file; responses in it are passed over. `file` is its name in messages.
///
/// # Errors
/// [`DynamicsError`] with the place of the first fault.
///
/// # Examples
/// ```
/// let table = toolroom_dynamics::read_coherence("c.csv", b"frequency [Hz],coherence [%]\n100,98\n102,99\n").unwrap();
/// let text = "frequency [Hz],real [um/N],imag [um/N]\n100,0.5,-0.1\n102,0.6,-0.2\n";
/// let measured = toolroom_dynamics::read_csv("tap.csv", text).unwrap().with_coherence(&table).unwrap();
/// assert_eq!(measured.functions[0].coherence, Some(vec![0.98, 0.99]));
/// ```
pub fn read_coherence(file: &str, bytes: &[u8]) -> Result<CoherenceTable, DynamicsError> {
    if is_universal(bytes) {
        read_coherence_uff(file, bytes)
    } else {
        read_coherence_csv(file, &String::from_utf8_lossy(bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::fmt::Write as _;

    /// Small good files of every kind: a table, one over time, a sound file of two channels, universal files with responses in text
    /// and in bytes and with signals over time.
    fn good() -> Vec<Vec<u8>> {
        let mut table = "frequency [Hz],xx.magnitude [dB re 1 m/N],xx.phase [deg],xx.coherence\n".to_owned();
        let mut record = "time [ms];force [N];y.acceleration [g]\n".to_owned();
        let mut wave =
            b"RIFF\xa4\x01\0\0WAVEfmt \x10\0\0\0\x01\0\x02\0\x80\x3e\0\0\0\xfa\0\0\x04\0\x10\0data\x80\x01\0\0"
                .to_vec();
        for i in 0..96 {
            let _ = writeln!(table, "{},{},{},0.9{}", 100 + 2 * i, -120 - i % 7, 10 * i - 180, i % 10);
            let _ = writeln!(record, "0,{i:03};{};{},5", if i == 20 { 200 } else { 0 }, i % 5);
            wave.extend([(i % 251) as u8, 1, 7, (i * 7 % 251) as u8]);
        }
        let set = |header: &str, kind: u8, of: [u8; 3], values: &[u8]| {
            let [data_type, numerator, denominator] = of;
            let mut set = format!(
                "    -1\n{header}\ntap\nNONE\nNONE\nNONE\nNONE\n{kind:5}{:10}{:5}{:10} {:<10}{:10}{:4} {:<10}{:10}{:4}\n\
                 {data_type:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n{:10}    0    0    0 NONE                 NONE\n\
                 {numerator:10}    0    0    0 NONE                 m/s^2\n\
                 {denominator:10}    0    0    0 NONE                 N\n{:10}    0    0    0 NONE                 NONE\n",
                1, 1, 0, "TIP", 1, 1, "TIP", 1, 1, 3, 1, 100.0, 2.0, 0.0, 18, 0
            )
            .into_bytes();
            set.extend(values);
            set.extend(b"\n    -1\n");
            set
        };
        let units = b"    -1\n   164\n         1SI: Meter (newton)           2\n  1.0000000000000000D+00  1.0000000000000000D+00\n    -1\n";
        let response = b" -1.00000E+00  5.00000E-01 -2.00000E+00  2.50000E-01\n -3.00000E+00  1.25000E-01";
        let coherence = b"  1.00000E+00  9.00000E-01  8.00000E-01";
        let binary: Vec<u8> = (0u8..6).flat_map(|i| f32::from(i).to_le_bytes()).collect();
        let text =
            [&units[..], &set("    58", 4, [5, 12, 13], response), &set("    58", 6, [2, 0, 0], coherence)].concat();
        let header = format!("    58b{:6}{:6}{:12}{:12}", 1, 2, 11, 24);
        let bytes = [&units[..], &set(&header, 4, [5, 12, 13], &binary)].concat();
        let time =
            [&units[..], &set("    58", 1, [2, 13, 0], coherence), &set("    58", 1, [2, 12, 0], coherence)].concat();
        let spectra = [
            &units[..],
            &set("    58", 2, [2, 13, 0], coherence),
            &set("    58", 2, [2, 12, 0], b"  2.00000E+01  2.00000E+01  2.00000E+01"),
            &set("    58", 3, [5, 12, 13], response),
        ]
        .concat();
        vec![table.into_bytes(), record.into_bytes(), wave, text, bytes, time, spectra]
    }

    #[test]
    fn the_good_files_of_these_tests_are_read_as_far_as_they_go() {
        let ends: Vec<String> = good()
            .iter()
            .map(|bytes| {
                measure("a", bytes, &TapOptions::default()).map_or_else(|error| error.to_string(), |_| String::new())
            })
            .collect();
        let [table, record, wave, text, bytes, time, spectra] = &ends[..] else { panic!("{ends:?}") };
        assert!([table, text, bytes, spectra].iter().all(|end| end.is_empty()), "{ends:?}");
        assert!(record.contains("hit") && wave.contains("force") && time.contains("3 samples"), "{ends:?}");
    }

    proptest! {
        /// `PROPTEST_CASES=1000000` reads a million.
        #[test]
        fn any_spoilt_file_is_read_or_refused(
            file in 0usize..7,
            edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0usize..40, 0u8..4), 1..5),
        ) {
            let mut bytes = good().swap_remove(file);
            for (place, byte, length, how) in edits {
                let start = place.index(bytes.len());
                let end = (start + length).min(bytes.len());
                match how {
                    0 => bytes[start] = byte,
                    1 => drop(bytes.drain(start..end)),
                    2 => bytes.extend_from_within(start..end),
                    _ => bytes.insert(start, byte),
                }
                if bytes.is_empty() {
                    break;
                }
            }
            let _ = measure("a", &bytes, &TapOptions::default());
        }
    }
}
