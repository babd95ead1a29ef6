//! How a sharp outside corner is passed.

use crate::path_error::ArcError;
use crate::{Corner, Machine, PathError, corner_feed};
use std::f64::consts::PI;

/// What the path does beyond a corner. All policies travel in air between the ends of the two
/// offset walls, to the point where the offset lines meet and back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CornerPolicy {
    /// A loop outside the corner, so that direction and speed never jump (Lukin, eq. (15)).
    Loop {
        /// Radius of the loop R_tr, m.
        radius: f64,
        /// Path error admitted on the loop, m; that of the pass where `None`.
        tolerance: Option<f64>,
    },
    /// Stop where the offset lines meet until the following error has faded.
    ExactStop,
    /// Slow down to the feed at which the corner is crossed within a tolerance.
    SlowDown {
        /// Undershoot admitted, m; the tolerance of the pass where `None`.
        tolerance: Option<f64>,
    },
}

/// Time constants of the position loop after which a stop has settled to 5 %.
const SETTLING: f64 = 3.0;

/// The move around one corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerMove {
    /// The corner.
    pub corner: Corner,
    /// Length of the additional path, m.
    pub length: f64,
    /// Feed in the corner itself, m/s; 0 for a stop.
    pub feed: f64,
    /// Time, s.
    pub time: f64,
}

impl CornerPolicy {
    /// The move around `corner`, in air and therefore at the machine's highest feed where the
    /// policy sets no limit.
    ///
    /// | policy | length | feed in the corner | time |
    /// |---|---|---|---|
    /// | loop | `2·(R_f + R_tr)·ctg(α/2) + R_tr·(π + α)` | greatest within the tolerance | length/feed |
    /// | exact stop | `2·R_f·ctg(α/2)` | 0 | length/V_max + V_max/a + 3/K_v |
    /// | slow down | `2·R_f·ctg(α/2)` | V_c from the undershoot | length/V_max + (V_max − V_c)²/(a·V_max) |
    ///
    /// # Source
    /// Loop: Lukin, eqs. (15) and (16). Stop and slow-down: kinematics of constant acceleration,
    /// settling to 5 % of the following error.
    pub fn pass(
        &self,
        corner: Corner,
        cutter_radius: f64,
        pass_tolerance: f64,
        machine: &Machine,
        path_error: &PathError,
    ) -> CornerMove {
        let cot = 1.0 / (0.5 * corner.interior_angle).tan();
        let straight = 2.0 * cutter_radius * cot;
        let (highest, acceleration) = (machine.highest_feed, machine.highest_acceleration);
        match *self {
            Self::Loop { radius, tolerance } => {
                let arc = path_error.on_arc(radius, PI + corner.interior_angle, machine.position_gain);
                let feed = ArcError::feed_within(&arc, tolerance.unwrap_or(pass_tolerance), highest);
                let length = loop_length(corner.interior_angle, cutter_radius, radius);
                CornerMove { corner, length, feed, time: length / feed }
            }
            Self::ExactStop => {
                let time = straight / highest + highest / acceleration + SETTLING / machine.position_gain;
                CornerMove { corner, length: straight, feed: 0.0, time }
            }
            Self::SlowDown { tolerance } => {
                let within = tolerance.unwrap_or(pass_tolerance);
                let feed = corner_feed(within, corner.interior_angle, machine.position_gain).min(highest);
                let time = straight / highest + (highest - feed).powi(2) / (acceleration * highest);
                CornerMove { corner, length: straight, feed, time }
            }
        }
    }
}

/// Additional path of a loop of `radius` around a corner of `interior_angle`, m (Lukin,
/// eq. (15)): the offset lines meet `R_f·ctg(α/2)` past the corner, the loop in the vertical
/// angle touches them `R_tr·ctg(α/2)` further and turns by π + α.
///
/// # Examples
/// ```
/// let length = toolroom_contour::loop_length(std::f64::consts::FRAC_PI_2, 0.016, 0.002);
/// assert!((length - 45.4248e-3).abs() < 1e-7);
/// ```
pub fn loop_length(interior_angle: f64, cutter_radius: f64, radius: f64) -> f64 {
    2.0 * (cutter_radius + radius) / (0.5 * interior_angle).tan() + radius * (PI + interior_angle)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn slowing_down_is_never_slower_than_stopping(angle in 0.2..3.0f64, tolerance in 1e-6..1e-3f64) {
            let machine = Machine::default();
            let corner = Corner { after: 0, interior_angle: angle };
            let time = |policy: CornerPolicy| policy.pass(corner, 0.016, tolerance, &machine, &PathError::default()).time;
            let (slowed, stopped) = (time(CornerPolicy::SlowDown { tolerance: None }), time(CornerPolicy::ExactStop));
            prop_assert!(slowed <= stopped);
        }
    }

    #[test]
    fn a_loop_with_exact_drives_runs_at_the_highest_feed() {
        let machine = Machine::default();
        let corner = Corner { after: 0, interior_angle: 1.0 };
        let policy = CornerPolicy::Loop { radius: 2e-3, tolerance: None };
        assert_eq!(policy.pass(corner, 0.016, 5e-5, &machine, &PathError::Off).feed, machine.highest_feed);
    }
}
