//! Tables, which cross by Arrow's C interface without copying.

use crate::failure::Failure;
use polars::error::{PolarsError, PolarsResult};
use polars::prelude::{
    Column as PolarsColumn, CompatLevel, DataFrame, DataType, IntoColumn, NamedFrom, ParquetReader, ParquetWriter,
    PlSmallStr, SerReader, Series,
};
use polars_arrow::array::{Array, StructArray};
use polars_arrow::datatypes::{ArrowDataType, Field};
use polars_arrow::ffi::{ArrowArrayStream, ArrowArrayStreamReader, export_field_to_c, export_iterator};
use pyo3::exceptions::{PyKeyError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyCapsule, PyDict};
use std::fs::File;
use std::path::PathBuf;

/// A table of named columns; a header has its unit in brackets, `cutting_speed [m/min]`.
///
/// pandas, polars, pyarrow and duckdb take it as it is (Arrow's PyCapsule interface); the unit of a column is in the
/// metadata of its field as `unit`, too.
#[pyclass(frozen, module = "toolroom")]
pub struct Table {
    frame: DataFrame,
}

impl Table {
    /// A table of columns.
    pub fn of(columns: Vec<PolarsColumn>) -> Result<Self, Failure> {
        let height = columns.first().map_or(0, PolarsColumn::len);
        DataFrame::new(height, columns).map(|frame| Self { frame }).map_err(Failure::work)
    }

    /// The fields with their units.
    fn field(&self) -> Field {
        let fields = self.frame.columns().iter().map(|column| {
            let field = column.field().to_arrow(CompatLevel::oldest());
            match unit(column.name()) {
                Some(unit) => field.with_metadata([(PlSmallStr::from("unit"), PlSmallStr::from(unit))].into()),
                None => field,
            }
        });
        Field::new(PlSmallStr::EMPTY, ArrowDataType::Struct(fields.collect()), false)
    }
}

/// The unit in the brackets of a header.
fn unit(header: &str) -> Option<&str> {
    header.strip_suffix(']')?.rsplit_once('[').map(|(_, unit)| unit)
}

fn lost(error: PolarsError) -> Failure {
    Failure::work(error)
}

#[pymethods]
impl Table {
    /// Reads a table from a Parquet file, or from a CSV file with a header.
    #[staticmethod]
    fn read(path: PathBuf) -> Result<Self, Failure> {
        if path.extension().is_some_and(|extension| extension == "parquet") {
            let file = File::open(&path).map_err(|error| Failure::file(&path, &error))?;
            let frame = ParquetReader::new(file).finish().map_err(lost)?;
            return Ok(Self { frame });
        }
        let bytes = std::fs::read(&path).map_err(|error| Failure::file(&path, &error))?;
        Self::from_csv(&bytes)
    }

    /// A table from the text of a CSV file with a header; a column of which every cell that is not empty is a number is one
    /// of numbers.
    #[staticmethod]
    fn from_csv(text: &[u8]) -> Result<Self, Failure> {
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text);
        let heads: Vec<String> = reader.headers().map_err(Failure::work)?.iter().map(str::to_owned).collect();
        let mut cells: Vec<Vec<String>> = vec![Vec::new(); heads.len()];
        for row in reader.records() {
            let row = row.map_err(Failure::work)?;
            cells.iter_mut().zip(row.iter()).for_each(|(column, cell)| column.push(cell.to_owned()));
        }
        let column = |(head, cells): (String, Vec<String>)| {
            let number = |cell: &String| -> Option<Option<f64>> {
                if cell.is_empty() { Some(None) } else { cell.parse().ok().map(Some) }
            };
            match cells.iter().map(number).collect::<Option<Vec<_>>>() {
                Some(numbers) => Series::new(head.into(), numbers).into_column(),
                None => Series::new(head.into(), cells).into_column(),
            }
        };
        Self::of(heads.into_iter().zip(cells).map(column).collect())
    }

    /// A table from whatever offers Arrow's PyCapsule stream: frames of pandas, polars, pyarrow, duckdb.
    #[staticmethod]
    fn from_arrow(data: &Bound<'_, PyAny>) -> Result<Self, Failure> {
        if !data.hasattr("__arrow_c_stream__")? {
            let class = data.get_type().name()?.to_string();
            let message = format!("{class} is no table: give a path, or a frame of pandas, polars, pyarrow or duckdb");
            return Err(PyTypeError::new_err(message).into());
        }
        let capsule = data.call_method0("__arrow_c_stream__")?;
        let capsule = capsule.cast::<PyCapsule>().map_err(PyErr::from)?;
        let pointer = capsule.pointer_checked(Some(c"arrow_array_stream"))?.cast::<ArrowArrayStream>();
        // SAFETY: a capsule of this name holds a valid stream, which its consumer takes by leaving an empty one.
        let stream = unsafe { std::ptr::replace(pointer.as_ptr(), ArrowArrayStream::empty()) };
        let frame = read_stream(Box::new(stream)).map_err(|error| {
            Failure::argument(
                format_args!("a column of the table is of a kind that is not read: {error}"),
                "give numbers, texts and truth values; turn times into seconds and categories into texts",
            )
        })?;
        Ok(Self { frame })
    }

    /// Names of the columns.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.frame.columns().iter().map(|column| column.name().to_string()).collect()
    }

    /// Unit of each column that has one.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for column in self.frame.columns() {
            if let Some(unit) = unit(column.name()) {
                units.set_item(column.name().as_str(), unit)?;
            }
        }
        Ok(units)
    }

    fn __len__(&self) -> usize {
        self.frame.height()
    }

    /// A column by its header, or by its name without the unit.
    fn __getitem__(&self, name: &str) -> PyResult<Column> {
        let bare = |header: &str| header.split(" [").next() == Some(name);
        let columns = self.frame.columns();
        let found = columns.iter().find(|column| column.name() == name);
        let Some(column) = found.or_else(|| columns.iter().find(|column| bare(column.name()))) else {
            return Err(PyKeyError::new_err(format!("{name}; the columns are {}", self.columns().join(", "))));
        };
        let series = column.as_materialized_series().rechunk();
        Ok(Column { series })
    }

    /// Cells of a row by header.
    fn row<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyDict>> {
        let row = PyDict::new(py);
        for column in self.frame.columns() {
            let cell = cell(py, column.as_materialized_series(), index).map_err(|error| PyErr::from(lost(error)))?;
            row.set_item(column.name().as_str(), cell)?;
        }
        Ok(row)
    }

    /// The table as CSV, numbers with every digit.
    fn csv<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyBytes>, Failure> {
        use polars::prelude::AnyValue;
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.columns()).map_err(Failure::work)?;
        for row in 0..self.frame.height() {
            let mut cells = Vec::with_capacity(self.frame.width());
            for column in self.frame.columns() {
                cells.push(match column.get(row).map_err(lost)? {
                    AnyValue::Null => String::new(),
                    AnyValue::String(text) => text.to_owned(),
                    AnyValue::StringOwned(text) => text.to_string(),
                    AnyValue::Float64(number) if number.is_nan() => String::new(),
                    AnyValue::Float64(number) => number.to_string(),
                    AnyValue::Float32(number) => number.to_string(),
                    other => other.to_string(),
                });
            }
            writer.write_record(cells).map_err(Failure::work)?;
        }
        let text = writer.into_inner().map_err(Failure::work)?;
        Ok(PyBytes::new(py, &text))
    }

    /// Writes the table to a Parquet file.
    fn write_parquet(&self, path: PathBuf) -> Result<(), Failure> {
        let file = File::create(&path).map_err(|error| Failure::file(&path, &error))?;
        ParquetWriter::new(file).finish(&mut self.frame.clone()).map(drop).map_err(lost)
    }

    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        PyCapsule::new_with_value(py, export_field_to_c(&self.field()), c"arrow_schema")
    }

    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // The interface lets a producer that cannot cast keep its own types.
        drop(requested_schema);
        let field = self.field();
        let frame = self.frame.clone();
        let columns: Vec<Box<dyn Array>> = frame
            .columns()
            .iter()
            .map(|column| column.as_materialized_series().rechunk().to_arrow(0, CompatLevel::oldest()))
            .collect();
        let batch = StructArray::new(field.dtype.clone(), frame.height(), columns, None);
        let stream = export_iterator(Box::new(std::iter::once(Ok(batch.boxed()))), field);
        PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
    }
}

/// Everything that a stream yields.
fn read_stream(stream: Box<ArrowArrayStream>) -> PolarsResult<DataFrame> {
    // SAFETY: the stream came in a capsule whose name promises the C stream interface.
    let mut reader = unsafe { ArrowArrayStreamReader::try_new(stream) }?;
    let mut whole: Option<DataFrame> = None;
    // SAFETY: as above.
    while let Some(array) = unsafe { reader.next() } {
        let array = array?;
        let Some(batch) = array.as_any().downcast_ref::<StructArray>() else {
            return Err(PolarsError::ComputeError("the stream is not one of a table".into()));
        };
        let frame = DataFrame::try_from(batch.clone())?;
        match &mut whole {
            Some(whole) => drop(whole.vstack_mut(&frame)?),
            None => whole = Some(frame),
        }
    }
    Ok(whole.unwrap_or_default())
}

/// A cell for Python.
fn cell<'py>(py: Python<'py>, series: &Series, index: usize) -> PolarsResult<Bound<'py, PyAny>> {
    use polars::prelude::AnyValue;
    let none = || py.None().into_bound(py);
    let value = series.get(index)?;
    let number = |number: f64| number.into_pyobject(py).map_or_else(|never| match never {}, Bound::into_any);
    let text = |text: &str| text.into_pyobject(py).map_or_else(|never| match never {}, Bound::into_any);
    Ok(match &value {
        AnyValue::Null => none(),
        AnyValue::String(own) => text(own),
        AnyValue::StringOwned(own) => text(own),
        other => other.extract::<f64>().map_or_else(|| text(&other.to_string()), number),
    })
}

/// A column of a table: a sequence, which numpy takes without copying where it holds numbers.
#[pyclass(frozen, module = "toolroom")]
pub struct Column {
    series: Series,
}

#[pymethods]
impl Column {
    fn __len__(&self) -> usize {
        self.series.len()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, index: isize) -> PyResult<Bound<'py, PyAny>> {
        let len = self.series.len() as isize;
        let index = if index < 0 { index + len } else { index };
        if !(0..len).contains(&index) {
            return Err(pyo3::exceptions::PyIndexError::new_err("no such row"));
        }
        cell(py, &self.series, index as usize).map_err(|error| lost(error).into())
    }

    /// Header of the column.
    #[getter]
    fn name(&self) -> String {
        self.series.name().to_string()
    }

    /// The memory of numbers, for numpy: valid while this column lives, which numpy sees to.
    #[getter]
    fn __array_interface__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let refused = || pyo3::exceptions::PyAttributeError::new_err("a column of numbers without gaps is due");
        if self.series.dtype() != &DataType::Float64 || self.series.null_count() > 0 {
            return Err(refused());
        }
        let numbers = self.series.f64().and_then(|numbers| numbers.cont_slice()).map_err(|_| refused())?;
        let interface = PyDict::new(py);
        interface.set_item("version", 3)?;
        interface.set_item("shape", (numbers.len(),))?;
        interface.set_item("typestr", if cfg!(target_endian = "big") { ">f8" } else { "<f8" })?;
        interface.set_item("data", (numbers.as_ptr() as usize, true))?;
        Ok(interface)
    }
}
