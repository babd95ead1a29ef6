//! Forced vibration of a stable cut and the surface that it leaves, without a delay solve.

use super::cutter::Engagement;
use super::engagement::Geometry;
use super::regenerated::{HARMONICS, Regeneration, Settled};
use super::{Direction, Milling};
use crate::error::{ChatterError, positive};
use nalgebra::{Complex, Matrix2, Vector2};
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

/// The static force of a cut over a repetition, and what it changes by for each motion.
struct Forces {
    geometry: Geometry,
    coefficients: Vec<Vector2<Complex<f64>>>,
    regeneration: Option<Regeneration>,
}

/// Samples of the displacement over a period.
const SAMPLES: usize = 1000;

impl Milling {
    /// Forced vibration at `spindle_speed` (rad/s) and `depth` (m), by the Fourier coefficients of
    /// the static force times the frequency response. It is the motion of a stable cut: the same in
    /// every period, so regeneration drops out where all teeth are alike. With runout or unequal pitch it is the same in every
    /// revolution, and a tooth finds what an earlier one left that moved otherwise: then the harmonics are solved for together, with
    /// every tooth cutting the surface that it would find without vibration. Where the modes change along the path it is that of the place with the
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
        let forces = self.forces(depth)?;
        let geometry = &forces.geometry;
        let base = geometry.span;
        let response: Vec<_> =
            (0..=HARMONICS).map(|r| self.frequency_response(r as f64 * spindle_speed / base)).collect();
        let Settled { motion, force } = self.periodic(&forces, spindle_speed, &response)?;
        let at = |series: &[Vector2<Complex<f64>>], angle: f64| sum(series, (angle - geometry.origin) / base);
        let angles: Vec<f64> = (0..SAMPLES).map(|i| geometry.origin + base * i as f64 / SAMPLES as f64).collect();
        let displacement: Vec<[f64; 2]> = angles.iter().map(|angle| at(&motion, *angle)).collect();
        let range = |axis: usize| {
            let values = displacement.iter().map(|u| u[axis]);
            values.clone().fold(f64::MIN, f64::max) - values.fold(f64::MAX, f64::min)
        };
        let regenerates = forces.regeneration.is_some();
        let cutting: Vec<[f64; 2]> = (angles.iter().zip(&displacement))
            .map(|(angle, u)| {
                let [x, y] = self.static_force(geometry, depth, *angle);
                if !regenerates {
                    return [x, y];
                }
                let change = self.regenerated_force(geometry, depth, *angle, *u, |earlier| at(&motion, earlier));
                [x + change[0], y + change[1]]
            })
            .collect();
        let greatest = |axis: usize| cutting.iter().map(|force| force[axis].abs()).fold(0.0, f64::max);
        Ok(Forced {
            peak_to_peak: [range(0), range(1)],
            surface_location_error: at(&motion, self.wall(depth))[1],
            mean_force: [force[0][0].re, force[0][1].re],
            greatest_force: [greatest(0), greatest(1)],
            greatest_resultant: cutting.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max),
            displacement,
        })
    }

    fn forces(&self, depth: f64) -> Result<Forces, ChatterError> {
        let geometry = Geometry::new(self, depth, false)?;
        let coefficients = self.force_coefficients(&geometry, depth);
        let regeneration = Regeneration::of(self, &geometry, depth);
        Ok(Forces { geometry, coefficients, regeneration })
    }

    /// Motion and force of the stable cut under `forces` with the structure's `responses` (m/N) to their harmonics.
    fn periodic(
        &self,
        forces: &Forces,
        spindle_speed: f64,
        responses: &[Matrix2<Complex<f64>>],
    ) -> Result<Settled, ChatterError> {
        if let Some(regeneration) = &forces.regeneration {
            return regeneration.settle(self, spindle_speed, &forces.coefficients, responses);
        }
        let motion = forces.coefficients.iter().zip(responses).map(|(force, response)| response * force).collect();
        Ok(Settled { motion, force: forces.coefficients.clone() })
    }

    /// What the force (N) at an angle of tooth 0 changes by for the displacement `u` (m) there and those of `earlier` angles.
    fn regenerated_force(
        &self,
        geometry: &Geometry,
        depth: f64,
        angle: f64,
        u: [f64; 2],
        earlier: impl Fn(f64) -> [f64; 2],
    ) -> [f64; 2] {
        let mut force = [0.0; 2];
        for tooth in geometry.cutting(angle - 1e-12, angle + 1e-12) {
            let h = geometry.directional(self, tooth, angle);
            let before = earlier(angle - geometry.teeth[tooth.0].1[tooth.1].delay);
            let (x, y) = (u[0] - before[0], u[1] - before[1]);
            force[0] -= depth * (h[0] * x + h[1] * y);
            force[1] -= depth * (h[2] * x + h[3] * y);
        }
        force
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
            self.forces(positive("depth", *depth)?).map(Some)
        };
        let series: Vec<Option<Forces>> = depths.par_iter().map(series).collect::<Result<_, ChatterError>>()?;
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
                    let Some(forces) = series else { continue };
                    let motion = cut.periodic(forces, *speed, &responses)?.motion;
                    let Geometry { origin, span, .. } = &forces.geometry;
                    let left = sign * sum(&motion, (self.wall(*depth) - origin) / span)[1];
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
        let mut coefficients = vec![Vector2::zeros(); HARMONICS + 1];
        geometry.over_panels(HARMONICS, |angle, share| {
            let [x, y] = self.static_force(geometry, depth, angle);
            let turn = Complex::from_polar(1.0, -TAU * (angle - geometry.origin) / geometry.span);
            let mut factor = Complex::new(share, 0.0);
            for coefficient in &mut coefficients {
                *coefficient += Vector2::new(factor * x, factor * y);
                factor *= turn;
            }
        });
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
