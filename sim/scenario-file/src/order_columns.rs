//! Tables of orders whose columns have names and dates of their own.

use super::fault::ScenarioFault;
use std::borrow::Cow;
use toolroom_form::{Fault, Form, Section, Span, Walk, nearest};
use toolroom_scenario::date;

/// What the columns of a table are; none listed where they have the names of `[[order]]`.
pub(super) struct Columns {
    listed: Vec<Column>,
}

/// A column under its own name.
struct Column {
    name: String,
    from: String,
    format: Option<String>,
    clock: Option<String>,
    span: Span,
}

/// Columns that hold dates.
const DATES: [&str; 2] = ["release", "due"];

impl Columns {
    /// Columns under the names of their keys.
    pub fn own() -> Self {
        Self { listed: Vec::new() }
    }

    /// The sections `column` of `[tables]`.
    pub fn read(walk: &mut Walk, tables: &Section<'_>, form: &Form) -> Self {
        let mut listed: Vec<Column> = Vec::new();
        for section in walk.sections(tables, "column", None) {
            let (Some(name), Some(from)) = (section.text("name"), section.text("from")) else { continue };
            let known = || form.keys.iter().map(|key| key.name);
            if form.key(name).is_none() {
                let fault = Fault::UnknownName {
                    kind: "column",
                    name: name.to_owned(),
                    nearest: nearest(name, known()).map(str::to_owned),
                    known: known().collect::<Vec<_>>().join(", "),
                };
                walk.fault(section.span_of("name"), fault);
                continue;
            }
            if listed.iter().any(|own| own.name == name) {
                let fault = Fault::DuplicateName { kind: "column", name: name.to_owned() };
                walk.fault(section.span_of("name"), fault);
            }
            let bad = |key, read: &str, expected, example| ScenarioFault::NoDate {
                key,
                read: read.to_owned(),
                expected,
                example,
            };
            if let Some(format) = section.text("format").filter(|format| !date::is_format(format)) {
                let fault = bad("format", format, "form of a date", "\"%d.%m.%Y\" or \"%m/%d/%Y %H:%M\"");
                walk.fault(section.span_of("format"), fault);
            }
            if let Some(clock) = section.text("at").filter(|clock| date::clock(clock).is_none()) {
                walk.fault(section.span_of("at"), bad("at", clock, "time of the day", "\"14:00\""));
            }
            for key in ["format", "at"].into_iter().filter(|key| section.given(key) && !DATES.contains(&name)) {
                let (case, applicable) = (format!("the column `{name}`"), DATES.join(", "));
                walk.fault(section.span_of(key), Fault::NotApplicable { key, case, applicable });
            }
            listed.push(Column {
                name: name.to_owned(),
                from: from.to_owned(),
                format: section.text("format").map(str::to_owned),
                clock: section.text("at").map(str::to_owned),
                span: section.span_of("from"),
            });
        }
        Self { listed }
    }

    /// The keys that the columns of a table are, empty for one that is not listed.
    pub fn named(&self, walk: &mut Walk, header: &[String], file: &str) -> Vec<String> {
        if self.listed.is_empty() {
            return header.to_vec();
        }
        for column in self.listed.iter().filter(|column| !header.contains(&column.from)) {
            let near = nearest(&column.from, header.iter().map(String::as_str));
            let near = near.map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
            let fault = ScenarioFault::TableCell {
                file: file.to_owned(),
                line: 1,
                reason: format!("there is no column \"{}\"", column.from),
                fix: Some(format!("{near}columns: {}", header.join(", "))),
            };
            walk.fault(column.span.clone(), fault);
        }
        let name = |from: &String| self.listed.iter().find(|own| own.from == *from).map(|own| own.name.clone());
        header.iter().map(|from| name(from).unwrap_or_default()).collect()
    }

    /// A cell of the column `name` with its date as scenarios write it.
    pub fn cell<'d>(&self, walk: &mut Walk, name: &str, cell: &'d str, place: &Span) -> Cow<'d, str> {
        let Some(column) =
            self.listed.iter().find(|column| column.name == name && DATES.contains(&name)).filter(|_| !cell.is_empty())
        else {
            return Cow::Borrowed(cell);
        };
        let (date, has_time) = match &column.format {
            Some(format) => {
                let Some(time) = date::by_format(cell, format) else {
                    let fault = ScenarioFault::NoDate {
                        key: DATES.into_iter().find(|key| *key == column.name).unwrap_or("due"),
                        read: cell.to_owned(),
                        expected: "date of the `format` of its column",
                        example: "31.03.2026 for \"%d.%m.%Y\"",
                    };
                    walk.fault(place.clone(), fault);
                    return Cow::Borrowed("");
                };
                (time, format.contains("%H"))
            }
            None => match date::parse(cell) {
                Some(time) => (time, cell.contains(':')),
                None => return Cow::Borrowed(cell),
            },
        };
        let clock = column.clock.as_deref().and_then(date::clock).filter(|_| !has_time).unwrap_or(0.0);
        Cow::Owned(date::show(date + clock))
    }
}
