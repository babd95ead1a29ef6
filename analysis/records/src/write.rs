//! Records to CSV.

use super::Records;
use super::columns::ColumnKind;
use std::io::Write;
use toolroom_process::table::{Cell, CsvWriter};
use toolroom_process::unit;

/// Writes records in display units, columns in the order of their kind, missing cells empty.
///
/// # Errors
/// Those of the writer.
pub fn write_csv(records: &Records, to: impl Write) -> Result<(), csv::Error> {
    let present = |name: &str| records.numbers(name).is_some() || records.texts(name).is_some();
    let columns: Vec<_> = records.kind.columns().iter().filter(|column| present(column.name)).collect();
    let mut writer = CsvWriter::new(to, columns.iter().map(|column| column.header()))?;
    for row in 0..records.len() {
        let cell = |column: &&super::RecordColumn| match column.kind {
            ColumnKind::Text => Cell::from(records.texts(column.name).map(|texts| &texts[row])),
            ColumnKind::Condition | ColumnKind::Channel => {
                let value = records.numbers(column.name).map_or(f64::NAN, |numbers| numbers[row]);
                Cell::Number(digits(unit::convert(value, column.unit, column.display)))
            }
        };
        writer.row(columns.iter().map(cell))?;
    }
    writer.flush()
}

/// Twelve significant digits: milliseconds in a year, and 60 m/min stays 60.
fn digits(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}
