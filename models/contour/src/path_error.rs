//! How far the drives leave a commanded arc.

use std::f64::consts::{FRAC_PI_2, PI};

/// Velocity loop of a feed drive as a second-order lag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VelocityLoop {
    /// Natural frequency ω_n, rad/s.
    pub frequency: f64,
    /// Damping ratio ζ.
    pub damping: f64,
}

/// Law of the radial error on an arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PathError {
    /// Lag of a proportional position loop around a velocity loop (ideal where `None`): the arc
    /// comes out smaller by `R_c·(1 − |G|)`, which tends to `V²/(2·K_v²·R_c)`, with the radius
    /// R_c of the cutter-centre path. Standard feed-drive theory.
    Servo {
        /// The velocity loop, ideal where `None`.
        velocity_loop: Option<VelocityLoop>,
    },
    /// `3.65e-9 m·(V/(1 mm/min))^1.5·(arc angle)^0.34`, Lukin's eq. (14), of which size and
    /// dependence on the angle alone are those of the truncation error of his integration.
    /// It counts whole arcs, however they are divided.
    Empirical,
    /// Truncation error of the equations of motion integrated by the explicit Euler method with
    /// this step, s (Lukin, eqs. (7) and (13), 10 ms): an error of the calculation, not of the
    /// machine, proportional to the step. A plan made with it carries a warning.
    ExplicitEuler {
        /// Time step, s.
        step: f64,
    },
    /// The drives follow exactly.
    Off,
}

impl Default for PathError {
    /// The servo law with an ideal velocity loop.
    fn default() -> Self {
        Self::Servo { velocity_loop: None }
    }
}

/// Feed to which eq. (14) refers, m/s: 1 mm/min.
const FEED_UNIT: f64 = 1e-3 / 60.0;

/// Coefficient of eq. (14), m.
const COEFFICIENT: f64 = 3.65e-9;

/// Exponent of the arc angle in eq. (14).
pub(crate) const ANGLE_EXPONENT: f64 = 0.34;

impl PathError {
    /// Magnitude of the radial error, m, on an arc of the cutter-centre path at `feed` (m/s);
    /// 0 on a line (`arc_angle` 0).
    ///
    /// # Examples
    /// ```
    /// use std::f64::consts::FRAC_PI_2;
    /// use toolroom_contour::PathError;
    /// let at = |law: PathError| law.magnitude(590e-3 / 60.0, 0.050, FRAC_PI_2, 16.667);
    /// assert!((at(PathError::default()) - 3.4805e-6).abs() < 1e-10);
    /// assert!((at(PathError::Empirical) - 60.989e-6).abs() < 1e-9);
    /// ```
    pub fn magnitude(&self, feed: f64, centre_radius: f64, arc_angle: f64, position_gain: f64) -> f64 {
        self.on_arc(centre_radius, arc_angle, position_gain).at(feed)
    }

    /// The law on one arc.
    pub(crate) fn on_arc(&self, centre_radius: f64, arc_angle: f64, position_gain: f64) -> ArcError {
        if arc_angle == 0.0 {
            return ArcError::None;
        }
        match *self {
            Self::Servo { velocity_loop } => ArcError::Servo { centre_radius, position_gain, velocity_loop },
            Self::Empirical => ArcError::Power { coefficient: COEFFICIENT * arc_angle.powf(ANGLE_EXPONENT) },
            Self::ExplicitEuler { step } => ArcError::Euler { centre_radius, arc_angle, step },
            Self::Off => ArcError::None,
        }
    }

    /// Sign of the error in the wall, positive where material is left: a lag pulls the path
    /// inwards, off a concave wall and into a convex one. Laws without a direction count as
    /// leaving material.
    pub fn sign(&self, wall_curvature: f64) -> f64 {
        match self {
            Self::Servo { .. } if wall_curvature > 0.0 => -1.0,
            Self::Servo { .. } | Self::Empirical | Self::ExplicitEuler { .. } | Self::Off => 1.0,
        }
    }
}

/// A law with all that does not depend on the feed worked out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ArcError {
    None,
    Power { coefficient: f64 },
    Servo { centre_radius: f64, position_gain: f64, velocity_loop: Option<VelocityLoop> },
    Euler { centre_radius: f64, arc_angle: f64, step: f64 },
}

impl ArcError {
    pub fn at(&self, feed: f64) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Power { coefficient } => {
                let ratio = feed / FEED_UNIT;
                coefficient * ratio * ratio.sqrt()
            }
            Self::Servo { centre_radius, position_gain, velocity_loop } => {
                // |G|⁻² − 1, which does not cancel.
                let square = (feed / centre_radius).powi(2);
                let lag = square / (position_gain * position_gain);
                let excess = match velocity_loop {
                    None => lag,
                    Some(VelocityLoop { frequency, damping }) => {
                        let lead = 2.0 * damping * square / (position_gain * frequency);
                        lag * (1.0 - square / (frequency * frequency)).powi(2) + lead * lead - 2.0 * lead
                    }
                };
                let root = (1.0 + excess).sqrt();
                (centre_radius * excess / (root * (1.0 + root))).abs()
            }
            Self::Euler { centre_radius, arc_angle, step } => euler(feed, centre_radius, arc_angle, step),
        }
    }

    /// Greatest feed up to `highest` at which the error stays within `tolerance`; the error
    /// grows with the feed.
    pub fn feed_within(&self, tolerance: f64, highest: f64) -> f64 {
        if self.at(highest) <= tolerance {
            return highest;
        }
        let (mut low, mut high) = (0.0, highest);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.at(middle) <= tolerance { low = middle } else { high = middle }
        }
        low
    }
}

/// Greatest radial error of the points of eq. (13) on an arc: successive chords of length
/// `feed·step` whose first one points along the starting tangent. Their ends lie on a circle
/// about a displaced centre.
fn euler(feed: f64, radius: f64, arc_angle: f64, step: f64) -> f64 {
    let chord = feed * step;
    let turn = chord / radius;
    let chords = (arc_angle / turn).round().max(1.0);
    if turn >= PI {
        return radius;
    }
    let circle = 0.5 * chord / (0.5 * turn).sin();
    let (dx, dy) = (0.5 * chord, 0.5 * chord / (0.5 * turn).tan() - radius);
    // Farthest where the ray from the arc's centre runs through the displaced centre.
    let farthest = (dx.atan2(-dy) / turn + 0.5).clamp(1.0, chords);
    [farthest.floor().max(1.0), farthest.ceil().min(chords), chords]
        .into_iter()
        .map(|n| {
            let (sin, cos) = ((n - 0.5) * turn).sin_cos();
            ((dx + circle * sin).hypot(dy - circle * cos) - radius).abs()
        })
        .fold(0.0, f64::max)
}

/// Least distance from a right-angled or other corner at which the path passes, m, when the
/// corner is crossed at constant `feed` by drives with an ideal velocity loop: the reference
/// turns at once, the axes follow with the time constant `1/position_gain`.
///
/// # Examples
/// ```
/// use toolroom_contour::corner_undershoot;
/// let error = corner_undershoot(250e-3 / 60.0, std::f64::consts::FRAC_PI_2, 16.667);
/// assert!((error - 127.213e-6).abs() < 1e-9);
/// ```
pub fn corner_undershoot(feed: f64, interior_angle: f64, position_gain: f64) -> f64 {
    feed / position_gain * undershoot_ratio(interior_angle)
}

/// Greatest feed, m/s, at which a corner is crossed within `tolerance`.
pub fn corner_feed(tolerance: f64, interior_angle: f64, position_gain: f64) -> f64 {
    tolerance * position_gain / undershoot_ratio(interior_angle)
}

/// Undershoot over following error.
fn undershoot_ratio(interior_angle: f64) -> f64 {
    // Between the old direction and the new one.
    let cos = -interior_angle.cos();
    let square = |u: f64| {
        let fading = (-u).exp();
        let gained = u - 1.0 + fading;
        fading * fading + gained * gained - 2.0 * fading * gained * cos
    };
    // One minimum: at first the path only leaves the corner's far side behind.
    let (mut low, mut high) = (0.0, 4.0);
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    for _ in 0..80 {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if square(a) < square(b) { high = b } else { low = a }
    }
    square(0.5 * (low + high)).sqrt()
}

/// Positions of eq. (13) on an arc, m: `x_i = x_{i−1} + V·cos(φ_{i−1})·Δt`, the literal explicit
/// Euler march whose error [`PathError::ExplicitEuler`] gives in closed form.
pub fn explicit_euler_march(feed: f64, radius: f64, arc_angle: f64, step: f64) -> Vec<crate::Point> {
    let steps = (radius * arc_angle / (feed * step)).round() as u32;
    let mut point = crate::Point::default();
    let mut positions = vec![point];
    for i in 0..steps {
        point = point.ahead(feed * step / radius * f64::from(i), feed * step);
        positions.push(point);
    }
    positions
}

/// Error of two axes whose position gains differ, m, on a line at 45° to both:
/// `V/2·|1/K_x − 1/K_y|`.
pub fn gain_mismatch_error(feed: f64, gain_x: f64, gain_y: f64) -> f64 {
    0.5 * feed * (1.0 / gain_x - 1.0 / gain_y).abs()
}

/// Force of inertia on an arc, N: `m·V²/R`.
pub fn inertia_force(mass: f64, feed: f64, radius: f64) -> f64 {
    mass * feed * feed / radius
}

/// Mean force of inertia, N, while the direction changes by `turn` within `duration`:
/// `m·2·V·sin(turn/2)/duration`. It is what a loop avoids.
pub fn corner_impulse(mass: f64, feed: f64, turn: f64, duration: f64) -> f64 {
    mass * 2.0 * feed * (0.5 * turn.clamp(-2.0 * FRAC_PI_2, 2.0 * FRAC_PI_2)).sin().abs() / duration
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const FEED: f64 = 590e-3 / 60.0;

    proptest! {
        #[test]
        fn the_closed_euler_error_is_that_of_the_march(feed in 1e-3..2e-2f64, radius in 5e-3..0.1f64, angle in 0.1..6.0f64) {
            let step = 0.01;
            let centre = crate::Point { x: 0.0, y: radius };
            let marched = explicit_euler_march(feed, radius, angle, step).into_iter()
                .map(|point| (point.distance(centre) - radius).abs()).fold(0.0, f64::max);
            prop_assert!((euler(feed, radius, angle, step) / marched - 1.0).abs() < 1e-6);
        }

        #[test]
        fn every_law_grows_with_the_feed(slow in 1e-3..1e-2f64, more in 1.01..2.0f64) {
            let fast = VelocityLoop { frequency: 120.0, damping: 0.7 };
            for law in [PathError::default(), PathError::Servo { velocity_loop: Some(fast) }, PathError::Empirical] {
                let at = |feed| law.magnitude(feed, 0.03, 1.0, 16.667);
                prop_assert!(at(more * slow) > at(slow));
            }
        }
    }

    #[test]
    fn the_explicit_euler_error_is_first_order_in_the_step() {
        let at = |step| PathError::ExplicitEuler { step }.magnitude(FEED, 0.05, FRAC_PI_2, 16.667);
        assert!((at(0.01) / at(0.005) - 2.0).abs() < 1e-3);
    }

    #[test]
    fn a_fast_velocity_loop_tends_to_the_ideal_one() {
        let fast = PathError::Servo { velocity_loop: Some(VelocityLoop { frequency: 1e7, damping: 0.7 }) };
        let at = |law: PathError| law.magnitude(FEED, 0.05, 1.0, 16.667);
        assert!((at(fast) / at(PathError::default()) - 1.0).abs() < 1e-4);
    }

    #[test]
    fn the_feed_within_a_tolerance_meets_it() {
        let arc = PathError::Empirical.on_arc(0.03, FRAC_PI_2, 16.667);
        let feed = arc.feed_within(50e-6, 1.0);
        assert!((arc.at(feed) / 50e-6 - 1.0).abs() < 1e-12);
        assert_eq!(arc.feed_within(1.0, 0.02), 0.02);
    }
}
