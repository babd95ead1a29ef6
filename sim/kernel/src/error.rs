use super::SimTime;
use thiserror::Error;

/// What the kernel refuses.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[non_exhaustive]
pub enum KernelError {
    /// A time that is not a number, infinite or negative.
    #[error("a time must be finite and not negative, got {seconds} s")]
    InvalidTime {
        /// The offending value.
        seconds: f64,
    },
    /// A duration that is not a number, infinite or negative.
    #[error("a duration must be finite and not negative, got {seconds} s")]
    InvalidDuration {
        /// The offending value.
        seconds: f64,
    },
    /// An event before the time of the last popped event.
    #[error("cannot schedule at {at} ({} s), the clock already shows {now} ({} s)", at.seconds(), now.seconds())]
    InThePast {
        /// The requested time.
        at: SimTime,
        /// The time of the calendar.
        now: SimTime,
    },
    /// As many events pending as a packed key can number.
    #[error("{pending} events are pending: a calendar cannot hold more")]
    Full {
        /// Number of pending events.
        pending: usize,
    },
}
