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
//! | [`propose()`] | terms that describe a gap of which no cause is known |
//! | [`Diagnosis`] | what is said, and its JSON form |
//! | [`Basis`], [`Noise`] | by what all models are judged |
//!
//! # Source
//! Leave-group-out evidence and stacking: Yao, Vehtari, Simpson & Gelman 2018. Discrepancy bounded
//! by a prior: Kennedy & O'Hagan 2001, Brynjarsdóttir & O'Hagan 2014. Max-T null: Westfall & Young
//! 1993. Thresholds are assumptions, checked by the blind benchmark.

#![deny(clippy::wildcard_enum_match_arm)]

mod basis;
mod belief;
mod budget;
mod channel_scale;
mod channels;
mod class;
mod closure;
mod constants;
mod decide;
mod decision;
mod diagnose;
mod diagnosing;
mod diagnosis;
mod discrepancy;
mod drift;
mod dynamics;
mod enough;
mod evidence;
mod fit;
mod fit_answer;
mod fitness;
mod generic;
mod gram;
mod identifiability;
mod job_facts;
mod joined;
mod left_out;
mod linear;
mod machine_facts;
#[cfg(test)]
mod machine_tests;
mod measures;
mod method;
mod narrowed;
mod noise;
mod number;
mod outside;
pub mod plan;
mod pooled;
mod probability;
mod processes;
mod propose;
mod queue;
mod reframed;
mod rules;
mod score;
mod settle;
mod shift_labels;
mod shop_facts;
mod shop_kpi;
#[cfg(test)]
mod shop_tests;
mod size;
mod stepwise;
mod stops;
mod summary;
mod tolerance;
mod trial;
mod verdict;

pub use basis::Basis;
pub use channel_scale::ChannelScale;
pub use channels::diagnose_parts;
pub use constants::{FEWEST_GROUPS, GATE, NINETY};
pub use decision::Decision;
pub use diagnose::{DiagnosisWithBasis, diagnose, diagnose_by};
pub use diagnosis::{
    Budget, Calibrated, Cell, Closure, Diagnosis, GapVerdict, NamedEffect, NextExperiment, NotNamed, OutlyingReading,
    Ranked, RuleFinding, Tried,
};
pub use drift::{DriftExplanation, DynamicsDrift, StructureChange};
pub use dynamics::add_dynamics;
pub use fit::{Fit, fit};
pub use fit_answer::{Fitness, LeastSeen, Part, Structure};
pub use gram::normal_equations;
pub use identifiability::{Identifiable, identifiability};
pub use job_facts::Jobs;
pub use joined::joined;
pub use linear::{Linear, predict};
pub use machine_facts::add_machine_facts;
pub use measures::{Measures, ResidualPair, apart};
pub use method::{Bare, Method};
pub use noise::Noise;
pub use outside::Outside;
pub use processes::{Answers, diagnose_processes, diagnosed_processes};
pub use propose::{Library, Proposal, ProposedTerm, propose};
pub use rules::{RULES, Refusal, Rule};
pub use score::Scores;
pub use shift_labels::ShiftLabels;
pub use toolroom_evidence::{EFFECT_PRIOR, Evidence, Gram};
pub use toolroom_nominal::{
    Candidate, Channel, ChannelId, Covariate, Declarations, Direction, Discrepancy, Discrepant, EMPIRICAL_EFFECTS,
    EffectId, EffectRefusal, EmpiricalSizes, Family, Forward, Frame, Local, Measured, ModelFileError, Movable,
    NominalModel, NominalProcess, Observation, On, Parameter, Point, ProcessData, Settings, Surface, Transform,
    Untried, WEAR_RATE, Words, WrittenEffect, cutting, empirical, features, grinding, program, sensor_sheet,
};
pub use trial::Trial;

/// Logs of shops as nominal models, and what their queues tell of a diagnosis.
pub mod shop {
    pub use super::queue::{Came, QueueFit, QueueScore, pools_of, queues, recorded_waits};
    pub use super::shop_facts::add_facts;
    pub use super::shop_kpi::{ShopKpi, mix};
    pub use toolroom_nominal::shop::*;
}
