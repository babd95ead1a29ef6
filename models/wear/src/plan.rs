//! Planning of one pass: speed at its start and end, and the ramp between them.

use crate::{Cut, Limits, Pair};
use toolroom_process::ode::{self, Tolerance};
use toolroom_process::record;

/// What a pass is to be best for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpeedMode {
    /// Mode 1: least wear per path.
    MinimumWear,
    /// The paper's rule A = B/v.
    LiteralBalance,
    /// Mode 2: highest speed at which the pass costs `wear_increment` (m).
    SetIncrement {
        /// Flank wear that the pass may cost, m.
        wear_increment: f64,
    },
    /// Path weighed against time at `shadow_price` (s/m).
    ShadowPrice {
        /// Worth of a metre of path, s/m.
        shadow_price: f64,
    },
}

record! {
    /// What the machine and the shop allow a speed policy; the speed range itself is in
    /// [`Limits`](crate::Limits).
    pub struct RampLimits {
        /// Greatest change of speed within a pass, per time.
        largest_acceleration: Real["m/s2" => "m/min2"] = 20.0 / 3600.0, 0.0..=1e3;
        /// Greatest change of speed from one pass to the next; 0.15 of 40 m/min.
        largest_step: Real["m/s" => "m/min"] = 0.1, 0.0..=1e3;
    }
}

/// Speeds at both ends of a pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ramp {
    /// At the start, m/s.
    pub start_speed: f64,
    /// At the end, m/s.
    pub end_speed: f64,
    /// Whether the law met its demand at both ends.
    pub feasible: bool,
}

impl RampLimits {
    /// The ramp of a pass along a law of speed against flank wear: the one rule of every policy that plans passes.
    ///
    /// The speeds follow the law at the wear of either end; the wear at the end is a fixed point with the speed there.
    /// The start is within `largest_step` of `previous_speed` (m/s), or free where that is `None`; the end is within what
    /// `largest_acceleration` reaches over `path` (m).
    ///
    /// `law` gives the speed (m/s) at a flank wear (m) and whether it meets the demand. `growth` predicts the wear of the
    /// pass, m, from the speed at its start alone, and then from the end speed and growth of the sweep before.
    pub fn ramp(
        &self,
        limits: &Limits,
        flank_wear: f64,
        path: f64,
        previous_speed: Option<f64>,
        law: impl Fn(f64) -> (f64, bool),
        mut growth: impl FnMut(f64, Option<(f64, f64)>) -> f64,
    ) -> Ramp {
        let clipped = |flank_wear: f64| {
            let (speed, feasible) = law(flank_wear);
            (limits.clip(speed), feasible)
        };
        let (wanted, start_feasible) = clipped(flank_wear);
        let step = self.largest_step;
        let start_speed = previous_speed.map_or(wanted, |last| limits.clip(wanted.max(last - step).min(last + step)));
        // v² changes by 2·a·l over a path.
        let reach = 2.0 * self.largest_acceleration * path;
        let slowest = (start_speed * start_speed - reach).max(0.0).sqrt();
        let fastest = (start_speed * start_speed + reach).sqrt();
        let end = |growth: f64| {
            let (speed, feasible) = clipped(flank_wear + growth);
            (speed.max(slowest).min(fastest), feasible)
        };
        let mut grown = growth(start_speed, None);
        let (mut end_speed, mut feasible) = end(grown);
        for _ in 1..SWEEPS {
            grown = growth(start_speed, Some((end_speed, grown)));
            (end_speed, feasible) = end(grown);
        }
        Ramp { start_speed, end_speed, feasible: start_feasible && feasible }
    }
}

/// Speed over one pass: `v(time) = start_speed + acceleration·time`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassPlan {
    /// Speed at the start, m/s.
    pub start_speed: f64,
    /// Speed at the end, m/s.
    pub end_speed: f64,
    /// Change of speed per time, m/s².
    pub acceleration: f64,
    /// Time in cut, s.
    pub duration: f64,
    /// Predicted growth of flank wear, m; at most ten wear limits.
    pub wear_increment: f64,
    /// Whether a set increment can be met.
    pub feasible: bool,
}

/// Sweeps of the fixed point between end speed and growth of wear: least wear has settled to
/// 1e-7 by then; a set increment, whose speed feels wear more, to 1e-3.
const SWEEPS: usize = 3;
/// Accuracy of the predicted wear, relative.
const WEAR_ACCURACY: f64 = 1e-7;
/// Predicted wear is followed up to this many wear limits; beyond, the edge is lost anyway.
const LOST: f64 = 10.0;

impl Pair {
    /// Plans a pass of length `path` (m) from an edge with `flank_wear` (m).
    ///
    /// The speeds at both ends follow the mode at the wear there; the wear at the end is a
    /// fixed point with the end speed. A step or acceleration of 0 holds the speed. Speeds are clipped to the limits of the pair, the start
    /// to within `largest_step` of `previous_speed`, the end to what `largest_acceleration`
    /// reaches. The speed in `cut` is not used.
    ///
    /// # Source
    /// Postnov & Shafikov, section 3 (speed and acceleration set per pass); limits assumptions.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Pair, RampLimits, SpeedMode};
    /// let pair = Pair::default();
    /// let cut = pair.reference_cut();
    /// let plan = pair.plan_pass(&cut, 0.1e-3, 75.4, SpeedMode::MinimumWear, &RampLimits::default(), None);
    /// assert!((plan.end_speed * 60.0 - 46.031213).abs() < 1e-4);
    /// ```
    pub fn plan_pass(
        &self,
        cut: &Cut,
        flank_wear: f64,
        path: f64,
        mode: SpeedMode,
        ramp: &RampLimits,
        previous_speed: Option<f64>,
    ) -> PassPlan {
        self.plan_pass_along(cut, flank_wear, path, ramp, previous_speed, |flank_wear| {
            self.mode_speed(cut, flank_wear, path, mode)
        })
    }

    /// [`Pair::plan_pass`] along any law `speed_at(flank_wear)`, which gives the speed (m/s) and
    /// whether it meets the demand; a [`SpeedTable`](crate::SpeedTable) where many passes follow
    /// the same law.
    pub fn plan_pass_along(
        &self,
        cut: &Cut,
        flank_wear: f64,
        path: f64,
        ramp: &RampLimits,
        previous_speed: Option<f64>,
        speed_at: impl Fn(f64) -> (f64, bool),
    ) -> PassPlan {
        let growth = |start: f64, before: Option<(f64, f64)>| match before {
            None => (self.intensity_at(cut, flank_wear, start) * path).min(LOST * self.limits.wear_limit),
            Some((end, _)) => self.wear_over_ramp(cut, flank_wear, path, start, end),
        };
        let Ramp { start_speed, end_speed, feasible } =
            ramp.ramp(&self.limits, flank_wear, path, previous_speed, speed_at, growth);
        let wear_increment = self.wear_over_ramp(cut, flank_wear, path, start_speed, end_speed);
        let duration = 2.0 * path / (start_speed + end_speed);
        PassPlan {
            start_speed,
            end_speed,
            acceleration: (end_speed - start_speed) / duration,
            duration,
            wear_increment,
            feasible,
        }
    }

    /// Speed of a mode, not clipped, and whether it meets the demand.
    fn mode_speed(&self, cut: &Cut, flank_wear: f64, path: f64, mode: SpeedMode) -> (f64, bool) {
        match mode {
            SpeedMode::MinimumWear => (self.minimum_wear_speed(cut, flank_wear), true),
            SpeedMode::LiteralBalance => (self.literal_balance_speed(cut, flank_wear), true),
            SpeedMode::ShadowPrice { shadow_price } => (self.shadow_price_speed(cut, flank_wear, shadow_price), true),
            SpeedMode::SetIncrement { wear_increment } => {
                let highest = self.limits.highest_speed;
                let set = self.set_intensity_speed_up_to(cut, flank_wear, wear_increment / path, highest);
                (set.cutting_speed, set.feasible)
            }
        }
    }

    /// Growth of quasi-steady flank wear over a ramp, m.
    fn wear_over_ramp(&self, cut: &Cut, flank_wear: f64, path: f64, start: f64, end: f64) -> f64 {
        let duration = 2.0 * path / (start + end);
        let lost = LOST * self.limits.wear_limit;
        let contact = self.contact(&cut.at_speed(start));
        let rate = |time: f64, wear: &[f64; 1]| {
            let speed = start + (end - start) * (time / duration);
            [contact.at_speed(speed).steady_wear(wear[0].min(lost)).rate(speed)]
        };
        let spent = |_: f64, wear: &[f64; 1]| [wear[0] - lost];
        let tolerance = Tolerance { relative: WEAR_ACCURACY, absolute: [WEAR_ACCURACY * self.limits.wear_limit] };
        // An edge whose wear runs away is lost as well.
        let grown =
            ode::integrate(rate, spent, &[flank_wear], duration, &tolerance).map_or(lost, |end| end.state[0].min(lost));
        grown - flank_wear
    }

    /// Quasi-steady wear per path at a speed, 1.
    pub(crate) fn intensity_at(&self, cut: &Cut, flank_wear: f64, speed: f64) -> f64 {
        self.contact(&cut.at_speed(speed)).steady_wear(flank_wear).intensity(speed)
    }
}
