//! What a mapping file says.

use super::super::columns::{ColumnKind, RecordColumn};
use super::super::combine::{COMBINES, Combine};
use super::super::{RecordKind, csv_table};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use toolroom_form::{Fault, Form, Key, Kind, ReadError, Refusal, Section, Walk, nearest};
use toolroom_process::unit;

const NUMBER: Kind = Kind::quantity("1", "1", -1e30, 1e30, "1");

/// Where a column of the records comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// A column of the file.
    Column {
        /// Its header, with or without its unit.
        from: String,
        /// Unit of its numbers, where the header does not say it.
        unit: Option<String>,
        /// What its numbers are multiplied by before that.
        factor: f64,
        /// Whether it is a running total of which the differences count.
        running: bool,
        /// Words for the texts of the file.
        values: BTreeMap<String, String>,
    },
    /// The same number everywhere, SI.
    Number(f64),
    /// The same text everywhere.
    Text(String),
}

/// One column of the records and its origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapped {
    /// The column.
    pub column: &'static RecordColumn,
    /// Where it comes from.
    pub origin: Origin,
    /// How samples are combined.
    pub combine: Combine,
}

/// A condition on the rows of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct Keep {
    /// Column of the file.
    pub from: String,
    /// Least number.
    pub at_least: f64,
    /// Greatest number.
    pub at_most: f64,
    /// Text.
    pub is: Option<String>,
}

/// How a table becomes records.
#[derive(Clone, Debug, PartialEq)]
pub struct Mapping {
    /// Kind of records.
    pub kind: RecordKind,
    /// Columns.
    pub columns: Vec<Mapped>,
    /// Rows that count.
    pub keep: Vec<Keep>,
    /// Rows of one edge that make up one operation.
    pub rows: usize,
}

/// Kinds of records that tables of others become; runs of part programs come from logs of controls.
const IMPORTED: [RecordKind; 5] =
    [RecordKind::Turning, RecordKind::Milling, RecordKind::Grinding, RecordKind::Shop, RecordKind::Empirical];

/// The words of [`IMPORTED`].
const IMPORTED_WORDS: [&str; 5] = {
    let mut words = [""; 5];
    let mut i = 0;
    while i < words.len() {
        words[i] = IMPORTED[i].name();
        i += 1;
    }
    words
};

/// The form of a mapping file.
pub static MAPPING: Form = Form {
    title: "the mapping",
    doc: "What the columns of a measured table are, for toolroom import csv",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::default("title", Kind::Text, "", "One line for people: which data"),
        Key::required("process", Kind::Choice(&IMPORTED_WORDS), "Kind of records"),
        Key::default(
            "rows_per_operation",
            Kind::Count { min: 1, max: 1_000_000_000 },
            "1",
            "Rows of one edge that make up one operation: samples of a series",
        ),
        Key::required("column", Kind::Tables(&COLUMN), "Columns of the records"),
        Key::optional("keep", Kind::Tables(&KEEP), "Conditions on the rows that count"),
    ],
};

static COLUMN: Form = Form {
    title: "[[column]]",
    doc: "One column of the records",
    keys: &[
        Key::required("name", Kind::Name, "Name in the records"),
        Key::optional("from", Kind::Text, "Header in the file"),
        Key::optional("constant", Kind::Text, "The same value in every row, with its unit"),
        Key::optional("unit", Kind::Text, "Unit of the file's numbers, where the header does not say it"),
        Key::optional("factor", NUMBER, "What the file's numbers are multiplied by first"),
        Key::default("running", Kind::Flag, "false", "A running total: the differences from row to row count"),
        Key::optional("values", Kind::Texts, "Words for the file's texts, { 1 = \"cast iron\" }"),
        Key::optional("combine", Kind::Choice(COMBINES), "How samples become the number of an operation"),
    ],
};

static KEEP: Form = Form {
    title: "[[keep]]",
    doc: "Rows outside are left out",
    keys: &[
        Key::required("from", Kind::Text, "Header in the file"),
        Key::optional("at_least", NUMBER, "Least number, in the file's unit"),
        Key::optional("at_most", NUMBER, "Greatest number, in the file's unit"),
        Key::optional("is", Kind::Text, "The text that has to stand there"),
    ],
};

impl Mapping {
    /// Reads a mapping file; `overrides` as after `--set`.
    ///
    /// # Errors
    /// Every fault of the file, with its place.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, ReadError> {
        toolroom_form::read(path, overrides, &MAPPING, resolve).map(|file| file.content)
    }

    /// Reads the text of a mapping; `file` is its name in messages.
    ///
    /// # Errors
    /// Every fault of the text, with its place.
    pub fn parse(file: &str, text: &str, overrides: &[String]) -> Result<Self, ReadError> {
        toolroom_form::parse(file, text, overrides, &MAPPING, resolve).map(|file| file.content)
    }

    /// The mapping of a column.
    pub fn column(&self, name: &str) -> Option<&Mapped> {
        self.columns.iter().find(|mapped| mapped.column.name == name)
    }
}

fn resolve(walk: &mut Walk, root: &Section<'_>) -> Option<Mapping> {
    let word = root.text("process")?;
    let kind = IMPORTED.into_iter().find(|kind| kind.name() == word)?;
    let sections = walk.sections(root, "column", None);
    let mut columns: Vec<Mapped> = Vec::new();
    for section in &sections {
        let Some(mapped) = column(walk, section, kind) else { continue };
        if columns.iter().any(|other| other.column.name == mapped.column.name) {
            let name = mapped.column.name.to_owned();
            walk.fault(section.span_of("name"), Fault::DuplicateName { kind: "column", name });
        } else {
            columns.push(mapped);
        }
    }
    let made = |column: &RecordColumn| kind.generated().is_some_and(|made| made.contains(&column.name));
    // A [[column]] that is wrong is reported where it stands.
    let given = |column: &RecordColumn| sections.iter().any(|section| section.text("name") == Some(column.name));
    let lacking = kind.columns().iter().filter(|column| column.required && !made(column) && !given(column));
    let lacking: Vec<&str> = lacking.map(|column| column.name).collect();
    if let [first, ..] = lacking[..] {
        let refusal = Refusal {
            code: "missing-key",
            message: format!("{} records need {}, which no [[column]] gives", kind.name(), lacking.join(", ")),
            fix: Some(format!("add a [[column]] with name = \"{first}\" and from or constant")),
        };
        walk.fault(root.span_of("process"), Fault::Content(Arc::new(refusal)));
    }
    let keep = walk.sections(root, "keep", None);
    let keep = keep.iter().map(|section| Keep {
        from: section.text("from").unwrap_or_default().to_owned(),
        at_least: section.si("at_least").unwrap_or(f64::NEG_INFINITY),
        at_most: section.si("at_most").unwrap_or(f64::INFINITY),
        is: section.text("is").map(str::to_owned),
    });
    let rows = usize::try_from(root.count("rows_per_operation")?).unwrap_or(usize::MAX);
    Some(Mapping { kind, columns, keep: keep.collect(), rows })
}

fn column(walk: &mut Walk, section: &Section<'_>, kind: RecordKind) -> Option<Mapped> {
    let name = section.text("name")?;
    let Some(column) = kind.column(name) else {
        let names = || kind.columns().iter().map(|column| column.name);
        let fault = Fault::UnknownName {
            kind: "column of these records",
            name: name.to_owned(),
            nearest: nearest(name, names()).map(str::to_owned),
            known: names().collect::<Vec<_>>().join(", "),
        };
        walk.fault(section.span_of("name"), fault);
        return None;
    };
    let values = walk.texts(section, "values", "{ 1 = \"cast iron\" }");
    let is_text = column.kind == ColumnKind::Text;
    let unfit = |key: &'static str| {
        let rule = if is_text { "a text has no unit and no arithmetic" } else { "a number has no words" };
        (key, Fault::Beside { key, beside: "name", rule })
    };
    let wrong: &[&'static str] = if is_text { &["unit", "factor", "running", "combine"] } else { &["values"] };
    for (key, fault) in wrong.iter().filter(|key| section.given(key)).map(|key| unfit(key)) {
        walk.fault(section.span_of(key), fault);
    }
    let combine = section.text("combine").and_then(Combine::named).unwrap_or(column.combine);
    let origin = match (section.text("from"), section.text("constant")) {
        (Some(_), Some(_)) => {
            let rule = "a column is either read or constant";
            walk.fault(section.span_of("constant"), Fault::Beside { key: "constant", beside: "from", rule });
            return None;
        }
        (None, None) => {
            let fault = Fault::MissingKey {
                section: format!("[[column]] {name}"),
                key: "from",
                example: "\"header\"".to_owned(),
            };
            walk.fault(section.span_of("name"), fault);
            return None;
        }
        (None, Some(text)) if is_text => Origin::Text(text.to_owned()),
        (None, Some(text)) => match unit::quantity(text, column.unit) {
            Ok(value) => Origin::Number(value),
            Err(reason) => {
                let example = format!("1 {}", column.display);
                let fault = Fault::Quantity { key: "constant".to_owned(), reason, example };
                walk.fault(section.span_of("constant"), fault);
                return None;
            }
        },
        (Some(from), None) => {
            if let Some(read) = section.text("unit").filter(|_| !is_text)
                && csv_table::scale(read, column.unit).is_none()
            {
                let reason = unit::quantity(&format!("1 {read}"), column.unit).err()?;
                let fault = Fault::Quantity { key: "unit".to_owned(), reason, example: column.display.to_owned() };
                walk.fault(section.span_of("unit"), fault);
                return None;
            }
            Origin::Column {
                from: from.to_owned(),
                unit: section.text("unit").map(str::to_owned),
                factor: section.si("factor").unwrap_or(1.0),
                running: section.flag("running").unwrap_or(false),
                values,
            }
        }
    };
    Some(Mapped { column, origin, combine })
}
