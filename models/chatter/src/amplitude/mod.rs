//! Amplitude and force of chatter: of turning from a table that the simulation has filled, of milling by a short simulation.

mod milling;
mod table;

use crate::error::{ChatterError, finite, positive, within};
use crate::{Mode, StabilityVerdict, Turning};
use std::f64::consts::{PI, TAU};

pub use table::AmplitudeTable;

/// A limit cycle, scaled by the mean chip h0 and the mean force F0, which chatter does not change; in milling by the feed of a
/// tooth and the force of the same cut without vibration.
///
/// | symbol | field | unit |
/// |---|---|---|
/// | pp/h0 | `amplitude` | 1 |
/// | F_max/F0 | `greatest_force` | 1 |
/// | <F²>/F0² | `mean_square_force` | 1 |
/// | <F³>/F0³ | `mean_cube_force` | 1 |
/// | – | `air_fraction` | 1 |
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct LimitCycle {
    /// Peak-to-peak displacement in chip thicknesses.
    pub amplitude: f64,
    /// Greatest force in mean forces.
    pub greatest_force: f64,
    /// Mean square of the force.
    pub mean_square_force: f64,
    /// Mean cube of the force.
    pub mean_cube_force: f64,
    /// Share of the time without contact.
    pub air_fraction: f64,
}

impl LimitCycle {
    /// A cut without vibration.
    pub const NONE: Self =
        Self { amplitude: 0.0, greatest_force: 1.0, mean_square_force: 1.0, mean_cube_force: 1.0, air_fraction: 0.0 };

    fn values(&self) -> [f64; 5] {
        [self.amplitude, self.greatest_force, self.mean_square_force, self.mean_cube_force, self.air_fraction]
    }

    fn from_values([amplitude, greatest_force, mean_square_force, mean_cube_force, air_fraction]: [f64; 5]) -> Self {
        Self { amplitude, greatest_force, mean_square_force, mean_cube_force, air_fraction }
    }

    /// The cycle at `share` of the way from this one to `other`.
    #[must_use]
    pub fn towards(&self, other: &Self, share: f64) -> Self {
        let (from, to) = (self.values(), other.values());
        Self::from_values(std::array::from_fn(|i| from[i] + share * (to[i] - from[i])))
    }

    /// Simulates the limit cycle of one mode in turning: `ratio` is width over its limit, `waves`
    /// the natural oscillations in a revolution.
    ///
    /// # Errors
    /// Arguments that are no cut.
    pub fn simulated(ratio: f64, waves: f64, damping_ratio: f64) -> Result<Self, ChatterError> {
        positive("ratio", ratio)?;
        positive("waves", waves)?;
        // Everything but the three arguments scales out; these values are convenient.
        let mode = Mode { direction: [1.0, 0.0], natural_frequency: 500.0, damping_ratio, stiffness: 1e7 };
        let cut = Turning::orthogonal(vec![mode], 1e9, 0.05);
        let spindle_speed = TAU * 500.0 / waves;
        let width = ratio * cut.limit(spindle_speed)?.depth;
        let feed = 1e-4;
        let run = cut.simulate(spindle_speed, width, feed, &table::SETTINGS)?;
        let mean = 1e9 * width * feed;
        Ok(Self {
            amplitude: run.peak_to_peak(0) / feed,
            greatest_force: run.greatest_force(0) / mean,
            mean_square_force: run.mean_force_power(0, 2) / mean.powi(2),
            mean_cube_force: run.mean_force_power(0, 3) / mean.powi(3),
            air_fraction: run.air_fraction,
        })
    }
}

impl Turning {
    /// Limit cycle of an unstable width at `spindle_speed` (rad/s) from the standard table, with
    /// the damping and the lobe of the mode that chatters; no vibration below the limit.
    ///
    /// # Validity
    /// One dominant mode, force linear in the chip, no process damping in the cycle itself.
    ///
    /// # Errors
    /// As [`Turning::limit`], except that a cut without limit does not vibrate.
    pub fn limit_cycle(&self, spindle_speed: f64, width: f64) -> Result<LimitCycle, ChatterError> {
        if self.by_speed.is_some() {
            return self.at_spindle_speed(spindle_speed)?.limit_cycle(spindle_speed, width);
        }
        if self.along_path.is_some() {
            return self.at_worst_place(spindle_speed, width)?.limit_cycle(spindle_speed, width);
        }
        within("width", width, 0.0, f64::MAX)?;
        let limit = match self.limit(spindle_speed) {
            Err(ChatterError::NoLimit { .. }) => return Ok(LimitCycle::NONE),
            limit => limit?,
        };
        let distance = |mode: &&Mode| (mode.natural_frequency - limit.chatter_frequency).abs();
        let Some(mode) = self.modes.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))) else {
            return Err(ChatterError::NoModes);
        };
        let waves = mode.natural_frequency * TAU / spindle_speed;
        AmplitudeTable::standard().limit_cycle(width / limit.depth, waves, mode.damping_ratio)
    }
}

impl StabilityVerdict {
    /// Time in which a vibration grows by `growth` (s), `period ln(growth)/ln(spectral_radius)`:
    /// the delay between the loss of stability and chatter. Infinite for a stable cut.
    ///
    /// # Errors
    /// A growth that is not positive.
    pub fn onset_time(&self, growth: f64) -> Result<f64, ChatterError> {
        positive("growth", growth)?;
        if self.spectral_radius <= 1.0 {
            return Ok(f64::INFINITY);
        }
        Ok((self.period * growth.ln() / self.spectral_radius.ln()).max(0.0))
    }
}

/// Arithmetic roughness Ra (m) of a turned surface: feed marks `f²/(18 sqrt(3) r)` and a sinusoidal
/// vibration `pp/pi`, combined in quadrature.
///
/// # Errors
/// A feed, corner radius or amplitude that is none.
///
/// # Source
/// The marks are kinematic; the quadrature is an assumption to be calibrated.
///
/// # Examples
/// ```
/// let still = toolroom_chatter::arithmetic_roughness(0.2e-3, 0.8e-3, 0.0).unwrap();
/// assert!((still - 1.6038e-6).abs() < 1e-10);
/// ```
pub fn arithmetic_roughness(feed_per_rev: f64, corner_radius: f64, peak_to_peak: f64) -> Result<f64, ChatterError> {
    positive("corner_radius", corner_radius)?;
    within("feed_per_rev", feed_per_rev, 0.0, f64::MAX)?;
    within("peak_to_peak", peak_to_peak, 0.0, f64::MAX)?;
    Ok((feed_per_rev * feed_per_rev / (18.0 * 3f64.sqrt() * corner_radius)).hypot(peak_to_peak / PI))
}

/// Indentation coefficient of process damping C_i (N/m) of a worn edge: `K_sp VB²/2`, with the
/// specific indentation force `K_sp` [N/m³] to be calibrated.
///
/// # Errors
/// Numbers that are negative or not finite.
///
/// # Source
/// Volume displaced under the flank land, of the form of Chiou and Liang (1998).
///
/// # Examples
/// ```
/// let worn = toolroom_chatter::indentation_coefficient(4e13, 0.2e-3).unwrap();
/// assert!((worn - 8e5).abs() < 1e-6);
/// ```
pub fn indentation_coefficient(specific_indentation_force: f64, flank_wear: f64) -> Result<f64, ChatterError> {
    finite("flank_wear", flank_wear)?;
    within("specific_indentation_force", specific_indentation_force, 0.0, f64::MAX)?;
    within("flank_wear", flank_wear, 0.0, f64::MAX)?;
    Ok(0.5 * specific_indentation_force * flank_wear * flank_wear)
}
