//! What can be judged: a milling cut, a turning cut, a workpiece in a chuck.

use super::file::Chart;
use rayon::prelude::*;
use serde_json::{Map, Value, json};
use std::f64::consts::TAU;
use toolroom_chatter::paper::Reduced;
use toolroom_chatter::{
    Axis, BoundaryColumn, ChatterError, ChatterKind, Lobes, Milling, StabilityLimit, StabilityVerdict, Turning,
};
use toolroom_process::unit::convert;
use toolroom_sim::scenario::lobes::LobesCut;

/// Chip pressure by which the chuck's cutting stiffness is a depth of cut, 300 kgf/mm², Pa.
///
/// # Source
/// Zakovorotny et al., "Parametrical phenomena under on-machine process control": c0 = rho t_p.
const CHIP_PRESSURE: f64 = 300.0 * 9.80665e6;

/// A cut without its operating point.
#[derive(Clone, Debug)]
pub enum Cut {
    Milling(Milling),
    Turning(Turning),
    Chuck(Reduced),
}

/// Verdict at a point and its distance from the boundary.
#[derive(Clone, Debug)]
pub struct Judgement {
    pub speed: f64,
    pub depth: f64,
    pub verdict: StabilityVerdict,
    /// Least unstable depth, m, or modulation of a chuck; `None` if there is none up to
    /// `searched`.
    pub limit: Option<f64>,
    /// Greatest depth that was searched; infinite where the limit is exact.
    pub searched: f64,
}

/// One boundary of a chart: (speed, depth) in the units of [`Chart`].
#[derive(Clone, Debug)]
pub struct Curve {
    pub label: String,
    /// Least unstable depth at each speed; NaN where there is none on the chart.
    pub limit: Vec<(f64, f64)>,
    /// Where the cut becomes stable again or unstable once more.
    pub further: Vec<(f64, f64)>,
}

/// Words and units of the axes.
#[derive(Clone, Copy, Debug)]
pub struct Axes {
    pub speed: Quantity,
    pub depth: Quantity,
}

/// One quantity as it is shown and written.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    pub label: &'static str,
    pub key: &'static str,
    si: &'static str,
    pub unit: &'static str,
}

impl Quantity {
    /// A value in the unit that is shown.
    pub fn shown(&self, value: f64) -> f64 {
        convert(value, self.si, self.unit)
    }

    /// Name of a column or key, with the unit.
    pub fn column(&self) -> String {
        if self.unit == "1" { self.key.to_owned() } else { format!("{} [{}]", self.key, self.unit) }
    }
}

impl From<LobesCut> for Cut {
    fn from(cut: LobesCut) -> Self {
        match cut {
            LobesCut::Milling(cut) => Self::Milling(cut),
            LobesCut::Turning { cut, bar } => {
                // Where the tool is, the file was checked for: the bar gives way there.
                let bending = bar.and_then(|(bar, place)| bar.mode_at(place).ok());
                Self::Turning(Turning { modes: cut.modes.into_iter().chain(bending).collect(), ..cut })
            }
            LobesCut::Chuck(chuck) => Self::Chuck(chuck),
        }
    }
}

impl Cut {
    pub fn process(&self) -> &'static str {
        match self {
            Self::Milling(_) => "milling",
            Self::Turning(_) => "turning",
            Self::Chuck(_) => "chuck",
        }
    }

    pub fn axes(&self) -> Axes {
        if matches!(self, Self::Chuck(_)) {
            let speed = Quantity { label: "Speed ratio", key: "speed_ratio", si: "1", unit: "1" };
            let depth = Quantity { label: "Modulation of the stiffness", key: "modulation", si: "1", unit: "1" };
            return Axes { speed, depth };
        }
        let speed = Quantity { label: "Spindle speed", key: "spindle_speed", si: "rad/s", unit: "rpm" };
        let depth = Quantity { label: "Depth of cut", key: "depth_of_cut", si: "m", unit: "mm" };
        Axes { speed, depth }
    }

    /// Verdict, limit and margin at a point; limits are searched up to the chart's greatest depth
    /// and at least to twice `depth`.
    pub fn judge(&self, speed: f64, depth: f64, chart: &Chart) -> Result<Judgement, ChatterError> {
        let searched = chart.depth.end.max(2.0 * depth);
        let (verdict, limit, searched) = match self {
            Self::Milling(cut) => {
                let mut at_speed = cut.at_speed(speed)?;
                (at_speed.verdict(depth)?, found(at_speed.limit(searched))?, searched)
            }
            Self::Turning(cut) => (cut.verdict(speed, depth)?, found(cut.limit(speed))?, f64::INFINITY),
            Self::Chuck(chuck) => (chuck.verdict(depth, speed)?, chuck.critical_modulation(speed, searched)?, searched),
        };
        Ok(Judgement { speed, depth, verdict, limit, searched })
    }

    /// Verdicts over the grid of the chart.
    pub fn lobes(&self, chart: &Chart) -> Result<Lobes, ChatterError> {
        match self {
            Self::Milling(cut) => cut.lobes(&chart.speed, &chart.depth),
            Self::Turning(cut) => cut.lobe_chart(&chart.speed, &chart.depth),
            Self::Chuck(chuck) => chuck.lobes(&chart.speed, &chart.depth),
        }
    }

    /// The boundary on the chart, and those of other lags.
    pub fn boundaries(&self, chart: &Chart) -> Result<Vec<Curve>, ChatterError> {
        let greatest = chart.depth.end;
        match self {
            Self::Milling(cut) => {
                let boundary = cut.boundary(&chart.speed, greatest, chart.depth.points)?;
                let depth = |column: &BoundaryColumn, i: usize| {
                    column.crossings.get(i).map_or(f64::NAN, |crossing| crossing.limit.depth)
                };
                let limit = boundary.columns.iter().map(|column| (column.speed, depth(column, 0))).collect();
                let further = |column: &BoundaryColumn| {
                    let speed = column.speed;
                    let depths: Vec<f64> = column.crossings.iter().skip(1).map(|c| c.limit.depth).collect();
                    depths.into_iter().map(move |depth| (speed, depth))
                };
                let further = boundary.columns.iter().flat_map(further).collect();
                Ok(vec![Curve { label: "stability limit".to_owned(), limit, further }])
            }
            Self::Turning(cut) => {
                let on_chart = |limit: Option<f64>| limit.filter(|depth| *depth <= greatest).unwrap_or(f64::NAN);
                let at = |speed| Ok((speed, on_chart(found(cut.limit(speed))?)));
                let limit = finer(&chart.speed).values("spindle_speed")?.into_par_iter().map(at);
                let limit = limit.collect::<Result<_, _>>()?;
                Ok(vec![Curve { label: "stability limit".to_owned(), limit, further: Vec::new() }])
            }
            Self::Chuck(chuck) => {
                let speeds = finer(&chart.speed).values("speed_ratio")?;
                let others = chart.lags.iter().copied().filter(|lag| *lag != chuck.lag);
                let lags = std::iter::once(chuck.lag).chain(others);
                let curve = |lag: f64| {
                    let chuck = Reduced { lag, ..*chuck };
                    let at = |eta: &f64| Ok((*eta, chuck.critical_modulation(*eta, greatest)?.unwrap_or(f64::NAN)));
                    let limit = speeds.par_iter().map(at).collect::<Result<_, _>>()?;
                    let label = format!("limit at lag {} us", toolroom_sim::scenario::file::significant(lag * 1e6));
                    Ok(Curve { label, limit, further: Vec::new() })
                };
                lags.map(curve).collect()
            }
        }
    }

    /// The verdict for programs.
    pub fn json(&self, judgement: &Judgement) -> Map<String, Value> {
        let Judgement { speed, depth, verdict, limit, searched } = judgement;
        let axes = self.axes();
        let mut object = Map::new();
        let mut put = |key: &str, value: Value| object.insert(key.to_owned(), value);
        put("process", self.process().into());
        put(&axes.speed.column(), axes.speed.shown(*speed).into());
        put(&axes.depth.column(), axes.depth.shown(*depth).into());
        put("spectral_radius", verdict.spectral_radius.into());
        put("stable", verdict.stable.into());
        put("type", word(verdict.kind).into());
        let finite = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
        if let Self::Chuck(chuck) = self {
            // Without modulation, by Routh; the limit of the modulation stands beside it.
            let depth = chuck.cutting_stiffness_limit() / CHIP_PRESSURE;
            put("stability_limit [mm]", finite(depth * 1e3));
            put("margin", json!(verdict.margin));
            put("critical_modulation", json!(limit));
            put("modulation_margin", json!(judgement.margin()));
            let spindle = chuck.natural_frequency() * speed / 3.0;
            put("spindle_speed [rpm]", convert(spindle, "rad/s", "rpm").into());
        } else {
            put("stability_limit [mm]", json!(limit.map(|depth| depth * 1e3)));
            put("margin", json!(judgement.margin()));
            put("searched [mm]", finite(searched * 1e3));
        }
        put("chatter_frequency [Hz]", self.chatter_frequency(verdict).into());
        put("chatter_frequencies [Hz]", json!(verdict.chatter_frequencies(self.greatest_frequency())));
        put("residual", verdict.residual.into());
        object
    }

    /// Frequency of the strongest line of the vibration, Hz; in a chuck the one that is nearest to
    /// the natural frequency.
    pub fn chatter_frequency(&self, verdict: &StabilityVerdict) -> f64 {
        let Self::Chuck(chuck) = self else { return verdict.chatter_frequency };
        let natural = chuck.natural_frequency() / TAU;
        let lines = verdict.chatter_frequencies(self.greatest_frequency());
        let nearest = lines.into_iter().min_by(|a, b| (a - natural).abs().total_cmp(&(b - natural).abs()));
        nearest.unwrap_or(verdict.chatter_frequency)
    }

    /// Twice the highest natural frequency, Hz, up to which the lines of a vibration are listed.
    fn greatest_frequency(&self) -> f64 {
        let modes = match self {
            Self::Milling(cut) => &cut.modes,
            Self::Turning(cut) => &cut.modes,
            Self::Chuck(chuck) => return 2.0 * chuck.natural_frequency() / TAU,
        };
        2.0 * modes.iter().map(|mode| mode.natural_frequency).fold(0.0, f64::max)
    }
}

impl Judgement {
    /// `1 − depth/limit`; `None` without limit.
    pub fn margin(&self) -> Option<f64> {
        // A cut that is unstable at depth zero has no margin to speak of.
        self.limit.filter(|limit| *limit > 0.0).map(|limit| 1.0 - self.depth / limit)
    }
}

/// Four times as many steps: lobes and tongues are a few percent of the speed wide.
fn finer(axis: &Axis) -> Axis {
    Axis { points: 4 * axis.points - 3, ..*axis }
}

/// A limit, or none within the depths that were searched.
fn found(limit: Result<StabilityLimit, ChatterError>) -> Result<Option<f64>, ChatterError> {
    match limit {
        Ok(limit) => Ok(Some(limit.depth)),
        Err(ChatterError::NoLimit { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

pub fn word(kind: ChatterKind) -> &'static str {
    match kind {
        ChatterKind::Stable => "stable",
        ChatterKind::Hopf => "hopf",
        ChatterKind::Flip => "flip",
        ChatterKind::Parametric => "parametric",
    }
}
