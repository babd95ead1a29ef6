//! Workpiece compliance along a slender bar.

use crate::error::{ChatterError, positive, within};
use crate::structure::Mode;
use std::f64::consts::{PI, TAU};

/// How the far end of the bar is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Support {
    /// In the chuck only.
    Chuck,
    /// In the chuck and on a centre in the tailstock.
    Tailstock,
}

/// A round bar in a chuck: its first bending mode at the place of the tool.
///
/// The mode shape is that of an Euler–Bernoulli beam, clamped and free or clamped and pinned; the
/// chuck adds its compliance in series.
///
/// | symbol | field | unit | range |
/// |---|---|---|---|
/// | L | `length` | m | > 0, from the jaws |
/// | d | `diameter` | m | > 0 |
/// | E | `youngs_modulus` | Pa | > 0 |
/// | rho | `density` | kg/m³ | > 0 |
/// | zeta | `damping_ratio` | 1 | 0 … 1, excluded |
/// | k_c | `chuck_stiffness` | N/m | > 0 |
///
/// # Source
/// Blevins, Formulas for Natural Frequency and Mode Shape (1979), single-span beams; the chuck in
/// series with Dunkerley's estimate of the frequency is an assumption.
///
/// # Examples
/// ```
/// use toolroom_chatter::{Bar, Support};
/// let bar = Bar { length: 0.2, diameter: 0.03, youngs_modulus: 2.1e11, density: 7850.0,
///     damping_ratio: 0.02, chuck_stiffness: 1e12, support: Support::Chuck };
/// // 3.09 E I/L³ at the free end, against 3 E I/L³ for a static load.
/// let (tip, middle) = (bar.mode_at(0.2).unwrap(), bar.mode_at(0.1).unwrap());
/// assert!((tip.stiffness - 3.226e6).abs() < 0.002e6 && middle.stiffness > 8.0 * tip.stiffness);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Bar {
    /// Length out of the chuck (m).
    pub length: f64,
    /// Diameter (m).
    pub diameter: f64,
    /// Young's modulus (Pa).
    pub youngs_modulus: f64,
    /// Density [kg/m³].
    pub density: f64,
    /// Share of critical damping.
    pub damping_ratio: f64,
    /// Stiffness of the chuck against a radial force (N/m).
    pub chuck_stiffness: f64,
    /// How the far end is held.
    pub support: Support,
}

impl Bar {
    /// The mode that the tool meets at `position` from the jaws (m), along the chip thickness.
    ///
    /// # Errors
    /// A bar that is none; a position off the bar or at a support, where nothing moves.
    pub fn mode_at(&self, position: f64) -> Result<Mode, ChatterError> {
        positive("length", self.length)?;
        positive("diameter", self.diameter)?;
        positive("youngs_modulus", self.youngs_modulus)?;
        positive("density", self.density)?;
        positive("chuck_stiffness", self.chuck_stiffness)?;
        within("position", position, 0.0, self.length)?;
        // beta L and the shape's coefficient; the mean square of the shape over the bar is one.
        let (root, sigma): (f64, f64) = match self.support {
            Support::Chuck => (1.875_104_068_711_961, 0.734_095_513_758_355),
            Support::Tailstock => (3.926_602_312_047_919, 1.000_777_304_382_068),
        };
        let x = root * position / self.length;
        let shape = x.cosh() - x.cos() - sigma * (x.sinh() - x.sin());
        let area = PI * self.diameter.powi(2) / 4.0;
        let inertia = PI * self.diameter.powi(4) / 64.0;
        let mass = self.density * area * self.length;
        let bending = self.youngs_modulus * inertia;
        let w = (root / self.length).powi(2) * (bending / (self.density * area)).sqrt();
        let bar = mass * w * w / (shape * shape);
        if shape.abs() < 1e-6 {
            return Err(ChatterError::NoModes);
        }
        let stiffness = 1.0 / (1.0 / bar + 1.0 / self.chuck_stiffness);
        let chuck = self.chuck_stiffness / mass;
        let natural_frequency = (1.0 / (1.0 / (w * w) + 1.0 / chuck)).sqrt() / TAU;
        let mode = Mode { direction: [1.0, 0.0], natural_frequency, damping_ratio: self.damping_ratio, stiffness };
        mode.check()?;
        Ok(mode)
    }
}
