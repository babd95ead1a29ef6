//! Tables to and from Parquet files: the only crate that knows polars.
//!
//! | item | what it does |
//! |---|---|
//! | [`ParquetTable`] | writes typed rows, a row group at a time |
//! | [`create`] | the same behind [`TableWriter`](toolroom_records::table::TableWriter), for crates that do not know Parquet |
//! | [`read_cells`] | reads any table as text cells, for measured records |
//!
//! # What is not modelled
//! Nested and categorical columns are read as the text that polars prints of them.

#![deny(clippy::wildcard_enum_match_arm)]

mod read;
mod write;

pub use read::read_cells;
pub use write::{ParquetTable, create};

/// Why a Parquet file was not written or read.
pub use polars::error::PolarsError;
