//! The tables of a run as Parquet or CSV files.
//!
//! Each table's columns are listed once, in [`columns`], and serve both formats; a column is named
//! with its display unit: `cutting_speed_start [m/min]`. What is not defined is null in Parquet
//! and empty in CSV. The order of rows is that of replications, policies and the log, so that the
//! same study gives the same bytes whatever the number of threads.

pub mod columns;

use columns::{Column, Row};
use std::fs::File;
use std::path::{Path, PathBuf};
use toolroom_parquet::{ParquetTable, PolarsError};
use toolroom_process::table::{Cell, CsvWriter};
use toolroom_records::table::Value;
use toolroom_scenario::{ProcessModel, Scenario};
use toolroom_shop::runlog::{EdgeRow, EventRow, JobRow, PassRow, RunLog, StateRow};

/// Format of the tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Parquet, Zstandard-compressed.
    Parquet,
    /// Comma-separated values.
    Csv,
}

impl Format {
    /// Extension of the files.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Parquet => "parquet",
            Self::Csv => "csv",
        }
    }
}

/// A table could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LogError {
    /// The file cannot be made.
    #[error("cannot create {path}: {source}")]
    Create {
        /// The file.
        path: PathBuf,
        /// What the file system said.
        source: std::io::Error,
    },
    /// The Parquet writer failed.
    #[error("cannot write {path}: {source}")]
    Parquet {
        /// The file.
        path: PathBuf,
        /// What polars said.
        source: PolarsError,
    },
    /// The CSV writer failed.
    #[error("cannot write {path}: {source}")]
    Csv {
        /// The file.
        path: PathBuf,
        /// What the csv crate said.
        source: csv::Error,
    },
    /// The table of an earlier run, whose rows were to be taken over.
    #[error("cannot read {path}: {source}")]
    Earlier {
        /// The file.
        path: PathBuf,
        /// What polars or the file system said.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

impl LogError {
    /// The file.
    pub fn path(&self) -> &Path {
        match self {
            Self::Create { path, .. }
            | Self::Parquet { path, .. }
            | Self::Csv { path, .. }
            | Self::Earlier { path, .. } => path,
        }
    }
}

/// Writes the five tables of runs, one run after the other.
///
/// # Examples
/// ```no_run
/// # fn example(scenario: &toolroom_scenario::Scenario) -> Result<(), Box<dyn std::error::Error>> {
/// use toolroom_study::logs::{Format, LogWriter};
/// let mut writer = LogWriter::create(std::path::Path::new("out/demo"), scenario, Format::Parquet)?;
/// writer.write(0, 0, &toolroom_shop::run(scenario, 0, 0)?)?;
/// writer.finish()?;
/// # Ok(())
/// # }
/// ```
pub struct LogWriter {
    names: Names,
    operations: Table<PassRow>,
    tools: Table<EdgeRow>,
    jobs: Table<JobRow>,
    states: Table<StateRow>,
    events: Table<EventRow>,
}

/// Names of the tables.
const TABLES: [&str; 5] = ["operations", "tools", "jobs", "states", "events"];

/// Names behind the indices of a log.
#[derive(Clone, Debug)]
pub struct Names {
    machines: Vec<String>,
    tools: Vec<String>,
    parts: Vec<(String, Vec<String>)>,
    /// Whether a wheel does it, by part and operation.
    ground: Vec<Vec<bool>>,
    policies: Vec<String>,
    orders: Vec<String>,
}

impl Names {
    /// Names of a scenario.
    pub fn of(scenario: &Scenario) -> Self {
        let operations = |part: &toolroom_scenario::Part| part.operations.iter().map(|o| o.name.clone()).collect();
        let is_ground = |operation: &toolroom_scenario::Operation| {
            let tool = operation.tool.map(|tool| &scenario.tools[tool].process);
            matches!(tool, Some(ProcessModel::Infeed(_)))
        };
        let ground = |part: &toolroom_scenario::Part| part.operations.iter().map(is_ground).collect();
        Self {
            ground: scenario.parts.iter().map(ground).collect(),
            machines: scenario.machines.iter().map(|machine| machine.name.clone()).collect(),
            tools: scenario.tools.iter().map(|tool| tool.name.clone()).collect(),
            parts: scenario.parts.iter().map(|part| (part.name.clone(), operations(part))).collect(),
            policies: scenario.policies.iter().map(|policy| policy.name.clone()).collect(),
            orders: scenario.orders.iter().map(|order| order.id.clone()).collect(),
        }
    }

    /// Name of a machine.
    pub fn machine(&self, index: u32) -> &str {
        self.machines.get(index as usize).map_or("", String::as_str)
    }

    /// Whether a wheel does an operation of a part.
    pub(crate) fn is_ground(&self, part: u32, operation: u32) -> bool {
        let operations = self.ground.get(part as usize);
        operations.and_then(|own| own.get(operation as usize)).copied().unwrap_or(false)
    }

    /// Name of a tool.
    pub fn tool(&self, index: u32) -> &str {
        self.tools.get(index as usize).map_or("", String::as_str)
    }

    /// Name of an order; empty where a job belongs to none.
    pub fn order(&self, index: Option<u32>) -> &str {
        index.and_then(|index| self.orders.get(index as usize)).map_or("", String::as_str)
    }

    /// Name of a part.
    pub fn part(&self, index: u32) -> &str {
        self.parts.get(index as usize).map_or("", |part| &part.0)
    }

    /// Name of an operation of a part.
    pub fn operation(&self, part: u32, index: u32) -> &str {
        self.parts.get(part as usize).and_then(|part| part.1.get(index as usize)).map_or("", String::as_str)
    }

    /// Name of a policy.
    pub fn policy(&self, index: usize) -> &str {
        self.policies.get(index).map_or("", String::as_str)
    }
}

impl LogWriter {
    /// Starts `operations`, `tools`, `jobs`, `states` and `events` in `directory`.
    ///
    /// # Errors
    /// [`LogError::Create`], or what the writers say about their headers.
    pub fn create(directory: &Path, scenario: &Scenario, format: Format) -> Result<Self, LogError> {
        let [operations, tools, jobs, states, events] = TABLES;
        Ok(Self {
            names: Names::of(scenario),
            operations: Table::create(directory, operations, format, columns::operations())?,
            tools: Table::create(directory, tools, format, columns::tools())?,
            jobs: Table::create(directory, jobs, format, columns::jobs())?,
            states: Table::create(directory, states, format, columns::states())?,
            events: Table::create(directory, events, format, columns::events())?,
        })
    }

    /// Takes over the rows of the same tables in another directory, before any of its own.
    ///
    /// # Errors
    /// [`LogError::Earlier`], or what the writers say.
    pub fn take_over(&mut self, earlier: &Path) -> Result<(), LogError> {
        self.operations.take_over(earlier)?;
        self.tools.take_over(earlier)?;
        self.jobs.take_over(earlier)?;
        self.states.take_over(earlier)?;
        self.events.take_over(earlier)
    }

    /// Names of the files of a format.
    pub fn names(format: Format) -> Vec<String> {
        TABLES.iter().map(|name| format!("{name}.{}", format.extension())).collect()
    }

    /// Adds the log of one run.
    ///
    /// # Errors
    /// What the writers say.
    pub fn write(&mut self, policy: usize, replication: u32, log: &RunLog) -> Result<(), LogError> {
        let Self { names, operations, tools, jobs, states, events } = self;
        operations.write(names, policy, replication, &log.passes)?;
        tools.write(names, policy, replication, &log.edges)?;
        jobs.write(names, policy, replication, &log.jobs)?;
        states.write(names, policy, replication, &log.states)?;
        events.write(names, policy, replication, &log.events)
    }

    /// Writes what is buffered and closes the files; without it a Parquet file cannot be read.
    ///
    /// # Errors
    /// What the writers say.
    pub fn finish(self) -> Result<(), LogError> {
        self.operations.finish()?;
        self.tools.finish()?;
        self.jobs.finish()?;
        self.states.finish()?;
        self.events.finish()
    }
}

/// One file.
struct Table<R> {
    path: PathBuf,
    columns: Vec<Column<R>>,
    sink: Sink,
}

enum Sink {
    Parquet(Box<ParquetTable>),
    Csv(Box<CsvWriter<File>>),
}

impl<R> Table<R> {
    fn create(directory: &Path, name: &str, format: Format, columns: Vec<Column<R>>) -> Result<Self, LogError> {
        let path = directory.join(name).with_extension(format.extension());
        let file = File::create(&path).map_err(|source| LogError::Create { path: path.clone(), source })?;
        let sink = match format {
            Format::Parquet => {
                let table = ParquetTable::new(file, columns.iter().map(|column| (column.header(), column.kind())));
                Sink::Parquet(Box::new(table.map_err(|source| LogError::Parquet { path: path.clone(), source })?))
            }
            Format::Csv => {
                let writer = CsvWriter::new(file, columns.iter().map(Column::header));
                Sink::Csv(Box::new(writer.map_err(|source| LogError::Csv { path: path.clone(), source })?))
            }
        };
        Ok(Self { path, columns, sink })
    }

    fn take_over(&mut self, earlier: &Path) -> Result<(), LogError> {
        let Some(name) = self.path.file_name() else { return Ok(()) };
        let path = earlier.join(name);
        let taken: Result<(), Box<dyn std::error::Error + Send + Sync>> = match &mut self.sink {
            Sink::Parquet(table) => table.take_over(&path).map_err(Into::into),
            Sink::Csv(writer) => csv::Reader::from_path(&path).map_err(Into::into).and_then(|mut reader| {
                let mut record = csv::ByteRecord::new();
                while reader.read_byte_record(&mut record)? {
                    writer.copy(&record)?;
                }
                Ok(())
            }),
        };
        taken.map_err(|source| LogError::Earlier { path, source })
    }

    fn write(&mut self, names: &Names, policy: usize, replication: u32, rows: &[R]) -> Result<(), LogError> {
        let row = |(index, row)| Row { names, policy, replication, index, row };
        match &mut self.sink {
            Sink::Parquet(table) => {
                let written = (0_u32..)
                    .zip(rows)
                    .map(row)
                    .try_for_each(|row| table.row(self.columns.iter().map(|column| column.value(&row))));
                written.map_err(|source| LogError::Parquet { path: self.path.clone(), source })
            }
            Sink::Csv(writer) => {
                let written = (0_u32..)
                    .zip(rows)
                    .map(row)
                    .try_for_each(|row| writer.row(self.columns.iter().map(|column| cell(column.value(&row)))));
                written.map_err(|source| LogError::Csv { path: self.path.clone(), source })
            }
        }
    }

    fn finish(self) -> Result<(), LogError> {
        let path = self.path;
        match self.sink {
            Sink::Parquet(table) => table.finish().map_err(|source| LogError::Parquet { path, source }),
            Sink::Csv(mut writer) => writer.flush().map_err(|source| LogError::Csv { path, source }),
        }
    }
}

fn cell(value: Value<'_>) -> Cell<'_> {
    match value {
        Value::Real(value) => value.into(),
        Value::Count(value) => value.into(),
        Value::Text(value) => value.into(),
    }
}

#[cfg(test)]
mod tests;
