//! Errors as programs read them: a code, a message, and the file and line at fault.

use serde_json::{Value, json};
use toolroom_location::Location;

/// An error as JSON: `code`, `message`, `help`, and `file`, `line` and `column` (from 1) of what is at fault; null where no
/// file is, or where the fault has no line.
pub fn json_error(code: &str, message: &str, help: Option<&str>, at: Option<&Location>) -> Value {
    json!({
        "code": code,
        "message": message,
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
    fn the_place_is_data_and_never_taken_from_the_message() {
        let error = json_error("argument", "c.toml:3: wrong", None, None);
        assert_eq!([&error["file"], &error["line"], &error["column"]], [&Value::Null; 3]);
        let error = json_error("argument", "wrong", None, Some(&Location::column("a b:1.nc", 5, 7)));
        assert_eq!((&error["file"], &error["line"], &error["column"]), (&json!("a b:1.nc"), &json!(5), &json!(7)));
        let error = json_error("argument", "wrong", None, Some(&Location::of("c")));
        assert_eq!((&error["file"], &error["line"]), (&json!("c"), &Value::Null));
    }
}
