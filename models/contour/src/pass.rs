//! One pass around the contour: what is cut, how exactly, and how it is modelled.

use crate::{CornerPolicy, Milling, PathError};
use toolroom_process::record;

record! {
    /// Allowance, limits and candidates of one pass. Defaults: the finishing pass of the
    /// reference example; table feeds are assumptions.
    pub struct Pass {
        /// Allowance along the wall's normal, t.
        allowance: Real["m" => "mm"] = 0.5e-3, 1e-7..=0.5;
        /// Height of the wall, B.
        depth_of_cut: Real["m" => "mm"] = 30e-3, 1e-6..=0.5;
        /// Form tolerance δ.
        tolerance: Real["m" => "mm"] = 0.05e-3, 1e-7..=0.1;
        /// Admissible roughness Rz.
        roughness: Real["m" => "um"] = 10e-6, 1e-8..=1e-2;
        /// Feed per tooth of the handbook table.
        table_feed: Real["m" => "mm"] = 0.06e-3, 1e-7..=5e-3;
        /// Share of the static deflection that the programme compensates.
        deflection_compensation: Real = 0.0, 0.0..=1.0;
        /// Hardness of the work over the nominal one.
        hardness_ratio: Real = 1.0, 0.3..=3.0;
        /// Flank wear of the edge.
        flank_wear: Real["m" => "mm"] = 0.0, 0.0..=2e-3;
        /// Least candidate of the feed per tooth.
        lowest_feed_per_tooth: Real["m" => "mm"] = 0.02e-3, 1e-7..=5e-3;
        /// Greatest candidate of the feed per tooth.
        highest_feed_per_tooth: Real["m" => "mm"] = 0.30e-3, 1e-7..=5e-3;
        /// Step between candidates.
        feed_step: Real["m" => "mm"] = 0.002e-3, 1e-7..=5e-3;
    }
}

impl Pass {
    /// The roughing pass of the reference example: 3 mm at 0.2 mm.
    pub fn rough() -> Self {
        Self { allowance: 3e-3, tolerance: 0.2e-3, roughness: 40e-6, table_feed: 0.08e-3, ..Self::default() }
    }

    /// How deep the cutter may cut into a wall that it does not mill at that moment, m: a tenth of the tolerance (assumption).
    pub fn gouge(&self) -> f64 {
        0.1 * self.tolerance
    }

    /// Candidates of the feed per tooth, m, ascending.
    pub fn feeds(&self) -> Vec<f64> {
        let steps = ((self.highest_feed_per_tooth - self.lowest_feed_per_tooth) / self.feed_step + 1e-9).floor();
        (0..=steps.max(0.0) as u32).map(|i| self.lowest_feed_per_tooth + f64::from(i) * self.feed_step).collect()
    }
}

toolroom_form::vocabulary! {
    /// Which deflection the accuracy constraint sees.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum FormError {
        /// Deflection under the force averaged over a revolution.
        #[default]
        Mean = "mean",
        /// Greatest deflection over the height of the wall, each height at the instant in which a
        /// helical edge finishes it ([`HelicalCut`](crate::HelicalCut)).
        Helical = "helical",
    }
}

toolroom_form::vocabulary! {
    /// Where the engagement is taken that limits the feed.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum EngagementModel {
        /// One engagement a section, as the paper has it: before a hollow wall limits are broken, because the rim is in the
        /// allowance of the next section already.
        #[default]
        Section = "section",
        /// The engagement along the path, with a bound between samples ([`Along`](crate::Along)): sections are planned in
        /// pieces.
        Path = "path",
    }
}

/// The models that a plan is made with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Models {
    /// Down or up milling.
    pub milling: Milling,
    /// Error of the drives.
    pub path_error: PathError,
    /// Error of the bent cutter.
    pub form_error: FormError,
    /// Sharp corners.
    pub corners: CornerPolicy,
    /// Where the engagement is taken.
    pub engagement: EngagementModel,
}

impl Default for Models {
    /// Down milling, ideal servo, average force, slowing down in corners, one engagement a section.
    fn default() -> Self {
        Self {
            milling: Milling::Down,
            path_error: PathError::default(),
            form_error: FormError::default(),
            corners: CornerPolicy::SlowDown { tolerance: None },
            engagement: EngagementModel::default(),
        }
    }
}
