//! `documentation/index.html`: what the unit computes, its equations and its variables.

use super::Version;
use crate::description::{Description, LICENCE, TOOL, VERSION, escaped};
use crate::variable::{Role, ValueType, Variable};
use std::fmt::Write as _;

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:72em;margin:2em auto;padding:0 1em;\
    color:#1b1f24;background:#fff}table{border-collapse:collapse;font-size:14px;width:100%}\
    th,td{border-bottom:1px solid #d0d7de;padding:.25em .6em;text-align:left;vertical-align:top}\
    td.n{text-align:right;font-variant-numeric:tabular-nums}code{font-family:ui-monospace,monospace}\
    @media(prefers-color-scheme:dark){body{color:#e6edf3;background:#0d1117}th,td{border-color:#30363d}}";

/// Groups of the variables table, by role.
const GROUPS: [(&str, &[Role]); 5] = [
    ("Inputs", &[Role::Input]),
    ("Outputs", &[Role::Output]),
    ("States", &[Role::State]),
    ("Local variables", &[Role::Local, Role::Independent]),
    ("Parameters", &[Role::Fixed, Role::Tunable]),
];

pub(super) fn page(description: &Description, version: Version) -> String {
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{id}</title><style>{STYLE}</style>\
         </head><body>\n<h1>{id}</h1>\n<p>{}. FMI {}.0, version {VERSION}, written by {TOOL}.</p>\n<p>{}</p>\n",
        escaped(description.title),
        version.number(),
        escaped(description.summary),
        id = description.identifier,
    );
    text.push_str(&interfaces(description));
    text.push_str("<h2>Equations</h2>\n<table>\n");
    for (name, equation) in description.equations {
        let _ = writeln!(text, "<tr><th>{}</th><td><code>{}</code></td></tr>", escaped(name), escaped(equation));
    }
    text.push_str("</table>\n<h2>Validity</h2>\n<ul>\n");
    for line in description.validity {
        let _ = writeln!(text, "<li>{}</li>", escaped(line));
    }
    text.push_str("</ul>\n<h2>Parameter sets</h2>\n<p>Set <code>tool.set</code> before initialisation to one of ");
    let sets: Vec<String> = description.sets.iter().map(|(name, _)| format!("<code>{name}</code>")).collect();
    let _ = writeln!(
        text,
        "{}, or to the name of a file that you add to <code>resources/tools</code>. Each file names the source of \
         every value. A parameter that is set by itself keeps its value.</p>",
        sets.join(", ")
    );
    for (title, roles) in GROUPS {
        table(&mut text, title, description, roles);
    }
    let _ = writeln!(
        text,
        "<h2>Licence</h2>\n<p>{LICENCE}, at your choice; both texts are in <code>documentation/licenses</code>.</p>\n\
         </body></html>"
    );
    text
}

fn interfaces(description: &Description) -> String {
    let model_exchange = if description.continuous {
        "Model Exchange gives states, derivatives and event indicators. "
    } else {
        "There is no Model Exchange: the model is no ordinary differential equation. "
    };
    format!(
        "<h2>Use</h2>\n<p>Values are in SI units; display units are declared, and start and range in the tables below \
         are in these. {model_exchange}In Co-Simulation inputs \
         are held over a step, which may have any length; events inside a step are located, and shown by the outputs \
         <code>event.*</code>. Importers of FMI 3.0 may use Event Mode and early return. States can be saved, restored \
         and serialised; first derivatives are exact where Model Exchange is offered. An output \
         <code>event.*</code> stays true until the next renewal (a rising edge of the inputs that change tool, part or \
         wheel).</p>\n<p>Every effect that the nominal model leaves out is a parameter <code>effect.*</code>, zero where \
         it is off; its shape parameters are <code>shape.*</code>.</p>\n"
    )
}

fn table(text: &mut String, title: &str, description: &Description, roles: &[Role]) {
    let rows: Vec<&Variable> = description.variables.iter().filter(|variable| roles.contains(&variable.role)).collect();
    if rows.is_empty() {
        return;
    }
    let _ = write!(
        text,
        "<h2>{title}</h2>\n<table>\n<tr><th>name</th><th>SI unit</th><th>display unit</th><th>start</th><th>range</th>\
         <th>meaning</th></tr>\n"
    );
    for variable in rows {
        let field = &variable.field;
        let shown = |value: f64| number(field.to_display(value) as f32);
        let bound = |value: f64, open: f64| if value == open { "–".to_owned() } else { shown(value) };
        let open = field.min == f64::MIN && field.max == f64::MAX;
        let counts = matches!(variable.value_type, ValueType::Real | ValueType::Integer);
        let range = match (counts, open) {
            (true, false) => format!("{} … {}", bound(field.min, f64::MIN), bound(field.max, f64::MAX)),
            (true, true) => String::new(),
            (false, _) => variable_range(variable),
        };
        let start = match variable.value_type {
            ValueType::String => description.sets[0].0.to_owned(),
            ValueType::Real | ValueType::Integer | ValueType::Boolean if !variable.has_start() => String::new(),
            ValueType::Boolean => (field.start > 0.5).to_string(),
            ValueType::Real | ValueType::Integer => shown(field.start),
        };
        let _ = writeln!(
            text,
            "<tr><td><code>{}</code></td><td>{}</td><td>{}</td><td class=\"n\">{start}</td><td>{range}</td><td>{}</td></tr>",
            escaped(&variable.name),
            escaped(field.unit),
            escaped(field.display),
            prose(field.doc.trim()),
        );
    }
    text.push_str("</table>\n");
}

/// A number as people read it: long ones by their power of ten.
fn number(value: f32) -> String {
    let plain = value == 0.0 || (1e-4..1e6).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}

/// A doc comment: what stands between backticks is code.
fn prose(text: &str) -> String {
    let mut code = false;
    let mut html = String::new();
    for (i, part) in text.split('`').enumerate() {
        if i > 0 {
            code = !code;
            html.push_str(if code { "<code>" } else { "</code>" });
        }
        html.push_str(&escaped(part));
    }
    html
}

/// Range of what is no number.
fn variable_range(variable: &Variable) -> String {
    match variable.value_type {
        ValueType::Boolean => "true, false".to_owned(),
        ValueType::Real | ValueType::Integer | ValueType::String => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn code_and_long_numbers_are_readable() {
        assert_eq!(prose("`1 < a`, at b"), "<code>1 &lt; a</code>, at b");
        assert_eq!([0.0, 0.12, 40.0, 1e12].map(number), ["0", "0.12", "40", "1e12"]);
    }
}
