//! What is wrong in the tables of a shop, and in which cell.

use crate::draft::Draft;
use crate::mapping::ShopMapping;
use crate::source::Source;
use serde_json::{Value, json};
use std::fmt;
use std::path::Path;
use toolroom_form::{Problem, ReadError};
use toolroom_location::{Located, Location};
use toolroom_process::parameters::place;

/// Most faults that are told one by one: a wrong unit spoils every row alike.
const MOST_TOLD: usize = 50;

/// Longest list of known names that is shown, characters.
const LISTED: usize = 160;

/// A cell of a table, a row of it, or the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct CellRef {
    /// The table of the mapping.
    pub table: usize,
    /// The row, as an index among those that count; `None` for the table as a whole.
    pub row: Option<usize>,
    /// The column of the mapping.
    pub column: Option<usize>,
}

/// What is wrong before it has its place in words.
#[derive(Clone, Debug)]
pub(crate) enum UnplacedFault {
    /// In a cell.
    Cell(CellRef, Diagnostic),
    /// Elsewhere.
    Place(Spot, Diagnostic),
}

/// A place, in words and for programs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Spot {
    /// In words.
    pub words: String,
    /// The file.
    pub file: String,
    /// Its line or row, from 1, where it is about one.
    pub line: Option<usize>,
}

impl UnplacedFault {
    /// Table and row of a fault in a row.
    pub fn row(&self) -> Option<(usize, usize)> {
        match self {
            Self::Cell(CellRef { table, row: Some(row), .. }, _) => Some((*table, *row)),
            Self::Cell(..) | Self::Place(..) => None,
        }
    }

    /// Whether it is about a row and about none of its cells.
    pub fn is_whole_row(&self) -> bool {
        matches!(self, Self::Cell(CellRef { row: Some(_), column: None, .. }, _))
    }
}

/// What is wrong, and the likely fix.
#[derive(Clone, Debug)]
pub(crate) struct Diagnostic {
    pub code: &'static str,
    pub message: String,
    pub fix: Option<String>,
}

/// A fault of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableFault {
    /// For `toolroom explain`.
    pub code: &'static str,
    /// File, sheet, row and cell, or line and column of the base.
    pub place: String,
    /// The file.
    pub file: String,
    /// Line or row of the file, from 1; `None` where the file as a whole is at fault.
    pub line: Option<usize>,
    /// What is wrong there.
    pub message: String,
    /// The likely fix.
    pub fix: Option<String>,
}

impl TableFault {
    /// For programs: `code`, `place` in words, `file`, `line`, `message` and `fix`.
    pub fn json(&self) -> Value {
        let Self { code, place, file, line, message, fix } = self;
        json!({ "code": code, "place": place, "file": file, "line": line, "message": message, "fix": fix })
    }
}

impl fmt::Display for TableFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)?;
        self.fix.as_ref().map_or(Ok(()), |fix| write!(f, "\n    {fix}"))
    }
}

/// Why no scenario was made.
#[derive(Debug, thiserror::Error)]
pub enum ShopImportError {
    /// The mapping, or the base, which cannot be read.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A table that cannot be read.
    #[error("{file} cannot be read: {reason}")]
    Table {
        /// The file.
        file: String,
        /// Why.
        reason: String,
    },
    /// Faults in cells.
    #[error("{} in the tables{}", counted(.faults.len() + .more), .faults.iter().map(|fault| format!("\n{fault}")).collect::<String>())]
    Cells {
        /// The first of them, in the order of the tables.
        faults: Vec<TableFault>,
        /// How many more there are.
        more: usize,
    },
}

fn counted(count: usize) -> String {
    format!("{count} fault{}", if count == 1 { "" } else { "s" })
}

impl Located for ShopImportError {
    fn location(&self) -> Option<Location> {
        match self {
            Self::Read(error) => error.location(),
            Self::Table { file, .. } => Some(Location::of(file)),
            // Each fault has its own cell.
            Self::Cells { .. } => None,
        }
    }
}

impl ShopImportError {
    /// The likely fix, where the message does not say it.
    pub fn fix(&self) -> Option<&'static str> {
        match self {
            Self::Read(_) | Self::Cells { .. } => None,
            Self::Table { .. } => Some("`file` and `sheet` of the mapping say which table it is"),
        }
    }

    pub(crate) fn tables(mut found: Vec<UnplacedFault>, places: &Places<'_>) -> Self {
        let key = |found: &UnplacedFault| match found {
            UnplacedFault::Cell(cell, _) => {
                (1, cell.table, cell.row.map_or(0, |row| row + 1), cell.column.unwrap_or(0))
            }
            UnplacedFault::Place(..) => (0, 0, 0, 0),
        };
        found.sort_by_key(key);
        let more = found.len().saturating_sub(MOST_TOLD);
        let mut faults: Vec<TableFault> = found.into_iter().take(MOST_TOLD).map(|found| places.told(found)).collect();
        faults.dedup();
        Self::Cells { faults, more }
    }
}

/// What tells the places of faults.
pub(crate) struct Places<'a> {
    pub mapping: &'a ShopMapping,
    pub tables: &'a [Source],
    pub base: &'a Path,
}

impl Places<'_> {
    /// A fault of the scenario that was made, at the cell of the faulty value.
    pub fn translated(&self, problem: &Problem, draft: &Draft) -> UnplacedFault {
        let fix = problem.fault.fix().map(|fix| match fix.split_once("known: ") {
            // A shop has thousands of names; the nearest is worth more than all of them.
            Some((near, known)) if known.chars().count() > LISTED => {
                let near = near.trim_end();
                if near.is_empty() { "none of the known names is alike".to_owned() } else { near.to_owned() }
            }
            Some(_) | None => fix,
        });
        let told = Diagnostic { code: problem.fault.code(), message: problem.fault.to_string(), fix };
        match draft.origin(problem.span.start) {
            Some(cell) => UnplacedFault::Cell(cell, told),
            None => {
                let (line, column) = place(&draft.text, problem.span.start);
                let file = self.base.display().to_string();
                UnplacedFault::Place(Spot { words: format!("{file}:{line}:{column}"), file, line: Some(line) }, told)
            }
        }
    }

    fn told(&self, found: UnplacedFault) -> TableFault {
        let (spot, Diagnostic { code, message, fix }) = match found {
            UnplacedFault::Cell(cell, told) => (self.spot(cell), told),
            UnplacedFault::Place(spot, told) => (spot, told),
        };
        let Spot { words, file, line } = spot;
        TableFault { code, place: words, file, line, message, fix }
    }

    /// `erp.xlsx, sheet Auftraege, row 7, cell C7 (Teil)`.
    fn spot(&self, cell: CellRef) -> Spot {
        let (map, source) = (&self.mapping.tables[cell.table], &self.tables[cell.table]);
        let mut words = map.file.clone();
        if let Some(sheet) = &source.sheet {
            words += &format!(", sheet {sheet}");
        }
        let line = cell.row.map(|row| source.rows[row].line);
        if let Some(line) = line {
            words += &format!(", row {line}");
            if let Some(column) = cell.column
                && let Some(at) = source.columns[column]
            {
                words += &format!(", cell {}{line} ({})", letters(at), map.columns[column].from);
            }
        }
        Spot { words, file: map.file.clone(), line }
    }
}

/// The name of a column as spreadsheets have it: A, B, …, Z, AA.
pub(crate) fn letters(mut column: usize) -> String {
    let mut name = String::new();
    loop {
        name.insert(0, char::from(b'A' + (column % 26) as u8));
        if column < 26 {
            return name;
        }
        column = column / 26 - 1;
    }
}
