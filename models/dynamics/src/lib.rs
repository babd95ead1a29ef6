//! Measured dynamics of machine, tool and workpiece: from a tap test to vibration modes with their uncertainty.
//!
//! ```text
//!  CSV, universal file ──► Measurement: receptance and coherence over frequency
//!  Record: hits over time ─┘   (responses)
//!  Record: sound of a cut ──► listen: speed, chatter, its frequency
//!                              ├── Stabilisation ──► poles over the order of a common denominator
//!                              └── fit ──► Fit: modes, covariance, quality, refusals
//!  ForceTest: mean forces over the feed ──► Coefficients of the cutting force; MaterialGroup where none was measured
//!  Segments, Joint, BaseMode ──► chain, Body::on: receptance at the tip of a tool on a spindle
//!  taps on a Blank ──► Blank::face: receptance of the spindle that holds it
//! ```
//!
//! # What is modelled
//! Real modes with viscous damping, `H_pq(w) = Σ phi_pr phi_qr/(w_r² − w² + 2 i zeta_r w_r w) + U_pq − L_pq/w²`, with the upper
//! residual U of the modes above the range and the lower residual L of a body that moves freely below it.
//!
//! # What is not modelled
//! Complex modes, gyroscopic splitting, joints with friction.

#![deny(clippy::wildcard_enum_match_arm)]

mod blank;
mod coherence;
mod comb;
mod coupling;
mod csv;
mod cuts;
mod error;
mod fft;
mod fit;
mod fitted_mode;
mod folded;
mod frames;
mod frf;
mod groups;
mod hammer;
mod likelihood;
mod line;
mod noise;
mod quality;
mod read;
mod record;
mod selection;
mod slot;
mod sound;
mod stabilisation;
mod structure;
mod table;
mod uff;
mod unit;
mod wav;

pub use blank::{Blank, BlankResponse};
pub use coherence::CoherenceTable;
pub use coupling::{BaseMode, Body, Damper, Joint, Material, Receptance, Segment, base, chain};
pub use csv::{read_csv, read_csv_by_speed};
pub use cuts::{ShopCut, ShopCutError, read_shop_cuts};
pub use error::{DynamicsError, RecordProblem, UniversalProblem, WaveProblem};
pub use fit::{Fit, FitOptions, fit};
pub use fitted_mode::{Estimate, FittedMode};
pub use frf::{Direction, Frf, Measurement};
pub use groups::{GROUPS_SOURCE, MATERIAL_GROUPS, MaterialGroup};
pub use hammer::{Estimator, HammerOptions, responses};
pub use line::{Line, Origin};
pub use quality::{Quality, REFUSAL_CODES, Refusal};
pub use read::{TapOptions, measure, measure_by_speed, read_coherence};
pub use record::{Channel, FullScale, Record, Signal, is_record, read_record};
pub use selection::SelectionProblem;
pub use slot::{Coefficient, Coefficients, ForceLine, ForceTest, ForceTestError, LackOfFit, TestedCut, read_forces};
pub use sound::{Chatter, Cutting, Heard, listen};
pub use stabilisation::{Pole, stabilisation};
pub use structure::{Scatter, StructureText, mode_keys, quoted};
pub use uff::read_uff;
pub use unit::Motion;
