//! The bound of memory: half of the machine, or what the user says.

use std::fs;

/// Memory of this machine that the process may take at most by default.
const SHARE: u64 = 2;

/// The bound of a text such as `4 GB`, `500 MB` or `25 %` of the machine, in bytes.
///
/// ```
/// assert_eq!(toolroom_output::memory::bound("1.5 GB"), Ok(1_500_000_000));
/// assert_eq!(toolroom_output::memory::bound("512MiB"), Ok(512 << 20));
/// assert!(toolroom_output::memory::bound("4").is_err());
/// ```
///
/// # Errors
/// In words: no number above zero, no unit, or a share of a machine whose memory is not told.
pub fn bound(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let end = text.find(|c: char| !(c.is_ascii_digit() || c == '.')).unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let number: f64 = number.parse().map_err(|_| "a number with its unit is due, such as \"4 GB\"".to_owned())?;
    let scale = match unit.trim() {
        "kB" | "KB" => 1e3,
        "MB" => 1e6,
        "GB" => 1e9,
        "TB" => 1e12,
        "KiB" => 1024.0,
        "MiB" => 1024.0 * 1024.0,
        "GiB" => 1024.0 * 1024.0 * 1024.0,
        "%" => machine().ok_or("the memory of this machine is not told: give it in GB")? as f64 / 100.0,
        _ => return Err("the unit is one of kB, MB, GB, TB, KiB, MiB, GiB and %".to_owned()),
    };
    let bytes = number * scale;
    if bytes >= 1.0 && bytes.is_finite() { Ok(bytes as u64) } else { Err("the bound is above zero".to_owned()) }
}

/// Half of the machine, where the system tells it.
pub fn default_bound() -> Option<u64> {
    Some(machine()? / SHARE)
}

/// Memory of the machine or of the container that it is, bytes; Linux only.
fn machine() -> Option<u64> {
    let whole = kilobytes(&fs::read_to_string("/proc/meminfo").ok()?, "MemTotal:")?;
    let container = fs::read_to_string("/sys/fs/cgroup/memory.max").ok().and_then(|text| text.trim().parse().ok());
    Some(container.map_or(whole, |most: u64| most.min(whole)))
}

/// Memory that this process has now, bytes; Linux only.
pub(crate) fn resident() -> Option<u64> {
    kilobytes(&fs::read_to_string("/proc/self/status").ok()?, "VmRSS:")
}

/// The value of a line `NAME 1234 kB`, bytes.
fn kilobytes(text: &str, name: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}

/// Bytes for people.
pub(crate) fn shown(bytes: u64) -> String {
    format!("{:.3} GB", bytes as f64 / 1e9)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_has_a_unit_and_is_above_zero() {
        for (text, bytes) in [("2 GB", Some(2_000_000_000)), ("0.5GiB", Some(1 << 29)), ("0 GB", None), ("-1 GB", None)]
        {
            assert_eq!(bound(text).ok(), bytes, "{text}");
        }
        assert!(bound("3 EUR").is_err_and(|text| text.contains("GiB")));
    }

    #[test]
    fn what_the_system_tells_is_read() {
        assert_eq!(kilobytes("Name:\tx\nVmRSS:\t    2048 kB\n", "VmRSS:"), Some(2 << 20));
        assert_eq!(kilobytes("nothing", "VmRSS:"), None);
    }
}
