//! A saved state as bytes: little-endian, versioned, checksummed.
//!
//! | bytes | what |
//! |---|---|
//! | 4 | `TRFU` |
//! | 4 | version of this form, 2 |
//! | 16 | instantiation token of the unit |
//! | 4 | length of what follows without the checksum |
//! | … | mode, time, discrete state, input, state, parameters, name of the set |
//! | 4 | CRC-32 of everything before |

use super::{Core, Discrete, MOST};
use crate::catalogue::token;
use crate::configured::Configured;
use crate::fault::{Fault, Outcome};
use crate::mode::Mode;
use crate::unit::Unit;
use std::path::Path;
use std::sync::Arc;
use toolroom_process::Record;

const MAGIC: &[u8; 4] = b"TRFU";
const VERSION: u32 = 2;
/// Bytes before the length.
const HEAD: usize = 4 + 4 + 16;

/// The state as bytes.
pub(super) fn write<U: Unit>(core: &Core<U>) -> Vec<u8> {
    let mut bytes = Vec::new();
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend(token::<U>().to_le_bytes());
    bytes.extend([0; 4]);
    bytes.push(core.mode.code());
    let discrete = &core.discrete;
    let flags = |flags: [bool; MOST]| flags.map(u8::from);
    for list in [discrete.renewals, discrete.acted, discrete.events] {
        bytes.extend(flags(list));
    }
    bytes.push(u8::from(discrete.lost));
    bytes.extend(discrete.counts.iter().flat_map(|count| count.to_le_bytes()));
    let mut number = |value: f64| bytes.extend(value.to_le_bytes());
    [core.time, discrete.speed, discrete.next_sample, discrete.lost_at].into_iter().for_each(&mut number);
    (0..U::Input::LEN).filter_map(|i| core.input.get(i)).for_each(&mut number);
    (0..U::State::LEN).filter_map(|i| core.state.get(i)).for_each(&mut number);
    bytes.extend((core.model.values.len() as u32).to_le_bytes());
    bytes.extend(core.model.values.iter().flat_map(|value| value.to_le_bytes()));
    bytes.extend((core.model.set.len() as u32).to_le_bytes());
    bytes.extend(core.model.set.as_bytes());
    let length = (bytes.len() - HEAD - 4) as u32;
    bytes[HEAD..HEAD + 4].copy_from_slice(&length.to_le_bytes());
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

/// What is left to read.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Outcome<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(count).ok_or(Fault::Corrupt { reason: "it ends too early" })?;
        self.0 = rest;
        Ok(head)
    }

    fn array<const N: usize>(&mut self) -> Outcome<[u8; N]> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    fn word(&mut self) -> Outcome<u32> {
        Ok(u32::from_le_bytes(self.array()?))
    }

    fn number(&mut self) -> Outcome<f64> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    fn numbers(&mut self, count: usize) -> Outcome<Vec<f64>> {
        // No more is reserved than there is.
        let bytes = self.take(count.saturating_mul(8))?;
        Ok(bytes.chunks_exact(8).map(|each| f64::from_le_bytes(each.try_into().unwrap_or_default())).collect())
    }

    fn flags(&mut self) -> Outcome<[bool; MOST]> {
        Ok(self.array::<MOST>()?.map(|flag| flag != 0))
    }
}

/// The state of bytes. `present` is used where it has the same parameters: making them anew means
/// reading their file.
pub(super) fn read<U: Unit>(bytes: &[u8], resources: Option<&Path>, present: &Arc<Configured<U>>) -> Outcome<Core<U>> {
    let corrupt = |reason| Box::new(Fault::Corrupt { reason });
    let mut head = Bytes(bytes);
    if head.take(4)? != MAGIC {
        return Err(corrupt("it is not a state of a toolroom unit"));
    }
    if head.word()? != VERSION {
        return Err(corrupt("it was written by another version"));
    }
    if u128::from_le_bytes(head.array()?) != token::<U>() {
        return Err(corrupt("it belongs to another unit"));
    }
    let length = head.word()? as usize;
    let mut body = Bytes(head.take(length)?);
    let checked = bytes.len() - head.0.len();
    if head.word()? != crc32fast::hash(&bytes[..checked]) {
        return Err(corrupt("its checksum is wrong"));
    }
    if !head.0.is_empty() {
        return Err(corrupt("it is longer than it says"));
    }
    let mode = Mode::from_code(body.array::<1>()?[0]).ok_or_else(|| corrupt("it has an unknown mode"))?;
    let (renewals, acted, events) = (body.flags()?, body.flags()?, body.flags()?);
    let lost = body.array::<1>()?[0] != 0;
    let mut counts = [0; MOST];
    for count in &mut counts {
        *count = body.word()?;
    }
    let (time, speed) = (body.number()?, body.number()?);
    let (next_sample, lost_at) = (body.number()?, body.number()?);
    let input = U::Input::from_slice(&body.numbers(U::Input::LEN)?);
    let state = U::State::from_slice(&body.numbers(U::State::LEN)?);
    let count = body.word()? as usize;
    let values = body.numbers(count)?;
    let count = body.word()? as usize;
    let set = std::str::from_utf8(body.take(count)?).map_err(|_| corrupt("it names a set that is no text"))?;
    let same = present.set == set && present.values == values;
    let model = if same { Arc::clone(present) } else { Arc::new(Configured::restored(set, values, resources)?) };
    Ok(Core {
        model,
        mode,
        time,
        state,
        input,
        discrete: Discrete { renewals, acted, counts, events, lost, lost_at, speed, next_sample },
    })
}
