//! What follows from one life: about how long an edge lasts at one cut.

use super::handbook::{ASSUMED_DEVIATIONS, ASSUMED_EXPONENTS, ReferenceLife};
use toolroom_form::vocabulary;

vocabulary! {
    /// Tool material, which decides how steeply life falls with speed.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ToolMaterial {
        /// Cemented carbide.
        Carbide = "carbide",
        /// High-speed steel.
        Hss = "hss",
        /// Ceramics.
        Ceramic = "ceramic",
    }
}

impl ToolMaterial {
    /// Median Taylor exponent p of speed (textbook values of 1/p: carbide 0.25, high-speed steel 0.125,
    /// ceramics 0.4; recalled).
    pub fn speed_exponent(self) -> f64 {
        match self {
            Self::Carbide => 4.0,
            Self::Hss => 8.0,
            Self::Ceramic => 2.5,
        }
    }
}

/// Standard deviation of ln p (assumption: most textbook values of one tool material lie within a
/// factor 1.35).
pub const SPEED_EXPONENT_DEVIATION: f64 = 0.3;
/// Standard deviation of the logarithm of a life that is known as "about" (assumption: a factor 1.28).
pub const ABOUT: f64 = 0.25;
/// Median scatter of edges in a shop, standard deviation of ln T (Wager & Barash 1971, abstract;
/// Machinery's Handbook 31, p. 139: coefficient of variation 25 to 45 %).
pub const EDGE_SCATTER: f64 = 0.28;
/// Standard deviation of the logarithm of that scatter (assumption: a factor 1.5).
pub const EDGE_SCATTER_DEVIATION: f64 = 0.4;

/// One life with what its tool material makes of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OneLife {
    /// Time in cut until the wear limit, s.
    pub life: f64,
    /// Cutting speed, m/s.
    pub cutting_speed: f64,
    /// Tool material.
    pub tool_material: ToolMaterial,
}

/// A median with the interval that holds nine tenths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Median.
    pub median: f64,
    /// 5th percentile.
    pub low: f64,
    /// 95th percentile.
    pub high: f64,
}

impl OneLife {
    /// The law about the cut at which the life is known.
    pub fn law(&self) -> ReferenceLife {
        ReferenceLife {
            life: self.life,
            speed_exponent: self.tool_material.speed_exponent(),
            feed_exponent: ASSUMED_EXPONENTS[0],
            depth_exponent: ASSUMED_EXPONENTS[1],
        }
    }

    /// Deviations of q and r.
    pub fn deviations() -> [f64; 2] {
        ASSUMED_DEVIATIONS
    }

    /// Life of the median edge at another speed, s.
    ///
    /// ln T is normal about ln T₀ with the deviation [`ABOUT`], less p·ln(v/v₀) with a lognormal p: the
    /// distribution of the sum by quadrature over p.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{OneLife, ToolMaterial};
    /// let known = OneLife { life: 900.0, cutting_speed: 200.0 / 60.0, tool_material: ToolMaterial::Carbide };
    /// let fast = known.life_at(250.0 / 60.0);
    /// assert!((fast.median / 60.0 - 6.03).abs() < 0.06 && (fast.low / 60.0 - 3.05).abs() < 0.03);
    /// let next = known.next_edge_at(250.0 / 60.0);
    /// assert!((next.low / 60.0 - 2.65).abs() < 0.03 && (next.high / 60.0 - 12.47).abs() < 0.12);
    /// ```
    pub fn life_at(&self, cutting_speed: f64) -> Band {
        self.band(cutting_speed, ABOUT)
    }

    /// Life of the next edge at another speed, s: with the scatter of edges, at its median.
    pub fn next_edge_at(&self, cutting_speed: f64) -> Band {
        self.band(cutting_speed, ABOUT.hypot(EDGE_SCATTER))
    }

    /// Width of the interval of ln T at a speed after `edges` tested there, against the width before: the
    /// spread of ln p is taken as small, and the scatter of edges as its median.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{OneLife, ToolMaterial};
    /// let known = OneLife { life: 900.0, cutting_speed: 200.0 / 60.0, tool_material: ToolMaterial::Carbide };
    /// assert!((known.narrowed(250.0 / 60.0, 2) - 0.476).abs() < 1e-3);
    /// ```
    pub fn narrowed(&self, cutting_speed: f64, edges: u32) -> f64 {
        let slope = self.tool_material.speed_exponent() * (cutting_speed / self.cutting_speed).ln();
        let before = ABOUT.powi(2) + (SPEED_EXPONENT_DEVIATION * slope).powi(2);
        let tested = EDGE_SCATTER.powi(2) / f64::from(edges);
        (tested / (before + tested)).sqrt()
    }

    fn band(&self, cutting_speed: f64, deviation: f64) -> Band {
        let ratio = (cutting_speed / self.cutting_speed).ln();
        let exponent = self.tool_material.speed_exponent();
        // Midpoints of equal probability in p; the normal of the level is smooth in between.
        const NODES: u32 = 400;
        let normal = statrs::distribution::Normal::standard();
        use statrs::distribution::ContinuousCDF;
        let centres: Vec<f64> = (0..NODES)
            .map(|k| normal.inverse_cdf((f64::from(k) + 0.5) / f64::from(NODES)))
            .map(|z| self.life.ln() - exponent * (SPEED_EXPONENT_DEVIATION * z).exp() * ratio)
            .collect();
        let below = |ln_life: f64| {
            centres.iter().map(|centre| normal.cdf((ln_life - centre) / deviation)).sum::<f64>() / f64::from(NODES)
        };
        let quantile = |share: f64| {
            let (mut low, mut high) = (self.life.ln() - 60.0, self.life.ln() + 60.0);
            while high - low > 1e-9 {
                let middle = 0.5 * (low + high);
                if below(middle) < share { low = middle } else { high = middle }
            }
            (0.5 * (low + high)).exp()
        };
        Band { median: quantile(0.5), low: quantile(0.05), high: quantile(0.95) }
    }
}
