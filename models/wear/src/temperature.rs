//! Contact temperature at the flank.

use crate::Cut;
use toolroom_process::{Number, record};

record! {
    /// Heating of the flank contact by the chip and by friction on the wear land.
    ///
    /// `temperature = ambient_temperature + (1 - body_share)·(chip + flank) + body_share·body`
    ///
    /// | term | equation |
    /// |---|---|
    /// | chip | `chip_heating · (v/v_r)^x · (f/f_r)^y · (a_p/a_r)^z · hardness^n` |
    /// | flank | `flank_heating · sqrt(v/v_r · (flank_wear + land_offset)/land_r) · hardness^n` |
    /// | body | a state that follows chip + flank with `body_time_constant` |
    ///
    /// # Validity
    /// Quasi-steady contact (contact times of milliseconds), high Péclet number.
    ///
    /// # Source
    /// Power-law chip heating as in Kosilova & Meshcheryakov (recalled); square-root law of a
    /// moving band source (Jaeger 1942, recalled) for the land; split into contact and body an
    /// assumption. Defaults are the set `ni_vk6om`.
    pub struct Temperature {
        /// Ambient temperature, theta_a.
        ambient_temperature: Real["K" => "K"] = 293.15, 200.0..=600.0;
        /// Temperature rise by the chip at the reference cut, K_t.
        chip_heating: Real["K" => "K"] = 130.0, 0.0..=2000.0;
        /// Exponent of speed, x.
        speed_exponent: Real = 0.38, 0.0..=1.0;
        /// Exponent of feed, y.
        feed_exponent: Real = 0.20, 0.0..=1.0;
        /// Exponent of depth of cut, z.
        depth_exponent: Real = 0.08, 0.0..=1.0;
        /// Temperature rise by flank friction at reference speed and land, K_f.
        flank_heating: Real["K" => "K"] = 70.0, 0.0..=2000.0;
        /// Land that heats when the edge is new, h0.
        land_offset: Real["m" => "mm"] = 0.02e-3, 0.0..=1e-3;
        /// Exponent of hardness, n_th.
        hardness_exponent: Real = 0.5, 0.0..=3.0;
        /// Share of the rise that the tool body's temperature carries, beta.
        body_share: Real = 0.15, 0.0..=1.0;
        /// Time constant of the tool body, tau_b.
        body_time_constant: Real["s" => "s"] = 20.0, 1e-3..=1e5;
        /// Contact temperature at which the edge collapses, theta_max.
        collapse_temperature: Real["K" => "K"] = 1400.0, 300.0..=5000.0;
        /// Speed at which the coefficients hold, 1 m/min.
        reference_speed: Real["m/s" => "m/min"] = 1.0 / 60.0, 1e-6..=100.0;
        /// Feed at which the coefficients hold, s0.
        reference_feed: Real["m" => "mm/rev"] = 0.12e-3, 1e-6..=5e-3;
        /// Depth of cut at which the coefficients hold, t0.
        reference_depth: Real["m" => "mm"] = 0.75e-3, 1e-6..=20e-3;
        /// Land at which the coefficients hold, 1 mm.
        reference_land: Real["m" => "mm"] = 1e-3, 1e-6..=1.0;
    }
}

/// Temperature rise of one cut, for any flank wear.
#[derive(Clone, Copy, Debug)]
pub struct Heating<N> {
    /// Rise by the chip, K.
    pub chip: N,
    /// Rise by flank friction over the square root of the land, K/√m.
    flank_per_root: N,
    /// Both at the reference speed.
    chip_level: N,
    flank_level: N,
    land_offset: N,
}

impl<N: Number> Temperature<N> {
    /// The temperature rise that `cut` causes.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Cut, Temperature};
    /// let heating = Temperature::default().heating(&Cut::default());
    /// assert!((heating.chip - 528.11).abs() < 0.01);
    /// assert!((heating.flank(0.2e-3) - 207.65).abs() < 0.01);
    /// ```
    pub fn heating(&self, cut: &Cut<N>) -> Heating<N> {
        let hard = power(cut.hardness, self.hardness_exponent);
        let chip_level = self.chip_heating
            * power(cut.feed_per_rev / self.reference_feed, self.feed_exponent)
            * power(cut.depth_of_cut / self.reference_depth, self.depth_exponent)
            * hard
            * cut.temperature_factor;
        let flank_level = self.flank_heating / root(self.reference_land) * hard * cut.temperature_factor;
        let level = Heating {
            chip: chip_level,
            flank_per_root: flank_level,
            chip_level,
            flank_level,
            land_offset: self.land_offset,
        };
        self.at_speed(&level, cut.cutting_speed)
    }

    /// The same cut at another speed.
    #[inline]
    pub(crate) fn at_speed(&self, heating: &Heating<N>, cutting_speed: N) -> Heating<N> {
        let speed = cutting_speed / self.reference_speed;
        Heating {
            chip: heating.chip_level * power(speed, self.speed_exponent),
            flank_per_root: heating.flank_level * root(speed),
            ..*heating
        }
    }

    /// The same cut after a small relative `change` of speed: five terms of the binomial series, whose
    /// remainder is below 1e-9 at 3 %.
    #[inline]
    pub(crate) fn near_speed(&self, heating: &Heating<N>, change: N) -> Heating<N> {
        let series = [4.0, 3.0, 2.0, 1.0, 0.0].into_iter().fold(N::from(1.0), |sum, term| {
            change * ((self.speed_exponent - term) * (term + 1.0f64).recip()) * sum + 1.0
        });
        Heating { chip: heating.chip * series, flank_per_root: heating.flank_per_root * root(change + 1.0), ..*heating }
    }
}

impl<N: Number> Heating<N> {
    /// The same where everything heats by `factor` more.
    #[inline]
    pub(crate) fn times(&self, factor: N) -> Self {
        Self {
            chip: self.chip * factor,
            flank_per_root: self.flank_per_root * factor,
            chip_level: self.chip_level * factor,
            flank_level: self.flank_level * factor,
            ..*self
        }
    }

    /// Rise by friction on a land of width `flank_wear`, K.
    #[inline]
    pub fn flank(&self, flank_wear: N) -> N {
        self.flank_per_root * root(flank_wear + self.land_offset)
    }
}

impl<N: Copy> Heating<N> {
    /// The same over another number type.
    pub(crate) fn map<M: Copy>(&self, mut convert: impl FnMut(N) -> M) -> Heating<M> {
        Heating {
            chip: convert(self.chip),
            flank_per_root: convert(self.flank_per_root),
            chip_level: convert(self.chip_level),
            flank_level: convert(self.flank_level),
            land_offset: convert(self.land_offset),
        }
    }
}

/// `base^exponent`, zero at zero base also for dual numbers (their slope there is infinite).
///
/// A ratio of 1 and an exponent of 0 or 1 are common (a cut at its reference, force in
/// proportion to depth) and cost nothing in plain numbers; the result is the same to the bit.
#[inline]
pub(crate) fn power<N: Number>(base: N, exponent: N) -> N {
    if N::NDERIV == 0 && (base.re() == 1.0 || exponent.re() == 0.0) {
        N::from(1.0)
    } else if N::NDERIV == 0 && exponent.re() == 1.0 {
        base
    } else if base.re() > 0.0 {
        base.powd(exponent)
    } else {
        N::from(if exponent.re() == 0.0 { 1.0 } else { 0.0 })
    }
}

/// Square root, zero at zero also for dual numbers.
#[inline]
pub(crate) fn root<N: Number>(square: N) -> N {
    if square.re() > 0.0 { square.sqrt() } else { N::from(0.0) }
}
