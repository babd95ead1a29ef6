//! Reads sections by their [`Form`]: units, ranges, unknown and missing keys, all faults at once.

use crate::fault::{Fault, Problem, nearest};
use crate::form::{CURRENCIES, Form, Key, Kind, Need, Quantity};
use crate::section::{RuleTable, Section, SectionValue, Span, Value};
use crate::words::{described, example, expected, fix, meant, quoted, range, understood};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toolroom_process::unit;

/// One quantity as it was understood.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Echo {
    /// Section, `machine L1`.
    pub section: String,
    /// Key.
    pub key: String,
    /// Value in the key's display unit.
    pub value: String,
    /// Bytes of the value in the text; those of the section where the file leaves it out.
    #[serde(skip)]
    pub span: Range<usize>,
    /// Whether the file leaves it out.
    pub default: bool,
}

/// The state of a reading: what was found wrong so far, and what was understood.
#[derive(Debug, Default)]
pub struct Walk {
    /// Faults so far.
    pub problems: Vec<Problem>,
    /// Values as they were understood.
    pub echo: Vec<Echo>,
    /// Currency codes used, with their place.
    pub currencies: Vec<(&'static str, Span)>,
    /// Currency of the file, in which amounts are echoed.
    pub currency: String,
    /// Folder of the file, from which the files that it names are found.
    pub folder: PathBuf,
    /// Files that it names.
    pub files: Vec<PathBuf>,
    /// Bytes at which lines of the text end.
    pub(crate) ends: Vec<usize>,
}

impl Walk {
    /// Notes a problem about the text at `span`, as [`Section::span_of`] tells it.
    pub fn fault(&mut self, span: Range<usize>, fault: impl Into<Fault>) {
        self.problems.push(Problem { fault: fault.into(), span });
    }

    /// Line on which `span` starts, from 1; what `--set` gives stands past the last one.
    pub fn line(&self, span: &Range<usize>) -> usize {
        self.ends.partition_point(|end| *end < span.start) + 1
    }

    /// Notes a file that was read because the file names it.
    pub fn named(&mut self, path: PathBuf) {
        self.files.push(path);
    }

    /// The text of a file that the value under `key` names; `None` where a problem was noted.
    pub fn file(&mut self, section: &Section<'_>, key: &str, path: &str) -> Option<String> {
        let text = crate::text::decode(path, &self.bytes(section, key, path)?);
        if text.is_err() {
            self.fault(section.span_of(key), Fault::NotUtf8 { file: path.to_owned() });
        }
        text.ok()
    }

    /// The bytes of a file that the value under `key` names; `None` where a problem was noted.
    pub fn bytes(&mut self, section: &Section<'_>, key: &str, path: &str) -> Option<Vec<u8>> {
        let place = self.folder.join(path);
        let bytes = crate::bytes(&place);
        self.files.push(place);
        match bytes {
            Ok(bytes) => Some(bytes),
            Err(source) => {
                let fault = Fault::Unreadable { file: path.to_owned(), reason: source.kind() };
                self.fault(section.span_of(key), fault);
                None
            }
        }
    }

    /// Reads a section. `case` decides keys that depend on something outside the section, such as
    /// the process of an operation's tool.
    pub fn section<'d>(
        &mut self,
        form: &'static Form,
        path: &str,
        table: &DeTable<'d>,
        span: Span,
        case: Option<(&str, &str)>,
    ) -> Section<'d> {
        let path = match table.get("name").and_then(|name| name.get_ref().as_str()) {
            Some(name) => format!("{path} {name}"),
            None => path.to_owned(),
        };
        let mut section = Section { form, span: span.clone(), path, values: BTreeMap::new() };
        for (name, value) in table {
            if form.key(name.get_ref()).is_none() {
                let fault = Fault::UnknownKey {
                    section: form.title.to_owned(),
                    key: name.get_ref().to_string(),
                    nearest: nearest(name.get_ref(), form.keys.iter().map(|key| key.name)),
                    known: form.key_names().join(", "),
                };
                // A header's span is the key; of an override only the value has a place.
                let place = if name.span().is_empty() { value.span() } else { name.span() };
                self.fault(place, fault);
            }
        }
        for key in form.keys {
            let raw = table.get(key.name);
            if raw.is_none() && matches!(key.need, Need::Optional) {
                continue;
            }
            // Selectors stand before the keys that they decide.
            let applies = |key: &Key| {
                key.when.map_or(Some(true), |when| {
                    let chosen = case.filter(|(name, _)| *name == when.key).map(|(_, value)| value);
                    chosen.or_else(|| section.text(when.key)).map(|chosen| when.values.contains(&chosen))
                })
            };
            // A key may be due in one case and free in another: one of its entries decides.
            let alike = || form.keys.iter().filter(|other| other.name == key.name);
            let decides = alike().find(|other| applies(other) != Some(false)).or_else(|| alike().next());
            if !decides.is_some_and(|other| std::ptr::eq(other, key)) {
                continue;
            }
            let applies = applies(key);
            match (raw, key.need) {
                (Some(raw), _) if applies == Some(false) => self.not_applicable(&section, key, raw.span(), case),
                (Some(raw), _) => {
                    let got =
                        SectionValue { span: raw.span(), given: true, value: self.value(key.name, &key.kind, raw) };
                    self.note(&section.path, key, &got);
                    section.values.insert(key.name, got);
                }
                (None, Need::Required) if applies == Some(true) => {
                    let fault = Fault::MissingKey {
                        section: form.title.to_owned(),
                        key: key.name,
                        example: example(&key.kind),
                    };
                    self.fault(span.clone(), fault);
                }
                (None, Need::Default(text)) if applies != Some(false) => {
                    let parsed = DeValue::parse(text).ok().filter(|_| {
                        !matches!(key.kind, Kind::Name | Kind::Text | Kind::Choice(_) | Kind::Fields { .. })
                    });
                    let raw = parsed.unwrap_or_else(|| Spanned::new(span.clone(), DeValue::String(text.into())));
                    let amounts = self.currencies.len();
                    let value = self.value(key.name, &key.kind, &raw);
                    // A default amount is zero, whatever its currency.
                    self.currencies.truncate(amounts);
                    let got = SectionValue { span: span.clone(), given: false, value };
                    self.note(&section.path, key, &got);
                    section.values.insert(key.name, got);
                }
                (None, _) => {}
            }
        }
        section
    }

    /// Every entry of the tables under `key`. `case`, a key with its value, decides keys that
    /// depend on something outside the entry.
    #[expect(clippy::wildcard_enum_match_arm, reason = "every other value of TOML is a fault")]
    pub fn sections<'d>(&mut self, section: &Section<'d>, key: &str, case: Option<(&str, &str)>) -> Vec<Section<'d>> {
        let (Some(form), Some(got)) = (table_form(section.form, key), section.got(key)) else { return Vec::new() };
        let Value::Raw(DeValue::Array(entries)) = &got.value else { return Vec::new() };
        let mut sections = Vec::with_capacity(entries.len());
        for (i, entry) in entries.iter().enumerate() {
            match entry.get_ref() {
                DeValue::Table(table) => {
                    // A part's operation keeps the part's name in its path.
                    let base =
                        if section.path.is_empty() { key.to_owned() } else { format!("{}, {key}", section.path) };
                    let path = if table.contains_key("name") { base } else { format!("{base} {}", i + 1) };
                    sections.push(self.section(form, &path, table, entry.span(), case));
                }
                other => {
                    self.wrong_type(key, other, &format!("a table {}", form.title), entry.span(), form.title.to_owned())
                }
            }
        }
        sections
    }

    /// The table under `key`, where it is a table.
    pub fn table<'d>(&mut self, section: &Section<'d>, key: &str) -> Option<Section<'d>> {
        self.table_in(section, key, None)
    }

    /// The rule under `key`, a word or a table with the word under `rule`, and that table; `None` where
    /// a problem was noted.
    pub fn rule<'d, T>(
        &mut self,
        section: &Section<'d>,
        key: &str,
        from_word: fn(&str) -> Option<T>,
    ) -> Option<(T, RuleTable<'d>)> {
        let table = self.table(section, key);
        let word =
            table.as_ref().map_or_else(|| section.chosen(key, from_word), |table| table.chosen("rule", from_word));
        word.map(|word| (word, RuleTable(table)))
    }

    /// The table under `key` with a `case` as in [`Walk::sections`].
    pub fn table_in<'d>(
        &mut self,
        section: &Section<'d>,
        key: &str,
        case: Option<(&str, &str)>,
    ) -> Option<Section<'d>> {
        let form = table_form(section.form, key)?;
        let got = section.got(key)?;
        let Value::Raw(DeValue::Table(table)) = &got.value else { return None };
        let path = if section.path.is_empty() { key.to_owned() } else { format!("{}, {key}", section.path) };
        Some(self.section(form, &path, table, got.span.clone(), case))
    }

    /// A table of names and texts; numbers and truth values may stand without quotes. `example` is
    /// shown where the value is no such table.
    #[expect(clippy::wildcard_enum_match_arm, reason = "every other value of TOML is a fault")]
    pub fn texts(&mut self, section: &Section<'_>, key: &str, example: &str) -> BTreeMap<String, String> {
        let mut texts = BTreeMap::new();
        let Some(got) = section.got(key) else { return texts };
        let Value::Raw(DeValue::Table(table)) = &got.value else {
            if let Value::Raw(other) = &got.value {
                self.wrong_type(key, other, "a table of names and texts", got.span.clone(), example.to_owned());
            }
            return texts;
        };
        for (name, value) in table {
            let text = match value.get_ref() {
                DeValue::String(text) => text.to_string(),
                DeValue::Integer(integer) => integer.as_str().to_owned(),
                DeValue::Float(float) => float.as_str().to_owned(),
                DeValue::Boolean(flag) => flag.to_string(),
                other => {
                    let expected = "a text, a number or a truth value";
                    self.wrong_type(name.get_ref(), other, expected, value.span(), "\"…\"".to_owned());
                    continue;
                }
            };
            texts.insert(name.get_ref().to_string(), text);
        }
        texts
    }

    fn not_applicable(&mut self, section: &Section<'_>, key: &Key, span: Span, case: Option<(&str, &str)>) {
        let Some(when) = key.when else { return };
        let outside = case.filter(|(name, _)| *name == when.key).map(|(_, value)| value);
        let chosen = outside.or_else(|| section.text(when.key)).unwrap_or_default();
        let applicable = section
            .form
            .keys
            .iter()
            .filter(|other| other.when.is_none_or(|when| when.values.contains(&chosen)))
            .map(|other| other.name)
            .collect::<Vec<_>>()
            .join(", ");
        let case = format!("{} = \"{chosen}\"", when.key);
        self.fault(span, Fault::NotApplicable { key: key.name, case, applicable });
    }

    fn value<'d>(&mut self, key: &str, kind: &Kind, raw: &Spanned<DeValue<'d>>) -> Value<'d> {
        let span = raw.span();
        match (kind, raw.get_ref()) {
            (Kind::Quantity(quantity), _) => self.quantity(key, quantity, raw),
            (Kind::Name, DeValue::String(text)) => {
                if text.trim().is_empty() || text.chars().count() > 100 || text.chars().any(char::is_control) {
                    let fault = Fault::WrongType {
                        key: key.to_owned(),
                        read: format!("{text:?}"),
                        expected: "a name of 1 to 100 printable characters".to_owned(),
                        example: example(kind),
                    };
                    self.fault(span, fault);
                    return Value::Faulty;
                }
                Value::Text(text.to_string())
            }
            (Kind::Text | Kind::Reference(_), DeValue::String(text)) => Value::Text(text.to_string()),
            (Kind::Choice(choices), DeValue::String(text)) => {
                if choices.contains(&&**text) {
                    return Value::Text(text.to_string());
                }
                let fault = Fault::UnknownChoice {
                    key: key.to_owned(),
                    read: text.to_string(),
                    nearest: nearest(text, choices.iter().copied()).map(str::to_owned),
                    choices: choices.join(", "),
                };
                self.fault(span, fault);
                Value::Faulty
            }
            (Kind::Or { words, .. }, DeValue::String(text)) if words.contains(&&**text) => {
                Value::Text(text.to_string())
            }
            (Kind::Or { words, other }, DeValue::String(text))
                if text.trim_start().starts_with(char::is_alphabetic) =>
            {
                let fault = Fault::UnknownChoice {
                    key: key.to_owned(),
                    read: text.to_string(),
                    nearest: nearest(text, words.iter().copied()).map(str::to_owned),
                    choices: format!("{}, or {}", words.join(", "), expected(other)),
                };
                self.fault(span, fault);
                Value::Faulty
            }
            (Kind::Dated(_), DeValue::String(text)) if begins_as_date(text) => Value::Text(text.to_string()),
            (Kind::Dated(other) | Kind::Or { other, .. }, _) => self.value(key, other, raw),
            (Kind::Count { min, max }, DeValue::Integer(integer)) => {
                match u64::from_str_radix(integer.as_str(), integer.radix())
                    .ok()
                    .filter(|count| (min..=max).contains(&count))
                {
                    Some(count) => Value::Count(count),
                    None => {
                        let upper = if *max == u64::MAX { "up".to_owned() } else { format!("to {max}") };
                        let fault = Fault::OutOfRange {
                            key: key.to_owned(),
                            read: integer.to_string(),
                            range: format!("{min} {upper}"),
                            meant: Vec::new(),
                        };
                        self.fault(span, fault);
                        Value::Faulty
                    }
                }
            }
            (Kind::Flag, DeValue::Boolean(flag)) => Value::Flag(*flag),
            (Kind::List(item), DeValue::Array(items)) => {
                let read = |raw: &Spanned<DeValue<'d>>| SectionValue {
                    span: raw.span(),
                    given: true,
                    value: self.value(key, item, raw),
                };
                Value::List(items.iter().map(read).collect())
            }
            (Kind::List(item), DeValue::String(_)) => {
                let value = self.value(key, item, raw);
                Value::List(vec![SectionValue { span, given: true, value }])
            }
            (Kind::Shorthand { word, .. } | Kind::Fields { word, .. }, other) if !other.is_table() => {
                self.value(key, word, raw)
            }
            (Kind::Shorthand { .. } | Kind::Fields { .. } | Kind::Table(_), DeValue::Table(_))
            | (Kind::Tables(_), DeValue::Array(_))
            | (Kind::Parameters | Kind::Texts | Kind::Content(_), _)
            | (Kind::Amount, DeValue::String(_) | DeValue::Integer(_) | DeValue::Float(_)) => {
                Value::Raw(raw.get_ref().clone())
            }
            (_, other) => {
                self.wrong_type(key, other, &expected(kind), span, example(kind));
                Value::Faulty
            }
        }
    }

    /// A quantity with its unit; ratios may be bare numbers.
    #[expect(clippy::wildcard_enum_match_arm, reason = "every other value of TOML is a fault")]
    pub fn quantity<'d>(&mut self, key: &str, quantity: &Quantity, raw: &Spanned<DeValue<'d>>) -> Value<'d> {
        let number = match raw.get_ref() {
            DeValue::String(text) => text.to_string(),
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().to_owned(),
            DeValue::Float(float) => float.as_str().to_owned(),
            other => {
                self.wrong_type(
                    key,
                    other,
                    &expected(&Kind::Quantity(*quantity)),
                    raw.span(),
                    quoted(quantity.example),
                );
                return Value::Faulty;
            }
        };
        let not_finite =
            matches!(number.trim().trim_start_matches(['+', '-']).to_lowercase().as_str(), "inf" | "nan" | "infinity");
        let value = match unit::quantity(&number, quantity.unit) {
            Ok(value) => value,
            Err(_) if not_finite => f64::NAN,
            Err(reason) => {
                // Past the opening quote; the text of a --set has none.
                let quote = usize::from(raw.span().len() > number.len());
                let start = raw.span().start + quote + reason.at();
                let span =
                    if reason.at() > 0 && start < raw.span().end { start..raw.span().end - quote } else { raw.span() };
                self.fault(
                    span,
                    Fault::Quantity { key: key.to_owned(), example: fix(quantity, &number, &reason), reason },
                );
                return Value::Faulty;
            }
        };
        if unit::parse(quantity.unit).is_ok_and(|unit| unit.dimension[7] != 0) {
            let words = number.split(|c: char| !c.is_ascii_alphabetic());
            let used = words.filter_map(|word| CURRENCIES.iter().find(|code| **code == word));
            self.currencies.extend(used.map(|code| (*code, raw.span())));
        }
        if !quantity.admits(value) {
            let fault = Fault::OutOfRange {
                key: key.to_owned(),
                read: number.clone(),
                range: range(quantity),
                meant: meant(quantity, &number),
            };
            self.fault(raw.span(), fault);
            return Value::Faulty;
        }
        Value::Si(value)
    }

    /// Notes a value of another kind than the key takes; `example` would do.
    pub fn wrong_type(&mut self, key: &str, read: &DeValue<'_>, expected: &str, span: Span, example: String) {
        let fault =
            Fault::WrongType { key: key.to_owned(), read: described(read), expected: expected.to_owned(), example };
        self.fault(span, fault);
    }

    fn note(&mut self, path: &str, key: &Key, got: &SectionValue<'_>) {
        let Some(mut value) = understood(&key.kind, &got.value) else { return };
        if matches!(key.kind, Kind::Quantity(quantity) if quantity.display.starts_with("EUR"))
            && !self.currency.is_empty()
        {
            value = value.replace("EUR", &self.currency);
        }
        let (section, key, span) = (path.to_owned(), key.name.to_owned(), got.span.clone());
        self.echo.push(Echo { section, key, value, span, default: !got.given });
    }
}

/// Whether a text begins as a date does: year-month-.
fn begins_as_date(text: &str) -> bool {
    let text = text.trim_start().as_bytes();
    let digits = |range: Range<usize>| text.get(range).is_some_and(|part| part.iter().all(u8::is_ascii_digit));
    digits(0..4) && text.get(4) == Some(&b'-') && digits(5..7) && text.get(7) == Some(&b'-')
}

/// The form of the tables under a key, where it takes tables.
pub(crate) fn table_form(form: &Form, key: &str) -> Option<&'static Form> {
    match form.key(key)?.kind {
        Kind::Table(form) | Kind::Tables(form) | Kind::Shorthand { form, .. } => Some(form),
        Kind::Name
        | Kind::Text
        | Kind::Quantity(_)
        | Kind::Count { .. }
        | Kind::Flag
        | Kind::Choice(_)
        | Kind::Or { .. }
        | Kind::Dated(_)
        | Kind::Reference(_)
        | Kind::List(_)
        | Kind::Fields { .. }
        | Kind::Parameters
        | Kind::Texts
        | Kind::Content(_)
        | Kind::Amount => None,
    }
}
