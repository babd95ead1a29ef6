//! Contour milling: what an end mill does along a contour of lines, arcs and splines, and the
//! spindle speeds and feeds that mill it in the least time or at the least cost.

mod baseline;
mod constraint;
mod contour;
mod corner;
mod edge_life;
mod engagement;
mod error;
mod force;
mod geometry;
mod handbook;
mod helix;
mod junction;
mod life;
mod parameters;
mod pass;
mod path_error;
mod plan;
mod planner;
mod search;
mod spline;
mod trace;

pub use constraint::{Constraint, Ratios};
pub use contour::Contour;
pub use corner::{CornerMove, CornerPolicy, loop_length};
pub use edge_life::EdgeLife;
pub use engagement::Engagement;
pub use error::{ContourError, FileError};
pub use force::{EdgeForce, Forces, MeanForces, Milling};
pub use geometry::{Corner, CutterSide, Point, Section, Shape};
pub use handbook::{Calibration, HandbookForce};
pub use helix::HelicalCut;
pub use life::MillLife;
pub use parameters::{Cutter, Economics, Machine, PARAMETER_SETS, Parameters, SetError};
pub use pass::{FormError, Models, Pass};
pub use path_error::{
    PathError, VelocityLoop, corner_feed, corner_impulse, corner_undershoot, explicit_euler_march, gain_mismatch_error,
    inertia_force,
};
pub use plan::{Plan, PlannedSection};
pub use planner::{Evaluation, Planner, Setting, Warning};
pub use search::Objective;
pub use trace::{CORNER_ANGLE, POSITION_TOLERANCE, Trace};
