//! Published and reference numbers, each with its origin.
//!
//! Origin unless said otherwise: independent reference implementation in Python of the same
//! equations (millimetres, minutes, revolutions), printed with six significant digits. A number
//! agrees when it prints the same.

mod fixture;
mod mechanics;
mod path;
mod plans;
mod separability;
