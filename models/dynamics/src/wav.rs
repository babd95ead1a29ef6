//! Sound files.

use crate::error::{DynamicsError, WaveProblem};

/// Format codes of RIFF WAVE files (Microsoft, Multimedia Programming Interface and Data Specifications 1.0, and
/// `WAVEFORMATEXTENSIBLE`).
const INTEGER: u16 = 1;
const FLOAT: u16 = 3;
const EXTENSIBLE: u16 = 0xFFFE;

/// Least length of a chunk that stands for an unknown one: `0xFFFF_FFFF` and, by programs that leave room for the header,
/// somewhat less than `0x8000_0000` (as ffmpeg and SoX write it; recalled).
const UNKNOWN_LENGTH: usize = 0x7FFF_0000;

/// Samples of a sound file.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Wave {
    /// Samples in a second.
    pub rate: f64,
    /// The samples of every channel, in shares of full scale.
    pub channels: Vec<Vec<f64>>,
}

/// Whether the bytes begin as a sound file does.
pub(crate) fn is_wave(bytes: &[u8]) -> bool {
    bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WAVE")
}

/// Reads whole numbers of 8, 16, 24 and 32 bits and floating-point numbers of 32 and 64 bits. A data chunk that promises more
/// than the file holds is refused, since nobody knows what the rest of the record would have told. Programs that write to a
/// pipe leave a length that stands for an unknown one; such a file is read to its end.
pub(crate) fn read_wave(file: &str, bytes: &[u8]) -> Result<Wave, DynamicsError> {
    let fault = |problem| DynamicsError::Wave { file: file.to_owned(), problem };
    let mut place = 12;
    let mut format = None;
    while let Some(head) = bytes.get(place..place + 8) {
        let length = u32::from_le_bytes([head[4], head[5], head[6], head[7]]) as usize;
        let start = place + 8;
        let end = start.saturating_add(length).min(bytes.len());
        let chunk = &bytes[start..end];
        match &head[..4] {
            b"fmt " => format = Some(Format::of(chunk).ok_or_else(|| fault(WaveProblem::Format))?),
            b"data" => {
                let format = format.ok_or_else(|| fault(WaveProblem::Format))?;
                if chunk.len() < length && length < UNKNOWN_LENGTH {
                    return Err(fault(WaveProblem::BrokenOff { promised: length, held: chunk.len() }));
                }
                return format.samples(chunk).map_err(fault);
            }
            _ => {}
        }
        // Chunks begin at even places.
        place = end + (length & 1);
    }
    Err(fault(WaveProblem::NoSamples))
}

/// How samples are written.
#[derive(Clone, Copy, Debug)]
struct Format {
    code: u16,
    channels: u16,
    rate: u32,
    bits: u16,
}

impl Format {
    fn of(chunk: &[u8]) -> Option<Self> {
        let short = |place: usize| Some(u16::from_le_bytes(chunk.get(place..place + 2)?.try_into().ok()?));
        let code = match short(0)? {
            // The first two bytes of the identifier of the subformat are the code.
            EXTENSIBLE => short(24)?,
            code => code,
        };
        let rate = u32::from_le_bytes(chunk.get(4..8)?.try_into().ok()?);
        Some(Self { code, channels: short(2)?, rate, bits: short(14)? })
    }

    fn samples(self, chunk: &[u8]) -> Result<Wave, WaveProblem> {
        let Self { code, channels, rate, bits } = self;
        let sample: fn(&[u8]) -> f64 = match (code, bits) {
            (INTEGER, 8) => |b| (f64::from(b[0]) - 128.0) / 128.0,
            (INTEGER, 16) => |b| f64::from(i16::from_le_bytes([b[0], b[1]])) / 32_768.0,
            (INTEGER, 24) => |b| f64::from(i32::from_le_bytes([0, b[0], b[1], b[2]])) / 2_147_483_648.0,
            (INTEGER, 32) => |b| f64::from(i32::from_le_bytes([b[0], b[1], b[2], b[3]])) / 2_147_483_648.0,
            (FLOAT, 32) => |b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
            (FLOAT, 64) => |b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]),
            _ => return Err(WaveProblem::Samples { code, bits }),
        };
        if channels == 0 || rate == 0 {
            return Err(WaveProblem::Format);
        }
        let (width, count) = (usize::from(bits / 8), usize::from(channels));
        let mut found = vec![Vec::with_capacity(chunk.len() / (width * count)); count];
        for frame in chunk.chunks_exact(width * count) {
            for (channel, bytes) in found.iter_mut().zip(frame.chunks_exact(width)) {
                let value = sample(bytes);
                if !value.is_finite() {
                    return Err(WaveProblem::NotANumber);
                }
                channel.push(value);
            }
        }
        if found[0].is_empty() {
            return Err(WaveProblem::NoSamples);
        }
        Ok(Wave { rate: f64::from(rate), channels: found })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn file(code: u16, channels: u16, bits: u16, data: &[u8]) -> Vec<u8> {
        let mut bytes = b"RIFF\0\0\0\0WAVEjunk\x03\0\0\0abc\0fmt \x10\0\0\0".to_vec();
        for value in [code, channels] {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend(8000u32.to_le_bytes());
        bytes.extend([0; 6]);
        bytes.extend(bits.to_le_bytes());
        bytes.extend(b"data");
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn every_width_gives_the_same_sound() {
        let values = [0.0, 0.5, -0.75];
        let expected = |data: Vec<u8>, code, bits| {
            let found = read_wave("a.wav", &file(code, 1, bits, &data)).unwrap();
            assert_eq!((found.rate, found.channels), (8000.0, vec![values.to_vec()]));
        };
        expected(values.map(|x| (128.0 + 128.0 * x) as u8).to_vec(), 1, 8);
        expected(values.iter().flat_map(|x| ((32_768.0 * x) as i16).to_le_bytes()).collect(), 1, 16);
        expected(values.iter().flat_map(|x| ((8_388_608.0 * x) as i32).to_le_bytes()[..3].to_vec()).collect(), 1, 24);
        expected(values.iter().flat_map(|x| ((2_147_483_648.0 * x) as i32).to_le_bytes()).collect(), 1, 32);
        expected(values.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect(), 3, 32);
        expected(values.iter().flat_map(|x| x.to_le_bytes()).collect(), 3, 64);
    }

    #[test]
    fn channels_lie_beside_each_other_and_a_file_that_breaks_off_is_refused() {
        let mut bytes = file(1, 2, 8, &[128, 0, 192, 128, 128, 128]);
        let found = read_wave("a.wav", &bytes).unwrap();
        assert_eq!(found.channels, [[0.0, 0.5, 0.0], [-1.0, 0.0, 0.0]]);
        let fault = |bytes: &[u8]| read_wave("a.wav", bytes).unwrap_err().to_string();
        let place = bytes.len() - 10;
        bytes.truncate(bytes.len() - 1);
        assert!(fault(&bytes).contains("promises 6 bytes of samples, 5 are there"), "{}", fault(&bytes));
        for unknown in [0xFFFF_FFFFu32, 0x7FFF_F000] {
            bytes[place..place + 4].copy_from_slice(&unknown.to_le_bytes());
            assert_eq!(read_wave("a.wav", &bytes).unwrap().channels[0].len(), 2);
        }
        assert!(fault(&file(6, 1, 8, &[1])).contains("format 6"), "{}", fault(&file(6, 1, 8, &[1])));
        assert!(fault(&file(1, 1, 16, &[])).contains("no samples"));
        assert!(fault(&bytes[..20]).contains("no samples"));
    }

    proptest! {
        #[test]
        fn any_bytes_are_read_or_refused(head in 0usize..60, tail in proptest::collection::vec(any::<u8>(), 0..80)) {
            let mut bytes = file(1, 1, 16, &[1, 2, 3, 4]);
            bytes.truncate(head.max(12));
            bytes.extend(tail);
            let _ = read_wave("a.wav", &bytes);
        }
    }
}
