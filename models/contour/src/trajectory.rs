//! The path that the drives make of a plan, in time.

use crate::{Plan, Planner, Point, Section, VelocityLoop};
use std::f64::consts::FRAC_PI_2;

/// What the drives made of one section.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// Greatest distance to the left of the commanded path, m.
    pub left: f64,
    /// Greatest distance to the right of the commanded path, m.
    pub right: f64,
}

impl Deviation {
    /// Greatest distance to either side, m.
    pub fn greatest(&self) -> f64 {
        self.left.max(self.right)
    }
}

/// One feed axis: position loop around a velocity loop.
#[derive(Clone, Copy, Debug)]
struct Axis {
    position: f64,
    speed: f64,
    acceleration: f64,
}

impl Axis {
    /// Steady following error at a constant speed.
    fn running(reference: f64, speed: f64, gain: f64) -> Self {
        Self { position: reference - speed / gain, speed, acceleration: 0.0 }
    }

    /// One step in which the reference moves evenly from `from` to `to`.
    fn step(&mut self, from: f64, to: f64, dt: f64, gain: f64, velocity_loop: Option<VelocityLoop>) {
        let speed = (to - from) / dt;
        match velocity_loop {
            // Exact for an evenly moving reference.
            None => {
                let steady = from - speed / gain;
                self.position = steady + speed * dt + (self.position - steady) * (-gain * dt).exp();
            }
            Some(VelocityLoop { frequency, damping }) => {
                let slope = |t: f64, [x, v, a]: [f64; 3]| {
                    let wanted = gain * (from + speed * t - x);
                    [v, a, frequency * frequency * (wanted - v) - 2.0 * damping * frequency * a]
                };
                let add = |y: [f64; 3], k: [f64; 3], h: f64| [y[0] + h * k[0], y[1] + h * k[1], y[2] + h * k[2]];
                let y = [self.position, self.speed, self.acceleration];
                let k1 = slope(0.0, y);
                let k2 = slope(0.5 * dt, add(y, k1, 0.5 * dt));
                let k3 = slope(0.5 * dt, add(y, k2, 0.5 * dt));
                let k4 = slope(dt, add(y, k3, dt));
                let end = |i: usize| y[i] + dt / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
                *self = Self { position: end(0), speed: end(1), acceleration: end(2) };
            }
        }
    }
}

impl Planner<'_> {
    /// Simulates both feed axes along the cutter-centre path with the plan's feeds and returns
    /// the deviation on every section. The reference runs section after section at the planned
    /// feeds, from steady motion at the start; at corners it turns at once, as if the policy
    /// were none.
    ///
    /// `None` as velocity loop is the ideal one, stepped exactly; a second-order loop is
    /// integrated by the classical Runge–Kutta method. Each section takes a whole number of steps
    /// of at most `step` seconds.
    pub fn follow(&self, plan: &Plan, velocity_loop: Option<VelocityLoop>, step: f64) -> Vec<Deviation> {
        let gain = self.parameters.machine.position_gain;
        let radius = self.parameters.cutter.radius();
        let side = self.contour.side;
        let path: Vec<(Section, f64)> = (self.contour.sections.iter().zip(&plan.sections))
            .map(|(section, planned)| (offset(section, side.sign() * radius), planned.evaluation.feed))
            .collect();
        let mut deviations = vec![Deviation::default(); path.len()];
        let Some((first, feed)) = path.first() else { return deviations };
        let (sin, cos) = first.heading.sin_cos();
        let mut x = Axis::running(first.start.x, feed * cos, gain);
        let mut y = Axis::running(first.start.y, feed * sin, gain);
        // The axes lag behind: the section beside them comes later than that of the reference.
        let mut beside = 0;
        for (i, (section, feed)) in path.iter().enumerate() {
            let steps = (section.length / (feed * step)).ceil().max(1.0);
            let dt = section.length / feed / steps;
            let mut start = section.start;
            for n in 1..=steps as u64 {
                let to = section.at(section.length * n as f64 / steps);
                x.step(start.x, to.x, dt, gain, velocity_loop);
                y.step(start.y, to.y, dt, gain, velocity_loop);
                start = to;
                let point = Point { x: x.position, y: y.position };
                while beside < i && position(&path[beside].0, point).0 >= path[beside].0.length {
                    beside += 1;
                }
                let (along, left) = position(&path[beside].0, point);
                if along >= 0.0 {
                    let deviation = &mut deviations[beside];
                    deviation.left = deviation.left.max(left);
                    deviation.right = deviation.right.max(-left);
                }
            }
        }
        deviations
    }
}

/// The section moved by `gap` to the left.
fn offset(section: &Section, gap: f64) -> Section {
    let ratio = 1.0 - gap * section.curvature;
    Section {
        start: section.start.ahead(section.heading + FRAC_PI_2, gap),
        length: section.length * ratio,
        curvature: section.curvature / ratio,
        ..*section
    }
}

/// Way along a section's line or circle, and distance to its left, of a point.
fn position(section: &Section, point: Point) -> (f64, f64) {
    let (dx, dy) = (point.x - section.start.x, point.y - section.start.y);
    let (sin, cos) = section.heading.sin_cos();
    let (ahead, left) = (dx * cos + dy * sin, dy * cos - dx * sin);
    if section.curvature == 0.0 {
        return (ahead, left);
    }
    let radius = 1.0 / section.curvature;
    // Seen from the centre, which lies `radius` to the left.
    let distance = ahead.hypot(left - radius);
    let angle = (ahead * radius.signum()).atan2((radius - left) * radius.signum()) * radius.signum();
    // A point far round a long arc comes out negative; no section is longer than a turn.
    let along = angle * radius.abs();
    let turned = if along < -0.25 * section.length { along + std::f64::consts::TAU * radius.abs() } else { along };
    (turned, radius - distance * radius.signum())
}
