//! Delimited text of any encoding to a table of cells.

use crate::RecordError;
use std::collections::HashMap;
use std::path::Path;
use toolroom_form::utf16_lossy;
use toolroom_process::table::{BrokenQuote, Lines, broken_quote};
use toolroom_process::unit;

/// Cells as they stand in a file.
#[derive(Debug, Default)]
pub struct RawTable {
    /// Headers.
    pub header: Vec<String>,
    /// Line of the file with the headers; 0 where the format has no lines.
    pub header_line: usize,
    /// Line of the file and its cells.
    pub rows: Vec<(usize, Vec<String>)>,
    /// What was done to read the file, for people.
    pub notes: Vec<String>,
}

impl RawTable {
    /// What is wrong with a row of more cells than there are headers: its cells may stand under the wrong ones, as those of numbers
    /// with a decimal comma in a table separated by commas do. `None` of every other row; empty cells at its end do no harm.
    pub(super) fn surplus(&self, cells: &[String]) -> Option<String> {
        let beyond = cells.get(self.header.len()..)?;
        beyond.iter().any(|cell| !cell.is_empty()).then(|| {
            format!(
                "{} cells stand under {} headers: write numbers with a point, or separate cells by semicolons",
                cells.len(),
                self.header.len()
            )
        })
    }
}

/// Reads a table that is no delimited text, from a file with another extension than `csv`.
pub type OtherTable<'a> = &'a dyn Fn(&Path) -> Result<RawTable, RecordError>;

/// Reads comma, semicolon or tab separated text; lines that start with `#` are comments.
pub(super) fn parse(bytes: &[u8]) -> Result<RawTable, BrokenQuote> {
    let (text, encoding) = decode(bytes);
    let mut table = RawTable::default();
    if let Some(encoding) = encoding {
        table.notes.push(format!("read as {encoding}"));
    }
    let head = text.lines().find(|line| !line.trim().is_empty() && !line.starts_with('#')).unwrap_or_default();
    let count = |sign: char| head.matches(sign).count();
    let delimiter = [b';', b'\t', b','].into_iter().max_by_key(|sign| count(char::from(*sign))).unwrap_or(b',');
    // A lenient reader would take the rows after a broken quote for the rest of its cell.
    if let Some(fault) = broken_quote(&text, delimiter) {
        return Err(fault);
    }
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        .flexible(true)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut lines = Lines::new(&text);
    for record in reader.records().filter_map(Result::ok) {
        if record.iter().all(str::is_empty) {
            continue;
        }
        let line = record.position().map_or(1, |position| lines.at(position.byte()));
        let cells: Vec<String> = record.iter().map(str::to_owned).collect();
        if table.header.is_empty() {
            (table.header, table.header_line) = (cells, line);
        } else {
            table.rows.push((line, cells));
        }
    }
    if delimiter != b',' {
        read_decimal_commas(&mut table);
    }
    table.notes.extend(repeated_rows(&table));
    Ok(table)
}

/// What is said of rows that are equal to an earlier one in every cell, as those of two exports in one file are. They are not left out
/// for that: coarse readings may repeat honestly.
fn repeated_rows(table: &RawTable) -> Option<String> {
    let mut earlier: HashMap<&[String], usize> = HashMap::with_capacity(table.rows.len());
    let mut first = None;
    let mut count = 0;
    for (line, cells) in &table.rows {
        if let Some(original) = earlier.get(cells.as_slice()) {
            first.get_or_insert((*line, *original));
            count += 1;
        } else {
            earlier.insert(cells, *line);
        }
    }
    let (line, original) = first?;
    let rows = if count == 1 { "1 row repeats".to_owned() } else { format!("{count} rows repeat") };
    Some(format!(
        "{rows} an earlier one in every cell, first line {line} that of line {original}: delete them if they were exported twice"
    ))
}

/// Text, and what it was read as unless UTF-8.
fn decode(bytes: &[u8]) -> (String, Option<&'static str>) {
    if let Some(text) = utf16_lossy(bytes) {
        return (text, Some("UTF-16"));
    }
    match bytes {
        [0xEF, 0xBB, 0xBF, body @ ..] => (String::from_utf8_lossy(body).into_owned(), None),
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => (text.to_owned(), None),
            // Names may suffer; numbers and units are ASCII but for the micro sign.
            Err(_) => (bytes.iter().map(|byte| char::from(*byte)).collect(), Some("Latin-1")),
        },
    }
}

/// Whether a cell is a number with a decimal comma, `1,5`, or with points between its thousands, too: `1.113,04`.
fn is_comma_number(cell: &str) -> bool {
    let Some((whole, fraction)) = cell.split_once(',') else { return false };
    let mut groups = whole.trim_start_matches(['+', '-']).split('.');
    let leading = |group: &str| (1..=3).contains(&group.len()) && !group.starts_with('0');
    let first = groups.next().is_some_and(|group| !whole.contains('.') || leading(group));
    let grouped = first && groups.all(|group| group.len() == 3);
    grouped && !fraction.contains(['.', ',']) && format!("{}.{fraction}", whole.replace('.', "")).parse::<f64>().is_ok()
}

/// Whether the comma of a number may stand between thousands: up to three digits before it, no zero first, three after it.
fn may_be_thousands(cell: &str) -> bool {
    let Some((before, after)) = cell.trim_start_matches(['+', '-']).split_once(',') else { return false };
    after.len() == 3 && (1..=3).contains(&before.len()) && !before.starts_with('0')
}

/// Writes decimal commas as points: where no number of the table has a point, and beside such numbers where no comma can stand
/// between thousands.
fn read_decimal_commas(table: &mut RawTable) {
    let cells = || table.rows.iter().flat_map(|(line, cells)| cells.iter().map(move |cell| (line, cell)));
    let with_point = cells().find(|(_, cell)| cell.contains('.') && cell.parse::<f64>().is_ok());
    let Some((line, first)) = cells().find(|(_, cell)| is_comma_number(cell)) else { return };
    let thousands = cells().find(|(_, cell)| is_comma_number(cell) && cell.contains('.'));
    if let (Some((line, cell)), Some((other, point))) = (thousands, with_point) {
        let note = format!(
            "`{cell}` in line {line} has points between thousands, and the point of `{point}` in line {other} may be one or a decimal \
             sign, so that numbers with a comma are not read: write one sign"
        );
        table.notes.push(note);
        return;
    }
    let note = match with_point {
        None => "numbers have a decimal comma".to_owned(),
        Some((other, point)) => {
            let mixed = format!(
                "decimal commas (line {line}: `{first}`) and points (line {other}: `{point}`) stand side by side"
            );
            match cells().find(|(_, cell)| is_comma_number(cell) && may_be_thousands(cell)) {
                Some((line, cell)) => {
                    let note = format!(
                        "{mixed}; `{cell}` in line {line} may be either, so that numbers with a comma are not read: write one sign"
                    );
                    table.notes.push(note);
                    return;
                }
                None => format!("{mixed}; both are read as decimal signs"),
            }
        }
    };
    table.notes.push(note);
    for (_, cells) in &mut table.rows {
        for cell in cells.iter_mut().filter(|cell| is_comma_number(cell)) {
            *cell = cell.replace('.', "").replacen(',', ".", 1);
        }
    }
}

/// `name [unit]` or `name (unit)` in two.
pub(super) fn name_and_unit(title: &str) -> (&str, &str) {
    match title.find(['[', '(']) {
        Some(open) => (title[..open].trim(), title[open + 1..].trim_end_matches([']', ')']).trim()),
        None => (title.trim(), ""),
    }
}

/// Factor and offset from `read` to `si`; `None` where they do not fit.
pub(super) fn scale(read: &str, si: &str) -> Option<(f64, f64)> {
    let (from, to) = (unit::parse(read).ok()?, unit::parse(si).ok()?);
    // Frequencies may be given per second or in hertz, rotations per minute.
    unit::compatible(from.dimension, to.dimension).then(|| (from.factor / to.factor, from.offset / to.factor))
}
