//! A page of reference for each kind of file, in Markdown.

use crate::{FileKind, SchemaSource};
use serde_json::Value;
use std::fmt::Write;

impl FileKind {
    /// What such a file is, how to begin one, and every key of it.
    pub fn reference(&self) -> String {
        let mut text = format!("# Files of the kind `{}`\n\n{}.\n\n", self.word, self.doc);
        if !self.signs.is_empty() {
            let signs: Vec<String> = self.signs.iter().map(|sign| format!("`{sign}`")).collect();
            let _ = writeln!(text, "Such a file is told by one of these at its top: {}.\n", signs.join(", "));
        }
        let _ = writeln!(text, "To begin one:\n\n```sh\ntoolroom new {} my-{0}\ncd my-{0}", self.word);
        for command in self.sample().next {
            let _ = writeln!(text, "{command}");
        }
        text.push_str("```\n\n");
        match self.form {
            SchemaSource::By(form) => text.push_str(&toolroom_form::reference(form)),
            SchemaSource::ByOneOf(forms) => {
                for form in forms {
                    text.push_str(&toolroom_form::reference(form));
                }
            }
            SchemaSource::Text(_) => text.push_str(&of_schema(&self.schema())),
            SchemaSource::Rows(_) => text.push_str(&of_rows(&self.schema())),
        }
        if self.read.is_some() && !matches!(self.form, SchemaSource::Text(_) | SchemaSource::Rows(_)) {
            text.push_str("A number stands with its unit in quotes, `\"2 min\"`; ratios may stand bare.\n");
        }
        text
    }
}

/// Columns of tables, kind by kind.
fn of_rows(schema: &Value) -> String {
    let mut text =
        "Units stand in the header, in brackets; other units of the same quantity are read, too.\n\n".to_owned();
    for kind in schema["anyOf"].as_array().into_iter().flatten() {
        let required: Vec<&str> = kind["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
        let _ = write!(text, "## {}\n\n| column | required |\n|---|---|\n", kind["title"].as_str().unwrap_or("–"));
        for (name, _) in kind["properties"].as_object().into_iter().flatten() {
            let mark = if required.contains(&name.as_str()) { "yes" } else { "" };
            let _ = writeln!(text, "| `{name}` | {mark} |");
        }
        text.push('\n');
    }
    text
}

/// Keys at the top of a file that has a schema of its own.
fn of_schema(schema: &Value) -> String {
    let mut text = "| key | meaning |\n|---|---|\n".to_owned();
    for (name, property) in schema["properties"].as_object().into_iter().flatten() {
        let _ =
            writeln!(text, "| `{name}` | {} |", property["description"].as_str().unwrap_or("–").replace('|', "\\|"));
    }
    text + "\nThe whole schema is printed by `toolroom schema`.\n\n"
}
