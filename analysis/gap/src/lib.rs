//! Where a nominal model and measurement differ, which missing effect causes it, and how far the
//! gap shrinks with it.
//!
//! ```text
//!  Records ─► Forward (nominal model, calibration, allowance, candidates)
//!                │ Linear: residuals and derivatives
//!                ▼
//!             Basis: noise, memory, scatter from edge to edge, read off a saturated model
//!                │
//!        fit ─► Gram by group ─► scores (where), evidence on groups left out (which)
//!                                      │
//!                                      ▼ decide: effect · unknown · masked · no gap (or cannot tell, unfitted)
//!                                   Diagnosis: effects, classes, closure, budget, next experiment
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`diagnose()`] | the whole way |
//! | [`diagnose_parts()`] | the same for channels that are models of their own |
//! | [`diagnose_processes()`] | the same for every process of a data set, with one answer |
//! | [`identifiability()`] | what records of a design can show, before anything is measured |
//! | [`Forward`] | what a nominal model must offer; [`cutting::Cutting`] offers it for turning and milling, [`program::Stretches`] for part programs |
//! | [`Diagnosis`] | what is said, and its JSON form |
//! | [`Basis`], [`Noise`] | by what all models are judged |
//!
//! # Source
//! Leave-group-out evidence and stacking: Yao, Vehtari, Simpson & Gelman 2018. Discrepancy bounded
//! by a prior: Kennedy & O'Hagan 2001, Brynjarsdóttir & O'Hagan 2014. Max-T null: Westfall & Young
//! 1993. Thresholds are assumptions, checked by the blind benchmark.

#![deny(clippy::wildcard_enum_match_arm)]

mod basis;
mod broken;
mod catalogue;
mod channels;
mod closure;
mod constants;
pub mod cutting;
mod cutting_effects;
mod decide;
mod diagnose;
mod diagnosing;
mod diagnosis;
mod discrepancy;
pub mod empirical;
mod empirical_effects;
mod enough;
mod evidence;
pub mod features;
mod fit;
mod forward;
mod generic;
mod gram;
pub mod grinding;
mod identifiability;
mod joined;
mod left_out;
mod linear;
mod measured;
mod method;
mod noise;
mod nominal;
pub mod plan;
mod plausible;
mod pooled;
mod processes;
pub mod program;
mod rules;
mod score;
mod search;
mod settings;
mod settle;
pub mod shop;
mod stepwise;
mod summary;
mod tolerance;
mod trial;
mod units;

pub use basis::Basis;
pub use catalogue::report_units;
pub use channels::diagnose_parts;
pub use closure::Outside;
pub use constants::FEWEST_GROUPS;
pub use decide::Decision;
pub use diagnose::{Diagnosed, diagnose, diagnose_by};
pub use diagnosis::{
    Budget, Calibrated, Cell, Closure, Diagnosis, Found, GapVerdict, NamedEffect, NextExperiment, NotNamed, Ranked,
    Tried,
};
pub use discrepancy::{Discrepancy, Discrepant, On};
pub use empirical_effects::{EMPIRICAL_EFFECTS, EmpiricalSizes};
pub use fit::Fit;
pub use forward::{Candidate, Covariate, Direction, Forward, Frame, Local, Parameter, Point, Surface};
pub use identifiability::{Identifiable, identifiability};
pub use joined::joined;
pub use linear::Linear;
pub use measured::{Channel, Measured, Observation, Transform};
pub use method::Method;
pub use noise::Noise;
pub use nominal::{ModelFileError, NominalModel, NominalProcess, sensor_sheet};
pub use processes::{Answers, Asked, diagnose_processes};
pub use rules::{RULES, Refusal, Rule};
pub use score::Scores;
pub use search::Untried;
pub use settings::Settings;
pub use toolroom_evidence::{Evidence, Gram};
pub use trial::Trial;
