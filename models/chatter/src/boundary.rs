//! The boundary of a chart: the ends of the stable intervals over spindle speed, and the curves that they form.

mod curves;

pub use curves::BoundaryCurve;

use crate::axis::Axis;
use crate::error::ChatterError;
use crate::intervals::Crossing;
use crate::{Milling, SpeedVariation, Turning};
use rayon::prelude::*;
use std::collections::BTreeMap;

impl Milling {
    /// The boundary below `greatest` depth (m): the ends of the stable intervals at every speed of the axis, and at
    /// speeds between where ends appear, vanish or change their kind.
    ///
    /// # Errors
    /// As [`Milling::lobes`].
    pub fn boundary(&self, speed: &Axis, greatest: f64) -> Result<Boundary, ChatterError> {
        trace(speed, greatest, |speed| self.at_speed(speed)?.up_to(greatest).charted_intervals(greatest))
    }

    /// [`Milling::boundary`] at speeds that vary about those of the axis.
    ///
    /// # Errors
    /// As [`Milling::boundary`]; a variation out of range.
    pub fn boundary_at_varying_speed(
        &self,
        speed: &Axis,
        variation: SpeedVariation,
        greatest: f64,
    ) -> Result<Boundary, ChatterError> {
        trace(speed, greatest, |speed| {
            let at_speed = self.at_varying_speed(speed, variation)?.up_to(greatest);
            at_speed.at_worst_limit(greatest)?.charted_intervals(greatest)
        })
    }
}

impl Turning {
    /// The boundary below `greatest` width (m): the ends of the stable intervals at every speed of the axis, and at
    /// speeds between where ends appear or vanish.
    ///
    /// # Errors
    /// As [`Turning::stable_intervals`]; an axis that is none.
    pub fn boundary(&self, speed: &Axis, greatest: f64) -> Result<Boundary, ChatterError> {
        trace(speed, greatest, |speed| Ok(self.stable_intervals(speed, greatest)?.ends))
    }
}

/// Parts into which a step of the axis is divided where the boundary folds.
const PARTS: usize = 8;

/// The boundary whose `ends` at a speed (rad/s) are known.
fn trace(
    axis: &Axis,
    greatest: f64,
    ends: impl Fn(f64) -> Result<Vec<Crossing>, ChatterError> + Sync,
) -> Result<Boundary, ChatterError> {
    axis.values("speed")?;
    crate::error::positive("greatest depth", greatest)?;
    let finer = Axis { points: PARTS * (axis.points - 1) + 1, ..*axis };
    let speeds = finer.values("speed")?;
    let column = |i: &usize| -> Result<(usize, Result<BoundaryColumn, BoundaryHole>), ChatterError> {
        let speed = speeds[*i];
        match ends(speed) {
            Ok(crossings) => Ok((*i, Ok(BoundaryColumn { speed, crossings }))),
            Err(error) if error.is_failed_search() => Ok((*i, Err(BoundaryHole { speed, reason: error.to_string() }))),
            Err(error) => Err(error),
        }
    };
    let (mut columns, mut holes) = (BTreeMap::new(), BTreeMap::new());
    let mut wanted: Vec<usize> = (0..speeds.len()).step_by(PARTS).collect();
    while !wanted.is_empty() {
        let traced: Result<Vec<_>, _> = wanted.par_iter().map(column).collect();
        for (i, traced) in traced? {
            match traced {
                Ok(column) => drop(columns.insert(i, column)),
                Err(hole) => drop(holes.insert(i, hole)),
            }
        }
        wanted = folds(&columns);
        // A speed that failed once fails again.
        wanted.retain(|i| !holes.contains_key(i));
    }
    Ok(Boundary { columns: columns.into_values().collect(), holes: holes.into_values().collect(), greatest })
}

/// Speeds halfway between columns whose ends do not continue each other.
fn folds(columns: &BTreeMap<usize, BoundaryColumn>) -> Vec<usize> {
    let kinds = |column: &BoundaryColumn| column.crossings.iter().map(|end| end.limit.kind).collect::<Vec<_>>();
    let neighbours = columns.iter().zip(columns.iter().skip(1));
    neighbours
        .filter(|((i, a), (j, b))| *j - *i > 1 && kinds(a) != kinds(b))
        .map(|((i, _), (j, _))| i + (j - i) / 2)
        .collect()
}

/// The boundary of a chart.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Boundary {
    /// By ascending speed, closer where it bends.
    pub columns: Vec<BoundaryColumn>,
    /// Speeds at which the search for the boundary failed, ascending.
    pub holes: Vec<BoundaryHole>,
    /// Greatest depth that was searched (m).
    pub greatest: f64,
}

/// A spindle speed without boundary.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BoundaryHole {
    /// Spindle speed (rad/s).
    pub speed: f64,
    /// Why the boundary was not found.
    pub reason: String,
}

/// Where the boundary meets one spindle speed.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BoundaryColumn {
    /// Spindle speed (rad/s).
    pub speed: f64,
    /// By ascending depth; stability is lost at the first, third …
    pub crossings: Vec<Crossing>,
}

impl Boundary {
    /// Whether `depth` (m) at `speed` (rad/s) is stable by linear interpolation; `None` off the
    /// chart or where the neighbouring speeds have different numbers of crossings.
    pub fn is_stable(&self, speed: f64, depth: f64) -> Option<bool> {
        let right = self.columns.partition_point(|column| column.speed < speed);
        let (a, b) = (self.columns.get(right.saturating_sub(1))?, self.columns.get(right)?);
        if a.crossings.len() != b.crossings.len() || speed < a.speed {
            return None;
        }
        let share = if b.speed > a.speed { (speed - a.speed) / (b.speed - a.speed) } else { 0.0 };
        let depths = a.crossings.iter().zip(&b.crossings);
        let below = depths.filter(|(x, y)| x.limit.depth + (y.limit.depth - x.limit.depth) * share < depth);
        Some(below.count() % 2 == 0)
    }
}
