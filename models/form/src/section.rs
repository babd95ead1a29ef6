//! A section whose keys were read, and the values of it.

use crate::form::Form;
use std::collections::BTreeMap;
use std::ops::Range;
use toml::de::DeValue;

/// Bytes of the file, or of a `--set` past its end.
pub type Span = Range<usize>;

/// A value of a section.
#[derive(Clone, Debug)]
pub struct SectionValue<'d> {
    /// Where it stands.
    pub span: Span,
    /// Whether the file gives it; else it is the default.
    pub given: bool,
    /// What it is.
    pub value: Value<'d>,
}

/// What was read under a key.
#[derive(Clone, Debug)]
pub enum Value<'d> {
    /// SI number.
    Si(f64),
    /// A whole number.
    Count(u64),
    /// A name, word or line.
    Text(String),
    /// `true` or `false`.
    Flag(bool),
    /// Several values.
    List(Vec<SectionValue<'d>>),
    /// Not looked into yet.
    Raw(DeValue<'d>),
    /// Refused; the problem is noted.
    Faulty,
}

/// A section whose keys were read.
///
/// A value is missing where the key is left out without a default, and where a problem was noted.
#[derive(Clone, Debug)]
pub struct Section<'d> {
    /// What describes it.
    pub form: &'static Form,
    /// Where it stands.
    pub span: Span,
    /// As people are told it, `machine L1`.
    pub path: String,
    pub(crate) values: BTreeMap<&'static str, SectionValue<'d>>,
}

impl<'d> Section<'d> {
    /// The value of a key with its place.
    pub fn got(&self, key: &str) -> Option<&SectionValue<'d>> {
        self.values.get(key)
    }

    /// Bytes of the value, or of the section where the key is left out.
    pub fn span_of(&self, key: &str) -> Range<usize> {
        self.got(key).filter(|got| got.given).map_or(self.span.clone(), |got| got.span.clone())
    }

    /// Whether the file gives the key.
    pub fn given(&self, key: &str) -> bool {
        self.got(key).is_some_and(|got| got.given)
    }

    /// A quantity in SI units.
    pub fn si(&self, key: &str) -> Option<f64> {
        if let Value::Si(value) = self.got(key)?.value { Some(value) } else { None }
    }

    /// A value that must be there; NaN only where a problem was noted.
    pub fn required(&self, key: &str) -> f64 {
        self.si(key).unwrap_or(f64::NAN)
    }

    /// A whole number.
    pub fn count(&self, key: &str) -> Option<u64> {
        if let Value::Count(count) = self.got(key)?.value { Some(count) } else { None }
    }

    /// A count within `u32` by its form.
    pub fn count32(&self, key: &str) -> u32 {
        self.count(key).and_then(|count| u32::try_from(count).ok()).unwrap_or(1)
    }

    /// A name, word or line.
    pub fn text(&self, key: &str) -> Option<&str> {
        if let Value::Text(text) = &self.got(key)?.value { Some(text) } else { None }
    }

    /// The variant of the word under `key`, by the `from_word` of the vocabulary whose words the key
    /// admits; `None` where the key is left out without a default, and where a problem was noted.
    ///
    /// # Panics
    /// Where the key admits a word that is not in that vocabulary.
    pub fn chosen<T>(&self, key: &str, from_word: fn(&str) -> Option<T>) -> Option<T> {
        let word = self.text(key)?;
        let variant = from_word(word);
        assert!(variant.is_some(), "{}: `{key}` admits `{word}`, which its vocabulary lacks", self.form.title);
        variant
    }

    /// `true` or `false`.
    pub fn flag(&self, key: &str) -> Option<bool> {
        if let Value::Flag(flag) = self.got(key)?.value { Some(flag) } else { None }
    }

    /// The quantities of a list in SI units; `None` where one of them has a problem.
    pub fn numbers(&self, key: &str) -> Option<Vec<f64>> {
        let Value::List(list) = &self.got(key)?.value else { return None };
        let number = |got: &SectionValue<'_>| if let Value::Si(value) = got.value { Some(value) } else { None };
        list.iter().map(number).collect()
    }

    /// The texts of a list.
    pub fn texts(&self, key: &str) -> Vec<String> {
        let text = |got: &SectionValue<'_>| if let Value::Text(text) = &got.value { Some(text.clone()) } else { None };
        self.list(key).iter().filter_map(text).collect()
    }

    /// The values of a list with their places; none where it is left out.
    pub fn list(&self, key: &str) -> &[SectionValue<'d>] {
        match self.got(key).map(|got| &got.value) {
            Some(Value::List(list)) => list,
            _ => &[],
        }
    }
}

/// The numbers of a rule: none where the rule is only a word.
#[derive(Clone, Debug)]
pub struct RuleTable<'d>(pub(crate) Option<Section<'d>>);

impl<'d> RuleTable<'d> {
    /// The table, where there is one.
    pub fn get(&self) -> Option<&Section<'d>> {
        self.0.as_ref()
    }

    /// The table of a rule that cannot do without numbers.
    ///
    /// # Panics
    /// Where the key admits the bare word of such a rule.
    pub fn due(&self) -> &Section<'d> {
        self.get().expect("a key admits no bare word of a rule with required numbers")
    }

    /// A quantity that may be left out, SI.
    pub fn si(&self, key: &str) -> Option<f64> {
        self.get().and_then(|table| table.si(key))
    }
}
