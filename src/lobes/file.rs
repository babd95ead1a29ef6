//! A lobes file as the chart needs it.

use super::cut::Cut;
use std::path::Path;
use toolroom_sim::scenario::file::{FormFile, ReadError};
use toolroom_sim::scenario::lobes;
pub use toolroom_sim::scenario::lobes::{Chart, Point};

/// What a lobes file says.
#[derive(Clone, Debug)]
pub struct LobesFile {
    pub name: String,
    pub title: String,
    pub cut: Cut,
    pub chart: Chart,
    pub points: Vec<Point>,
}

pub fn read(path: &Path, overrides: &[String]) -> Result<FormFile<LobesFile>, ReadError> {
    let FormFile { content, echo, text, files } = lobes::read(path, overrides)?;
    let lobes::LobesFile { name, title, cut, chart, points } = content;
    Ok(FormFile { content: LobesFile { name, title, cut: cut.into(), chart, points }, echo, text, files })
}
