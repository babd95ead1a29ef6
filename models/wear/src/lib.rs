//! Tool wear in turning: wear laws, tool life, adaptive cutting speed and its scatter.
//!
//! The evolutionary model of Postnov & Shafikov reads wear as two functionals, one of force
//! and path, one of temperature and time. Both depend on how worn the edge already is, so the
//! speed of least wear falls during the life of an edge; whoever follows it gains tool life.
//! Taylor's law, whose speed and state of wear separate, gains nothing: both are here.
//!
//! ```text
//!  Cut (speed, feed, depth,          ┌───────────── Pair ─────────────┐
//!   scatter and effect factors) ──►  │ Temperature ─► WearLaw: A, B ──┼─► WearState rates ─► run
//!  flank wear, body heat, damage ──► │      │          (path) (time)  │
//!                                    │ Force, Emf, Chipping, Limits ──┼─► Point (what is measured)
//!                                    └───────────────┬────────────────┘
//!      life by quadrature, best constant speed ◄─────┤
//!      v*(h), mu-law, set increment, pass plan ◄─────┴──► Observer (reads wear from measurements)
//! ```
//!
//! | type | what it is |
//! |---|---|
//! | [`Pair`], [`PARAMETER_SETS`] | everything known of one tool in one work material; shipped sets |
//! | [`ParameterSet`], [`PARAMETER_SET`] | a file of constants, handbook forms included, each with its origin |
//! | [`Cut`] | what the edge meets, with neutral multipliers |
//! | [`Temperature`], [`Force`], [`Emf`], [`Chipping`], [`Limits`] | the parts of a pair |
//! | [`WearLaw`]: [`EnergyBalance`], [`ExtendedTaylor`], [`TakeyamaMurata`], [`Usui`] | how fast the flank wears; [`WearLaw::rate`] is dh/dt at constant conditions |
//! | [`run_in`], [`wear_stage`] | factors that shape the wear curve, shared by the laws and by milling |
//! | [`Contact`], [`Coefficients`], [`Point`] | algebra at one instant |
//! | [`WearState`], [`EdgeRun`] | what changes: [`Pair::derivative`], [`Pair::run`] |
//! | [`Life`], [`Objective`] | life by quadrature, best constant speed |
//! | [`SpeedMode`], [`PassPlan`], [`SpeedTable`], [`SpeedSchedule`] | control laws for a pass, tabulated, or open loop |
//! | [`Observer`] | extended Kalman filter on power, feed force, EMF |
//! | [`Scatter`], [`LifeMoments`] | how edges differ |
//! | [`claims`] | published numbers beside computed ones |
//!
//! ```
//! use toolroom_wear::{Objective, Pair};
//! let pair = Pair::named("ni_vk6om").unwrap();
//! let cut = pair.reference_cut();
//! let constant = pair.best_constant_speed(&cut, Objective::Path).life;
//! let adaptive = pair.minimum_wear_life(&cut);
//! assert!((adaptive.path / constant.path - 1.555).abs() < 1e-3);
//! // Per unit of time it loses against a faster constant speed, at two minutes an edge change.
//! let fast = pair.best_constant_speed(&cut, Objective::Rate { change_time: 120.0 }).life;
//! assert!(adaptive.production_rate(120.0) < 0.76 * fast.production_rate(120.0));
//! ```
//!
//! The set `ni_vk6om` was chosen so that the paper's doubled tool life comes out: it shows that
//! the claim is attainable and predicts nothing. `ni_vk6om_hb` agrees with handbook slopes.
//! Equations are generic over [`Number`](toolroom_process::Number); all values are SI.
//!
//! # What is not modelled
//! - Crater wear, notch wear, plastic deformation of the edge; breakage other than [`Chipping`].
//! - Built-up edge: at low speed mechanical wear only saturates at its cold plateau.
//! - Contact transients (milliseconds): the acceleration of speed has no effect of its own.
//! - Coolant, nose radius, tool geometry other than the cutting edge angle.
//! - Wear acts on force and temperature, not on chip formation or surface finish.
//! - Searches for a speed assume a continuous cut; in interrupted cutting they are biased, since
//!   the tool is colder at the start of a pass.
//! - The observer knows neither thermal damage nor errors of the land's stresses.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod calibrate;
mod chipped_share;
mod chipping;
mod claims;
mod command;
mod contact;
mod cut;
mod emf;
mod energy_balance;
mod force;
mod law;
mod life;
mod life_moments;
mod limits;
mod measurement;
mod observer;
mod pair;
mod plan;
mod quadrature;
mod scatter;
mod schedule;
mod search;
mod set;
mod speed;
mod speed_table;
mod state;
mod takeyama_murata;
mod taylor;
mod temperature;
mod turning_sets;
mod usui;
mod wear;
mod wear_curve;

pub use calibrate::WearTarget;
pub use chipping::Chipping;
pub use claims::{ClaimError, claims};
pub use command::{OtherLaw, SpeedLaw, ramp_limits};
pub use contact::{Coefficients, Contact, Point};
pub use cut::Cut;
pub use emf::Emf;
pub use energy_balance::EnergyBalance;
pub use force::{Force, Load};
pub use law::WearLaw;
pub use life::{ConstantSpeed, Life, Objective};
pub use life_moments::LifeMoments;
pub use limits::Limits;
pub use measurement::Measurement;
pub use observer::{BELIEF, Estimate, Observer, ObserverNoise, WearLevel};
pub use pair::Pair;
pub use plan::{PassPlan, Ramp, RampLimits, SpeedMode};
pub use scatter::{EdgeScatter, PairScatter, Scatter};
pub use schedule::SpeedSchedule;
pub use set::{
    ABOUT, ASSUMED_DEVIATIONS, ASSUMED_EXPONENTS, Band, Catalogue, EDGE_SCATTER, EDGE_SCATTER_DEVIATION,
    EDGE_SCATTER_NAME, FORCE_DEVIATION, FirstSet, FittedLives, Group, HANDBOOK, HandbookTaylor, ISO_513, Kienzle,
    KnownLife, KnownLifeError, MATERIAL_GROUPS, MaterialGroup, OneLife, Origin, PARAMETER_SET, ParameterSet,
    ParameterValue, READING_NOISE_NAME, ReferenceLife, SPEED_EXPONENT_DEVIATION, ScatterWord, SetError, Spread,
    TestedLife, ToolMaterial, is_path, read_priors,
};
pub use speed::{RateOptimum, SetSpeed};
pub use speed_table::SpeedTable;
pub use state::{EdgeRun, WEAR_EVENTS, WearState};
pub use takeyama_murata::TakeyamaMurata;
pub use taylor::ExtendedTaylor;
pub use temperature::{Heating, Temperature};
pub use turning_sets::{PARAMETER_SETS, TURNING_SETS};
pub use usui::Usui;
pub use wear::Wear;
pub use wear_curve::{LARGEST_CONTRAST, LARGEST_TILT, check_tilt, run_in, stage_time, wear_stage};
