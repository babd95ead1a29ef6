//! Tables in files beside a scenario: a row is a section.

use super::fault::ScenarioFault;
use super::keys::SCENARIO;
use super::order_columns::Columns;
use std::borrow::Cow;
use toml::Spanned;
use toml::de::{DeTable, DeValue};
use toolroom_form::{Encoding, Form, Kind, Need, Section, Span, Undecodable, Walk, nearest};
use toolroom_process::table::Lines;

/// What else columns of orders may be called.
const MAPPED: &str = "; [[tables.column]] says what columns with other names are";

/// A table beside the scenario.
pub(super) struct Table<'a> {
    /// The file, as the scenario names it.
    pub file: &'a str,
    /// What it says.
    pub text: &'a str,
    /// Where the scenario names it.
    pub place: Span,
    /// The sections that its rows are: `order`.
    pub kind: &'static str,
    /// What its columns are.
    pub mapping: &'a Columns,
}

impl Table<'_> {
    /// Hands every row as a section, with its line, to `row`. A semicolon separates where the first line has no comma.
    pub fn rows(&self, walk: &mut Walk, mut row: impl FnMut(&mut Walk, &Section<'_>, u64)) {
        let &Self { file, text, ref place, kind, mapping } = self;
        let form = form_of(kind);
        let first_line = text.lines().next().unwrap_or_default();
        let delimiter = if first_line.contains(';') && !first_line.contains(',') { b';' } else { b',' };
        let mut rows = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .flexible(true) // rows of another length are told below
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
                return;
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
                let other = if kind == "order" { MAPPED } else { "" };
                let known = known().collect::<Vec<_>>().join(", ");
                let fix = format!("{}columns: {known}{other}", nearest.unwrap_or_default());
                walk.fault(place.clone(), fault(1, format!("there is no column \"{column}\""), Some(fix)));
            }
        }
        let due = form.keys.iter().filter(|key| matches!(key.need, Need::Required)).map(|key| key.name);
        for column in due.filter(|column| !columns.iter().any(|own| own == column)) {
            walk.fault(place.clone(), fault(1, format!("the column `{column}` is missing"), None));
        }
        if walk.problems.len() > noted {
            return;
        }
        let mut lines = Lines::new(text);
        for record in rows.records() {
            let record = match record {
                Ok(record) => record,
                Err(error) => {
                    let line = error.position().map_or(0, csv::Position::line);
                    walk.fault(place.clone(), fault(line, error.to_string(), None));
                    continue;
                }
            };
            let line = record.position().map_or(0, |position| lines.at(position.byte()) as u64);
            if record.len() != columns.len() {
                let sign = char::from(delimiter);
                let count = |count: usize| format!("{count} cell{}", if count == 1 { "" } else { "s" });
                let reason = format!("the row has {}, but the first line {}", count(record.len()), columns.len());
                let fix = format!(
                    "give every row a cell for each column: leave it empty where there is nothing (`{sign}{sign}`), and put it in quotes where it holds a `{sign}`"
                );
                walk.fault(place.clone(), fault(line, reason, Some(fix)));
                continue;
            }
            let noted = walk.problems.len();
            let cells: Vec<Cow<'_, str>> = columns
                .iter()
                .zip(record.iter())
                .map(|(column, cell)| mapping.cell(walk, column, cell, place))
                .collect();
            let cells = columns.iter().zip(&cells).map(|(column, cell)| (column.as_str(), cell.as_ref()));
            let cells = cells.filter(|(column, cell)| !column.is_empty() && !cell.is_empty());
            let cells: Vec<(&str, &str)> = cells.collect();
            let is_count = |column: &str| matches!(form.key(column).map(|key| key.kind), Some(Kind::Count { .. }));
            let written = cells.iter().filter(|(column, _)| is_count(column));
            let grouped = written.filter_map(|(column, cell)| Some((column, cell, plain_number(cell)?)));
            let grouped: Vec<String> = grouped
                .map(|(column, cell, plain)| {
                    let reason =
                        format!("`{column}` is \"{cell}\": points, commas and gaps in whole numbers are not read");
                    walk.fault(place.clone(), fault(line, reason, Some(format!("write {plain}"))));
                    plain
                })
                .collect();
            if !grouped.is_empty() {
                continue;
            }
            let table: DeTable<'_> = cells.into_iter().map(|(column, cell)| entry(form, column, cell, place)).collect();
            let echoed = walk.echo.len();
            let section = walk.section(form, kind, &table, place.clone(), None);
            row(walk, &section, line);
            walk.echo.truncate(echoed); // what a table says is read there
            for problem in &mut walk.problems[noted..] {
                let placed = fault(line, problem.fault.to_string(), problem.fault.fix());
                problem.fault = placed.into();
                problem.span = place.clone();
            }
        }
    }
}

/// The text of a table that the value under `key` of `[tables]` names, in the encoding of that section; `None` where a problem was
/// noted. Which encoding a file has cannot be told for certain, and a wrong letter in a name is another part: it is asked for.
pub(super) fn text(walk: &mut Walk, tables: &Section<'_>, key: &str, file: &str) -> Option<String> {
    let encoding = tables.chosen("encoding", Encoding::from_word).unwrap_or_default();
    let bytes = walk.bytes(tables, key, file)?;
    match encoding.decode(&bytes) {
        Ok(text) => Some(text),
        Err(Undecodable { line, reason }) => {
            let fix = match encoding {
                Encoding::Utf8 | Encoding::Latin1 => {
                    "say what it is, `encoding = \"windows-1252\"` (or \"latin-1\", \"utf-16\") under [tables], or save the \
                     file as UTF-8 (in spreadsheets the format \"CSV UTF-8\")"
                }
                Encoding::Utf16 | Encoding::Windows1252 => "take out `encoding`, or save the file as UTF-8",
            };
            let file = file.to_owned();
            let fault = ScenarioFault::TableCell { file, line, reason, fix: Some(fix.to_owned()) };
            walk.fault(tables.span_of(key), fault);
            None
        }
    }
}

/// The form of the sections of a kind, which rows of a table have too.
pub(super) fn form_of(kind: &str) -> &'static Form {
    match SCENARIO.key(kind).map(|key| key.kind) {
        Some(Kind::Tables(form)) => form,
        _ => unreachable!("a scenario has tables of that kind"),
    }
}

/// A number with signs between its digits as a whole number without them, such as `1.062,00`: a comma is taken for the
/// decimal sign, points and gaps for thousands where three digits follow each. `None` for any other text; decimals that are not
/// nought are rounded up, since pieces are whole.
fn plain_number(cell: &str) -> Option<String> {
    let is_gap = |c: char| matches!(c, '.' | '\'' | ' ' | '\u{a0}' | '\u{202f}');
    let (whole, decimals) = match cell.rsplit_once(',') {
        Some((whole, decimals)) => (whole, decimals),
        None => match cell.rsplit_once('.') {
            Some((whole, decimals)) if decimals.len() != 3 && !whole.contains(is_gap) => (whole, decimals),
            Some(_) | None => (cell, ""),
        },
    };
    let mut groups = whole.split(is_gap);
    let first = groups.next().filter(|first| (1..=3).contains(&first.len()) || !whole.contains(is_gap))?;
    let all_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let groups: Vec<&str> = groups.collect();
    let fits =
        !first.is_empty() && all_digits(first) && groups.iter().all(|group| group.len() == 3 && all_digits(group));
    if !fits || !all_digits(decimals) || groups.is_empty() && cell == first {
        return None;
    }
    let number: u64 = format!("{first}{}", groups.concat()).parse().ok()?;
    Some(number.saturating_add(u64::from(decimals.bytes().any(|byte| byte != b'0'))).to_string())
}

/// A cell as the value of a key.
fn entry<'d>(
    form: &Form,
    column: &'d str,
    cell: &'d str,
    place: &Span,
) -> (Spanned<Cow<'d, str>>, Spanned<DeValue<'d>>) {
    let kind = form.key(column).map(|key| key.kind);
    let bare = matches!(kind, Some(Kind::Count { .. } | Kind::Or { .. } | Kind::Flag));
    let read = if bare { DeValue::parse(cell).ok().map(Spanned::into_inner) } else { None };
    let read = read.filter(|value| value.is_integer() || value.is_bool());
    let value = read.unwrap_or(DeValue::String(cell.into()));
    (Spanned::new(place.clone(), column.into()), Spanned::new(place.clone(), value))
}

#[cfg(test)]
mod tests {
    use super::plain_number;

    #[test]
    fn whole_numbers_with_signs_between_their_digits_are_told_as_they_have_to_be_written() {
        let told = [
            ("1.062,00", "1062"),
            ("1.062,50", "1063"),
            ("1.062", "1062"),
            ("12 500", "12500"),
            ("40,0", "40"),
            ("2.5", "3"),
        ];
        for (cell, plain) in told {
            assert_eq!(plain_number(cell).as_deref(), Some(plain), "{cell}");
        }
        for cell in ["40", "many", "1.06.2", "", ",", "1,062,500 pieces", "-4"] {
            assert_eq!(plain_number(cell), None, "{cell}");
        }
    }
}
