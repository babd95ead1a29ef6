use super::KernelError;
use serde::{Deserialize, Serialize};
use std::cmp::Ordering;
use std::fmt;
use std::hash::{Hash, Hasher};
use std::ops::Sub;

/// Seconds since the start of the run: finite, not negative, totally ordered.
///
/// For such numbers the order of the values is the order of their bit patterns, so comparing,
/// hashing and packing into a key use the bits. Negative zero becomes zero.
///
/// # Examples
/// ```
/// use toolroom_kernel::SimTime;
/// let start = SimTime::from_seconds(3600.0)?;
/// let end = start.after(61.5)?;
/// assert_eq!(end - start, 61.5);
/// assert_eq!(format!("{end} {end:.1}"), "1:01:02 1:01:01.5");
/// # Ok::<(), toolroom_kernel::KernelError>(())
/// ```
#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize)]
#[serde(try_from = "f64", into = "f64")]
pub struct SimTime(f64);

impl SimTime {
    /// The start of the run.
    pub const ZERO: Self = Self(0.0);

    /// A time \[s\] after the start.
    ///
    /// # Errors
    /// [`KernelError::InvalidTime`] if `seconds` is not a number, infinite or negative.
    #[inline]
    pub fn from_seconds(seconds: f64) -> Result<Self, KernelError> {
        if is_finite_and_not_negative(seconds) {
            Ok(Self(seconds + 0.0)) // -0.0 + 0.0 is +0.0
        } else {
            Err(KernelError::InvalidTime { seconds })
        }
    }

    /// `self + duration`, the duration in seconds.
    ///
    /// # Errors
    /// [`KernelError::InvalidDuration`] if `duration` is not a number, infinite or negative,
    /// [`KernelError::InvalidTime`] if the sum overflows.
    #[inline]
    pub fn after(self, duration: f64) -> Result<Self, KernelError> {
        if is_finite_and_not_negative(duration) {
            Self::from_seconds(self.0 + duration)
        } else {
            Err(KernelError::InvalidDuration { seconds: duration })
        }
    }

    /// Seconds since the start.
    #[inline]
    #[must_use]
    pub fn seconds(self) -> f64 {
        self.0
    }

    /// The bit pattern; its top bit is zero and its order is the order of the times.
    #[inline]
    #[must_use]
    pub fn to_bits(self) -> u64 {
        self.0.to_bits()
    }

    /// The inverse of [`SimTime::to_bits`], for patterns that came from there.
    #[inline]
    pub(super) fn from_own_bits(bits: u64) -> Self {
        Self(f64::from_bits(bits))
    }
}

#[inline]
fn is_finite_and_not_negative(seconds: f64) -> bool {
    (0.0..=f64::MAX).contains(&seconds)
}

/// Signed difference in seconds.
impl Sub for SimTime {
    type Output = f64;

    #[inline]
    fn sub(self, earlier: Self) -> f64 {
        self.0 - earlier.0
    }
}

impl PartialEq for SimTime {
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        self.to_bits() == other.to_bits()
    }
}

impl Eq for SimTime {}

impl PartialOrd for SimTime {
    #[inline]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for SimTime {
    #[inline]
    fn cmp(&self, other: &Self) -> Ordering {
        self.to_bits().cmp(&other.to_bits())
    }
}

impl Hash for SimTime {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.to_bits().hash(state);
    }
}

impl TryFrom<f64> for SimTime {
    type Error = KernelError;

    fn try_from(seconds: f64) -> Result<Self, KernelError> {
        Self::from_seconds(seconds)
    }
}

impl From<SimTime> for f64 {
    fn from(time: SimTime) -> f64 {
        time.0
    }
}

/// `h:mm:ss`, rounded to the second; a precision adds decimals of the second (at most nine).
impl fmt::Display for SimTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Beyond 2^53 nanoseconds a decimal means nothing more, and rounding it could overflow.
        let decimals = if self.0 < 9e6 { f.precision().unwrap_or(0).min(9) } else { 0 };
        let per_second = 10f64.powi(decimals as i32);
        let ticks = (self.0 * per_second).round();
        let whole = (ticks / per_second).floor();
        let hours = (whole / 3600.0).floor();
        let within_hour = (whole % 3600.0) as u32;
        write!(f, "{hours:.0}:{:02}:{:02}", within_hour / 60, within_hour % 60)?;
        if decimals > 0 {
            write!(f, ".{:0decimals$}", (ticks - whole * per_second) as u64)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: f64) -> SimTime {
        SimTime::from_seconds(seconds).unwrap()
    }

    #[test]
    fn impossible_times_are_refused() {
        for seconds in [f64::NAN, -1.0, -f64::MIN_POSITIVE, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(matches!(SimTime::from_seconds(seconds), Err(KernelError::InvalidTime { .. })), "{seconds}");
            assert!(matches!(at(1.0).after(seconds), Err(KernelError::InvalidDuration { .. })), "{seconds}");
        }
        assert!(matches!(at(f64::MAX).after(f64::MAX), Err(KernelError::InvalidTime { .. })));
    }

    #[test]
    fn negative_zero_is_zero() {
        assert_eq!(at(-0.0).to_bits(), 0);
        assert_eq!(at(0.0).after(-0.0).unwrap(), SimTime::ZERO);
    }

    #[test]
    fn order_of_bits_is_order_of_values() {
        let ascending = [0.0, f64::from_bits(1), f64::MIN_POSITIVE, 1.0, 1.0 + f64::EPSILON, 1e9, f64::MAX];
        assert!(ascending.windows(2).all(|pair| at(pair[0]) < at(pair[1])));
        assert!(ascending.iter().all(|&s| SimTime::from_own_bits(at(s).to_bits()).seconds() == s));
    }

    #[test]
    fn display_carries_over_to_minutes_and_hours() {
        assert_eq!(at(0.0).to_string(), "0:00:00");
        assert_eq!(at(59.4).to_string(), "0:00:59");
        assert_eq!(at(3599.5).to_string(), "1:00:00");
        assert_eq!(at(360_000.0).to_string(), "100:00:00");
        assert_eq!(format!("{:.3}", at(61.0625)), "0:01:01.063");
        assert_eq!(format!("{:.3}", at(59.9999)), "0:01:00.000");
        assert_eq!(format!("{:.3}", at(1e12)), "277777777:46:40");
    }
}
