//! Event logs of a shop against its nominal simulation.
//!
//! ```text
//!  events ─► State of each stay ─► Visit (one operation on one machine) ─► Block statistics
//!  scenario ─► Shop (what the planner believes) ──────────────────────────────┐     │
//!                                                 ShopModel: Forward ◄────────┴─────┘
//! ```
//! Times of single operations scatter, and what a shop lacks often shows in their scatter before
//! it shows in their mean: visits are therefore gathered in blocks (machine, day, part of a shift,
//! program), and a block has several channels: where its times lie (median), how far they spread,
//! how much longer than shorter outliers there are, what its mean is above its median. Spreads are
//! taken over normal scores of the probability integral transform under the nominal simulation. Waits
//! in queues are scored by the room `gap`.
//!
//! # Source
//! Normal scores of the randomised probability integral transform: Dunn & Smyth 1996. Short stops
//! as a Poisson process of exponential durations, 20 s in the mean: assumption.

mod action;
mod block;
mod booked;
mod catalogue;
mod constant;
mod expected;
mod figure;
mod logs;
mod model;
mod nominal;
mod queueing;
mod scaled;
mod scopes;
mod scrap;
mod shapes;
mod state;
mod stays;
mod stopped;
mod stops;
mod visit;
mod words;

pub use block::normal_score;
pub use constant::Constant;
pub use logs::{LogGroup, after, groups_of};
pub use model::ShopModel;
pub use nominal::{EdgeLife, JobSource, Program, Shop, Station};
pub use scaled::Scaled;
pub use scrap::{ExpectedScrap, expected_scrap, settled};
pub use state::State;
pub use stops::Shape;
pub use visit::{Breakdowns, SHORT_STOP, Visit, Visits, visits};
