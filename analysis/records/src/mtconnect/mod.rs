//! Logs of machines that speak MTConnect, as records.
//!
//! ```text
//!  SHDR text ─► Lines ─► Session, cut where time goes back ─► MachineState at each change ─► events
//!                                                                   └► Run ─► stretches of its program
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`parse_shdr`], [`Lines`], [`Entry`], [`Passed`] | lines of an adapter, and what of them was passed over |
//! | [`sessions`], [`Session`], [`Role`] | connections of the adapter, and what its keys mean |
//! | [`states`], [`MachineState`] | what the machine did from instant to instant |
//! | [`events`] | the same as records |
//! | [`runs()`], [`Run`] | runs of programs, from start to completion |
//! | [`run_table()`] | runs of the table of the NIST test bed |
//! | [`summary()`] | what was read of a log, for people |
//! | [`whole`], [`stretches()`], [`Untimed`] | times of runs, and of the stretches of a part program in each run |
//!
//! ```
//! use toolroom_records::mtconnect::{events, parse_shdr, sessions};
//! let log = parse_shdr("2017-02-07T10:00:00Z|execution|READY\n2017-02-07T10:00:05Z|execution|ACTIVE|Fovr|50\n");
//! let records = events(&sessions("mill", &log, &[]), &[]);
//! // The end of the log is an event of its own.
//! assert_eq!(records.numbers("time"), Some(&[0.0, 5.0, 5.0][..]));
//! ```

mod events;
mod figures;
mod keys;
mod plateau;
mod run_table;
mod runs;
mod session;
mod shdr;
mod state;
mod stretches;
mod summary;
mod time;

pub use events::events;
pub use keys::{Role, RoleError};
pub use run_table::{RunTableError, run_table};
pub use runs::{Run, runs};
pub use session::{Session, sessions};
pub use shdr::{Entry, Lines, Passed, parse_shdr};
pub use state::{MachineState, UNAVAILABLE, states};
pub use stretches::{Untimed, stretches, whole};
pub use summary::summary;
