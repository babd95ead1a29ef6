//! Tool life by quadrature over flank wear.

use crate::{Contact, Cut, Pair, quadrature};

/// Distance of the two quadrature rules, relative, at which an integral at constant speed is
/// accepted. Its integrand is analytic, so that the better rule is by far more accurate: below
/// 1e-8 over the shipped sets and their speed ranges.
const SMOOTH: f64 = 5e-5;
/// The same along a policy, which may have kinks at its limits: the error itself.
const KINKED: f64 = 1e-7;

/// What an edge gives between two states of wear.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Life {
    /// Time in cut T, s.
    pub cutting_time: f64,
    /// Cutting path L, m.
    pub path: f64,
    /// Functional of force and path F_M, m.
    pub mechanical_wear: f64,
    /// Functional of temperature and time F_T, m.
    pub thermal_wear: f64,
}

impl Life {
    /// Mean cutting speed, m/s.
    pub fn mean_speed(&self) -> f64 {
        self.path / self.cutting_time
    }

    /// Path per time in cut and changing edges, L/(T + change_time), m/s.
    pub fn production_rate(&self, change_time: f64) -> f64 {
        self.path / (self.cutting_time + change_time)
    }
}

/// What a constant speed is to be best for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Objective {
    /// Most path per edge.
    Path,
    /// Most time in cut per edge; often the lowest admissible speed.
    Life,
    /// Most path per time, edge changes included.
    Rate {
        /// Time to change an edge, s.
        change_time: f64,
    },
    /// Least cost per path.
    Cost {
        /// Time to change an edge, s.
        change_time: f64,
        /// Price of an edge.
        edge_cost: f64,
        /// Price of machine and operator per second.
        machine_cost: f64,
    },
}

impl Objective {
    /// The change time that makes path per time express this objective: an edge's price counts
    /// as the machine time that it would buy. `None` for path and life.
    pub fn change_time(&self) -> Option<f64> {
        match *self {
            Self::Path | Self::Life => None,
            Self::Rate { change_time } => Some(change_time),
            Self::Cost { change_time, edge_cost, machine_cost } => Some(change_time + edge_cost / machine_cost),
        }
    }
}

/// A constant speed and what it gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantSpeed {
    /// The speed, m/s.
    pub cutting_speed: f64,
    /// Life at it, from a new edge to the wear limit.
    pub life: Life,
}

/// Life and its slopes by ln v.
struct Slopes {
    life: Life,
    /// ∂L/∂ln v, m.
    path: f64,
}

impl Pair {
    /// Quasi-steady life of a new edge at a constant cut.
    ///
    /// `T = ∫ dh/(v·A + B)`, `L = v·T`, `F_M = ∫ v·A/(v·A + B) dh`, to 1e-7 relative or better.
    ///
    /// # Validity
    /// The tool body follows at once (continuous cut); no thermal damage, no collapse, no
    /// chipping: [`Pair::run`] knows those.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Pair;
    /// let pair = Pair::default();
    /// let life = pair.life(&pair.reference_cut());
    /// assert!((life.cutting_time / 60.0 - 14.932164).abs() < 1e-5);
    /// ```
    pub fn life(&self, cut: &Cut) -> Life {
        let contact = self.contact(cut);
        self.life_integral(0.0, self.limits.wear_limit, SMOOTH, |_| (contact, cut.cutting_speed))
    }

    /// Quasi-steady life of a new edge when the cut depends on flank wear (a speed policy
    /// v(h), or effects that grow with the land).
    pub fn life_along(&self, cut_at: impl Fn(f64) -> Cut) -> Life {
        self.life_between(0.0, self.limits.wear_limit, cut_at)
    }

    /// The same between two states of wear, m.
    pub fn life_between(&self, start: f64, end: f64, cut_at: impl Fn(f64) -> Cut) -> Life {
        self.life_integral(start, end, KINKED, |flank_wear| {
            let cut = cut_at(flank_wear);
            (self.contact(&cut), cut.cutting_speed)
        })
    }

    fn life_integral<'a>(
        &self,
        start: f64,
        end: f64,
        accuracy: f64,
        contact_at: impl Fn(f64) -> (Contact<'a>, f64),
    ) -> Life {
        let [cutting_time, path, mechanical_wear, thermal_wear] = self.over_wear(start, end, accuracy, |flank_wear| {
            let (contact, speed) = contact_at(flank_wear);
            let wear = contact.steady_wear(flank_wear);
            let rate = wear.rate(speed);
            [rate.recip(), speed / rate, speed * wear.mechanical_per_path / rate, wear.thermal_rate / rate]
        });
        Life { cutting_time, path, mechanical_wear, thermal_wear }
    }

    /// Land over which the wear curve bends, m: quadratures over wear run in ln(1 + h/scale). A
    /// thirtieth of the wear limit (an assumption) where the law has no run-in.
    pub fn curve_scale(&self) -> f64 {
        self.law.run_in_width().unwrap_or(self.limits.wear_limit / 30.0)
    }

    /// ∫ f dh in the variable ln(1 + h/scale), in which the run-in is as wide as the rest.
    fn over_wear<const D: usize>(&self, start: f64, end: f64, accuracy: f64, f: impl Fn(f64) -> [f64; D]) -> [f64; D] {
        let scale = self.curve_scale();
        let integrand = |x: f64| {
            let stretch = x.exp();
            f(scale * (stretch - 1.0)).map(|value| value * scale * stretch)
        };
        quadrature::integrate(integrand, (start / scale).ln_1p(), (end / scale).ln_1p(), accuracy)
    }

    fn life_slopes(&self, cut: &Cut) -> Slopes {
        let contact = self.contact(cut);
        let speed = cut.cutting_speed;
        let [cutting_time, path, mechanical_wear, thermal_wear, slope] =
            self.over_wear(0.0, self.limits.wear_limit, SMOOTH, |flank_wear| {
                let temperature = contact.steady_temperature(flank_wear);
                let wear = contact.wear(flank_wear, temperature, 0.0);
                let (mechanical, thermal) = contact.balance(flank_wear, temperature, wear);
                let rate = wear.rate(speed);
                let intensity = rate / speed;
                [
                    rate.recip(),
                    speed / rate,
                    speed * wear.mechanical_per_path / rate,
                    wear.thermal_rate / rate,
                    (mechanical - thermal) / (intensity * intensity),
                ]
            });
        Slopes { life: Life { cutting_time, path, mechanical_wear, thermal_wear }, path: slope }
    }

    /// The best constant speed within the limits of the pair, for a new edge.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Objective, Pair};
    /// let pair = Pair::default();
    /// let best = pair.best_constant_speed(&pair.reference_cut(), Objective::Path);
    /// assert!((best.cutting_speed * 60.0 - 30.430343).abs() < 1e-5);
    /// ```
    pub fn best_constant_speed(&self, cut: &Cut, objective: Objective) -> ConstantSpeed {
        let change_time = objective.change_time();
        let gain = |slopes: &Slopes, speed: f64| {
            // With T = L/v: dT/dln v = (dL/dln v)/v - T.
            let time_slope = slopes.path / speed - slopes.life.cutting_time;
            match (objective, change_time) {
                (Objective::Life, _) => (slopes.life.cutting_time, time_slope),
                (_, Some(change)) => {
                    let total = slopes.life.cutting_time + change;
                    (slopes.life.path / total, slopes.path * total - slopes.life.path * time_slope)
                }
                _ => (slopes.life.path, slopes.path),
            }
        };
        let value = |speed: f64| gain(&self.life_slopes(&cut.at_speed(speed)), speed);
        let (low, high) = (self.limits.lowest_speed, self.limits.highest_speed);
        let cutting_speed = crate::search::greatest(low, high, 48, value);
        ConstantSpeed { cutting_speed, life: self.life(&cut.at_speed(cutting_speed)) }
    }
}
