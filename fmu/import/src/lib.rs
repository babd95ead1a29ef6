//! FMI units of others: looked into, checked against what importers trip over, and driven as
//! machines of the shop.
//!
//! ```text
//!   F.fmu ──► Archive ──► ModelDescription ──► check: findings by rule
//!               │                │
//!               ├──► Binary ─────┘
//!               │                                       ┌──► simulate: a table of outputs
//!               └──► Unit ──► Instance (actions) ───────┤
//!                      │  with feature fmi              └──► UnitProcess: MachineProcess of the shop
//!                      └──► worker: its code in other processes
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Archive`], [`Entry`] | the zip file, never unpacked outside its folder |
//! | [`ModelDescription`], [`Variable`] | what a unit says about itself, FMI 2.0 and 3.0 |
//! | [`Platform`], [`Binary`] | for which platforms it has a library, and what that library hands out |
//! | [`check::check`], [`check::Finding`] | the rules behind failures that users of FMI report |
//! | `Unit`, `Instance`, `Port` | with the feature `fmi`: a loaded unit, of Co-Simulation or Model Exchange, one instance, one variable of it |
//! | `UnitProcess`, `wire::Wires` | with the feature `fmi`: a unit in the place of a native process, in SI |
//! | `Isolation`, `worker::serve` | with the feature `fmi`: where the code of a unit runs |
//! | `register`, `register_program` | with the feature `fmi`: lets scenarios name units in the place of processes |
//! | `simulate::simulate` | with the feature `fmi`: a unit by itself |
//!
//! ```
//! use toolroom_fmu_import::ModelDescription;
//! let reading = ModelDescription::read("<fmiModelDescription fmiVersion='1.0'/>");
//! assert!(reading.faults[0].message.contains("2.0 and 3.0 are"));
//! ```
//!
//! # What is not modelled
//! FMI 1.0, Scheduled Execution, clocks, binary variables, arrays as ports of a machine, stiff equations
//! of Model Exchange (the integrator is explicit), source-code units, layered standards.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

pub mod archive;
pub mod check;
pub mod description;
#[cfg(feature = "fmi")]
mod halving;
#[cfg(feature = "fmi")]
mod importer;
#[cfg(feature = "fmi")]
mod inputs;
#[cfg(feature = "fmi")]
pub mod instance;
#[cfg(feature = "fmi")]
mod keeping;
mod listing;
#[cfg(feature = "fmi")]
pub mod machine;
#[cfg(feature = "fmi")]
mod notes;
#[cfg(feature = "fmi")]
pub mod parts;
pub mod platform;
#[cfg(feature = "fmi")]
pub mod simulate;
#[cfg(feature = "fmi")]
pub mod unit;
#[cfg(feature = "fmi")]
mod watch;
#[cfg(feature = "fmi")]
pub mod wire;
#[cfg(all(feature = "fmi", unix))]
pub mod worker;
pub mod xml;

pub use archive::{Archive, ArchiveError, Entry};
pub use description::{Dimension, Interface, ModelDescription, Reading, ValueType, Variable};
pub use platform::{Binary, PLATFORMS, Platform};
#[cfg(feature = "fmi")]
pub use {
    importer::{register, register_program},
    instance::{Action, Answer, CallError, Instance, Port, StartValue, StepResult},
    machine::UnitProcess,
    parts::Retaking,
    unit::{CALL_LIMIT, Driven, Isolation, LoadError, Steps, Unit, WorkerProgram},
    wire::WiringError,
};
