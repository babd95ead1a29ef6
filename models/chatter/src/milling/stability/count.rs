//! How many vibrations of a cut grow.

use super::{AtSpeed, Effort};
use crate::error::{ChatterError, within};
use crate::period::{MapStorage, PeriodMap};
use crate::response::LONG_PARTS;
use toolroom_spectral::{LinearMap, dense_eigenvalues};

/// Greatest number of unknowns of a period map whose multipliers are counted (assumption: half a second of dense eigenvalues).
const MOST_COUNTED: usize = 300;

impl AtSpeed<'_> {
    /// Number of Floquet multipliers outside the unit circle at `depth` (m), at the worst place of a path; none where the period map
    /// has so many unknowns that its dense eigenvalues take seconds.
    ///
    /// # Errors
    /// As [`AtSpeed::verdict`].
    pub fn unstable_multipliers(&self, depth: f64) -> Result<Option<usize>, ChatterError> {
        within("depth", depth, 0.0, f64::MAX)?;
        if self.slow()?.is_some() {
            return Ok(None);
        }
        let mut most = 0;
        for place in std::iter::once(self).chain(&self.others) {
            let period = place.assemble(depth, Effort::Boundary.settings().0, LONG_PARTS)?.period;
            let mut storage = MapStorage::default();
            let mut map = PeriodMap::new(&period, depth, &mut storage);
            if map.size() > MOST_COUNTED {
                return Ok(None);
            }
            most = most.max(dense_eigenvalues(map.dense())?.iter().filter(|value| value.norm() > 1.0).count());
        }
        Ok(Some(most))
    }
}
