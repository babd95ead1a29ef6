//! Errors as programs read them: a code, a message, and the file and line at fault.

use serde_json::{Value, json};
use std::path::Path;

/// An error as JSON: `code`, `message`, `help`, and `file`, `line` and `column` (from 1) of what is at fault; null where no
/// file is, or where the fault has no line. They are those that the message begins with, as every reader writes them:
/// `FILE:LINE:COLUMN: …`, `FILE:LINE: …`, `FILE: …`, `FILE cannot be read: …` or `cannot read FILE: …`.
pub fn json_error(code: &str, message: &str, help: Option<&str>) -> Value {
    let words = std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned());
    // `--drives=FILE` names a file, too.
    let named: Vec<String> =
        words.map(|word| word.split_once('=').map(|(_, value)| value.to_owned()).unwrap_or(word)).collect();
    let place = place(message, &|name| Path::new(name).exists(), &|name| named.iter().any(|word| word == name));
    json!({
        "code": code,
        "message": message,
        "help": help,
        "file": place.map(|place| place.file),
        "line": place.and_then(|place| place.line),
        "column": place.and_then(|place| place.column),
    })
}

/// The place that a message begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct MessagePlace<'a> {
    file: &'a str,
    line: Option<usize>,
    column: Option<usize>,
}

/// The place at the beginning of a message. What stands there is a file where it `exists`, or where the command named it
/// and the system did not open it. A name may hold colons and spaces of its own: the longest beginning that is a file
/// counts.
fn place<'a>(
    message: &'a str,
    exists: &dyn Fn(&str) -> bool,
    named: &dyn Fn(&str) -> bool,
) -> Option<MessagePlace<'a>> {
    let first = message.lines().next().unwrap_or_default();
    let first = first.strip_prefix("cannot read ").unwrap_or(first);
    let split = |at: usize| (&first[..at], &first[at..]);
    let is_place = |(name, rest): &(&str, &str)| {
        let gone = rest.contains("(os error ") && named(name);
        LINE_WORDS.iter().chain([&" cannot be ", &" is not "]).any(|word| rest.starts_with(word))
            && (gone || exists(name))
    };
    let places = first.char_indices().filter(|(_, sign)| matches!(sign, ':' | ' ' | ',')).map(|(at, _)| split(at));
    let (file, rest) = places.filter(is_place).last()?;
    let Some((line, rest)) = LINE_WORDS.iter().find_map(|word| number(rest.strip_prefix(word)?)) else {
        return Some(MessagePlace { file, line: None, column: None });
    };
    let column = rest.strip_prefix(':').and_then(number).map(|(column, _)| column);
    Some(MessagePlace { file, line: Some(line), column })
}

/// What stands between a file and the number of a line.
const LINE_WORDS: [&str; 4] = [", line ", " line ", ", row ", ":"];

/// A number from 1 at the beginning of a text, and what follows it.
fn number(text: &str) -> Option<(usize, &str)> {
    let end = text.find(|sign: char| !sign.is_ascii_digit()).unwrap_or(text.len());
    let number = text[..end].parse().ok().filter(|number| *number > 0)?;
    Some((number, &text[end..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// File, line and column of a message of a command that was given these files.
    fn told<'a>(message: &'a str, files: &[&str]) -> Option<(&'a str, Option<usize>, Option<usize>)> {
        place(message, &|name| files.contains(&name), &|name| name == "gone.nc")
            .map(|place| (place.file, place.line, place.column))
    }

    #[test]
    fn a_message_that_begins_with_a_file_has_its_place() {
        let files = ["a b.csv", "c:1.nc", "c"];
        assert_eq!(told("a b.csv:102: `nan` is no number", &files), Some(("a b.csv", Some(102), None)));
        assert_eq!(told("c:1.nc:5:7: fanuc: G411", &files), Some(("c:1.nc", Some(5), Some(7))));
        assert_eq!(told("c:3: wrong", &files), Some(("c", Some(3), None)));
        assert_eq!(told("c, line 3: wrong", &files), Some(("c", Some(3), None)));
        assert_eq!(told("a b.csv cannot be read: gone", &files), Some(("a b.csv", None, None)));
        assert_eq!(told("c is not an FMU: no zip", &files), Some(("c", None, None)));
        assert_eq!(told("cannot read gone.nc: No such file (os error 2)", &files), Some(("gone.nc", None, None)));
        assert_eq!(told("c: no rows", &files), Some(("c", None, None)));
        assert_eq!(told("gone.nc: No such file (os error 2)", &files), Some(("gone.nc", None, None)));
    }

    #[test]
    fn a_message_of_no_file_has_no_place() {
        assert_eq!(told("--select \"a\": there is no b:3", &["c"]), None);
        assert_eq!(told("gone.nc: has no teeth", &["c"]), None);
        assert_eq!(told("c has no line 3: wrong", &["c"]), None);
        assert_eq!(told("", &["c"]), None);
        assert_eq!(told("c", &["c"]), None);
        assert_eq!(told("c:0: wrong", &["c"]), Some(("c", None, None)));
    }
}
