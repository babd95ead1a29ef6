//! FMI units of others: looked into, checked against what importers trip over, and driven as
//! machines of the shop.
//!
//! ```text
//!   F.fmu ──► Archive ──► ModelDescription ──► check: findings by rule
//!               │                │
//!               ├──► Binary ─────┘
//!               │                                       ┌──► simulate: a table of outputs
//!               └──► Unit (library) ──► Instance (calls)┤
//!                    with feature fmi                   └──► UnitProcess: MachineProcess of the shop
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Archive`], [`Entry`] | the zip file, never unpacked outside its folder |
//! | [`ModelDescription`], [`Variable`] | what a unit says about itself, FMI 2.0 and 3.0 |
//! | [`Platform`], [`Binary`] | for which platforms it has a library, and what that library hands out |
//! | [`check::check`], [`check::Finding`] | the rules behind failures that users of FMI report |
//! | `Unit`, `Instance`, `Port` | with the feature `fmi`: a loaded unit, one instance, one variable of it |
//! | `UnitProcess`, `wire::Wires` | with the feature `fmi`: a unit in the place of a native process, in SI |
//! | `simulate::simulate` | with the feature `fmi`: a unit by itself |
//!
//! ```
//! use toolroom_fmu_import::ModelDescription;
//! let reading = ModelDescription::read("<fmiModelDescription fmiVersion='1.0'/>");
//! assert!(reading.faults[0].message.contains("2.0 and 3.0 are"));
//! ```
//!
//! # What is not modelled
//! FMI 1.0, Scheduled Execution, clocks, binary variables and arrays as ports of a machine,
//! source-code units, layered standards.

pub mod archive;
pub mod check;
pub mod description;
#[cfg(feature = "fmi")]
pub mod instance;
#[cfg(feature = "fmi")]
mod keeping;
#[cfg(feature = "fmi")]
pub mod machine;
pub mod platform;
#[cfg(feature = "fmi")]
pub mod simulate;
#[cfg(feature = "fmi")]
pub mod unit;
#[cfg(feature = "fmi")]
pub mod wire;

pub use archive::{Archive, ArchiveError, Entry};
pub use description::{Interface, ModelDescription, Reading, ValueType, Variable};
pub use platform::{Binary, PLATFORMS, Platform};
#[cfg(feature = "fmi")]
pub use {
    instance::{CallError, Instance, Port, StartValue},
    machine::UnitProcess,
    unit::{LoadError, Unit},
    wire::WiringError,
};
