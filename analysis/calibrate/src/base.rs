//! What is known of a tool before its calibration, and what an edge meets.

use std::sync::Arc;
use toolroom_cutting::CutterLife;
use toolroom_process::{AnyRecord, ModelError};
use toolroom_wear::{Chipping, Cut, Pair, WearLaw, check_tilt};

/// A process whose wear can be calibrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Process {
    /// Turning: feeds count per revolution.
    Turning,
    /// Milling: feeds count per tooth, and cuts have a width.
    Milling,
}

impl Process {
    /// Word in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Turning => "turning",
            Self::Milling => "milling",
        }
    }

    /// Column of the feed in records.
    pub fn feed(self) -> &'static str {
        match self {
            Self::Turning => "feed_per_rev",
            Self::Milling => "feed_per_tooth",
        }
    }
}

/// A parameter set as far as wear goes: what a calibration starts from, and what it ends with.
#[derive(Clone, Debug)]
pub enum Base {
    /// Turning.
    Turning {
        /// Tool and work material.
        pair: Box<Pair>,
        /// Wear laws that their set states beside the one that it uses: what is known of those beforehand.
        others: Arc<[WearLaw]>,
    },
    /// The life of a milling cutter of this diameter, m.
    Milling {
        /// The group `life` of its set.
        life: CutterLife,
        /// Diameter of the cutter: no width of cut is greater.
        diameter: f64,
        /// The group `chipping` of its set.
        chipping: Chipping,
    },
}

impl From<&Pair> for Base {
    fn from(pair: &Pair) -> Self {
        Self::Turning { pair: Box::new(pair.clone()), others: Arc::default() }
    }
}

impl Base {
    /// The process.
    pub fn process(&self) -> Process {
        match self {
            Self::Turning { .. } => Process::Turning,
            Self::Milling { .. } => Process::Milling,
        }
    }

    /// Flank wear at which an edge is worn out, m.
    pub fn wear_limit(&self) -> f64 {
        match self {
            Self::Turning { pair, .. } => pair.limits.wear_limit,
            Self::Milling { life, .. } => life.wear_limit,
        }
    }

    /// The cut at which the set states its level.
    pub fn reference(&self) -> Condition {
        match self {
            Self::Turning { pair, .. } => pair.reference_cut().into(),
            Self::Milling { life, .. } => Condition {
                width: Some(life.reference_width),
                ..Cut::nominal(life.reference_speed, life.reference_feed, life.reference_depth).into()
            },
        }
    }

    /// Share of the time in cut during which an edge is in the material: a tooth is for part of a rotation.
    pub(crate) fn share_in_cut(&self, condition: &Condition) -> f64 {
        match self {
            Self::Turning { .. } => 1.0,
            Self::Milling { life, diameter, .. } => {
                let width = condition.width.unwrap_or(life.reference_width).min(*diameter);
                (1.0 - 2.0 * width / diameter).acos() / std::f64::consts::TAU
            }
        }
    }

    /// Hazard of chipping of the set.
    pub fn chipping(&self) -> &Chipping {
        match self {
            Self::Turning { pair, .. } => &pair.chipping,
            Self::Milling { chipping, .. } => chipping,
        }
    }

    /// The same with its level stated at another cut, where the level of the law belongs to one cut only. A prior of a level
    /// says little of cuts far from its own.
    #[must_use]
    pub fn referred_to(self, condition: &Condition) -> Self {
        match self {
            // Its laws have levels of different kinds, which their groups state at the reference cut of the set.
            Self::Turning { .. } => self,
            Self::Milling { life, diameter, chipping } => {
                let reference = Condition { group: 0, ..*condition };
                let reference_life = Self::Milling { life, diameter, chipping }
                    .taylor(&reference)
                    .map_or(life.reference_life, |(minutes, ..)| minutes * 60.0);
                let [reference_speed, reference_feed, reference_depth, width] = reference.quantities();
                let reference_width =
                    if reference.width.is_some() { width.min(diameter) } else { life.reference_width };
                let life = CutterLife {
                    reference_life: reference_life.clamp(1.0, 1e7),
                    reference_speed,
                    reference_feed,
                    reference_depth,
                    reference_width,
                    ..life
                };
                Self::Milling { life, diameter, chipping }
            }
        }
    }

    /// The same with the level of a law of lives in turning stated at another cut.
    pub(crate) fn taylor_referred_to(&mut self, condition: &Condition) {
        if let Self::Turning { pair, .. } = self
            && let WearLaw::ExtendedTaylor(law) = &mut pair.law
        {
            law.reference_speed = condition.cut.cutting_speed;
            law.reference_feed = condition.cut.feed_per_rev;
            law.reference_depth = condition.cut.depth_of_cut;
        }
    }

    /// The record of the wear law.
    pub(crate) fn law_mut(&mut self) -> &mut dyn AnyRecord {
        match self {
            Self::Turning { pair, .. } => pair.law.record_mut(),
            Self::Milling { life, .. } => life,
        }
    }

    /// Whether the stages of the wear curve fit together.
    ///
    /// # Errors
    /// [`ModelError::Contradiction`] where the tilt is too large for the contrast.
    pub(crate) fn stages(&self) -> Result<(), ModelError> {
        match self {
            Self::Turning { pair, .. } => pair.law.check(),
            Self::Milling { life, .. } => check_tilt(life.stage_contrast, life.stage_tilt),
        }
    }

    /// Life in min and contrast and tilt of the wear curve under a condition, where the law is one of lives.
    pub(crate) fn taylor(&self, condition: &Condition) -> Option<(f64, f64, f64)> {
        let cut = &condition.cut;
        match self {
            Self::Turning { pair, .. } => match &pair.law {
                WearLaw::ExtendedTaylor(law) => Some((law.tool_life(cut) / 60.0, law.stage_contrast, law.stage_tilt)),
                WearLaw::EnergyBalance(_) | WearLaw::TakeyamaMurata(_) | WearLaw::Usui(_) => None,
            },
            Self::Milling { life, diameter, .. } => {
                let width = condition.width.unwrap_or(life.reference_width).min(*diameter);
                let damage = (cut.cutting_speed / life.reference_speed).powf(life.speed_exponent)
                    * (cut.feed_per_rev / life.reference_feed).powf(life.feed_exponent)
                    * (cut.depth_of_cut / life.reference_depth).powf(life.depth_exponent)
                    * (width / life.reference_width).powf(life.width_exponent);
                Some((life.reference_life / damage / 60.0, life.stage_contrast, life.stage_tilt))
            }
        }
    }
}

/// What an edge meets: cutting data, and the group of edges to which it belongs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Condition {
    /// Cutting data; in milling the feed is that of a tooth.
    pub cut: Cut,
    /// Width of cut in milling, m.
    pub width: Option<f64>,
    /// Group of the edge; edges of group 0 wear at the level of the law, the others faster by a factor of their own.
    pub group: usize,
}

impl From<Cut> for Condition {
    fn from(cut: Cut) -> Self {
        Self { cut, width: None, group: 0 }
    }
}

impl Condition {
    /// The same at another cutting speed, m/s.
    pub fn at_speed(&self, cutting_speed: f64) -> Self {
        Self { cut: self.cut.at_speed(cutting_speed), ..*self }
    }

    /// Speed, feed, depth and width: m/s and m.
    pub(crate) fn quantities(&self) -> [f64; 4] {
        [self.cut.cutting_speed, self.cut.feed_per_rev, self.cut.depth_of_cut, self.width.unwrap_or(1.0)]
    }

    /// The same cut, whatever the group.
    pub(crate) fn same_cut(&self, other: &Self) -> bool {
        self.quantities() == other.quantities()
    }
}
