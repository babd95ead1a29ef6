//! What tuning may change about a policy, and what it is tuned for.
//!
//! Rules can only be compared fairly where each of them runs at its best settings. A policy has at most two settings: one
//! that decides the speed, and one that decides when an edge is changed. Where the policy says so, the rule by which edges
//! are changed is chosen, too.

use crate::{PolicyRule, SpeedRule, ToolChangeRule};
use std::mem::discriminant;
use toolroom_form::significant;
use toolroom_process::unit::convert;

/// A number of a policy that tuning may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// The given constant cutting speed, m/s.
    CuttingSpeed,
    /// The factor on the speed that a rule commands, 1.
    SpeedFactor,
    /// The shadow price of edges, s/m.
    Price,
    /// The path that an edge is to last, m.
    PathPerEdge,
    /// The flank wear at which an edge is changed, m.
    WearLimit,
    /// The cutting time after which an edge is changed, s.
    CuttingTime,
    /// The parts after which an edge is changed, 1.
    Parts,
}

impl Setting {
    /// All settings.
    pub const ALL: [Self; 7] = [
        Self::CuttingSpeed,
        Self::SpeedFactor,
        Self::Price,
        Self::PathPerEdge,
        Self::WearLimit,
        Self::CuttingTime,
        Self::Parts,
    ];

    /// Its key in files, in the table `tune` of a policy.
    pub const fn key(self) -> &'static str {
        match self {
            Self::CuttingSpeed => "cutting_speed",
            Self::SpeedFactor => "speed_factor",
            Self::Price => "price",
            Self::PathPerEdge => "path_per_edge",
            Self::WearLimit => "limit",
            Self::CuttingTime => "time",
            Self::Parts => "parts",
        }
    }

    /// Its SI unit and the unit in which people are told it.
    pub const fn units(self) -> (&'static str, &'static str) {
        match self {
            Self::CuttingSpeed => ("m/s", "m/min"),
            Self::SpeedFactor | Self::Parts => ("1", "1"),
            Self::Price => ("s/m", "s/m"),
            Self::PathPerEdge => ("m", "m"),
            Self::WearLimit => ("m", "mm"),
            Self::CuttingTime => ("s", "min"),
        }
    }

    /// A value (SI) as people are told it and as a file takes it.
    ///
    /// # Examples
    /// ```
    /// use toolroom_scenario::Setting;
    /// assert_eq!(Setting::WearLimit.shown(0.4e-3), "0.4 mm");
    /// assert_eq!(Setting::SpeedFactor.shown(0.85), "0.85");
    /// ```
    pub fn shown(self, value: f64) -> String {
        let (unit, display) = self.units();
        let number = significant(convert(value, unit, display));
        if display == "1" { number } else { format!("{number} {display}") }
    }

    /// A value (SI) rounded to three digits of the unit in which people are told it: what is printed is exactly what was
    /// simulated. Parts are whole.
    pub fn rounded(self, value: f64) -> f64 {
        let (unit, display) = self.units();
        let shown = convert(value, unit, display);
        let rounded = match self {
            Self::Parts => shown.round().max(1.0),
            Self::CuttingSpeed
            | Self::SpeedFactor
            | Self::Price
            | Self::PathPerEdge
            | Self::WearLimit
            | Self::CuttingTime => format!("{shown:.2e}").parse().unwrap_or(shown),
        };
        convert(rounded, display, unit)
    }

    /// Whether it decides when an edge is changed.
    pub const fn is_of_change(self) -> bool {
        match self {
            Self::WearLimit | Self::CuttingTime | Self::Parts => true,
            Self::CuttingSpeed | Self::SpeedFactor | Self::Price | Self::PathPerEdge => false,
        }
    }
}

/// The least and the greatest value of a setting that may be tried, SI.
pub type SettingRange = (Setting, (f64, f64));

/// Whether a policy is tuned, and within what.
#[derive(Clone, Debug, PartialEq)]
pub enum Tunable {
    /// It stands as it is given.
    Given,
    /// Its settings are tuned.
    Free {
        /// Settings that are tuned within a range only.
        ranges: Vec<SettingRange>,
        /// Whether the rule by which edges are changed is tuned, too.
        change: bool,
    },
}

impl Default for Tunable {
    fn default() -> Self {
        Self::Free { ranges: Vec::new(), change: false }
    }
}

impl PolicyRule {
    /// Whether tuning may choose the rule by which edges are changed.
    pub fn chooses_change(&self) -> bool {
        match &self.tune {
            Tunable::Free { change, .. } => *change,
            Tunable::Given => false,
        }
    }

    /// Rules of tool change that tuning may choose among, the policy's own one first: that one alone, or where
    /// [`chooses_change`](Self::chooses_change) by reading wear, by predicting it and by the time in cut as well. Those that
    /// are not its own start at the tool's wear limit, and at `time` (s in cut), without which that rule is left out.
    ///
    /// # Examples
    /// ```
    /// use toolroom_scenario::{PolicyRule, ToolChangeRule, Tunable};
    /// let fixed = PolicyRule::default();
    /// assert_eq!(fixed.change_rules(None), [ToolChangeRule::WearLimit { limit: None }]);
    /// let free = PolicyRule { tune: Tunable::Free { ranges: Vec::new(), change: true }, ..fixed };
    /// assert_eq!(free.change_rules(Some(900.0))[2], ToolChangeRule::CuttingTime { time: 900.0 });
    /// ```
    pub fn change_rules(&self, time: Option<f64>) -> Vec<ToolChangeRule> {
        let all = [
            Some(ToolChangeRule::WearLimit { limit: None }),
            Some(ToolChangeRule::Predicted { limit: None }),
            time.map(|time| ToolChangeRule::CuttingTime { time }),
        ];
        let own = discriminant(&self.tool_change);
        let others = all.into_iter().flatten().filter(|rule| self.chooses_change() && discriminant(rule) != own);
        std::iter::once(self.tool_change).chain(others).collect()
    }

    /// Settings that tuning may move with any of the rules of tool change that it may choose.
    pub fn all_settings(&self) -> Vec<Setting> {
        let mut settings: Vec<Setting> = Vec::new();
        for tool_change in self.change_rules(Some(1.0)) {
            let of_rule = Self { tool_change, ..self.clone() }.settings();
            settings.extend(of_rule.into_iter().filter(|setting| !settings.contains(setting)).collect::<Vec<_>>());
        }
        settings
    }

    /// Settings that tuning may move: that of the speed, where the rule has one, and that of the tool change.
    pub fn settings(&self) -> Vec<Setting> {
        let change = match self.tool_change {
            ToolChangeRule::WearLimit { .. } | ToolChangeRule::Predicted { .. } => Setting::WearLimit,
            ToolChangeRule::CuttingTime { .. } => Setting::CuttingTime,
            ToolChangeRule::PartCount { .. } => Setting::Parts,
        };
        self.speed.entry().setting.into_iter().chain([change]).collect()
    }

    /// The policy with one of its settings at another value, SI. A setting that it does not have changes nothing.
    pub fn with(&self, setting: Setting, value: f64) -> Self {
        let mut rule = self.clone();
        match (setting, &mut rule.speed, &mut rule.tool_change) {
            (Setting::CuttingSpeed, SpeedRule::Constant { cutting_speed: speed }, _) => *speed = value,
            (Setting::SpeedFactor, _, _) => rule.speed_factor = value,
            (Setting::Price, SpeedRule::Productivity { price }, _) => *price = Some(value),
            (Setting::PathPerEdge, SpeedRule::SetIncrement { path_per_edge }, _) => *path_per_edge = value,
            (Setting::WearLimit, _, ToolChangeRule::WearLimit { limit } | ToolChangeRule::Predicted { limit }) => {
                *limit = Some(value);
            }
            (Setting::CuttingTime, _, ToolChangeRule::CuttingTime { time }) => *time = value,
            (Setting::Parts, _, ToolChangeRule::PartCount { parts }) => *parts = value.round() as u32,
            (
                Setting::CuttingSpeed
                | Setting::Price
                | Setting::PathPerEdge
                | Setting::WearLimit
                | Setting::CuttingTime
                | Setting::Parts,
                _,
                _,
            ) => {}
        }
        rule
    }

    /// The change of a scenario file, as after `--set`, that gives this policy a setting at a value, SI.
    pub fn override_of(&self, setting: Setting, value: f64) -> String {
        let value = setting.shown(value);
        let path = format!("policy.{:?}", self.name);
        let change = |value: &str| {
            let rule = self.tool_change.word();
            format!("{path}.tool_change={{ rule = \"{rule}\", {} = {value} }}", setting.key())
        };
        match setting {
            Setting::WearLimit | Setting::CuttingTime => change(&format!("\"{value}\"")),
            Setting::Parts => change(&value),
            Setting::CuttingSpeed | Setting::SpeedFactor | Setting::Price | Setting::PathPerEdge => {
                format!("{path}.{}={value}", setting.key())
            }
        }
    }
}

/// How rules are tuned, the same for all: the section `[tune]`.
#[derive(Clone, Debug, PartialEq)]
pub struct TuneRequest {
    /// The key figure that is tuned for, as in `kpi.csv`.
    pub objective: String,
    /// Simulated replications of the shop for every rule.
    pub budget: u32,
    /// Seed of the tuning; that of the scenario judges.
    pub seed: u64,
    /// Greatest share of edges that may collapse thermally.
    pub collapse: f64,
    /// Greatest share of edges that may be lost in cut, by collapse or chipping; `None`: any.
    pub failure: Option<f64>,
    /// Differences of the objective that do not matter, relative.
    pub indifference: f64,
}

impl Default for TuneRequest {
    /// What a file without the section `[tune]` asks for: cost per part, 600 replications a rule on seed 1001, at most 2 %
    /// of the edges collapsed, 0.1 % that does not matter (assumptions).
    fn default() -> Self {
        Self {
            objective: "cost_per_part".to_owned(),
            budget: 600,
            seed: 1001,
            collapse: 0.02,
            failure: None,
            indifference: 1e-3,
        }
    }
}
