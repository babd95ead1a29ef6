//! Why there is no cycle.

use crate::Rounded;
use toolroom_process::ModelError;

/// Why there is no cycle. Lengths are in um.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CycleError {
    /// Input, parameters or limits outside their range.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Even the coolest depth is too hot.
    #[error(
        "{limit} = {allowed} K conflicts with the heat of this wheel: no depth of cut stays below {least:.0} K; use more \
         coolant, a sharper wheel or faster work rotation"
    )]
    TooHotAtAnyDepth {
        /// The limit.
        limit: &'static str,
        /// Its value, K.
        allowed: f64,
        /// Least temperature rise at any depth, K.
        least: f64,
    },
    /// A limit that the wheel breaks at any depth of cut.
    #[error(
        "{limit} conflicts with this wheel: at any depth of cut it is {least}; use a sharper wheel or change the limit"
    )]
    NoDepth {
        /// The limit.
        limit: &'static str,
        /// What it comes to at least, with its unit.
        least: String,
    },
    /// A limit of roughness without a roughness that was measured.
    #[error(
        "roughness is limited and none was measured: give [roughness] with measured and removal_rate (a cycle file of \
         `grind`; operations of a shop have none)"
    )]
    NoRoughness,
    /// Even the finest finish is too rough.
    #[error(
        "roughness = {} um conflicts with infeed_step: the finest finish infeed leaves {least:.4} um however long the \
         spark-out; dress finer", Rounded(*.allowed)
    )]
    TooRough {
        /// The limit.
        allowed: f64,
        /// Roughness at the finest finish infeed after a long spark-out.
        least: f64,
    },
    /// A limit of the finish phase lies below the first infeed that can be set.
    #[error(
        "{limit} and infeed_step conflict: the finish infeed must stay below {depth_limit:.4} um, the \
         machine sets multiples of {} um", Rounded(*.step)
    )]
    FinishBelowStep {
        /// The limit.
        limit: &'static str,
        /// Greatest depth of the finish phase.
        depth_limit: f64,
        /// Step of the infeed.
        step: f64,
    },
    /// More finish stock than stock.
    #[error(
        "finish_stock = {} um and stock = {} um conflict: {removable:.4} um can be removed at most",
        Rounded(*.finish_stock), Rounded(*.stock)
    )]
    FinishStockBeyondStock {
        /// Finish stock requested.
        finish_stock: f64,
        /// Stock.
        stock: f64,
        /// What a cycle can remove at most.
        removable: f64,
    },
    /// Threshold force and wheel wear alone leave more than allowed.
    #[error(
        "size_error = {} um conflicts with threshold force and wheel wear: they alone leave {threshold:.4} um and \
         {wear:.4} um however long the spark-out", Rounded(*.allowed)
    )]
    SizeBeyondReach {
        /// The limit.
        allowed: f64,
        /// Left by the threshold force.
        threshold: f64,
        /// Left by the wear of the wheel on this part.
        wear: f64,
    },
    /// A cycle exists but is absurdly long.
    #[error("{limit} needs more than {revolutions} revolutions; the lag is {lag:.6}")]
    TooLong {
        /// The limit that needs them.
        limit: &'static str,
        /// Length at which the search ends.
        revolutions: u32,
        /// Lag K.
        lag: f64,
    },
}

impl CycleError {
    /// The limits that conflict, as keys of [`super::CycleLimits`]; none where the fault is another one.
    pub fn limits(&self) -> &'static [&'static str] {
        match self {
            Self::Model(_) => &[],
            Self::TooHotAtAnyDepth { limit: "finish_temperature_rise", .. } => &["finish_temperature_rise"],
            Self::TooHotAtAnyDepth { .. } => &["rough_temperature_rise"],
            Self::NoDepth { limit: "power", .. } => &["power"],
            Self::NoDepth { limit: "normal_force", .. } => &["normal_force"],
            Self::NoDepth { .. } => &["burn_margin"],
            Self::NoRoughness => &["roughness"],
            Self::TooRough { .. } => &["roughness", "infeed_step"],
            Self::FinishBelowStep { limit: "power", .. } => &["power", "infeed_step"],
            Self::FinishBelowStep { limit: "normal_force", .. } => &["normal_force", "infeed_step"],
            Self::FinishBelowStep { limit: "burn_margin", .. } => &["burn_margin", "infeed_step"],
            Self::FinishBelowStep { limit: "material_removal", .. } => &["material_removal", "infeed_step"],
            Self::FinishBelowStep { limit: "rough_temperature_rise", .. } => &["rough_temperature_rise", "infeed_step"],
            Self::FinishBelowStep { .. } => &["finish_temperature_rise", "infeed_step"],
            Self::FinishStockBeyondStock { .. } => &["finish_stock", "stock"],
            Self::SizeBeyondReach { .. } => &["size_error"],
            Self::TooLong { limit: "stock", .. } => &["stock", "rough_temperature_rise"],
            Self::TooLong { limit: "blank_roundness_error", .. } => &["blank_roundness_error", "roundness_error"],
            Self::TooLong { .. } => &["last_depth", "size_error", "roundness_error"],
        }
    }
}
