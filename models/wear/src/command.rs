//! What a controller may command: laws of speed against wear, clear of thermal collapse, and what a pass costs.

use crate::{Cut, Pair, RampLimits, SetSpeed};

/// Greatest change of speed from pass to pass, share of the pair's reference speed.
/// Postnov & Shafikov restrict it; the size is an assumption.
const LARGEST_STEP: f64 = 0.15;
/// Greatest acceleration within a pass, share of the pair's reference speed per second:
/// 20 m/min per minute at 40 m/min (assumption).
const LARGEST_ACCELERATION: f64 = 0.5 / 60.0;
/// Share of the temperature rise that a controller keeps between itself and the collapse of the
/// edge: two and a half standard deviations of what the hardness of the work adds to it, which
/// goes with the square root of hardness (assumption).
const COLLAPSE_MARGIN: f64 = 0.05;
/// Bisections of the speed of collapse: a millionth of the speed range.
const BISECTIONS: u32 = 20;
/// Midpoint steps over a pass of the predicted growth of wear.
const STEPS: u32 = 8;

/// A law of speed against flank wear.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpeedLaw {
    /// Least wear per path.
    MinimumWear,
    /// Both functionals equal.
    LiteralBalance,
    /// Path weighed against time at this price, s/m.
    ShadowPrice(f64),
    /// A law that one rule alone has.
    Other(OtherLaw),
}

/// A law of speed by its equation.
#[derive(Clone, Copy, Debug)]
pub struct OtherLaw {
    /// The number of the law, SI.
    pub number: f64,
    /// The speed (m/s) of a pair for a cut at a flank wear (m), by the number of the law.
    pub speed: fn(&Pair, &Cut, f64, f64) -> f64,
}

impl PartialEq for OtherLaw {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number && std::ptr::fn_addr_eq(self.speed, other.speed)
    }
}

/// How fast a policy may change the speed of a pair, in passes of shops and of tool-life studies alike.
pub fn ramp_limits(pair: &Pair) -> RampLimits {
    let reference = pair.limits.reference_speed;
    RampLimits { largest_acceleration: LARGEST_ACCELERATION * reference, largest_step: LARGEST_STEP * reference }
}

impl Pair {
    /// The highest speed of the pair's range at which an edge keeps clear of thermal collapse,
    /// m/s; `flank_wear` is that of the edge at a speed, m. The speed in `cut` is not used.
    ///
    /// # Examples
    /// ```
    /// let pair = toolroom_wear::Pair::default();
    /// let speed = pair.safe_speed(&pair.reference_cut(), |_| 0.3e-3);
    /// assert!(speed > pair.limits.reference_speed && speed <= pair.limits.highest_speed);
    /// ```
    pub fn safe_speed(&self, cut: &Cut, flank_wear: impl Fn(f64) -> f64) -> f64 {
        let limits = &self.limits;
        let (ambient, collapse) = (self.temperature.ambient_temperature, self.temperature.collapse_temperature);
        let hottest = collapse - COLLAPSE_MARGIN * (collapse - ambient);
        let safe = |speed: f64| {
            let contact = self.contact(&cut.at_speed(speed));
            contact.steady_temperature(flank_wear(speed)) <= hottest
        };
        let (mut low, mut high) = (limits.lowest_speed, limits.highest_speed);
        if safe(high) {
            return high;
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            *(if safe(middle) { &mut low } else { &mut high }) = middle;
        }
        low
    }

    /// The speed of a law at a flank wear (m), m/s.
    pub fn speed_by_law(&self, cut: &Cut, law: SpeedLaw, flank_wear: f64) -> f64 {
        match law {
            SpeedLaw::MinimumWear => self.minimum_wear_speed(cut, flank_wear),
            SpeedLaw::LiteralBalance => self.literal_balance_speed(cut, flank_wear),
            SpeedLaw::ShadowPrice(price) => self.shadow_price_speed(cut, flank_wear, price),
            SpeedLaw::Other(law) => (law.speed)(self, cut, flank_wear, law.number),
        }
    }

    /// The speed of a law at a flank wear (m) times `factor`, clear of thermal collapse, m/s. The speed in `cut` is not
    /// used.
    pub fn law_speed(&self, cut: &Cut, law: SpeedLaw, factor: f64, flank_wear: f64) -> f64 {
        (factor * self.speed_by_law(cut, law, flank_wear)).min(self.safe_speed(cut, |_| flank_wear))
    }

    /// The speed, times `factor`, at which an edge of `flank_wear` (m) wears by `intensity` a path (1), clear of thermal
    /// collapse, m/s; and whether there is one.
    pub fn intensity_speed(&self, cut: &Cut, flank_wear: f64, intensity: f64, factor: f64) -> (f64, bool) {
        let highest = self.safe_speed(cut, |_| flank_wear);
        let SetSpeed { cutting_speed, feasible } = self.set_intensity_speed_up_to(cut, flank_wear, intensity, highest);
        ((factor * cutting_speed).min(highest), feasible)
    }

    /// Flank wear after a pass of `path` metres between two speeds (m/s), which change evenly over its time, from
    /// `flank_wear`, m; `factor` is that of the edge on wear.
    pub fn wear_after_pass(&self, cut: &Cut, flank_wear: f64, factor: f64, path: f64, speeds: (f64, f64)) -> f64 {
        let (start, end) = speeds;
        let duration = 2.0 * path / (start + end);
        let step = duration / f64::from(STEPS);
        let acceleration = (end - start) / duration;
        let contact = self.contact(cut);
        (0..STEPS).fold(flank_wear, |worn, i| {
            let speed = start + acceleration * (f64::from(i) + 0.5) * step;
            let contact = contact.at_speed(speed);
            let rate = |wear: f64| factor * contact.steady_wear(wear).rate(speed);
            worn + rate(worn + 0.5 * step * rate(worn)) * step
        })
    }
}
