//! Questions that are planned before chips fly, worked out from a file of the user's.
//!
//! | module | what it does |
//! |---|---|
//! | [`contour`] | how the gains of a planned contour move with the conditions |
//! | [`lobes`] | stability charts: what is cut, verdicts at points and over a grid, boundaries |
//!
//! # What is not modelled
//! Pictures and reports are made by the command line from what stands here.

pub mod contour;
pub mod lobes;
