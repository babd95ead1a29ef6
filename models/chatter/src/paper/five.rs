//! System (5): the tool in three directions and the workpiece in two, coupled by the cut.

use super::{KGF_PER_MM, Preset, delayed_multipliers, monodromy};
use crate::error::{ChatterError, finite, positive, within};
use crate::verdict::{ChatterKind, StabilityVerdict};
use nalgebra::{Complex, DMatrix, SMatrix};
use std::f64::consts::{FRAC_PI_2, TAU};
use toolroom_spectral::dense_eigenvalues;

/// Cycles of the fastest vibration in a revolution with regeneration: the period map has 28 rows for each, and its
/// eigenvalues take seconds.
const MOST_REGENERATED: f64 = 30.0;

type Matrix5 = SMatrix<f64, 5, 5>;
type Matrix10 = SMatrix<f64, 10, 10>;

/// Tool (normal to the generatrix, cutting speed, feed) and workpiece (two directions) in the
/// variational equation `M x'' + H(t) x' + K(t) x = 0`.
///
/// `K = blockdiag(c1, c(t)) + Kc`, `H = blockdiag(h1, h) − diag(T1, T2, T3, T1, T2) Kc`, where
/// `Kc` has in rows i the entries `chi_i r` in columns 1 and 4 and `chi_i a(t)` in column 3, with
/// `a(t) = c0 (1 + sum mu_k cos((2k−1) Omega t))` and
/// `c(t) = diag(c (1 + mu cos 3 Omega t), c (1 + mu cos(3 Omega t + 3 pi/2)))`.
///
/// | symbol | field | unit |
/// |---|---|---|
/// | m1, h1, c1 | `tool_mass`, `tool_damping`, `tool_stiffness` | kg, N s/m, N/m |
/// | m, h, c | `workpiece_mass`, `workpiece_damping`, `workpiece_stiffness` | kg, N s/m, N/m |
/// | c0 | `cutting_stiffness` | N/m |
/// | r = rho S_p | `pressure_feed` | N/m |
/// | chi | `force_direction` | 1 |
/// | T1, T2, T3 | `lag` | s |
/// | mu_k | `mu_allowance` | 1 |
/// | mu | `mu_chuck` | 1 |
///
/// # Source
/// Zakovorotny et al., equations (1)–(5), Tables 1 and 2. The printed matrices are damaged: the
/// third row of the stiffness is read by symmetry, the workpiece rows by the pattern of columns
/// 1, 3 and 4, the phase 3 pi/2 from the geometry of three jaws.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct FiveDegrees {
    /// Mass of the tool in each direction (kg).
    pub tool_mass: f64,
    /// Damping matrix of the tool [N·s/m].
    pub tool_damping: [[f64; 3]; 3],
    /// Stiffness matrix of the tool (N/m).
    pub tool_stiffness: [[f64; 3]; 3],
    /// Mass of the workpiece (kg).
    pub workpiece_mass: f64,
    /// Damping matrix of the workpiece [N·s/m].
    pub workpiece_damping: [[f64; 2]; 2],
    /// Mean stiffness of the clamped workpiece (N/m).
    pub workpiece_stiffness: f64,
    /// Stiffness of the cutting process (N/m).
    pub cutting_stiffness: f64,
    /// Chip pressure times feed, the stiffness of the cut against approach (N/m).
    pub pressure_feed: f64,
    /// Direction cosines of the cutting force.
    pub force_direction: [f64; 3],
    /// Chip-formation lag of each force component (s).
    pub lag: [f64; 3],
    /// Amplitudes of the odd harmonics 1, 3, 5 … of the allowance.
    pub mu_allowance: Vec<f64>,
    /// Modulation of the workpiece stiffness by the jaws.
    pub mu_chuck: f64,
    /// Whether the extra damping `−c T (1 + mu cos 3 Omega t)` of the printed workpiece rows is
    /// taken literally. It makes the cut unstable without modulation, against the paper's premise.
    pub workpiece_lag: bool,
    /// Whether the feed deflection of the previous revolution enters the force (a delay equation);
    /// off in the paper's stability analysis.
    pub regeneration: bool,
}

impl FiveDegrees {
    /// Tables 1 and 2 with the workpiece mass of `preset`, one `lag` (s) for all components and
    /// `feed_per_rev` (m).
    ///
    /// # Source
    /// The paper gives neither feed nor lags for Fig. 4; 0.1 mm and 0.4·10⁻⁴ s are assumptions
    /// that a caller makes.
    pub fn from_preset(preset: Preset, lag: f64, feed_per_rev: f64) -> Self {
        let (mass, _) = preset.mass_and_damping();
        Self {
            tool_mass: 0.079e-3 * KGF_PER_MM,
            tool_damping: in_si([[0.0159, 0.0032, 0.0021], [0.0032, 0.0225, 0.011], [0.0021, 0.011, 0.032]]),
            tool_stiffness: in_si([[1000.0, 200.0, 120.0], [200.0, 2100.0, 310.0], [120.0, 310.0, 2500.0]]),
            workpiece_mass: mass * KGF_PER_MM,
            workpiece_damping: in_si([[0.0159, 0.0032], [0.0032, 0.0225]]),
            workpiece_stiffness: 400.0 * KGF_PER_MM,
            cutting_stiffness: 200.0 * KGF_PER_MM,
            // 300 kgf/mm² times the feed in mm.
            pressure_feed: 300.0 * feed_per_rev * 1e3 * KGF_PER_MM,
            force_direction: [0.50, 0.70, 0.51],
            lag: [lag; 3],
            mu_allowance: Vec::new(),
            mu_chuck: 0.0,
            workpiece_lag: false,
            regeneration: false,
        }
    }

    /// `w0 = sqrt((c + c0)/m)` (rad/s), the scale of the spindle speed in the paper's Fig. 4.
    pub fn reference_frequency(&self) -> f64 {
        ((self.workpiece_stiffness + self.cutting_stiffness) / self.workpiece_mass).sqrt()
    }

    fn check(&self) -> Result<(), ChatterError> {
        positive("tool_mass", self.tool_mass)?;
        positive("workpiece_mass", self.workpiece_mass)?;
        positive("workpiece_stiffness", self.workpiece_stiffness)?;
        within("cutting_stiffness", self.cutting_stiffness, 0.0, f64::MAX)?;
        within("pressure_feed", self.pressure_feed, 0.0, f64::MAX)?;
        within("mu_chuck", self.mu_chuck, 0.0, f64::MAX)?;
        for lag in self.lag {
            within("lag", lag, 0.0, f64::MAX)?;
        }
        for mu in &self.mu_allowance {
            within("mu_allowance", *mu, 0.0, f64::MAX)?;
        }
        positive_definite("tool_stiffness", self.tool_stiffness)?;
        positive_definite("tool_damping", self.tool_damping)?;
        positive_definite("workpiece_damping", self.workpiece_damping)?;
        Ok(())
    }

    /// Direction cosines and lags of the five rows.
    fn rows(&self) -> ([f64; 5], [f64; 5]) {
        let [c1, c2, c3] = self.force_direction;
        let [t1, t2, t3] = self.lag;
        ([c1, c2, c3, c1, c2], [t1, t2, t3, t1, t2])
    }

    /// `a(t)/c0`.
    fn allowance(&self, angle: f64) -> f64 {
        let harmonics = self.mu_allowance.iter().zip(0..);
        1.0 + harmonics.map(|(mu, k)| mu * (f64::from(2 * k + 1) * angle).cos()).sum::<f64>()
    }

    /// Stiffness and damping at spindle `angle` (rad).
    fn matrices(&self, angle: f64) -> (Matrix5, Matrix5) {
        let (chi, lag) = self.rows();
        let jaws = [0.0, 3.0 * FRAC_PI_2].map(|phase| 1.0 + self.mu_chuck * (3.0 * angle + phase).cos());
        let mut cutting = Matrix5::zeros();
        let feed_side = self.cutting_stiffness * self.allowance(angle);
        for i in 0..5 {
            cutting[(i, 0)] = chi[i] * self.pressure_feed;
            cutting[(i, 2)] = chi[i] * feed_side;
            cutting[(i, 3)] = chi[i] * self.pressure_feed;
        }
        let mut damping = -Matrix5::from_diagonal(&lag.into()) * cutting;
        let mut stiffness = cutting;
        for i in 0..3 {
            for j in 0..3 {
                stiffness[(i, j)] += self.tool_stiffness[i][j];
                damping[(i, j)] += self.tool_damping[i][j];
            }
        }
        for i in 0..2 {
            stiffness[(3 + i, 3 + i)] += self.workpiece_stiffness * jaws[i];
            for j in 0..2 {
                damping[(3 + i, 3 + j)] += self.workpiece_damping[i][j];
            }
            if self.workpiece_lag {
                damping[(3 + i, 3 + i)] -= self.workpiece_stiffness * lag[3 + i] * jaws[i];
            }
        }
        (stiffness, damping)
    }

    fn inverse_mass(&self, row: usize) -> f64 {
        1.0 / if row < 3 { self.tool_mass } else { self.workpiece_mass }
    }

    /// First-order form in time scaled by w0, so that the entries are of one size.
    fn coefficients(&self, angle: f64) -> Matrix10 {
        let w0 = self.reference_frequency();
        let (stiffness, damping) = self.matrices(angle);
        let mut a = Matrix10::zeros();
        for i in 0..5 {
            a[(i, 5 + i)] = 1.0;
            for j in 0..5 {
                a[(5 + i, j)] = -stiffness[(i, j)] * self.inverse_mass(i) / (w0 * w0);
                a[(5 + i, 5 + j)] = -damping[(i, j)] * self.inverse_mass(i) / w0;
            }
        }
        a
    }

    /// Influence of the feed deflection one revolution ago and of its rate.
    fn delayed(&self, angle: f64) -> SMatrix<f64, 10, 2> {
        let w0 = self.reference_frequency();
        let (chi, lag) = self.rows();
        let feed_side = self.cutting_stiffness * self.allowance(angle);
        let mut b = SMatrix::zeros();
        for i in 0..5 {
            b[(5 + i, 0)] = chi[i] * feed_side * self.inverse_mass(i) / (w0 * w0);
            b[(5 + i, 1)] = -lag[i] * chi[i] * feed_side * self.inverse_mass(i) / w0;
        }
        b
    }

    /// Eigenvalues [1/s] without modulation and regeneration, those of upper half plane first.
    ///
    /// # Errors
    /// Constants that are no structure.
    pub fn eigenvalues(&self) -> Result<Vec<Complex<f64>>, ChatterError> {
        self.check()?;
        let mean = Self { mu_chuck: 0.0, mu_allowance: Vec::new(), ..self.clone() };
        let w0 = self.reference_frequency();
        let mut eigenvalues: Vec<_> = mean.coefficients(0.0).complex_eigenvalues().iter().map(|l| l * w0).collect();
        eigenvalues.sort_by(|x, y| (y.im > 0.0).cmp(&(x.im > 0.0)).then(x.im.abs().total_cmp(&y.im.abs())));
        Ok(eigenvalues)
    }

    /// Floquet multipliers over one revolution at `spindle_speed` (rad/s), the greatest first.
    ///
    /// # Errors
    /// Constants that are no structure; a spindle speed that is not positive, or at which the fastest vibration swings
    /// more than 1000 times in a revolution (30 times with regeneration); a vibration that outgrows all numbers within it.
    ///
    /// # Examples
    /// ```
    /// use toolroom_chatter::paper::{FiveDegrees, Preset};
    /// let mut lathe = FiveDegrees::from_preset(Preset::Table2Milli, 0.4e-4, 0.1e-3);
    /// lathe.mu_chuck = 0.3;
    /// let speed = 0.55 * lathe.reference_frequency();
    /// assert!((lathe.multipliers(speed).unwrap()[0].norm() - 1.196003135).abs() < 1e-7);
    /// ```
    pub fn multipliers(&self, spindle_speed: f64) -> Result<Vec<Complex<f64>>, ChatterError> {
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        let w0 = self.reference_frequency();
        let ratio = spindle_speed / w0;
        // Fastest oscillation: the stiffest direction of the tool, in units of w0.
        let fastest = ((0..3).map(|i| self.tool_stiffness[i][i]).sum::<f64>() / self.tool_mass).sqrt() / w0;
        let fastest = fastest.max(1.0);
        let cycles = fastest / ratio;
        let most = if self.regeneration { MOST_REGENERATED } else { super::MOST_CYCLES };
        within("speed_ratio", ratio, fastest / most, f64::MAX)?;
        if self.regeneration {
            let mut observed = SMatrix::<f64, 2, 10>::zeros();
            observed[(0, 2)] = 1.0;
            observed[(1, 7)] = 1.0;
            let elements = cycles.ceil() as usize;
            let a = |s: f64| self.coefficients(ratio * s);
            let b = |s: f64| self.delayed(ratio * s);
            return delayed_multipliers(a, b, &observed, TAU / ratio, elements, 14);
        }
        let steps = ((80.0 * cycles).ceil() as usize).max(400);
        let map = monodromy(|s| self.coefficients(ratio * s), TAU / ratio, steps);
        Ok(dense_eigenvalues(DMatrix::from_iterator(10, 10, map.iter().copied()))?)
    }

    /// Verdict at `spindle_speed` (rad/s), with the spectral radius over one revolution.
    ///
    /// # Errors
    /// As [`FiveDegrees::multipliers`].
    pub fn verdict(&self, spindle_speed: f64) -> Result<StabilityVerdict, ChatterError> {
        let dominant = self.multipliers(spindle_speed)?[0];
        let mut verdict = StabilityVerdict::from_multiplier(dominant, TAU / spindle_speed, 0.0);
        let modulated = self.mu_chuck != 0.0 || self.mu_allowance.iter().any(|mu| *mu != 0.0);
        if !verdict.stable && modulated {
            let mean = Self { mu_chuck: 0.0, mu_allowance: Vec::new(), ..self.clone() };
            if mean.multipliers(spindle_speed)?[0].norm() < 1.0 {
                verdict.kind = ChatterKind::Parametric;
            }
        }
        Ok(verdict)
    }

    /// Least chuck modulation that is unstable at `spindle_speed` (rad/s), up to `greatest`.
    ///
    /// # Errors
    /// As [`FiveDegrees::multipliers`].
    pub fn critical_chuck_modulation(&self, spindle_speed: f64, greatest: f64) -> Result<Option<f64>, ChatterError> {
        positive("mu_chuck", greatest)?;
        super::first_unstable(greatest, 24, |mu_chuck| {
            Ok(Self { mu_chuck, ..self.clone() }.multipliers(spindle_speed)?[0].norm() - 1.0)
        })
    }
}

/// Entries of the paper's tables in SI units.
fn in_si<const N: usize>(table: [[f64; N]; N]) -> [[f64; N]; N] {
    table.map(|row| row.map(|entry| entry * KGF_PER_MM))
}

/// Refuses a matrix that is not positive definite, naming its least eigenvalue.
fn positive_definite<const N: usize>(quantity: &'static str, rows: [[f64; N]; N]) -> Result<(), ChatterError> {
    let matrix = SMatrix::<f64, N, N>::from_fn(|i, j| rows[i][j]);
    for value in matrix.iter() {
        finite(quantity, *value)?;
    }
    let matrix = DMatrix::from_fn(N, N, |i, j| matrix[(i, j)]);
    let least = matrix.symmetric_eigenvalues().min();
    positive(quantity, least).map(|_| ())
}
