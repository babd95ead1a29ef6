//! Faults of a file that a model reads, with their places.

use std::fmt::Display;

/// A file that was refused; all faults that are known.
#[derive(Debug)]
pub struct FaultyFile {
    pub file: String,
    pub text: String,
    pub faults: Vec<Placed>,
}

/// A fault at a line and column, from 1.
#[derive(Debug)]
pub struct Placed {
    /// What `toolroom explain` takes.
    pub code: &'static str,
    pub line: usize,
    pub column: usize,
    pub message: String,
    /// The likely fix, where the message does not say it.
    pub fix: Option<String>,
}

impl Placed {
    pub fn new(code: &'static str, (line, column): (usize, usize), message: impl Display) -> Self {
        Self { code, line, column, message: message.to_string(), fix: None }
    }
}

impl FaultyFile {
    pub fn new(file: impl Display, text: &str, faults: Vec<Placed>) -> Self {
        Self { file: file.to_string(), text: text.to_owned(), faults }
    }

    /// From a place to the end of its line, as bytes of the text.
    pub fn span(&self, fault: &Placed) -> std::ops::Range<usize> {
        let lines = self.text.split_inclusive('\n');
        let start: usize = lines.take(fault.line.saturating_sub(1)).map(str::len).sum();
        let line = self.text[start..].lines().next().unwrap_or_default();
        let within = line.char_indices().nth(fault.column.saturating_sub(1)).map_or(0, |(at, _)| at);
        start + within..start + line.len()
    }
}

/// Line and column of a key of a TOML text, else of the header of its table, else of the start.
pub fn key_place(text: &str, table: &str, key: &str) -> (usize, usize) {
    let header = |line: &str| line.trim_start().trim_start_matches('[').starts_with(&format!("{table}]"));
    let assigns =
        |line: &str| line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='));
    let at = |wanted: &dyn Fn(&str) -> bool| text.lines().position(wanted).map(|line| (line + 1, 1));
    at(&assigns).or_else(|| at(&header)).unwrap_or((1, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_found_in_any_text() {
        let text = "schema = 1\n[limits]\nstock = \"9 µm\" # no\n";
        let file = FaultyFile::new("f", text, vec![Placed::new("x", (3, 12), "y"), Placed::new("x", (9, 9), "y")]);
        assert_eq!(&text[file.span(&file.faults[0])], "µm\" # no");
        assert_eq!(file.span(&file.faults[1]), text.len()..text.len());
        assert_eq!(key_place(text, "limits", "stock"), (3, 1));
        assert_eq!(key_place(text, "limits", "size_error"), (2, 1));
        assert_eq!(key_place("", "limits", "stock"), (1, 1));
    }
}
