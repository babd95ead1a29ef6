//! Switchable effects that a nominal model of a machining process leaves out.
//!
//! A nominal simulator and a real shop differ because something is missing in the equations.
//! Each effect here is one such thing, with a strength (`size`, neutral at zero) and a shape.
//! An effect sees physical quantities and changes factors and summands; the equations of a
//! process read only those, so no equation knows which effects exist. Strength zero is the
//! same as absent, bit for bit, and still carries its derivative.
//!
//! ```text
//!   Context (flank wear, time in cut,          Terms (factors 1, summands 0)
//!   coolant age, lot, removed volume)                    │
//!        │            ┌──────────┐                       ▼
//!        └───────────►│ Effects  │──────────►  equations of the process
//!                     └──────────┘
//!                  id, size, shape from files, FMU parameters, diagnosis
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Effect`] | one effect with size and shape; reads `{ id = "wear_force", size = 0.2 }` and `wear_force=0.2` |
//! | [`Effects`] | the list that a process holds |
//! | [`EFFECT_LIST`], [`EffectList`], [`read_effects`] | the list in files |
//! | [`Effect::CATALOGUE`], [`CatalogueEntry`] | what is known about each: channels, regime, confounder, separating test |
//! | [`Search`] | how a diagnosis looks for an effect, or why it does not |
//! | [`Context`] | what an effect may look at |
//! | [`Terms`] | what an effect may change |
//! | [`Definition`], [`UserEffect`], [`USER_EFFECT`], [`read_definitions`] | effects of a user, written as formulas in files |
//! | [`vocabulary`] | what such formulas may name |
//!
//! ```
//! use toolroom_effects::{Context, Effect, Effects};
//! let effects = Effects::new(vec!["wheel_dulling=1".parse::<Effect>().unwrap()]).unwrap();
//! let dull = Context { removed_volume: 0.3e-3, ..Context::neutral() };
//! let terms = effects.terms::<f64>(&dull);
//! assert!((terms.process_stiffness - 1.2).abs() < 1e-12);
//! ```
//!
//! To add an effect: one file with its record (`size` first), its `ENTRY` and its `act`, and its line in the
//! list in `effect.rs` and among the modules here. The shop, the units, the diagnosis and the tests pick it up.
//!
//! # What is not modelled
//! Effects of the shop (feed override, stops, delays) change no term of a cutting process; the
//! shop simulator lists them. Effects act independently: none raises the size of another. Sensor
//! effects are those of the readings named in [`Terms`]; vibration has none.

#![deny(clippy::wildcard_enum_match_arm)]

mod built_up_edge;
mod catalogue;
mod chipping;
mod chuck_stiffness;
mod context;
mod coolant_ageing;
mod coolant_change;
mod crawl_wear;
mod effect;
mod effects;
mod error;
mod file;
mod force_bias;
mod force_drift;
mod helix_form_error;
mod lot_hardness;
mod mode_damping;
mod mode_frequency;
mod mode_stiffness;
mod process_damping;
mod run_in;
mod runout;
mod search;
mod servo_lag;
mod spindle_loss;
mod start_offset;
mod stiffness_drift;
mod stock_offset;
mod temperature_lag;
mod terms;
mod thermal_growth;
mod thermal_heredity;
mod thermal_softening;
mod threshold_force;
mod user;
mod wear_acceleration;
mod wear_force;
mod wear_temperature;
mod wheel_dulling;
mod wheel_wear;

pub use catalogue::{CatalogueEntry, Sign, Touched};
pub use context::Context;
pub use effect::*;
pub use effects::Effects;
pub use error::EffectError;
pub use file::{EFFECT_LIST, EffectList, read_effects};
pub use search::Search;
pub use terms::Terms;
pub use user::{
    CODES, Definition, EFFECTS_FILE, FormulaError, Named, USER_EFFECT, UserEffect, parse_definitions, read_definitions,
    read_effects_file, vocabulary,
};
