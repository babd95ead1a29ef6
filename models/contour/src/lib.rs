//! Contour milling: what an end mill does along a contour of lines, arcs and splines, and the
//! spindle speeds and feeds that mill it in the least time or at the least cost.
//!
//! The wall's curvature decides how much of the cutter is engaged, hence force, deflection, life
//! and roughness; the drives add their own error on arcs. A planner turns twelve limits on those
//! into admissible settings for every section and chooses among them by dynamic programming.
//!
//! ```text
//!  contour file, G-code ──► Contour ──┐
//!  parameter set ──► Parameters ──────┤          engagement ─► forces ─► deflection, form
//!  Pass, Models ──────────────────────┴► Planner    │    └──► life, power, strength, roughness
//!                                          │        └ path error of the drives, corners
//!              handbook, best constant ◄───┤
//!              optimal, ramps, edge life ◄─┴──► Plan ──► part program, simulated path
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Contour`], [`Section`], [`Corner`], [`Shape`], [`Trace`] | geometry, drawn or read |
//! | [`ContourFile`], [`read_gcode`], [`read_dxf`] | contour files in TOML, contours in part programs and in drawings |
//! | [`Parameters`], [`Machine`], [`Cutter`], [`EdgeForce`], [`MillLife`], [`Economics`] | constants, in named sets |
//! | [`Pass`], [`Models`], [`PathError`], [`FormError`], [`CornerPolicy`], [`Milling`] | what is cut and how it is modelled |
//! | [`Engagement`], [`MeanForces`], [`HelicalCut`], [`HandbookForce`] | cutting mechanics |
//! | [`Constraint`], [`Ratios`], [`Evaluation`] | limits by name, and what a setting does |
//! | [`Planner`], [`Setting`], [`Objective`], [`EdgeLife`], [`Plan`] | plans: optimal, with ramps, on a used edge or both, baselines, front of time and cost |
//! | [`Planner::part_program`], [`Planner::follow`] | G-code with planned feeds; the path the drives make of it |
//! | [`Along`], [`Piece`], [`Rim`], [`Track`], [`distance`] | engagement along the path, with a bound between samples |
//! | [`Sensitivity`] | gains over scattered conditions |
//! | [`claims`] | published numbers beside computed ones |
//!
//! ```
//! use toolroom_contour::{ContourFile, Objective};
//! let file = ContourFile::parse("rk3.toml", include_str!("../../../scenarios/contour/rk3.toml"), &[]).unwrap().content;
//! let (_, finish) = &file.planners().unwrap()[1];
//! let (handbook, plan) = (finish.handbook().unwrap(), finish.optimal(Objective::Cost).unwrap());
//! assert!((plan.productivity_gain(&handbook) - 0.1307).abs() < 1e-4);
//! assert!((plan.cost_change(&handbook) + 0.1516).abs() < 1e-4);
//! ```
//!
//! # What is not modelled
//! Chatter and every other vibration: forces are those of a stiff machine or of one that bends
//! statically. Stock is parallel to the wall: what an earlier pass left at corners and by deflection is not carried
//! over. With [`EngagementModel::Section`] the engagement changes at once at joints of different curvature, as in the
//! paper; with [`EngagementModel::Path`] limits hold between samples too. [`Contour::clears`] finds narrow slots, necks and
//! contours that cross themselves, but not on the ways around sharp corners. Run-out enters the roughness, not the forces. Heat. Wear of the edge raises the edge forces as a constant of the pass, not
//! along the contour. The feed in ramps wears the edge as if there were none. Lead-in, lead-out
//! and the change from the last spindle speed back to the first take no time. The direction of
//! the feed forces moves the cutter along the wall only. Friction, backlash and jerk of the drives.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod along;
mod baseline;
mod claims;
mod clearance;
mod constraint;
mod contour;
mod corner;
mod dxf;
mod edge_life;
mod engagement;
mod error;
mod evaluation;
mod file;
mod file_form;
mod force;
mod gcode;
mod geometry;
mod handbook;
mod helix;
mod junction;
mod junction_edge;
mod life;
mod lobed;
mod parameters;
mod part_program;
mod pass;
mod path_error;
mod plan;
mod planner;
mod rim;
mod search;
mod sensitivity;
mod spline;
mod trace;
mod track;
mod trajectory;
mod wall;

pub use along::{Along, Piece};
pub use claims::claims;
pub use constraint::{Constraint, Ratios};
pub use contour::Contour;
pub use corner::{CornerMove, CornerPolicy, loop_length};
pub use dxf::{read as read_dxf, read_outline as read_dxf_outline};
pub use edge_life::EdgeLife;
pub use engagement::Engagement;
pub use error::{ContourError, FileError};
pub use evaluation::{Evaluation, Setting, Warning};
pub use file::{ContourFile, Drawing, GcodeFileError};
pub use file_form::{CONTOUR, SETUP};
pub use force::{EdgeForce, Forces, MeanForces, Milling};
pub use gcode::read as read_gcode;
pub use geometry::{Corner, CutterSide, Point, Section, Shape};
pub use handbook::{Calibration, HandbookForce};
pub use helix::HelicalCut;
pub use life::MillLife;
pub use parameters::{Cutter, Economics, Machine, PARAMETER_SETS, Parameters, SetError};
pub use pass::{EngagementModel, FormError, Models, Pass};
pub use path_error::{
    PathError, VelocityLoop, corner_feed, corner_impulse, corner_undershoot, explicit_euler_march, gain_mismatch_error,
    inertia_force,
};
pub use plan::{Plan, PlannedSection};
pub use planner::Planner;
pub use rim::Rim;
pub use search::Objective;
pub use sensitivity::{ConditionScatter, Draw, DrawKeeper, Sensitivity};
pub use trace::{CORNER_ANGLE, POSITION_TOLERANCE, Trace};
pub use track::{Track, distance};
pub use trajectory::Deviation;
