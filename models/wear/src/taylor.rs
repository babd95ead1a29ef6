//! Taylor's tool-life law with a flank-wear curve.

use crate::temperature::power;
use crate::{Cut, LARGEST_CONTRAST, LARGEST_TILT, wear::Wear, wear_stage};
use toolroom_process::{Number, record};

record! {
    /// Extended Taylor tool life, with a flank-wear curve that reaches the wear limit at that
    /// life. Speed and state of wear are separable: constant speed is optimal, adaptive speed
    /// gains nothing.
    ///
    /// `tool_life = reference_life · (v/v_r)^-p · (f/f_r)^-q · (a_p/a_r)^-r / (wear_factor · hardness^n)`,
    /// `d flank_wear / d time = wear_limit / (tool_life · s(x))` with `x = flank_wear/wear_limit` and
    /// `s(x) = 1 + stage_contrast·(6·x·(1 - x) - 1) + stage_tilt·(2·x - 1)`, whose integral over
    /// the life is 1 ([`wear_stage`](crate::wear_stage)). The whole of it counts as mechanical wear.
    ///
    /// # Validity
    /// p ≥ 1; the speed range in which the exponents were measured.
    ///
    /// # Source
    /// Taylor 1907 with the exponents of feed and depth (handbook form, recalled); the
    /// three-stage curve is an assumption. Defaults (steel, carbide): v = 420/(T^0.2 t^0.15 s^0.2)
    /// of Kosilova & Meshcheryakov, recalled.
    pub struct ExtendedTaylor {
        /// Tool life at the reference cut.
        reference_life: Real["s" => "min"] = 3600.0, 1.0..=1e7;
        /// Exponent of speed, p = 1/m.
        speed_exponent: Real = 5.0, 1.0..=20.0;
        /// Exponent of feed, q.
        feed_exponent: Real = 1.0, 0.0..=10.0;
        /// Exponent of depth of cut, r.
        depth_exponent: Real = 0.75, 0.0..=10.0;
        /// Exponent of hardness, n.
        hardness_exponent: Real = 1.0, 0.0..=5.0;
        /// Contrast of the three wear stages: 0 is a straight line, near 1 a sharp S.
        stage_contrast: Real = 0.6, 0.0..=LARGEST_CONTRAST;
        /// Tilt of the wear curve: positive where a new edge wears faster than a spent one. At most
        /// 0.95·(1 - stage_contrast) in absolute value.
        stage_tilt: Real = 0.0, -LARGEST_TILT..=LARGEST_TILT;
        /// Flank wear at the end of the life.
        wear_limit: Real["m" => "mm"] = 0.3e-3, 1e-6..=5e-3;
        /// Reference speed.
        reference_speed: Real["m/s" => "m/min"] = 222.0 / 60.0, 1e-3..=50.0;
        /// Reference feed.
        reference_feed: Real["m" => "mm/rev"] = 0.3e-3, 1e-6..=5e-3;
        /// Reference depth of cut.
        reference_depth: Real["m" => "mm"] = 1.5e-3, 1e-6..=20e-3;
    }
}

impl<N: Number> ExtendedTaylor<N> {
    /// Tool life at `cut`, s.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Cut, ExtendedTaylor};
    /// let taylor = ExtendedTaylor::default();
    /// let life = taylor.tool_life(&Cut::nominal(2.0 * taylor.reference_speed, 0.3e-3, 1.5e-3));
    /// assert!((life - 3600.0 / 32.0).abs() < 1e-9); // 2^5
    /// ```
    pub fn tool_life(&self, cut: &Cut<N>) -> N {
        self.wear_limit / (self.level(cut).mechanical_per_path * cut.cutting_speed)
    }

    /// Mean wear per path over the life; finite at rest, since p ≥ 1.
    pub(crate) fn level(&self, cut: &Cut<N>) -> Wear<N> {
        let mechanical_per_path = self.wear_limit / (self.reference_life * self.reference_speed)
            * power(cut.cutting_speed / self.reference_speed, self.speed_exponent - 1.0)
            * power(cut.feed_per_rev / self.reference_feed, self.feed_exponent)
            * power(cut.depth_of_cut / self.reference_depth, self.depth_exponent)
            * power(cut.hardness, self.hardness_exponent)
            * cut.mechanical_factor
            * cut.wear_factor;
        Wear { mechanical_per_path, thermal_rate: N::from(0.0) }
    }

    pub(crate) fn wear(&self, level: Wear<N>, flank_wear: N) -> Wear<N> {
        let stage = wear_stage(flank_wear / self.wear_limit, self.stage_contrast, self.stage_tilt);
        Wear { mechanical_per_path: level.mechanical_per_path / stage, ..level }
    }

    pub(crate) fn weights(&self) -> (N, N) {
        (-self.speed_exponent + 1.0, N::from(0.0))
    }
}
