//! Parquet files to a table of cells.

use polars::prelude::{AnyValue, ParquetReader, PolarsResult, SerReader};
use std::fs::File;
use std::path::Path;
use toolroom_records::{RawTable, RecordError};

/// Reads every column as text; numbers keep all their digits.
///
/// # Errors
/// [`RecordError::Table`] where polars cannot read the file.
pub fn read_cells(path: &Path) -> Result<RawTable, RecordError> {
    cells(path).map_err(|source| RecordError::Table { path: path.to_owned(), source: Box::new(source) })
}

fn cells(path: &Path) -> PolarsResult<RawTable> {
    let frame = ParquetReader::new(File::open(path)?).finish()?;
    let columns = frame.columns();
    let header = columns.iter().map(|column| column.name().to_string()).collect();
    let mut rows = Vec::with_capacity(frame.height());
    for row in 0..frame.height() {
        let mut cells = Vec::with_capacity(columns.len());
        for column in columns {
            let value = column.get(row)?;
            #[expect(
                clippy::wildcard_enum_match_arm,
                reason = "polars has kinds of values that depend on its features"
            )]
            cells.push(match value {
                AnyValue::Null => String::new(),
                AnyValue::String(text) => text.to_owned(),
                AnyValue::StringOwned(text) => text.to_string(),
                AnyValue::Float64(number) => number.to_string(),
                AnyValue::Float32(number) => number.to_string(),
                other => other.to_string(),
            });
        }
        rows.push((row + 1, cells));
    }
    Ok(RawTable { header, header_line: 0, rows, notes: Vec::new() })
}
