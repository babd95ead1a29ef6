//! Receptance coupling: a tool on a measured spindle, from the receptance of both.
//!
//! A receptance at an end is the matrix `[[y/F, y/M], [theta/F, theta/M]]` of displacement and slope over force and moment,
//! with theta = dy/dx and x from the tip into the spindle. A segment is an exact Timoshenko beam: the state (y, theta, M, Q)
//! obeys `y' = theta + Q/(k' G A)`, `theta' = M/(E I)`, `M' = −Q − rho I w² theta`, `Q' = −rho A w² y`, with the complex modulus
//! `E (1 + i eta)` of a hysteretic loss factor.
//!
//! # Source
//! Schmitz, Smith: Machining Dynamics (receptance coupling); Hutchinson, J. Appl. Mech. 68 (2001) 87-92 (shear coefficient of
//! a circle, solid or hollow).
//!
//! # What is not modelled
//! Torsion and axial motion, gyroscopic moments, joints whose stiffness depends on load or speed.

use nalgebra::{Complex, Matrix2, Matrix4, Vector4};
use std::f64::consts::PI;

/// A receptance at one end: (y, theta) over (F, M).
pub type Receptance = Matrix2<Complex<f64>>;

/// What a segment is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Young's modulus (Pa).
    pub youngs_modulus: f64,
    /// Density (kg/m³).
    pub density: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Hysteretic loss factor.
    pub loss_factor: f64,
}

/// A part of a tool or holder with one round section.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Length (m).
    pub length: f64,
    /// Outer diameter (m).
    pub diameter: f64,
    /// Diameter of a bore (m), 0 without.
    pub inner_diameter: f64,
    /// Share of the diameter that bends and shears; 0.8 for a fluted length (Kops and Vo, Ann. CIRP 39 (1990), recalled).
    pub bending_factor: f64,
    /// Share of the diameter whose mass moves.
    pub inertia_factor: f64,
    /// Its material.
    pub material: Material,
}

/// Springs between tool and base, each with a hysteretic loss factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Radial stiffness (N/m).
    pub radial: f64,
    /// Angular stiffness (N m/rad).
    pub angular: f64,
    /// Loss factor of both.
    pub loss_factor: f64,
}

/// A mass on a spring and a dashpot inside of a tool, such as that of a boring bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Damper {
    /// Mass (kg).
    pub mass: f64,
    /// Natural frequency (Hz) of the mass on its spring, the tool held fast.
    pub natural_frequency: f64,
    /// Share of critical damping of the same.
    pub damping_ratio: f64,
}

/// A mode of a base with its slope.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseMode {
    /// Undamped natural frequency (Hz).
    pub natural_frequency: f64,
    /// Share of critical damping.
    pub damping_ratio: f64,
    /// Modal stiffness at the face (N/m).
    pub stiffness: f64,
    /// Slope over displacement at the face (1/m).
    pub rotation: f64,
}

/// Receptances of a body with two free ends.
#[derive(Clone, Copy, Debug)]
pub struct Body {
    /// Of the first end under loads there.
    pub r11: Receptance,
    /// Of the first end under loads at the second.
    pub r12: Receptance,
    /// Of the second end under loads at the first.
    pub r21: Receptance,
    /// Of the second end under loads there.
    pub r22: Receptance,
}

/// Area (m²) and second moment (m⁴) of a ring.
fn section(outer: f64, inner: f64) -> (f64, f64) {
    (0.25 * PI * (outer.powi(2) - inner.powi(2)), PI / 64.0 * (outer.powi(4) - inner.powi(4)))
}

/// Shear coefficient of a ring by the ratio of its inner to its outer diameter; a thin tube shears at half of its area.
fn shear_coefficient(nu: f64, ratio: f64) -> f64 {
    let square = ratio * ratio;
    let both = (1.0 + square).powi(2);
    6.0 * (1.0 + nu).powi(2) * both
        / ((7.0 + 12.0 * nu + 4.0 * nu * nu) * both + 4.0 * (5.0 + 6.0 * nu + 2.0 * nu * nu) * square)
}

impl Segment {
    /// A solid rod of a length and diameter (m), of which the share `factor` of the diameter bends and moves: 1 for a plain one.
    pub const fn rod(length: f64, diameter: f64, factor: f64, material: Material) -> Self {
        Self { length, diameter, inner_diameter: 0.0, bending_factor: factor, inertia_factor: factor, material }
    }

    /// Its receptances with free ends at `w` (rad/s, positive); none where a frequency of the free body makes them infinite.
    pub fn body(&self, w: f64) -> Option<Body> {
        let Material { youngs_modulus, density, poisson_ratio: nu, loss_factor } = self.material;
        let modulus = Complex::new(1.0, loss_factor) * youngs_modulus;
        let (bending_area, bending_moment) = section(self.diameter * self.bending_factor, self.inner_diameter);
        let (area, moment) = section(self.diameter * self.inertia_factor, self.inner_diameter);
        let shear_share = shear_coefficient(nu, self.inner_diameter / (self.diameter * self.bending_factor));
        let shear = modulus * (shear_share * bending_area / (2.0 * (1.0 + nu)));
        let stiffness = modulus * bending_moment;
        // The state in units of length, 1, E I/L and E I/L² has entries of like size.
        let l = self.length;
        let scale = youngs_modulus * bending_moment;
        let zero = Complex::new(0.0, 0.0);
        let one = Complex::new(1.0, 0.0);
        let inertia = density * w * w;
        #[rustfmt::skip]
        let rates = Matrix4::new(
            zero, one, zero, one * (scale / (l * l)) / shear,
            zero, zero, one * scale / stiffness, zero,
            zero, one * (-inertia * moment * l * l / scale), zero, -one,
            one * (-inertia * area * l.powi(4) / scale), zero, zero, zero,
        );
        let transfer = exponential(&rates);
        let block = |i, j| transfer.fixed_view::<2, 2>(i, j).into_owned();
        let (uu, uf, fu, ff) = (block(0, 0), block(0, 2), block(2, 0), block(2, 2));
        let inverse = fu.try_inverse()?;
        // From scaled loads (M, F) to (F, M) in SI units.
        let swap = |matrix: Matrix2<Complex<f64>>| {
            let units = Matrix2::new(l, 0.0, 0.0, 1.0).map(Complex::from);
            let loads = Matrix2::new(0.0, l / scale, l * l / scale, 0.0).map(Complex::from);
            units * matrix * loads
        };
        Some(Body {
            r11: swap(inverse * ff),
            r12: swap(inverse),
            r21: swap(uu * inverse * ff - uf),
            r22: swap(uu * inverse),
        })
    }
}

impl Body {
    /// This body with another one joined rigidly to its second end.
    pub fn with(&self, next: &Self) -> Option<Self> {
        let inverse = (self.r22 + next.r11).try_inverse()?;
        Some(Self {
            r11: self.r11 - self.r12 * inverse * self.r21,
            r12: self.r12 * inverse * next.r12,
            r21: next.r21 * inverse * self.r21,
            r22: next.r22 - next.r21 * inverse * next.r12,
        })
    }

    /// This body with a damper at its first end, at `w` (rad/s).
    pub fn damped(&self, damper: &Damper, w: f64) -> Option<Self> {
        let inverse = damper.stiffness(w).inv() + self.r11[(0, 0)];
        if !(inverse.norm() > 0.0 && inverse.norm().is_finite()) {
            return None;
        }
        // Loads on either end move the first end; the damper answers with a force there.
        let answer = |from: &Receptance, to: &Receptance| (from.column(0) * to.row(0)) / inverse;
        Some(Self {
            r11: self.r11 - answer(&self.r11, &self.r11),
            r12: self.r12 - answer(&self.r11, &self.r12),
            r21: self.r21 - answer(&self.r21, &self.r11),
            r22: self.r22 - answer(&self.r21, &self.r12),
        })
    }

    /// Receptance of the first end with the second end on a base, over a joint where there is one.
    pub fn on(&self, base: &Receptance, joint: Option<&Joint>) -> Option<Receptance> {
        let between = joint.map_or_else(Receptance::zeros, Joint::compliance);
        let inverse = (self.r22 + base + between).try_inverse()?;
        Some(self.r11 - self.r12 * inverse * self.r21)
    }

    /// Receptance of a base from that of this body on it, the inverse of [`Body::on`] without joint.
    pub fn removed(&self, assembled: &Receptance) -> Option<Receptance> {
        Some(self.r21 * (self.r11 - assembled).try_inverse()? * self.r12 - self.r22)
    }
}

impl Damper {
    /// Force over displacement (N/m) with which it resists at `w` (rad/s): `−m w² (k + i c w)/(k + i c w − m w²)`.
    fn stiffness(&self, w: f64) -> Complex<f64> {
        let own = std::f64::consts::TAU * self.natural_frequency;
        let spring = Complex::new(own * own, 2.0 * self.damping_ratio * own * w) * self.mass;
        let inertia = self.mass * w * w;
        -spring * inertia / (spring - inertia)
    }
}

impl Joint {
    fn compliance(&self) -> Receptance {
        let spring = |stiffness: f64| 1.0 / (Complex::new(1.0, self.loss_factor) * stiffness);
        Receptance::from_diagonal(&nalgebra::Vector2::new(spring(self.radial), spring(self.angular)))
    }
}

/// Segments from the tip on, joined rigidly, at `w` (rad/s).
pub fn chain(segments: &[Segment], w: f64) -> Option<Body> {
    let (first, rest) = segments.split_first()?;
    rest.iter().try_fold(first.body(w)?, |body, segment| body.with(&segment.body(w)?))
}

/// Receptance of a base of modes at `w` (rad/s).
pub fn base(modes: &[BaseMode], w: f64) -> Receptance {
    modes.iter().fold(Receptance::zeros(), |sum, mode| {
        let wr = std::f64::consts::TAU * mode.natural_frequency;
        let denominator = Complex::new(wr * wr - w * w, 2.0 * mode.damping_ratio * wr * w);
        let value = wr * wr / mode.stiffness / denominator;
        let r = mode.rotation;
        sum + Matrix2::new(1.0, r, r, r * r).map(|entry| value * entry)
    })
}

/// Exponential of a matrix by scaling, Taylor's series and squaring.
fn exponential(matrix: &Matrix4<Complex<f64>>) -> Matrix4<Complex<f64>> {
    /// Order at which `(1/2)^n/n!` is below the rounding of numbers.
    const ORDER: u32 = 14;
    let size = matrix.iter().map(|entry| entry.norm()).fold(0.0, f64::max) * 4.0;
    let halvings = size.log2().ceil().max(-1.0) as i32 + 1;
    let scaled = matrix * Complex::from(0.5f64.powi(halvings));
    let mut sum = Matrix4::from_diagonal(&Vector4::repeat(Complex::from(1.0)));
    let mut term = sum;
    for order in 1..=ORDER {
        term = term * scaled * Complex::from(1.0 / f64::from(order));
        sum += term;
    }
    for _ in 0..halvings {
        sum *= sum;
    }
    sum
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::f64::consts::TAU;

    pub(crate) const STEEL: Material =
        Material { youngs_modulus: 200e9, density: 7800.0, poisson_ratio: 0.29, loss_factor: 0.01 };
    pub(crate) const CARBIDE: Material =
        Material { youngs_modulus: 580e9, density: 14_500.0, poisson_ratio: 0.24, loss_factor: 0.004 };

    /// Peaks of |H| up to a frequency (Hz): frequency (Hz) and height.
    fn peaks(h: impl Fn(f64) -> Complex<f64>, last: u32) -> Vec<(f64, f64)> {
        let size = |frequency: f64| h(TAU * frequency).norm();
        let grid: Vec<f64> = (1..last / 2).map(|i| 2.0 * f64::from(i)).collect();
        let values: Vec<f64> = grid.iter().map(|frequency| size(*frequency)).collect();
        let mut found = Vec::new();
        for i in 1..grid.len() - 1 {
            if values[i] > values[i - 1] && values[i] > values[i + 1] {
                let (mut a, mut b) = (grid[i - 1], grid[i + 1]);
                for _ in 0..80 {
                    let (c, d) = (a + (b - a) / 3.0, b - (b - a) / 3.0);
                    if size(c) > size(d) { b = d } else { a = c }
                }
                found.push((a, size(a)));
            }
        }
        found
    }

    #[test]
    fn a_tube_shears_at_less_than_its_area() {
        // A solid circle and, for any Poisson's ratio, a thin tube: (1 + nu)/(2 + nu).
        close(shear_coefficient(0.29, 0.0), 6.0 * 1.29 * 1.29 / (7.0 + 12.0 * 0.29 + 4.0 * 0.29 * 0.29), 1e-15);
        for nu in [0.0, 0.24, 0.5] {
            close(shear_coefficient(nu, 1.0), (1.0 + nu) / (2.0 + nu), 1e-14);
        }
        // A bore weakens it steadily.
        let ratios: Vec<f64> = (0..=10).map(|i| shear_coefficient(0.29, 0.1 * f64::from(i))).collect();
        assert!(ratios.windows(2).all(|pair| pair[1] < pair[0]), "{ratios:?}");
    }

    fn close(value: f64, expected: f64, tolerance: f64) {
        assert!((value / expected - 1.0).abs() < tolerance, "{value} is not {expected}");
    }

    #[test]
    fn a_clamped_steel_rod_has_its_published_peaks() {
        let rod = Segment::rod(0.125, 0.01, 1.0, STEEL);
        let tip = |w: f64| rod.body(w).unwrap().on(&Receptance::zeros(), None).unwrap()[(0, 0)];
        let found = peaks(tip, 12_000);
        let expected = [(451.786, 645.495e-6), (2774.11, 16.646e-6), (7531.96, 2.1633e-6)];
        for ((frequency, height), (f, h)) in found.iter().zip(expected) {
            close(*frequency, f, 1e-4);
            close(*height, h, 1e-4);
        }
        let receptance = tip(TAU * 500.0) * 1e6;
        close(receptance.re, -28.45019, 1e-6);
        close(receptance.im, -1.27665, 1e-5);
        close(tip(TAU * 0.5).norm() * 1e6, 6.65340, 1e-4);
    }

    #[test]
    fn a_slender_rod_is_one_of_euler() {
        // Without shear and rotary inertia: 453.376 Hz of 125 mm scale with the square of the length.
        let rod = Segment::rod(5.0, 0.01, 1.0, Material { loss_factor: 1e-4, ..STEEL });
        let tip = |w: f64| rod.body(w).unwrap().on(&Receptance::zeros(), None).unwrap()[(0, 0)].norm();
        let euler = 453.376 * (0.125f64 / 5.0).powi(2);
        let near = |factor: f64| tip(TAU * euler * factor);
        assert!(near(1.0) > near(0.9998) && near(1.0) > near(1.0002), "the peak is not at {euler} Hz");
    }

    fn spindle(w: f64) -> Receptance {
        let mode = |natural_frequency, damping_ratio, stiffness, rotation| BaseMode {
            natural_frequency,
            damping_ratio,
            stiffness,
            rotation,
        };
        base(&[mode(680.0, 0.045, 4.2e7, -9.0), mode(1420.0, 0.03, 6.5e7, -14.0), mode(2950.0, 0.025, 9e7, -22.0)], w)
    }

    fn tool(overhang: f64) -> [Segment; 2] {
        [Segment::rod(0.026, 0.012, 0.8, CARBIDE), Segment::rod(overhang - 0.026, 0.012, 1.0, CARBIDE)]
    }

    #[test]
    fn tools_on_a_spindle_have_the_peaks_of_an_independent_computation() {
        let joint = Joint { radial: 2e8, angular: 2.5e4, loss_factor: 0.02 };
        type Case = (f64, bool, [(f64, f64); 3], [f64; 2]);
        let cases: [Case; 4] = [
            (0.040, false, [(661.58, 0.61166), (1345.16, 0.85112), (2530.58, 0.91331)], [0.147446, -0.014981]),
            (0.040, true, [(1338.07, 1.08344), (2438.55, 1.71269), (4988.65, 2.33149)], [0.234727, -0.018854]),
            (0.055, false, [(1289.49, 1.51743), (2283.95, 1.60606), (5311.63, 3.70643)], [0.276570, -0.026449]),
            (0.055, true, [(1264.54, 2.62487), (2059.45, 3.58955), (3761.97, 1.41367)], [0.502866, -0.043530]),
        ];
        for (overhang, jointed, expected, at) in cases {
            let joint = jointed.then_some(&joint);
            let tip = |w: f64| chain(&tool(overhang), w).unwrap().on(&spindle(w), joint).unwrap()[(0, 0)];
            let mut found = peaks(tip, 6_000);
            found.sort_by(|a, b| b.1.total_cmp(&a.1));
            found.truncate(3);
            found.sort_by(|a, b| a.0.total_cmp(&b.0));
            for ((frequency, height), (f, h)) in found.iter().zip(expected) {
                close(*frequency, f, 1e-4);
                close(*height * 1e6, h, 1e-4);
            }
            let value = tip(TAU * 1000.0) * 1e6;
            close(value.re, at[0], 1e-5);
            close(value.im, at[1], 1e-4);
        }
    }

    #[test]
    fn a_damper_halves_a_peak_as_den_hartog_says() {
        // J. P. Den Hartog, Mechanical Vibrations, 4th edition (1956), section 3.3: the best damper of the mass ratio mu has its frequency
        // at 1/(1 + mu) of that of the structure and the square of its damping ratio at 3 mu/(8 (1 + mu)^3); the peak is sqrt(1 + 2/mu) of the
        // static deflection. The structure: one mode under a short stiff rod without mass.
        let (frequency, stiffness, ratio) = (200.0, 1e7, 0.05f64);
        let mass = stiffness / (TAU * frequency).powi(2);
        let damper = Damper {
            mass: ratio * mass,
            natural_frequency: frequency / (1.0 + ratio),
            damping_ratio: (3.0 * ratio / (8.0 * (1.0 + ratio).powi(3))).sqrt(),
        };
        let light = Material { youngs_modulus: 2e12, density: 1.0, poisson_ratio: 0.3, loss_factor: 1e-4 };
        let rod = Segment::rod(0.005, 0.05, 1.0, light);
        let mode = BaseMode { natural_frequency: frequency, damping_ratio: 1e-6, stiffness, rotation: 0.0 };
        let tip =
            |w: f64| rod.body(w).unwrap().damped(&damper, w).unwrap().on(&base(&[mode], w), None).unwrap()[(0, 0)];
        let found = peaks(tip, 400);
        assert_eq!(found.len(), 2, "{found:?}");
        for (_, height) in found {
            close(height * stiffness, (1.0 + 2.0 / ratio).sqrt(), 0.01);
        }
        // A mass without spring is a mass: 1/3 more lowers the frequency to sqrt(3)/2.
        let mass = Damper { mass: mass / 3.0, natural_frequency: 1e6, damping_ratio: 0.0 };
        let loaded =
            |w: f64| rod.body(w).unwrap().damped(&mass, w).unwrap().on(&base(&[mode], w), None).unwrap()[(0, 0)];
        close(peaks(loaded, 400)[0].0, frequency * 0.75f64.sqrt(), 1e-3);
    }

    #[test]
    fn a_blank_that_is_removed_and_put_on_again_changes_nothing() {
        for frequency in [150.0, 700.0, 1500.0, 4000.0] {
            let w = TAU * frequency;
            let blank = Segment::rod(0.04, 0.016, 1.0, STEEL).body(w).unwrap();
            let measured = blank.on(&spindle(w), None).unwrap();
            let again = blank.on(&blank.removed(&measured).unwrap(), None).unwrap();
            assert!((again - measured).norm() < 1e-9 * measured.norm());
        }
    }
}
