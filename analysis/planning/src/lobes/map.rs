//! Quantities over the whole chart, each as a map of its own.

use super::chart_map::{ChartMap, MapError, MapKind};
use super::cut::Cut;
use super::picture::{axis, limit_lines, lobes};
use super::robust::ASSUMED_SCATTER;
use super::{ChartStudy, LobesFile};
use rayon::prelude::*;
use toolroom_chart::{Axis, Chart, Colour, ColourMap, Dash, HeatMap, Style};
use toolroom_chatter::{ChatterError, CuttingLoad, Milling};
use toolroom_form::significant;

/// Samples behind a map of probabilities: the standard error is 5 % at most.
pub const MAP_SAMPLES: u64 = 100;
/// Most columns and rows of a map of probabilities, whose points cost a hundred verdicts each.
const MOST: (usize, usize) = (80, 50);
/// Seed of these samples.
const SEED: u64 = 1;

impl ChartMap {
    /// The map of `kind` of a study.
    ///
    /// # Errors
    /// [`MapError`]: a cut without that quantity, no feed, a value that the model refuses.
    pub fn new(study: &ChartStudy<'_>, kind: MapKind) -> Result<Self, MapError> {
        let file = study.file;
        let map = kind.word();
        let milling_alone = matches!(kind, MapKind::Sle | MapKind::Ra);
        match &file.cut {
            Cut::Milling(_, None) => {}
            Cut::Milling(_, Some(_)) | Cut::Turning(_, Some(_))
                if matches!(kind, MapKind::PStable | MapKind::Sle | MapKind::Ra) =>
            {
                return Err(MapError::Process { map, of: "cuts at constant speed" });
            }
            Cut::Milling(_, Some(_)) => {}
            Cut::Turning(..) if milling_alone => return Err(MapError::Process { map, of: "milling" }),
            Cut::Turning(..) => {}
            Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => {
                return Err(MapError::Process { map, of: "milling and turning" });
            }
        }
        if kind.needs_feed() && file.feed.is_none() {
            let milling = matches!(file.cut, Cut::Milling(..));
            return Err(MapError::NoFeed {
                map,
                key: if milling { "feed_per_tooth of [force]" } else { "feed_per_rev of [cut]" },
            });
        }
        let mut axes = [file.chart.speed, file.chart.depth];
        if kind == MapKind::PStable {
            axes[0].points = axes[0].points.min(MOST.0);
            axes[1].points = axes[1].points.min(MOST.1);
        }
        let (speeds, depths) = (axes[0].values("speed")?, axes[1].values("depth")?);
        let values = match kind {
            MapKind::Margin => {
                let limits = study.limits_at(&speeds);
                limits.iter().flat_map(|limit| depths.iter().map(move |depth| 1.0 - depth / limit)).collect()
            }
            MapKind::PStable => probabilities(file, &speeds, &depths)?,
            MapKind::Sle => match &file.cut {
                Cut::Milling(cut, _) => study.where_stable(&speeds, &depths, cut.surface_errors(&speeds, &depths)?),
                Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => Vec::new(),
            },
            MapKind::Ra => match &file.cut {
                Cut::Milling(cut, _) => {
                    let stable = study.where_stable(&speeds, &depths, vec![0.0; speeds.len() * depths.len()]);
                    roughness(cut, &speeds, &depths, &stable)?
                }
                Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => Vec::new(),
            },
            MapKind::Force => {
                let forces = loads(file, &speeds, &depths, |load, _| load.greatest_force)?;
                study.where_stable(&speeds, &depths, forces)
            }
            MapKind::Torque => loads(file, &speeds, &depths, |load, _| load.torque)?,
            MapKind::Power => loads(file, &speeds, &depths, |load, ratio| load.power * ratio)?,
            MapKind::Mrr => loads(file, &speeds, &depths, |load, ratio| load.removal_rate * ratio)?,
        };
        let factor = kind.quantity().2;
        Ok(Self { kind, speeds, depths, values: values.into_iter().map(|value| value * factor).collect() })
    }

    /// The map with the stability limit, the limits of the file and the best point on it.
    pub fn picture(&self, study: &ChartStudy<'_>) -> impl Chart + use<> {
        let axes = study.file.cut.axes();
        let (speed, depth) = (axes.speed, axes.depth);
        let (label, unit, _) = self.kind.quantity();
        let rows = self.depths.len();
        let values = (0..rows).flat_map(|row| (0..self.speeds.len()).map(move |column| column * rows + row));
        let values: Vec<f64> = values.map(|i| self.values[i]).collect();
        let columns = self.speeds.iter().map(|value| speed.shown(*value));
        let depths = self.depths.iter().map(|value| depth.shown(*value));
        let shown = [axis(speed), axis(depth), Axis::linear(label, unit)];
        let title = format!("{}: {}", study.file.title, label.to_lowercase());
        let description = format!("{label} over {} and {}.", speed.label.to_lowercase(), depth.label.to_lowercase());
        let mut map = HeatMap::new(title, shown, columns, depths, values).describe(description);
        // An error of the surface has a sign.
        if self.kind == MapKind::Sle {
            map = map.colours(ColourMap::Diverging);
        }
        if self.values.iter().any(|value| !value.is_finite()) {
            map = map.missing(self.kind.missing());
        }
        if self.kind == MapKind::Mrr {
            map = equal_rates(map, self);
        }
        map = map.lobes(&lobes(study));
        for (label, points, style) in limit_lines(study) {
            map = map.line(label, points, style);
        }
        map
    }
}

/// Lines of equal removal rate, which are hyperbolas.
fn equal_rates(mut map: HeatMap, chart_map: &ChartMap) -> HeatMap {
    const LINES: usize = 5;
    let greatest = chart_map.values.iter().copied().fold(0.0, f64::max);
    let (speed, depth) =
        (chart_map.speeds.last().copied().unwrap_or(1.0), chart_map.depths.last().copied().unwrap_or(1.0));
    let rpm = |speed: f64| speed * 30.0 / std::f64::consts::PI;
    let style = Style::nth(0).colour(Colour::Grey).dash(Dash::Dotted);
    for line in 1..=LINES {
        let share = line as f64 / (LINES + 1) as f64;
        let rate = significant(format!("{:.2e}", greatest * share).parse().unwrap_or(0.0));
        let points = chart_map.speeds.iter().map(|at| (rpm(*at), depth * 1e3 * share * speed / at));
        let within: Vec<(f64, f64)> = points.filter(|(_, deep)| *deep <= depth * 1e3).collect();
        let label = if line == 1 { format!("equal removal rate, steps of {rate} cm3/min") } else { String::new() };
        map = map.line(label, within, style);
    }
    map
}

/// A share of the load over the grid, of the load at the first speed and the ratio of a speed to it: torque and greatest
/// force do not depend on the speed, power and removal rate are proportional to it.
fn loads(
    file: &LobesFile,
    speeds: &[f64],
    depths: &[f64],
    of: fn(&CuttingLoad, f64) -> f64,
) -> Result<Vec<f64>, ChatterError> {
    let Some(first) = speeds.first() else { return Ok(Vec::new()) };
    let row: Vec<Option<CuttingLoad>> =
        depths.par_iter().map(|depth| file.load(*first, *depth)).collect::<Result<_, ChatterError>>()?;
    let value = |load: &Option<CuttingLoad>, ratio: f64| load.as_ref().map_or(f64::NAN, |load| of(load, ratio));
    Ok(speeds.iter().flat_map(|speed| row.iter().map(move |load| value(load, speed / first))).collect())
}

/// Ra of the wall (m) over the grid where `stable` is a number; none without depth, and where the surfaces of the teeth overlap by
/// runout.
fn roughness(cut: &Milling, speeds: &[f64], depths: &[f64], stable: &[f64]) -> Result<Vec<f64>, ChatterError> {
    let places = speeds.iter().flat_map(|speed| depths.iter().map(move |depth| (*speed, *depth)));
    let places: Vec<((f64, f64), f64)> = places.zip(stable.iter().copied()).collect();
    let at = |((speed, depth), stable): &((f64, f64), f64)| {
        if stable.is_nan() || *depth == 0.0 {
            return Ok(f64::NAN);
        }
        match cut.forced(*speed, *depth) {
            Ok(forced) => Ok(cut.forced_roughness(*depth, &forced)?.map_or(f64::NAN, |roughness| roughness.ra)),
            Err(ChatterError::OutOfRange { .. }) => Ok(f64::NAN),
            Err(error) => Err(error),
        }
    };
    places.par_iter().map(at).collect()
}

fn probabilities(file: &LobesFile, speeds: &[f64], depths: &[f64]) -> Result<Vec<f64>, ChatterError> {
    let scatter = file.scatter.unwrap_or(ASSUMED_SCATTER);
    match &file.cut {
        Cut::Milling(cut, _) => cut.stability_probabilities(speeds, depths, &scatter, MAP_SAMPLES, SEED),
        Cut::Turning(cut, _) => cut.stability_probabilities(speeds, depths, &scatter, MAP_SAMPLES, SEED),
        Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => Ok(Vec::new()),
    }
}
