//! Stability and vibration of turning and milling.
mod error;
mod gauss;
pub mod paper;
mod verdict;
pub use error::ChatterError;
pub use verdict::{ChatterKind, StabilityVerdict};
