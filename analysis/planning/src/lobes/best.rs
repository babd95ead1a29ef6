//! The point of a chart that removes most material: stable with a probability, and within all limits.
//!
//! ```text
//!  speeds of the chart ── cap: first limit of stability, limits of the file ──► greatest removal rate possible
//!        │ the most promising first
//!        ▼
//!  depth that would beat the best so far: stable in enough samples? ──► bisection up to the cap
//!        │
//!        ▼
//!  finer speeds around the best ──► fresh samples; a depth that fails them is reduced
//! ```
//!
//! # Not found
//! Depths above the first limit of stability, which islands and pockets leave stable.

use super::best_point::{Best, Bound};
use super::chart_map::MapError;
use super::cut::{Cut, with_unit};
use super::load::Limited;
use super::robust::ASSUMED_SCATTER;
use super::{ChartStudy, LobesFile};
use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_chatter::{ChatterError, Probability, Scatter};
use toolroom_form::significant;

/// Samples behind the search, and those that check its result.
const SAMPLES: u64 = 400;
const CHECKED: u64 = 1000;
/// Seeds of both: the point must hold with samples that it was not chosen by.
const SEEDS: [u64; 2] = [1, 2];
/// Halvings between the depth that beats the best so far and the cap: to 1 % of their difference.
const HALVINGS: u32 = 7;
/// Speeds between two columns of the chart that are tried on either side of the best column.
const FINER: usize = 4;
/// Share of the depth that is taken off where fresh samples do not bear it out.
const LESS: f64 = 0.98;

/// What a reader of the best point has to know.
pub(super) const BEST_NOTE: &str = "The probability is the share of samples with scattered constants that are stable at the \
     point itself; depths above the first limit of stability are not searched.";

/// Removal rate that a column can reach at most, its speed and the greatest depth there.
type Column = (f64, f64, f64, Bound);

impl Best {
    /// The best point of a study that is stable with a probability of `required` at least; none where no column has one.
    ///
    /// # Errors
    /// [`MapError`]: a cut without removal rate, no feed, a value that the model refuses.
    pub fn of(study: &ChartStudy<'_>, required: f64) -> Result<Option<Self>, MapError> {
        let file = study.file;
        let map = "the best point";
        let key = match &file.cut {
            Cut::Milling(_, None) => "feed_per_tooth of [force]",
            Cut::Turning(_, None) => "feed_per_rev of [cut]",
            Cut::Milling(..) | Cut::Turning(..) | Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => {
                return Err(MapError::Process { map, of: "milling and turning at constant speed" });
            }
        };
        if file.feed.is_none() {
            return Err(MapError::NoFeed { map, key });
        }
        let scatter = file.scatter.unwrap_or(ASSUMED_SCATTER);
        let mut columns = columns(study, &study.speeds, &study.limits)?;
        columns.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut found = Search { file, scatter, required, best: None };
        columns.iter().try_for_each(|column| found.column(column))?;
        let Some((_, around, ..)) = found.best else { return Ok(None) };
        let step = (file.chart.speed.end - file.chart.speed.start) / (file.chart.speed.points - 1) as f64;
        let finer =
            (1..=FINER).flat_map(|i| [-1.0, 1.0].map(|side| around + side * step * i as f64 / (FINER + 1) as f64));
        let mut finer: Vec<f64> =
            finer.filter(|speed| (file.chart.speed.start..=file.chart.speed.end).contains(speed)).collect();
        finer.sort_by(f64::total_cmp);
        for column in self::columns(study, &finer, &file.limit_depths(&finer)?)? {
            found.column(&column)?;
        }
        let Some((_, speed, mut depth, mut bound)) = found.best else { return Ok(None) };
        let mut probability = file.probability(speed, depth, &scatter)?;
        while probability.value < required && depth > 1e-3 * file.chart.depth.end {
            depth *= LESS;
            bound = Bound::Stability;
            probability = file.probability(speed, depth, &scatter)?;
        }
        let Some(load) = file.load(speed, depth)? else { return Ok(None) };
        let surface_error = file.surface_error(speed, depth)?;
        let today = match file.points.first() {
            Some(point) => file.load(point.speed, point.depth)?.map(|load| (point.name.clone(), load.removal_rate)),
            None => None,
        };
        Ok(Some(Self { speed, depth, probability, required, scatter, load, surface_error, bound, today }))
    }

    /// Removal rate over that of the first operating point, less one.
    pub fn gain(&self) -> Option<f64> {
        self.today.as_ref().filter(|(_, rate)| *rate > 0.0).map(|(_, rate)| self.load.removal_rate / rate - 1.0)
    }

    /// For programs.
    pub fn json(&self) -> Value {
        json!({
            "spindle_speed [rpm]": self.speed * 30.0 / std::f64::consts::PI,
            "depth_of_cut [mm]": self.depth * 1e3,
            "removal_rate [cm3/min]": self.load.removal_rate * 6e7,
            "p_stable": self.probability.value,
            "p_stable_required": self.required,
            "power [kW]": self.load.power * 1e-3,
            "torque [N m]": self.load.torque,
            "max_static_force [N]": self.load.greatest_force,
            "sle [um]": self.surface_error.map(|error| error * 1e6),
            "bound": self.bound.word(),
            "scatter": {
                "natural_frequency": self.scatter.natural_frequency,
                "damping_ratio": self.scatter.damping_ratio,
                "coefficients": self.scatter.coefficients,
            },
            "compared_with": self.today.as_ref().map(|(name, _)| name),
            "gain": self.gain(),
        })
    }

    /// In a sentence or two.
    pub(super) fn text(&self, file: &LobesFile) -> String {
        let axes = file.cut.axes();
        let (speed, depth) = (with_unit(&axes.speed, self.speed), with_unit(&axes.depth, self.depth));
        let rounded = |value: f64| significant((value * 1e3).round() / 1e3);
        let mut text = format!(
            "{speed}, {depth}: {} cm3/min, {} kW, {} N m, at most {} N",
            rounded(self.load.removal_rate * 6e7),
            rounded(self.load.power * 1e-3),
            rounded(self.load.torque),
            rounded(self.load.greatest_force)
        );
        if let Some(error) = self.surface_error {
            let _ = write!(text, ", surface {} um", rounded(error * 1e6));
        }
        let (value, error) = (self.probability.value, self.probability.standard_error);
        let _ = write!(text, "; P(stable) {value:.3} ± {error:.3}");
        let _ = match self.bound {
            Bound::Stability => write!(text, "; a deeper cut would be stable with less than {}", self.required),
            Bound::Limit(limited) => {
                let limit = limited.of(&file.limits).map_or_else(String::new, |limit| limited.label(limit));
                write!(text, "; a deeper cut would break the limit: {limit}")
            }
            Bound::Chart => write!(text, "; the chart ends at this depth"),
        };
        if let (Some((name, _)), Some(gain)) = (&self.today, self.gain()) {
            let _ = write!(text, "; {:+.0} % against \"{name}\"", 100.0 * gain);
        }
        if file.scatter.is_none() {
            let Scatter { natural_frequency: f, damping_ratio: zeta, coefficients: k } = self.scatter;
            let _ = write!(
                text,
                "; scatter assumed: {} % in frequency, {} % in damping, {} % in coefficients",
                f * 100.0,
                zeta * 100.0,
                k * 100.0
            );
        }
        text
    }
}

impl LobesFile {
    /// Probability of fresh samples that a point is stable.
    fn probability(&self, speed: f64, depth: f64, scatter: &Scatter) -> Result<Probability, ChatterError> {
        match &self.cut {
            Cut::Milling(cut, _) => cut.stability_probability(speed, depth, scatter, CHECKED, SEEDS[1]),
            Cut::Turning(cut, _) => cut.stability_probability(speed, depth, scatter, CHECKED, SEEDS[1]),
            Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => Ok(Probability { value: 0.0, standard_error: 0.0 }),
        }
    }
}

/// Every speed with its cap and what it is.
fn columns(
    study: &ChartStudy<'_>,
    speeds: &[f64],
    limits: &[(Limited, Vec<f64>)],
) -> Result<Vec<Column>, ChatterError> {
    let file = study.file;
    let stable = study.limits_at(speeds);
    let mut columns = Vec::with_capacity(speeds.len());
    for (i, speed) in speeds.iter().enumerate() {
        let (mut cap, mut bound) = (file.chart.depth.end, Bound::Chart);
        if stable[i] < cap {
            (cap, bound) = (stable[i], Bound::Stability);
        }
        for (limited, depths) in limits {
            // Within the limit by more than rounding.
            let kept = depths[i] * (1.0 - 1e-9);
            if kept < cap {
                (cap, bound) = (kept, Bound::Limit(*limited));
            }
        }
        if cap > 0.0 {
            columns.push((file.load(*speed, cap)?.map_or(0.0, |load| load.removal_rate), *speed, cap, bound));
        }
    }
    Ok(columns)
}

/// The best column so far.
struct Search<'a> {
    file: &'a LobesFile,
    scatter: Scatter,
    required: f64,
    best: Option<Column>,
}

impl Search<'_> {
    fn stable(&self, speed: f64, depth: f64) -> Result<bool, ChatterError> {
        let at = (speed, depth);
        match &self.file.cut {
            Cut::Milling(cut, _) => cut.is_probably_stable(at, &self.scatter, SAMPLES, SEEDS[0], self.required),
            Cut::Turning(cut, _) => cut.is_probably_stable(at, &self.scatter, SAMPLES, SEEDS[0], self.required),
            Cut::Chuck(_) | Cut::ChipLag(_) | Cut::Lathe(_) => Ok(false),
        }
    }

    /// Keeps the deepest probable cut of a column where it removes more than the best so far.
    fn column(&mut self, &(most, speed, cap, bound): &Column) -> Result<(), ChatterError> {
        let beaten = self.best.map_or(0.0, |best| best.0);
        if most <= beaten * (1.0 + 1e-9) {
            return Ok(());
        }
        // The removal rate is proportional to the depth.
        let mut low = (cap * beaten / most).max(1e-3 * cap);
        if !self.stable(speed, low)? {
            return Ok(());
        }
        let (mut depth, mut by) = (cap, bound);
        if !self.stable(speed, cap)? {
            let mut high = cap;
            for _ in 0..HALVINGS {
                let middle = 0.5 * (low + high);
                if self.stable(speed, middle)? { low = middle } else { high = middle }
            }
            (depth, by) = (low, Bound::Stability);
        }
        let rate = most * depth / cap;
        if rate > beaten {
            self.best = Some((rate, speed, depth, by));
        }
        Ok(())
    }
}
