//! The vocabulary in which the sections of a file are described: one table a section, from which
//! reader, JSON schema, echo and error texts are all made.

use toolroom_process::Field;

/// A section: `[shop]`, one `[[machine]]`, one inline table.
#[derive(Debug)]
pub struct Form {
    /// How people write it, `[[machine]]`.
    pub title: &'static str,
    /// One line for people.
    pub doc: &'static str,
    /// Keys in the order in which they are explained.
    pub keys: &'static [Key],
}

/// One key of a section.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// As written.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// Whether it has to be there.
    pub need: Need,
    /// The choice of another key of the section under which it applies; always, if `None`.
    pub when: Option<KeyCondition>,
    /// One line for people.
    pub doc: &'static str,
}

/// The condition under which a key applies: `key` has one of `values`.
#[derive(Clone, Copy, Debug)]
pub struct KeyCondition {
    /// The deciding key.
    pub key: &'static str,
    /// Its values under which this one applies.
    pub values: &'static [&'static str],
}

/// Whether a key has to be there.
#[derive(Clone, Copy, Debug)]
pub enum Need {
    /// It has to.
    Required,
    /// It may be left out.
    Optional,
    /// Left out, it has this value, written as in a file (without quotes for text).
    Default(&'static str),
}

/// What a key takes.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    /// A name or word.
    Name,
    /// A line for people.
    Text,
    /// A number with its unit.
    Quantity(Quantity),
    /// A whole number.
    Count {
        /// Least.
        min: u64,
        /// Greatest.
        max: u64,
    },
    /// `true` or `false`.
    Flag,
    /// One word of these.
    Choice(&'static [&'static str]),
    /// One of these words, or something else.
    Or {
        /// The words.
        words: &'static [&'static str],
        /// What else it may be.
        other: &'static Kind,
    },
    /// A date such as `2026-03-30 06:00`, or something else. The kind of file reads the date, which stays a text.
    Dated(&'static Kind),
    /// The name of another section's entry, of this kind.
    Reference(&'static str),
    /// One or more, in brackets; a single one may stand without.
    List(&'static Kind),
    /// A section or inline table.
    Table(&'static Form),
    /// Sections `[[…]]` or an array of inline tables.
    Tables(&'static Form),
    /// A word, or a table whose key `selector` is that word.
    Shorthand {
        /// The scalar form.
        word: &'static Kind,
        /// The full form.
        form: &'static Form,
    },
    /// A word, or a table of values of a record, each in the unit of its field.
    Fields {
        /// The scalar form.
        word: &'static Kind,
        /// The record's fields.
        fields: &'static [Field],
    },
    /// Groups of parameters of a process, `{ group = { name = value } }`.
    Parameters,
    /// A table of texts or numbers under names that the file chooses.
    Texts,
    /// A value that the kind of file reads itself.
    Content(&'static Content),
    /// A number with its unit, which follows from another key; a ratio may stand without quotes.
    Amount,
}

/// What messages and editors say about a value that a kind of file reads itself.
#[derive(Debug)]
pub struct Content {
    /// What is due, in words.
    pub expected: &'static str,
    /// A value that would do, as written in a file.
    pub example: &'static str,
    /// Its JSON schema.
    pub schema: fn() -> serde_json::Value,
    /// Of a list of tables, the key by which `--set` calls an entry, and the key that it sets where it
    /// names none: `--set effects.threshold_force="5 N"`. An entry that is missing is added.
    pub entry: Option<[&'static str; 2]>,
}

/// Currencies whose amounts can be read.
pub const CURRENCIES: &[&str] = &["EUR", "USD", "GBP", "CHF", "JPY", "CNY", "INR", "RUB"];

/// The unit and range of a quantity.
#[derive(Clone, Copy, Debug)]
pub struct Quantity {
    /// SI unit.
    pub unit: &'static str,
    /// Unit in which people are answered.
    pub display: &'static str,
    /// Least admissible value, SI.
    pub min: f64,
    /// Greatest admissible value, SI.
    pub max: f64,
    /// Whether the least value itself is excluded.
    pub above: bool,
    /// A value that would do.
    pub example: &'static str,
}

impl Quantity {
    /// The quantity of a field of a record: its units and its range.
    pub const fn of(field: &Field) -> Self {
        let Field { unit, display, min, max, .. } = *field;
        Self { unit, display, min, max, above: false, example: "" }
    }

    /// Whether `value` (SI) may stand here.
    pub fn admits(&self, value: f64) -> bool {
        value.is_finite() && value <= self.max && if self.above { value > self.min } else { value >= self.min }
    }
}

/// Keys of several lists as one.
///
/// # Panics
/// Where `N` is not the number of all.
pub const fn joined<const N: usize>(lists: &[&[Key]]) -> [Key; N] {
    let mut all = [lists[0][0]; N];
    let (mut list, mut count) = (0, 0);
    while list < lists.len() {
        let mut key = 0;
        while key < lists[list].len() {
            all[count] = lists[list][key];
            (key, count) = (key + 1, count + 1);
        }
        list += 1;
    }
    assert!(count == N);
    all
}

/// The keys of a record, each optional, in the unit and range of its field.
///
/// # Panics
/// Where `N` is not the number of fields.
pub const fn record_keys<const N: usize>(fields: &'static [Field]) -> [Key; N] {
    assert!(fields.len() == N);
    let mut keys = [Key::of(&fields[0]); N];
    let mut i = 1;
    while i < N {
        keys[i] = Key::of(&fields[i]);
        i += 1;
    }
    keys
}

/// Whether the bytes of two texts are the same, also where constants are worked out.
pub const fn same(one: &[u8], other: &[u8]) -> bool {
    if one.len() != other.len() {
        return false;
    }
    let mut i = 0;
    while i < one.len() {
        if one[i] != other[i] {
            return false;
        }
        i += 1;
    }
    true
}

impl Kind {
    /// A number from `min` to `max`, both SI and admitted; `unit` is its SI unit, `display` the one in which people are
    /// answered, `example` a value that would do.
    pub const fn quantity(
        unit: &'static str,
        display: &'static str,
        min: f64,
        max: f64,
        example: &'static str,
    ) -> Self {
        Self::Quantity(Quantity { unit, display, min, max, above: false, example })
    }

    /// A number above zero up to `max`, SI; the rest as in [`Kind::quantity`].
    pub const fn positive(unit: &'static str, display: &'static str, max: f64, example: &'static str) -> Self {
        Self::Quantity(Quantity { unit, display, min: 0.0, max, above: true, example })
    }
}

impl Key {
    /// The optional key of a field of a record.
    pub const fn of(field: &'static Field) -> Self {
        Self::optional(field.name, Kind::Quantity(Quantity::of(field)), field.doc)
    }

    /// The optional key of the field of this name: a file that names some fields of a record has their ranges from it.
    ///
    /// # Panics
    /// While compiling, where no field has the name.
    pub const fn of_named(fields: &'static [Field], name: &str) -> Self {
        let mut i = 0;
        while i < fields.len() {
            if same(fields[i].name.as_bytes(), name.as_bytes()) {
                return Self::of(&fields[i]);
            }
            i += 1;
        }
        panic!("no field has the name")
    }

    /// The same key under another name, with its own meaning.
    pub const fn called(self, name: &'static str, doc: &'static str) -> Self {
        Self { name, doc, ..self }
    }

    /// The same key with a value where a file does not say.
    pub const fn by_default(self, value: &'static str) -> Self {
        Self { need: Need::Default(value), ..self }
    }

    /// A key that has to be there.
    pub const fn required(name: &'static str, kind: Kind, doc: &'static str) -> Self {
        Self { name, kind, need: Need::Required, when: None, doc }
    }

    /// A key that may be left out.
    pub const fn optional(name: &'static str, kind: Kind, doc: &'static str) -> Self {
        Self { name, kind, need: Need::Optional, when: None, doc }
    }

    /// A key with a default.
    pub const fn default(name: &'static str, kind: Kind, value: &'static str, doc: &'static str) -> Self {
        Self { name, kind, need: Need::Default(value), when: None, doc }
    }

    /// The same key, applying only where `key` has one of `values`.
    pub const fn when(mut self, key: &'static str, values: &'static [&'static str]) -> Self {
        self.when = Some(KeyCondition { key, values });
        self
    }
}

impl Form {
    /// The key called `name`.
    pub fn key(&self, name: &str) -> Option<&'static Key> {
        self.keys.iter().find(|key| key.name == name)
    }

    /// Names of all keys in their order, each once: a key may stand several times, one for each case in which it applies.
    pub fn key_names(&self) -> Vec<&'static str> {
        let mut names: Vec<&'static str> = Vec::new();
        for key in self.keys {
            if !names.contains(&key.name) {
                names.push(key.name);
            }
        }
        names
    }
}
