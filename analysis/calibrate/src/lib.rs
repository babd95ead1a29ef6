//! Parameters with uncertainty from a shop's own measurements of tools.
//!
//! ```text
//!  edges: wear readings, lives ─┐
//!  law, priors ─────────────────┴─► Model: log posterior density ─► maximum ─► draws ─► intervals
//!                                                                            └─► edges left out ─► choice of law
//! ```
//!
//! One statistical model serves all data: a reading is `H(w·t; θ) + ε`, with the wear curve H of the condition, the level w
//! of the edge (`ln w ~ N(0, τ²)`, integrated out), and priors on θ. Lives are readings of another kind.
//!
//! | type | what it is |
//! |---|---|
//! | [`Edge`], [`Stretch`], [`Life`] | what was measured of an edge |
//! | [`Law`], [`Shape`], [`Candidate`] | the wear laws with their parameters, and the shape of wear curves |
//! | [`Base`], [`Condition`], [`Process`] | the set from which a calibration starts, and what an edge meets |
//! | [`Parameter`], [`Prior`], [`Scale`] | a quantity that the data are to tell, in its working coordinate |
//! | [`Curve`] | flank wear over time at one condition |
//! | [`WearModel`] | readings and lives under a law |
//! | [`ChannelModel`], [`ChannelFit`] | cutting force, feed force, spindle power, temperature and thermo-EMF against wear |
//! | [`ChippingFit`], [`Exposure`] | the rate at which edges chip |
//! | [`Model`] | what the inference needs of any model |
//! | [`maximise`], [`sample`], [`Posterior`] | the maximum, draws, and how well they can be relied on |
//! | [`Identifiability`] | what the data determine, and what only the prior says |
//! | [`leave_edges_out`], [`Coverage`], [`Choice`] | predictions of edges by the others, and the law that they speak for |
//! | [`Measured`], [`Treatment`], [`Clock`] | records brought into this form, with what is to be said of them |
//! | [`Calibration`], [`Request`] | all of it in one go: text, JSON, draws, the parameter set |
//! | [`DrawnTable`] | draws as a table, also of what is known before any data |
//! | [`Advice`], [`Costs`], [`Test`] | a decision between two speeds, and what to measure for it |
//! | [`CalibrationStudy`], [`StudyResult`] | the same from files |
//!
//! Times are in min, wear in mm, other values in the units of parameter files.
//!
//! # What is not modelled
//! - The tool body's temperature follows at once, as in lives by quadrature.
//! - An edge's level acts on the whole rate; it is not split into a mechanical and a thermal part.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod advise;
mod base;
mod calibration;
mod channel;
mod channels;
mod chipping;
mod choice;
mod conflict;
mod curve;
mod data_error;
mod drawn;
mod edge;
mod edge_start;
mod end;
mod ensemble;
mod fit;
mod fixing;
mod identify;
mod in_life;
mod joined;
mod known;
mod law;
mod left_out;
mod level;
mod loads;
mod model;
mod normal;
mod packed;
mod parameter;
mod pareto;
mod profile;
mod range;
mod remarks;
mod report;
mod request;
mod sample;
mod set_file;
mod shape;
mod slot;
mod stated;
mod study;
mod summary;
mod times;
mod treatment;
mod unfitted;
mod wear_model;

pub use advise::{Advice, Costs, Test, deviation_after};
pub use base::{Base, Condition, Process};
pub use calibration::{Calibration, CalibrationError, HeldOut, LawFit, LifeAt, life_at};
pub use channel::{Channel, ChannelModel, ChannelReading, IDLE_POWER};
pub use channels::{ChannelFit, When};
pub use chipping::{ChippingFit, Exposure};
pub use choice::{Choice, Score, Verdict};
pub use curve::Curve;
pub use data_error::DataError;
pub use drawn::DrawnTable;
pub use edge::{Block, Common, Edge, Life, Stretch};
pub use edge_start::EdgeStart;
pub use end::End;
pub use fit::{Maximum, maximise};
pub use identify::{Identifiability, Product, Undetermined};
pub use in_life::InLife;
pub use law::Law;
pub use left_out::{Coverage, LeftOut, leave_edges_out};
pub use loads::ChannelReadings;
pub use model::Model;
pub use parameter::{Parameter, Prior, Scale};
pub use pareto::Weights;
pub use profile::profiles;
pub use request::Request;
pub use sample::{Method, Posterior, sample};
pub use shape::{Candidate, Shape};
pub use study::{CalibrationStudy, Refusal, StudyResult};
pub use treatment::{Clock, Measured, Treatment};
pub use wear_model::{EDGE_SCATTER, LIFE_NOISE_NAME, READING_NOISE, WearModel};
