//! The rate of chipping that a share of chipped edges stands for.

use crate::{Chipping, Cut, Pair, WearState};
use toolroom_process::ModelError;

impl Chipping {
    /// The rate at which `share` of nominal edges chip before the wear limit at a constant cut.
    ///
    /// # Errors
    /// Those of [`Pair::run`]; a `share` outside 0..1 and an edge that never wears out have no
    /// solution.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Chipping, Pair, WearState};
    /// let mut pair = Pair::default();
    /// let cut = pair.reference_cut();
    /// pair.chipping = Chipping::default().for_share(&pair, &cut, 0.10).unwrap();
    /// let worn = pair.run(&WearState::default(), |_, _| cut, 1e5, 1e-9).unwrap().state;
    /// assert!((1.0 - (-worn.chipping_hazard).exp() - 0.10).abs() < 1e-6);
    /// ```
    pub fn for_share(&self, pair: &Pair, cut: &Cut, share: f64) -> Result<Self, ModelError> {
        if !(0.0..1.0).contains(&share) {
            return Err(ModelError::NoSolution { quantity: "chipping rate", reason: "the share is not within 0 to 1" });
        }
        let life = pair.life(cut);
        if !(life.path > 0.0 && life.path.is_finite()) {
            return Err(ModelError::NoSolution { quantity: "chipping rate", reason: "the edge does not wear out" });
        }
        let unit = Self { rate: life.path.recip(), ..*self };
        let trial = Pair { chipping: unit, ..pair.clone() };
        let worn = trial.run(&WearState::default(), |_, _| *cut, 10.0 * life.cutting_time, 1e-9)?.state;
        // Hazard grows with the power `shape` of the rate.
        Ok(Self { rate: unit.rate * (-(-share).ln_1p() / worn.chipping_hazard).powf(self.shape.recip()), ..*self })
    }
}
