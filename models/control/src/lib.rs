//! The controller of cutting speed as a process of its own: it samples what the machine measures, estimates flank wear,
//! plans each pass and says when the edge is changed.
//!
//! ```text
//!   spindle power, feed force, thermo-EMF, wear readings ──► SpeedController ──► cutting speed, tool change
//! ```
//! The rules are those of the shop: the same laws of speed against wear, ramps, filter and limits
//! ([`toolroom_wear::SpeedLaw`], [`toolroom_wear::RampLimits`], [`toolroom_wear::Observer`]). Between two samples the speed
//! is held, where the shop ramps it: at the mean of the ramp, so that the path of every interval is the same.
//!
//! # What is not modelled
//! Noise and bias of sensors, which belong to the machine that measures; changing a spindle speed because of chatter;
//! schedules of speed against path. The controller does not know that the tool cools in a pause.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod controller;
mod records;

pub use controller::SpeedController;
pub use records::{
    CHANGE_RULES, Change, ControlInput, ControlOutput, ControlState, Operation, Rule, SPEED_RULES, Sensing,
};
