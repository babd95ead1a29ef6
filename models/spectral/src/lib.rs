//! Numerics under questions of stability; it knows no cut and no structure.
//!
//! | type or function | what it is |
//! |---|---|
//! | [`Rule`] | Gauss–Legendre nodes on 0 … 1 with weights, integration and interpolation |
//! | [`LinearMap`], [`Krylov`], [`Dominant`] | the eigenvalue of greatest modulus of a map, by Arnoldi's method |
//! | [`dense_eigenvalues`], [`dense_dominant`] | all eigenvalues of a matrix, or the greatest of them |
//! | [`Factors`], [`subtract_columns`], [`subtract`], [`dot`] | dense factors and products in storage that is kept |
//! | [`Root`], [`least_root`] | the root of least modulus of a polynomial, proved to be the least |
//! | [`brackets`], [`root`] | sign changes of a function of even samples, and a root between two of them |
//! | [`SignChanges`], [`may_reach_zero`] | sign changes of a function that may come back to zero between samples |
//!
//! A search that finds nothing is an error of the caller's kind: functions that are searched return their own errors, and
//! [`NotConverged`] is that of an iteration.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod crossing;
mod factor;
mod gauss;
mod hessenberg;
mod krylov;
mod polynomial;
mod scan;

pub use crossing::{brackets, root};
pub use factor::{Factors, subtract_columns};
pub use gauss::{MAX_NODES, Rule};
pub use krylov::{Dominant, Krylov, LinearMap, NotConverged, dense_dominant, dense_eigenvalues, dot, subtract};
pub use polynomial::{Root, least_root};
pub use scan::{Around, STEPS, Sample, SignChanges, may_reach_zero};
