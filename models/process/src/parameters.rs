//! Parameter files: named sets of constants, each with its unit and its source.
//!
//! ```toml
//! schema = 1
//! name = "ni_vk6om"
//! title = "Nickel alloy with VK6OM carbide"
//!
//! [parameters.wear]
//! wear_limit = { value = "0.6 mm", source = "Postnov & Shafikov, range of Fig. 2" }
//! ```

use crate::{AnyRecord, ModelError, unit, unit::UnitError};
use serde::Deserialize;
use std::collections::BTreeMap;
use toml::Spanned;

/// A parameter file as written: groups of entries.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ParameterFile {
    /// Version of the format, 1.
    pub schema: u32,
    /// Name by which scenarios call the set.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// Entries by group and parameter name.
    #[serde(rename = "parameters")]
    pub groups: BTreeMap<String, BTreeMap<String, Spanned<Entry>>>,
}

/// One constant.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Entry {
    /// A bare number for a ratio, else a number with its unit.
    pub value: Spanned<Value>,
    /// Where the value comes from, or `assumption`.
    pub source: String,
}

/// A number, with or without unit.
#[derive(Clone, Debug, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// A ratio, count or flag.
    Number(f64),
    /// A number with its unit.
    Quantity(String),
}

/// Why a parameter file was refused. Lines and columns count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// Not TOML, or not of this form.
    #[error("line {line}, column {column}: {message}")]
    Syntax {
        /// Line.
        line: usize,
        /// Column.
        column: usize,
        /// What the TOML reader says.
        message: String,
    },
    /// A parameter that the group does not have.
    #[error("line {line}: [parameters.{group}] has no parameter `{name}`; it has {known}")]
    Unknown {
        /// Line.
        line: usize,
        /// Group.
        group: String,
        /// What was read.
        name: String,
        /// The names that exist.
        known: String,
    },
    /// A parameter that is not given.
    #[error("[parameters.{group}] lacks `{name}`")]
    Missing {
        /// Group.
        group: String,
        /// The missing parameter.
        name: &'static str,
    },
    /// A value that cannot be read as this parameter.
    #[error("line {line}, column {column}: {name}: {reason}")]
    Unit {
        /// Line.
        line: usize,
        /// Column.
        column: usize,
        /// Parameter.
        name: String,
        /// What is wrong.
        reason: UnitError,
    },
    /// A value outside the parameter's range.
    #[error("line {line}: {reason}")]
    Range {
        /// Line.
        line: usize,
        /// What is wrong.
        reason: ModelError,
    },
}

/// [`place`] of many ascending offsets, in one go through the text: no part of it is read twice, however many offsets stand in
/// one line.
///
/// ```
/// assert_eq!(toolroom_process::parameters::places("ab\ncd\nef", &[1, 4, 4]), [(1, 2), (2, 2), (2, 2)]);
/// ```
pub fn places(text: &str, offsets: &[usize]) -> Vec<(usize, usize)> {
    let (mut line, mut column, mut passed) = (1, 1, 0);
    let place_of = |offset: &usize| {
        let part = &text[passed..boundary(text, *offset).max(passed)];
        passed += part.len();
        let (lines, rest) = match part.rfind('\n') {
            Some(end) => (part.matches('\n').count(), &part[end + 1..]),
            None => (0, part),
        };
        line += lines;
        column = if lines == 0 { column } else { 1 } + rest.chars().count();
        (line, column)
    };
    offsets.iter().map(place_of).collect()
}

/// The last start of a character at or before a byte offset.
fn boundary(text: &str, offset: usize) -> usize {
    let mut boundary = offset.min(text.len());
    while !text.is_char_boundary(boundary) {
        boundary -= 1;
    }
    boundary
}

/// Line and column, from 1, of a byte offset in `text`.
///
/// ```
/// assert_eq!(toolroom_process::parameters::place("ab\ncd", 4), (2, 2));
/// ```
pub fn place(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..boundary(text, offset)];
    let line = before.matches('\n').count() + 1;
    let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
    (line, column)
}

impl ParameterFile {
    /// Reads a parameter file.
    ///
    /// # Errors
    /// [`ParameterError::Syntax`] with line and column.
    pub fn read(text: &str) -> Result<Self, ParameterError> {
        toml::from_str(text).map_err(|error| {
            let (line, column) = place(text, error.span().map_or(0, |span| span.start));
            ParameterError::Syntax { line, column, message: error.message().to_owned() }
        })
    }

    /// Sets every parameter of `record` from the group called `group`; `text` is the file, for
    /// line numbers. A parameter with `len` above one is not allowed in files.
    ///
    /// # Errors
    /// A missing or unknown parameter, a unit that does not fit, a value out of range.
    pub fn fill(&self, text: &str, group: &str, record: &mut dyn AnyRecord) -> Result<(), ParameterError> {
        let none = BTreeMap::new();
        let entries = self.groups.get(group).unwrap_or(&none);
        let fields = record.fields();
        if let Some((name, entry)) = entries.iter().find(|(name, _)| fields.iter().all(|field| field.name != *name)) {
            let known = fields.iter().map(|field| field.name).collect::<Vec<_>>().join(", ");
            let (line, _) = place(text, entry.span().start);
            return Err(ParameterError::Unknown { line, group: group.to_owned(), name: name.clone(), known });
        }
        for (i, field) in fields.iter().enumerate() {
            let entry = entries
                .get(field.name)
                .ok_or_else(|| ParameterError::Missing { group: group.to_owned(), name: field.name })?;
            let value = &entry.get_ref().value;
            let span = value.span().start;
            let si = match value.get_ref() {
                Value::Number(number) => unit::quantity(&number.to_string(), field.unit),
                Value::Quantity(quantity) => unit::quantity(quantity, field.unit),
            }
            .map_err(|reason| {
                // One past the opening quote.
                let (line, column) = place(text, span + 1 + reason.at());
                ParameterError::Unit { line, column, name: field.name.to_owned(), reason }
            })?;
            let (line, _) = place(text, span);
            field.check(si).map_err(|reason| ParameterError::Range { line, reason })?;
            record.set_value(i, si);
        }
        Ok(())
    }

    /// Source of a parameter, where it is given.
    pub fn source(&self, group: &str, name: &str) -> Option<&str> {
        Some(self.groups.get(group)?.get(name)?.get_ref().source.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record;

    record! {
        /// Parameters.
        pub struct Wear {
            /// Wear limit.
            wear_limit: Real["m" => "mm"] = 0.3e-3, 1e-6..=5e-3;
            /// Exponent.
            exponent: Real = 0.25, 0.0..=1.0;
        }
    }

    const HEAD: &str = "schema = 1\nname = \"x\"\ntitle = \"x\"\n[parameters.wear]\n";

    fn fill(body: &str) -> Result<Wear, ParameterError> {
        let text = format!("{HEAD}{body}");
        let mut wear = Wear::default();
        ParameterFile::read(&text)?.fill(&text, "wear", &mut wear)?;
        Ok(wear)
    }

    #[test]
    fn a_set_is_read_in_si() {
        let wear =
            fill("wear_limit = { value = \"0.6 mm\", source = \"s\" }\nexponent = { value = 0.2, source = \"s\" }");
        assert_eq!(wear, Ok(Wear { wear_limit: 0.6e-3, exponent: 0.2 }));
    }

    #[test]
    fn every_fault_names_its_line() {
        let unit =
            fill("wear_limit = { value = \"0.6 min\", source = \"s\" }\nexponent = { value = 0.2, source = \"s\" }");
        assert!(matches!(unit, Err(ParameterError::Unit { line: 5, column: 29, .. })), "{unit:?}");
        let range =
            fill("wear_limit = { value = \"0.6 m\", source = \"s\" }\nexponent = { value = 0.2, source = \"s\" }");
        assert!(matches!(range, Err(ParameterError::Range { line: 5, .. })), "{range:?}");
        let unknown = fill("wear_limt = { value = \"0.6 mm\", source = \"s\" }");
        assert!(matches!(unknown, Err(ParameterError::Unknown { line: 5, .. })), "{unknown:?}");
        assert!(matches!(fill(""), Err(ParameterError::Missing { name: "wear_limit", .. })));
        assert!(matches!(fill("exponent = 3"), Err(ParameterError::Syntax { line: 5, .. })));
    }
}
