//! Rows to Parquet in batches.

use super::columns::{Column, Kind, Row, Value};
use polars::prelude::{
    BatchedWriter, DataFrame, DataType, Field, IntoColumn, NamedFrom, NewChunkedArray, ParquetReader, ParquetWriter,
    PlSmallStr, PolarsResult, Schema, SerReader, Series, StringChunked,
};
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// Rows of a row group; fixed, so that the bytes do not depend on how the rows arrive.
const BATCH: usize = 1 << 16;

/// Cells of a column not yet written.
enum Buffer {
    Real(Vec<Option<f64>>),
    Count(Vec<Option<u32>>),
    Text(Vec<PlSmallStr>),
}

/// A Parquet file being written.
pub(super) struct ParquetTable {
    writer: BatchedWriter<BufWriter<File>>,
    schema: Schema,
    buffers: Vec<Buffer>,
    rows: usize,
}

impl ParquetTable {
    pub fn new<R>(file: File, columns: &[Column<R>]) -> PolarsResult<Self> {
        let fields = columns.iter().map(|column| {
            let kind = match column.kind() {
                Kind::Real => DataType::Float64,
                Kind::Count => DataType::UInt32,
                Kind::Text => DataType::String,
            };
            Field::new(column.header().into(), kind)
        });
        let schema: Schema = fields.collect();
        let writer = ParquetWriter::new(BufWriter::new(file)).set_parallel(false).batched(&schema)?;
        Ok(Self { writer, buffers: empty(columns), schema, rows: 0 })
    }

    pub fn write<'a, R: 'a>(
        &mut self,
        columns: &[Column<R>],
        rows: impl Iterator<Item = Row<'a, R>>,
    ) -> PolarsResult<()> {
        for row in rows {
            for (column, buffer) in columns.iter().zip(&mut self.buffers) {
                match (column.value(&row), buffer) {
                    (Value::Real(value), Buffer::Real(cells)) => cells.push(value),
                    (Value::Count(value), Buffer::Count(cells)) => cells.push(value),
                    (Value::Text(value), Buffer::Text(cells)) => cells.push(value.into()),
                    _ => unreachable!("a column has one kind"),
                }
            }
            self.rows += 1;
            if self.rows == BATCH {
                self.flush()?;
            }
        }
        Ok(())
    }

    /// Takes over the rows of an earlier table, a row group at a time.
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

    pub fn finish(mut self) -> PolarsResult<()> {
        if self.rows > 0 {
            self.flush()?;
        }
        self.writer.finish().map(|_| ())
    }
}

fn empty<R>(columns: &[Column<R>]) -> Vec<Buffer> {
    let buffer = |column: &Column<R>| match column.kind() {
        Kind::Real => Buffer::Real(Vec::new()),
        Kind::Count => Buffer::Count(Vec::new()),
        Kind::Text => Buffer::Text(Vec::new()),
    };
    columns.iter().map(buffer).collect()
}
