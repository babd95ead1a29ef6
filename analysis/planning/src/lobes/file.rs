//! A lobes file as the chart needs it.

use super::cut::Cut;
use std::path::{Path, PathBuf};
use toolroom_chatter::Scatter;
use toolroom_form::{FormFile, ReadError};
use toolroom_lobes as lobes;
pub use toolroom_lobes::{Chart, Limits, Point};

/// What a lobes file says.
#[derive(Clone, Debug)]
pub struct LobesFile {
    /// Short name, also of the output folder.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// What is cut.
    pub cut: Cut,
    /// Range and resolution of the chart.
    pub chart: Chart,
    /// Operating points that are judged beside the chart.
    pub points: Vec<Point>,
    /// How well the constants are known, where the file or its structure file says so.
    pub scatter: Option<Scatter>,
    /// What machine, tool and drawing allow.
    pub limits: Limits,
    /// Feed per tooth in milling, per revolution in turning (m), where it is given.
    pub feed: Option<f64>,
    /// Measured responses whose own limit stands beside that of the modes, where the structure file names them.
    pub table: Option<PathBuf>,
}

/// Reads a lobes file; `overrides` are `path=value`.
///
/// # Errors
/// [`ReadError`]: the file cannot be opened or decoded, or every fault found in it.
pub fn read(path: &Path, overrides: &[String]) -> Result<FormFile<LobesFile>, ReadError> {
    lobes::read(path, overrides).map(judged)
}

/// A file from its text; `file` is its name in messages.
///
/// # Errors
/// As [`read`].
pub fn parse(file: &str, text: &str, overrides: &[String]) -> Result<FormFile<LobesFile>, ReadError> {
    lobes::parse(file, text, overrides).map(judged)
}

fn judged(file: FormFile<lobes::LobesFile>) -> FormFile<LobesFile> {
    let FormFile { content, echo, text, files } = file;
    let lobes::LobesFile { name, title, cut, variation, chart, points, scatter, limits, feed, table } = content;
    let content = LobesFile { name, title, cut: Cut::new(cut, variation), chart, points, scatter, limits, feed, table };
    FormFile { content, echo, text, files }
}
