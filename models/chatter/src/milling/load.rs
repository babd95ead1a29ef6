//! What a steady cut asks of the spindle and what it removes.

use super::Milling;
use super::cutter::Engagement;
use super::profile::{SLICES, slices};
use crate::Turning;
use crate::error::{ChatterError, positive, within};
use std::f64::consts::TAU;

/// Load of a steady cut, without its vibration.
///
/// The means hold beyond the stability limit too, since the chip is conserved; the greatest force is that of a stable cut.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CuttingLoad {
    /// Material removed per time (m³/s).
    pub removal_rate: f64,
    /// Mean torque at the spindle (N m).
    pub torque: f64,
    /// Mean power at the spindle (W).
    pub power: f64,
    /// Greatest resultant force in the plane (N).
    pub greatest_force: f64,
}

impl Milling {
    /// Radial width of cut (m): `D/2 (cos entry − cos exit)`.
    pub fn radial_width(&self) -> f64 {
        0.5 * self.cutter.diameter * (self.engagement.entry.cos() - self.engagement.exit.cos())
    }

    /// Section of the cut normal to the feed (m²), and the integral of radius and engagement over the length of the edge (m²
    /// rad), by which the tangential force of the edge makes torque.
    fn section(&self, depth: f64) -> (f64, f64) {
        let Engagement { entry, exit } = self.engagement;
        let full = 0.5 * self.cutter.diameter;
        let slices = slices(self, depth, SLICES);
        if slices.is_empty() {
            return (depth * self.radial_width(), depth * full * (exit - entry));
        }
        slices.iter().fold((0.0, 0.0), |(area, edge), slice| {
            let (from, to) = slice.engagement(full, entry, exit);
            let height = slice.share * depth * slice.radius;
            (area + height * (from.cos() - to.cos()), edge + height * slice.edge * (to - from).max(0.0))
        })
    }

    /// Load at `spindle_speed` (rad/s) and `depth` (m); none at depth zero.
    ///
    /// The mean torque is `w D/2 N (K_t f_z (cos entry − cos exit) + K_te (exit − entry))/(2 pi)`, so that without edge
    /// forces the power is `K_t` times the removal rate. With a corner radius the sums run over the slices, each with its own
    /// radius, engagement and length of edge; the removal rate is the section of the cut times the feed rate.
    ///
    /// # Errors
    /// A cut that is none, without feed; a speed that is not positive; a negative depth.
    ///
    /// # Examples
    /// ```
    /// use toolroom_chatter::{Cutter, Direction, Engagement, Milling, MillingForce, Mode};
    /// let cut = Milling {
    ///     modes: vec![Mode::from_mass([1.0, 0.0], 922.0, 0.011, 0.03993)],
    ///     cutter: Cutter::straight(2, 0.02),
    ///     engagement: Engagement::new(0.25, Direction::Down).unwrap(),
    ///     force: MillingForce::new(6e8, 2e8),
    ///     feed_per_tooth: 0.1e-3,
    ///     by_speed: None,
    ///     along_path: None,
    /// };
    /// // 5 mm wide, 2 mm deep, 0.1 mm a tooth, two teeth, 6000 rpm: 12 cm³/min and 120 W.
    /// let load = cut.load(6000.0 / 60.0 * std::f64::consts::TAU, 2e-3).unwrap();
    /// assert!((load.removal_rate * 6e7 - 12.0).abs() < 1e-9 && (load.power - 120.0).abs() < 1e-9);
    /// ```
    pub fn load(&self, spindle_speed: f64, depth: f64) -> Result<CuttingLoad, ChatterError> {
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        within("depth", depth, 0.0, f64::MAX)?;
        positive("feed_per_tooth", self.feed_per_tooth)?;
        let teeth = self.cutter.teeth as f64;
        let (area, edge) = self.section(depth);
        let torque =
            teeth * (self.force.tangential * self.feed_per_tooth * area + self.force.edge_tangential * edge) / TAU;
        let greatest_force = if depth > 0.0 { self.greatest_static_force(depth)? } else { 0.0 };
        let removal_rate = area * self.feed_per_tooth * teeth * spindle_speed / TAU;
        Ok(CuttingLoad { removal_rate, torque, power: torque * spindle_speed, greatest_force })
    }
}

impl Turning {
    /// Load at `spindle_speed` (rad/s), `width` (m) and `feed_per_rev` (m): the force is `b K_f f`, its share along the
    /// cutting speed `sin(force_angle)`, and the removal rate `b f Omega D/2`.
    ///
    /// # Errors
    /// A cut that is none; a speed or feed that is not positive; a negative width.
    pub fn load(&self, spindle_speed: f64, width: f64, feed_per_rev: f64) -> Result<CuttingLoad, ChatterError> {
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        within("width", width, 0.0, f64::MAX)?;
        positive("feed_per_rev", feed_per_rev)?;
        let radius = 0.5 * self.diameter;
        let force = width * self.cutting_coefficient * feed_per_rev;
        let torque = force * self.force_angle.sin().abs() * radius;
        let removal_rate = width * feed_per_rev * spindle_speed * radius;
        Ok(CuttingLoad { removal_rate, torque, power: torque * spindle_speed, greatest_force: force })
    }
}
