//! Control laws: the cutting speed for a state of wear.

use crate::search::{greatest, grid, root};
use crate::{ConstantSpeed, Contact, Cut, Life, Objective, Pair};
use toolroom_process::ModelError;

/// Range of the searches over speed, shares of the reference speed.
const RANGE: (f64, f64) = (0.1, 6.0);
/// Points of the first scan.
const POINTS: u32 = 48;

/// Answer to a wear rate that was requested.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SetSpeed {
    /// The speed, m/s.
    pub cutting_speed: f64,
    /// Whether the rate can be met; if not, the speed is that of least wear.
    pub feasible: bool,
}

/// Variable speed that gives most path per time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateOptimum {
    /// Shadow price μ = (T + change time)/L, s/m.
    pub shadow_price: f64,
    /// Life under [`Pair::shadow_price_speed`] at that price, within the speed limits.
    pub life: Life,
    /// Iterations taken.
    pub iterations: u32,
}

impl Pair {
    fn search_range(&self) -> (f64, f64) {
        (RANGE.0 * self.limits.reference_speed, RANGE.1 * self.limits.reference_speed)
    }

    /// Wear per path J and `-∂J/∂ln v` at a speed.
    fn intensity_and_fall(&self, contact: &Contact<'_>, flank_wear: f64, speed: f64) -> (f64, f64) {
        let contact = contact.at_speed(speed);
        let temperature = contact.steady_temperature(flank_wear);
        let wear = contact.wear(flank_wear, temperature, 0.0);
        let (mechanical, thermal) = contact.balance(flank_wear, temperature, wear);
        (wear.intensity(speed), mechanical - thermal)
    }

    /// Mode 1: the speed of least wear per path, v*(h), where the weighted functionals are in
    /// balance, `w_M·A = w_T·B/v`. Searched between 0.1 and 6 times the reference speed, not
    /// clipped to the limits of the pair. The speed in `cut` is not used.
    ///
    /// # Source
    /// Postnov & Shafikov, section 3: speed is set so that "the functionals approach each other".
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Pair;
    /// let pair = Pair::default();
    /// let v = pair.minimum_wear_speed(&pair.reference_cut(), 0.2e-3);
    /// assert!((v * 60.0 - 39.99782).abs() < 1e-5);
    /// ```
    pub fn minimum_wear_speed(&self, cut: &Cut, flank_wear: f64) -> f64 {
        let (low, high) = self.search_range();
        let contact = self.contact(cut);
        greatest(low, high, POINTS, |speed| {
            let (intensity, fall) = self.intensity_and_fall(&contact, flank_wear, speed);
            (-intensity, fall)
        })
    }

    /// The paper's rule taken literally: the speed at which `A = B/v`. The highest one where
    /// there are several, an end of the search range where there is none.
    pub fn literal_balance_speed(&self, cut: &Cut, flank_wear: f64) -> f64 {
        let (low, high) = self.search_range();
        let contact = self.contact(cut);
        let excess = |speed: f64| {
            let wear = contact.at_speed(speed).steady_wear(flank_wear);
            wear.mechanical_per_path - wear.thermal_rate / speed
        };
        let mut above = high;
        if excess(high) > 0.0 {
            return high;
        }
        for i in (0..POINTS - 1).rev() {
            let speed = grid(low, high, POINTS, i);
            if excess(speed) > 0.0 {
                return root(speed, above, excess);
            }
            above = speed;
        }
        low
    }

    /// Mode 2: the highest speed at which wear per path is `intensity` (set increment over
    /// path); where even the least wear is more, the speed of least wear and `feasible` false.
    pub fn set_intensity_speed(&self, cut: &Cut, flank_wear: f64, intensity: f64) -> SetSpeed {
        self.set_intensity_speed_up_to(cut, flank_wear, intensity, self.search_range().1)
    }

    /// [`Pair::set_intensity_speed`] for a machine that goes no faster than `highest` (m/s): that
    /// speed where it wears the edge less than is requested.
    pub fn set_intensity_speed_up_to(&self, cut: &Cut, flank_wear: f64, intensity: f64, highest: f64) -> SetSpeed {
        let contact = self.contact(cut);
        let short = |speed: f64| intensity - contact.at_speed(speed).steady_wear(flank_wear).intensity(speed);
        let met = |cutting_speed: f64| SetSpeed { cutting_speed, feasible: true };
        let (low, fastest) = self.search_range();
        let high = highest.min(fastest);
        if short(high) > 0.0 {
            return met(high);
        }
        let step = (fastest / low).powf(f64::from(POINTS - 1).recip());
        let mut above = high;
        while above > low {
            let speed = above / step;
            if short(speed) > 0.0 {
                return met(root(speed, above, short));
            }
            above = speed;
        }
        // The least wear may still undercut the demand between two points.
        let least = self.minimum_wear_speed(cut, flank_wear);
        if short(least) < 0.0 {
            return SetSpeed { cutting_speed: least, feasible: false };
        }
        met(root(least, (least * step).min(fastest), short))
    }

    /// The speed that maximises `(μ - 1/v)/J`: path weighed against time at the shadow price
    /// `μ` (s/m). An infinite price gives [`Pair::minimum_wear_speed`].
    ///
    /// # Source
    /// Least time for given path and wear: minimise ∫dl/v at given ∫J dl, whose Hamiltonian is
    /// autonomous.
    pub fn shadow_price_speed(&self, cut: &Cut, flank_wear: f64, shadow_price: f64) -> f64 {
        let (low, high) = self.search_range();
        // Below 1/μ a metre costs more time than it is worth.
        let worth = shadow_price.recip() * (1.0 + 1e-9);
        if worth >= high {
            return high;
        }
        let contact = self.contact(cut);
        greatest(low.max(worth), high, POINTS, |speed| {
            let (intensity, fall) = self.intensity_and_fall(&contact, flank_wear, speed);
            let margin = shadow_price - speed.recip();
            (margin / intensity, (speed * margin).recip() + fall / intensity)
        })
    }

    /// The variable speed with most path per time, edge changes of `change_time` included, by
    /// Dinkelbach's iteration on the shadow price.
    ///
    /// # Source
    /// Dinkelbach 1967 (recalled).
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Pair;
    /// let pair = Pair::default();
    /// let optimum = pair.rate_optimum(&pair.reference_cut(), 120.0);
    /// assert!((optimum.life.production_rate(120.0) * 60.0 - 46.5).abs() < 0.1);
    /// ```
    pub fn rate_optimum(&self, cut: &Cut, change_time: f64) -> RateOptimum {
        self.rate_optimum_below(cut, change_time, |_| f64::INFINITY)
    }

    /// The same where the speed also stays below `highest` (m/s), which depends on flank wear (m).
    pub fn rate_optimum_below(&self, cut: &Cut, change_time: f64, highest: impl Fn(f64) -> f64) -> RateOptimum {
        let ConstantSpeed { mut life, .. } = self.best_constant_speed(cut, Objective::Rate { change_time });
        let mut shadow_price = life.production_rate(change_time).recip();
        let mut iterations = 0;
        loop {
            iterations += 1;
            life = self.life_along(|flank_wear| {
                let speed = self.shadow_price_speed(cut, flank_wear, shadow_price).min(highest(flank_wear));
                cut.at_speed(self.limits.clip(speed))
            });
            let next = life.production_rate(change_time).recip();
            // Convergence is quadratic; the bound only guards against rounding at the limit.
            if (next / shadow_price - 1.0).abs() < 1e-8 || iterations == 40 {
                return RateOptimum { shadow_price, life, iterations };
            }
            shadow_price = next;
        }
    }

    /// Life under mode 1 within the speed limits: the variable speed with most path per edge.
    pub fn minimum_wear_life(&self, cut: &Cut) -> Life {
        self.life_along(|flank_wear| cut.at_speed(self.limits.clip(self.minimum_wear_speed(cut, flank_wear))))
    }

    /// Life under [`Pair::shadow_price_speed`] within the speed limits.
    pub fn life_at_price(&self, cut: &Cut, shadow_price: f64) -> Life {
        self.life_along(|flank_wear| {
            cut.at_speed(self.limits.clip(self.shadow_price_speed(cut, flank_wear, shadow_price)))
        })
    }

    /// The variable speed with most path per edge among those that last `cutting_time` (s).
    ///
    /// # Errors
    /// [`ModelError::NoSolution`] where the edge lasts less under mode 1 already, or more at
    /// the highest admissible speed.
    pub fn equal_life_optimum(&self, cut: &Cut, cutting_time: f64) -> Result<RateOptimum, ModelError> {
        let quantity = "variable speed of given tool life";
        let longest = self.minimum_wear_life(cut);
        if cutting_time > longest.cutting_time {
            return Err(ModelError::NoSolution { quantity, reason: "the edge lasts less even at the least wear" });
        }
        // Life grows with the price of path, from highest speed throughout to mode 1.
        let (mut low, mut high) = (self.limits.highest_speed.recip(), 1e3 * self.limits.lowest_speed.recip());
        if self.life_at_price(cut, low).cutting_time > cutting_time {
            return Err(ModelError::NoSolution { quantity, reason: "the edge lasts more even at the highest speed" });
        }
        let mut iterations = 0;
        while high / low > 1.0 + 1e-10 {
            iterations += 1;
            let middle = (low * high).sqrt();
            if self.life_at_price(cut, middle).cutting_time < cutting_time {
                low = middle;
            } else {
                high = middle;
            }
        }
        Ok(RateOptimum { shadow_price: high, life: self.life_at_price(cut, high), iterations })
    }
}
