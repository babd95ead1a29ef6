//! Rows to Parquet in batches.

use polars::prelude::{
    BatchedWriter, DataFrame, DataType, Field, IntoColumn, NamedFrom, NewChunkedArray, ParquetReader, ParquetWriter,
    PlSmallStr, PolarsResult, Schema, SerReader, Series, StringChunked,
};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use toolroom_records::table::{Kind, TableError, TableWriter, Value};

/// Rows of a row group; fixed, so that the bytes do not depend on how the rows arrive.
const BATCH: usize = 1 << 16;

/// Cells of a column not yet written.
enum Buffer {
    Real(Vec<Option<f64>>),
    Count(Vec<Option<u32>>),
    Text(Vec<PlSmallStr>),
}

/// A Parquet file being written.
pub struct ParquetTable {
    writer: BatchedWriter<BufWriter<File>>,
    schema: Schema,
    buffers: Vec<Buffer>,
    rows: usize,
}

/// A Parquet file for rows of the `columns`, each a header and a kind.
///
/// # Errors
/// What polars says about the header.
pub fn create(file: File, columns: &[(&str, Kind)]) -> Result<Box<dyn TableWriter + Send>, TableError> {
    let columns = columns.iter().map(|(header, kind)| ((*header).to_owned(), *kind));
    Ok(Box::new(ParquetTable::new(file, columns)?))
}

impl ParquetTable {
    /// A file for rows of `columns`, each a header and a kind.
    ///
    /// # Errors
    /// What polars says about the header.
    pub fn new(file: File, columns: impl Iterator<Item = (String, Kind)>) -> PolarsResult<Self> {
        let mut schema = Schema::default();
        let mut buffers = Vec::new();
        for (header, kind) in columns {
            let (kind, buffer) = match kind {
                Kind::Real => (DataType::Float64, Buffer::Real(Vec::new())),
                Kind::Count => (DataType::UInt32, Buffer::Count(Vec::new())),
                Kind::Text => (DataType::String, Buffer::Text(Vec::new())),
            };
            let field = Field::new(header.into(), kind);
            schema.with_column(field.name, field.dtype);
            buffers.push(buffer);
        }
        let writer = ParquetWriter::new(BufWriter::new(file)).set_parallel(false).batched(&schema)?;
        Ok(Self { writer, schema, buffers, rows: 0 })
    }

    /// Adds a row, one cell a column in the order of the columns.
    ///
    /// # Errors
    /// What polars says about the row group that it may complete.
    ///
    /// # Panics
    /// If a cell is not of its column's kind.
    pub fn row<'a>(&mut self, cells: impl Iterator<Item = Value<'a>>) -> PolarsResult<()> {
        for (cell, buffer) in cells.zip(&mut self.buffers) {
            match (cell, buffer) {
                (Value::Real(value), Buffer::Real(cells)) => cells.push(value),
                (Value::Count(value), Buffer::Count(cells)) => cells.push(value),
                (Value::Text(value), Buffer::Text(cells)) => cells.push(value.into()),
                (Value::Real(_) | Value::Count(_) | Value::Text(_), _) => unreachable!("a column has one kind"),
            }
        }
        self.rows += 1;
        if self.rows == BATCH { self.flush() } else { Ok(()) }
    }

    /// Takes over the rows of an earlier table, a row group at a time.
    ///
    /// # Errors
    /// What polars says about either file.
    pub fn take_over(&mut self, earlier: &Path) -> PolarsResult<()> {
        for batch in 0.. {
            let reader = ParquetReader::new(File::open(earlier)?);
            let frame = reader.with_slice(Some((batch * BATCH, BATCH))).finish()?;
            for (name, buffer) in self.schema.iter_names().zip(&mut self.buffers) {
                let column = frame.column(name)?;
                match buffer {
                    Buffer::Real(cells) => cells.extend(column.f64()?.iter()),
                    Buffer::Count(cells) => cells.extend(column.u32()?.iter()),
                    Buffer::Text(cells) => {
                        cells.extend(column.str()?.iter().map(|text| PlSmallStr::from_str(text.unwrap_or_default())));
                    }
                }
            }
            self.rows += frame.height();
            if self.rows < BATCH {
                break;
            }
            self.flush()?;
        }
        Ok(())
    }

    /// Writes what is buffered as a row group.
    fn flush(&mut self) -> PolarsResult<()> {
        let columns = self.schema.iter_names().zip(&mut self.buffers).map(|(name, buffer)| match buffer {
            Buffer::Real(cells) => Series::new(name.clone(), std::mem::take(cells)).into_column(),
            Buffer::Count(cells) => Series::new(name.clone(), std::mem::take(cells)).into_column(),
            Buffer::Text(cells) => {
                let text = StringChunked::from_iter_values(name.clone(), cells.iter().map(PlSmallStr::as_str));
                cells.clear();
                text.into_column()
            }
        });
        let frame = DataFrame::new(self.rows, columns.collect())?;
        self.rows = 0;
        self.writer.write_batch(&frame)
    }

    /// Writes what is buffered and closes the file; without it the file cannot be read.
    ///
    /// # Errors
    /// What polars says.
    pub fn finish(mut self) -> PolarsResult<()> {
        self.end_group()?;
        self.writer.finish().map(|_| ())
    }

    fn end_group(&mut self) -> PolarsResult<()> {
        if self.rows > 0 { self.flush() } else { Ok(()) }
    }
}

impl TableWriter for ParquetTable {
    fn row(&mut self, cells: &[Value<'_>]) -> Result<(), TableError> {
        Ok(Self::row(self, cells.iter().copied())?)
    }

    fn end_group(&mut self) -> Result<(), TableError> {
        Ok(Self::end_group(self)?)
    }

    fn finish(self: Box<Self>) -> Result<(), TableError> {
        Ok(Self::finish(*self)?)
    }
}
