//! Forced vibration of a stable cut and the surface that it leaves, without a delay solve.

use super::cutter::Engagement;
use super::engagement::Geometry;
use super::{Direction, Milling};
use crate::error::{ChatterError, positive};
use nalgebra::{Complex, Vector2};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Periodic vibration of a stable cut.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Forced {
    /// Peak-to-peak displacement in feed and normal direction (m).
    pub peak_to_peak: [f64; 2],
    /// Displacement normal to the feed at the moment when the surface is left (m): positive into
    /// the work in up milling, its magnitude is the error of the surface location.
    pub surface_location_error: f64,
    /// Mean cutting force (feed, normal) (N).
    pub mean_force: [f64; 2],
    /// Greatest cutting force in feed and normal direction (N).
    pub greatest_force: [f64; 2],
    /// Greatest resultant of the cutting force in the plane (N).
    pub greatest_resultant: f64,
    /// Displacement (feed, normal) over one period (m), evenly spaced, from entry of tooth 0.
    pub displacement: Vec<[f64; 2]>,
}

/// Harmonics of the tooth-passing frequency that are summed.
const HARMONICS: usize = 200;

/// Origin and span of the angle (rad), and the coefficients of the force in it (N).
type ForceSeries = (f64, f64, Vec<Vector2<Complex<f64>>>);

/// Samples of the displacement over a period.
const SAMPLES: usize = 1000;

impl Milling {
    /// Forced vibration at `spindle_speed` (rad/s) and `depth` (m), by the Fourier coefficients of
    /// the static force times the frequency response. It is the motion of a stable cut: the same in
    /// every period, so regeneration drops out. Where the modes change along the path it is that of the place with the
    /// greatest error of the surface.
    ///
    /// # Errors
    /// A cut that is none; a speed or depth that is not positive; runout so great that the teeth's
    /// surfaces overlap, which needs the simulation.
    ///
    /// # Source
    /// `F = −w H(phi) (f_z, 0)` with the forces of runout and edge, coefficients `G(i r N Omega)`; surface location error after
    /// Schmitz and Smith (Machining Dynamics, 2009), at the angle where the tooth leaves the wall:
    /// 0 in up, pi in down milling, at the foot of the wall above a corner radius.
    pub fn forced(&self, spindle_speed: f64, depth: f64) -> Result<Forced, ChatterError> {
        if self.by_speed.is_some() {
            return self.at_spindle_speed(spindle_speed)?.forced(spindle_speed, depth);
        }
        if self.along_path.is_some() {
            let mut worst: Option<Forced> = None;
            for (_, cut) in self.places() {
                let forced = cut.forced(spindle_speed, depth)?;
                let size = |forced: &Forced| forced.surface_location_error.abs();
                if worst.as_ref().is_none_or(|worst| size(&forced) > size(worst)) {
                    worst = Some(forced);
                }
            }
            return worst.ok_or(ChatterError::NoModes);
        }
        self.check()?;
        positive("spindle_speed", spindle_speed)?;
        positive("depth", depth)?;
        let geometry = Geometry::new(self, depth, false)?;
        let base = geometry.span;
        let response: Vec<_> =
            (0..=HARMONICS).map(|r| self.frequency_response(r as f64 * spindle_speed / base)).collect();
        let coefficients = self.force_coefficients(&geometry, depth);
        let motion: Vec<Vector2<Complex<f64>>> =
            coefficients.iter().zip(&response).map(|(force, response)| response * force).collect();
        let at = |series: &[Vector2<Complex<f64>>], angle: f64| sum(series, (angle - geometry.origin) / base);
        let angles = (0..SAMPLES).map(|i| geometry.origin + base * i as f64 / SAMPLES as f64);
        let displacement: Vec<[f64; 2]> = angles.clone().map(|angle| at(&motion, angle)).collect();
        let range = |axis: usize| {
            let values = displacement.iter().map(|u| u[axis]);
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        };
        let greatest = |axis: usize| {
            angles.clone().map(|angle| self.static_force(&geometry, depth, angle)[axis].abs()).fold(0.0, f64::max)
        };
        Ok(Forced {
            peak_to_peak: [range(0), range(1)],
            surface_location_error: at(&motion, self.wall(depth))[1],
            mean_force: [coefficients[0][0].re, coefficients[0][1].re],
            greatest_force: [greatest(0), greatest(1)],
            greatest_resultant: angles
                .clone()
                .map(|angle| self.static_force(&geometry, depth, angle))
                .map(|[x, y]| x.hypot(y))
                .fold(0.0, f64::max),
            displacement,
        })
    }

    /// What the forced vibration leaves on the wall (m), positive where material is left: in up milling the tooth that moves
    /// into the work takes more, in down milling it moves away from the wall.
    pub fn material_left(&self, forced: &Forced) -> f64 {
        let error = forced.surface_location_error;
        if self.direction() == Direction::Up { -error } else { error }
    }

    /// What the forced vibration of a stable cut leaves on the wall (m), as [`Milling::material_left`], at every speed
    /// (rad/s) and depth (m): all depths of the first speed first. A cut of no depth leaves nothing.
    ///
    /// # Errors
    /// As [`Milling::forced`].
    pub fn surface_errors(&self, speeds: &[f64], depths: &[f64]) -> Result<Vec<f64>, ChatterError> {
        self.check()?;
        let series = |depth: &f64| {
            if *depth == 0.0 {
                return Ok(None);
            }
            let geometry = Geometry::new(self, positive("depth", *depth)?, false)?;
            let coefficients = self.force_coefficients(&geometry, *depth);
            Ok(Some((geometry.origin, geometry.span, coefficients)))
        };
        let series: Vec<Option<ForceSeries>> = depths.par_iter().map(series).collect::<Result<_, ChatterError>>()?;
        let sign = if self.direction() == Direction::Up { -1.0 } else { 1.0 };
        // Straight teeth repeat after the same angle at every depth, helical ones too.
        let span = if self.cutter.is_regular() { TAU / self.cutter.teeth as f64 } else { TAU };
        let column = |speed: &f64| {
            positive("spindle_speed", *speed)?;
            let mut worst = vec![0.0f64; depths.len()];
            for (_, cut) in self.at_spindle_speed(*speed)?.places() {
                let responses: Vec<_> =
                    (0..=HARMONICS).map(|r| cut.frequency_response(r as f64 * speed / span)).collect();
                for ((worst, series), depth) in worst.iter_mut().zip(&series).zip(depths) {
                    let Some((origin, base, forces)) = series else { continue };
                    let motion: Vec<_> = forces.iter().zip(&responses).map(|(force, g)| g * force).collect();
                    let left = sign * sum(&motion, (self.wall(*depth) - origin) / base)[1];
                    if left.abs() > worst.abs() {
                        *worst = left;
                    }
                }
            }
            Ok(worst)
        };
        let columns: Vec<Vec<f64>> = speeds.par_iter().map(column).collect::<Result<_, ChatterError>>()?;
        Ok(columns.into_iter().flatten().collect())
    }

    /// Greatest resultant of the static cutting force in the plane (N) at `depth` (m), at any speed: the peak that a stable
    /// cut asks of tool and spindle.
    ///
    /// # Errors
    /// A cut that is none; a depth that is not positive.
    pub fn greatest_static_force(&self, depth: f64) -> Result<f64, ChatterError> {
        self.check()?;
        let geometry = Geometry::new(self, positive("depth", depth)?, false)?;
        let at = |i: usize| {
            let [x, y] =
                self.static_force(&geometry, depth, geometry.origin + geometry.span * i as f64 / SAMPLES as f64);
            x.hypot(y)
        };
        Ok((0..SAMPLES).map(at).fold(0.0, f64::max))
    }

    /// Angle of tooth 0 at its tip at which it leaves the foot of the wall, where it moves along the feed.
    pub(super) fn wall(&self, depth: f64) -> f64 {
        let leaving = if self.direction() == Direction::Up { 0.0 } else { PI };
        leaving + self.cutter.lag_angle(self.foot_of_wall(depth))
    }

    /// Up milling if the engagement starts at the wall, else down.
    pub(super) fn direction(&self) -> Direction {
        let Engagement { entry, exit } = self.engagement;
        if (PI - exit).abs() < entry.abs() { Direction::Down } else { Direction::Up }
    }

    /// Force of the static chip at an angle of tooth 0 (N).
    pub(super) fn static_force(&self, geometry: &Geometry, depth: f64, angle: f64) -> [f64; 2] {
        let feed = self.feed_per_tooth * self.cutter.teeth as f64 / TAU;
        let mut force = [0.0; 2];
        for tooth in geometry.cutting(angle - 1e-12, angle + 1e-12) {
            let arc = &geometry.teeth[tooth.0].1[tooth.1];
            let h = geometry.directional(self, tooth, angle);
            // What does not grow with the feed: runout and the edge.
            let tangential = self.force.tangential * arc.step + self.force.edge_tangential;
            let radial = self.force.radial * arc.step + self.force.edge_radial;
            let rest = geometry.against([tangential, radial], tooth, angle);
            force[0] -= depth * (h[0] * feed * arc.delay + rest[0]);
            force[1] -= depth * (h[2] * feed * arc.delay + rest[1]);
        }
        force
    }

    /// Complex Fourier coefficients of the static force, harmonics 0 … [`HARMONICS`].
    fn force_coefficients(&self, geometry: &Geometry, depth: f64) -> Vec<Vector2<Complex<f64>>> {
        let rule = toolroom_spectral::Rule::of(48);
        let mut coefficients = vec![Vector2::zeros(); HARMONICS + 1];
        for pair in geometry.breaks.windows(2) {
            // The highest harmonic turns far within a stretch: panels keep the quadrature exact.
            let panels = ((pair[1] - pair[0]) / geometry.span * HARMONICS as f64 / 8.0).ceil().max(1.0) as usize;
            let length = (pair[1] - pair[0]) / panels as f64;
            for panel in 0..panels {
                let from = pair[0] + length * panel as f64;
                for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
                    let angle = from + node * length;
                    let [x, y] = self.static_force(geometry, depth, angle);
                    let share = weight * length / geometry.span;
                    let turn = Complex::from_polar(1.0, -TAU * (angle - geometry.origin) / geometry.span);
                    let mut factor = Complex::new(share, 0.0);
                    for coefficient in &mut coefficients {
                        *coefficient += Vector2::new(factor * x, factor * y);
                        factor *= turn;
                    }
                }
            }
        }
        coefficients
    }
}

/// A real Fourier series after the share `turned` of its period.
fn sum(series: &[Vector2<Complex<f64>>], turned: f64) -> [f64; 2] {
    let turn = Complex::from_polar(1.0, TAU * turned);
    let mut factor = Complex::new(1.0, 0.0);
    let mut sum = [-series[0][0].re, -series[0][1].re];
    for c in series {
        // Negative harmonics are the conjugates.
        sum = [sum[0] + 2.0 * (c[0] * factor).re, sum[1] + 2.0 * (c[1] * factor).re];
        factor *= turn;
    }
    sum
}
