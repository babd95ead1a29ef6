//! How much of a workbook is read: a zip file of a megabyte can hold gigabytes, and two cells can lie so far apart that
//! the rectangle between them fits into no memory.

use std::fs::File;
use std::io::{BufReader, Read, copy, sink};
use std::path::Path;
use zip::ZipArchive;

/// Most cells of a workbook, empty ones between others among them. Orders of an enterprise are some hundred thousand rows of
/// twenty columns; more are better kept as CSV (assumption). They take some 150 bytes of memory each.
pub(crate) const MOST_CELLS: u64 = 4_000_000;
/// Most bytes of the unpacked files of a workbook: 64 for each cell, of which XML needs some 40 (assumption).
const MOST_BYTES: u64 = 64 * MOST_CELLS;
/// Most elements, attributes and texts of an ODS workbook: a cell is an element that has a paragraph, which has a text.
pub(crate) const MOST_NODES: u32 = 4 * MOST_CELLS as u32;

/// Refuses an archive that would fill the memory when it is unpacked. What its table of contents says of the sizes is
/// not trusted: every file is unpacked once and counted.
///
/// # Errors
/// A file that cannot be read, is no archive, or is too large.
pub(crate) fn unpacked(path: &Path) -> Result<(), String> {
    let mut archive = archive(path)?;
    let mut left = MOST_BYTES;
    for number in 0..archive.len() {
        let entry = archive.by_index(number).map_err(|error| error.to_string())?;
        let bytes = copy(&mut entry.take(left + 1), &mut sink()).map_err(|error| error.to_string())?;
        left = left.checked_sub(bytes).ok_or_else(too_large)?;
    }
    Ok(())
}

/// The text of a file in an archive.
///
/// # Errors
/// As [`unpacked`], or no such file.
pub(crate) fn contents(path: &Path, name: &str) -> Result<String, String> {
    let mut archive = archive(path)?;
    let entry = archive.by_name(name).map_err(|error| error.to_string())?;
    let mut text = String::new();
    let bytes = entry.take(MOST_BYTES + 1).read_to_string(&mut text).map_err(|error| error.to_string())?;
    if bytes as u64 > MOST_BYTES { Err(too_large()) } else { Ok(text) }
}

fn archive(path: &Path) -> Result<ZipArchive<BufReader<File>>, String> {
    let file = File::open(path).map_err(|error| error.kind().to_string())?;
    ZipArchive::new(BufReader::new(file)).map_err(|error| error.to_string())
}

fn too_large() -> String {
    format!("it is larger than {} MB when it is unpacked; save the sheet as CSV", MOST_BYTES / 1_000_000)
}

/// Refuses more cells than are read.
///
/// # Errors
/// More than that.
pub(crate) fn at_most(cells: u64) -> Result<(), String> {
    if cells <= MOST_CELLS { Ok(()) } else { Err(format!("more than {MOST_CELLS} cells are not read; save it as CSV")) }
}

/// The rectangle of the cells of a sheet that hold something.
#[derive(Debug, Default)]
pub(crate) struct Extent(Option<[u32; 4]>);

impl Extent {
    /// Adds a cell, by its row and column from 0.
    pub fn take(&mut self, row: u32, column: u32) {
        let [top, bottom, left, right] = self.0.unwrap_or([row, row, column, column]);
        self.0 = Some([top.min(row), bottom.max(row), left.min(column), right.max(column)]);
    }

    /// Cells of the rectangle and those of sheets before.
    ///
    /// # Errors
    /// More than are read.
    pub fn checked(&self, before: u64) -> Result<u64, String> {
        let Some([top, bottom, left, right]) = self.0 else { return Ok(before) };
        let rows = u64::from(bottom - top).saturating_add(1);
        // Cells left of the first column are empty ones in every row of what is read.
        let columns = u64::from(right).saturating_add(1);
        let cells = rows.saturating_mul(columns).saturating_add(before);
        if cells <= MOST_CELLS {
            return Ok(cells);
        }
        let (first, last) = (crate::source::cell_name(top, left), crate::source::cell_name(bottom, right));
        Err(format!(
            "its cells reach from {first} to {last}, and more than {MOST_CELLS} cells are not read; clear what lies outside the table, or save it as CSV"
        ))
    }
}
