//! Cuts whose modes change along the path of the tool, judged place by place.

use crate::error::ChatterError;
use crate::path::worst;
use crate::verdict::{StabilityLimit, StabilityVerdict};
use crate::{Milling, Turning};

impl Milling {
    /// The cut at each place of its path that is judged (m), as a cut whose modes do not change; the cut itself without a
    /// position where they do not.
    pub fn places(&self) -> Vec<(Option<f64>, Self)> {
        let Some(path) = &self.along_path else { return vec![(None, self.clone())] };
        let of = |(position, modes)| (Some(position), Self { modes, along_path: None, ..self.clone() });
        path.places().into_iter().map(of).collect()
    }

    /// The cut at the place of its path where a disturbance at `spindle_speed` (rad/s) and `depth` (m) grows most.
    ///
    /// # Errors
    /// As [`Milling::verdict`].
    pub(crate) fn at_worst_place(&self, spindle_speed: f64, depth: f64) -> Result<Self, ChatterError> {
        let position = self.at_speed(spindle_speed)?.worst_position(depth)?;
        let mut places = self.places();
        let worst = places.iter().position(|(place, _)| *place == position).unwrap_or(0);
        Ok(places.swap_remove(worst).1)
    }
}

impl Turning {
    /// The cut at each place of its path that is judged (m), as [`Milling::places`].
    pub fn places(&self) -> Vec<(Option<f64>, Self)> {
        let Some(path) = &self.along_path else { return vec![(None, self.clone())] };
        let of = |(position, modes)| (Some(position), Self { modes, along_path: None, ..self.clone() });
        path.places().into_iter().map(of).collect()
    }

    /// The least of the limits along the path.
    pub(crate) fn least_limit(
        &self,
        limit: impl Fn(&Self) -> Result<StabilityLimit, ChatterError>,
    ) -> Result<StabilityLimit, ChatterError> {
        let mut least: Option<StabilityLimit> = None;
        let mut searched: f64 = f64::INFINITY;
        for (_, cut) in self.places() {
            match limit(&cut) {
                Ok(found) if least.is_none_or(|least| found.depth < least.depth) => least = Some(found),
                Ok(_) => {}
                Err(ChatterError::NoLimit { searched: up_to }) => searched = searched.min(up_to),
                Err(error) => return Err(error),
            }
        }
        least.ok_or(ChatterError::NoLimit { searched })
    }

    /// The verdict with the greatest spectral radius along the path; unstable before stable, where rounding makes them equal.
    pub(crate) fn worst_verdict(
        &self,
        verdict: impl Fn(&Self) -> Result<StabilityVerdict, ChatterError>,
    ) -> Result<StabilityVerdict, ChatterError> {
        let verdicts = self.places().iter().map(|(_, cut)| verdict(cut)).collect::<Result<Vec<_>, _>>()?;
        worst(verdicts).ok_or(ChatterError::NoModes)
    }

    /// The cut at the place of its path where a disturbance at `spindle_speed` (rad/s) and `width` (m) grows most.
    ///
    /// # Errors
    /// As [`Turning::verdict`].
    pub(crate) fn at_worst_place(&self, spindle_speed: f64, width: f64) -> Result<Self, ChatterError> {
        let position = self.worst_position(spindle_speed, width)?;
        let mut places = self.places();
        let worst = places.iter().position(|(place, _)| *place == position).unwrap_or(0);
        Ok(places.swap_remove(worst).1)
    }

    /// The place of its path (m) where a disturbance at `spindle_speed` (rad/s) and `width` (m) grows most; none where the
    /// modes do not change along a path.
    ///
    /// # Errors
    /// As [`Turning::verdict`].
    pub fn worst_position(&self, spindle_speed: f64, width: f64) -> Result<Option<f64>, ChatterError> {
        let mut worst: Option<(Option<f64>, f64)> = None;
        for (position, cut) in self.places() {
            if position.is_none() {
                return Ok(None);
            }
            let radius = cut.verdict_without_margin(spindle_speed, width)?.spectral_radius;
            if worst.is_none_or(|(_, greatest)| radius > greatest) {
                worst = Some((position, radius));
            }
        }
        Ok(worst.and_then(|(position, _)| position))
    }
}
