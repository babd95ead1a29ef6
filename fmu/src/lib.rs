//! Cutting processes as units of the Functional Mock-up Interface, versions 2.0 and 3.0.
//!
//! Any [`Process`](toolroom_process::Process) becomes a unit for Co-Simulation and, where it is
//! an ordinary differential equation, for Model Exchange. Variables, units, ranges, start values
//! and both model descriptions come from its records; which output depends on which input is
//! found by trying. One shared library holds every unit: the instantiation token says which one
//! is meant.
//!
//! ```text
//!   Process + Unit (names, sets, renewals)
//!        │
//!        ├─► Variable, Description ──► modelDescription.xml 2.0 and 3.0, terminals, documentation
//!        │                                                        │
//!        └─► Instance<U> (state, parameters, events, saved states)│──► package: F.fmu
//!                 │ Component                                     │
//!            C interfaces: 44 + 75 functions ──► shared library ──┘
//! ```
//!
//! | type | what it is |
//! |---|---|
//! | [`units`], [`Entry`] | the units that are shipped |
//! | [`Unit`], [`Renewal`], [`AdaptivePolicy`], [`TurningMachine`], [`MillingMachine`] | what a process adds to be shipped |
//! | [`Instance`], [`Component`] | one instance, typed and by trait object |
//! | [`Interface`], [`Mode`], [`Status`], [`Fault`] | what it serves, where it is, what it answers |
//! | [`Variable`], [`Slot`], [`Role`], [`ValueType`] | the variables and their value references |
//! | [`Description`], [`Dependencies`] | what the package says |
//! | [`package()`], [`Platform`], [`Binary`] | the file that importers open |
//! | [`archive`], [`Xml`], [`parameter_values`] | parts of other packages that hold units |
//! | [`Sources`], [`Compiler`] | the shared library for this platform and others |
//!
//! ```
//! use toolroom_fmu::{Interface, Log, Slot, ValueType, units};
//! let turning = units().find(|unit| unit.name == "turning").unwrap();
//! let wear = turning.describe().variables.iter().find(|each| each.name == "process.flank_wear").unwrap();
//! let held = Interface::CoSimulation { event_mode: false, early_return: false };
//! let mut unit = turning.instantiate(held, None, Log::new(None, false));
//! unit.enter_initialization().unwrap();
//! unit.exit_initialization().unwrap();
//! unit.do_step(0.0, 600.0).unwrap();
//! let mut value = [0.0];
//! unit.read(ValueType::Real, &[wear.slot.reference()], &mut value).unwrap();
//! assert!((value[0] - 0.290762e-3).abs() < 1e-9);
//! ```
//!
//! # What is not modelled
//! Scheduled Execution, clocks, intermediate update, interpolation of inputs (they are held over
//! a step), binary variables, source code units. Logging is the importer's. A unit has no access
//! to network, files (but its own resources) or threads.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]
#![deny(unsafe_code)]

mod abi;
mod catalogue;
mod component;
mod configured;
mod cross;
mod description;
mod fault;
mod instance;
mod libraries;
mod log;
mod mode;
mod package;
mod unit;
mod units;
mod variable;

pub use catalogue::{Entry, units};
pub use component::{Component, Interface, StepResult, Update};
pub use configured::parameter_values;
pub use cross::{Compiler, CrossError};
pub use description::{Attributes, Dependencies, Description, Xml, unit_powers};
pub use fault::{Fault, Outcome};
pub use instance::Instance;
pub use libraries::{LibraryError, Sources, library_beside_program, library_of_folder};
pub use log::{Category, Log, Sink, Status};
pub use mode::Mode;
pub use package::{
    Binary, OwnSet, OwnSetError, PackageError, Platform, Version, archive, file_name, own_set, package,
    package_without_enumerations,
};
pub use unit::{AdaptivePolicy, Renewal, Unit};
pub use units::{MillingMachine, TurningMachine};
pub use variable::{Role, Slot, ValueType, Variable, variables};

#[cfg(test)]
mod tests;
