//! Limit cycles of milling by a short simulation.

use super::LimitCycle;
use crate::error::{ChatterError, positive};
use crate::simulate::{GoOn, Patience, Simulation, SimulationSettings, settling, steps_for};
use crate::{Milling, Mode};
use std::f64::consts::TAU;

/// Tooth periods.
const HASTY: Patience = Patience { periods: [150, 600], window: 40 };
/// Least steps in a tooth period, and steps in an oscillation of the highest mode.
const COARSE: [f64; 2] = [100.0, 25.0];

impl Milling {
    /// The vibration that milling at `spindle_speed` (rad/s) and `depth` (m) settles to, set off by a chip thickness: for
    /// whoever asks for many. [`Milling::settled`] is finer and tells its error.
    ///
    /// Displacements are in feeds per tooth, the greater of both directions; forces are resultants in the plane of the
    /// cutter, scaled by the greatest one, the mean square and the mean cube of the same cut without vibration.
    ///
    /// # Validity
    /// `examples/amplitudes.rs` compares it with a run of four times the steps and periods.
    ///
    /// # Errors
    /// As [`Milling::simulate`].
    ///
    /// # Examples
    /// ```
    /// use std::f64::consts::TAU;
    /// use toolroom_chatter::{Cutter, Direction, Engagement, Milling, MillingForce, Mode};
    /// let slot = Milling {
    ///     modes: vec![Mode::from_mass([1.0, 0.0], 922.0, 0.011, 0.03993)],
    ///     cutter: Cutter::straight(2, 0.02),
    ///     engagement: Engagement::new(1.0, Direction::Down).unwrap(),
    ///     force: MillingForce::new(6e8, 2e8),
    ///     feed_per_tooth: 0.1e-3,
    ///     by_speed: None,
    ///     along_path: None,
    /// };
    /// // Period doubling at 1.1 times the limit: an independent simulation has 345.32 um.
    /// let cycle = slot.limit_cycle(12000.0 / 60.0 * TAU, 1.1 * 2.14930949e-3).unwrap();
    /// assert!((cycle.amplitude / 3.4532 - 1.0).abs() < 0.06);
    /// ```
    pub fn limit_cycle(&self, spindle_speed: f64, depth: f64) -> Result<LimitCycle, ChatterError> {
        if self.by_speed.is_some() {
            return self.at_spindle_speed(spindle_speed)?.limit_cycle(spindle_speed, depth);
        }
        if self.along_path.is_some() {
            return self.at_worst_place(spindle_speed, depth)?.limit_cycle(spindle_speed, depth);
        }
        let teeth = self.cutter.teeth;
        let pitch = TAU / (teeth as f64 * positive("spindle_speed", spindle_speed)?);
        let steps = steps_for(&self.modes, pitch, COARSE);
        let simulate = |settings: &_, go_on: GoOn<'_>| self.simulate_on(spindle_speed, depth, settings, go_on);
        let (run, _, _) = settling(steps, HASTY, &[0, 1], &simulate)?;
        // The same steps without vibration; runout needs two revolutions to have cut all surfaces.
        let stiff = |mode: &Mode| Mode { stiffness: mode.stiffness * RIGID, ..*mode };
        let rigid = Self { modes: self.modes.iter().map(stiff).collect(), ..self.clone() };
        let settings = SimulationSettings { steps, periods: 3 * teeth, observed: teeth, kick: 0.0 };
        let still = rigid.simulate(spindle_speed, depth, &settings)?;
        let over = |of: &dyn Fn(&Simulation) -> f64| of(&run) / of(&still);
        Ok(LimitCycle {
            amplitude: run.peak_to_peak(0).max(run.peak_to_peak(1)) / self.feed_per_tooth,
            greatest_force: over(&|run| resultants(run).fold(0.0, f64::max)),
            mean_square_force: over(&|run| mean(run, 2)),
            mean_cube_force: over(&|run| mean(run, 3)),
            air_fraction: run.air_fraction,
        })
    }
}

/// Factor on every stiffness of a structure that does not move.
const RIGID: f64 = 1e9;

fn resultants(run: &Simulation) -> impl Iterator<Item = f64> {
    run.force.iter().map(|[x, y]| x.hypot(*y))
}

/// Mean of the resultant to the power `p` [N^p].
fn mean(run: &Simulation, p: i32) -> f64 {
    resultants(run).map(|force| force.powi(p)).sum::<f64>() / run.force.len() as f64
}
