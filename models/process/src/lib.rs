//! The contract between a machining process model and whoever drives it.
//!
//! A process is an immutable value; everything that changes is a flat record of SI numbers;
//! whoever holds the record drives the process: the shop by events, an FMU by communication
//! steps, the gap diagnosis by recorded inputs.
//!
//! ```text
//!   parameters, effects            input (held)
//!          │                            │
//!      ┌───▼────────────────────────────▼───┐
//!      │ Process: initial, output, advance, │──► Advance { elapsed, event }
//!      │          derivative, indicators    │──► output
//!      └───▲────────────────────────────┬───┘
//!          └────────── state ◄──────────┘
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Record`], [`record!`], [`Field`] | a flat list of numbers that carries name, unit, range and meaning of each |
//! | [`Process`], [`Advance`], [`ProcessEvent`] | the typed contract |
//! | [`MachineProcess`] | the same by element index, for native models and imported units alike |
//! | [`Wiring`] | how an imported unit stands in for a native process |
//! | [`Number`] | `f64` or a dual number: equations are written once |
//! | [`refuse`], [`watched`] | how an equation that gives numbers refuses a value, and how whoever drives the model learns of it |
//! | [`mod@unit`] | `"60 m/min"` to SI and back |
//! | [`ode`] | Runge–Kutta 4, Dormand–Prince 5(4), event location |
//! | [`table`] | the one writer of CSV files, and the check of their quotes |
//! | [`parameters`] | named parameter sets with units and sources |
//! | [`contract`], [`process_contract!`] | the tests that every process passes |
//!
//! ```
//! use toolroom_process::ode::{Tolerance, integrate};
//! // Wear grows with the square root of time: 0.3 mm after 9 minutes.
//! let rate = |_: f64, vb: &[f64; 1]| [0.005 / vb[0].max(1e-6)];
//! let tolerance = Tolerance { relative: 1e-8, absolute: [1e-10] };
//! let end = integrate(rate, |_, vb| [vb[0] - 0.3], &[1e-6], 100.0, &tolerance).unwrap();
//! assert!((end.time - 9.0).abs() < 1e-4);
//! ```
//!
//! # What is not modelled
//! Nothing is: this crate holds no physics. Stiff systems are refused by [`ode::integrate`]
//! rather than solved slowly.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod claim;
pub mod contract;
mod error;
mod field;
mod number;
pub mod ode;
pub mod parameters;
mod process;
mod record;
mod refusal;
pub mod table;
pub mod unit;
mod wiring;

pub use claim::Claim;
pub use error::{EffectValue, ModelError};
pub use field::{Field, Kind};
pub use num_dual;
pub use number::Number;
pub use process::{Advance, MachineProcess, Process, ProcessEvent};
#[doc(hidden)]
pub use record::Slots;
pub use record::{AnyRecord, Record};
pub use refusal::{refuse, watched};
pub use wiring::{UnitIsolation, Wiring};
