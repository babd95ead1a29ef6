//! Constants of a shop that measurements have moved.

use crate::{Occasion, Scope};
use toolroom_form::vocabulary;

/// To what a calibration belongs.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// Everything.
    Shop,
    /// A tool by its name.
    Tool(String),
    /// A machine by its name; one with a count means all of them.
    Machine(String),
    /// An operation, `part/operation`.
    Operation(String),
    /// A source of jobs, by its part.
    Source(String),
}

impl Target {
    /// As a file has it: `tool insert`, `shop`.
    pub fn words(&self) -> String {
        match self {
            Self::Shop => "shop".to_owned(),
            Self::Tool(name) => format!("tool {name}"),
            Self::Machine(name) => format!("machine {name}"),
            Self::Operation(name) => format!("part {name}"),
            Self::Source(name) => format!("source {name}"),
        }
    }

    /// The target of such words; `None` where they are of another form.
    pub fn of(words: &str) -> Option<Self> {
        let words = words.trim();
        if words == "shop" {
            return Some(Self::Shop);
        }
        let (kind, name) = words.split_once(' ')?;
        let name = name.trim().to_owned();
        match kind {
            "tool" => Some(Self::Tool(name)),
            "machine" => Some(Self::Machine(name)),
            "part" if name.contains('/') => Some(Self::Operation(name)),
            "source" => Some(Self::Source(name)),
            _ => None,
        }
    }

    /// Whether an operation belongs to it; a machine with a count is meant by its common name, too.
    pub fn has(&self, place: &Occasion<'_>) -> bool {
        let is = |key: &str, name: &String| place.get(key) == Some(name);
        match self {
            Self::Shop => true,
            Self::Tool(name) => is("tool", name),
            Self::Machine(name) => {
                // L with a count stands for L1, L2 …
                let numbered = |own: &str| {
                    own.strip_prefix(name.as_str())
                        .is_some_and(|rest| rest.is_empty() || rest.chars().all(|digit| digit.is_ascii_digit()))
                };
                place.get("machine").is_some_and(numbered)
            }
            Self::Operation(name) => name.split_once('/').is_some_and(|(part, operation)| {
                place.get("part") == Some(part) && place.get("operation") == Some(operation)
            }),
            Self::Source(name) => is("part", name),
        }
    }
}

/// How a calibration changes its value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CalibrationShift {
    /// Multiplies it.
    Factor(f64),
    /// Adds to it, SI.
    Summand(f64),
}

/// A constant that measurements have moved: written by `gap apply`, or by hand.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// `group.field` of the process of a tool, or a word of [`Calibration::WORDS`].
    pub parameter: String,
    /// To what it belongs.
    pub target: Target,
    /// What it does.
    pub moved: CalibrationShift,
    /// Standard error of the logarithm of the factor, or of the summand, SI.
    pub standard_error: Option<f64>,
    /// Standard deviation of the same before any data.
    pub prior: Option<f64>,
    /// Operations on which it acts.
    pub scope: Scope,
    /// Who wrote it.
    pub by: String,
}

vocabulary! {
    /// A value of a shop that a calibration can move.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ShopConstant {
        /// Time in cut of an operation, s.
        ProgrammedTime = "programmed_time",
        /// Time of loading and unloading, s.
        HandlingTime = "handling_time",
        /// Time of changing over, s.
        SetupTime = "setup_time",
        /// Time of a change of edges, s.
        ToolChangeTime = "tool_change_time",
        /// Time between breakdowns, s.
        TimeBetweenFailures = "time_between_failures",
        /// Time of a repair, s.
        TimeToRepair = "time_to_repair",
        /// Time between two jobs of a source, s.
        ArrivalInterval = "arrival_interval",
        /// Share of lost edges that spoil the part, and of inspected pieces that are scrapped, 1.
        Scrap = "scrap",
        /// Rate of wear, 1.
        WearRate = "wear_rate",
    }
}

impl ShopConstant {
    /// Unit of a summand.
    const fn unit(self) -> &'static str {
        match self {
            Self::ProgrammedTime
            | Self::HandlingTime
            | Self::SetupTime
            | Self::ToolChangeTime
            | Self::TimeBetweenFailures
            | Self::TimeToRepair
            | Self::ArrivalInterval => "s",
            Self::Scrap | Self::WearRate => "1",
        }
    }

    /// Word and unit.
    const fn entry(self) -> (&'static str, &'static str) {
        (self.word(), self.unit())
    }
}

impl Calibration {
    /// Words of the shop: value, and unit of a summand; `*` stands for a name.
    pub const WORDS: &'static [(&'static str, &'static str)] = &[
        ShopConstant::ProgrammedTime.entry(),
        ShopConstant::HandlingTime.entry(),
        ShopConstant::SetupTime.entry(),
        ShopConstant::ToolChangeTime.entry(),
        ShopConstant::TimeBetweenFailures.entry(),
        ShopConstant::TimeToRepair.entry(),
        ShopConstant::ArrivalInterval.entry(),
        ShopConstant::Scrap.entry(),
        ShopConstant::WearRate.entry(),
        ("gain.*", "1"),
        ("offset.*", "1"),
        ("scatter.*", "1"),
    ];

    /// Group and field of a process that it moves; `None` of a word of the shop.
    pub fn constant(&self) -> Option<(&str, &str)> {
        let (group, field) = self.parameter.split_once('.')?;
        (!matches!(group, "gain" | "offset" | "scatter")).then_some((group, field))
    }
}

/// What all calibrations of a constant of the shop together make of `value` at a place: factors first, then summands.
///
/// ```
/// use toolroom_scenario::{Calibration, CalibrationShift, Occasion, Scope, ShopConstant, Target, calibrated};
/// let one = |moved| Calibration {
///     parameter: ShopConstant::HandlingTime.word().to_owned(), target: Target::Shop, moved,
///     standard_error: None, prior: None, scope: Scope::default(), by: String::new(),
/// };
/// let both = [one(CalibrationShift::Summand(2.0)), one(CalibrationShift::Factor(1.5))];
/// assert_eq!(calibrated(&both, ShopConstant::HandlingTime, &Occasion::default(), 10.0), 17.0);
/// ```
pub fn calibrated(all: &[Calibration], constant: ShopConstant, place: &Occasion<'_>, value: f64) -> f64 {
    moved_by(all, constant.word(), place, value)
}

/// The same of what a sensor reads of a channel: its gain and its offset.
pub fn calibrated_channel(all: &[Calibration], channel: &str, place: &Occasion<'_>, value: f64) -> f64 {
    ["gain", "offset"].iter().fold(value, |value, word| moved_by(all, &format!("{word}.{channel}"), place, value))
}

fn moved_by(all: &[Calibration], parameter: &str, place: &Occasion<'_>, value: f64) -> f64 {
    let (mut factor, mut summand) = (1.0, 0.0);
    for calibration in all.iter().filter(|calibration| {
        calibration.parameter == parameter && calibration.target.has(place) && calibration.scope.holds(place)
    }) {
        match calibration.moved {
            CalibrationShift::Factor(by) => factor *= by,
            CalibrationShift::Summand(by) => summand += by,
        }
    }
    value * factor + summand
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_constant_of_the_shop_is_a_word_of_files() {
        let words: Vec<&str> = Calibration::WORDS.iter().map(|(word, _)| *word).collect();
        assert!(ShopConstant::WORDS.iter().all(|word| words.contains(word)), "{words:?}");
    }
}
