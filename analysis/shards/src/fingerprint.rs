//! Hashes that tell contents apart; they prove nothing against malice.

use crate::{ShardError, at};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// FNV-1a of a text as 16 hexadecimal digits: tells inputs apart, proves nothing against malice.
///
/// # Examples
/// ```
/// assert_eq!(toolroom_shards::fingerprint(b"a"), "af63dc4c8601ec8c");
/// ```
pub fn fingerprint(bytes: &[u8]) -> String {
    format!("{:016x}", fnv(FNV_OFFSET, bytes))
}

/// FNV-1a of nothing, 64 bits.
pub const FNV_OFFSET: u64 = 0xcbf2_9ce4_8422_2325;

/// FNV-1a of what gave `hash`, followed by `bytes`.
pub fn fnv(hash: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(hash, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3))
}

/// FNV-1a of a file as 16 hexadecimal digits, read in pieces.
///
/// # Errors
/// [`ShardError::File`] where it cannot be read.
pub fn hash_of(path: &Path) -> Result<String, ShardError> {
    let mut file = File::open(path).map_err(at(path))?;
    let (mut hash, mut buffer) = (FNV_OFFSET, vec![0; 1 << 16]);
    loop {
        let read = file.read(&mut buffer).map_err(at(path))?;
        if read == 0 {
            return Ok(format!("{hash:016x}"));
        }
        hash = fnv(hash, &buffer[..read]);
    }
}
