//! Clock, calendar, random streams and replay digest: no shop, no physics.

mod calendar;
mod digest;
mod error;
mod streams;
mod time;

pub use calendar::{Calendar, Class, EventKey};
pub use digest::Digest;
pub use error::KernelError;
pub use streams::{Entity, Purpose, Stream, Streams};
pub use time::SimTime;
