//! Cutters whose edge bends round a corner or leans with a taper: axial slices, each straight with its own radius.

use super::Milling;
use super::engagement::Geometry;
use super::slice::Slice;
use crate::error::{ChatterError, positive};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use toolroom_spectral::Rule;

/// Slices of the corner, in equal steps of the axial angle, and of the straight part above it where a helix makes it lag.
/// Limits of ball ends change by less than 1e-3 with twice as many (a test).
pub(crate) const SLICES: usize = 16;

/// The slices of `cut` at `depth` (m), from the tip up; none of a cylinder.
pub(crate) fn slices(cut: &Milling, depth: f64, count: usize) -> Vec<Slice> {
    let corner = cut.cutter.corner_radius;
    if cut.cutter.is_cylinder() || depth <= 0.0 {
        return Vec::new();
    }
    let full = 0.5 * cut.cutter.diameter;
    if cut.cutter.taper_angle > 0.0 {
        return cone(full, cut.cutter.taper_angle, depth, count);
    }
    let height = depth.min(corner);
    let last = (1.0 - height / corner).clamp(-1.0, 1.0).acos();
    let mut found = Vec::with_capacity(2 * count);
    for i in 0..count {
        let (from, to) = (last * i as f64 / count as f64, last * (i + 1) as f64 / count as f64);
        let (middle, rise) = (0.5 * (from + to), from.cos() - to.cos());
        found.push(Slice {
            share: corner * rise / depth,
            radius: full - corner + corner * middle.sin(),
            height: corner * (1.0 - middle.cos()),
            sine: 0.5 * ((to - to.sin() * to.cos()) - (from - from.sin() * from.cos())) / rise,
            cosine: 0.5 * (to.sin().powi(2) - from.sin().powi(2)) / rise,
            edge: (to - from) / rise,
        });
    }
    let straight = depth - height;
    if straight > 0.0 {
        let parts = if cut.cutter.helix_angle == 0.0 { 1 } else { count };
        for i in 0..parts {
            found.push(Slice {
                share: straight / depth / parts as f64,
                radius: full,
                height: height + straight * (i as f64 + 0.5) / parts as f64,
                sine: FRAC_PI_2.sin(),
                cosine: 0.0,
                edge: 1.0,
            });
        }
    }
    found
}

/// Even slices of a cone that is `tip` (m) in radius at its tip and has the angle `taper` (rad) between axis and edge.
fn cone(tip: f64, taper: f64, depth: f64, count: usize) -> Vec<Slice> {
    let (share, (cosine, sine)) = (1.0 / count as f64, taper.sin_cos());
    let slice = |i: usize| {
        let height = depth * share * (i as f64 + 0.5);
        Slice { share, radius: tip + height * cosine / sine, height, sine, cosine, edge: 1.0 / sine }
    };
    (0..count).map(slice).collect()
}

impl Geometry {
    /// The cut of a cutter with a corner radius or a taper at `depth` (m): each slice of each tooth is a straight tooth that lags. A
    /// depth at which the corner does not reach the work is free flight.
    pub fn sliced(cut: &Milling, depth: f64, whole_revolution: bool) -> Self {
        Self::of_slices(cut, &slices(cut, depth, SLICES), whole_revolution)
    }

    fn of_slices(cut: &Milling, slices: &[Slice], whole_revolution: bool) -> Self {
        let cutter = &cut.cutter;
        let pitch = TAU / cutter.teeth as f64;
        let span = if whole_revolution { TAU } else { pitch };
        let (entry, exit) = (cut.engagement.entry, cut.engagement.exit);
        let mut geometry =
            Self { origin: entry, span, teeth: Vec::new(), slices: Vec::new(), lag: 0.0, breaks: Vec::new() };
        for offset in cutter.offsets() {
            for slice in slices {
                let (from, to) = slice.engagement(0.5 * cutter.diameter, entry, exit);
                let arcs = if to > from {
                    vec![super::engagement::Arc { from, to, delay: pitch, step: 0.0 }]
                } else {
                    Vec::new()
                };
                geometry.teeth.push((offset - cutter.lag_angle(slice.height), arcs));
                geometry.slices.push(*slice);
            }
        }
        geometry.breaks = geometry.find_breaks(false);
        geometry
    }
}

impl Milling {
    /// Mean force on the cutter (feed, normal) over a revolution at `depth` (m) without vibration (N), of cylinders and of
    /// cutters with a corner radius or a taper.
    ///
    /// # Errors
    /// A cut that is none; a depth that is not positive.
    ///
    /// # Source
    /// Cylinder: Altintas, Manufacturing Automation (2012), average-force method; corner: the transformation of Engin and
    /// Altintas (2001), generalised cutters.
    pub fn mean_force(&self, depth: f64) -> Result<[f64; 2], ChatterError> {
        self.check()?;
        positive("depth", depth)?;
        let geometry = Geometry::new(self, depth, false)?;
        let rule = Rule::of(24);
        let mut mean = [0.0; 2];
        for pair in geometry.breaks.windows(2) {
            let length = pair[1] - pair[0];
            for (node, weight) in rule.nodes.iter().zip(&rule.weights) {
                let force = self.static_force(&geometry, depth, pair[0] + node * length);
                (0..2).for_each(|i| mean[i] += force[i] * weight * length / geometry.span);
            }
        }
        Ok(mean)
    }

    /// Height above the tip (m) at which the wall begins that is left at `depth` (m): above the corner, or the uppermost
    /// point of a cut that is not as deep.
    pub(super) fn foot_of_wall(&self, depth: f64) -> f64 {
        self.cutter.corner_radius.min(depth)
    }

    /// Refuses a cutter with a corner radius or a taper where a calculation knows cylinders alone.
    pub(crate) fn only_cylinder(&self) -> Result<(), ChatterError> {
        let within = crate::error::within;
        within("corner_radius where only cylinders are calculated", self.cutter.corner_radius, 0.0, 0.0)?;
        within("taper_angle where only cylinders are calculated", self.cutter.taper_angle, 0.0, 0.0).map(drop)
    }

    /// What a cutter with a corner radius or a taper can have beside it.
    pub(super) fn check_corner(&self) -> Result<(), ChatterError> {
        if self.cutter.is_cylinder() {
            return Ok(());
        }
        let within = crate::error::within;
        within("corner_radius", self.cutter.corner_radius, 0.0, 0.5 * self.cutter.diameter)?;
        within("entry with a corner radius or a taper", self.engagement.entry, 0.0, PI)?;
        within("exit with a corner radius or a taper", self.engagement.exit, 0.0, PI)?;
        let irregular = f64::from(u8::from(!self.cutter.is_regular()));
        within("unequal pitch or runout with a corner radius or a taper", irregular, 0.0, 0.0).map(drop)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cutter, Direction, Engagement, MillingForce, Mode};

    fn cut(corner_radius: f64, helix: f64, immersion: f64) -> Milling {
        Milling {
            modes: vec![
                Mode { direction: [1.0, 0.0], natural_frequency: 900.0, damping_ratio: 0.02, stiffness: 6e6 },
                Mode { direction: [0.0, 1.0], natural_frequency: 1050.0, damping_ratio: 0.025, stiffness: 8e6 },
            ],
            cutter: Cutter { corner_radius, helix_angle: helix, ..Cutter::straight(2, 0.01) },
            engagement: Engagement::new(immersion, Direction::Down).unwrap(),
            force: MillingForce {
                axial: 2.2e8,
                edge_tangential: 2e4,
                edge_radial: 3e4,
                ..MillingForce::new(8e8, 1.7e8)
            },
            feed_per_tooth: 1e-4,
            by_speed: None,
            along_path: None,
        }
    }

    /// A slot: sums over the slices are exact, so that the closed form holds at any number of them. With N teeth of a ball
    /// of radius R at depth R, of straight flutes: `F_y = N/4 K_t f R + N/pi K_te (pi/2) R`,
    /// `F_x = −N/4 f R (K_r pi/4 + K_a/2) − N/pi K_re R`.
    #[test]
    fn mean_forces_of_a_ball_end_in_a_slot_are_its_closed_form() {
        let cut = cut(5e-3, 0.0, 1.0);
        let (n, f, r) = (2.0, 1e-4, 5e-3);
        let [x, y] = cut.mean_force(r).unwrap();
        let expected_x = -(n / 4.0) * f * r * (1.7e8 * PI / 4.0 + 2.2e8 / 2.0) - n / PI * 3e4 * r;
        let expected_y = n / 4.0 * 8e8 * f * r + n / PI * 2e4 * FRAC_PI_2 * r;
        assert!(
            (x / expected_x - 1.0).abs() < 1e-9 && (y / expected_y - 1.0).abs() < 1e-9,
            "{x} {expected_x} {y} {expected_y}"
        );
        // A cylinder: the average-force method.
        let straight = Milling { cutter: Cutter::straight(2, 0.01), ..cut };
        let [x, y] = straight.mean_force(2e-3).unwrap();
        let expected_x = -(n / 4.0) * f * 2e-3 * 1.7e8 - n / PI * 3e4 * 2e-3;
        let expected_y = n / 4.0 * 8e8 * f * 2e-3 + n / PI * 2e4 * 2e-3;
        assert!((x / expected_x - 1.0).abs() < 1e-9 && (y / expected_y - 1.0).abs() < 1e-9);
    }

    #[test]
    fn a_vanishing_corner_is_a_cylinder() {
        let speed = 9000.0 / 60.0 * TAU;
        for (helix, immersion) in [(0.0, 0.4), (0.6, 0.4), (0.0, 1.0)] {
            let limit = |corner: f64| cut(corner, helix, immersion).at_speed(speed).unwrap().limit(5e-3).unwrap().depth;
            let (straight, rounded) = (limit(0.0), limit(1e-8));
            assert!((rounded / straight - 1.0).abs() < 2e-3, "{helix} {immersion}: {straight} {rounded}");
        }
    }

    /// A slot with straight flutes and one mode along the feed: the cut of all slices is one matrix with the coefficients
    /// averaged over the depth, so that the limit is that of a cylinder with these coefficients.
    #[test]
    fn the_limit_of_a_ball_end_in_a_slot_is_that_of_its_mean_coefficients() {
        let ball = cut(5e-3, 0.0, 1.0);
        for rpm in [6000.0, 9500.0, 14000.0] {
            let speed = rpm / 60.0 * TAU;
            let limit = ball.at_speed(speed).unwrap().limit(5e-3).unwrap();
            let kappa = (1.0 - limit.depth / 5e-3).acos();
            let rise = 1.0 - kappa.cos();
            let radial = (1.7e8 * 0.5 * (kappa - kappa.sin() * kappa.cos()) + 2.2e8 * 0.5 * kappa.sin().powi(2)) / rise;
            let force = MillingForce { radial, axial: 0.0, ..ball.force };
            let straight = Milling { cutter: Cutter::straight(2, 0.01), force, ..ball.clone() };
            let verdict = straight.verdict(speed, limit.depth).unwrap();
            assert!((verdict.spectral_radius - 1.0).abs() < 1e-6, "{rpm}: {verdict:?}");
        }
    }

    /// What the slices sum, integrated point by point along the edge: angle by angle and, at each, over the axial angle of the
    /// edge of every tooth, whose point stands in the work where the stock is: between the wall that the full diameter makes
    /// and the free side. Forces on a piece `dS` of the edge are those of Engin and Altintas (2001):
    /// `dF_x = −dF_r sin phi sin kappa − dF_t cos phi − dF_a sin phi cos kappa` and so on, with `h = f sin phi sin kappa`.
    fn integrated(cut: &Milling, depth: f64, turned: f64) -> ([f64; 2], f64) {
        let (corner, full) = (cut.cutter.corner_radius, 0.5 * cut.cutter.diameter);
        let (entry, exit) = (cut.engagement.entry, cut.engagement.exit);
        let pieces = 4000;
        let last = (1.0 - depth.min(corner) / corner).acos();
        let (mut force, mut torque) = ([0.0; 2], 0.0);
        let mut add = |kappa: f64, length: f64, radius: f64, height: f64| {
            for j in 0..cut.cutter.teeth {
                let pitch = TAU / cut.cutter.teeth as f64;
                let phi =
                    (turned - pitch * j as f64 - 2.0 * cut.cutter.helix_angle.tan() * height / cut.cutter.diameter)
                        .rem_euclid(TAU);
                // Across the feed the point stands at −r cos(phi); the stock from −R cos(entry) to −R cos(exit).
                let across = -radius * phi.cos();
                if phi > PI || across < -full * entry.cos() || across > -full * exit.cos() {
                    continue;
                }
                let chip = cut.feed_per_tooth * phi.sin() * kappa.sin();
                let t = (cut.force.tangential * chip + cut.force.edge_tangential) * length;
                // The edge force along the axis of the edge is none here.
                let r = (cut.force.radial * chip + cut.force.edge_radial) * length;
                let a = cut.force.axial * chip * length;
                let (s, c) = phi.sin_cos();
                force[0] += -r * s * kappa.sin() - t * c - a * s * kappa.cos();
                force[1] += -r * c * kappa.sin() + t * s - a * c * kappa.cos();
                torque += t * radius;
            }
        };
        for i in 0..pieces {
            let kappa = last * (f64::from(i) + 0.5) / f64::from(pieces);
            let radius = full - corner + corner * kappa.sin();
            add(kappa, corner * last / f64::from(pieces), radius, corner * (1.0 - kappa.cos()));
        }
        let straight = (depth - corner).max(0.0);
        for i in 0..pieces {
            let height = corner + straight * (f64::from(i) + 0.5) / f64::from(pieces);
            add(FRAC_PI_2, straight / f64::from(pieces), full, height);
        }
        (force, torque)
    }

    #[test]
    fn forces_and_torque_are_those_of_an_integral_along_the_edge() {
        for (corner, helix, immersion, depth) in
            [(5e-3, 0.5, 0.6, 3e-3), (5e-3, 0.0, 0.3, 4.5e-3), (2e-3, 0.6, 1.0, 5e-3), (5e-3, 0.4, 0.8, 5e-3)]
        {
            let cut = cut(corner, helix, immersion);
            let load = cut.load(800.0, depth).unwrap();
            let forced = cut.forced(800.0, depth).unwrap();
            let turns = 720;
            let (mut mean, mut torque, mut greatest) = ([0.0; 2], 0.0, 0.0f64);
            for i in 0..turns {
                let (force, moment) = integrated(&cut, depth, TAU * (f64::from(i) + 0.5) / f64::from(turns));
                (0..2).for_each(|axis| mean[axis] += force[axis] / f64::from(turns));
                torque += moment / f64::from(turns);
                greatest = greatest.max(force[0].hypot(force[1]));
            }
            let size = mean[0].hypot(mean[1]);
            let label = format!("{corner} {helix} {immersion} {depth}");
            for axis in 0..2 {
                let off = (forced.mean_force[axis] - mean[axis]).abs() / size;
                assert!(off < 5e-3, "{label}: {:?} {mean:?}", forced.mean_force);
                assert!((cut.mean_force(depth).unwrap()[axis] - mean[axis]).abs() < 5e-3 * size, "{label}");
            }
            assert!((load.torque / torque - 1.0).abs() < 5e-3, "{label}: {} {torque}", load.torque);
            // A slice comes in as a whole: a straight flute peaks too high by up to half a slice.
            let excess = load.greatest_force / greatest - 1.0;
            assert!(excess.abs() < if helix == 0.0 { 0.05 } else { 0.02 }, "{label}: {excess}");
            // Without edge forces the power is K_t times the volume removed.
            let keen = MillingForce { edge_tangential: 0.0, edge_radial: 0.0, ..cut.force };
            let load = Milling { force: keen, ..cut.clone() }.load(800.0, depth).unwrap();
            assert!((load.power / (8e8 * load.removal_rate) - 1.0).abs() < 1e-12);
        }
        // A ball end as deep as its radius in a slot removes half a disc.
        let ball = cut(5e-3, 0.3, 1.0).load(100.0, 5e-3).unwrap();
        let half_disc = 0.5 * PI * 25e-6;
        assert!((ball.removal_rate / (half_disc * 1e-4 * 2.0 * 100.0 / TAU) - 1.0).abs() < 5e-3, "{ball:?}");
    }

    /// The simulation knows nothing of collocation and Fourier series: stable cuts swing as forced, and just below and above
    /// the limit a disturbance dies and grows.
    #[test]
    fn simulated_ball_ends_swing_as_forced_and_lose_stability_at_the_limit() {
        for (corner, helix, immersion, rpm) in
            [(5e-3, 0.5, 0.6, 8000.0), (5e-3, 0.0, 1.0, 11000.0), (1.5e-3, 0.6, 0.2, 9000.0)]
        {
            let cut = cut(corner, helix, immersion);
            let speed = rpm / 60.0 * TAU;
            let limit = cut.at_speed(speed).unwrap().limit(8e-3).unwrap().depth;
            let settings = crate::SimulationSettings { steps: 600, periods: 500, observed: 60, kick: 0.3 };
            let still = cut.simulate(speed, 0.6 * limit, &settings).unwrap();
            let forced = cut.forced(speed, 0.6 * limit).unwrap();
            let greatest = forced.peak_to_peak[0].max(forced.peak_to_peak[1]);
            for axis in 0..2 {
                let off = (still.peak_to_peak(axis) - forced.peak_to_peak[axis]).abs() / greatest;
                assert!(off < 0.04, "{corner} {rpm} {axis}: {} {:?}", still.peak_to_peak(axis), forced.peak_to_peak);
            }
            let beyond = cut.simulate(speed, 1.25 * limit, &settings).unwrap();
            let grown = beyond.peak_to_peak(0).max(beyond.peak_to_peak(1));
            let there = cut.forced(speed, 1.25 * limit).unwrap().peak_to_peak;
            assert!(grown > 1.5 * there[0].max(there[1]), "{corner} {rpm}: {grown} {there:?}");
        }
    }

    #[test]
    fn slices_are_many_enough() {
        let speed = 8000.0 / 60.0 * TAU;
        for (corner, helix, immersion) in [(5e-3, 0.5, 0.3), (1.5e-3, 0.5, 0.15), (5e-3, 0.0, 0.6)] {
            let cut = cut(corner, helix, immersion);
            let radius = |count: usize, depth: f64| {
                let geometry = Geometry::of_slices(&cut, &slices(&cut, depth, count), false);
                let mut at_speed = cut.at_speed(speed).unwrap();
                at_speed.radius_in(&geometry, depth).unwrap()
            };
            for depth in [0.8e-3, 1.6e-3, 3e-3] {
                let (few, many) = (radius(SLICES, depth), radius(4 * SLICES, depth));
                assert!((few / many - 1.0).abs() < 2e-3, "{corner} {helix} {immersion} {depth}: {few} {many}");
            }
        }
    }

    #[test]
    fn a_depth_that_does_not_reach_the_work_is_stable_and_what_is_not_calculated_is_refused() {
        // The wall stands at 0.8 of the radius: the ball reaches it at 0.4 R.
        let speed = 8000.0 / 60.0 * TAU;
        let shallow = cut(5e-3, 0.0, 0.1);
        let verdict = shallow.verdict(speed, 1.9e-3).unwrap();
        assert!(
            verdict.stable
                && (verdict.spectral_radius - shallow.verdict(speed, 0.0).unwrap().spectral_radius).abs() < 1e-9
        );
        assert!(
            shallow.mean_force(1.9e-3).unwrap()[1].abs() < 1e-9 && shallow.mean_force(2.6e-3).unwrap()[1].abs() > 0.1
        );
        assert!(shallow.zeroth_order_limit(speed).is_err());
        let load = shallow.load(speed, 1.9e-3).unwrap();
        assert_eq!((load.removal_rate, load.torque, load.greatest_force), (0.0, 0.0, 0.0));
        let runout = Milling { cutter: Cutter { runout: 1e-5, ..shallow.cutter.clone() }, ..shallow.clone() };
        let large = Milling { cutter: Cutter { corner_radius: 6e-3, ..shallow.cutter.clone() }, ..shallow };
        assert!(runout.at_speed(speed).is_err() && large.at_speed(speed).is_err());
    }
}
