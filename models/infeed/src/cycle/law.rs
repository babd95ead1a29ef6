//! Depths of a cycle in closed form.

use crate::{Infeed, Input, State};

/// The revolution recursion in closed form: `h' = decay h + infeed/give`.
///
/// The closed form is that of a force exponent of 1 and of a wheel that stays as it is within the part.
#[derive(Clone, Copy)]
pub(super) struct Law {
    /// c = Cp/J.
    pub compliance: f64,
    /// g, wheel wear per depth.
    pub wear: f64,
    /// F0/J.
    pub threshold: f64,
    /// 1 + c + g.
    pub give: f64,
    /// c/(1 + c + g): the lag K where the wheel does not wear.
    pub decay: f64,
    /// Infeed over the depth to which it tends, 1 + g.
    pub steady: f64,
}

impl Law {
    /// The law of the wheel as it is.
    pub fn of(grinding: &Infeed, wheel: &State, input: &Input) -> Self {
        Self::with(grinding.shares(wheel, input))
    }

    /// The law of these shares: compliance, wear, threshold.
    pub fn with([compliance, wear, threshold]: [f64; 3]) -> Self {
        let give = 1.0 + compliance + wear;
        Self { compliance, wear, threshold, give, decay: compliance / give, steady: 1.0 + wear }
    }

    /// A law whose depths are never above those of a wheel that becomes blunter from this law to `blunt`: with c0 and c1 the
    /// least and the greatest compliance, `h' = (c h + infeed)/(1 + g + c') ≥ (c0 h + infeed)/(1 + g + c1)`.
    pub fn below(&self, blunt: &Self) -> Self {
        let give = 1.0 + blunt.compliance + self.wear.max(blunt.wear);
        Self {
            threshold: self.threshold.max(blunt.threshold),
            give,
            decay: self.compliance / give,
            steady: give - self.compliance,
            ..*self
        }
    }

    /// Depth after `revolutions` of infeed that starts at first contact.
    pub fn rough_depth(&self, infeed: f64, revolutions: u32) -> f64 {
        // Below the threshold force the wheel rubs for some revolutions first.
        let rubbing = (self.threshold / infeed).floor();
        let cutting = f64::from(revolutions) - rubbing - 1.0;
        if cutting < 0.0 {
            return 0.0;
        }
        let first = ((rubbing + 1.0) * infeed - self.threshold) / self.give;
        self.towards(first, infeed, cutting)
    }

    /// Depth `revolutions` after `depth` under another infeed.
    pub fn towards(&self, depth: f64, infeed: f64, revolutions: f64) -> f64 {
        let steady = infeed / self.steady;
        steady + (depth - steady) * self.decay.powf(revolutions)
    }
}
