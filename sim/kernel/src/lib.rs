//! Clock, calendar, random streams and replay digest: no shop, no physics.
//!
//! | item | what it is |
//! |---|---|
//! | [`SimTime`] | seconds since the start: finite, not negative, totally ordered |
//! | [`Calendar`], [`Class`], [`EventKey`] | pending events in the order (time, class, sequence), with cancellation |
//! | [`Agenda`] | the same for numbered events that are never cancelled |
//! | [`Streams`], [`Entity`], [`Purpose`] | the same entity draws the same numbers under every policy and thread count |
//! | [`Digest`] | two runs with equal digests went through the same events at the same times |
//! | [`KernelError`] | what the kernel refuses |
//!
//! # Event order
//! All events of one instant are settled before anything is decided at that instant, so that a
//! decision never depends on which of two simultaneous events was scheduled first:
//!
//! ```text
//! while the calendar holds an event:
//!     (now, class) = time and class of the earliest event
//!     if class is Observe:            nothing else is due now: sample, log
//!         observe(pop)
//!     else:
//!         while an event before Observe is due at now, also one scheduled just now:
//!             settle(pop)             finish, failure < move < arrive < shift < dispatch request
//!         dispatch(now)               every idle machine chooses; ties by arrival time, then job
//! ```
//!
//! An operation of zero length puts a new event into the same instant; the loop then settles and
//! dispatches once more before the observers see that instant.
//!
//! ```
//! use toolroom_kernel::{Calendar, Class, SimTime};
//! #[derive(Clone, Copy, PartialEq, Debug)]
//! enum Event { Arrive, Finish, Sample }
//!
//! let mut calendar = Calendar::new();
//! let noon = SimTime::from_seconds(43_200.0)?;
//! calendar.schedule(noon, Class::Observe, Event::Sample)?;
//! calendar.schedule(noon, Class::Arrive, Event::Arrive)?;
//! calendar.schedule(noon, Class::Finish, Event::Finish)?;
//!
//! let mut seen = Vec::new();
//! while let Some((now, class)) = calendar.peek() {
//!     if class == Class::Observe {
//!         seen.extend(calendar.pop().map(|(_, event)| event));
//!         continue;
//!     }
//!     while let Some(event) = calendar.pop_before(now, Class::Observe) {
//!         seen.push(event); // settle
//!     }
//!     // dispatch every idle machine here
//! }
//! assert_eq!(seen, [Event::Finish, Event::Arrive, Event::Sample]);
//! # Ok::<(), toolroom_kernel::KernelError>(())
//! ```
//!
//! # What is not modelled
//! Time has no calendar date, no time zone and no leap seconds. Events of one instant have no
//! finer order than class and order of scheduling. One run is one thread; replications run side by
//! side.

#![deny(clippy::wildcard_enum_match_arm)]

mod agenda;
mod calendar;
mod digest;
mod error;
mod heap;
mod streams;
mod time;

pub use agenda::Agenda;
pub use calendar::{Calendar, Class, EventKey};
pub use digest::Digest;
pub use error::KernelError;
pub use streams::{Entity, Purpose, Stream, Streams};
pub use time::SimTime;
