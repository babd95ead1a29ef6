//! Tables of cells, and which of their rows count.

use crate::fault::{CellRef, Diagnostic, ShopImportError, Spot, UnplacedFault, letters};
use crate::mapping::TableMap;
use std::path::Path;
use toolroom_form::nearest;

/// What a cell shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Cell {
    pub text: String,
    /// Whether it is a date or time of a workbook, shown in ISO 8601: no `format` applies.
    pub is_date: bool,
}

/// A row that counts.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// Its number in the file, from 1.
    pub line: usize,
    pub cells: Vec<Cell>,
}

/// A table as it stands in its file.
#[derive(Debug, Default)]
pub(crate) struct Grid {
    pub sheet: Option<String>,
    pub rows: Vec<Row>,
    pub notes: Vec<String>,
}

/// A table by its mapping.
#[derive(Debug)]
pub(crate) struct Source {
    pub sheet: Option<String>,
    pub rows: Vec<Row>,
    /// For every column of the mapping, where it stands.
    pub columns: Vec<Option<usize>>,
    /// For every column of the mapping, the unit of its header.
    pub units: Vec<String>,
    left_out: usize,
    notes: Vec<String>,
}

impl Source {
    /// The cell of a column of the mapping; `None` where there is nothing in it.
    pub fn cell(&self, row: usize, column: usize) -> Option<&Cell> {
        self.rows[row].cells.get(self.columns[column]?).filter(|cell| !cell.text.is_empty())
    }

    /// One line for people.
    pub fn note(&self, map: &TableMap) -> String {
        let count = self.rows.len();
        let rows = if count == 1 { "row" } else { "rows" };
        let mut note = format!("{}: {count} {rows} of {}", map.kind.word(), map.file);
        if let Some(sheet) = &self.sheet {
            note += &format!(", sheet {sheet}");
        }
        if self.left_out > 0 {
            note += &format!("; {} left out by `where`", self.left_out);
        }
        for more in &self.notes {
            note += &format!("; {more}");
        }
        note
    }
}

/// Reads the table of a mapping. Columns that are missing are noted among `faults`.
pub(crate) fn read(path: &Path, map: &TableMap, faults: &mut Vec<UnplacedFault>) -> Result<Source, ShopImportError> {
    let grid = grid(path, map)?;
    let refused = |reason: String| ShopImportError::Table { file: map.file.clone(), reason };
    let mut rows = grid.rows.into_iter().filter(|row| row.cells.iter().any(|cell| !cell.text.is_empty()));
    let head = match map.header {
        Some(line) => rows.by_ref().find(|row| row.line >= line).filter(|row| row.line == line),
        None => rows.next(),
    };
    let Some(head) = head else { return Err(refused("there is no row of headers".to_owned())) };
    let titles: Vec<&str> = head.cells.iter().map(|cell| cell.text.trim()).collect();
    let place = || {
        let sheet = grid.sheet.as_ref().map_or_else(String::new, |sheet| format!(", sheet {sheet}"));
        let words = format!("{}{sheet}, row {}", map.file, head.line);
        Spot { words, file: map.file.clone(), line: Some(head.line) }
    };
    let mut located = |from: &str| {
        let found = position(&titles, from);
        if found.is_none() {
            let near = nearest(from, titles.iter().copied())
                .map_or_else(String::new, |near| format!("did you mean `{near}`? "));
            let known: Vec<&str> = titles.iter().copied().filter(|title| !title.is_empty()).collect();
            let told = Diagnostic {
                code: "table-cell",
                message: format!("there is no column \"{from}\""),
                fix: Some(format!("{near}columns: {}", known.join(", "))),
            };
            faults.push(UnplacedFault::Place(place(), told));
        }
        found
    };
    let columns: Vec<Option<usize>> = map.columns.iter().map(|column| located(&column.from)).collect();
    let keep: Vec<_> = map.keep.iter().map(|comparison| (located(&comparison.column), comparison)).collect();
    let units = columns.iter().map(|at| at.map_or("", |at| name_and_unit(titles[at]).1).to_owned()).collect();
    let mut kept = Vec::new();
    let mut left_out = 0;
    for row in rows {
        let mut counts = true;
        for (at, comparison) in keep.iter().filter_map(|(at, comparison)| Some(((*at)?, comparison))) {
            let cell = row.cells.get(at).map_or("", |cell| cell.text.trim());
            counts = comparison.holds(cell).unwrap_or_else(|| {
                let told = Diagnostic {
                    code: "where",
                    message: format!("`where` compares {} with a number, but it is \"{cell}\"", comparison.column),
                    fix: Some("mend the cell, or leave the row out by another comparison before this one".to_owned()),
                };
                let sheet = grid.sheet.as_ref().map_or_else(String::new, |sheet| format!(", sheet {sheet}"));
                let words = format!("{}{sheet}, row {}, cell {}{}", map.file, row.line, letters(at), row.line);
                faults.push(UnplacedFault::Place(Spot { words, file: map.file.clone(), line: Some(row.line) }, told));
                false
            });
            if !counts {
                break;
            }
        }
        if counts {
            kept.push(row);
        } else {
            left_out += 1;
        }
    }
    Ok(Source { sheet: grid.sheet, rows: kept, columns, units, left_out, notes: grid.notes })
}

/// The header as it stands, or its name without the unit.
fn position(titles: &[&str], from: &str) -> Option<usize> {
    let from = from.trim();
    let exact = titles.iter().position(|title| *title == from);
    exact.or_else(|| titles.iter().position(|title| name_and_unit(title).0 == from))
}

/// `name [unit]` in two. Round brackets are part of the name: they seldom hold a unit in tables of orders.
fn name_and_unit(title: &str) -> (&str, &str) {
    match title.find('[') {
        Some(open) => (title[..open].trim(), title[open + 1..].trim_end_matches(']').trim()),
        None => (title, ""),
    }
}

fn grid(path: &Path, map: &TableMap) -> Result<Grid, ShopImportError> {
    let refused = |reason: String| ShopImportError::Table { file: map.file.clone(), reason };
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default().to_lowercase();
    match extension.as_str() {
        "xlsx" | "xlsm" | "ods" => {
            #[cfg(feature = "xlsx")]
            return crate::workbook::grid(path, map);
            #[cfg(not(feature = "xlsx"))]
            return Err(refused("this program was built without the feature `xlsx`; save the sheet as CSV".to_owned()));
        }
        "xls" | "xlsb" => return Err(refused(format!("{extension} workbooks are not read; save it as XLSX"))),
        _ => {}
    }
    if map.sheet.is_some() {
        return Err(refused("only workbooks (XLSX, ODS) have sheets; take out `sheet`".to_owned()));
    }
    let bytes = std::fs::read(path).map_err(|error| refused(error.kind().to_string()))?;
    // Titles above the headers say nothing of what separates cells, so the reader does not see them.
    let wide = bytes.starts_with(&[0xFF, 0xFE]) || bytes.starts_with(&[0xFE, 0xFF]);
    let above = map.header.filter(|_| !wide).map_or(0, |row| row - 1);
    let start: usize = bytes.split_inclusive(|byte| *byte == b'\n').take(above).map(<[u8]>::len).sum();
    let table = toolroom_records::cells(&map.file, &bytes[start..]).map_err(|error| refused(error.to_string()))?;
    let cell = |text: String| Cell { text, is_date: false };
    let row =
        |(line, cells): (usize, Vec<String>)| Row { line: line + above, cells: cells.into_iter().map(cell).collect() };
    // The reader takes the first row for the headers; `header` may mean a later one.
    let first = Row { line: table.header_line + above, cells: table.header.into_iter().map(cell).collect() };
    let rows = std::iter::once(first).chain(table.rows.into_iter().map(row)).collect();
    Ok(Grid { sheet: None, rows, notes: table.notes })
}

/// What a comparison asks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Relation {
    Equal,
    Unequal,
    Less,
    AtMost,
    Greater,
    AtLeast,
}

/// One comparison of `where`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Comparison {
    pub column: String,
    relation: Relation,
    text: String,
}

impl Comparison {
    /// `Status != 'closed' and Menge > 0`.
    pub fn parse(text: &str) -> Result<Vec<Self>, String> {
        split(text).into_iter().map(|one| Self::one(one.trim())).collect()
    }

    fn one(text: &str) -> Result<Self, String> {
        let relations = [
            ("!=", Relation::Unequal),
            ("<=", Relation::AtMost),
            (">=", Relation::AtLeast),
            ("==", Relation::Equal),
            ("=", Relation::Equal),
            ("<", Relation::Less),
            (">", Relation::Greater),
        ];
        let first = relations.iter().filter_map(|(sign, relation)| Some((text.find(sign)?, sign, *relation)));
        // Of signs at one place the longer one is meant; the list has it first.
        let Some((at, sign, relation)) = first.min_by_key(|(at, ..)| *at) else {
            return Err(format!("`{text}` is no comparison"));
        };
        let column = text[..at].trim().trim_matches(['\'', '"', '`']).to_owned();
        let value = text[at + sign.len()..].trim();
        let quoted = value.len() >= 2 && value.starts_with(['\'', '"']) && value.ends_with(['\'', '"']);
        let bare = value.parse::<f64>().is_ok_and(f64::is_finite);
        if column.is_empty() || !(quoted || bare) {
            return Err(format!("`{text}`: a column is compared with a 'text' or a number"));
        }
        let value = if quoted { &value[1..value.len() - 1] } else { value };
        let ordered = !matches!(relation, Relation::Equal | Relation::Unequal);
        if ordered && quoted {
            return Err(format!("`{text}`: only numbers are greater or less"));
        }
        Ok(Self { column, relation, text: value.to_owned() })
    }

    /// Whether a cell meets it; an empty one is neither greater nor less than a number. `None` where a text is compared so: a slip
    /// of a quantity would silently leave its order out.
    fn holds(&self, cell: &str) -> Option<bool> {
        let numbers = cell.parse::<f64>().ok().zip(self.text.parse::<f64>().ok());
        let equal = numbers.map_or_else(|| cell == self.text, |(cell, text)| cell == text);
        let ordered = |holds: fn(f64, f64) -> bool| match numbers {
            Some((cell, text)) => Some(holds(cell, text)),
            None if cell.is_empty() => Some(false),
            None => None,
        };
        match self.relation {
            Relation::Equal => Some(equal),
            Relation::Unequal => Some(!equal),
            Relation::Less => ordered(|cell, text| cell < text),
            Relation::AtMost => ordered(|cell, text| cell <= text),
            Relation::Greater => ordered(|cell, text| cell > text),
            Relation::AtLeast => ordered(|cell, text| cell >= text),
        }
    }
}

/// The comparisons between the words `and` that stand outside quotes.
fn split(text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut start, mut quote) = (0, None);
    for (at, letter) in text.char_indices() {
        match quote {
            Some(open) if letter == open => quote = None,
            Some(_) => {}
            None if matches!(letter, '\'' | '"') => quote = Some(letter),
            None if text[at..].starts_with(" and ") && at >= start => {
                parts.push(&text[start..at]);
                start = at + " and ".len();
            }
            None => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

/// A fault of one cell.
pub(crate) fn at(table: usize, row: Option<usize>, column: Option<usize>) -> CellRef {
    CellRef { table, row, column }
}

#[cfg(feature = "xlsx")]
/// A cell as people call it, `C7`; both from 0.
pub(crate) fn cell_name(row: u32, column: u32) -> String {
    format!("{}{}", letters(column as usize), row + 1)
}
