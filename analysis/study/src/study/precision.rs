//! How well figures have to be known before a study stops.

use super::Study;
use crate::kpi::{Better, CURRENCY, definitions};
use serde_json::{Value, json};
use std::fmt;
use std::str::FromStr;
use toolroom_process::unit;
use toolroom_statistics::{CONFIDENCE, Interval};

/// Stop rule: the half-width of the 95 % interval of a figure is at most so much, for every policy. Looked at as
/// [`next_look`](Self::next_look) says: looking early and often makes intervals that cover less than they say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Figure of the shop, by its id; `None`: both of [`WATCHED`](Self::WATCHED).
    pub figure: Option<&'static str>,
    /// How wide its interval may be.
    pub width: Width,
}

/// Half-width of an interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Width {
    /// Over the size of the mean, 1.
    Relative(f64),
    /// In the SI unit of the figure.
    Absolute(f64),
}

impl Precision {
    /// Figures that have to be known where none is named.
    pub const WATCHED: [&'static str; 2] = ["parts_per_shift", "cost_per_part"];
    /// Replications before the rule is looked at.
    pub const LEAST: u32 = 10;

    /// The number of replications at which the rule is looked at next when so many are done: 10, and from there on a quarter
    /// more each time, at least 5. It depends on nothing but the number, so that a study that goes on looks where
    /// the whole one does.
    pub fn next_look(replications: u32) -> u32 {
        let mut look = Self::LEAST;
        while look <= replications {
            look = look.saturating_add((look / 4).max(5));
            if look == u32::MAX {
                break;
            }
        }
        look
    }

    /// Of both watched figures, relative.
    pub fn relative(share: f64) -> Self {
        Self { figure: None, width: Width::Relative(share) }
    }

    /// The figures that have to be known.
    pub fn figures(&self) -> Vec<&'static str> {
        self.figure.map_or_else(|| Self::WATCHED.to_vec(), |figure| vec![figure])
    }

    /// Whether an interval is narrow enough.
    pub fn holds(&self, interval: &Interval) -> bool {
        match self.width {
            Width::Relative(share) => interval.within(share),
            Width::Absolute(width) => interval.half_width <= width,
        }
    }
}

impl Study {
    /// What the intervals are called: the rule that ends the study looks at them after every few replications, so that they
    /// cover less often than those of a number that was given.
    pub(crate) fn interval_name(&self) -> &'static str {
        if self.until.is_empty() { "95 % CI" } else { "95 % CI, sequential" }
    }

    /// The stop rule in words; none where the number of replications was given.
    pub(crate) fn sequential_text(&self) -> Option<String> {
        if self.until.is_empty() {
            return None;
        }
        let rules: Vec<String> = self.until.iter().map(Precision::to_string).collect();
        let end = if self.is_precise() { "reached" } else { "not reached" };
        Some(format!(
            "sequential intervals: run until {}, {end} with {} replications; as the number depends on the results, they hold the \
             true value somewhat less often than in 95 %",
            rules.join(" and "),
            self.replications
        ))
    }

    /// The stop rule for programs.
    pub(crate) fn sequential_json(&self) -> Option<Value> {
        let rules: Vec<String> = self.until.iter().map(Precision::to_string).collect();
        (!rules.is_empty()).then(|| json!({ "until": rules, "reached": self.is_precise() }))
    }
}

/// A text that is no precision.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{reason}: the half-width of the {} % interval is due, such as \"half-width 2%\", \"lead_time half-width 2%\" or \"lead_time half-width 5 min\"", 100.0 * CONFIDENCE)]
pub struct NoPrecision {
    reason: String,
}

/// Figures of the shop that may be watched: those of which some size is wanted or none, by id, with their units.
fn figure(id: &str) -> Result<(&'static str, &'static str), NoPrecision> {
    let shop = || definitions().filter(|(_, of_machine)| !of_machine).map(|(own, _)| own);
    shop().find(|own| own.id == id).map(|own| (own.id, own.unit)).ok_or_else(|| {
        let known: Vec<&str> = shop().filter(|own| own.better != Better::Neither).map(|own| own.id).collect();
        NoPrecision { reason: format!("there is no figure \"{id}\" (among others: {})", known.join(", ")) }
    })
}

impl FromStr for Precision {
    type Err = NoPrecision;

    /// `half-width 2%`, `2 %`, `0.02`, `lead_time half-width 2 %`, `lead_time half-width 5 min`.
    fn from_str(text: &str) -> Result<Self, NoPrecision> {
        let none = |reason: &str| NoPrecision { reason: reason.to_owned() };
        let (before, width) = match text.split_once("half-width") {
            Some((before, width)) => (before.trim(), width),
            None => ("", text),
        };
        let width = width.trim_start_matches([' ', '=', '<']).trim();
        let named = if before.is_empty() { None } else { Some(figure(before)?) };
        let share = match width.strip_suffix('%') {
            Some(percent) => percent.trim().parse::<f64>().ok().map(|percent| percent / 100.0),
            None if named.is_none() => width.parse().ok(),
            None => None,
        };
        let found = match (share, named) {
            (Some(share), _) if share > 0.0 && share < 1.0 => Width::Relative(share),
            (Some(_), _) | (None, None) => {
                return Err(none("a half-width over the mean is a share above 0 and below 1"));
            }
            (None, Some((id, si))) => {
                let read = match si {
                    // Of money and numbers there is no other unit.
                    CURRENCY | "1" => width.parse().ok(),
                    si => unit::quantity(width, si).ok(),
                };
                let read = read.filter(|width: &f64| *width > 0.0 && width.is_finite());
                Width::Absolute(read.ok_or_else(|| none(&format!("\"{width}\" is no width of {id}")))?)
            }
        };
        Ok(Self { figure: named.map(|(id, _)| id), width: found })
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(figure) = self.figure {
            write!(f, "{figure} ")?;
        }
        match self.width {
            Width::Relative(share) => write!(f, "half-width {}%", 100.0 * share),
            Width::Absolute(width) => {
                let si = self.figure.and_then(|id| figure(id).ok()).map_or("1", |(_, unit)| unit);
                let si = if si == "1" || si == CURRENCY { String::new() } else { format!(" {si}") };
                write!(f, "half-width {width}{si}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn looks_are_a_quarter_apart() {
        let looks: Vec<u32> =
            std::iter::successors(Some(10), |look| Some(Precision::next_look(*look))).take(10).collect();
        assert_eq!(looks, [10, 15, 20, 25, 31, 38, 47, 58, 72, 90]);
        assert_eq!([0, 9, 11, 89].map(Precision::next_look), [10, 10, 15, 90]);
        assert_eq!(Precision::next_look(u32::MAX), u32::MAX);
    }

    #[test]
    fn a_precision_is_read_as_people_write_it() {
        for text in ["half-width 2%", "half-width 2 %", "2%", "0.02", "half-width=2%"] {
            assert_eq!(text.parse(), Ok(Precision::relative(0.02)), "{text}");
        }
        for text in ["", "half-width", "0", "-2%", "100%", "nan", "inf", "lead_time half-width", "wrong half-width 2%"]
        {
            assert!(text.parse::<Precision>().is_err(), "{text}");
        }
        let of_figure = |width| Precision { figure: Some("lead_time"), width };
        assert_eq!("lead_time half-width 2 %".parse(), Ok(of_figure(Width::Relative(0.02))));
        assert_eq!("lead_time half-width 5 min".parse(), Ok(of_figure(Width::Absolute(300.0))));
        let share = "tardy_share half-width 0.01".parse::<Precision>().unwrap();
        assert_eq!(share.width, Width::Absolute(0.01));
        for text in ["half-width 2%", "lead_time half-width 300 s", "tardy_share half-width 0.01"] {
            assert_eq!(text.parse::<Precision>().unwrap().to_string(), text);
        }
    }
}
