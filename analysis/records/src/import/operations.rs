//! Rows of each edge in order, samples combined to operations.

use super::super::columns::ColumnKind;
use super::super::combine::Combine;
use super::super::{ReadReport, RecordError, RecordKind, Records};
use super::ImportError;
use super::mapping::{Mapping, Origin};
use super::source::{Cells, Source};
use std::collections::BTreeMap;
use toolroom_statistics::median;

/// The records of a source.
pub(super) fn records(source: &Source, mapping: &Mapping, report: &mut ReadReport) -> Result<Records, ImportError> {
    let edges = edges(source, mapping, report);
    let cells = differences(source, mapping, &edges, report);
    let operations: Vec<(usize, Vec<usize>)> = edges
        .iter()
        .enumerate()
        .flat_map(|(edge, rows)| pieces(rows, &cells, mapping.rows).into_iter().map(move |piece| (edge, piece)))
        .collect();
    if operations.len() < edges.iter().map(Vec::len).sum() {
        let rows: usize = edges.iter().map(Vec::len).sum();
        report.notes.push(format!("{rows} rows make {} operations of up to {}", operations.len(), mapping.rows));
    }
    let mut records = Records::new(mapping.kind, operations.len());
    for (mapped, cells) in mapping.columns.iter().zip(&cells) {
        let rows = || operations.iter().map(|(_, rows)| rows);
        match cells {
            Cells::Texts(texts) => {
                records.set_texts(mapped.column.name, rows().map(|rows| texts[rows[0]].clone()).collect());
            }
            Cells::Numbers(numbers) => {
                let one = |rows: &Vec<usize>| combine(mapped.combine, rows.iter().map(|row| numbers[*row]));
                records.set_numbers(mapped.column.name, rows().map(one).collect());
            }
        }
    }
    generated(&mut records, &operations);
    complete(records, source, &operations, mapping.kind, report)
}

/// Rows of each edge, edges by first appearance, rows by their order.
fn edges(source: &Source, mapping: &Mapping, report: &mut ReadReport) -> Vec<Vec<usize>> {
    let (edge, order) = mapping.kind.sequence();
    let texts = |name: &str| match cells_of(source, mapping, name) {
        Some(Cells::Texts(texts)) => Some(texts),
        _ => None,
    };
    let numbers = |name: &str| match cells_of(source, mapping, name) {
        Some(Cells::Numbers(numbers)) => Some(numbers),
        _ => None,
    };
    let mut places: BTreeMap<&str, usize> = BTreeMap::new();
    let mut edges: Vec<Vec<usize>> = Vec::new();
    let names = texts(edge);
    for row in 0..source.lines.len() {
        let name = names.map_or("", |names| names[row].as_str());
        let place = *places.entry(name).or_insert(edges.len());
        if place == edges.len() {
            edges.push(Vec::new());
        }
        edges[place].push(row);
    }
    let Some(order) = numbers(order).or_else(|| numbers("start_time")) else { return edges };
    let mut moved = false;
    for rows in &mut edges {
        let before = rows.clone();
        rows.sort_by(|a, b| order[*a].total_cmp(&order[*b]));
        moved |= before != *rows;
        rows.dedup_by(|later, first| {
            let same = same(source, *first, *later);
            if same {
                let line = source.lines[*first];
                report.dropped.push((source.lines[*later], format!("the same stands in line {line} already")));
            }
            same
        });
    }
    if moved {
        report.notes.push("rows put into the order of each edge".to_owned());
    }
    edges
}

fn cells_of<'s>(source: &'s Source, mapping: &Mapping, name: &str) -> Option<&'s Cells> {
    mapping.columns.iter().position(|mapped| mapped.column.name == name).map(|at| &source.cells[at])
}

/// Whether two rows agree in every mapped cell.
fn same(source: &Source, a: usize, b: usize) -> bool {
    source.cells.iter().all(|cells| match cells {
        Cells::Numbers(numbers) => numbers[a].to_bits() == numbers[b].to_bits(),
        Cells::Texts(texts) => texts[a] == texts[b],
    })
}

/// The cells, with running totals turned into what each row adds.
fn differences(source: &Source, mapping: &Mapping, edges: &[Vec<usize>], report: &mut ReadReport) -> Vec<Cells> {
    let one = |(mapped, cells): (&super::Mapped, &Cells)| {
        let numbers = match cells {
            Cells::Texts(texts) => return Cells::Texts(texts.clone()),
            Cells::Numbers(numbers) => numbers,
        };
        if !matches!(mapped.origin, Origin::Column { running: true, .. }) {
            return Cells::Numbers(numbers.clone());
        }
        let mut added = vec![f64::NAN; numbers.len()];
        let mut backwards = 0;
        for rows in edges {
            let mut before = 0.0;
            for row in rows {
                let here = numbers[*row];
                if here < before {
                    backwards += 1;
                } else {
                    added[*row] = here - before;
                }
                before = if here.is_nan() { before } else { here };
            }
        }
        if backwards > 0 {
            let name = mapped.column.name;
            report.notes.push(format!("{backwards} rows where the total behind {name} goes back: missing there"));
        }
        Cells::Numbers(added)
    };
    mapping.columns.iter().zip(&source.cells).map(one).collect()
}

/// Pieces of `most` rows of an edge; a new text starts a new one.
fn pieces(rows: &[usize], cells: &[Cells], most: usize) -> Vec<Vec<usize>> {
    let mut pieces: Vec<Vec<usize>> = Vec::new();
    let changes =
        |a: usize, b: usize| cells.iter().any(|cells| matches!(cells, Cells::Texts(texts) if texts[a] != texts[b]));
    for row in rows {
        match pieces.last_mut() {
            Some(piece) if piece.len() < most && !changes(piece[0], *row) => piece.push(*row),
            _ => pieces.push(vec![*row]),
        }
    }
    pieces
}

fn combine(how: Combine, values: impl Iterator<Item = f64>) -> f64 {
    let mut known: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    match (how, known.as_slice()) {
        (_, []) => f64::NAN,
        (Combine::Mean, known) => known.iter().sum::<f64>() / known.len() as f64,
        (Combine::Sum, known) => known.iter().sum(),
        (Combine::First, [first, ..]) => *first,
        (Combine::Last, [.., last]) => *last,
        (Combine::Min, known) => known.iter().copied().fold(f64::INFINITY, f64::min),
        (Combine::Max, known) => known.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        (Combine::Median, _) => median(&mut known),
    }
}

/// Numbers the operations of each edge and names them, where the mapping does not.
fn generated(records: &mut Records, operations: &[(usize, Vec<usize>)]) {
    let kind = records.kind;
    let Some([order, id]) = kind.generated() else { return };
    let (edge, _) = kind.sequence();
    let mut counts: BTreeMap<usize, usize> = BTreeMap::new();
    let places: Vec<usize> = operations
        .iter()
        .map(|(edge, _)| {
            let count = counts.entry(*edge).or_insert(0);
            *count += 1;
            *count
        })
        .collect();
    if records.numbers(order).is_none() {
        records.set_numbers(order, places.iter().map(|place| *place as f64).collect());
    }
    if records.texts(id).is_none() {
        let name = |(row, place): (usize, &usize)| match records.texts(edge) {
            Some(edges) => format!("{}-{place}", edges[row]),
            None => place.to_string(),
        };
        records.set_texts(id, places.iter().enumerate().map(name).collect());
    }
}

/// The operations that have everything their kind needs.
fn complete(
    records: Records,
    source: &Source,
    operations: &[(usize, Vec<usize>)],
    kind: RecordKind,
    report: &mut ReadReport,
) -> Result<Records, ImportError> {
    let required: Vec<_> = kind.columns().iter().filter(|column| column.required).collect();
    for column in &required {
        if records.numbers(column.name).is_none() && records.texts(column.name).is_none() {
            return Err(ImportError::NotMapped { column: column.name, process: kind.name() });
        }
    }
    let mut rows = Vec::with_capacity(records.len());
    for (row, (_, samples)) in operations.iter().enumerate() {
        let lacking = required.iter().find(|column| match column.kind {
            ColumnKind::Text => records.texts(column.name).is_some_and(|texts| texts[row].is_empty()),
            ColumnKind::Condition | ColumnKind::Channel => {
                records.numbers(column.name).is_some_and(|numbers| !numbers[row].is_finite())
            }
        });
        match lacking {
            Some(column) => report.dropped.push((source.lines[samples[0]], format!("{} is missing", column.name))),
            None => rows.push(row),
        }
    }
    if rows.is_empty() {
        let first = report.dropped.first().map(|(line, reason)| format!("line {line}, {reason}"));
        return Err(
            RecordError::NoRows { file: report.file.clone(), rows: source.lines.len(), first, wrong: true }.into()
        );
    }
    report.dropped.sort();
    report.lines = rows.iter().map(|row| source.lines[operations[*row].1[0]]).collect();
    Ok(records.select(&rows))
}
