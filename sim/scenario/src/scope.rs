//! On which operations an effect, a calibration or a deviation acts.

use std::borrow::Cow;

/// Names by which a scope can choose operations.
pub const SCOPE_NAMES: [&str; 10] =
    ["machine", "tool", "tool_id", "part", "operation", "material", "lot", "shift", "operator", "coolant"];

/// The operations on which something acts: all conditions hold together, the names of one are alternatives.
///
/// A simulated shop knows machine, tool, edge (`tool_id`), part, operation, lot, shift and coolant of an
/// operation; it has no material and no operator, so what is scoped by them acts on records only.
///
/// ```
/// use toolroom_scenario::{Occasion, Scope};
/// let scope = Scope { names: vec![("machine", vec!["M1".to_owned()])], until: Some(60.0), ..Scope::default() };
/// let mut occasion = Occasion::default();
/// assert!(Scope::default().holds(&occasion) && !scope.holds(&occasion));
/// occasion.set("machine", "M1");
/// occasion.time = Some(59.0);
/// assert!(scope.holds(&occasion));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scope {
    /// Entries of [`SCOPE_NAMES`] in their order, each with the names of which one has to fit.
    pub names: Vec<(&'static str, Vec<String>)>,
    /// First instant, s since the start of the scenario.
    pub from: Option<f64>,
    /// Instant from which on it no longer holds, s since the start of the scenario.
    pub until: Option<f64>,
}

impl Scope {
    /// The scope of one shift.
    pub fn shift(name: &str) -> Self {
        Self { names: vec![("shift", vec![name.to_owned()])], ..Self::default() }
    }

    /// Whether it holds always and everywhere.
    pub fn is_everywhere(&self) -> bool {
        self.names.is_empty() && self.from.is_none() && self.until.is_none()
    }

    /// Whether it holds at `place`; a condition on something that the place does not tell does not hold.
    pub fn holds(&self, place: &Occasion<'_>) -> bool {
        let within = |time: f64| self.from.is_none_or(|from| time >= from) && self.until.is_none_or(|end| time < end);
        let timed = self.from.is_some() || self.until.is_some();
        self.names.iter().all(|(key, names)| place.get(key).is_some_and(|own| names.iter().any(|name| name == own)))
            && (!timed || place.time.is_some_and(within))
    }

    /// Whether an operation can lie in both.
    pub fn meets(&self, other: &Self) -> bool {
        let names = |key| other.names.iter().find(|(own, _)| *own == key).map(|(_, names)| names);
        let alike = |(key, own): &(&'static str, Vec<String>)| {
            names(*key).is_none_or(|theirs| own.iter().any(|name| theirs.contains(name)))
        };
        let before =
            |end: Option<f64>, begin: Option<f64>| matches!((end, begin), (Some(end), Some(begin)) if end <= begin);
        self.names.iter().all(alike) && !before(self.until, other.from) && !before(other.until, self.from)
    }

    /// In words, `machine=M1, shift=S1|S2, from 120 h`; empty where it holds everywhere. Times that are no whole hours are in s.
    pub fn words(&self) -> String {
        let mut words: Vec<String> =
            self.names.iter().map(|(key, names)| format!("{key}={}", names.join("|"))).collect();
        let time = |time: f64| match time / 3600.0 {
            hours if hours.fract() == 0.0 => format!("{hours} h"),
            _ => format!("{time} s"),
        };
        words.extend(self.from.map(|from| format!("from {}", time(from))));
        words.extend(self.until.map(|until| format!("until {}", time(until))));
        words.join(", ")
    }
}

/// What is known of an operation by the names that a scope may ask for.
#[derive(Clone, Debug, Default)]
pub struct Occasion<'a> {
    names: [Option<Cow<'a, str>>; SCOPE_NAMES.len()],
    /// Start of the operation, s since the start of the scenario.
    pub time: Option<f64>,
}

impl<'a> Occasion<'a> {
    /// An operation of which nothing is known but its start, s since the start of the scenario.
    pub fn at(time: f64) -> Self {
        Self { time: Some(time), ..Self::default() }
    }

    /// Tells a name; a key that is none of [`SCOPE_NAMES`] is passed over.
    pub fn set(&mut self, key: &str, name: impl Into<Cow<'a, str>>) {
        if let Some(i) = SCOPE_NAMES.iter().position(|known| *known == key) {
            self.names[i] = Some(name.into());
        }
    }

    /// The name under a key of [`SCOPE_NAMES`].
    pub fn get(&self, key: &str) -> Option<&str> {
        let i = SCOPE_NAMES.iter().position(|known| *known == key)?;
        self.names[i].as_deref()
    }
}

/// Columns under which records hold what a scope may ask for.
const COLUMNS: [(&str, &str); 8] = [
    ("machine", "machine"),
    ("tool_id", "tool_id"),
    ("part", "part_type"),
    ("material", "material"),
    ("lot", "lot"),
    ("shift", "shift"),
    ("operator", "operator"),
    ("coolant", "coolant_id"),
];

impl<'a> Occasion<'a> {
    /// A recorded operation, of which `text` tells the columns; `tool` is the name of its tool in the scenario,
    /// which records do not tell. The operation is the second part of an `operation_id` such as `J12/turn`.
    pub fn recorded(text: &dyn Fn(&str) -> Option<&'a str>, time: Option<f64>, tool: Option<&str>) -> Self {
        let mut occasion = Self { time: time.filter(|time| time.is_finite()), ..Self::default() };
        if let Some(tool) = tool {
            occasion.set("tool", tool.to_owned());
        }
        let text = |column: &str| text(column).filter(|text| !text.is_empty());
        for (key, column) in COLUMNS {
            if let Some(name) = text(column) {
                occasion.set(key, name);
            }
        }
        if let Some(operation) = text("operation_id").and_then(|id| id.split('/').nth(1)) {
            occasion.set("operation", operation);
        }
        occasion
    }
}
