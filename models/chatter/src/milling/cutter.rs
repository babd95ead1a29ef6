//! What the cutter is and how it meets the work.

use crate::error::{ChatterError, finite, positive, within};
use std::f64::consts::{PI, TAU};

/// Greatest taper (rad): flatter edges, as of high-feed mills below 10°, cut along the axis, where nothing vibrates here (assumption).
const WIDEST_TAPER: f64 = 80.0 / 180.0 * PI;

/// A milling cutter.
///
/// | symbol | field | unit | range |
/// |---|---|---|---|
/// | N | `teeth` | 1 | ≥ 1 |
/// | D | `diameter` | m | > 0 |
/// | beta | `helix_angle` | rad | 0 … pi/2, end excluded |
/// | psi_j | `pitch` | rad | empty (equal) or N angles that sum to 2 pi |
/// | e | `runout` | m | ≥ 0 |
/// | lambda | `runout_angle` | rad | any |
/// | r_c | `corner_radius` | m | 0 … D/2: a cylinder, a bull nose, a ball end |
/// | alpha | `taper_angle` | rad | 0 … 80°, of a cone; the lead angle of a face mill is `pi/2 − alpha` |
///
/// With a corner radius or a taper the axis stands normal to the feed, the flutes lag by `2 tan(beta) z/D` at the height z, and
/// pitch and runout are those of a true cutter. A tapered cutter has its diameter, and its engagement, at the tip: it grows wider by
/// `2 z tan(alpha)` above, and meets a wall that stands upright over a wider angle there.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Cutter {
    /// Number of teeth.
    pub teeth: usize,
    /// Diameter (m).
    pub diameter: f64,
    /// Helix angle (rad).
    #[serde(default)]
    pub helix_angle: f64,
    /// Angle from each tooth to the one that cut before it (rad); empty for equal pitch.
    #[serde(default)]
    pub pitch: Vec<f64>,
    /// Offset of the cutter's axis from the spindle's (m).
    #[serde(default)]
    pub runout: f64,
    /// Angle from tooth 0 to the offset (rad).
    #[serde(default)]
    pub runout_angle: f64,
    /// Radius of the corner between face and flute (m): 0 a cylinder, half the diameter a ball end.
    #[serde(default)]
    pub corner_radius: f64,
    /// Angle between axis and edge (rad): 0 a cylinder; without a corner radius.
    #[serde(default)]
    pub taper_angle: f64,
}

impl Cutter {
    /// A cutter with straight, equally spaced teeth that runs true.
    pub fn straight(teeth: usize, diameter: f64) -> Self {
        Self {
            teeth,
            diameter,
            helix_angle: 0.0,
            pitch: Vec::new(),
            runout: 0.0,
            runout_angle: 0.0,
            corner_radius: 0.0,
            taper_angle: 0.0,
        }
    }

    pub(crate) fn check(&self) -> Result<(), ChatterError> {
        if self.teeth == 0 {
            return Err(ChatterError::NoTeethInCut);
        }
        positive("diameter", self.diameter)?;
        // At a right angle the tooth would be a disc.
        within("helix_angle", self.helix_angle, 0.0, 0.49 * PI)?;
        within("runout", self.runout, 0.0, self.diameter)?;
        finite("runout_angle", self.runout_angle)?;
        within("corner_radius", self.corner_radius, 0.0, 0.5 * self.diameter)?;
        within("taper_angle", self.taper_angle, 0.0, WIDEST_TAPER)?;
        if self.taper_angle > 0.0 {
            within("corner_radius with a taper", self.corner_radius, 0.0, 0.0)?;
        }
        if !self.pitch.is_empty() {
            if self.pitch.len() != self.teeth {
                let (value, wanted) = (self.pitch.len() as f64, self.teeth as f64);
                return Err(ChatterError::OutOfRange {
                    quantity: "number of pitch angles",
                    value,
                    min: wanted,
                    max: wanted,
                });
            }
            for pitch in &self.pitch {
                positive("pitch", *pitch)?;
            }
            within("sum of pitch", self.pitch.iter().sum(), TAU * (1.0 - 1e-6), TAU * (1.0 + 1e-6))?;
        }
        Ok(())
    }

    /// Angle from tooth `j` to the tooth that cut before it (rad).
    pub(crate) fn pitch_before(&self, j: usize) -> f64 {
        self.pitch.get(j).copied().unwrap_or(TAU / self.teeth as f64)
    }

    /// Whether a tooth is the same at every depth: straight, without a corner or a taper.
    pub(crate) fn is_straight(&self) -> bool {
        self.helix_angle == 0.0 && self.is_cylinder()
    }

    /// Whether the radius is the same at every depth.
    pub(crate) fn is_cylinder(&self) -> bool {
        self.corner_radius == 0.0 && self.taper_angle == 0.0
    }

    /// Whether one tooth period is like the next.
    pub(crate) fn is_regular(&self) -> bool {
        let equal = TAU / self.teeth as f64;
        self.runout == 0.0 && self.pitch.iter().all(|pitch| (pitch - equal).abs() < 1e-12)
    }

    /// Angles of the teeth ahead of tooth 0 (rad): a tooth cuts when tooth 0 has this angle less
    /// than its own. Tooth j cuts after tooth j − 1.
    pub(crate) fn offsets(&self) -> Vec<f64> {
        let mut offset = 0.0;
        (0..self.teeth)
            .map(|j| {
                if j > 0 {
                    offset -= self.pitch_before(j);
                }
                offset
            })
            .collect()
    }

    /// Extra radius of tooth `j` by runout (m): `e cos(lambda − angle of the tooth)`.
    pub(crate) fn extra_radius(&self, j: usize) -> f64 {
        if self.runout == 0.0 { 0.0 } else { self.runout * (self.runout_angle - self.offsets()[j]).cos() }
    }

    /// Angle by which the tooth lags over `depth` (rad): `2 tan(beta) depth/D`.
    pub(crate) fn lag_angle(&self, depth: f64) -> f64 {
        2.0 * self.helix_angle.tan() * depth / self.diameter
    }
}

/// Direction of the feed against the cutting speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// The chip starts thin (conventional milling).
    Up,
    /// The chip ends thin (climb milling).
    Down,
}

/// Where around its axis the cutter is in the work; tooth angles count from the normal of the
/// feed, in the sense of rotation.
///
/// ```
/// use toolroom_chatter::{Direction, Engagement};
/// let slot = Engagement::new(1.0, Direction::Down).unwrap();
/// assert!(slot.entry == 0.0 && (slot.exit - std::f64::consts::PI).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Engagement {
    /// Angle at which a tooth enters (rad).
    pub entry: f64,
    /// Angle at which it leaves (rad).
    pub exit: f64,
}

impl Engagement {
    /// From the radial immersion `a/D`: up `0 … acos(1 − 2 a/D)`, down `acos(2 a/D − 1) … pi`.
    ///
    /// # Errors
    /// [`ChatterError::NoTeethInCut`] at immersion 0, [`ChatterError::OutOfRange`] beyond 0 … 1.
    pub fn new(immersion: f64, direction: Direction) -> Result<Self, ChatterError> {
        within("immersion", immersion, 0.0, 1.0)?;
        if immersion == 0.0 {
            return Err(ChatterError::NoTeethInCut);
        }
        Ok(match direction {
            Direction::Up => Self { entry: 0.0, exit: (1.0 - 2.0 * immersion).acos() },
            Direction::Down => Self { entry: (2.0 * immersion - 1.0).acos(), exit: PI },
        })
    }

    pub(crate) fn check(&self) -> Result<(), ChatterError> {
        within("entry", self.entry, -TAU, TAU)?;
        within("exit", self.exit, -TAU, TAU)?;
        if self.exit <= self.entry {
            return Err(ChatterError::NoTeethInCut);
        }
        within("engagement", self.exit - self.entry, 0.0, TAU)?;
        Ok(())
    }
}

/// Cutting force on one tooth: tangential `K_t w h + K_te w`, radial `K_n w h + K_re w + (C_i/V) w h'`.
///
/// | symbol | field | unit | range |
/// |---|---|---|---|
/// | K_t | `tangential` | Pa | > 0 |
/// | K_n | `radial` | Pa | any |
/// | C_i | `process_damping` | N/m | ≥ 0 |
/// | K_te | `edge_tangential` | N/m | ≥ 0 |
/// | K_re | `edge_radial` | N/m | any |
/// | K_a | `axial` | Pa | any; with a corner radius or a taper alone |
///
/// The edge forces do not depend on the chip: they act on load and vibration, not on stability.
///
/// # Source
/// Linear force of Altintas and Budak (1995); the damping by the flank's indentation is taken
/// along the radius only (assumption).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MillingForce {
    /// Tangential cutting-force coefficient (Pa).
    pub tangential: f64,
    /// Radial cutting-force coefficient (Pa).
    pub radial: f64,
    /// Indentation coefficient of process damping (N/m).
    #[serde(default)]
    pub process_damping: f64,
    /// Tangential force of the edge per depth (N/m).
    #[serde(default)]
    pub edge_tangential: f64,
    /// Radial force of the edge per depth (N/m).
    #[serde(default)]
    pub edge_radial: f64,
    /// Axial cutting-force coefficient (Pa), which acts in the plane where a corner radius or a taper turns the edge.
    #[serde(default)]
    pub axial: f64,
}

impl MillingForce {
    /// Without process damping and edge forces.
    pub fn new(tangential: f64, radial: f64) -> Self {
        Self { tangential, radial, process_damping: 0.0, edge_tangential: 0.0, edge_radial: 0.0, axial: 0.0 }
    }

    pub(crate) fn check(&self) -> Result<(), ChatterError> {
        positive("tangential", self.tangential)?;
        finite("radial", self.radial)?;
        within("process_damping", self.process_damping, 0.0, f64::MAX)?;
        within("edge_tangential", self.edge_tangential, 0.0, f64::MAX)?;
        finite("edge_radial", self.edge_radial)?;
        finite("axial", self.axial)?;
        Ok(())
    }

    /// Force per depth by displacement of a tooth at angle `phi`, rows of (x, y):
    /// `[[s (Kt c + Kn s), c (Kt c + Kn s)], [s (−Kt s + Kn c), c (−Kt s + Kn c)]]`.
    pub(crate) fn directional(&self, phi: f64) -> [f64; 4] {
        let (s, c) = phi.sin_cos();
        let (x, y) = (self.tangential * c + self.radial * s, self.radial * c - self.tangential * s);
        [s * x, c * x, s * y, c * y]
    }

    /// Integral of [`MillingForce::directional`] over `from … to`.
    pub(crate) fn directional_integral(&self, start: f64, end: f64) -> [f64; 4] {
        let [ss, sc, cc] = square_integrals(start, end);
        let (t, r) = (self.tangential, self.radial);
        [t * sc + r * ss, t * cc + r * sc, r * sc - t * ss, r * cc - t * sc]
    }
}

/// Integrals of sin², sin cos and cos² over `from … to`.
pub(crate) fn square_integrals(start: f64, end: f64) -> [f64; 3] {
    let (s1, c1) = end.sin_cos();
    let (s0, c0) = start.sin_cos();
    let half = 0.5 * (end - start);
    let swing = 0.5 * (s1 * c1 - s0 * c0);
    [half - swing, 0.5 * (s1 * s1 - s0 * s0), half + swing]
}
