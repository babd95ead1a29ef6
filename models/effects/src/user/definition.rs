//! An effect as a user defines it.

use super::change::Change;
use super::dimension::{self, Powers, powers, si_text};
use super::expression::{self, FormulaError, is_name};
use super::neutral::{in_range, neutral};
use super::program::{MOST_PARTS, Program, SHAPES};
use super::slots::{Quantity, Term};
use crate::catalogue::rises;
use crate::{CatalogueEntry, Search, Touched};
use std::collections::BTreeSet;
use std::fmt::Write;
use std::sync::Mutex;
use toolroom_process::{Field, Kind, unit};

/// Values of a shape that is to be fitted, as shares of its range.
const TRIED: [f64; 3] = [1.0 / 6.0, 0.5, 5.0 / 6.0];

/// An effect that a user has written, checked: dimensions, neutrality at size zero, ranges of the terms.
///
/// Definitions of the same text are one, so that effects of two readings of a file are equal. They live as long as the
/// program.
#[derive(Debug)]
pub struct Definition {
    pub(super) entry: CatalogueEntry,
    pub(super) fields: &'static [Field],
    pub(super) changes: Vec<Change>,
    empirical: bool,
    text: String,
}

impl PartialEq for Definition {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

/// A number with its unit as a file has it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Amount {
    pub text: String,
    pub si: f64,
    pub powers: Powers,
    /// Unit as written, `1` for a number.
    pub unit: String,
}

impl Amount {
    /// Reads a number with any unit.
    ///
    /// # Errors
    /// What is wrong, in words.
    pub fn from_text(text: &str) -> Result<Self, String> {
        let body = text.trim();
        let end = body.find(|letter: char| {
            letter.is_whitespace() || (letter.is_alphabetic() && !matches!(letter, 'e' | 'E')) || letter == '%'
        });
        let (number, name) = body.split_at(end.unwrap_or(body.len()));
        let read = unit::parse(name.trim()).map(|unit| si_text(&unit.dimension.map(f64::from)));
        let si = if name.trim().is_empty() {
            "1".to_owned()
        } else {
            read.map_err(|(symbol, _)| format!("unknown unit `{symbol}`"))?
        };
        let value = unit::quantity(body, lasting(&si)).map_err(|error| error.to_string())?;
        if !value.is_finite() {
            return Err(format!("`{number}` is no finite number"));
        }
        let unit = if name.trim().is_empty() { "1" } else { name.trim() };
        Ok(Self { text: text.to_owned(), si: value, powers: powers(&si), unit: unit.to_owned() })
    }
}

/// A number of the shape as a file has it.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    pub name: String,
    pub value: Amount,
    /// Least and greatest value.
    pub range: Option<[Amount; 2]>,
    /// Whether the diagnosis looks for its value.
    pub fit: bool,
}

/// A change as a file has it.
#[derive(Clone, Debug)]
pub(crate) struct Written {
    pub term: Term,
    pub formula: String,
}

/// A definition as a file has it.
#[derive(Clone, Debug)]
pub(crate) struct Draft {
    pub id: String,
    pub title: String,
    pub processes: Vec<&'static str>,
    pub ordinary: Amount,
    pub range: [Amount; 2],
    pub shape: Vec<Shape>,
    pub changes: Vec<Written>,
    pub confounder: String,
    pub separating_test: String,
    pub source: String,
    pub empirical: bool,
}

/// What is wrong with a definition: the change at fault, or the definition itself.
#[derive(Clone, Debug)]
pub(crate) struct Refused {
    /// Index of the change.
    pub change: Option<usize>,
    pub error: FormulaError,
}

/// The text for as long as the program runs; each is kept once.
fn lasting(text: &str) -> &'static str {
    static ALL: Mutex<BTreeSet<&'static str>> = Mutex::new(BTreeSet::new());
    let mut all = ALL.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(known) = all.get(text) {
        return known;
    }
    let new: &'static str = Box::leak(text.to_owned().into_boxed_str());
    all.insert(new);
    new
}

fn field(name: &str, value: &Amount, range: [f64; 2], doc: &str) -> Field {
    let display = unit::convert(1.0, lasting(&si_text(&value.powers)), &value.unit);
    let display = if display.is_finite() { value.unit.as_str() } else { "1" };
    Field {
        name: lasting(name),
        unit: lasting(&si_text(&value.powers)),
        display: lasting(display),
        kind: Kind::Real,
        len: 1,
        start: value.si,
        min: range[0],
        max: range[1],
        doc: lasting(doc),
    }
}

impl Definition {
    /// Checks a draft.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub(crate) fn new(draft: &Draft) -> Result<&'static Self, Vec<Refused>> {
        static ALL: Mutex<Vec<&'static Definition>> = Mutex::new(Vec::new());
        let text = text_of(draft);
        let known = |all: &Vec<&'static Self>| all.iter().copied().find(|own| own.text == text);
        if let Some(same) = known(&ALL.lock().unwrap_or_else(std::sync::PoisonError::into_inner)) {
            return Ok(same);
        }
        let definition = Self::checked(draft, text.clone())?;
        let mut all = ALL.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        Ok(known(&all).unwrap_or_else(|| {
            let kept: &'static Self = Box::leak(Box::new(definition));
            all.push(kept);
            kept
        }))
    }

    fn checked(draft: &Draft, text: String) -> Result<Self, Vec<Refused>> {
        let size = Amount { si: 0.0, ..draft.ordinary.clone() };
        let title = if draft.title.is_empty() { &draft.id } else { &draft.title };
        let mut fields = vec![field("size", &size, draft.range.clone().map(|end| end.si), title)];
        for parameter in &draft.shape {
            let range = parameter.range.as_ref().map_or([parameter.value.si; 2], |range| [range[0].si, range[1].si]);
            fields.push(field(&parameter.name, &parameter.value, range, "number of the shape"));
        }
        let fields: &'static [Field] = Vec::leak(fields);
        let none = |i: usize| format!("(shape {i})");
        let mut names: Vec<String> = vec!["size".to_owned()];
        names.extend((0..SHAPES).map(|i| draft.shape.get(i).map_or_else(|| none(i), |own| own.name.clone())));
        names.extend(Quantity::ALL.iter().map(|quantity| quantity.name().to_owned()));
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let mut units: Vec<Powers> = vec![draft.ordinary.powers];
        units.extend((0..SHAPES).map(|i| draft.shape.get(i).map_or([0.0; 8], |own| own.value.powers)));
        units.extend(Quantity::ALL.iter().map(|quantity| powers(quantity.field().unit)));
        let (mut changes, mut refused) = (Vec::new(), Vec::new());
        for (i, written) in draft.changes.iter().enumerate() {
            match change(draft, written, &names, &units, fields) {
                Ok(change) => changes.push(change),
                Err(error) => refused.push(Refused { change: Some(i), error }),
            }
        }
        if !refused.is_empty() {
            return Err(refused);
        }
        Ok(Self { entry: entry(draft, &changes, &fields[0]), fields, changes, empirical: draft.empirical, text })
    }

    /// The row of the catalogue that it would be.
    pub fn entry(&self) -> &CatalogueEntry {
        &self.entry
    }

    /// Size, then the numbers of the shape.
    pub fn fields(&self) -> &'static [Field] {
        self.fields
    }

    /// Whether it describes records without saying why: **empirical, not a cause**.
    pub fn is_empirical(&self) -> bool {
        self.empirical
    }

    /// The section `[[effect]]` that says it, in a form of its own.
    pub fn text(&self) -> &str {
        &self.text
    }
}

/// One change of a definition, checked.
fn change(
    draft: &Draft,
    written: &Written,
    names: &[&str],
    units: &[Powers],
    fields: &[Field],
) -> Result<Change, FormulaError> {
    let term = written.term;
    let whole = |code: &'static str, message: String| FormulaError { code, message, span: 0..written.formula.len() };
    let node = expression::parse(&written.formula, names)?;
    if node.count() > MOST_PARTS {
        return Err(whole(
            "effect-parse",
            format!("{} numbers, names and operators, at most {MOST_PARTS}", node.count()),
        ));
    }
    dimension::fits(&node, units, &powers(term.field().unit), term.is_factor())?;
    for process in &draft.processes {
        if !term.is_read_by(process) {
            let read = Term::ALL.iter().filter(|own| own.is_read_by(process)).map(|own| own.name());
            let read = read.collect::<Vec<_>>().join(", ");
            return Err(whole("effect-unit", format!("{process} does not read {}; it reads {read}", term.name())));
        }
    }
    let slots: Vec<usize> = (0..names.len()).filter(|slot| node.names(&|own| own == *slot)).collect();
    for quantity in slots.iter().filter_map(|slot| slot.checked_sub(SHAPES + 1)).map(|at| Quantity::ALL[at]) {
        if let Some(process) = draft.processes.iter().find(|process| !quantity.filled_by().contains(process)) {
            let filled = Quantity::ALL.iter().filter(|own| own.filled_by().contains(process)).map(|own| own.name());
            let filled = filled.collect::<Vec<_>>().join(", ");
            return Err(whole("effect-unit", format!("{process} has no {}; it has {filled}", quantity.name())));
        }
    }
    let range = [term.field().min, term.field().max];
    let change = Change { term, program: Program::of(&node), range, slots };
    neutral(&node, &change, fields)?;
    in_range(&node, &change, fields)?;
    Ok(change)
}

/// The row of the catalogue.
fn entry(draft: &Draft, changes: &[Change], size: &'static Field) -> CatalogueEntry {
    let mut channels: Vec<Touched> = Vec::new();
    for channel in changes.iter().flat_map(|change| change.term.channels()) {
        if channels.iter().all(|known| known.channel != *channel) {
            channels.push(rises(channel));
        }
    }
    let seen = |quantity: Quantity| {
        let slot = SHAPES + 1 + Quantity::ALL.iter().position(|own| *own == quantity).unwrap_or(0);
        changes.iter().any(|change| change.slots.contains(&slot))
    };
    let regime: Vec<&str> = Quantity::ALL.iter().filter(|own| seen(**own)).map(|own| own.name()).collect();
    let ordinary = draft.ordinary.si;
    let fitted = draft.shape.iter().find(|own| own.fit);
    let search = match fitted {
        _ if seen(Quantity::lot_deviation) => Search::Lots(ordinary),
        Some(own) => Search::Values {
            parameter: lasting(&own.name),
            values: Vec::leak(tried(own)),
            told_by: None,
            size: ordinary,
        },
        None => Search::Size(ordinary),
    };
    let or = |text: &str, other: &str| if text.is_empty() { lasting(other) } else { lasting(text) };
    CatalogueEntry {
        id: lasting(&draft.id),
        title: or(&draft.title, &draft.id),
        size,
        channels: Vec::leak(channels),
        regime: or(&regime.join(", "), "every cut alike"),
        confounder: or(&draft.confounder, "not said by its author"),
        separating_test: or(&draft.separating_test, "not said by its author"),
        source: or(&draft.source, "not said by its author"),
        processes: Vec::leak(draft.processes.iter().map(|process| (*process, search)).collect()),
    }
}

/// Values at which a number of the shape is tried: its own, and some over its range, by the logarithm where that is
/// positive.
fn tried(shape: &Shape) -> Vec<f64> {
    let mut values = vec![shape.value.si];
    if let Some([low, high]) = shape.range.as_ref().map(|range| [range[0].si, range[1].si]) {
        let value = |share: &f64| if low > 0.0 { low * (high / low).powf(*share) } else { low + share * (high - low) };
        values.extend(TRIED.iter().map(value));
    }
    values
}

/// Whether a word may be the id of a user's effect: words joined by dots, of which one at least.
pub(crate) fn is_id(word: &str) -> bool {
    let part = |part: &str| {
        !part.is_empty()
            && part.chars().all(|letter| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '_')
    };
    word.contains('.') && word.split('.').all(part) && word.len() <= 80
}

/// Whether a word may be the name of a number of the shape.
pub(crate) fn is_shape(word: &str) -> bool {
    is_name(word) && word != "size" && Quantity::ALL.iter().all(|quantity| quantity.name() != word)
}

/// The section `[[effect]]` of a draft.
fn text_of(draft: &Draft) -> String {
    let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
    let amount = |own: &Amount| if own.unit == "1" { own.text.trim().to_owned() } else { quoted(&own.text) };
    let mut text = format!("[[effect]]\nid = {}\n", quoted(&draft.id));
    let processes: Vec<String> = draft.processes.iter().map(|process| quoted(process)).collect();
    let mut line = |key: &str, value: &str| {
        if !value.is_empty() {
            let _ = writeln!(text, "{key} = {}", quoted(value));
        }
    };
    line("title", &draft.title);
    line("confounder", &draft.confounder);
    line("separating_test", &draft.separating_test);
    line("source", &draft.source);
    if draft.empirical {
        line("kind", "empirical");
    }
    let [low, high] = draft.range.each_ref().map(&amount);
    let _ = writeln!(text, "process = [{}]", processes.join(", "));
    let ordinary = amount(&draft.ordinary);
    let _ = writeln!(
        text,
        "size = {{ unit = {}, ordinary = {ordinary}, range = [{low}, {high}] }}",
        quoted(&draft.ordinary.unit)
    );
    if !draft.shape.is_empty() {
        let one = |own: &Shape| {
            let range = own
                .range
                .as_ref()
                .map_or_else(String::new, |[low, high]| format!(", range = [{}, {}]", amount(low), amount(high)));
            let fit = if own.fit { ", fit = true" } else { "" };
            format!("{} = {{ value = {}{range}{fit} }}", own.name, amount(&own.value))
        };
        let _ = writeln!(text, "shape = {{ {} }}", draft.shape.iter().map(one).collect::<Vec<_>>().join(", "));
    }
    text.push_str("changes = [\n");
    for change in &draft.changes {
        let key = if change.term.is_factor() { "factor" } else { "summand" };
        let _ = writeln!(text, "    {{ term = {}, {key} = {} }},", quoted(change.term.name()), quoted(&change.formula));
    }
    text.push_str("]\n");
    text
}
