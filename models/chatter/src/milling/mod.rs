//! Milling: any modes, up and down, helix, unequal pitch, runout, process damping.

mod characteristic;
mod cutter;
mod engagement;
mod forced;
mod harmonics;
mod load;
mod preview;
mod profile;
mod regenerated;
mod slice;
mod slow;
mod stability;
mod wall;

pub use cutter::{Cutter, Direction, Engagement, MillingForce};
pub(crate) use engagement::tooth_period_gain;
pub use forced::Forced;
pub use harmonics::{Response, Sampling};
pub use load::CuttingLoad;
pub(crate) use profile::{SLICES, slices};
pub(crate) use slice::Slice;
pub use stability::{AtSpeed, WorstPhase};
pub use wall::Roughness;

use crate::error::{ChatterError, positive, within};
use crate::path::{PathModes, check_path, one_table};
use crate::speeds::{SpeedModes, check_speeds};
use crate::structure::{Mode, check_modes};
use std::borrow::Cow;

/// A milling cut as the stability model sees it: everything but speed and depth.
///
/// `F = −w H(phi) (u(t) − u(t − tau) + (f_z, 0))` with `u` the relative displacement in
/// (feed, normal).
///
/// # Examples
/// ```
/// use std::f64::consts::TAU;
/// use toolroom_chatter::{Cutter, Direction, Engagement, Milling, MillingForce, Mode};
/// let cut = Milling {
///     modes: vec![Mode::from_mass([1.0, 0.0], 922.0, 0.011, 0.03993)],
///     cutter: Cutter::straight(2, 0.02),
///     engagement: Engagement::new(1.0, Direction::Down).unwrap(),
///     force: MillingForce::new(6e8, 2e8),
///     feed_per_tooth: 0.1e-3,
///     by_speed: None,
///     along_path: None,
/// };
/// let verdict = cut.verdict(5000.0 / 60.0 * TAU, 0.5e-3).unwrap();
/// assert!((verdict.spectral_radius - 1.073975587).abs() < 1e-7);
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Milling {
    /// Modes of tool and workpiece in (feed, normal).
    pub modes: Vec<Mode>,
    /// The cutter.
    pub cutter: Cutter,
    /// Where it is in the work.
    pub engagement: Engagement,
    /// Cutting-force coefficients.
    pub force: MillingForce,
    /// Feed per tooth (m); stability depends on it only with runout.
    pub feed_per_tooth: f64,
    /// The modes by spindle speed, where they change with it. They count then, and `modes` where nothing is said of the
    /// speed.
    #[serde(default)]
    pub by_speed: Option<SpeedModes>,
    /// The modes at stations along the path, where they change on it: every question is answered at the worst place. They
    /// count then, and `modes` nowhere. Not together with `by_speed`.
    #[serde(default)]
    pub along_path: Option<PathModes>,
}

impl Milling {
    /// The cut with the modes that it has at `spindle_speed` (rad/s); the same cut where they do not change with it.
    ///
    /// # Errors
    /// [`ChatterError::SpeedOutsideTable`] outside the speeds of [`Milling::by_speed`].
    pub fn at_spindle_speed(&self, spindle_speed: f64) -> Result<Cow<'_, Self>, ChatterError> {
        Ok(match &self.by_speed {
            None => Cow::Borrowed(self),
            Some(table) => {
                let modes = table.at(spindle_speed)?;
                Cow::Owned(Self { modes, cutter: self.cutter.clone(), by_speed: None, along_path: None, ..*self })
            }
        })
    }

    pub(crate) fn check(&self) -> Result<(), ChatterError> {
        check_modes(&self.modes)?;
        check_speeds(self.by_speed.as_ref())?;
        check_path(self.along_path.as_ref())?;
        one_table(self.by_speed.is_some(), self.along_path.is_some())?;
        self.cutter.check()?;
        self.engagement.check()?;
        self.force.check()?;
        self.check_corner()?;
        within("feed_per_tooth", self.feed_per_tooth, 0.0, f64::MAX)?;
        if self.cutter.runout > 0.0 {
            positive("feed_per_tooth", self.feed_per_tooth)?;
        }
        Ok(())
    }
}
