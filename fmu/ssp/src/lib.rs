//! Systems of FMI units as packages of the standard SSP (System Structure and Parameterization): read, and simulated by
//! a master of our own.
//!
//! ```text
//!   F.ssp ──► Package ──► SystemStructure: components, connections, start values
//!                │                 │
//!                └──► units ───────┴──► System (feature fmi): Jacobi or Gauss–Seidel, a table of outputs
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Package`] | a `.ssp` file with its structure |
//! | [`SystemStructure`], [`Component`], [`Connection`] | what a system is made of, nested systems resolved |
//! | [`Parameter`] | a start value of a `.ssv` file or of the structure itself |
//! | `System`, `Order` | with the feature `fmi`: the units loaded and connected, and the order in which they step |
//!
//! # What is not modelled
//! Mappings of parameters (`.ssm`), signal dictionaries, packages and structures as components, transformations of
//! Booleans, integers and enumerations, signals that are strings, steps of variable length, iteration over algebraic
//! loops between units after the start.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod edges;
#[cfg(feature = "fmi")]
mod error;
mod listing;
#[cfg(feature = "fmi")]
mod loops;
#[cfg(feature = "fmi")]
mod master;
mod package;
mod read;
mod structure;
mod values;
#[cfg(feature = "fmi")]
mod wires;

#[cfg(feature = "fmi")]
pub use error::MasterError;
#[cfg(feature = "fmi")]
pub use loops::Loop;
#[cfg(feature = "fmi")]
pub use master::{Experiment, Order, System};
pub use package::{Package, STRUCTURE, SspError};
pub use read::Fault;
pub use structure::{Boundary, Component, Connection, Connector, End, SystemStructure};
pub use values::Parameter;
