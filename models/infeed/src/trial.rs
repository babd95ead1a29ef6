//! A plunge trial, and why one may be impossible.

use crate::basis::Basis;
use std::fmt;

/// One plunge trial: what was commanded and what was measured, in SI.
///
/// | symbol | field | unit |
/// |---|---|---|
/// | S | `infeed_per_rev` | m |
/// | n | `revolutions` | 1, counted from first contact |
/// | P | `stock_removed` | m of radius, when the wheel retracts |
/// | P_y | `normal_force` | N, at the end of the rise |
/// | P_z | `tangential_force` | N, at the end of the rise |
///
/// Table columns have the names of the fields; see [`read_trials`](crate::read_trials).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trial {
    /// Name of the trial.
    pub trial_id: String,
    /// Line of the file that it was read from.
    pub line: Option<usize>,
    /// Machine on which it was ground.
    pub machine: Option<String>,
    /// Commanded infeed per work revolution.
    pub infeed_per_rev: f64,
    /// Work revolutions under infeed.
    pub revolutions: f64,
    /// Work revolutions without infeed before retraction.
    pub spark_out_revolutions: f64,
    /// Infeed per work revolution of a finish stage behind the first one; 0 without one.
    pub finish_infeed_per_rev: f64,
    /// Work revolutions of the finish stage; 0 without one.
    pub finish_revolutions: f64,
    /// Rotation of the workpiece, rad/s.
    pub work_rotation_speed: Option<f64>,
    /// Radial stock removed, at retraction.
    pub stock_removed: Option<f64>,
    /// Steady normal force.
    pub normal_force: Option<f64>,
    /// Steady tangential force.
    pub tangential_force: Option<f64>,
    /// Revolutions after which the force has come to 95 % of its end.
    pub rise_revolutions: Option<f64>,
    /// Normal force at retraction, after the spark-out revolutions.
    pub force_after_spark_out: Option<f64>,
    /// The force as it was recorded, from the commanded start to retraction.
    pub force_trace: Vec<ForceSample>,
}

/// A point of a recorded force.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForceSample {
    /// Work revolutions since the commanded start.
    pub revolution: f64,
    /// Normal force, or any signal proportional to it.
    pub force: f64,
}

/// Why a trial cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TrialFault {
    /// A number that is infinite or none.
    #[error("{field} is not a finite number")]
    NotFinite {
        /// Field.
        field: &'static str,
    },
    /// A number that must be above zero.
    #[error("{field} = {value} {unit} must be above zero")]
    NotPositive {
        /// Field.
        field: &'static str,
        /// Display unit.
        value: Rounded,
        /// The display unit.
        unit: &'static str,
    },
    /// A number that must not be negative.
    #[error("{field} = {value} {unit} must not be negative")]
    Negative {
        /// Field.
        field: &'static str,
        /// Display unit.
        value: Rounded,
        /// The display unit.
        unit: &'static str,
    },
    /// One revolution holds no lag that could be told from the infeed.
    #[error("{revolutions} revolutions: at least 2 whole revolutions of infeed are needed")]
    TooFewRevolutions {
        /// Revolutions.
        revolutions: Rounded,
    },
    /// The stock exceeds what was commanded.
    #[error(
        "stock {stock} um is not below the commanded infeed of {revolutions} rev x {infeed_per_rev} um/rev = {infeed} \
         um: the machine cannot grind more than it is told to; count revolutions from first contact, and give stock \
         as radius, not as diameter"
    )]
    StockNotBelowInfeed {
        /// Stock removed, um.
        stock: Rounded,
        /// Revolutions.
        revolutions: Rounded,
        /// Infeed, um per revolution.
        infeed_per_rev: Rounded,
        /// Commanded infeed, um.
        infeed: Rounded,
    },
    /// A force that grows while the machine stands still.
    #[error("force_after_spark_out = {after} N is not below normal_force = {steady} N")]
    ForceGrowsInSparkOut {
        /// Force at retraction, N.
        after: Rounded,
        /// Steady force, N.
        steady: Rounded,
    },
    /// Nothing that would tell the lag.
    #[error(
        "no lag can be told by {}; give stock_removed, rise_revolutions, force_after_spark_out with normal_force and \
         spark_out_revolutions, or a recorded force with a rise or decay in it",
        match .basis { Basis::Both => "stock or force", Basis::Stock => "stock", Basis::Force => "force" }
    )]
    NoLag {
        /// What the lag was to be taken from.
        basis: Basis,
    },
}

impl TrialFault {
    /// Short name of the fault, for programs.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NotFinite { .. } | Self::NotPositive { .. } | Self::Negative { .. } => "out-of-range",
            Self::TooFewRevolutions { .. } => "too-few-revolutions",
            Self::StockNotBelowInfeed { .. } => "stock-beyond-infeed",
            Self::ForceGrowsInSparkOut { .. } => "force-grows",
            Self::NoLag { .. } => "no-lag",
        }
    }
}

/// A number told with six significant digits, or as many decimals as requested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounded(pub f64);

impl fmt::Display for Rounded {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match f.precision() {
            Some(decimals) => write!(f, "{:.decimals$}", self.0),
            None => write!(f, "{}", format!("{:.5e}", self.0).parse().unwrap_or(self.0)),
        }
    }
}

/// Metres to the unit in which people read them.
const UM: f64 = 1e6;

impl Trial {
    /// Infeed commanded in the whole trial, n S of each stage, m.
    pub fn commanded_infeed(&self) -> f64 {
        self.revolutions * self.infeed_per_rev + self.finish_revolutions * self.finish_infeed_per_rev
    }

    /// Everything that makes this trial impossible.
    ///
    /// ```
    /// use toolroom_infeed::{Trial, TrialFault};
    /// let trial = Trial { infeed_per_rev: 4.43e-6, revolutions: 14.6, stock_removed: Some(66e-6), ..Trial::default() };
    /// assert!(matches!(trial.faults()[0], TrialFault::StockNotBelowInfeed { .. }));
    /// ```
    pub fn faults(&self) -> Vec<TrialFault> {
        let mut faults = Vec::new();
        let optional = [
            ("stock_removed", self.stock_removed, UM, "um"),
            ("normal_force", self.normal_force, 1.0, "N"),
            ("tangential_force", self.tangential_force, 1.0, "N"),
            ("rise_revolutions", self.rise_revolutions, 1.0, "rev"),
            ("work_rotation_speed", self.work_rotation_speed, 30.0 / std::f64::consts::PI, "rpm"),
            ("force_after_spark_out", self.force_after_spark_out, 1.0, "N"),
        ];
        let required = [
            ("infeed_per_rev", Some(self.infeed_per_rev), UM, "um"),
            ("revolutions", Some(self.revolutions), 1.0, "rev"),
        ];
        for (field, value, scale, unit) in required.into_iter().chain(optional) {
            let Some(value) = value else { continue };
            if !value.is_finite() {
                faults.push(TrialFault::NotFinite { field });
            } else if value <= 0.0 {
                faults.push(TrialFault::NotPositive { field, value: Rounded(value * scale), unit });
            }
        }
        for (field, value, scale, unit) in [
            ("spark_out_revolutions", self.spark_out_revolutions, 1.0, "rev"),
            ("finish_infeed_per_rev", self.finish_infeed_per_rev, UM, "um"),
            ("finish_revolutions", self.finish_revolutions, 1.0, "rev"),
        ] {
            if !value.is_finite() {
                faults.push(TrialFault::NotFinite { field });
            } else if value < 0.0 {
                faults.push(TrialFault::Negative { field, value: Rounded(value * scale), unit });
            }
        }
        if self.force_trace.iter().any(|sample| !(sample.revolution.is_finite() && sample.force.is_finite())) {
            faults.push(TrialFault::NotFinite { field: "force_trace" });
        }
        if faults.is_empty() {
            self.contradictions(&mut faults);
        }
        faults
    }

    /// Numbers that are admissible one by one and impossible together.
    fn contradictions(&self, faults: &mut Vec<TrialFault>) {
        if self.revolutions <= 1.0 {
            faults.push(TrialFault::TooFewRevolutions { revolutions: Rounded(self.revolutions) });
        }
        if let Some(stock) = self.stock_removed
            && stock >= self.commanded_infeed()
        {
            faults.push(TrialFault::StockNotBelowInfeed {
                stock: Rounded(stock * UM),
                revolutions: Rounded(self.revolutions),
                infeed_per_rev: Rounded(self.infeed_per_rev * UM),
                infeed: Rounded(self.commanded_infeed() * UM),
            });
        }
        if let (Some(after), Some(steady)) = (self.force_after_spark_out, self.normal_force)
            && self.spark_out_revolutions > 0.0
            && after >= steady
        {
            faults.push(TrialFault::ForceGrowsInSparkOut { after: Rounded(after), steady: Rounded(steady) });
        }
    }
}
