//! What can be judged: a milling cut, a turning cut, a workpiece in a chuck.

use rayon::prelude::*;
use std::f64::consts::TAU;
use std::ops::Range;
use toolroom_chatter::paper::{FiveDegrees, Reduced};
use toolroom_chatter::{
    AtSpeed, ChatterError, Lobes, Milling, Mode, SpeedVariation, StabilityLimit, StabilityVerdict, Turning,
};
use toolroom_form::significant;
use toolroom_lobes::{Chart, LobesCut, LobesProcess, axes};
use toolroom_process::unit::convert;

/// A cut without its operating point, with the variation of its spindle speed.
#[derive(Clone, Debug)]
pub enum Cut {
    /// Over spindle speed and depth of cut.
    Milling(Milling, Option<SpeedVariation>),
    /// Over spindle speed and depth of cut.
    Turning(Turning, Option<SpeedVariation>),
    /// Over speed ratio and modulation.
    Chuck(Reduced),
    /// Over lag and cutting stiffness.
    ChipLag(Reduced),
    /// Over speed ratio and modulation.
    Lathe(Box<FiveDegrees>),
}

/// Words and units of the axes.
#[derive(Clone, Copy, Debug)]
pub struct Axes {
    /// The first axis: spindle speed, or what stands for it.
    pub speed: Quantity,
    /// The second axis: depth of cut, or what stands for it.
    pub depth: Quantity,
}

/// One quantity as it is shown and written.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    /// Words on an axis.
    pub label: &'static str,
    /// Name in files.
    pub key: &'static str,
    /// Unit of the numbers in memory.
    pub si: &'static str,
    /// Unit that is shown and written.
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

impl Cut {
    /// What a file says, with the variation of its spindle speed.
    pub fn new(cut: LobesCut, variation: Option<SpeedVariation>) -> Self {
        match cut {
            LobesCut::Milling(cut) => Self::Milling(cut, variation),
            LobesCut::Turning { cut, bar } => {
                // Where the tool is, the file was checked for: the bar gives way there.
                let bending = bar.and_then(|(bar, place)| bar.mode_at(place).ok());
                let cut = match bending {
                    Some(mode) => cut.with_mode(mode),
                    None => cut,
                };
                Self::Turning(cut, variation)
            }
            LobesCut::Chuck(chuck) => Self::Chuck(chuck),
            LobesCut::ChipLag(chuck) => Self::ChipLag(chuck),
            LobesCut::Lathe(lathe) => Self::Lathe(lathe),
        }
    }

    /// What is cut, in a word.
    pub fn process(&self) -> LobesProcess {
        match self {
            Self::Milling(..) => LobesProcess::Milling,
            Self::Turning(..) => LobesProcess::Turning,
            Self::Chuck(_) => LobesProcess::Chuck,
            Self::ChipLag(_) => LobesProcess::ChipLag,
            Self::Lathe(_) => LobesProcess::Lathe,
        }
    }

    /// Words and units of both axes.
    pub fn axes(&self) -> Axes {
        let labels = match self {
            Self::Milling(..) | Self::Turning(..) => ["Spindle speed", "Depth of cut"],
            Self::Chuck(_) | Self::Lathe(_) => ["Speed ratio", "Modulation of the stiffness"],
            Self::ChipLag(_) => ["Chip-formation lag", "Cutting stiffness"],
        };
        let [speed, depth] = axes(self.process());
        let quantity = |label, (key, si, unit)| Quantity { label, key, si, unit };
        Axes { speed: quantity(labels[0], speed), depth: quantity(labels[1], depth) }
    }

    /// Time over which the spectral radius counts.
    pub fn period(&self) -> &'static str {
        match self {
            Self::Milling(_, Some(_)) | Self::Turning(_, Some(_)) => "a mean revolution",
            Self::Milling(cut, None) if cut.cutter.runout == 0.0 && cut.cutter.pitch.is_empty() => "a tooth period",
            Self::Milling(..) | Self::Turning(..) | Self::Lathe(_) => "a revolution",
            Self::Chuck(_) => "a period of the modulation, a third of a revolution",
            Self::ChipLag(_) => "a natural period",
        }
    }

    /// Verdicts over some columns of the chart's grid; a point whose search fails is a hole.
    ///
    /// # Errors
    /// [`ChatterError`] where the chart lies outside the domain of the model.
    pub fn lobes(&self, chart: &Chart, columns: Range<usize>) -> Result<Lobes, ChatterError> {
        let (speeds, depths) = (chart.speed.values("speed")?, chart.depth.values("depth")?);
        let speeds = &speeds[columns];
        match self {
            Self::Milling(cut, None) => cut.lobes(speeds, &depths),
            Self::Milling(cut, Some(variation)) => cut.lobes_at_varying_speed(speeds, *variation, &depths),
            Self::Turning(cut, None) => cut.lobe_chart(speeds, &depths),
            Self::Turning(cut, Some(variation)) => cut.lobe_chart_at_varying_speed(speeds, *variation, &depths),
            Self::Chuck(chuck) => chuck.lobes(speeds, &depths),
            Self::ChipLag(chuck) => chuck.stability_region(speeds, &depths),
            Self::Lathe(lathe) => lathe.lobes(speeds, &depths),
        }
    }

    /// Frequency of the strongest line of the vibration, Hz; in a chuck the one that is nearest to
    /// the natural frequency.
    pub fn chatter_frequency(&self, verdict: &StabilityVerdict) -> f64 {
        let natural = match self {
            Self::Milling(..) | Self::Turning(..) => return verdict.chatter_frequency,
            Self::Chuck(chuck) | Self::ChipLag(chuck) => chuck.natural_frequency() / TAU,
            Self::Lathe(lathe) => lathe.reference_frequency() / TAU,
        };
        let lines = verdict.chatter_frequencies(self.greatest_frequency());
        let nearest = lines.into_iter().min_by(|a, b| (a - natural).abs().total_cmp(&(b - natural).abs()));
        nearest.unwrap_or(verdict.chatter_frequency)
    }

    /// Where on its path, m, the cut is worst at a point, and the least unstable depth at every judged place, searched up to
    /// `greatest`; none where its modes do not change along the path.
    ///
    /// # Errors
    /// As [`Cut::judge`].
    pub(super) fn along_path(&self, speed: f64, depth: f64, greatest: f64) -> Result<Option<AlongPath>, ChatterError> {
        type Limits = Result<Vec<(f64, Option<f64>)>, ChatterError>;
        Ok(match self {
            Self::Milling(cut, variation) if cut.along_path.is_some() => {
                let limit = |(position, cut): (Option<f64>, Milling)| {
                    let limit = found(prepared(&cut, *variation, speed)?.limit(greatest))?;
                    Ok((position.unwrap_or_default(), limit))
                };
                let limits = cut.places().into_par_iter().map(limit).collect::<Limits>()?;
                let loudest = prepared(cut, *variation, speed)?.worst_position(depth)?;
                loudest.map(|loudest| AlongPath::new(limits, loudest))
            }
            Self::Turning(cut, None) if cut.along_path.is_some() => {
                let limit = |(position, cut): (Option<f64>, Turning)| {
                    Ok((position.unwrap_or_default(), found(cut.limit(speed))?.filter(|limit| *limit <= greatest)))
                };
                let limits = cut.places().into_iter().map(limit).collect::<Limits>()?;
                cut.worst_position(speed, depth)?.map(|loudest| AlongPath::new(limits, loudest))
            }
            Self::Milling(..) | Self::Turning(..) | Self::Chuck(_) | Self::ChipLag(_) | Self::Lathe(_) => None,
        })
    }

    /// Twice the highest natural frequency, Hz, up to which the lines of a vibration are listed.
    pub fn greatest_frequency(&self) -> f64 {
        let modes: Vec<Mode> = match self {
            Self::Milling(cut, _) => cut.places().into_iter().flat_map(|(_, cut)| cut.modes).collect(),
            Self::Turning(cut, _) => cut.places().into_iter().flat_map(|(_, cut)| cut.modes).collect(),
            Self::Chuck(chuck) | Self::ChipLag(chuck) => return 2.0 * chuck.natural_frequency() / TAU,
            Self::Lathe(lathe) => return 2.0 * lathe.reference_frequency() / TAU,
        };
        2.0 * modes.iter().map(|mode| mode.natural_frequency).fold(0.0, f64::max)
    }
}

/// What stability is along the path of the tool, at one speed.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct AlongPath {
    /// Place (m) of the least limit; where no place has one, that at which a disturbance at the depth in question grows most.
    pub worst: f64,
    /// Judged places (m) with the least unstable depth (m), where there is one.
    pub limits: Vec<(f64, Option<f64>)>,
}

impl AlongPath {
    fn new(limits: Vec<(f64, Option<f64>)>, loudest: f64) -> Self {
        let limited = limits.iter().filter_map(|(place, limit)| Some((*place, (*limit)?)));
        let worst = limited.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(loudest, |(place, _)| place);
        Self { worst, limits }
    }
}

/// A milling cut at a speed that may vary.
pub(super) fn prepared(
    cut: &Milling,
    variation: Option<SpeedVariation>,
    speed: f64,
) -> Result<AtSpeed<'_>, ChatterError> {
    match variation {
        Some(variation) => cut.at_varying_speed(speed, variation),
        None => cut.at_speed(speed),
    }
}

/// A limit, or none within the depths that were searched.
pub(super) fn found(limit: Result<StabilityLimit, ChatterError>) -> Result<Option<f64>, ChatterError> {
    match limit {
        Ok(limit) => Ok(Some(limit.depth)),
        Err(ChatterError::NoLimit { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

/// A quantity for people, to four decimals.
pub(super) fn with_unit(quantity: &Quantity, value: f64) -> String {
    let number = significant((quantity.shown(value) * 1e4).round() / 1e4);
    if quantity.unit == "1" { number } else { format!("{number} {}", quantity.unit) }
}
