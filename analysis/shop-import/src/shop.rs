//! Rows to sections of a scenario.

use crate::draft::Draft;
use crate::fault::{CellRef, Diagnostic, UnplacedFault};
use crate::mapping::{TableKind, TableMap};
use crate::source::{Source, at};
use crate::value::{clock, literal, moment, quoted, told, with_unit, worded};
use std::collections::{BTreeMap, HashMap};
use toolroom_form::nearest;

/// A table of the mapping.
#[derive(Clone, Copy)]
struct Table<'a> {
    index: usize,
    map: &'a TableMap,
    source: &'a Source,
}

/// A row of a table.
#[derive(Clone, Copy)]
struct RowOf<'a> {
    table: Table<'a>,
    row: usize,
}

impl RowOf<'_> {
    fn origin(self) -> CellRef {
        at(self.table.index, Some(self.row), None)
    }

    /// The column of the mapping that is called so.
    fn column(self, name: &str) -> Option<usize> {
        self.table.map.columns.iter().position(|column| column.name == name)
    }

    /// The cell of a column.
    fn cell_ref(self, name: &str) -> CellRef {
        at(self.table.index, Some(self.row), self.column(name))
    }

    /// The text of a cell in the words of the mapping, or the text that rows have by default; `None` where there is none.
    fn text(self, name: &str) -> Option<String> {
        let cell = self.column(name).and_then(|column| {
            let map = &self.table.map.columns[column];
            self.table.source.cell(self.row, column).map(|cell| worded(map, cell).to_owned())
        });
        let default = || self.table.map.default(name).map(|value| value.trim_matches('"').to_owned());
        cell.filter(|text| !text.is_empty()).or_else(default)
    }

    /// The text that has to be there; a fault is noted where it is not.
    fn due(self, name: &str, faults: &mut Vec<UnplacedFault>) -> Option<String> {
        let text = self.text(name);
        // A column that the table lacks altogether was noted before.
        if text.is_none() && self.column(name).is_none_or(|column| self.table.source.columns[column].is_some()) {
            faults.push(UnplacedFault::Cell(self.cell_ref(name), told(format!("`{name}` is empty"), None)));
        }
        text
    }
}

/// The sections of all tables.
pub(crate) fn write(draft: &mut Draft, maps: &[TableMap], sources: &[Source], faults: &mut Vec<UnplacedFault>) {
    let tables: Vec<Table<'_>> =
        maps.iter().zip(sources).enumerate().map(|(index, (map, source))| Table { index, map, source }).collect();
    let of_kind = |kind: TableKind| tables.iter().copied().filter(move |table| table.map.kind == kind);
    for kind in TableKind::all() {
        match kind {
            TableKind::Calendars => of_kind(kind).for_each(|table| calendars(draft, table, faults)),
            TableKind::SetupMatrix => of_kind(kind).for_each(|table| setup_matrix(draft, table, faults)),
            TableKind::Machines => of_kind(kind).for_each(|table| plain(draft, "machine", table, faults)),
            TableKind::Operators => of_kind(kind).for_each(|table| plain(draft, "operator", table, faults)),
            TableKind::Orders => of_kind(kind).for_each(|table| plain(draft, "order", table, faults)),
            TableKind::Wip => of_kind(kind).for_each(|table| plain(draft, "wip", table, faults)),
            TableKind::Parts => parts(draft, &tables, faults),
            // Part of the parts.
            TableKind::Components | TableKind::Routings => {}
        }
    }
}

fn rows(table: Table<'_>) -> impl Iterator<Item = RowOf<'_>> {
    (0..table.source.rows.len()).map(move |row| RowOf { table, row })
}

/// A section for every row.
fn plain(draft: &mut Draft, title: &str, table: Table<'_>, faults: &mut Vec<UnplacedFault>) {
    for row in rows(table) {
        draft.section(title, row.origin());
        keys(draft, row, &[], faults);
    }
}

/// The keys of a section that a row gives, but for `without`.
fn keys(draft: &mut Draft, row: RowOf<'_>, without: &[&str], faults: &mut Vec<UnplacedFault>) {
    let Table { index, map, source } = row.table;
    for (number, column) in map.columns.iter().enumerate() {
        let Some(key) = map.kind.key(&column.name).filter(|_| !without.contains(&column.name.as_str())) else {
            continue;
        };
        let Some(cell) = source.cell(row.row, number) else { continue };
        let origin = at(index, Some(row.row), Some(number));
        match literal(key, column, cell, &source.units[number]) {
            Ok(value) => draft.value(&column.name, &value, origin),
            Err(told) => faults.push(UnplacedFault::Cell(origin, told)),
        }
    }
    for (name, value) in &map.default {
        let given = row.column(name).is_some_and(|column| source.cell(row.row, column).is_some());
        if !given && map.kind.key(name).is_some() && !without.contains(&name.as_str()) {
            draft.value(name, value, row.origin());
        }
    }
}

/// A part with what goes into it and how it is made.
struct PartRows<'a> {
    name: String,
    first: RowOf<'a>,
    own: Option<RowOf<'a>>,
    components: Vec<RowOf<'a>>,
    operations: Vec<RowOf<'a>>,
}

/// Parts, their components and routings: in the order of the table of parts, without one in that of the routings.
fn parts<'a>(draft: &mut Draft, tables: &[Table<'a>], faults: &mut Vec<UnplacedFault>) {
    let mut parts: Vec<PartRows<'a>> = Vec::new();
    let mut index: HashMap<String, usize> = HashMap::new();
    let listed = tables.iter().any(|table| table.map.kind == TableKind::Parts);
    for table in tables.iter().filter(|table| table.map.kind == TableKind::Parts) {
        for row in rows(*table) {
            let Some(name) = row.due("name", faults) else { continue };
            // A part that is there twice is refused with the scenario, at its second row.
            index.entry(name.clone()).or_insert(parts.len());
            parts.push(PartRows { name, first: row, own: Some(row), components: Vec::new(), operations: Vec::new() });
        }
    }
    let known: Vec<String> = parts.iter().map(|part| part.name.clone()).collect();
    for kind in [TableKind::Routings, TableKind::Components] {
        for table in tables.iter().filter(|table| table.map.kind == kind) {
            for row in rows(*table) {
                let Some(name) = row.due("part", faults) else { continue };
                let part = match index.get(&name) {
                    Some(part) => *part,
                    None if listed => {
                        let near = nearest(&name, known.iter().map(String::as_str));
                        let fix = near.map(|near| format!("did you mean `{near}`?"));
                        let message = format!("there is no part \"{name}\" in the table of parts");
                        faults.push(UnplacedFault::Cell(
                            row.cell_ref("part"),
                            Diagnostic { code: "unknown-name", message, fix },
                        ));
                        continue;
                    }
                    None => {
                        index.insert(name.clone(), parts.len());
                        let empty = (Vec::new(), Vec::new());
                        parts.push(PartRows { name, first: row, own: None, components: empty.0, operations: empty.1 });
                        parts.len() - 1
                    }
                };
                let rows = &mut parts[part];
                if kind == TableKind::Routings { &mut rows.operations } else { &mut rows.components }.push(row);
            }
        }
    }
    parts.into_iter().for_each(|part| write_part(draft, part, faults));
}

fn write_part(draft: &mut Draft, mut part: PartRows<'_>, faults: &mut Vec<UnplacedFault>) {
    draft.section("part", part.first.origin());
    match part.own {
        Some(row) => keys(draft, row, &[], faults),
        None => draft.value("name", &quoted(&part.name), part.first.cell_ref("part")),
    }
    for row in &part.components {
        let Some(component) = row.due("component", faults) else { continue };
        draft.section("part.components", row.origin());
        draft.value("part", &quoted(&component), row.cell_ref("component"));
        if let Some(quantity) = row.text("quantity") {
            match crate::value::whole(&quantity) {
                Some(quantity) => draft.value("quantity", &quantity.to_string(), row.cell_ref("quantity")),
                None => {
                    let wrong = told(format!("\"{quantity}\" is no whole number"), None);
                    faults.push(UnplacedFault::Cell(row.cell_ref("quantity"), wrong));
                }
            }
        }
    }
    let mut sequences: Vec<(f64, usize)> = Vec::new();
    for (number, row) in part.operations.iter().enumerate() {
        let sequence = match row.text("sequence") {
            Some(text) => match text.parse::<f64>() {
                Ok(sequence) if sequence.is_finite() => sequence,
                _ => {
                    let wrong = told(format!("\"{text}\" is no number of an operation"), None);
                    faults.push(UnplacedFault::Cell(row.cell_ref("sequence"), wrong));
                    continue;
                }
            },
            None => number as f64,
        };
        if row.column("sequence").is_some() && sequences.iter().any(|(other, _)| *other == sequence) {
            let wrong = told(format!("two operations of \"{}\" have the number {sequence}", part.name), None);
            faults.push(UnplacedFault::Cell(row.cell_ref("sequence"), wrong));
        }
        sequences.push((sequence, number));
    }
    // A stable order: rows without numbers stay as they stand.
    sequences.sort_by(|one, other| one.0.total_cmp(&other.0));
    let operations = std::mem::take(&mut part.operations);
    for (place, (_, number)) in sequences.into_iter().enumerate() {
        let row = operations[number];
        draft.section("part.operation", row.origin());
        if row.text("name").is_none() {
            let name = row.text("sequence").unwrap_or_else(|| (10 * (place + 1)).to_string());
            draft.value("name", &quoted(&name), row.cell_ref("sequence"));
        }
        keys(draft, row, &[], faults);
    }
}

/// A calendar: its shifts and holidays, which are rows.
#[derive(Default)]
struct CalendarRows<'a> {
    name: String,
    rows: Vec<RowOf<'a>>,
    /// Days with their shifts.
    week: BTreeMap<usize, (String, Vec<String>)>,
    holidays: Vec<String>,
}

fn calendars(draft: &mut Draft, table: Table<'_>, faults: &mut Vec<UnplacedFault>) {
    let mut calendars: Vec<CalendarRows<'_>> = Vec::new();
    for row in rows(table) {
        let Some(name) = row.due("name", faults) else { continue };
        let index = calendars.iter().position(|calendar| calendar.name == name).unwrap_or_else(|| {
            calendars.push(CalendarRows { name, ..CalendarRows::default() });
            calendars.len() - 1
        });
        let calendar = &mut calendars[index];
        calendar.rows.push(row);
        if let Some(days) = row.text("days")
            && let Some(shift) = shift(row, faults)
        {
            let place = calendar.week.values().position(|(known, _)| *known == days);
            let place = place.unwrap_or(calendar.week.len());
            calendar.week.entry(place).or_insert_with(|| (days, Vec::new())).1.push(shift);
        }
        if let Some(column) = row.column("holiday")
            && let Some(cell) = table.source.cell(row.row, column)
        {
            let map = &table.map.columns[column];
            // First and last day, or one.
            match moment(map, cell) {
                Ok(day) => calendar.holidays.push(day.get(..10).unwrap_or(&day).to_owned()),
                Err(told) => faults.push(UnplacedFault::Cell(row.cell_ref("holiday"), told)),
            }
        }
    }
    for calendar in calendars {
        let first = calendar.rows[0];
        draft.section("calendar", first.origin());
        draft.value("name", &quoted(&calendar.name), first.cell_ref("name"));
        let shifts = |shifts: &[String]| shifts.iter().map(|shift| quoted(shift)).collect::<Vec<_>>().join(", ");
        let week = calendar.week.values().map(|(days, of_day)| format!("{} = [{}]", quoted(days), shifts(of_day)));
        let week = format!("{{ {} }}", week.collect::<Vec<_>>().join(", "));
        draft.value("week", &week, first.cell_ref("days"));
        if !calendar.holidays.is_empty() {
            draft.value("holidays", &format!("[{}]", shifts(&calendar.holidays)), first.cell_ref("holiday"));
        }
        keys(draft, first, &["name", "week", "holidays"], faults);
    }
}

/// A shift, of one column or of two.
fn shift(row: RowOf<'_>, faults: &mut Vec<UnplacedFault>) -> Option<String> {
    let mut part = |name: &str, text: &str| match clock(text.trim()) {
        Ok(clock) => Some(clock),
        Err(told) => {
            faults.push(UnplacedFault::Cell(row.cell_ref(name), told));
            None
        }
    };
    if let Some(text) = row.text("shift") {
        let Some((from, to)) = text.split_once('-') else {
            let fix = Some("such as 06:00-14:00".to_owned());
            faults.push(UnplacedFault::Cell(row.cell_ref("shift"), told(format!("\"{text}\" is no shift"), fix)));
            return None;
        };
        return Some(format!("{}-{}", part("shift", from)?, part("shift", to)?));
    }
    let (from, to) = (row.text("from")?, row.text("to")?);
    Some(format!("{}-{}", part("from", &from)?, part("to", &to)?))
}

/// Setup matrices from a row for every pair of groups.
fn setup_matrix(draft: &mut Draft, table: Table<'_>, faults: &mut Vec<UnplacedFault>) {
    let mut matrices: Vec<(String, Vec<RowOf<'_>>)> = Vec::new();
    for row in rows(table) {
        let name = row.text("name").unwrap_or_else(|| "setup".to_owned());
        match matrices.iter_mut().find(|(known, _)| *known == name) {
            Some((_, rows)) => rows.push(row),
            None => matrices.push((name, vec![row])),
        }
    }
    for (name, rows) in matrices {
        let mut groups: Vec<String> = Vec::new();
        let mut pairs: HashMap<(String, String), RowOf<'_>> = HashMap::new();
        for row in &rows {
            // An empty group before is a machine that was never set up.
            let from = row.text("from").unwrap_or_default();
            let Some(to) = row.due("to", faults) else { continue };
            for group in [&from, &to].into_iter().filter(|group| !group.is_empty()) {
                if !groups.contains(group) {
                    groups.push(group.clone());
                }
            }
            if pairs.insert((from.clone(), to.clone()), *row).is_some() {
                let wrong = told(format!("the change from \"{from}\" to \"{to}\" is there twice"), None);
                faults.push(UnplacedFault::Cell(row.origin(), wrong));
            }
        }
        let first = rows[0];
        draft.section("setup_matrix", first.origin());
        draft.value("name", &quoted(&name), first.cell_ref("name"));
        let list = groups.iter().map(|group| quoted(group)).collect::<Vec<_>>().join(", ");
        draft.value("groups", &format!("[{list}]"), first.origin());
        let fresh = pairs.keys().any(|(from, _)| from.is_empty());
        let before = fresh.then(String::new).into_iter().chain(groups.iter().cloned());
        draft.piece("times = [\n", first.origin());
        for from in before {
            draft.piece("    [", first.origin());
            for group in &groups {
                let Some(row) = pairs.get(&(from.clone(), group.clone())) else {
                    if from != *group {
                        let message = format!("setup matrix \"{name}\" has no time from \"{from}\" to \"{group}\"");
                        let fix = Some("add a row for it".to_owned());
                        let place = at(table.index, None, None);
                        faults.push(UnplacedFault::Cell(place, Diagnostic { code: "missing-pair", message, fix }));
                    }
                    // The same group again takes nothing, unless a row says so.
                    draft.piece("\"0 min\", ", first.origin());
                    continue;
                };
                let time = row.due("time", faults).unwrap_or_default();
                let written = row.column("time").map_or(Ok(time.clone()), |column| {
                    with_unit(&table.map.columns[column], &time, &table.source.units[column], "s", "min")
                });
                match written {
                    Ok(time) => draft.piece(&format!("{}, ", quoted(&time)), row.cell_ref("time")),
                    Err(told) => faults.push(UnplacedFault::Cell(row.cell_ref("time"), told)),
                }
            }
            draft.piece("],\n", first.origin());
        }
        draft.piece("]\n", first.origin());
    }
}
