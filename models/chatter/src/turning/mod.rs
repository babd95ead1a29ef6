//! Turning: exact limits from the frequency response, verdicts from the period map.

mod bar;
mod crossings;
mod line;
mod oriented;
mod roots;
mod stability;

pub use bar::{Bar, Support};
pub(crate) use roots::TurningAtSpeed;

use self::crossings::{Crossings, NeutralVibration};
use self::line::LoopGain;
use self::oriented::Oriented;
use crate::error::{ChatterError, finite, positive, within};
use crate::intervals::{Certificate, Crossing, StableIntervals};
use crate::path::{PathModes, check_path, one_table};
use crate::speeds::{SpeedModes, check_speeds};
use crate::structure::{Mode, check_modes};
use crate::verdict::StabilityLimit;
use nalgebra::Complex;
use std::borrow::Cow;

/// A turning cut: modes, cutting force and its direction.
///
/// `force = b K_f (u(t − tau) − u(t)) − b (C_i/V) u'` along `force_direction`, with `u` the
/// relative displacement along `chip_direction` and `V = Omega D/2`.
///
/// | symbol | field | unit | range |
/// |---|---|---|---|
/// | – | `modes` | | at least one |
/// | K_f | `cutting_coefficient` | Pa | > 0 |
/// | beta | `force_angle` | rad | from the chip thickness to the force |
/// | C_i | `process_damping` | N/m | ≥ 0 |
/// | D | `diameter` | m | > 0 |
/// | alpha | `chip_exponent` | 1 | > 0; force ~ h^alpha |
///
/// With an exponent other than one, `K_f` is the coefficient of `b K_f h0 (h/h0)^alpha`, so its
/// slope at the mean chip is `alpha K_f`.
///
/// # Source
/// Altintas, Manufacturing Automation (2012), oriented frequency response; process damping as in
/// Altintas, Eynian and Onozuka (2008).
///
/// # Examples
/// ```
/// use toolroom_chatter::{Mode, Turning};
/// // One mode of 250 Hz at 30 degrees to the chip (Altintas 2012): b_min = 7.319 mm.
/// let mode = Mode { direction: [1.0, 0.0], natural_frequency: 250.0, damping_ratio: 0.012, stiffness: 3.0133e8 };
/// let cut = Turning::orthogonal(vec![mode], 1e9, 0.05);
/// assert!((cut.absolute_limit().unwrap() - 7.319e-3).abs() < 1e-6);
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Turning {
    /// Modes of tool and workpiece in (chip thickness, cutting speed).
    pub modes: Vec<Mode>,
    /// Cutting-force coefficient K_f (Pa).
    pub cutting_coefficient: f64,
    /// Angle from the direction of chip thickness to the force (rad).
    #[serde(default)]
    pub force_angle: f64,
    /// Indentation coefficient of process damping (N/m).
    #[serde(default)]
    pub process_damping: f64,
    /// Diameter of the workpiece (m).
    pub diameter: f64,
    /// Exponent of the chip thickness in the force.
    #[serde(default = "one")]
    pub chip_exponent: f64,
    /// The modes by spindle speed, where they change with it. They count then, and `modes` where nothing is said of the
    /// speed.
    #[serde(default)]
    pub by_speed: Option<SpeedModes>,
    /// The modes at stations along the path, where they change on it: every question is answered at the worst place. They
    /// count then, and `modes` nowhere. Not together with `by_speed`.
    #[serde(default)]
    pub along_path: Option<PathModes>,
}

fn one() -> f64 {
    1.0
}

impl Turning {
    /// Force along the chip thickness, no process damping, linear in the chip.
    pub fn orthogonal(modes: Vec<Mode>, cutting_coefficient: f64, diameter: f64) -> Self {
        Self {
            modes,
            cutting_coefficient,
            force_angle: 0.0,
            process_damping: 0.0,
            diameter,
            chip_exponent: 1.0,
            by_speed: None,
            along_path: None,
        }
    }

    /// The cut with the modes that it has at `spindle_speed` (rad/s); the same cut where they do not change with it.
    ///
    /// # Errors
    /// [`ChatterError::SpeedOutsideTable`] outside the speeds of [`Turning::by_speed`].
    pub fn at_spindle_speed(&self, spindle_speed: f64) -> Result<Cow<'_, Self>, ChatterError> {
        Ok(match &self.by_speed {
            None => Cow::Borrowed(self),
            Some(table) => {
                Cow::Owned(Self { modes: table.at(spindle_speed)?, by_speed: None, along_path: None, ..*self })
            }
        })
    }

    /// The cut with one more mode, which does not change with the speed.
    #[must_use]
    pub fn with_mode(mut self, mode: Mode) -> Self {
        self.modes.push(mode);
        let along_path = self.along_path.map(|path| path.with(mode));
        Self { by_speed: self.by_speed.map(|table| table.with(mode)), along_path, ..self }
    }

    pub(crate) fn check(&self) -> Result<(), ChatterError> {
        check_modes(&self.modes)?;
        check_speeds(self.by_speed.as_ref())?;
        check_path(self.along_path.as_ref())?;
        one_table(self.by_speed.is_some(), self.along_path.is_some())?;
        positive("cutting_coefficient", self.cutting_coefficient)?;
        finite("force_angle", self.force_angle)?;
        within("process_damping", self.process_damping, 0.0, f64::MAX)?;
        positive("diameter", self.diameter)?;
        within("chip_exponent", self.chip_exponent, 1e-3, 10.0)?;
        if self.modes.iter().all(|mode| self.orientation(mode) == 0.0) {
            return Err(ChatterError::NoModes);
        }
        Ok(())
    }

    /// Slope of the force by chip thickness per width (Pa).
    pub fn force_slope(&self) -> f64 {
        self.chip_exponent * self.cutting_coefficient
    }

    /// Share of a mode's motion in the chip thickness times its share of the force.
    fn orientation(&self, mode: &Mode) -> f64 {
        let [x, y] = mode.unit();
        let (s, c) = self.force_angle.sin_cos();
        // cos(90°) is no coupling, though it rounds to 6e-17.
        let product = x * (x * c + y * s);
        if product.abs() < 1e-15 { 0.0 } else { product }
    }

    /// Damping of the cut per width at `spindle_speed` (N s/m²).
    pub(crate) fn damping_slope(&self, spindle_speed: f64) -> f64 {
        self.process_damping / (spindle_speed * self.diameter / 2.0)
    }

    /// Least width that is unstable at some speed, without process damping (m):
    /// `−1/(2 K_f min Re G)`; for one mode `2 k zeta (1 + zeta)/K_f`.
    ///
    /// # Errors
    /// A cut that is none; [`ChatterError::NoLimit`] if the oriented response never turns negative.
    ///
    /// Of modes that change with the speed or along the path it is the least at the speeds of their table, at the judged places.
    pub fn absolute_limit(&self) -> Result<f64, ChatterError> {
        self.check()?;
        let tabled: Vec<Vec<Mode>> = match (&self.by_speed, &self.along_path) {
            (Some(table), _) => table.rows().cloned().collect(),
            (None, Some(path)) => path.places().into_iter().map(|(_, modes)| modes).collect(),
            (None, None) => Vec::new(),
        };
        if !tabled.is_empty() {
            let limit = |modes| Self { modes, by_speed: None, along_path: None, ..*self }.absolute_limit();
            return tabled.into_iter().map(limit).try_fold(f64::INFINITY, |least, limit| match limit {
                Err(ChatterError::NoLimit { .. }) => Ok(least),
                limit => Ok(least.min(limit?)),
            });
        }
        let structure = Oriented::new(self);
        let real = |w: f64| structure.response(Complex::new(0.0, w)).re;
        let mut least = (0.0, 0.0);
        for w in self.frequency_grid() {
            if real(w) < least.1 {
                least = (w, real(w));
            }
        }
        // Golden section about the best grid point, whose neighbours are far closer than a peak.
        let narrowest = self.modes.iter().map(|m| m.angular_frequency() * m.damping_ratio).fold(f64::MAX, f64::min);
        let (mut a, mut b) = (least.0 - narrowest, least.0 + narrowest);
        let ratio = 0.5 * (5f64.sqrt() - 1.0);
        while b - a > 1e-11 * b {
            let (c, d) = (b - ratio * (b - a), a + ratio * (b - a));
            if real(c) < real(d) { b = d } else { a = c }
        }
        let lowest = real(0.5 * (a + b));
        if lowest >= 0.0 {
            return Err(ChatterError::NoLimit { searched: f64::INFINITY });
        }
        Ok(-0.5 / (self.force_slope() * lowest))
    }

    /// Speed below which the cut is stable at any width by process damping (rad/s):
    /// `V < w_c C_i/K_f` at the highest mode.
    ///
    /// # Source
    /// Sufficient: the damping force exceeds every regenerative force (Altintas et al. 2008).
    pub fn always_stable_below(&self) -> f64 {
        let fastest = |cut: &Self| cut.modes.iter().map(Mode::angular_frequency).fold(0.0, f64::max);
        let fastest = self.places().iter().map(|(_, cut)| fastest(cut)).fold(0.0, f64::max);
        fastest * self.process_damping / self.force_slope() / (self.diameter / 2.0)
    }

    /// Frequencies (rad/s) that resolve every resonance, ascending.
    fn frequency_grid(&self) -> Vec<f64> {
        let fastest = self.modes.iter().map(Mode::angular_frequency).fold(0.0, f64::max);
        let mut grid: Vec<f64> = (1..=400).map(|i| 6.0 * fastest * f64::from(i) / 400.0).collect();
        for mode in &self.modes {
            let (w, width) = (mode.angular_frequency(), mode.damping_ratio * mode.angular_frequency());
            // Denser towards the resonance, out to 40 half-widths.
            for i in -80..=80 {
                let x = f64::from(i) / 80.0;
                grid.push(w + 40.0 * width * x * x.abs());
            }
        }
        grid.retain(|w| *w > 0.0);
        grid.sort_by(f64::total_cmp);
        grid
    }

    /// Least width that is unstable at `spindle_speed` (rad/s), exact to rounding: the first end of
    /// [`Turning::stable_intervals`].
    ///
    /// # Errors
    /// A cut that is none, a speed that is not positive; [`ChatterError::NoLimit`] where process damping keeps every
    /// width stable, up to that at which the cut is a thousand times as stiff as the structure.
    pub fn limit(&self, spindle_speed: f64) -> Result<StabilityLimit, ChatterError> {
        if self.along_path.is_some() {
            return self.least_limit(|cut| cut.limit(spindle_speed));
        }
        let line = LoopGain::new(self, spindle_speed)?;
        let searched = line.stiff_width();
        let least = Crossings::new(&line).least(searched).ok_or(ChatterError::NoLimit { searched })?;
        Ok(least.limit())
    }

    /// All widths up to `greatest` (m) at which the cut is stable at `spindle_speed` (rad/s), exact to rounding.
    ///
    /// # Errors
    /// As [`Turning::limit`], but a cut without limit is stable throughout.
    ///
    /// # Source
    /// The characteristic function `1 + b [K_f (1 − e^(−s tau)) + s C_i/V] G(s)` is linear in the width, so that the
    /// frequencies at which roots cross the imaginary axis do not depend on it. All of them are isolated; a root crosses
    /// to the right where the imaginary part of the loop gain rises.
    pub fn stable_intervals(&self, spindle_speed: f64, greatest: f64) -> Result<StableIntervals, ChatterError> {
        if self.along_path.is_some() {
            let places = self.places();
            let lists: Result<Vec<_>, _> =
                places.iter().map(|(_, cut)| cut.stable_intervals(spindle_speed, greatest)).collect();
            return Ok(StableIntervals::common(&lists?, greatest));
        }
        let line = LoopGain::new(self, spindle_speed)?;
        positive("greatest width", greatest)?;
        Ok(stable_intervals(&Crossings::new(&line).up_to(greatest), greatest))
    }
}

/// The stable intervals between neutral vibrations of ascending width, from no unstable root at width zero.
fn stable_intervals(crossings: &[NeutralVibration], greatest: f64) -> StableIntervals {
    let mut unstable_roots = 0;
    let mut ends = Vec::new();
    for vibration in crossings {
        let before = unstable_roots;
        unstable_roots += vibration.change;
        if (before > 0) != (unstable_roots > 0) {
            ends.push(Crossing { limit: vibration.limit(), becomes_unstable: before == 0 });
        }
    }
    StableIntervals { ends, greatest, certificate: Certificate::Proved }
}
