//! The cells of a file by a mapping: SI numbers and texts of the rows that count.

use super::super::columns::ColumnKind;
use super::super::csv_table::{RawTable, name_and_unit, scale};
use super::super::read::{is_missing, number};
use super::super::{ReadReport, RecordError};
use super::ImportError;
use super::mapping::{Keep, Mapped, Mapping, Origin};
use std::collections::BTreeMap;

/// Headers of the file that a message lists.
const LISTED: usize = 12;

/// Cells of one column of the records, row by row.
pub(super) enum Cells {
    /// SI, NaN where missing.
    Numbers(Vec<f64>),
    /// Empty where missing.
    Texts(Vec<String>),
}

/// The rows that count.
pub(super) struct Source {
    /// Line of the file.
    pub lines: Vec<usize>,
    /// Cells of each mapped column.
    pub cells: Vec<Cells>,
}

impl Source {
    pub fn new(file: &str, table: &RawTable, mapping: &Mapping, report: &mut ReadReport) -> Result<Self, ImportError> {
        let rows = kept(file, table, &mapping.keep, report)?;
        if rows.is_empty() {
            let first = report.dropped.first().map(|(line, reason)| format!("line {line}, {reason}"));
            return Err(
                RecordError::NoRows { file: file.to_owned(), rows: table.rows.len(), first, wrong: true }.into()
            );
        }
        let cells = mapping.columns.iter().map(|mapped| column(file, table, &rows, mapped, report));
        let cells = cells.collect::<Result<Vec<_>, _>>()?;
        let used: Vec<usize> = mapping
            .columns
            .iter()
            .filter_map(|mapped| match &mapped.origin {
                Origin::Column { from, .. } => position(table, from),
                Origin::Number(_) | Origin::Text(_) => None,
            })
            .collect();
        let unused = table.header.iter().enumerate().filter(|(at, title)| !used.contains(at) && !title.is_empty());
        report.unused.extend(unused.map(|(_, title)| title.clone()));
        Ok(Self { lines: rows.iter().map(|row| table.rows[*row].0).collect(), cells })
    }
}

/// The column of the file that a mapping means: the header as it stands, or its name without the unit.
fn position(table: &RawTable, from: &str) -> Option<usize> {
    let exact = table.header.iter().position(|title| title == from);
    exact.or_else(|| table.header.iter().position(|title| name_and_unit(title).0.eq_ignore_ascii_case(from.trim())))
}

fn located(file: &str, table: &RawTable, from: &str) -> Result<usize, ImportError> {
    position(table, from).ok_or_else(|| {
        let likeness = |title: &&String| strsim::jaro_winkler(from, title);
        let nearest = table.header.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
        let more = if table.header.len() > LISTED { ", …" } else { "" };
        let known: Vec<&str> = table.header.iter().take(LISTED).map(String::as_str).collect();
        ImportError::NoColumn {
            file: file.to_owned(),
            column: from.to_owned(),
            nearest: nearest.filter(|title| likeness(title) > 0.8).cloned(),
            known: known.join(", ") + more,
        }
    })
}

/// Indices of the rows that meet every condition.
fn kept(file: &str, table: &RawTable, keep: &[Keep], report: &mut ReadReport) -> Result<Vec<usize>, ImportError> {
    let mut conditions = Vec::with_capacity(keep.len());
    for condition in keep {
        conditions.push((located(file, table, &condition.from)?, condition));
    }
    let mut rows = Vec::with_capacity(table.rows.len());
    'rows: for (row, (line, cells)) in table.rows.iter().enumerate() {
        if let Some(reason) = table.surplus(cells) {
            report.dropped.push((*line, reason));
            continue;
        }
        for (column, keep) in &conditions {
            let read = cells.get(*column).map_or("", String::as_str);
            let fits = match &keep.is {
                Some(text) => read == text,
                None => number(read).is_some_and(|value| value >= keep.at_least && value <= keep.at_most),
            };
            if !fits {
                report
                    .dropped
                    .push((*line, format!("{} is {}", keep.from, if read.is_empty() { "empty" } else { read })));
                continue 'rows;
            }
        }
        rows.push(row);
    }
    Ok(rows)
}

fn column(
    file: &str,
    table: &RawTable,
    rows: &[usize],
    mapped: &Mapped,
    report: &mut ReadReport,
) -> Result<Cells, ImportError> {
    let column = mapped.column;
    let (from, unit, factor, values) = match &mapped.origin {
        Origin::Number(value) => return Ok(Cells::Numbers(vec![*value; rows.len()])),
        Origin::Text(text) => return Ok(Cells::Texts(vec![text.clone(); rows.len()])),
        Origin::Column { from, unit, factor, values, .. } => (from, unit, *factor, values),
    };
    let place = located(file, table, from)?;
    let title = &table.header[place];
    let cell = |row: &usize| table.rows[*row].1.get(place).map_or("", String::as_str);
    report.columns.push(format!("{title} → {}", column.header()));
    if column.kind == ColumnKind::Text {
        let word = |row: &usize| {
            let read = cell(row);
            if is_missing(read) { String::new() } else { values.get(read).cloned().unwrap_or_else(|| read.to_owned()) }
        };
        return Ok(Cells::Texts(rows.iter().map(word).collect()));
    }
    let (scale, offset) = units(title, unit.as_deref(), mapped, file, report)?;
    let greatest = column.scale() * column.greatest;
    // Rows whose values are no such quantity: line and value.
    let mut beyond: BTreeMap<usize, (usize, f64)> = BTreeMap::new();
    let mut numbers = Vec::with_capacity(rows.len());
    for (at, row) in rows.iter().enumerate() {
        let (line, read) = (table.rows[*row].0, cell(row));
        let value = number(read).map(|value| value * factor * scale + offset);
        if value.is_none() && !is_missing(read) {
            report.unreadable.push((line, column.name.to_owned(), read.to_owned()));
        }
        if let Some(value) = value.filter(|value| value.abs() > greatest) {
            beyond.insert(at, (line, value));
        }
        numbers.push(value.unwrap_or(f64::NAN));
    }
    if let Some((line, value)) = beyond.first_entry().map(|entry| *entry.get()) {
        let (name, display) = (column.name, column.display);
        let shown = toolroom_form::significant(value / column.scale());
        let reason = match (display, column.greatest) {
            // Counts, and marks such as `censored`, have no unit that could be wrong.
            ("1", greatest) => {
                format!("{name} is {shown}, and {greatest} is the greatest that it can be: look at `{title}`")
            }
            (_, greatest) => {
                format!("{name} is {shown} {display}, beyond {greatest} {display}: check the unit of `{title}`")
            }
        };
        // A few slips are no values. A whole channel in another unit is for those to say who use it; a condition in another
        // unit would leave rows that say nothing of how was cut.
        let few = 2 * beyond.len() < numbers.iter().filter(|value| value.is_finite()).count();
        if !few && column.kind != ColumnKind::Channel {
            let first = Some(format!("line {line}, {reason}"));
            return Err(RecordError::NoRows { file: file.to_owned(), rows: rows.len(), first, wrong: true }.into());
        }
        beyond.keys().filter(|_| few).for_each(|at| numbers[*at] = f64::NAN);
        let what = if few { format!("; {} such values are taken as missing", beyond.len()) } else { String::new() };
        report.notes.push(format!("line {line}: {reason}{what}"));
    }
    Ok(Cells::Numbers(numbers))
}

/// Factor and offset to SI: the mapping's unit, else the header's, else the unit of the records.
fn units(
    title: &str,
    unit: Option<&str>,
    mapped: &Mapped,
    file: &str,
    report: &mut ReadReport,
) -> Result<(f64, f64), ImportError> {
    let column = mapped.column;
    let (_, written) = name_and_unit(title);
    let of_header = if written.is_empty() { None } else { scale(written, column.unit) };
    if let (Some(unit), Some(header)) = (unit, of_header)
        && scale(unit, column.unit) != Some(header)
    {
        report.notes.push(format!("`{title}` is read in {unit}, as the mapping says, not in {written}"));
    }
    let read = unit.unwrap_or(if written.is_empty() { column.display } else { written });
    if unit.is_none() && written.is_empty() && column.display != "1" {
        report.notes.push(format!("`{title}` has no unit; taken as {}", column.display));
    }
    let bare = column.unit == "1" && matches!(read, "rev" | "-" | "#");
    scale(if bare { "1" } else { read }, column.unit).ok_or_else(|| {
        RecordError::Unit {
            file: file.to_owned(),
            column: column.name,
            read: read.to_owned(),
            accepted: toolroom_process::unit::accepted(column.unit),
        }
        .into()
    })
}
