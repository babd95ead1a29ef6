//! Stock carried through a part program: how much of the cutter is engaged along its path, how much it removes, and what
//! that asks of spindle and cutter.
//!
//! ```text
//!  setup file ─► Setup: stock, tools
//!                  │
//!  Motions ───────►Cutting: outline less swaths ─► Cut of each motion: angle with bound, depth, volume, air, power, force
//! ```
//!
//! A point of the rim is in material where it lies inside the outline of the stock and in no earlier swath whose floor is at or
//! below its height. Swaths are what the cutter has run over: regions around lines, arcs and points, each with its floor. The
//! engaged angles follow in closed form from the crossings of the rim with their boundaries, for each height between the
//! floors near by; no polygon is cut, so none can fail.
//!
//! Where a tool has a ball, a rounded corner or a cone at its end, the stock is a grid of heights instead: what of the surface of the
//! cutter lies below them is engaged, to within three quarters of a cell.
//!
//! | item | what it is |
//! |---|---|
//! | [`Setup`], [`SETUP`] | a file that describes stock and tools |
//! | [`Part`], [`Gouge`] | what should be left, and what cuts into it |
//! | [`Stock`], [`Outline`], [`Profile`], [`Tool`], [`End`], [`Holder`], [`ToolForce`] | what is cut and with what |
//! | [`Cutting`], [`Cut`], [`Load`], [`Mean`] | stock that is cut motion by motion, and what each does |
//! | [`Follower`] | tool, spindle and height of a program as it goes on |
//! | [`FeedPlan`], [`FeedLimits`], [`FeedLimit`], [`LimitUse`], [`SpeedChange`] | feeds and spindle speeds of a program inside the limits of its tools |
//! | [`Calls`], [`Call`], [`Span`] | a program as tool calls with time and conditions: what a shop does with it |
//!
//! # Units
//! SI, but for the motions, which are those of the crate `program`: mm and s.
//!
//! # What is not modelled
//! The tool along another axis than Z; undercuts; fixtures, holders that are more than a cylinder; stock and parts that are
//! no prisms. What a bent cutter leaves. Chips thinner than the edge radius. Wear by
//! plunging and drilling.

#![deny(clippy::wildcard_enum_match_arm)]

mod call;
mod cutting;
mod drawn;
mod end;
mod engaged;
mod follow;
mod front;
mod gouge;
mod holder;
mod limits;
mod load;
mod map;
mod mapped;
mod piece;
mod plan;
mod profile;
mod setup;
mod swath;

pub use call::{Call, CallError, Calls, Conditions, Span, TimedStretch};
pub use cutting::{Cut, Cutting, Mean};
pub use end::End;
pub use engaged::{Outline, Stock};
pub use follow::{FollowError, Follower, NoTool};
pub use gouge::{Gouge, Part};
pub use holder::Holder;
pub use limits::{FeedLimit, FeedLimits};
pub use load::{Load, Tool, ToolForce};
pub use plan::{AsProgrammed, FeedObjective, FeedPiece, FeedPlan, LimitUse, SpeedChange};
pub use profile::Profile;
pub use setup::{SETUP, Setup};
