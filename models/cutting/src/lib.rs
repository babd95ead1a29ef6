//! Turning and milling as processes: what wear, force, heat and effects give together.
//!
//! ```text
//!   Pair (wear) ──┐
//!   Finish ───────┼─► Turning ──► rates, outputs, events ──► impl Process
//!   Effects ──────┤
//!   EdgeForce ────┼─► Milling ──► rates, outputs, events ──► impl Process
//!   CutterLife ───┤
//!   structures ───┘  (TurningStructure, MillingStructure: stability, chatter)
//! ```
//!
//! | type | what it is |
//! |---|---|
//! | [`Turning`] | one edge in one workpiece |
//! | [`Milling`], [`MILLING_SETS`], [`MILLING_CATALOGUE`] | one cutter in one workpiece; shipped sets, what a set holds |
//! | [`HeldTurning`], [`HeldMilling`] | either under an input that stays, for many questions at once |
//! | [`TurningStructure`], [`MillingStructure`] | what vibrates around the cut; without one a process does not ask |
//! | [`Regeneration`], [`Vibration`] | what wear and chatter do to each other; the verdict of an operating point |
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
//! Built-up edge, thermal growth of workpiece and spindle, notch and crater wear, chip
//! breaking, nose wear (roughness is that of an ideal edge), interrupted cuts within a
//! revolution, coolant other than through the effects.
//!
//! Milling besides: heat, curved walls, the helix (it lowers the peaks and bends the wall along
//! the axis), ploughing of thin chips, tilted runout, unequal wear of the teeth, thermal and
//! mechanical cycling of the edge as a cause of wear of its own.
//!
//! Chatter is in its limit cycle at once: the seconds in which it grows do not count for wear.
//! Verdicts carry no derivatives. A parametrically excited chuck swings like regenerative chatter
//! just beyond its limit, and its chip-formation lag is zero (assumptions). Chatter of milling has
//! the limit cycle of turning with a tooth period for a revolution. The forced vibration of turning
//! is quasi-static.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

pub mod milling;
pub mod turning;
mod vibration;

pub use milling::{
    Cutter, CutterLife, EdgeForce, HeldMilling, MILLING_CATALOGUE, MILLING_SETS, Milling, MillingInput, MillingOutput,
    MillingState, process_of_set,
};
pub use turning::{Finish, HeldTurning, LifeModel, Turning, TurningInput, TurningMemory, TurningOutput, TurningState};
pub use vibration::{MillingStructure, Regeneration, TurningStructure, Vibration};
