//! Hashes that tell contents apart; they prove nothing against malice.

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
