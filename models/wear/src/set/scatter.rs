//! The key `scatter` of files: one of three words, or a table of single values.

use crate::Scatter;
use toml::de::DeValue;
use toolroom_form::{Kind, Section, Value, Walk, set_record, vocabulary};
use toolroom_process::Record;

vocabulary! {
    /// Scatter of edges, workpieces and wear.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ScatterWord {
        /// All edges and workpieces alike.
        None = "none",
        /// That of a laboratory.
        Lab = "lab",
        /// That of a shop.
        Shop = "shop",
    }
}

impl From<ScatterWord> for Scatter {
    fn from(word: ScatterWord) -> Self {
        match word {
            ScatterWord::None => Self::none(),
            ScatterWord::Lab => Self::lab(),
            ScatterWord::Shop => Self::shop(),
        }
    }
}

impl Scatter {
    /// What the key `scatter` takes: a word, or a table that changes single values of the shop's scatter.
    pub const KIND: Kind = Kind::Fields { word: &Kind::Choice(ScatterWord::WORDS), fields: Self::FIELDS };

    /// The key `scatter` of a section; `None` where the file does not give it. Messages call its table `title`. Where
    /// the key is at fault, which the walk has noted, the shop's scatter stands for it.
    pub fn of_section(walk: &mut Walk, section: &Section<'_>, title: &str) -> Option<Self> {
        if !section.given("scatter") {
            return None;
        }
        let word = section.chosen("scatter", ScatterWord::from_word).unwrap_or(ScatterWord::Shop);
        let mut scatter = Self::from(word);
        if let Some(Value::Raw(DeValue::Table(table))) = section.got("scatter").map(|got| &got.value) {
            set_record(walk, title, table, &mut scatter);
        }
        Some(scatter)
    }
}
