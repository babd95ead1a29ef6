//! The machining shop: an event kernel, scenarios, cutting-speed policies and the log of a run.
//!
//! ```text
//!   scenario file ──read──► Scenario ──────────────┬──────────────► ResolvedPolicy
//!                                                  │                 (a Controller a pass)
//!   (seed, replication)                            │                        │ speed, edge change
//!          │                                       ▼                        ▼
//!     ┌────▼────┐  draws   ┌───────────────────────────────────────────────────┐   ┌────────────────┐
//!     │ Streams ├─────────►│ Shop: World (jobs, machines, edges) + Calendar    │◄─►│ MachineProcess │
//!     └─────────┘          │ settle every event of an instant, then dispatch   │   │ turning, …     │
//!                          └───────┬───────────────────────────┬───────────────┘   └────────────────┘
//!                                  ▼                           ▼
//!                               RunLog                      Digest
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Scenario`], [`scenario`] | what is simulated, in SI and by index; read from a file |
//! | [`Shop`], [`shop::run`] | one replication under one policy |
//! | [`RunLog`] | its tables: passes, edges, jobs, machine states, events |
//! | [`ResolvedPolicy`], [`Controller`], [`policy`] | who chooses the speed and when an edge is changed |
//! | [`SimTime`] | seconds since the start: finite, not negative, totally ordered |
//! | [`Calendar`], [`Class`], [`EventKey`] | pending events in the order (time, class, sequence), with cancellation |
//! | [`Streams`], [`Entity`], [`Purpose`] | the same entity draws the same numbers under every policy and thread count |
//! | [`Digest`] | two runs with equal digests went through the same events at the same times |
//! | [`effects::SHOP_EFFECTS`] | catalogue rows of what a shop does beside its nominal simulation |
//! | [`ShopError`], [`KernelError`] | why a run stopped, what the kernel refuses |
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
//! use toolroom_sim::{Calendar, Class, SimTime};
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
//! # Ok::<(), toolroom_sim::KernelError>(())
//! ```
//!
//! # What is not modelled
//! What the shop leaves out is listed in [`shop`], what controllers leave out in [`policy`].
//! Time has no calendar date, no time zone and no leap seconds. Events of one instant have no
//! finer order than class and order of scheduling. One run is one thread; replications run side by
//! side.

pub mod effects;
pub mod kernel;
pub mod policy;
pub mod runlog;
pub mod scenario;
pub mod shop;

pub use kernel::{Calendar, Class, Digest, Entity, EventKey, KernelError, Purpose, SimTime, Stream, Streams};
pub use policy::{Controller, ResolvedPolicy};
pub use runlog::RunLog;
pub use scenario::Scenario;
pub use shop::{Shop, ShopError};
