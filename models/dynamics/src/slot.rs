//! Cutting-force coefficients of milling from mean forces over the feed: the average-force method.
//!
//! With the force of a tooth `K_t w h + K_te w` along the cutting speed, `K_r w h + K_re w` along the radius and
//! `K_a w h + K_ae w` along the axis, and `h = f sin(phi)` between entry and exit, the mean forces on the tool are straight lines
//! over the feed per tooth f:
//!
//! ```text
//!  mean F_x = −N w/(2 pi) [f (K_t I_sc + K_r I_ss) + K_te I_c + K_re I_s]       x: feed
//!  mean F_y = −N w/(2 pi) [f (K_r I_sc − K_t I_ss) + K_re I_c − K_te I_s]       y: normal to it
//!  mean F_z =  N w/(2 pi) [f K_a I_s + K_ae (exit − entry)]                     z: axis of the cutter
//! ```
//!
//! with the integrals of sin cos, sin², cos and sin over the arc. In a slot: `−N w/4 K_r f − N w/pi K_re`,
//! `N w/4 K_t f + N w/pi K_te` and `N w/pi K_a f + N w/2 K_ae`. A helix does not change a mean over a revolution.
//!
//! # Source
//! Altintas, Manufacturing Automation (2012), mechanistic identification; the equations follow from the force above.

use crate::error::DynamicsError;
use crate::table::read_table;
use crate::unit::{self, Motion};
use nalgebra::{Matrix2, Vector2};
use std::f64::consts::PI;
use toolroom_location::{Located, Location};
use toolroom_numerics::beta_quantile;

/// Why no coefficients can be identified.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ForceTestError {
    /// The table cannot be read.
    #[error(transparent)]
    Table(#[from] DynamicsError),
    /// A column of no known meaning or unit, or one that is there twice.
    #[error(
        "{file}:{line}: the column `{column}` is none of `feed_per_tooth [mm]`, `mean_force_x [N]`, `mean_force_y [N]` and \
         `mean_force_z [N]`, each once and with its unit"
    )]
    Column {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The column as it is written.
        column: String,
    },
    /// A column that is needed.
    #[error("{file}:{line}: the column `{column}` is missing")]
    Missing {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// The column.
        column: &'static str,
    },
    /// A feed that is none.
    #[error("{file}: a feed per tooth of {value} mm is not positive")]
    Feed {
        /// The file.
        file: String,
        /// The feed (mm).
        value: f64,
    },
    /// A line over the feed needs three of them to be tested.
    #[error(
        "{file}: {feeds} different feeds do not tell chip and edge apart with an error; cut at three feeds or more"
    )]
    TooFewFeeds {
        /// The file.
        file: String,
        /// How many there are.
        feeds: usize,
    },
    /// A coefficient of a sign that no cut has.
    #[error(
        "the {name} coefficient would be {value:.1} MPa: the axes or signs of the dynamometer are not those of the tool; \
         forces on the work have the opposite sign"
    )]
    Sign {
        /// Which coefficient.
        name: &'static str,
        /// Its value (MPa).
        value: f64,
    },
    /// A cut that is none.
    #[error("the cut has no teeth, depth or arc")]
    NoCut,
}

impl Located for ForceTestError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Table(error) => error.location(),
            Self::Column { file, line, .. } | Self::Missing { file, line, .. } => Some(Location::line(file, *line)),
            Self::Feed { file, .. } | Self::TooFewFeeds { file, .. } => Some(Location::of(file)),
            Self::Sign { .. } | Self::NoCut => None,
        }
    }
}

/// How the cutter was in the work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TestedCut {
    /// Teeth of the cutter.
    pub teeth: u32,
    /// Axial depth of cut (m).
    pub depth: f64,
    /// Angle from the normal to the feed at which a tooth enters (rad).
    pub entry: f64,
    /// Angle at which it leaves (rad).
    pub exit: f64,
}

/// Mean forces on the tool over the feed.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceTest {
    /// Name of the file.
    pub source: String,
    /// Feeds per tooth (m).
    pub feeds: Vec<f64>,
    /// Mean forces along feed, normal and axis (N); of the axis where it was measured.
    pub forces: [Option<Vec<f64>>; 3],
}

/// A coefficient and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficient {
    /// The value (Pa, or N/m of an edge).
    pub value: f64,
    /// Its standard deviation.
    pub sd: f64,
}

/// Whether the means of repeated feeds lie on a line: an F test of what the line leaves against the repeats.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LackOfFit {
    /// Mean square of the lack of fit over that of the repeats.
    pub ratio: f64,
    /// Value that it exceeds in 5 % of tests of a straight line.
    pub critical: f64,
    /// Degrees of freedom of both.
    pub freedom: [usize; 2],
}

/// A line of mean force over feed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForceLine {
    /// Force at no feed (N).
    pub intercept: f64,
    /// Force per feed (N/m).
    pub slope: f64,
    /// Standard deviation of a mean force about it (N).
    pub residual: f64,
    /// The test of the line, where a feed was cut more than once.
    pub lack_of_fit: Option<LackOfFit>,
}

/// Cutting-force coefficients with their uncertainty.
#[derive(Clone, Debug, PartialEq)]
pub struct Coefficients {
    /// Of the chip: tangential, radial, axial (Pa).
    pub chip: [Option<Coefficient>; 3],
    /// Of the edge: tangential, radial, axial (N/m).
    pub edge: [Option<Coefficient>; 3],
    /// Lines of the forces along feed, normal and axis.
    pub lines: [Option<ForceLine>; 3],
    /// Least and greatest feed per tooth (m).
    pub range: [f64; 2],
    /// Degrees of freedom behind every standard deviation.
    pub freedom: usize,
    /// Factor of a standard deviation that makes half of a 95 % interval.
    pub quantile: f64,
    /// What to be careful about, in words.
    pub warnings: Vec<String>,
}

/// Reads mean forces over the feed: `feed_per_tooth [mm]`, `mean_force_x [N]`, `mean_force_y [N]` and, where it was measured,
/// `mean_force_z [N]`; `file` is its name in messages.
///
/// # Errors
/// [`ForceTestError`] with the place of the fault.
pub fn read_forces(file: &str, text: &str) -> Result<ForceTest, ForceTestError> {
    let table = read_table(file, text)?;
    let line = table.line;
    const NAMES: [&str; 4] = ["feed_per_tooth", "mean_force_x", "mean_force_y", "mean_force_z"];
    let sorted = table.sorted(|name, unit| {
        let (place, unit) = (NAMES.iter().position(|known| *known == name)?, unit?);
        let factor = if place == 0 {
            let length = unit::motion(unit.strip_suffix("/tooth").unwrap_or(unit));
            length.filter(|(_, motion)| *motion == Motion::Displacement).map(|(factor, _)| factor)
        } else {
            unit::force(unit)
        };
        Some((place, factor?))
    });
    let refused = |column| ForceTestError::Column { file: file.to_owned(), line, column };
    let [feeds, x, y, z] = sorted.map_err(refused)?;
    let forces = [x, y, z];
    let missing = |column| ForceTestError::Missing { file: file.to_owned(), line, column };
    let feeds: Vec<f64> = feeds.ok_or_else(|| missing("feed_per_tooth [mm]"))?;
    for (force, column) in forces.iter().zip(["mean_force_x [N]", "mean_force_y [N]"]) {
        if force.is_none() {
            return Err(missing(column));
        }
    }
    if let Some(feed) = feeds.iter().find(|feed| **feed <= 0.0) {
        return Err(ForceTestError::Feed { file: file.to_owned(), value: feed * 1e3 });
    }
    Ok(ForceTest { source: file.to_owned(), feeds, forces })
}

impl ForceTest {
    /// The forces along feed, normal and axis of the tool, where the dynamometer has other axes: which of its columns each
    /// of them is, 0 to 2, and by what factor.
    #[must_use]
    pub fn turned(self, axes: [(usize, f64); 3]) -> Self {
        let forces = axes.map(|(column, factor)| {
            self.forces[column].as_ref().map(|values| values.iter().map(|value| value * factor).collect())
        });
        Self { forces, ..self }
    }

    /// Coefficients by least squares.
    ///
    /// # Errors
    /// [`ForceTestError`]: fewer than three feeds, a cut that is none, coefficients of an impossible sign.
    pub fn identify(&self, cut: &TestedCut) -> Result<Coefficients, ForceTestError> {
        let arc = cut.exit - cut.entry;
        if cut.teeth == 0 || cut.depth <= 0.0 || arc <= 0.0 {
            return Err(ForceTestError::NoCut);
        }
        let mut known = self.feeds.clone();
        known.sort_by(f64::total_cmp);
        known.dedup_by(|a, b| (*a - *b).abs() < 1e-9 * b.abs());
        if known.len() < 3 {
            return Err(ForceTestError::TooFewFeeds { file: self.source.clone(), feeds: known.len() });
        }
        let count = self.feeds.len() as f64;
        let mean = self.feeds.iter().sum::<f64>() / count;
        let spread = self.feeds.iter().map(|feed| (feed - mean).powi(2)).sum::<f64>();
        let freedom = self.feeds.len() - 2;
        let lines = self.forces.each_ref().map(|forces| forces.as_ref().map(|forces| self.line(forces, &known)));
        let (Some(x), Some(y)) = (lines[0], lines[1]) else {
            return Err(ForceTestError::Missing { file: self.source.clone(), line: 1, column: "mean_force_y [N]" });
        };
        let across = self.residual_product(x, y) / freedom as f64;
        // Variance of slope and intercept over that of a mean force.
        let (of_slope, of_intercept) = (1.0 / spread, 1.0 / count + mean * mean / spread);
        let scale = f64::from(cut.teeth) * cut.depth / (2.0 * PI);
        let (s0, c0) = cut.entry.sin_cos();
        let (s1, c1) = cut.exit.sin_cos();
        let (i_sc, i_ss) = (0.5 * (s1 * s1 - s0 * s0), 0.5 * (arc - (s1 * c1 - s0 * c0)));
        let (i_c, i_s) = (s1 - s0, c0 - c1);
        let plane = |a: f64, b: f64, of: [f64; 2], share: f64| {
            // [F_x, F_y] = −scale [[a, b], [−b, a]] [tangential, radial].
            let norm = -1.0 / (scale * (a * a + b * b));
            let inverse = Matrix2::new(a, -b, b, a) * norm;
            let value = inverse * Vector2::from(of);
            let noise = Matrix2::new(x.residual * x.residual, across, across, y.residual * y.residual) * share;
            let covariance = inverse * noise * inverse.transpose();
            [0, 1].map(|i| Coefficient { value: value[i], sd: covariance[(i, i)].max(0.0).sqrt() })
        };
        let [tangential, radial] = plane(i_sc, i_ss, [x.slope, y.slope], of_slope);
        let [edge_tangential, edge_radial] = plane(i_c, i_s, [x.intercept, y.intercept], of_intercept);
        let axial = lines[2].map(|z| {
            let (chip, edge) = (scale * i_s, scale * arc);
            [
                Coefficient { value: z.slope / chip, sd: z.residual * of_slope.sqrt() / chip },
                Coefficient { value: z.intercept / edge, sd: z.residual * of_intercept.sqrt() / edge },
            ]
        });
        if tangential.value <= 0.0 {
            return Err(ForceTestError::Sign { name: "tangential", value: tangential.value * 1e-6 });
        }
        if radial.value < -2.0 * radial.sd {
            return Err(ForceTestError::Sign { name: "radial", value: radial.value * 1e-6 });
        }
        let chip = [Some(tangential), Some(radial), axial.map(|pair| pair[0])];
        let edge = [Some(edge_tangential), Some(edge_radial), axial.map(|pair| pair[1])];
        let mut found = Coefficients {
            chip,
            edge,
            lines,
            range: [known[0], known[known.len() - 1]],
            freedom,
            quantile: f_quantile(1, freedom).sqrt(),
            warnings: Vec::new(),
        };
        found.warn();
        Ok(found)
    }

    /// The line of a force over the feed.
    fn line(&self, forces: &[f64], known: &[f64]) -> ForceLine {
        let count = forces.len() as f64;
        let feed = self.feeds.iter().sum::<f64>() / count;
        let force = forces.iter().sum::<f64>() / count;
        let pairs = || self.feeds.iter().zip(forces);
        let spread = self.feeds.iter().map(|at| (at - feed).powi(2)).sum::<f64>();
        let slope = pairs().map(|(at, value)| (at - feed) * (value - force)).sum::<f64>() / spread;
        let intercept = force - slope * feed;
        let left = pairs().map(|(at, value)| (value - intercept - slope * at).powi(2)).sum::<f64>();
        let freedom = forces.len() - 2;
        // What repeats of one feed scatter.
        let mut pure = 0.0;
        for at in known {
            let repeats: Vec<f64> =
                pairs().filter(|(feed, _)| (*feed - at).abs() < 1e-9 * at.abs()).map(|(_, value)| *value).collect();
            let mean = repeats.iter().sum::<f64>() / repeats.len() as f64;
            pure += repeats.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        }
        let degrees = [known.len() - 2, forces.len() - known.len()];
        let lack_of_fit = (degrees[1] > 0 && pure > 0.0).then(|| LackOfFit {
            ratio: ((left - pure).max(0.0) / degrees[0] as f64) / (pure / degrees[1] as f64),
            critical: f_quantile(degrees[0], degrees[1]),
            freedom: degrees,
        });
        ForceLine { intercept, slope, residual: (left / freedom as f64).sqrt(), lack_of_fit }
    }

    /// Sum of the products of what two lines leave of the forces in the plane.
    fn residual_product(&self, x: ForceLine, y: ForceLine) -> f64 {
        let left = |i: usize, line: ForceLine| -> Vec<f64> {
            let forces = self.forces[i].iter().flatten();
            self.feeds.iter().zip(forces).map(|(at, force)| force - line.intercept - line.slope * at).collect()
        };
        left(0, x).iter().zip(left(1, y)).map(|(a, b)| a * b).sum()
    }
}

impl Coefficients {
    /// Says what is doubtful.
    fn warn(&mut self) {
        let names = ["tangential", "radial", "axial"];
        for (edge, name) in self.edge.iter().zip(names) {
            if let Some(edge) = edge.filter(|edge| edge.value < -2.0 * edge.sd) {
                self.warnings.push(format!(
                    "the {name} edge force is negative, {:.2} ± {:.2} N/mm: the forces are not linear in the feed down to zero",
                    edge.value * 1e-3,
                    edge.sd * 1e-3
                ));
            }
        }
        for (line, name) in self.lines.iter().zip(["feed", "normal", "axis"]) {
            if let Some(LackOfFit { ratio, critical, .. }) = line.and_then(|line| line.lack_of_fit)
                && ratio > critical
            {
                self.warnings.push(format!(
                    "the force along the {name} is no straight line over the feed: F {ratio:.2} above {critical:.2}; the \
                     coefficients hold for the range of feeds alone"
                ));
            }
        }
    }
}

/// 95 % quantile of Snedecor's F: with x of the beta distribution, `d2 x/(d1 (1 − x))`.
fn f_quantile(d1: usize, d2: usize) -> f64 {
    let (a, b) = (0.5 * d1 as f64, 0.5 * d2 as f64);
    let x = beta_quantile(a, b, 0.95);
    b * x / (a * (1.0 - x))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLOT: TestedCut = TestedCut { teeth: 2, depth: 2e-3, entry: 0.0, exit: PI };

    /// Mean forces of a slot in aluminium, 2 teeth, 2 mm deep, with noise.
    const AL7075: &str = "feed_per_tooth [mm],mean_force_x [N],mean_force_y [N],mean_force_z [N]
0.0500,-49.621,71.758,16.312\n0.0500,-46.565,77.909,17.207\n0.0500,-48.997,73.107,18.805
0.0800,-48.569,99.631,22.329\n0.0800,-55.051,102.949,25.920\n0.0800,-56.986,98.739,22.505
0.1100,-59.269,121.609,32.109\n0.1100,-56.312,122.671,32.419\n0.1100,-56.672,124.903,29.785
0.1400,-63.378,144.257,41.939\n0.1400,-65.959,146.760,42.278\n0.1400,-63.497,144.089,41.382
0.1700,-70.504,167.201,51.414\n0.1700,-70.549,173.514,52.644\n0.1700,-72.770,171.269,48.098\n";

    fn close(found: Option<Coefficient>, [value, sd]: [f64; 2]) {
        let found = found.unwrap();
        let apart = |found: f64, expected: f64| (found / expected - 1.0).abs();
        // The reference has four to six digits.
        assert!(apart(found.value, value) < 5e-6 && apart(found.sd, sd) < 8e-5, "{found:?} {value} {sd}");
    }

    #[test]
    fn a_slot_in_aluminium_has_the_coefficients_of_an_independent_fit() {
        let found = read_forces("slot.csv", AL7075).unwrap().identify(&SLOT).unwrap();
        close(found.chip[0], [791.341e6, 14.879e6]);
        close(found.chip[1], [188.342e6, 14.042e6]);
        close(found.chip[2], [222.101e6, 8.894e6]);
        close(found.edge[0], [27.9944e3, 1.3778e3]);
        close(found.edge[1], [30.0511e3, 1.3002e3]);
        close(found.edge[2], [0.951_54e3, 0.6675e3]);
        assert!(found.warnings.is_empty(), "{:?}", found.warnings);
        // t of 13 degrees of freedom, F of 3 and 10: tables of the distributions.
        assert!((found.quantile - 2.160_369).abs() < 1e-5);
        let lack = found.lines[0].unwrap().lack_of_fit.unwrap();
        assert!(lack.freedom == [3, 10] && (lack.critical - 3.708_265).abs() < 1e-5, "{lack:?}");
    }

    /// Mean forces by quadrature over the arc.
    fn means(cut: &TestedCut, feed: f64, [t, r, a]: [f64; 3], [te, re, ae]: [f64; 3]) -> [f64; 3] {
        const STEPS: u32 = 20_000;
        let mut sum = [0.0; 3];
        for i in 0..STEPS {
            let phi = cut.entry + (cut.exit - cut.entry) * (f64::from(i) + 0.5) / f64::from(STEPS);
            let (s, c) = phi.sin_cos();
            let (ft, fr, fa) = (t * feed * s + te, r * feed * s + re, a * feed * s + ae);
            sum = [sum[0] - (ft * c + fr * s), sum[1] - (fr * c - ft * s), sum[2] + fa];
        }
        let share = (cut.exit - cut.entry) / f64::from(STEPS) * f64::from(cut.teeth) * cut.depth / (2.0 * PI);
        sum.map(|sum| sum * share)
    }

    #[test]
    fn any_immersion_gives_back_the_coefficients_of_simulated_means() {
        let (chip, edge) = ([2100e6, 850e6, 300e6], [41e3, 55e3, 3e3]);
        for (entry, exit) in [(0.0, 1.1), (2.0, PI), (0.4, 2.9)] {
            let cut = TestedCut { teeth: 4, depth: 1.5e-3, entry, exit };
            let feeds = [0.04e-3, 0.07e-3, 0.1e-3, 0.13e-3];
            let mut forces: [Vec<f64>; 3] = Default::default();
            for feed in feeds {
                for (column, mean) in forces.iter_mut().zip(means(&cut, feed, chip, edge)) {
                    column.push(mean);
                }
            }
            let test = ForceTest { source: "means".to_owned(), feeds: feeds.to_vec(), forces: forces.map(Some) };
            let found = test.identify(&cut).unwrap();
            for (found, expected) in found.chip.iter().chain(&found.edge).zip(chip.iter().chain(&edge)) {
                assert!((found.unwrap().value / expected - 1.0).abs() < 1e-6, "{entry} {exit} {found:?} {expected}");
            }
        }
    }

    #[test]
    fn what_tells_nothing_or_the_opposite_is_refused() {
        let two = "feed_per_tooth [mm],mean_force_x [N],mean_force_y [N]\n0.05,-1,2\n0.1,-2,4\n0.1,-2,4\n";
        let refused = read_forces("two.csv", two).unwrap().identify(&SLOT);
        assert_eq!(refused, Err(ForceTestError::TooFewFeeds { file: "two.csv".to_owned(), feeds: 2 }));
        let test = read_forces("slot.csv", AL7075).unwrap();
        // Forces on the work instead of the tool.
        let refused = test.clone().turned([(0, -1.0), (1, -1.0), (2, -1.0)]).identify(&SLOT);
        assert!(matches!(refused, Err(ForceTestError::Sign { name: "tangential", .. })), "{refused:?}");
        // A dynamometer turned by a quarter, told.
        let mut turned = test.clone();
        turned.forces.swap(0, 1);
        assert_eq!(turned.turned([(1, 1.0), (0, 1.0), (2, 1.0)]).identify(&SLOT), test.identify(&SLOT));
        for (text, word) in [
            ("feed_per_tooth,mean_force_x [N],mean_force_y [N]\n", "feed_per_tooth"),
            ("feed_per_tooth [mm],mean_force_x [um],mean_force_y [N]\n", "mean_force_x"),
            ("feed_per_tooth [mm],mean_force_x [N]\n0.1,1\n", "mean_force_y"),
            ("feed_per_tooth [mm],mean_force_x [N],mean_force_y [N]\n0,1,2\n", "not positive"),
        ] {
            let message = read_forces("f.csv", text).unwrap_err().to_string();
            assert!(message.contains(word), "{message}");
        }
    }

    #[test]
    fn forces_that_are_no_line_are_told() {
        let curved: String = (1..=5)
            .flat_map(|i| [-0.1, 0.1].map(|noise| (f64::from(i) * 0.03, noise)))
            .map(|(feed, noise)| format!("{feed},{},{}\n", -600.0 * feed - noise, 900.0 * feed.sqrt() + noise))
            .collect();
        let text = format!("feed_per_tooth [mm],mean_force_x [N],mean_force_y [N]\n{curved}");
        let found = read_forces("curved.csv", &text).unwrap().identify(&SLOT).unwrap();
        assert!(found.warnings.len() == 1 && found.warnings[0].contains("normal"), "{:?}", found.warnings);
    }
}
