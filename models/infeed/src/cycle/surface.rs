//! Roughness of the ground surface.

use super::DressingPlan;
use toolroom_process::record;

record! {
    /// A roughness that was measured, from which others follow.
    ///
    /// `Ra = R2 s_d^(1/2) a_d^(1/4) (Q'_w/v_s)^x` under infeed, with lead s_d and depth a_d of dressing. R2 is worked out
    /// from the measured value. In spark-out the roughness falls towards a share of what the infeed left, by the lag K a
    /// revolution.
    ///
    /// # Source
    /// Malkin, Grinding Technology (recalled): x between 0.15 and 0.6. The share after a long spark-out: assumption.
    pub struct Surface {
        /// Roughness Ra that was measured at the end of an infeed without spark-out.
        measured: Real["m" => "um"] = 0.4e-6, 1e-9..=1e-3;
        /// Specific removal rate of that infeed.
        removal_rate: Real["m2/s" => "mm2/s"] = 1e-6, 1e-9..=1e-2;
        /// Lead of the dressing before it.
        lead: Real["m" => "mm"] = 0.1e-3, 1e-7..=1e-2;
        /// Depth of the dressing before it.
        depth: Real["m" => "um"] = 20e-6, 1e-8..=1e-3;
        /// Exponent of the removal rate.
        exponent: Real = 0.3, 0.15..=0.6;
        /// Share of the roughness that is left after a long spark-out.
        sparked_out: Real = 0.5, 0.05..=1.0;
    }
}

impl Surface {
    /// R2 s_d^(1/2) a_d^(1/4), m; the factor of (Q'_w/v_s)^x, which is in (m)^x, at another dressing.
    ///
    /// ```
    /// use toolroom_infeed::{DressingPlan, Surface};
    /// let measured = Surface { measured: 0.4e-6, removal_rate: 3e-6, ..Surface::default() };
    /// let plan = DressingPlan::default(); // dressed as it was then
    /// let again = measured.under_infeed(3e-6, 35.0, 35.0, &plan);
    /// assert!((again - 0.4e-6f64).abs() < 1e-18);
    /// ```
    pub fn under_infeed(
        &self,
        removal_rate: f64,
        wheel_speed: f64,
        measured_wheel_speed: f64,
        dressing: &DressingPlan,
    ) -> f64 {
        let thickness = (removal_rate / wheel_speed) / (self.removal_rate / measured_wheel_speed);
        let lead = (dressing.lead / self.lead).sqrt();
        let depth = (dressing.depth / self.depth).sqrt().sqrt();
        self.measured * lead * depth * thickness.powf(self.exponent)
    }

    /// The constant R2 of `Ra = R2 s_d^(1/2) a_d^(1/4) (Q'_w/v_s)^x` with lengths in mm and Q'_w/v_s in um: what a
    /// handbook would print.
    pub fn constant(&self, measured_wheel_speed: f64) -> f64 {
        const MM: f64 = 1e3;
        let thickness = self.removal_rate / measured_wheel_speed * 1e6;
        let dressing = (self.lead * MM).sqrt() * (self.depth * MM).sqrt().sqrt();
        self.measured * 1e6 / (dressing * thickness.powf(self.exponent))
    }
}

/// The roughness law of a task: what the search asks.
#[derive(Clone, Copy, Debug)]
pub(super) struct Roughness {
    pub surface: Surface,
    pub dressing: DressingPlan,
    /// Wheel speed when the roughness was measured, m/s.
    pub measured_wheel_speed: f64,
}

impl Roughness {
    /// Of a surface measured at a wheel speed (m/s), after another dressing.
    pub fn from_dressing((surface, dressing, measured_wheel_speed): (&Surface, &DressingPlan, f64)) -> Self {
        Self { surface: *surface, dressing: *dressing, measured_wheel_speed }
    }

    /// Roughness under infeed, m.
    pub fn under_infeed(&self, removal_rate: f64, wheel_speed: f64) -> f64 {
        self.surface.under_infeed(removal_rate, wheel_speed, self.measured_wheel_speed, &self.dressing)
    }

    /// Roughness in spark-out, of which `left` of what can go is still there, m.
    pub fn in_spark_out(&self, under_infeed: f64, left: f64) -> f64 {
        let end = under_infeed * self.surface.sparked_out;
        end + (under_infeed - end) * left
    }
}
