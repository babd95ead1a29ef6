//! Records to CSV.

use super::Records;
use super::columns::ColumnKind;
use std::io::Write;
use toolroom_process::unit;

/// Writes records in display units, columns in the order of their kind, missing cells empty.
///
/// # Errors
/// Those of the writer.
pub fn write_csv(records: &Records, to: impl Write) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_writer(to);
    let present = |name: &str| records.numbers(name).is_some() || records.texts(name).is_some();
    let columns: Vec<_> = records.kind.columns().iter().filter(|column| present(column.name)).collect();
    writer.write_record(columns.iter().map(|column| column.header()))?;
    for row in 0..records.len() {
        let cell = |column: &&&super::RecordColumn| match column.kind {
            ColumnKind::Text => records.texts(column.name).map_or(String::new(), |texts| texts[row].clone()),
            _ => {
                let value = records.numbers(column.name).map_or(f64::NAN, |numbers| numbers[row]);
                if value.is_nan() { String::new() } else { digits(unit::convert(value, column.unit, column.display)) }
            }
        };
        writer.write_record(columns.iter().map(|column| cell(&column)))?;
    }
    writer.flush()?;
    Ok(())
}

/// Twelve significant digits: milliseconds in a year, and 60 m/min stays 60.
fn digits(value: f64) -> String {
    format!("{value:.11e}").parse::<f64>().map_or_else(|_| value.to_string(), |rounded| rounded.to_string())
}
