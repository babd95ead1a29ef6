//! Errors as programs read them: a code, a message, and the file and line at fault.

use serde_json::{Value, json};
use std::borrow::Cow;
use toolroom_location::Location;

/// Longest word that is printed whole, in characters. Assumption: longer than any name that a person writes.
const LONGEST_WORD: usize = 300;
/// The same of a path, which Linux bounds at so many bytes.
const LONGEST_PATH: usize = 4096;
/// Characters of a longer word that are printed. Assumption: enough to find it in the file.
const SHOWN: usize = 80;

/// `text` with the beginning of a word in the place of one that nobody would read: that of a file without blanks is as long as the
/// file.
pub fn bounded(text: &str) -> Cow<'_, str> {
    let excess = |word: &str| {
        let bound = if word.contains(['/', '\\']) { LONGEST_PATH } else { LONGEST_WORD };
        // Bytes bound characters: most words are never counted.
        (word.len() > bound).then(|| word.chars().count()).filter(|count| *count > bound)
    };
    if text.split_whitespace().all(|word| excess(word).is_none()) {
        return Cow::Borrowed(text);
    }
    let pieces = text.split_inclusive(char::is_whitespace).map(|piece| {
        let word = piece.trim_end();
        match excess(word) {
            Some(count) => {
                let beginning: String = word.chars().take(SHOWN).collect();
                Cow::Owned(format!("{beginning}… ({count} characters){}", &piece[word.len()..]))
            }
            None => Cow::Borrowed(piece),
        }
    });
    Cow::Owned(pieces.collect())
}

/// An error as JSON: `code`, `message`, `help`, and `file`, `line` and `column` (from 1) of what is at fault; null where no
/// file is, or where the fault has no line.
pub fn json_error(code: &str, message: &str, help: Option<&str>, at: Option<&Location>) -> Value {
    json!({
        "code": code,
        "message": bounded(message),
        "help": help,
        "file": at.map(|at| &at.file),
        "line": at.and_then(|at| at.line),
        "column": at.and_then(|at| at.column),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_word_that_nobody_would_read_is_told_by_its_beginning() {
        let long = "ä".repeat(100_000);
        let told = bounded(&format!("`x` is\nnot {long}\tknown")).into_owned();
        assert_eq!(told, format!("`x` is\nnot {}… (100000 characters)\tknown", "ä".repeat(80)));
        let path = format!("/{}", "a/".repeat(1000));
        assert_eq!(bounded(&path), path);
    }

    #[test]
    fn the_place_is_data_and_never_taken_from_the_message() {
        let error = json_error("argument", "c.toml:3: wrong", None, None);
        assert_eq!([&error["file"], &error["line"], &error["column"]], [&Value::Null; 3]);
        let error = json_error("argument", "wrong", None, Some(&Location::column("a b:1.nc", 5, 7)));
        assert_eq!((&error["file"], &error["line"], &error["column"]), (&json!("a b:1.nc"), &json!(5), &json!(7)));
        let error = json_error("argument", "wrong", None, Some(&Location::of("c")));
        assert_eq!((&error["file"], &error["line"]), (&json!("c"), &Value::Null));
    }
}
