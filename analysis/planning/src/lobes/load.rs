//! What a cut asks of machine, tool and drawing, and which limit it breaks.

use super::cut::Cut;
use super::file::{Limits, LobesFile};
use serde_json::{Map, Value, json};
use toolroom_chatter::{ChatterError, CuttingLoad};
use toolroom_form::vocabulary;

vocabulary! {
    /// A quantity that machine, tool or drawing limits.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Limited {
        /// Mean power at the spindle.
        Power = "power",
        /// Mean torque at the spindle.
        Torque = "torque",
        /// Greatest resultant force on the tool.
        Force = "max_force",
        /// Error of the surface location.
        Tolerance = "tolerance",
    }
}

impl Limited {
    /// All, in the order of the file.
    pub const ALL: [Self; 4] = [Self::Power, Self::Torque, Self::Force, Self::Tolerance];

    /// What `limits` allow (SI).
    pub fn of(self, limits: &Limits) -> Option<f64> {
        match self {
            Self::Power => limits.power,
            Self::Torque => limits.torque,
            Self::Force => limits.force,
            Self::Tolerance => limits.surface_error,
        }
    }

    /// The limit in words, with its value, for legends.
    pub fn label(self, limit: f64) -> String {
        let round = |value: f64| toolroom_form::significant((value * 1e6).round() / 1e6);
        match self {
            Self::Power => format!("power {} kW", round(limit * 1e-3)),
            Self::Torque => format!("torque {} N m", round(limit)),
            Self::Force => format!("force {} N", round(limit)),
            Self::Tolerance => format!("surface within {} um", round(limit * 1e6)),
        }
    }
}

/// Depths at which the error of the surface location is worked out to find where it reaches its limit.
const DEPTHS: usize = 200;

impl LobesFile {
    /// Load of the cut at `speed` (rad/s) and `depth` (m); none without feed, and where no chip is cut.
    ///
    /// # Errors
    /// [`ChatterError`] where the model refuses a value.
    pub fn load(&self, speed: f64, depth: f64) -> Result<Option<CuttingLoad>, ChatterError> {
        let Some(feed) = self.feed else { return Ok(None) };
        match &self.cut {
            Cut::Milling(cut, _) => cut.load(speed, depth).map(Some),
            Cut::Turning(cut, _) => cut.load(speed, depth, feed).map(Some),
            Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => Ok(None),
        }
    }

    /// What a stable cut leaves on the wall (m), positive where material is left; none of cuts other than milling with
    /// feed at constant speed.
    ///
    /// # Errors
    /// [`ChatterError`] where the model refuses a value.
    pub fn surface_error(&self, speed: f64, depth: f64) -> Result<Option<f64>, ChatterError> {
        match (&self.cut, self.feed) {
            (Cut::Milling(cut, None), Some(_)) => Ok(cut.surface_errors(&[speed], &[depth])?.first().copied()),
            (Cut::Milling(..) | Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_), _) => Ok(None),
        }
    }

    /// Depths (m) up to which each limit of the file is kept, from depth zero on, at every speed (rad/s); infinite where
    /// it is kept on the whole chart.
    ///
    /// # Errors
    /// [`ChatterError`] where the model refuses a value.
    pub fn limit_depths(&self, speeds: &[f64]) -> Result<Vec<(Limited, Vec<f64>)>, ChatterError> {
        let greatest = self.chart.depth.end;
        let mut found = Vec::new();
        for limited in Limited::ALL {
            let Some(limit) = limited.of(&self.limits) else { continue };
            // Torque and power grow in proportion to the depth.
            let proportional = |share: fn(&CuttingLoad) -> f64| {
                let at = |speed: &f64| {
                    let load = self.load(*speed, greatest)?.map_or(0.0, |load| share(&load));
                    Ok(if load > limit { greatest * limit / load } else { f64::INFINITY })
                };
                speeds.iter().map(at).collect::<Result<Vec<f64>, ChatterError>>()
            };
            let depths = match limited {
                Limited::Power => proportional(|load| load.power)?,
                Limited::Torque => proportional(|load| load.torque)?,
                Limited::Force => {
                    let Some(speed) = speeds.first() else { continue };
                    let force = |depth: f64| Ok(self.load(*speed, depth)?.map_or(0.0, |load| load.greatest_force));
                    vec![reached(force, limit, greatest)?; speeds.len()]
                }
                Limited::Tolerance => self.tolerated(speeds, limit)?,
            };
            found.push((limited, depths));
        }
        Ok(found)
    }

    /// Depths (m) up to which the surface of a stable cut is right within `limit` (m).
    fn tolerated(&self, speeds: &[f64], limit: f64) -> Result<Vec<f64>, ChatterError> {
        let (Cut::Milling(cut, None), Some(_)) = (&self.cut, self.feed) else {
            return Ok(vec![f64::INFINITY; speeds.len()]);
        };
        let depths: Vec<f64> = (0..=DEPTHS).map(|i| self.chart.depth.end * i as f64 / DEPTHS as f64).collect();
        let errors = cut.surface_errors(speeds, &depths)?;
        let first = |errors: &[f64]| {
            let index = errors.iter().position(|error| error.abs() > limit)?;
            // Between two depths the error is taken as a straight line; at depth zero it is zero.
            let (before, after) = (errors[index - 1].abs(), errors[index].abs());
            let share = (limit - before) / (after - before);
            Some(depths[index - 1] + share * (depths[index] - depths[index - 1]))
        };
        Ok(errors.chunks(depths.len()).map(|errors| first(errors).unwrap_or(f64::INFINITY)).collect())
    }

    /// Load and limits at a point for programs; `stable` says whether the surface error counts.
    ///
    /// # Errors
    /// [`ChatterError`] where the model refuses a value.
    pub(super) fn load_json(&self, speed: f64, depth: f64, stable: bool) -> Result<Map<String, Value>, ChatterError> {
        let mut object = Map::new();
        let Some(load) = self.load(speed, depth)? else { return Ok(object) };
        let mut put = |key: &str, value: Value| object.insert(key.to_owned(), value);
        put("removal_rate [cm3/min]", json!(load.removal_rate * 6e7));
        put("power [kW]", json!(load.power * 1e-3));
        put("torque [N m]", json!(load.torque));
        put("max_static_force [N]", json!(load.greatest_force));
        if self.limits == Limits::default() {
            return Ok(object);
        }
        let error = if stable { self.surface_error(speed, depth)? } else { None };
        let broken: Vec<&str> = self.broken(&load, error).into_iter().map(Limited::word).collect();
        put("limits_broken", json!(broken));
        Ok(object)
    }

    /// The limits of the file that a load and a surface error break.
    pub fn broken(&self, load: &CuttingLoad, surface_error: Option<f64>) -> Vec<Limited> {
        let value = |limited: Limited| match limited {
            Limited::Power => load.power,
            Limited::Torque => load.torque,
            Limited::Force => load.greatest_force,
            Limited::Tolerance => surface_error.unwrap_or(0.0).abs(),
        };
        let breaks = |limited: &Limited| limited.of(&self.limits).is_some_and(|limit| value(*limited) > limit);
        Limited::ALL.into_iter().filter(breaks).collect()
    }
}

/// Depth up to `greatest` at which an ascending `value` reaches `limit`, by bisection; infinite where it does not.
fn reached(value: impl Fn(f64) -> Result<f64, ChatterError>, limit: f64, greatest: f64) -> Result<f64, ChatterError> {
    if value(greatest)? <= limit {
        return Ok(f64::INFINITY);
    }
    let (mut low, mut high) = (0.0, greatest);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if value(middle)? > limit { high = middle } else { low = middle }
    }
    Ok(low)
}
