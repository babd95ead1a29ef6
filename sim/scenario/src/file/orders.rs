//! Orders: sections of the scenario and rows of a table beside it.

use super::calendars::moment;
use super::fault::ScenarioFault;
use super::keys::SCENARIO;
use super::order_columns::Columns;
use super::resolve::{Names, reference};
use crate::{Order, Part, date};
use std::borrow::Cow;
use std::collections::BTreeSet;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toolroom_form::{Fault, Form, Kind, Section, Span, Walk, nearest};

/// What the orders of a file are read against.
struct Reader<'a> {
    names: &'a Names,
    parts: &'a [Part],
    start: Option<f64>,
    horizon: f64,
    seen: BTreeSet<String>,
}

/// All orders: those of `[[order]]` first, then those of the table.
pub(super) fn orders(
    walk: &mut Walk,
    root: &Section<'_>,
    names: &Names,
    parts: &[Part],
    start: Option<f64>,
    horizon: f64,
) -> Vec<Order> {
    let mut reader = Reader { names, parts, start, horizon, seen: BTreeSet::new() };
    let sections = walk.sections(root, "order", None);
    let mut orders: Vec<Order> = sections.iter().map(|section| reader.order(walk, section)).collect();
    if let Some(tables) = walk.table(root, "tables")
        && let Some(path) = tables.text("orders")
        && let Some(text) = walk.file(&tables, "orders", path)
    {
        let mapping = Columns::read(walk, &tables, order_form());
        orders.extend(reader.table(walk, path, &text, (&tables.span_of("orders"), &mapping)));
    }
    orders
}

impl Reader<'_> {
    fn order(&mut self, walk: &mut Walk, section: &Section<'_>) -> Order {
        let id = section.text("id").unwrap_or_default().to_owned();
        if !id.is_empty() && !self.seen.insert(id.clone()) {
            walk.fault(section.span_of("id"), Fault::DuplicateName { kind: "order", name: id.clone() });
        }
        let known = self.names.parts.iter().map(String::as_str);
        let part = reference(walk, "part", section.got("part"), known).unwrap_or(0);
        let release = moment(walk, section, "release", self.start).unwrap_or(0.0);
        if !(0.0..=self.horizon).contains(&release) {
            let run = format!("from {} to {}", self.shown(0.0), self.shown(self.horizon));
            let fault = ScenarioFault::OrderOutside { id: id.clone(), release: self.shown(release), run };
            walk.fault(section.span_of("release"), fault);
        }
        let allowance = self.parts.get(part).map_or(0.0, |part| part.flow_allowance);
        let due = match moment(walk, section, "due", self.start) {
            Some(due) => due,
            None => release + allowance,
        };
        if due < release {
            let fault = Fault::Contradiction {
                first: "due",
                first_value: self.shown(due),
                second: "release",
                second_value: self.shown(release),
                rule: "an order is due after it is released",
            };
            walk.fault(section.span_of("due"), fault);
        }
        Order {
            id,
            part,
            quantity: section.count32("quantity"),
            release,
            due,
            priority: section.count32("priority"),
            weight: section.required("weight"),
            customer: section.text("customer").unwrap_or_default().to_owned(),
            transfer: section.count("transfer").and_then(|pieces| u32::try_from(pieces).ok()),
        }
    }

    /// A time as people read it.
    fn shown(&self, time: f64) -> String {
        self.start.map_or_else(|| format!("{} h", time / 3600.0), |start| date::show(start + time))
    }

    /// Rows of a comma-separated table; a semicolon separates where the first line has no comma.
    fn table(&mut self, walk: &mut Walk, file: &str, text: &str, (place, mapping): (&Span, &Columns)) -> Vec<Order> {
        let form = order_form();
        let first_line = text.lines().next().unwrap_or_default();
        let delimiter = if first_line.contains(';') && !first_line.contains(',') { b';' } else { b',' };
        let mut rows = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let fault = |line: u64, reason: String, fix: Option<String>| ScenarioFault::TableCell {
            file: file.to_owned(),
            line,
            reason,
            fix,
        };
        let header: Vec<String> = match rows.headers() {
            Ok(header) => header.iter().map(str::to_owned).collect(),
            Err(error) => {
                walk.fault(place.clone(), fault(1, error.to_string(), None));
                return Vec::new();
            }
        };
        let noted = walk.problems.len();
        // A column that no mapping names has an empty name and is passed over.
        let columns = mapping.named(walk, &header, file);
        for (i, column) in columns.iter().enumerate().filter(|(_, column)| !column.is_empty()) {
            let known = || form.keys.iter().map(|key| key.name);
            if columns[..i].contains(column) {
                walk.fault(place.clone(), fault(1, format!("two columns are called \"{column}\""), None));
            } else if form.key(column).is_none() {
                let nearest = nearest(column, known()).map(|near| format!("did you mean `{near}`? "));
                let fix = format!(
                    "{}columns: {}; [[tables.column]] says what columns with other names are",
                    nearest.unwrap_or_default(),
                    known().collect::<Vec<_>>().join(", ")
                );
                walk.fault(place.clone(), fault(1, format!("there is no column \"{column}\""), Some(fix)));
            }
        }
        for column in ["id", "part"].into_iter().filter(|column| !columns.iter().any(|own| own == column)) {
            walk.fault(place.clone(), fault(1, format!("the column `{column}` is missing"), None));
        }
        if walk.problems.len() > noted {
            return Vec::new();
        }
        let mut orders = Vec::new();
        for row in rows.records() {
            let row = match row {
                Ok(row) => row,
                Err(error) => {
                    let line = error.position().map_or(0, csv::Position::line);
                    walk.fault(place.clone(), fault(line, error.to_string(), None));
                    continue;
                }
            };
            let line = row.position().map_or(0, csv::Position::line);
            let noted = walk.problems.len();
            let cells: Vec<Cow<'_, str>> =
                columns.iter().zip(row.iter()).map(|(column, cell)| mapping.cell(walk, column, cell, place)).collect();
            let cells = columns.iter().zip(&cells).map(|(column, cell)| (column.as_str(), cell.as_ref()));
            let cells = cells.filter(|(column, cell)| !column.is_empty() && !cell.is_empty());
            let table: DeTable<'_> = cells.map(|(column, cell)| entry(form, column, cell, place)).collect();
            let echoed = walk.echo.len();
            let section = walk.section(form, "order", &table, place.clone(), None);
            orders.push(self.order(walk, &section));
            walk.echo.truncate(echoed); // what a table says is read there
            for problem in &mut walk.problems[noted..] {
                let told = fault(line, problem.fault.to_string(), problem.fault.fix());
                problem.fault = told.into();
                problem.span = place.clone();
            }
        }
        orders
    }
}

/// The form of `[[order]]`, which rows of a table have too.
fn order_form() -> &'static Form {
    match SCENARIO.key("order").map(|key| key.kind) {
        Some(Kind::Tables(form)) => form,
        _ => unreachable!("a scenario has tables of orders"),
    }
}

/// A cell as the value of a key.
fn entry<'d>(
    form: &Form,
    column: &'d str,
    cell: &'d str,
    place: &Span,
) -> (Spanned<Cow<'d, str>>, Spanned<DeValue<'d>>) {
    let whole = matches!(form.key(column).map(|key| key.kind), Some(Kind::Count { .. }));
    let number = if whole { DeValue::parse(cell).ok().map(Spanned::into_inner) } else { None };
    let value = number.filter(DeValue::is_integer).unwrap_or(DeValue::String(cell.into()));
    (Spanned::new(place.clone(), column.into()), Spanned::new(place.clone(), value))
}
