//! Turning and milling as processes: what wear, force, heat and effects give together.
//!
//! ```text
//!   Pair (wear) ──┐
//!   Finish ───────┼─► Turning ──► rates, outputs, events ──► impl Process
//!   Effects ──────┤
//!   EdgeForce ────┼─► Milling ──► rates, outputs, events ──► impl Process
//!   CutterLife ───┘
//! ```
//!
//! | type | what it is |
//! |---|---|
//! | [`Turning`] | one edge in one workpiece |
//! | [`Milling`], [`MILLING_SETS`] | one cutter in one workpiece; shipped sets |
//!
//! ```
//! use toolroom_cutting::{Turning, TurningInput};
//! use toolroom_process::Process;
//! let turning = Turning::named("c45_t15k6").unwrap();
//! let cut = TurningInput { cutting_speed: 3.0, feed_per_rev: 0.3e-3, depth_of_cut: 1.5e-3, ..Default::default() };
//! let output = turning.output(&turning.initial(), &cut);
//! assert!(output.spindle_power > 2e3 && output.spindle_power < 3e3);
//! ```
//!
//! # What is not modelled
//! Chatter, built-up edge, thermal growth of workpiece and spindle, notch and crater wear, chip
//! breaking, nose wear (roughness is that of an ideal edge), interrupted cuts within a
//! revolution, coolant other than through the effects.
//!
//! Milling besides: heat, curved walls, the helix (it lowers the peaks and bends the wall along
//! the axis), ploughing of thin chips, tilted runout, unequal wear of the teeth, thermal and
//! mechanical cycling of the edge as a cause of wear of its own.

pub mod milling;
pub mod turning;

pub use milling::{Cutter, CutterLife, EdgeForce, MILLING_SETS, Milling, MillingInput, MillingOutput, MillingState};
pub use turning::{Finish, LifeModel, Turning, TurningInput, TurningOutput, TurningState};
