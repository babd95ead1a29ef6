//! Logs of machines that speak MTConnect, as records.
//!
//! ```text
//!  SHDR text ─► Lines ─► Session, cut where time goes back ─► MachineState at each change ─► events
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`parse_shdr`], [`Lines`], [`Entry`], [`Passed`] | lines of an adapter, and what of them was passed over |
//! | [`sessions`], [`Session`], [`Role`] | connections of the adapter, and what its keys mean |
//! | [`states`], [`MachineState`] | what the machine did from instant to instant |
//! | [`events`] | the same as records |
//!
//! ```
//! use toolroom_analysis::mtconnect::{events, parse_shdr, sessions};
//! let log = parse_shdr("2017-02-07T10:00:00Z|execution|READY\n2017-02-07T10:00:05Z|execution|ACTIVE|Fovr|50\n");
//! let records = events(&sessions("mill", &log, &[]));
//! assert_eq!(records.numbers("time"), Some(&[0.0, 5.0][..]));
//! ```

mod events;
mod keys;
mod session;
mod shdr;
mod state;
mod time;

pub use events::events;
pub use keys::Role;
pub use session::{Session, sessions};
pub use shdr::{Entry, Lines, Passed, parse_shdr};
pub use state::{MachineState, UNAVAILABLE, states};
