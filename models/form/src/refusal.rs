//! What a model refuses of a file whose form is right.

use crate::error::FaultList;
use crate::fault::{ContentFault, Fault, Problem};
use std::fmt::Display;
use std::sync::Arc;

/// A fault that only a model finds: limits that conflict, a trial that cannot be.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{message}")]
pub struct Refusal {
    /// What `toolroom explain` takes.
    pub code: &'static str,
    /// What is wrong.
    pub message: String,
    /// The likely fix, where the message does not say it.
    pub fix: Option<String>,
}

impl Refusal {
    /// A refusal that says its fix itself.
    pub fn new(code: &'static str, message: impl Display) -> Self {
        Self { code, message: message.to_string(), fix: None }
    }
}

impl ContentFault for Refusal {
    fn code(&self) -> &'static str {
        self.code
    }

    fn fix(&self) -> Option<String> {
        self.fix.clone()
    }
}

impl FaultList {
    /// A text that a model refuses; each refusal stands at a line and column, from 1, and is about the rest of that line.
    pub fn refused(file: &str, text: &str, refusals: impl IntoIterator<Item = ((usize, usize), Refusal)>) -> Self {
        let problem = |(place, refusal): ((usize, usize), Refusal)| Problem {
            fault: Fault::Content(Arc::new(refusal)),
            span: rest_of_line(text, place),
        };
        let problems = refusals.into_iter().map(problem).collect();
        Self { file: file.to_owned(), text: text.to_owned(), overrides: Vec::new(), problems }
    }
}

/// From a place to the end of its line, as bytes of the text.
fn rest_of_line(text: &str, (line, column): (usize, usize)) -> std::ops::Range<usize> {
    let start: usize = text.split_inclusive('\n').take(line.saturating_sub(1)).map(str::len).sum();
    let rest = text[start..].lines().next().unwrap_or_default();
    let within = rest.char_indices().nth(column.saturating_sub(1)).map_or(0, |(at, _)| at);
    start + within..start + rest.len()
}

/// Line and column of a key of a TOML text, else of the header of its table, else of the start.
pub fn key_place(text: &str, table: &str, key: &str) -> (usize, usize) {
    let header = |line: &str| line.trim_start().trim_start_matches('[').starts_with(&format!("{table}]"));
    let assigns =
        |line: &str| line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='));
    let first = |wanted: &dyn Fn(&str) -> bool| text.lines().position(wanted).map(|line| (line + 1, 1));
    first(&assigns).or_else(|| first(&header)).unwrap_or((1, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_found_in_any_text() {
        let text = "schema = 1\n[limits]\nstock = \"9 µm\" # no\n";
        let refused =
            FaultList::refused("f", text, [((3, 12), Refusal::new("x", "y")), ((9, 9), Refusal::new("x", "y"))]);
        let [within, beyond] = [&refused.problems[0], &refused.problems[1]];
        assert_eq!(&text[within.span.clone()], "µm\" # no");
        assert_eq!(beyond.span, text.len()..text.len());
        let place = refused.place(within);
        assert_eq!((place.line, place.column, within.fault.code()), (3, 12, "x"));
        let each: Vec<_> = refused.problems.iter().map(|problem| refused.place(problem)).collect();
        assert_eq!(refused.places(), each);
        assert_eq!(key_place(text, "limits", "stock"), (3, 1));
        assert_eq!(key_place(text, "limits", "size_error"), (2, 1));
        assert_eq!(key_place("", "limits", "stock"), (1, 1));
    }
}
