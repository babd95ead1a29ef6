//! What a mapping of shop tables says.

use crate::source::Comparison;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use toml::de::DeValue;
use toolroom_form::{Content, Fault, Form, Key, Kind, ReadError, Refusal, Section, Value, Walk, nearest, vocabulary};
use toolroom_scenario::date;
use toolroom_scenario_file::{SCENARIO, literal};

vocabulary! {
    /// What the rows of a table are, in the order in which a scenario has them.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub(crate) enum TableKind {
        /// Shifts and holidays of calendars.
        Calendars = "calendars",
        /// Machines.
        Machines = "machines",
        /// Times of changing over, a pair of groups each.
        SetupMatrix = "setup_matrix",
        /// People.
        Operators = "operators",
        /// Parts.
        Parts = "parts",
        /// Parts that go into other parts.
        Components = "components",
        /// Operations of parts.
        Routings = "routings",
        /// Orders.
        Orders = "orders",
        /// Orders that are in the shop.
        Wip = "wip",
    }
}

/// The form of the tables under a key.
fn tables_of(form: &'static Form, key: &str) -> &'static Form {
    let Some(Kind::Tables(inner)) = form.key(key).map(|key| key.kind) else {
        unreachable!("{} has tables under `{key}`", form.title)
    };
    inner
}

impl TableKind {
    /// All of them, in that order.
    pub fn all() -> impl Iterator<Item = Self> {
        Self::WORDS.iter().filter_map(|word| Self::from_word(word))
    }

    /// The section that a row is.
    pub fn form(self) -> &'static Form {
        let top = |key: &str| tables_of(&SCENARIO, key);
        let of_part = |key: &str| tables_of(top("part"), key);
        match self {
            Self::Orders => top("order"),
            Self::Routings => of_part("operation"),
            Self::Machines => top("machine"),
            Self::Parts => top("part"),
            Self::Calendars => top("calendar"),
            Self::Operators => top("operator"),
            Self::SetupMatrix => top("setup_matrix"),
            Self::Wip => top("wip"),
            Self::Components => of_part("components"),
        }
    }

    /// Columns that are no keys of the section.
    fn special(self) -> &'static [&'static str] {
        match self {
            Self::Routings => &["part", "sequence"],
            Self::Calendars => &["days", "shift", "from", "to", "holiday"],
            Self::SetupMatrix => &["from", "to", "time"],
            Self::Components => &["part", "component", "quantity"],
            Self::Orders | Self::Machines | Self::Parts | Self::Operators | Self::Wip => &[],
        }
    }

    /// Columns without which no row can be understood.
    fn due(self) -> &'static [&'static str] {
        match self {
            Self::Orders => &["id", "part"],
            Self::Routings => &["part", "machines"],
            Self::Machines | Self::Parts | Self::Calendars => &["name"],
            Self::Operators => &["name", "skills"],
            Self::SetupMatrix => &["from", "to", "time"],
            Self::Wip => &["order", "operation"],
            Self::Components => &["part", "component"],
        }
    }

    /// Whether its columns are read by a rule of its own, and the keys of its section are not columns.
    fn own_columns(self) -> bool {
        matches!(self, Self::SetupMatrix | Self::Components)
    }

    /// What a column may be called; nested keys as `operator.setup`.
    pub fn columns(self) -> Vec<String> {
        let mut names: Vec<String> = self.special().iter().map(|name| (*name).to_owned()).collect();
        if self == Self::SetupMatrix {
            names.push("name".to_owned());
        }
        if self.own_columns() {
            return names;
        }
        for key in self.form().keys {
            match key.kind {
                Kind::Table(form) => names.extend(form.keys.iter().map(|inner| format!("{}.{}", key.name, inner.name))),
                Kind::Tables(_) | Kind::Parameters | Kind::Texts | Kind::Content(_) | Kind::Amount => {}
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
                | Kind::Shorthand { .. }
                | Kind::Fields { .. } => names.push(key.name.to_owned()),
            }
        }
        let mut once: Vec<String> = Vec::new();
        for name in names {
            if !once.contains(&name) {
                once.push(name);
            }
        }
        once
    }

    /// The kind of values of a column that is a key of its section.
    pub fn key(self, column: &str) -> Option<&'static Key> {
        if self.special().contains(&column) {
            return None;
        }
        match column.split_once('.') {
            Some((outer, inner)) => {
                if let Kind::Table(form) = self.form().key(outer)?.kind {
                    form.key(inner)
                } else {
                    None
                }
            }
            None => self.form().key(column),
        }
    }
}

/// A column of a table.
#[derive(Clone, Debug)]
pub(crate) struct ColumnMap {
    /// What it is.
    pub name: String,
    /// Its header.
    pub from: String,
    /// Unit of its numbers.
    pub unit: Option<String>,
    /// Form of its dates.
    pub format: Option<String>,
    /// Time of the day of dates without one.
    pub at: Option<String>,
    /// Coefficient of variation of a lognormal time with these means.
    pub cv: Option<f64>,
    /// Words for its texts.
    pub values: BTreeMap<String, String>,
}

/// A table and what it means.
#[derive(Clone, Debug)]
pub(crate) struct TableMap {
    pub kind: TableKind,
    pub file: String,
    pub sheet: Option<String>,
    /// Row of the headers, from 1; left out: the first that is not empty.
    pub header: Option<usize>,
    pub columns: Vec<ColumnMap>,
    pub keep: Vec<Comparison>,
    /// Keys and values, as files write them, of what a row leaves out.
    pub default: Vec<(String, String)>,
}

impl TableMap {
    /// The value of what rows leave out.
    pub fn default(&self, name: &str) -> Option<&str> {
        self.default.iter().find(|(key, _)| key == name).map(|(_, value)| value.as_str())
    }
}

/// What a mapping of shop tables says.
#[derive(Clone, Debug)]
pub struct ShopMapping {
    /// The scenario without what the tables give.
    pub(crate) base: String,
    pub(crate) tables: Vec<TableMap>,
}

/// The form of a mapping of shop tables.
pub static SHOP_MAPPING: Form = Form {
    title: "the mapping",
    doc: "What the tables of a shop are, for toolroom import shop",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::default("title", Kind::Text, "", "One line for people: which system"),
        Key::required(
            "base",
            Kind::Text,
            "A scenario without what the tables give: [shop], calendars, rules, variants; its text is taken as it is",
        ),
        Key::required("table", Kind::Tables(&TABLE), "Tables"),
    ],
};

static TABLE: Form = Form {
    title: "[[table]]",
    doc: "A table and what its rows are",
    keys: &[
        Key::required("kind", Kind::Choice(TableKind::WORDS), "What its rows are"),
        Key::required(
            "file",
            Kind::Text,
            "CSV in any delimiter, encoding and decimal sign, XLSX or ODS, beside this file",
        ),
        Key::optional("sheet", Kind::Text, "Sheet of a workbook; left out: its only one"),
        Key::optional(
            "header",
            Kind::Count { min: 1, max: 1_000_000 },
            "Row with the names of the columns; left out: the first that is not empty",
        ),
        Key::required("column", Kind::Tables(&COLUMN), "Columns; those that are not listed are passed over"),
        Key::optional(
            "where",
            Kind::Text,
            "Rows that count: comparisons of a column with a text or number, joined by `and`: \"Status != 'closed'\"",
        ),
        Key::optional("default", Kind::Content(&DEFAULT), "Values of what a row leaves out: { priority = 2 }"),
    ],
};

static DEFAULT: Content = Content {
    expected: "a table of columns and values",
    example: "{ priority = 2 }",
    schema: || {
        serde_json::json!({
            "type": "object",
            "additionalProperties": true,
            "description": "Values of columns that a row leaves out, as in a scenario",
        })
    },
    entry: None,
};

static COLUMN: Form = Form {
    title: "[[table.column]]",
    doc: "A column of a table",
    keys: &[
        Key::required("name", Kind::Name, "What it is: a key of the section, such as `quantity` of [[order]]"),
        Key::required("from", Kind::Text, "Its header in the table"),
        Key::optional("unit", Kind::Text, "Unit of its numbers, where the header does not say it"),
        Key::optional(
            "format",
            Kind::Text,
            "Form of its dates: \"%d.%m.%Y\" or \"%m/%d/%Y %H:%M\"; left out: 2026-03-30",
        ),
        Key::optional("at", Kind::Text, "Time of the day of dates without one: \"14:00\"; left out: midnight"),
        Key::optional(
            "cv",
            Kind::positive("1", "1", 10.0, "0.3"),
            "Scatter of a time: lognormal with the cell as its mean and this standard deviation over mean",
        ),
        Key::optional("values", Kind::Texts, "Words for the table's texts, { Zerspanung = \"plain\" }"),
    ],
};

impl ShopMapping {
    /// Reads a mapping file; `overrides` as after `--set`.
    ///
    /// # Errors
    /// Every fault of the file, with its place.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, ReadError> {
        toolroom_form::read(path, overrides, &SHOP_MAPPING, resolve).map(|file| file.content)
    }

    /// The file with what no table has, as the mapping names it: found from the folder of the mapping.
    pub fn base(&self) -> &str {
        &self.base
    }

    /// What it maps, for people: `orders of erp.csv`.
    pub fn tables(&self) -> Vec<String> {
        self.tables.iter().map(|table| format!("{} of {}", table.kind.word(), table.file)).collect()
    }
}

fn resolve(walk: &mut Walk, root: &Section<'_>) -> Option<ShopMapping> {
    let base = root.text("base").map(str::to_owned);
    let sections = walk.sections(root, "table", None);
    let tables: Vec<TableMap> = sections.iter().filter_map(|section| table(walk, section)).collect();
    Some(ShopMapping { base: base?, tables })
}

fn table(walk: &mut Walk, section: &Section<'_>) -> Option<TableMap> {
    let kind = section.chosen("kind", TableKind::from_word)?;
    let mut columns: Vec<ColumnMap> = Vec::new();
    for inner in walk.sections(section, "column", None) {
        let Some(column) = column(walk, &inner, kind) else { continue };
        if columns.iter().any(|other| other.name == column.name) {
            walk.fault(inner.span_of("name"), Fault::DuplicateName { kind: "column", name: column.name });
        } else {
            columns.push(column);
        }
    }
    let default = defaults(walk, section, kind);
    for due in kind.due() {
        let given = columns.iter().any(|column| column.name == *due) || default.iter().any(|(name, _)| name == due);
        if !given {
            let refusal = Refusal {
                code: "missing-key",
                message: format!("a table of {} needs the column `{due}`", kind.word()),
                fix: Some(format!("add {{ name = \"{due}\", from = \"header\" }} to `column`")),
            };
            walk.fault(section.span_of("kind"), Fault::Content(Arc::new(refusal)));
        }
    }
    let keep = match section.text("where").map(Comparison::parse) {
        Some(Ok(keep)) => keep,
        Some(Err(reason)) => {
            let refusal = Refusal {
                code: "where",
                message: format!("`where`: {reason}"),
                fix: Some("such as \"Status != 'closed' and Menge > 0\"".to_owned()),
            };
            walk.fault(section.span_of("where"), Fault::Content(Arc::new(refusal)));
            Vec::new()
        }
        None => Vec::new(),
    };
    let sheet = section.text("sheet").map(str::to_owned);
    let header = section.count("header").and_then(|row| usize::try_from(row).ok());
    Some(TableMap { kind, file: section.text("file")?.to_owned(), sheet, header, columns, keep, default })
}

fn column(walk: &mut Walk, section: &Section<'_>, kind: TableKind) -> Option<ColumnMap> {
    let (name, from) = (section.text("name")?, section.text("from")?);
    if !known(walk, section, ("name", name), kind) {
        return None;
    }
    if let Some(format) = section.text("format").filter(|format| !date::is_format(format)) {
        let message = format!("`format` = \"{format}\" is no form of dates");
        let fix = Some("such as \"%d.%m.%Y\" or \"%m/%d/%Y %H:%M\"".to_owned());
        walk.fault(section.span_of("format"), Fault::Content(Arc::new(Refusal { code: "no-date", message, fix })));
    }
    if let Some(clock) = section.text("at").filter(|clock| date::clock(clock).is_none()) {
        let message = format!("`at` = \"{clock}\" is no time of the day");
        let fix = Some("such as \"14:00\"".to_owned());
        walk.fault(section.span_of("at"), Fault::Content(Arc::new(Refusal { code: "no-date", message, fix })));
    }
    let random = matches!(kind.key(name).map(|key| key.kind), Some(Kind::Shorthand { .. }));
    if section.given("cv") && !random {
        let refusal =
            Refusal::new("not-applicable", format_args!("`cv` does not apply to `{name}`, which is no random time"));
        walk.fault(section.span_of("cv"), Fault::Content(Arc::new(refusal)));
    }
    Some(ColumnMap {
        name: name.to_owned(),
        from: from.to_owned(),
        unit: section.text("unit").map(str::to_owned),
        format: section.text("format").map(str::to_owned),
        at: section.text("at").map(str::to_owned),
        cv: section.si("cv"),
        values: walk.texts(section, "values", "{ Zerspanung = \"plain\" }"),
    })
}

/// Whether tables of a kind have such a column; a fault is noted at `key` where they have not.
fn known(walk: &mut Walk, section: &Section<'_>, (key, name): (&str, &str), kind: TableKind) -> bool {
    let columns = kind.columns();
    if columns.iter().any(|column| column == name) {
        return true;
    }
    let fault = Fault::UnknownName {
        kind: "column of such a table",
        name: name.to_owned(),
        nearest: nearest(name, columns.iter().map(String::as_str)).map(str::to_owned),
        known: columns.join(", "),
    };
    walk.fault(section.span_of(key), fault);
    false
}

/// The table `default`, its values as files write them.
fn defaults(walk: &mut Walk, section: &Section<'_>, kind: TableKind) -> Vec<(String, String)> {
    let Some(Value::Raw(value)) = section.got("default").map(|got| &got.value) else { return Vec::new() };
    let DeValue::Table(table) = value else {
        let example = DEFAULT.example.to_owned();
        walk.wrong_type("default", value, DEFAULT.expected, section.span_of("default"), example);
        return Vec::new();
    };
    let mut values = Vec::new();
    let nested = |name: &str| kind.columns().iter().any(|column| column.starts_with(&format!("{name}.")));
    for (name, value) in table {
        let name: &str = name.get_ref();
        // `operator.setup = …` is a table in a table.
        if let DeValue::Table(inner) = value.get_ref()
            && nested(name)
        {
            for (key, value) in inner {
                let name = format!("{name}.{}", key.get_ref());
                if known(walk, section, ("default", &name), kind) {
                    values.push((name, literal(value.get_ref())));
                }
            }
        } else if known(walk, section, ("default", name), kind) {
            values.push((name.to_owned(), literal(value.get_ref())));
        }
    }
    values
}
