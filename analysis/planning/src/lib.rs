//! Questions that are planned before chips fly, worked out from a file of the user's.
//!
//! | module | what it does |
//! |---|---|
//! | [`coefficients`] | cutting-force coefficients from mean forces, or of a group of work materials |
//! | [`contour`] | plans along a contour, and how their gains move with the conditions |
//! | [`cycle`] | the fastest grinding cycle within limits, and when to dress |
//! | [`engagement`] | a part program through its stock: engagement, air, power and force by tool |
//! | [`identification`] | lag and stiffnesses of a grinder from trials |
//! | [`listen`] | whether a recorded cut chatters, and at which speeds it would not |
//! | [`lobes`] | stability charts: what is cut, verdicts at points and over a grid, boundaries |
//! | [`point`] | every output of a process at one operating point, or at many |
//! | [`program`] | the nominal cycle time of a part program, by tool and by block |
//!
//! A study hands out text for a terminal, JSON for programs, and its files: tables, pictures and the report. It
//! writes nothing by itself.

#![deny(clippy::wildcard_enum_match_arm)]

mod change;
mod codes;
pub mod coefficients;
pub mod contour;
pub mod cycle;
pub mod engagement;
pub mod explain;
pub mod feeds;
pub mod folders;
pub mod identification;
pub mod listen;
pub mod lobes;
pub mod motions;
mod plane;
pub mod point;
pub mod program;
mod tables;

pub use change::ChangeError;
pub use codes::CODES;
