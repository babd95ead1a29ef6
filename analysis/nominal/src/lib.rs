//! Nominal models over measured records: what each reading should be, and what may be moved.
//!
//! | item | what it is |
//! |---|---|
//! | [`Forward`] | what a diagnosis asks of a nominal model: predictions, derivatives, scatter |
//! | [`Frame`] | what a model states beside them: measurements, constants, allowances, effects that may be missing |
//! | [`NominalModel`] | a nominal model as a file describes it, to be held over records |
//! | [`cutting`], [`grinding`], [`program`], [`shop`], [`empirical`] | the models |
//! | [`Settings`] | what is believed before any measurement |
//! | [`EffectId`], [`ChannelId`] | what effects and channels are told apart by |
//!
//! Nothing here fits or decides: that is the room `gap`.

#![deny(clippy::wildcard_enum_match_arm)]

mod broken;
mod channel_id;
pub mod compound;
mod constants;
pub mod cutting;
mod cutting_effects;
mod discrepancy;
mod effect_id;
pub mod empirical;
mod empirical_catalogue;
mod empirical_effects;
pub mod features;
mod forward;
mod frame;
mod given;
pub mod grinding;
mod measured;
mod model_file_error;
mod movable;
mod nominal;
mod parts;
mod plausible;
mod predict;
pub mod program;
mod role;
mod search;
mod settings;
mod sheet;
pub mod shop;
mod stability;
mod stated;
mod stopped;
mod surface;
mod units;
mod untried;

pub use channel_id::ChannelId;
pub use constants::{HUBER, MAD};
pub use discrepancy::{Discrepancy, Discrepant, On};
pub use effect_id::{EffectId, WEAR_RATE};
pub use empirical_catalogue::{EMPIRICAL_EFFECTS, EmpiricalSizes};
pub use forward::{Direction, EffectRefusal, Forward, Point, WrittenEffect};
pub use frame::{Candidate, Covariate, Family, Frame, Local, Parameter};
pub use measured::{Channel, Measured, Observation, Transform};
pub use model_file_error::ModelFileError;
pub use movable::{Movable, Words};
pub use nominal::{NominalModel, NominalProcess, ProcessData};
pub use predict::{correct, predict, touches, transformed};
pub use role::Role;
pub use settings::Settings;
pub use sheet::sensor_sheet;
pub use stability::{HeardCut, StructurePrior};
pub use stated::Declarations;
pub use surface::Surface;
pub use untried::Untried;
