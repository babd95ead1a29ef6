//! A cell as the value of a key, as scenarios write it.

use crate::fault::Diagnostic;
use crate::mapping::ColumnMap;
use crate::source::Cell;
use toml::Value as Toml;
use toolroom_form::{Key, Kind};
use toolroom_scenario::date;

/// Keys that are texts of which dates are meant.
const DATES: [&str; 3] = ["release", "due", "since"];

/// What separates several names in one cell.
const SEPARATORS: [char; 3] = [',', ';', '|'];

/// A text in quotes.
pub(crate) fn quoted(text: &str) -> String {
    Toml::String(text.to_owned()).to_string()
}

/// The text of a cell in the words of the mapping.
pub(crate) fn worded<'a>(column: &'a ColumnMap, cell: &'a Cell) -> &'a str {
    let text = cell.text.trim();
    column.values.get(text).map_or(text, String::as_str)
}

/// A cell as the value of `key`; `header` is the unit in the header of its column.
pub(crate) fn literal(key: &Key, column: &ColumnMap, cell: &Cell, header: &str) -> Result<String, Diagnostic> {
    if DATES.contains(&key.name) {
        return moment(column, cell).map(|moment| quoted(&moment));
    }
    of_kind(&key.kind, column, worded(column, cell), header)
}

fn of_kind(kind: &Kind, column: &ColumnMap, text: &str, header: &str) -> Result<String, Diagnostic> {
    match kind {
        Kind::Quantity(quantity) => with_unit(column, text, header, quantity.unit, quantity.display).map(|text| {
            // A ratio may be a bare number.
            if text.parse::<f64>().is_ok_and(f64::is_finite) { text } else { quoted(&text) }
        }),
        Kind::Shorthand { word, .. } => {
            let mean = of_kind(word, column, text, header)?;
            let nothing = text.parse::<f64>().is_ok_and(|number| number == 0.0);
            Ok(match column.cv.filter(|_| !nothing) {
                Some(cv) => format!("{{ distribution = \"lognormal\", mean = {mean}, cv = {cv} }}"),
                None => mean,
            })
        }
        Kind::Count { .. } => whole(text)
            .map(|number| number.to_string())
            .ok_or_else(|| told(format!("\"{text}\" is no whole number"), None)),
        Kind::Or { words, other } => {
            if words.contains(&text) {
                Ok(quoted(text))
            } else {
                of_kind(other, column, text, header)
            }
        }
        Kind::Dated(other) => of_kind(other, column, text, header),
        Kind::Flag => match text.to_lowercase().as_str() {
            "true" => Ok("true".to_owned()),
            "false" => Ok("false".to_owned()),
            _ => {
                let fix = "say by `values` what it means: values = { X = \"true\" }".to_owned();
                Err(told(format!("\"{text}\" is neither true nor false"), Some(fix)))
            }
        },
        Kind::List(item) => {
            let items = text.split(SEPARATORS).map(str::trim).filter(|text| !text.is_empty());
            let meant = |text: &'_ str| column.values.get(text).map_or_else(|| text.to_owned(), Clone::clone);
            let items: Result<Vec<String>, Diagnostic> =
                items.map(|text| of_kind(item, column, &meant(text), header)).collect();
            items.map(|items| format!("[{}]", items.join(", ")))
        }
        Kind::Name
        | Kind::Text
        | Kind::Choice(_)
        | Kind::Reference(_)
        | Kind::Table(_)
        | Kind::Tables(_)
        | Kind::Fields { .. }
        | Kind::Parameters
        | Kind::Texts
        | Kind::Content(_)
        | Kind::Amount => Ok(quoted(text)),
    }
}

/// A whole number; spreadsheets and order systems write `60.0` too.
pub(crate) fn whole(text: &str) -> Option<i64> {
    let number: f64 = text.parse().ok()?;
    // Beyond this not every whole number is one of a spreadsheet.
    (number.fract() == 0.0 && number.abs() < 2f64.powi(53)).then_some(number as i64)
}

/// A number with the unit of its column; what already has a unit stays as it is.
pub(crate) fn with_unit(
    column: &ColumnMap,
    text: &str,
    header: &str,
    si: &str,
    display: &str,
) -> Result<String, Diagnostic> {
    if text.parse::<f64>().is_err() {
        return Ok(text.to_owned());
    }
    let unit = column.unit.as_deref().unwrap_or(header);
    if !unit.is_empty() {
        return Ok(format!("{text} {unit}"));
    }
    if si == "1" {
        return Ok(text.to_owned());
    }
    let fix = format!(
        "say it in the mapping: {{ name = \"{}\", from = \"{}\", unit = \"{display}\" }}",
        column.name, column.from
    );
    Err(told(format!("{text} has no unit"), Some(fix)))
}

/// A date, or a time since the start with its unit.
pub(crate) fn moment(column: &ColumnMap, cell: &Cell) -> Result<String, Diagnostic> {
    let text = worded(column, cell);
    let (time, has_clock) = match column.format.as_deref().filter(|_| !cell.is_date) {
        Some(format) => {
            let Some(time) = date::by_format(text, format) else {
                return Err(told(format!("\"{text}\" is no date of the form \"{format}\""), None));
            };
            (time, format.contains("%H"))
        }
        None => match date::parse(text) {
            Some(time) => (time, text.contains(':')),
            // A time since the start; the scenario is asked whether it is one.
            None if column.unit.is_some() => return with_unit(column, text, "", "s", "h"),
            None => return Ok(text.to_owned()),
        },
    };
    // A date cell of a workbook is midnight where it has no time.
    let has_clock = has_clock && !(cell.is_date && text.ends_with(" 00:00"));
    let clock = column.at.as_deref().and_then(date::clock).filter(|_| !has_clock).unwrap_or(0.0);
    Ok(date::show(time + clock))
}

/// A time of the day, `6:00` or `06:00:00`, as calendars write it.
pub(crate) fn clock(text: &str) -> Result<String, Diagnostic> {
    let padded = if text.find(':') == Some(1) { format!("0{text}") } else { text.to_owned() };
    match date::clock(&padded) {
        Some(time) => {
            let minutes = (time / 60.0).round() as u32;
            Ok(format!("{:02}:{:02}", minutes / 60, minutes % 60))
        }
        None => Err(told(format!("\"{text}\" is no time of the day"), Some("such as 06:00".to_owned()))),
    }
}

pub(crate) fn told(message: String, fix: Option<String>) -> Diagnostic {
    Diagnostic { code: "table-cell", message, fix }
}
