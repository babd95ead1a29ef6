//! Measured tables: any encoding, delimiter and decimal sign that occurs in practice, every fault
//! with its place.

use toolroom_process::table::{BrokenQuote, Lines, broken_quote};
use toolroom_process::unit;

/// A column that a reader knows.
pub(crate) struct ColumnSpec {
    pub name: &'static str,
    /// SI unit of a number, or none for a text.
    pub unit: Option<&'static str>,
    pub required: bool,
}

/// One cell, numbers in SI.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Cell {
    Missing,
    Number(f64),
    Text(String),
}

/// A line of the file, with a cell for every column that the reader knows.
#[derive(Debug)]
pub(crate) struct Row {
    pub line: usize,
    pub cells: Vec<Cell>,
}

/// What a reader did on its own account.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableNote {
    /// Numbers were read with a decimal comma.
    #[error("numbers have a decimal comma")]
    DecimalComma,
    /// The text is not in UTF-8.
    #[error("the text was read as {encoding}")]
    Encoding {
        /// What it was read as.
        encoding: &'static str,
    },
    /// A column that the reader does not know.
    #[error("column `{name}` is not used")]
    Unused {
        /// Its header.
        name: String,
    },
}

/// A table that cannot be used; all faults at once.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", .faults.iter().map(|fault| format!("{file}:{fault}")).collect::<Vec<_>>().join("\n"))]
pub struct TableError {
    /// The file, as named by the caller.
    pub file: String,
    /// What is wrong, in the order of the file.
    pub faults: Vec<TableFault>,
}

/// One fault. Line and column (of the table) count from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{line}:{column}: {reason}")]
pub struct TableFault {
    /// Line of the file.
    pub line: usize,
    /// Column of the table.
    pub column: usize,
    /// What is wrong there.
    pub reason: TableReason,
}

/// What can be wrong with a table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TableReason {
    /// There is no header, or nothing under it.
    #[error("no rows; expected a header `name [unit], ...` and a line for each record")]
    NoRows,
    /// A quote that cannot be read.
    #[error(transparent)]
    Quote(BrokenQuote),
    /// A row with too many or too few cells.
    #[error("{found} cells where the header has {expected}; with decimal commas, separate columns by semicolons")]
    CellCount {
        /// Cells in the row.
        found: usize,
        /// Cells in the header.
        expected: usize,
    },
    /// A column that must be there.
    #[error("the column `{name}` is missing; expected `{example}`")]
    MissingColumn {
        /// Its name.
        name: &'static str,
        /// A header that would do.
        example: String,
    },
    /// A column name that looks misspelt.
    #[error("unknown column `{name}`; did you mean `{nearest}`?")]
    Misspelt {
        /// What was read.
        name: String,
        /// The most similar name.
        nearest: &'static str,
    },
    /// Two columns of one name.
    #[error("column `{name}` stands twice, first as column {first}")]
    TwoColumns {
        /// Its name.
        name: &'static str,
        /// Where it stood before.
        first: usize,
    },
    /// A header without unit or with a wrong one.
    #[error("column `{name}` needs its unit in brackets, {accepted}; read `{read}`")]
    Unit {
        /// Column.
        name: &'static str,
        /// What was read as unit.
        read: String,
        /// Units that fit.
        accepted: String,
    },
    /// A cell that should be a number.
    #[error("{name} of `{record}` is `{read}`; expected a finite number")]
    NotANumber {
        /// Column.
        name: &'static str,
        /// First cell of the row.
        record: String,
        /// What was read.
        read: String,
    },
    /// An empty cell where there must be something.
    #[error("{name} is empty")]
    Empty {
        /// Column.
        name: &'static str,
    },
    /// Points and commas in one file, or commas that may separate thousands.
    #[error("`{read}`: decimal comma or thousands? {clash}; write all numbers with a decimal point")]
    AmbiguousComma {
        /// What was read.
        read: String,
        /// Why it cannot be decided.
        clash: &'static str,
    },
    /// Two records of one name.
    #[error("`{record}` stands twice, first in line {first}")]
    TwoRecords {
        /// Its name.
        record: String,
        /// Where it stood before.
        first: usize,
    },
    /// A record that belongs to nothing.
    #[error("there is no trial `{record}`")]
    NoSuchTrial {
        /// Its name.
        record: String,
    },
}

impl TableReason {
    /// Short name of the fault, for programs.
    pub fn code(&self) -> &'static str {
        match self {
            Self::NoRows | Self::Quote(_) | Self::CellCount { .. } | Self::Empty { .. } => "table",
            Self::MissingColumn { .. } => "missing-key",
            Self::Misspelt { .. } | Self::TwoColumns { .. } => "unknown-key",
            Self::Unit { .. } | Self::NotANumber { .. } | Self::AmbiguousComma { .. } => "quantity",
            Self::TwoRecords { .. } => "duplicate-name",
            Self::NoSuchTrial { .. } => "unknown-name",
        }
    }
}

/// Likeness above which an unknown column name counts as misspelt (assumption).
const MISSPELT: f64 = 0.9;

/// Reads the columns `specs` from a delimited table.
pub(crate) fn read(file: &str, bytes: &[u8], specs: &[ColumnSpec]) -> Result<(Vec<Row>, Vec<TableNote>), TableError> {
    let (text, encoding) = decode(bytes);
    let mut notes: Vec<TableNote> = encoding.map(|encoding| TableNote::Encoding { encoding }).into_iter().collect();
    let delimiter = delimiter(&text);
    if let Some(fault) = broken_quote(&text, delimiter) {
        let faults = vec![TableFault { line: fault.line(), column: 1, reason: TableReason::Quote(fault) }];
        return Err(TableError { file: file.to_owned(), faults });
    }
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut lines = Lines::new(&text);
    let placed = |mut record: csv::StringRecord| {
        if let Some(mut position) = record.position().cloned() {
            position.set_line(lines.at(position.byte()) as u64);
            record.set_position(Some(position));
        }
        record
    };
    let there = |record: &csv::StringRecord| record.iter().any(|cell| !cell.is_empty());
    let mut records = reader.records().filter_map(Result::ok).filter(there).map(placed);
    let mut faults = Vec::new();
    let refuse = |faults| Err(TableError { file: file.to_owned(), faults });
    let Some(header) = records.next() else {
        return refuse(vec![TableFault { line: 1, column: 1, reason: TableReason::NoRows }]);
    };
    let columns = header_columns(&header, specs, &mut notes, &mut faults);
    let records: Vec<csv::StringRecord> = records.collect();
    if records.is_empty() {
        faults.push(TableFault { line: line_of(&header), column: 1, reason: TableReason::NoRows });
    }
    let comma = decimal_comma(&records, &columns, specs, &mut faults);
    if comma {
        notes.push(TableNote::DecimalComma);
    }
    let mut rows = Vec::with_capacity(records.len());
    for record in &records {
        let line = line_of(record);
        if record.len() != header.len() {
            let reason = TableReason::CellCount { found: record.len(), expected: header.len() };
            faults.push(TableFault { line, column: record.len().min(header.len()), reason });
            continue;
        }
        let cells = specs.iter().zip(&columns).map(|(spec, column)| {
            let Some((index, scale)) = column else { return Cell::Missing };
            cell(record, *index, spec, scale, comma).unwrap_or_else(|reason| {
                faults.push(TableFault { line, column: index + 1, reason });
                Cell::Missing
            })
        });
        rows.push(Row { line, cells: cells.collect() });
    }
    if faults.is_empty() { Ok((rows, notes)) } else { refuse(faults) }
}

fn line_of(record: &csv::StringRecord) -> usize {
    record.position().map_or(1, |position| usize::try_from(position.line()).unwrap_or(usize::MAX))
}

/// Text of the bytes, and what they were read as unless UTF-8.
fn decode(bytes: &[u8]) -> (String, Option<&'static str>) {
    let wide = |body: &[u8], join: fn([u8; 2]) -> u16| {
        let units = body.chunks(2).map(|pair| join([pair[0], pair.get(1).copied().unwrap_or(0)]));
        char::decode_utf16(units).map(|unit| unit.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
    };
    match bytes {
        [0xFF, 0xFE, body @ ..] => (wide(body, u16::from_le_bytes), Some("UTF-16")),
        [0xFE, 0xFF, body @ ..] => (wide(body, u16::from_be_bytes), Some("UTF-16")),
        [0xEF, 0xBB, 0xBF, body @ ..] => (String::from_utf8_lossy(body).into_owned(), None),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => (text.to_owned(), None),
            Err(_) => (bytes.iter().map(|byte| windows_1251(*byte)).collect(), Some("windows-1251")),
        },
    }
}

/// The letters of windows-1251 and the signs that occur in headers.
fn windows_1251(byte: u8) -> char {
    match byte {
        0x00..=0x7F => char::from(byte),
        0xC0..=0xFF => char::from_u32(0x0410 + u32::from(byte - 0xC0)).unwrap_or(char::REPLACEMENT_CHARACTER),
        0xA8 => 'Ё',
        0xB8 => 'ё',
        0xB9 => '№',
        0xA0 => ' ',
        0xB0 | 0xB1 | 0xB5 | 0xB7 => char::from(byte),
        _ => char::REPLACEMENT_CHARACTER,
    }
}

/// The delimiter that the header uses.
fn delimiter(text: &str) -> u8 {
    let header = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
    match header {
        _ if header.contains(';') => b';',
        _ if header.contains('\t') => b'\t',
        _ => b',',
    }
}

/// Place and factor-and-offset to SI of a column in the file.
type Place = Option<(usize, unit::Unit)>;

/// Ratios and texts are taken as they stand.
const AS_IT_STANDS: unit::Unit = unit::Unit { factor: 1.0, offset: 0.0, dimension: [0; 8] };

fn header_columns(
    header: &csv::StringRecord,
    specs: &[ColumnSpec],
    notes: &mut Vec<TableNote>,
    faults: &mut Vec<TableFault>,
) -> Vec<Place> {
    let mut columns: Vec<Place> = specs.iter().map(|_| None).collect();
    let line = line_of(header);
    for (place, title) in header.iter().enumerate() {
        let mut fault = |reason| faults.push(TableFault { line, column: place + 1, reason });
        let (name, read) = name_and_unit(title);
        let Some(index) = specs.iter().position(|spec| spec.name.eq_ignore_ascii_case(name)) else {
            let likeness = |spec: &&ColumnSpec| strsim::jaro_winkler(spec.name, &name.to_ascii_lowercase());
            let nearest = specs.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
            match nearest.filter(|spec| likeness(spec) >= MISSPELT) {
                Some(nearest) => fault(TableReason::Misspelt { name: name.to_owned(), nearest: nearest.name }),
                None => notes.push(TableNote::Unused { name: title.to_owned() }),
            }
            continue;
        };
        let spec = &specs[index];
        if let Some((first, _)) = columns[index] {
            fault(TableReason::TwoColumns { name: spec.name, first: first + 1 });
            continue;
        }
        match scale(spec, read) {
            Ok(scale) => columns[index] = Some((place, scale)),
            Err(reason) => {
                columns[index] = Some((place, AS_IT_STANDS));
                fault(reason);
            }
        }
    }
    for (spec, column) in specs.iter().zip(&columns) {
        if spec.required && column.is_none() {
            let example = match spec.unit {
                Some(si) if si != "1" => {
                    format!("{} [{}]", spec.name, unit::accepted(si).split(", ").next().unwrap_or(si))
                }
                _ => spec.name.to_owned(),
            };
            faults.push(TableFault {
                line,
                column: 1,
                reason: TableReason::MissingColumn { name: spec.name, example },
            });
        }
    }
    columns
}

/// `name [unit]` or `name (unit)` in two.
fn name_and_unit(title: &str) -> (&str, &str) {
    match title.find(['[', '(']) {
        Some(open) => (title[..open].trim(), title[open + 1..].trim_end_matches([']', ')']).trim()),
        None => (title.trim(), ""),
    }
}

fn scale(spec: &ColumnSpec, read: &str) -> Result<unit::Unit, TableReason> {
    let Some(si) = spec.unit else { return Ok(AS_IT_STANDS) };
    if si == "1" && (read.is_empty() || read == "rev") {
        return Ok(AS_IT_STANDS);
    }
    let wrong = || TableReason::Unit { name: spec.name, read: read.to_owned(), accepted: unit::accepted(si) };
    let (from, to) = (unit::parse(read).map_err(|_| wrong())?, unit::parse(si).map_err(|_| wrong())?);
    if read.is_empty() || !unit::compatible(from.dimension, to.dimension) {
        return Err(wrong());
    }
    Ok(unit::Unit { factor: from.factor / to.factor, ..from })
}

/// Whether the numbers of the file are written with a decimal comma.
fn decimal_comma(
    records: &[csv::StringRecord],
    columns: &[Place],
    specs: &[ColumnSpec],
    faults: &mut Vec<TableFault>,
) -> bool {
    let numeric = specs.iter().zip(columns).filter_map(|(spec, column)| spec.unit.and(*column));
    let places: Vec<usize> = numeric.map(|(at, _)| at).collect();
    let cells = || {
        let of_record =
            |record| places.iter().filter_map(move |at| Some((record, *at, csv::StringRecord::get(record, *at)?)));
        records.iter().flat_map(of_record)
    };
    let mut commas = cells().filter(|(_, _, cell)| cell.contains(','));
    let Some((record, index, read)) = commas.next() else { return false };
    // 1,234 may be a thousand and more; 0,234 or 12,5 cannot.
    let decides = |cell: &str| {
        let (whole, rest) = cell.trim_start_matches(['-', '+']).split_once(',').unwrap_or_default();
        rest.len() != 3 || whole == "0" || whole.len() > 3
    };
    let clash = if cells().any(|(_, _, cell)| cell.contains('.')) {
        "the file has numbers with a point too"
    } else if !cells().any(|(_, _, cell)| cell.contains(',') && decides(cell)) {
        "every comma stands before three digits"
    } else {
        return true;
    };
    let reason = TableReason::AmbiguousComma { read: read.to_owned(), clash };
    faults.push(TableFault { line: line_of(record), column: index + 1, reason });
    true
}

fn cell(
    record: &csv::StringRecord,
    index: usize,
    spec: &ColumnSpec,
    scale: &unit::Unit,
    comma: bool,
) -> Result<Cell, TableReason> {
    let read = record.get(index).unwrap_or_default();
    // MTConnect writes UNAVAILABLE for a value that was not there.
    if read.is_empty() || read.eq_ignore_ascii_case("unavailable") {
        return if spec.required { Err(TableReason::Empty { name: spec.name }) } else { Ok(Cell::Missing) };
    }
    if spec.unit.is_none() {
        return Ok(Cell::Text(read.to_owned()));
    }
    let number = if comma { read.replacen(',', ".", 1) } else { read.to_owned() };
    match number.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Cell::Number(value * scale.factor + scale.offset)),
        _ => Err(TableReason::NotANumber {
            name: spec.name,
            record: record.get(0).unwrap_or_default().to_owned(),
            read: read.to_owned(),
        }),
    }
}
