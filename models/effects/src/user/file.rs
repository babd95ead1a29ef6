//! Users' effects in files: `[[effect]]` in a scenario, or a file of nothing else.

use super::definition::{Amount, Definition, Draft, Refused, Shape, Written, is_id, is_shape};
use super::program::SHAPES;
use super::slots::Term;
use serde_json::json;
use std::path::Path;
use std::sync::Arc;
use toml::Spanned;
use toml::de::DeValue;
use toolroom_form::{
    Content, ContentFault, Fault, Form, Key, Kind, ReadError, Section, SectionValue, Span, Value, Walk, nearest,
};

/// Processes on which an effect may act.
const PROCESSES: &[&str] = &["turning", "milling", "infeed"];

/// The size of an effect.
static SIZE: Form = Form {
    title: "size",
    doc: "Strength of an effect: its unit, an ordinary value, its range",
    keys: &[
        Key::default("unit", Kind::Text, "1", "Unit of the size, 1 for a ratio"),
        Key::required("ordinary", Kind::Amount, "An ordinary size: scale of the search"),
        Key::required("range", Kind::List(&Kind::Amount), "Least and greatest size; zero lies within"),
    ],
};

/// A change of a term.
static CHANGE: Form = Form {
    title: "changes",
    doc: "A term that the effect changes, by a factor or by a summand",
    keys: &[
        Key::required("term", Kind::Text, "Term; `toolroom effects --context` lists them"),
        Key::optional("factor", Kind::Text, "Formula that multiplies the term, 1 at size 0"),
        Key::optional("summand", Kind::Text, "Formula that is added to the term, 0 at size 0"),
    ],
};

/// Numbers of the shape, by name.
static SHAPE: Content = Content {
    expected: "a table of numbers with their units",
    example: "{ reference_speed = { value = \"200 m/min\", range = [\"60 m/min\", \"400 m/min\"], fit = true } }",
    schema: || {
        let amount = json!({ "type": ["number", "string"] });
        let full = json!({
            "type": "object", "additionalProperties": false, "required": ["value"],
            "properties": {
                "value": amount, "range": { "type": "array", "items": amount, "minItems": 2, "maxItems": 2 },
                "fit": { "type": "boolean", "description": "Whether a diagnosis looks for the value" },
            },
        });
        json!({ "type": "object", "additionalProperties": { "oneOf": [amount, full] } })
    },
    entry: None,
};

/// An effect of the user.
pub static USER_EFFECT: Form = Form {
    title: "[[effect]]",
    doc: "An effect of your own, beside those of the catalogue",
    keys: &[
        Key::required("id", Kind::Name, "Id with a dot, `my.crater`, so that it never meets one of the catalogue"),
        Key::default("title", Kind::Text, "", "One line for people"),
        Key::required("process", Kind::List(&Kind::Choice(PROCESSES)), "Processes on which it acts"),
        Key::required("size", Kind::Table(&SIZE), "Unit, ordinary value and range of the strength"),
        Key::optional("shape", Kind::Content(&SHAPE), "Other numbers of its formulas, each with value, range, fit"),
        Key::required("changes", Kind::Tables(&CHANGE), "What it changes"),
        Key::default(
            "kind",
            Kind::Choice(&["cause", "empirical"]),
            "cause",
            "`empirical`: it describes, and is no cause",
        ),
        Key::default("confounder", Kind::Text, "", "What it is most easily mistaken for"),
        Key::default("separating_test", Kind::Text, "", "The experiment that tells the two apart"),
        Key::default("source", Kind::Text, "", "Where it comes from"),
    ],
};

/// A file of nothing but effects.
pub static EFFECTS_FILE: Form = Form {
    title: "the effects",
    doc: "Effects of a user, for --effects",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::required("effect", Kind::Tables(&USER_EFFECT), "An effect of your own; repeatable"),
    ],
};

/// What is wrong with a definition.
#[derive(Debug, thiserror::Error)]
#[error("effect `{id}`: {message}")]
struct DefinitionFault {
    code: &'static str,
    id: String,
    message: String,
}

impl ContentFault for DefinitionFault {
    fn code(&self) -> &'static str {
        self.code
    }
}

/// Longer texts for the codes of this crate.
pub const CODES: &[(&str, &str)] = &[
    (
        "effect-definition",
        "An effect of your own has an id with a dot (`my.crater`), a size whose range holds zero, at most seven numbers of a shape, and changes: each a term with a formula under `factor` (terms that multiply) or `summand` (terms that add).",
    ),
    (
        "effect-parse",
        "The formula cannot be read at the place that is marked. It holds numbers with units, names of the context, of the shape and `size`, the operators + - * / ^, comparisons with and, or, not, and if(c, a, b), min, max, abs, exp, ln, sqrt, sin, cos, tanh, step(x), bump(x, centre, width). `toolroom effects --context` lists the names.",
    ),
    (
        "effect-unit",
        "The units of a formula do not fit. Sums, comparisons, min, max and if need equal units; exp, ln, sin, cos, tanh and step need a number; what has a unit takes a constant exponent. A factor is a number, a summand has the unit of its term. degC stands beside another temperature only, since a difference of 20 degC is 20 K.",
    ),
    (
        "effect-neutral",
        "At size 0 an effect is absent: every factor is 1 and every summand 0, in every context. Write a factor as `1 + size * …` and a summand as `size * …`.",
    ),
    (
        "effect-range",
        "In some context of the documented ranges the formula gives no number, or drives the term out of its range; the message names the context. Bound the formula by min and max, or narrow the range of the size.",
    ),
    (
        "effect-value",
        "While a model ran, the formula of an effect gave no number, an infinite one, or one out of the range of its term, or several effects left that range together. The message names the effect, the term, what the formula was given, and the operation. The points at which the formula was tried before lie beside that one: bound it there by min and max, keep roots and logarithms above zero (sqrt(max(x, 0))) and divisors away from it.",
    ),
];

/// The effects that a file defines under `effect`; a definition with faults is noted and left out.
pub fn read_definitions(walk: &mut Walk, root: &Section<'_>) -> Vec<&'static Definition> {
    let mut list: Vec<&'static Definition> = Vec::new();
    for section in walk.sections(root, "effect", None) {
        let Some(definition) = definition(walk, &section) else { continue };
        if list.iter().any(|own| own.entry().id == definition.entry().id) {
            let name = definition.entry().id.to_owned();
            walk.fault(section.span_of("id"), Fault::DuplicateName { kind: "effect", name });
            continue;
        }
        list.push(definition);
    }
    list
}

/// Reads a file of effects.
///
/// # Errors
/// [`ReadError`]: the file cannot be read, or every fault found in it.
pub fn read_effects_file(path: &Path) -> Result<Vec<&'static Definition>, ReadError> {
    let read = toolroom_form::read(path, &[], &EFFECTS_FILE, |walk, root| Some(read_definitions(walk, root)));
    read.map(|file| file.content)
}

/// Effects of a text that [`Definition::text`] may have written; `file` is its name in messages.
///
/// # Errors
/// [`ReadError`] with every fault found.
pub fn parse_definitions(file: &str, text: &str) -> Result<Vec<&'static Definition>, ReadError> {
    let read = |walk: &mut Walk, root: &Section<'_>| Some(read_definitions(walk, root));
    toolroom_form::parse(file, &format!("schema = 1\n{text}"), &[], &EFFECTS_FILE, read).map(|file| file.content)
}

struct Faults<'w> {
    walk: &'w mut Walk,
    id: String,
}

impl Faults<'_> {
    fn note(&mut self, code: &'static str, span: Span, message: impl Into<String>) {
        let fault = DefinitionFault { code, id: self.id.clone(), message: message.into() };
        self.walk.fault(span, Fault::Content(Arc::new(fault)));
    }

    fn amount(&mut self, raw: &DeValue<'_>, span: &Span, what: &str) -> Option<Amount> {
        let text = match raw {
            DeValue::String(text) => text.to_string(),
            DeValue::Integer(number) if number.radix() == 10 => number.as_str().to_owned(),
            DeValue::Float(number) => number.as_str().to_owned(),
            DeValue::Integer(_)
            | DeValue::Boolean(_)
            | DeValue::Datetime(_)
            | DeValue::Array(_)
            | DeValue::Table(_) => {
                self.note("effect-definition", span.clone(), format!("{what} is a number with its unit in quotes"));
                return None;
            }
        };
        match Amount::from_text(&text) {
            Ok(amount) => Some(amount),
            Err(reason) => {
                self.note("effect-definition", span.clone(), format!("{what}: {reason}"));
                None
            }
        }
    }

    /// A range with two ends of one unit, the least first.
    fn range(
        &mut self,
        ends: &[(DeValue<'_>, Span)],
        span: &Span,
        default: &Amount,
        what: &str,
    ) -> Option<[Amount; 2]> {
        let all: Vec<Amount> = ends.iter().filter_map(|(raw, span)| self.amount(raw, span, what)).collect();
        let [low, high] = <[Amount; 2]>::try_from(all).ok().or_else(|| {
            self.note(
                "effect-definition",
                span.clone(),
                format!("the range of {what} is its least and its greatest value"),
            );
            None
        })?;
        if low.powers != default.powers || high.powers != default.powers {
            self.note("effect-unit", span.clone(), format!("the range of {what} has the unit {}", default.unit));
            return None;
        }
        if low.si >= high.si {
            self.note(
                "effect-definition",
                span.clone(),
                format!("the range of {what} rises from its first end to its second"),
            );
            return None;
        }
        Some([low, high])
    }
}

fn raw_of<'d>(got: &SectionValue<'d>) -> Option<(DeValue<'d>, Span)> {
    if let Value::Raw(raw) = &got.value { Some((raw.clone(), got.span.clone())) } else { None }
}

fn definition(walk: &mut Walk, section: &Section<'_>) -> Option<&'static Definition> {
    let before = walk.problems.len();
    let id = section.text("id").unwrap_or_default().to_owned();
    let size = walk.table(section, "size");
    let changes = walk.sections(section, "changes", None);
    let processes = section.texts("process");
    let processes = PROCESSES.iter().copied().filter(|own| processes.iter().any(|process| process == own)).collect();
    let mut faults = Faults { walk, id: id.clone() };
    if !id.is_empty() && !is_id(&id) {
        let message = "an id has small letters, digits and low lines, and a dot: `my.crater`";
        faults.note("effect-definition", section.span_of("id"), message);
    }
    let ordinary = size.as_ref().and_then(|size| sized(&mut faults, size));
    let shape = shapes(&mut faults, section);
    let written = changes.iter().map(|change| written(&mut faults, change)).collect::<Option<Vec<_>>>();
    if section.given("changes") && changes.is_empty() {
        faults.note("effect-definition", section.span_of("changes"), "an effect changes one term at least");
    }
    let (ordinary, range) = ordinary?;
    let (written, places): (Vec<Written>, Vec<(Span, String)>) = written?.into_iter().unzip();
    if faults.walk.problems.len() > before {
        return None;
    }
    let text = |key: &str| section.text(key).unwrap_or_default().to_owned();
    let draft = Draft {
        id,
        title: text("title"),
        processes,
        ordinary,
        range,
        shape,
        changes: written,
        confounder: text("confounder"),
        separating_test: text("separating_test"),
        source: text("source"),
        empirical: section.text("kind") == Some("empirical"),
    };
    match Definition::new(&draft) {
        Ok(definition) => Some(definition),
        Err(all) => {
            for Refused { change, error } in all {
                let Some((span, formula)) = change.and_then(|i| places.get(i)) else { continue };
                // The marked part where the text stands in the file letter by letter, else the whole value.
                let quotes = span.len().saturating_sub(formula.len());
                let start = span.start + quotes / 2;
                let exact = quotes == 2 && !error.span.is_empty();
                let place = if exact { start + error.span.start..start + error.span.end } else { span.clone() };
                faults.note(error.code, place, error.marked(formula));
            }
            None
        }
    }
}

fn sized(faults: &mut Faults<'_>, size: &Section<'_>) -> Option<(Amount, [Amount; 2])> {
    let (raw, span) = raw_of(size.got("ordinary")?)?;
    let ordinary = faults.amount(&raw, &span, "ordinary")?;
    let unit = size.text("unit").unwrap_or("1");
    match Amount::from_text(&format!("1 {unit}")) {
        Ok(one) if one.powers == ordinary.powers => {}
        Ok(_) => {
            faults.note("effect-unit", span, format!("the ordinary size has the unit {unit}"));
            return None;
        }
        Err(reason) => {
            faults.note("effect-unit", size.span_of("unit"), reason);
            return None;
        }
    }
    let ordinary = Amount { unit: unit.to_owned(), ..ordinary };
    let ends: Vec<_> = size.list("range").iter().filter_map(raw_of).collect();
    let range = faults.range(&ends, &size.span_of("range"), &ordinary, "size")?;
    if range[0].si > 0.0 || range[1].si <= 0.0 {
        faults.note(
            "effect-definition",
            size.span_of("range"),
            "the range of the size begins at zero or below and ends above",
        );
        return None;
    }
    if ordinary.si <= 0.0 || ordinary.si > range[1].si {
        faults.note("effect-definition", span, "the ordinary size is above zero and within the range");
        return None;
    }
    Some((ordinary, range))
}

fn shapes(faults: &mut Faults<'_>, section: &Section<'_>) -> Vec<Shape> {
    let Some((raw, span)) = section.got("shape").and_then(raw_of) else { return Vec::new() };
    let DeValue::Table(table) = raw else {
        faults.note("effect-definition", span, format!("shape is {}, {}", SHAPE.expected, SHAPE.example));
        return Vec::new();
    };
    if table.len() > SHAPES {
        faults.note("effect-definition", span, format!("a shape has at most {SHAPES} numbers"));
        return Vec::new();
    }
    let mut list = Vec::new();
    for (name, raw) in table.iter() {
        let (name, place) = (name.get_ref().to_string(), raw.span());
        if !is_shape(&name) {
            let message = format!(
                "`{name}` cannot be a number of the shape: small letters, digits and low lines, no unit, no name of the context"
            );
            faults.note("effect-definition", place, message);
            continue;
        }
        list.extend(shape(faults, name, raw));
    }
    list
}

fn shape(faults: &mut Faults<'_>, name: String, raw: &Spanned<DeValue<'_>>) -> Option<Shape> {
    let DeValue::Table(table) = raw.get_ref() else {
        let value = faults.amount(raw.get_ref(), &raw.span(), &name)?;
        return Some(Shape { name, value, range: None, fit: false });
    };
    const KEYS: [&str; 3] = ["value", "range", "fit"];
    if let Some((key, unknown)) = table.iter().find(|(key, _)| !KEYS.contains(&key.get_ref().as_ref())) {
        let message = format!("`{}` is no key of a number of the shape; it has value, range, fit", key.get_ref());
        faults.note("effect-definition", unknown.span(), message);
        return None;
    }
    let Some(written) = table.get("value") else {
        faults.note("effect-definition", raw.span(), format!("{name} has no value"));
        return None;
    };
    let value = faults.amount(written.get_ref(), &written.span(), &name)?;
    let range = match table.get("range") {
        None => None,
        Some(range) => {
            let ends: Vec<_> = match range.get_ref() {
                DeValue::Array(ends) => ends.iter().map(|end| (end.get_ref().clone(), end.span())).collect(),
                DeValue::String(_)
                | DeValue::Integer(_)
                | DeValue::Float(_)
                | DeValue::Boolean(_)
                | DeValue::Datetime(_)
                | DeValue::Table(_) => Vec::new(),
            };
            Some(faults.range(&ends, &range.span(), &value, &name)?)
        }
    };
    if let Some([low, high]) = &range
        && !(low.si..=high.si).contains(&value.si)
    {
        faults.note("effect-definition", written.span(), format!("the value of {name} lies within its range"));
        return None;
    }
    let fit = match table.get("fit").map(|value| (value.get_ref(), value.span())) {
        None => false,
        Some((DeValue::Boolean(fit), span)) => {
            if *fit && range.is_none() {
                faults.note("effect-definition", span, format!("{name} is to be fitted and has no range"));
                return None;
            }
            *fit
        }
        Some((_, span)) => {
            faults.note("effect-definition", span, "fit is true or false");
            return None;
        }
    };
    Some(Shape { name, value, range, fit })
}

fn written(faults: &mut Faults<'_>, change: &Section<'_>) -> Option<(Written, (Span, String))> {
    let word = change.text("term")?;
    let Some(term) = Term::ALL.iter().copied().find(|term| term.name() == word) else {
        let known = || Term::ALL.iter().map(|term| term.name());
        let near = nearest(word, known()).map_or_else(String::new, |near| format!("; nearest: `{near}`"));
        let message = format!("unknown term `{word}`{near} (`toolroom effects --context` lists all)");
        faults.note("effect-definition", change.span_of("term"), message);
        return None;
    };
    let (due, other) = if term.is_factor() { ("factor", "summand") } else { ("summand", "factor") };
    match (change.text(due), change.given(other)) {
        (Some(formula), false) => {
            let place = (change.span_of(due), formula.to_owned());
            Some((Written { term, formula: formula.to_owned() }, place))
        }
        (None, _) | (Some(_), true) => {
            let message = format!("{word} is changed by a {due}, and by nothing else");
            faults.note("effect-definition", change.span.clone(), message);
            None
        }
    }
}
