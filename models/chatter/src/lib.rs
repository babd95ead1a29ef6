//! Stability and vibration of turning and milling.
//!
//! A cut meets the surface that it left a tooth or a revolution ago, so its force depends on the
//! vibration now and then; a chuck of three jaws and an uneven allowance modulate it besides. This
//! crate says whether a cut is stable, by how much, how it becomes unstable and at what frequency;
//! how a stable cut vibrates and what surface it leaves; and how far an unstable one swings.
//!
//! ```text
//!  modes ──────────┐                      ┌─► StabilityVerdict ─► onset_time
//!  (tool, Bar)     ▼                      │   (radius, kind, frequency, margin)
//!  Cutter ──► Milling ─┬─► period map ────┼─► StabilityLimit, Boundary, Lobes
//!  Engagement          │   (collocation,  │
//!  MillingForce        │    Krylov), or    └─► Probability, RobustSpeed
//!                      │   characteristic
//!                      │   function
//!             Turning ─┤
//!                      ├─► forced: Fourier × frequency response ─► Forced
//!                      └─► simulate: loss of contact ─► Simulation ─► AmplitudeTable ─► LimitCycle
//!  paper::{Reduced, FiveDegrees} ─► Floquet multipliers (Magnus) ─► StabilityVerdict
//! ```
//!
//! | type | what it is |
//! |---|---|
//! | [`Mode`], [`Bar`] | a vibration mode; the mode of a bar in a chuck at the tool |
//! | [`Turning`] | exact limits and stable intervals, process damping, verdicts, speed variation |
//! | [`Milling`], [`AtSpeed`] | verdicts and limits by spectral collocation; helix, unequal pitch, runout |
//! | [`StabilityVerdict`], [`StabilityLimit`] | the answers: small, `Copy`, cheap to cache |
//! | [`StableIntervals`] | every depth at which a cut is stable, behind limit, margin and charts |
//! | [`Lobes`], [`Boundary`] | charts as plain data |
//! | [`Forced`], [`Simulation`], [`LimitCycle`] | vibration of stable and unstable cuts |
//! | [`CuttingLoad`] | torque, power, force and removal rate of a steady cut |
//! | [`Scatter`], [`Probability`], [`RobustSpeed`] | stability under uncertain constants |
//! | [`SpeedModes`], [`PathModes`] | modes that change with the spindle speed or along the path |
//! | [`SpeedVariation`] | sinusoidal spindle speed |
//! | [`paper`] | parametric stability in a three-jaw chuck |
//! | [`discretised`] | semi- and full discretisation, for cross-checks only |
//!
//! ```
//! use std::f64::consts::TAU;
//! use toolroom_chatter::{ChatterKind, Cutter, Direction, Engagement, Milling, MillingForce, Mode};
//! let cut = Milling {
//!     modes: vec![Mode::from_mass([1.0, 0.0], 922.0, 0.011, 0.03993)],
//!     cutter: Cutter::straight(2, 0.02),
//!     engagement: Engagement::new(0.05, Direction::Down).unwrap(),
//!     force: MillingForce::new(6e8, 2e8),
//!     feed_per_tooth: 0.1e-3,
//!     by_speed: None,
//!     along_path: None,
//! };
//! let limit = cut.at_speed(16000.0 / 60.0 * TAU).unwrap().limit(12e-3).unwrap();
//! assert!((limit.depth - 5.5176757e-3).abs() < 1e-9);
//! assert_eq!(limit.kind, ChatterKind::Flip);
//! ```
//!
//! # How good the numbers are
//! The displacement in cut is collocated at Gauss–Legendre nodes, with the exact response of the
//! modes between them and in free flight. At the nodes that are chosen the radius is good to 2e-7
//! in a verdict; in a chart point mostly to 1e-4, and to 4e-2 at worst where two multipliers are
//! nearly of one modulus. Whatever comes near 1 is computed again with more
//! nodes, so that of 10 000 scattered points none is judged wrongly against the dense eigenvalues
//! of a finer map (`examples/verdicts.rs`).
//!
//! Collocation converges faster than any power of the nodes: in the standard slot (two teeth,
//! 922 Hz, 5000 rpm, 0.5 mm; 1.073975587) the relative error is 9e-2, 5e-3, 3e-5 and 5e-8 with 20,
//! 24, 28 and 32 nodes. The discretisations of time converge with order 2 and are at 4e-3 and 2e-3
//! with 160 steps (`examples/convergence.rs`). Chebyshev nodes need about two more nodes for the
//! same error.
//!
//! The eigenvalue is found by Arnoldi's method and given only with a residual; an iteration that
//! does not converge is an error. The zeroth-order approximation is offered as a preview: at low
//! immersion it is unsafe by a factor of two.
//!
//! # What is not modelled
//! * Modes that change with the temperature; with spindle speed and place of the cut other than by tables ([`SpeedModes`],
//!   [`PathModes`]) and [`Bar`]'s.
//! * Force that is not linear in the chip in milling, size effect.
//! * Unequal pitch in the simulation of [`Milling`]; process damping in the amplitude of [`Turning`] from the table.
//! * Frequency responses without a modal fit; cross-coupled modes that are not symmetric.
//! * Runout in the linear verdict assumes the surfaces of the steady cut.
//! * A state-dependent delay, torsion of drills, boring bars with dampers.
//! * Amplitudes of milling chatter without a simulation: [`Milling::limit_cycle`] runs a short one.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod amplitude;
mod axis;
mod boundary;
mod claims;
pub mod discretised;
mod error;
mod intervals;
mod lobes;
mod milling;
pub mod paper;
mod path;
mod period;
mod places;
mod plan;
mod response;
mod rows;
mod shares;
mod simulate;
mod speed_variation;
mod speeds;
mod structure;
mod turning;
mod uncertainty;
mod verdict;

pub use amplitude::{AmplitudeTable, LimitCycle, arithmetic_roughness, indentation_coefficient};
pub use axis::Axis;
pub use boundary::{Boundary, BoundaryColumn, BoundaryCurve, BoundaryHole};
pub use claims::claims;
pub use error::ChatterError;
pub use intervals::{Certificate, Crossing, StableIntervals};
pub use lobes::{Hole, Lobes};
pub use milling::{
    AtSpeed, Cutter, CuttingLoad, Direction, Engagement, Forced, Milling, MillingForce, Response, Roughness, Sampling,
    WorstPhase,
};
pub use path::PathModes;
pub use simulate::{SETTLED, Settled, Simulation, SimulationSettings};
pub use speed_variation::SpeedVariation;
pub use speeds::SpeedModes;
pub use structure::Mode;
pub use turning::{Bar, Support, Turning};
pub use uncertainty::{Draw, Probability, RobustSpeed, Scatter};
pub use verdict::{ChatterKind, StabilityLimit, StabilityVerdict};
