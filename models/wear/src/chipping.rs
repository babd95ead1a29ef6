//! Chipping of the edge as a hazard that accumulates with path.

use crate::temperature::power;
use toolroom_process::{Number, record};

record! {
    /// Weibull hazard in cutting path, raised by flank wear:
    /// `d hazard / d path = shape · rate · (rate·path)^(shape - 1) · (1 + (h/reference_land)²)`.
    /// The edge chips when the accumulated hazard reaches its resistance, an Exp(1) number.
    ///
    /// # Source
    /// Assumption; shape 1.5, ageing with the land.
    pub struct Chipping {
        /// Inverse of the Weibull scale in path; 0 switches chipping off.
        rate: Real["1/m" => "1/km"] = 0.0, 0.0..=10.0;
        /// Weibull shape.
        shape: Real = 1.5, 1.0..=10.0;
        /// Land at which the hazard has doubled.
        reference_land: Real["m" => "mm"] = 0.4e-3, 1e-6..=1e6;
    }
}

impl<N: Number> Chipping<N> {
    /// Hazard per path at `path` since the edge was new, 1/m; `added_rate` comes on top of
    /// [`Chipping::rate`].
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Chipping;
    /// let chipping = Chipping { rate: 1e-3, ..Chipping::default() };
    /// assert!((chipping.hazard_per_path(0.0, 1000.0, 0.4e-3) - 3e-3).abs() < 1e-12);
    /// ```
    #[inline]
    pub fn hazard_per_path(&self, added_rate: N, path: N, flank_wear: N) -> N {
        let rate = self.rate + added_rate;
        let land = flank_wear / self.reference_land;
        self.shape * rate * power(rate * path, self.shape - 1.0) * (land * land + 1.0)
    }
}
