//! Plunge (infeed) grinding: how far the ground stock lags behind the commanded infeed, and
//! what follows for size, roundness, force, temperature and the wheel.
//!
//! The wheel presses on the part; machine and part give way. Of the deflection, each work
//! revolution grinds off the share 1 − K and leaves the share K = Cp/(J + Cp). Everything here
//! is a consequence of that recursion, extended by wheel wear, a threshold force, dulling and
//! the heat of the contact.
//!
//! ```text
//!   infeed per revolution ──►(+)──► deflection ──► 1/(1 + Cp/J + g) ──► depth h ──► Cp h = F_n
//!                             ▲ −                                        │            │
//!                             └── stock removed r, wheel wear w ◄── Σ ◄──┤         heat, burn
//!                                                 dulling, dressing ◄────┘
//! ```
//!
//! | item | what it is |
//! |---|---|
//! | [`Infeed`] | the [`Process`](toolroom_process::Process), revolution by revolution |
//! | [`InfeedProfile`], [`InfeedFirstOrder`] | the same as delay equation with the profile of the part, and as ODE |
//! | [`Parameters`], [`PARAMETER_SETS`] | machine, wheel and work; shipped sets |
//! | [`Input`], [`State`], [`Output`] | its records |
//! | [`lag`], [`stiffness_from_k`], [`series_stiffness`], [`remaining_stiffness`] | stiffnesses |
//! | [`stock_after`], [`revolutions_to`], [`deviation_after`] | the recursion in closed form |
//! | [`lag_time_constant`], [`decay_time_constant`] | its continuous equivalents |
//! | [`Trial`], [`read_trials`], [`read_force_traces`] | plunge trials and their tables |
//! | [`identify`], [`Identification`], [`Advice`] | K, Cp, J with intervals; what is wrong with the protocol |
//! | [`Load`] | power, removal rate, specific energy and burn of a revolution |
//! | [`Surface`], [`DressingPlan`] | roughness, overlap, life of the wheel |
//! | [`fastest_cycle_while_dulling`], [`CycleLimits`], [`CycleFile`] | rough–finish–spark-out cycles by exact search |
//! | [`dressing_interval`] | parts between dressings |
//! | [`PlungeDeviations`], [`PlungeShape`], [`separability`] | what hidden effects leave in trials |
//! | [`wave`], [`fastest_growing_wave`] | which waves die out and which grow to chatter |
//! | [`claims`] | published numbers beside computed ones |
//!
//! ```
//! use toolroom_infeed::{Infeed, Input, Parameters};
//! use toolroom_process::Process;
//! let grinding = Infeed { parameters: Parameters::named("zb153u_40kh").unwrap(), ..Infeed::default() };
//! let mut part = grinding.initial();
//! let revolution = 60.0 / 292.0;
//! grinding.advance(&mut part, &Input::default(), 16.0 * revolution).unwrap();
//! grinding.advance(&mut part, &Input { infeed_per_rev: 0.0, ..Input::default() }, 4.0 * revolution).unwrap();
//! let output = grinding.output(&part, &Input::default());
//! assert!((output.roundness_error - 0.4143e-6).abs() < 1e-10); // step left after spark-out
//! ```
//!
//! # Half a revolution
//! The stock of a trial is known to a revolution only as well as the start of contact and the
//! place of the gauge on the spiral are. At n = 16 half a revolution moves K by 0.1, three times
//! the scatter of five trials; [`identify`] therefore tells it beside the interval and never in it.
//!
//! # The paper's eq. (8)
//! The paper prints `J = Cp (1 − K)`, eq. (8). Its eq. (3), `K = Cp/(J + Cp)`, gives
//! `J = Cp (1 − K)/K`, 1.81 times as much at K = 0.553, and the force over the measured lag agrees
//! with the latter: 170 N / 4.88 um = 34.8 N/um in trial 1. [`stiffness_from_k`] inverts eq. (3);
//! [`paper_eq8_contradicts_eq3`] keeps eq. (8).
//!
//! # What is not modelled
//! In the recursion: the angle within a revolution, which [`InfeedProfile`] has. Waves on the wheel
//! and waves shorter than the contact. A contact stiffness that grows with load; thermal growth of part
//! and machine, but for [`PlungeDeviations`]; drift of the stiffness. Heat at low Péclet number (below 10 the moving band is a few per cent high); the film
//! boiling of the coolant. The scatter of a roughness. In the design of a cycle: work rotation that changes
//! between phases.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

mod basis;
mod claims;
mod cycle;
mod first_order;
mod identify;
mod infeed;
mod law;
mod load;
mod parameters;
mod profile;
mod records;
mod signature;
mod stiffness;
mod table;
mod transient;
mod trial;
mod trial_table;
mod waves;

pub use basis::Basis;
pub use claims::claims;
pub use cycle::{
    CYCLE, Cycle, CycleError, CycleFile, CycleLimits, CyclePhase, CyclePoint, DressingInterval, DressingPlan, Surface,
    WheelLife, WheelState, cycle_time_estimate, depth_at_temperature, dressing_interval, fastest_cycle,
    fastest_cycle_while_dulling, grind_cycle,
};
pub use first_order::{FirstOrderState, InfeedFirstOrder, TimeConstant};
pub use identify::{
    Advice, BestRevolutions, Bootstrap, Estimate, ForceFit, Identification, IdentifyError, IdentifyOptions,
    ImpossibleTrial, Joint, MeasurementErrors, Pooled, Scatter, Shifted, TrialLag, fit_force_trace, identify,
    lag_from_rise, lag_from_spark_out, lag_from_stock, lag_sd, paper_trials, revolutions_of_least_error,
};
pub use infeed::Infeed;
pub use load::Load;
pub use parameters::{PARAMETER_SETS, Parameters, SetError};
pub use profile::{InfeedProfile, ProfileState, STATIONS};
pub use records::{Input, Output, State};
pub use signature::{PlungeDesign, PlungeDeviations, PlungeReading, PlungeShape, Separability, separability};
pub use stiffness::{lag, paper_eq8_contradicts_eq3, remaining_stiffness, series_stiffness, stiffness_from_k};
pub use table::{TableError, TableFault, TableNote, TableReason};
pub use transient::{decay_time_constant, deviation_after, lag_time_constant, revolutions_to, stock_after};
pub use trial::{ForceSample, Rounded, Trial, TrialFault};
pub use trial_table::{TrialTable, read_force_traces, read_trials};
pub use waves::{Structure, Wave, fastest_growing_wave, wave};
