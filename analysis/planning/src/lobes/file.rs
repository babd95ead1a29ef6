//! A lobes file as the chart needs it.

use super::cut::Cut;
use std::path::Path;
use toolroom_chatter::Scatter;
use toolroom_form::{FormFile, ReadError};
use toolroom_lobes as lobes;
pub use toolroom_lobes::{Chart, Point};

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
    /// How well the modes of a structure file are known, where it says so.
    pub scatter: Option<Scatter>,
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
    let lobes::LobesFile { name, title, cut, variation, chart, points, scatter } = content;
    let content = LobesFile { name, title, cut: Cut::new(cut, variation), chart, points, scatter };
    FormFile { content, echo, text, files }
}
