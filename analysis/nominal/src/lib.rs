//! Nominal models over measured records: what each reading should be, and what may be moved.
//!
//! | item | what it is |
//! |---|---|
//! | [`Forward`] | what a diagnosis asks of a nominal model: predictions, derivatives, scatter |
//! | [`Frame`] | what a model states beside them: measurements, constants, allowances, effects that may be missing |
//! | [`NominalModel`] | a nominal model as a file describes it, to be held over records |
//! | [`cutting`], [`grinding`], [`program`], [`shop`], [`empirical`] | the models |
//! | [`Settings`] | what is believed before any measurement |
//!
//! Nothing here fits or decides: that is the room `gap`.

#![deny(clippy::wildcard_enum_match_arm)]

mod broken;
mod constants;
pub mod cutting;
mod cutting_effects;
mod discrepancy;
pub mod empirical;
mod empirical_effects;
pub mod features;
mod forward;
pub mod grinding;
mod measured;
mod nominal;
mod parts;
mod plausible;
mod predict;
pub mod program;
mod search;
mod settings;
pub mod shop;
mod stability;
mod stated;
mod units;

pub use constants::{HUBER, MAD};
pub use discrepancy::{Discrepancy, Discrepant, On};
pub use empirical_effects::{EMPIRICAL_EFFECTS, EmpiricalSizes};
pub use forward::{
    Candidate, Covariate, Direction, EffectRefusal, Family, Forward, Frame, Local, Parameter, Point, Surface,
    WrittenEffect,
};
pub use measured::{Channel, Measured, Observation, Transform};
pub use nominal::{Asked, ModelFileError, NominalModel, NominalProcess, sensor_sheet};
pub use parts::WEAR_RATE;
pub use predict::{correct, predict, touches, transformed};
pub use search::Untried;
pub use settings::Settings;
pub use stability::{HeardCut, StructurePrior};
pub use stated::{Movable, Stated, Words};
