//! The keys of a form as a page for people, in Markdown: a table a section.

use crate::form::{Form, Key, Kind, Need, Quantity};
use crate::words::display;
use std::fmt::Write;
use toolroom_process::{Field, unit};

/// Every section of a form, each with a table of its keys: what a key takes with unit and range, its default, what it
/// means. Sections stand in the order in which they are named first.
///
/// ```
/// use toolroom_form::{Form, Key, Kind, reference};
/// static FILE: Form = Form {
///     title: "the file",
///     doc: "A bar",
///     keys: &[Key::default("length", Kind::positive("m", "mm", 1.0, "100 mm"), "100 mm", "Length")],
/// };
/// let page = reference(&FILE);
/// assert!(page.contains("mm, um, m, in; above 0 up to 1000 mm | 100 mm | Length |"), "{page}");
/// ```
pub fn reference(form: &'static Form) -> String {
    let mut sections = vec![form];
    let mut text = String::new();
    let mut next = 0;
    while let Some(form) = sections.get(next).copied() {
        next += 1;
        let _ = writeln!(text, "## {}\n\n{}.\n", heading(form), sentence(form.doc));
        text.push_str("| key | takes | default | meaning |\n|---|---|---|---|\n");
        for key in form.keys {
            let _ = writeln!(
                text,
                "| `{}` | {} | {} | {} |",
                key.name,
                cell(&takes(&key.kind)),
                cell(&default(key)),
                cell(&meaning(key))
            );
            let mut fields = None;
            inner(&key.kind, &mut |found| match found {
                Inner::Form(form) if !sections.iter().any(|own| std::ptr::eq(*own, form)) => sections.push(form),
                Inner::Form(_) => {}
                Inner::Fields(found) => fields = Some(found),
            });
            for field in fields.into_iter().flatten() {
                let _ = writeln!(
                    text,
                    "| `{}.{}` | {} | | {} |",
                    key.name,
                    field.name,
                    cell(&number(&Quantity::of(field))),
                    cell(&sentence(field.doc))
                );
            }
        }
        text.push('\n');
    }
    text
}

/// What stands inside a value.
enum Inner {
    Form(&'static Form),
    Fields(&'static [Field]),
}

fn inner(kind: &'static Kind, found: &mut dyn FnMut(Inner)) {
    match kind {
        Kind::Table(form) | Kind::Tables(form) => found(Inner::Form(form)),
        Kind::Shorthand { form, .. } => found(Inner::Form(form)),
        Kind::Fields { fields, .. } => found(Inner::Fields(fields)),
        Kind::List(item) | Kind::Or { other: item, .. } | Kind::Dated(item) => inner(item, found),
        Kind::Name
        | Kind::Text
        | Kind::Quantity(_)
        | Kind::Count { .. }
        | Kind::Flag
        | Kind::Choice(_)
        | Kind::Reference(_)
        | Kind::Parameters
        | Kind::Texts
        | Kind::Content(_)
        | Kind::Amount => {}
    }
}

/// The title as a heading; brackets would be a link.
fn heading(form: &Form) -> String {
    if form.title.contains('[') || form.title.contains('{') {
        format!("`{}`", form.title)
    } else {
        form.title.to_owned()
    }
}

fn sentence(doc: &str) -> String {
    doc.split_whitespace().collect::<Vec<_>>().join(" ").trim_end_matches('.').to_owned()
}

/// A text in a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ").replace('<', "&lt;")
}

fn default(key: &Key) -> String {
    match key.need {
        Need::Required => "required".to_owned(),
        Need::Optional => String::new(),
        Need::Default("") => "empty".to_owned(),
        Need::Default(value) => value.to_owned(),
    }
}

fn meaning(key: &Key) -> String {
    match key.when {
        Some(when) => format!("{}. Where `{}` is {}", sentence(key.doc), when.key, when.values.join(" or ")),
        None => sentence(key.doc),
    }
}

/// What a key takes, with units and range.
fn takes(kind: &Kind) -> String {
    match kind {
        Kind::Name => "a name".to_owned(),
        Kind::Text => "a text".to_owned(),
        Kind::Quantity(quantity) => number(quantity),
        Kind::Count { min, max: u64::MAX } => format!("a whole number from {min}"),
        Kind::Count { min, max } => format!("a whole number, {min} to {max}"),
        Kind::Flag => "`true` or `false`".to_owned(),
        Kind::Choice(choices) => choices.iter().map(|word| format!("`{word}`")).collect::<Vec<_>>().join(", "),
        Kind::Or { words, other } => {
            let words: Vec<String> = words.iter().map(|word| format!("`{word}`")).collect();
            format!("{}; or {}", words.join(", "), takes(other))
        }
        Kind::Dated(other) => format!("a date such as `2026-03-30 06:00`; or {}", takes(other)),
        Kind::Reference(kind) => format!("the name of a {kind}"),
        Kind::List(item) => format!("one or more: {}", takes(item)),
        Kind::Table(form) => format!("a table: {}", heading(form)),
        Kind::Tables(form) => format!("tables: {}", heading(form)),
        Kind::Shorthand { word, form } => format!("{}; or a table: {}", takes(word), heading(form)),
        Kind::Fields { word, .. } => format!("{}; or a table of the values below", takes(word)),
        Kind::Parameters => "groups of parameters, `{ group = { name = value } }`".to_owned(),
        Kind::Texts => "names of the file's own, each with a text or number".to_owned(),
        Kind::Content(content) => format!("{}, such as `{}`", content.expected, content.example),
        Kind::Amount => "a number with its unit".to_owned(),
    }
}

/// Units and range of a number.
fn number(quantity: &Quantity) -> String {
    let units = if quantity.unit == "1" { "a number".to_owned() } else { unit::accepted(quantity.unit) };
    let (low, high) = (quantity.min.abs() < 1e29, quantity.max.abs() < 1e29);
    let shown = |si| display(quantity, si);
    let range = match (low, high) {
        (true, true) if quantity.above => format!("above {} up to {}", display_bare(quantity), shown(quantity.max)),
        (true, true) => format!("{} to {}", shown(quantity.min), shown(quantity.max)),
        (true, false) if quantity.above => format!("above {}", display_bare(quantity)),
        (true, false) => format!("from {}", shown(quantity.min)),
        (false, true) => format!("up to {}", shown(quantity.max)),
        (false, false) => return units,
    };
    format!("{units}; {range}")
}

/// The least value; nought needs no unit.
fn display_bare(quantity: &Quantity) -> String {
    if quantity.min == 0.0 { "0".to_owned() } else { display(quantity, quantity.min) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::form::Content;

    static INNER: Form = Form {
        title: "{ rule = … }",
        doc: "A rule",
        keys: &[Key::required("limit", Kind::quantity("m", "mm", 0.0, f64::INFINITY, "1 mm"), "Limit | of wear")],
    };
    static CONTENT: Content =
        Content { expected: "two numbers", example: "[0, 1]", schema: || serde_json::Value::Null, entry: None };
    static FILE: Form = Form {
        title: "the file",
        doc: "Everything",
        keys: &[
            Key::optional("rule", Kind::Shorthand { word: &Kind::Choice(&["a", "b"]), form: &INNER }, "A rule"),
            Key::optional("rules", Kind::List(&Kind::Table(&INNER)), "More of them").when("rule", &["a"]),
            Key::default("count", Kind::Count { min: 1, max: 9 }, "3", "How many"),
            Key::optional("range", Kind::Content(&CONTENT), "From and to"),
        ],
    };

    #[test]
    fn a_section_stands_once_and_every_key_with_its_range_and_condition() {
        let page = reference(&FILE);
        assert_eq!(page.matches("## `{ rule = … }`").count(), 1, "{page}");
        for expected in [
            "| `rule` | `a`, `b`; or a table: `{ rule = … }` |  | A rule |",
            "| `rules` | one or more: a table: `{ rule = … }` |  | More of them. Where `rule` is a |",
            "| `count` | a whole number, 1 to 9 | 3 | How many |",
            "| `range` | two numbers, such as `[0, 1]` |  | From and to |",
            "from 0 mm | required | Limit \\| of wear |",
        ] {
            assert!(page.contains(expected), "{expected} in\n{page}");
        }
    }
}
