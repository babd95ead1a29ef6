//! Tool life in milling.

use std::f64::consts::TAU;
use toolroom_process::record;

record! {
    /// Handbook tool life of end mills:
    /// `cutting_speed = speed_constant·D^q / (T^m·t^x·f^y·B^u·z^p)` with D, t, f, B in mm and T in
    /// min, solved for T.
    ///
    /// | symbol | field |
    /// |---|---|
    /// | C_v·K_v | `speed_constant` |
    /// | q, m, x, y, u, p | `diameter_exponent`, `life_exponent`, `immersion_exponent`, `feed_exponent`, `depth_exponent`, `teeth_exponent` |
    /// | T_nom | `nominal_life` |
    ///
    /// # Source
    /// Kosilova & Meshcheryakov, vol. 2, tables 39 and 40 (T15K6 end mill, steel 45), recalled.
    pub struct MillLife {
        /// Cutting speed for a life of one minute where every factor is 1.
        speed_constant: Real["m/s" => "m/min"] = 234.0 / 60.0, 1e-3..=1e3;
        /// Exponent of the diameter, q.
        diameter_exponent: Real = 0.44, 0.0..=2.0;
        /// Exponent of the life, m.
        life_exponent: Real = 0.37, 0.01..=1.0;
        /// Exponent of the radial immersion, x.
        immersion_exponent: Real = 0.24, 0.0..=2.0;
        /// Exponent of the feed per tooth, y.
        feed_exponent: Real = 0.26, 0.0..=2.0;
        /// Exponent of the width of edge, u.
        depth_exponent: Real = 0.1, 0.0..=2.0;
        /// Exponent of the number of teeth, p.
        teeth_exponent: Real = 0.13, 0.0..=2.0;
        /// Life for which handbook regimes are made, and the least admissible one.
        nominal_life: Real["s" => "min"] = 7200.0, 1.0..=1e7;
    }
}

const MM: f64 = 1e-3;
const MINUTE: f64 = 60.0;

impl MillLife {
    /// Tool life, s, at `spindle_speed` (rad/s) and a radial `immersion`, all lengths in m. The
    /// planner takes the product apart: each factor depends on one of speed, immersion and feed.
    ///
    /// # Examples
    /// ```
    /// use toolroom_contour::MillLife;
    /// let rpm = std::f64::consts::TAU / 60.0;
    /// let life = MillLife::default().tool_life(1600.0 * rpm, 0.08e-3, 3e-3, 0.03, 4.0, 0.032);
    /// assert!((life / 60.0 - 120.353).abs() < 0.001);
    /// ```
    pub fn tool_life(
        &self,
        spindle_speed: f64,
        feed_per_tooth: f64,
        immersion: f64,
        depth_of_cut: f64,
        teeth: f64,
        diameter: f64,
    ) -> f64 {
        self.of_cutter(depth_of_cut, teeth, diameter)
            * self.of_speed(spindle_speed, diameter)
            * self.of_immersion(immersion)
            * self.of_feed(feed_per_tooth)
    }

    /// Cutting speed, m/s, at which the edge lasts `life` seconds.
    pub fn speed_for(
        &self,
        life: f64,
        feed_per_tooth: f64,
        immersion: f64,
        depth_of_cut: f64,
        teeth: f64,
        diameter: f64,
    ) -> f64 {
        let at_one =
            self.of_cutter(depth_of_cut, teeth, diameter) * self.of_immersion(immersion) * self.of_feed(feed_per_tooth);
        self.speed_constant * (at_one / life).powf(self.life_exponent)
    }

    /// Life that makes an edge's cost least at given feed: `(1/m − 1)·(change_time +
    /// edge_cost/machine_rate)`, s (Taylor's economics).
    pub fn economic_life(&self, change_time: f64, edge_cost: f64, machine_rate: f64) -> f64 {
        (1.0 / self.life_exponent - 1.0) * (change_time + edge_cost / machine_rate)
    }

    /// Life at `speed_constant` where immersion and feed are 1 mm.
    pub(crate) fn of_cutter(&self, depth_of_cut: f64, teeth: f64, diameter: f64) -> f64 {
        let ratio = (diameter / MM).powf(self.diameter_exponent)
            / ((depth_of_cut / MM).powf(self.depth_exponent) * teeth.powf(self.teeth_exponent));
        MINUTE * ratio.powf(1.0 / self.life_exponent)
    }

    /// Factor of the spindle speed.
    pub(crate) fn of_speed(&self, spindle_speed: f64, diameter: f64) -> f64 {
        let cutting_speed = spindle_speed / TAU * std::f64::consts::PI * diameter;
        (self.speed_constant / cutting_speed).powf(1.0 / self.life_exponent)
    }

    /// Factor of the radial immersion.
    pub(crate) fn of_immersion(&self, immersion: f64) -> f64 {
        (immersion / MM).powf(-self.immersion_exponent / self.life_exponent)
    }

    /// Factor of the feed per tooth.
    pub(crate) fn of_feed(&self, feed_per_tooth: f64) -> f64 {
        (feed_per_tooth / MM).powf(-self.feed_exponent / self.life_exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_speed_for_a_life_gives_that_life() {
        let life = MillLife::default();
        let speed = life.speed_for(5400.0, 0.1e-3, 1e-3, 0.02, 3.0, 0.02);
        let back = life.tool_life(speed / 0.01, 0.1e-3, 1e-3, 0.02, 3.0, 0.02);
        assert!((back / 5400.0 - 1.0).abs() < 1e-12);
    }
}
