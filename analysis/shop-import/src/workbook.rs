//! Sheets of XLSX and ODS workbooks.

use crate::bounds::{Extent, at_most, unpacked};
use crate::fault::ShopImportError;
use crate::mapping::TableMap;
use crate::ods;
use crate::source::{Cell, Grid, Row, cell_name};
use calamine::{Data, DataRef, Dimensions, ExcelDateTime, Range, Reader, Sheets, Xlsx, XlsxError, open_workbook_auto};
use std::io::{Read, Seek};
use std::path::Path;
use toolroom_scenario::date;

/// Second 0 of the days of a workbook whose first day is 1900-01-01: 1899-12-30, since they count a 29 February 1900.
///
/// # Source
/// ECMA-376 part 1, 18.17.4.1.
const FIRST_DAY: &str = "1899-12-30";

/// Reads a sheet: its cells as they are shown, dates in ISO 8601. Merged cells are refused, since nobody can say to which of the
/// rows they belong.
pub(crate) fn grid(path: &Path, map: &TableMap) -> Result<Grid, ShopImportError> {
    let refused = |reason: String| ShopImportError::Table { file: map.file.clone(), reason };
    unpacked(path).map_err(refused)?;
    // Its reader unfolds every sheet when it opens the file.
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ods")) {
        ods::bounded(path).map_err(refused)?;
    }
    let mut book = open_workbook_auto(path).map_err(|error| refused(error.to_string()))?;
    let names = book.sheet_names();
    let sheet = match (&map.sheet, &names[..]) {
        (Some(sheet), _) if names.contains(sheet) => sheet.clone(),
        (Some(sheet), _) => {
            let near = toolroom_form::nearest(sheet, names.iter().map(String::as_str));
            let near = near.map_or_else(String::new, |near| format!("; is it `{near}`?"));
            return Err(refused(format!("it has no sheet \"{sheet}\"{near} It has: {}", names.join(", "))));
        }
        (None, [only]) => only.clone(),
        (None, _) => return Err(refused(format!("it has several sheets, `sheet` says which: {}", names.join(", ")))),
    };
    let merged = match &mut book {
        Sheets::Xlsx(book) => {
            extent(book, &sheet).map_err(refused)?;
            let regions = book.merge_cells_by_sheet_name(&sheet).map_err(|error| refused(error.to_string()))?;
            regions.first().map(|Dimensions { start, .. }| cell_name(start.0, start.1))
        }
        Sheets::Ods(_) => ods::merged(path, &sheet).map_err(refused)?,
        Sheets::Xls(_) | Sheets::Xlsb(_) => None,
    };
    if let Some(cell) = merged {
        return Err(refused(format!(
            "sheet {sheet} has merged cells, the first at {cell}; unmerge them and fill every row"
        )));
    }
    let range = book.worksheet_range(&sheet).map_err(|error| refused(error.to_string()))?;
    let rows =
        rows(&range).map_err(|cell| refused(format!("sheet {sheet}, cell {cell} holds an error of a formula")))?;
    Ok(Grid { sheet: Some(sheet), rows, notes: Vec::new() })
}

/// Refuses a sheet of an XLSX workbook whose cells lie too far apart for the rectangle between them, and one with a formula of
/// which nobody has worked out the value.
fn extent<R: Read + Seek>(book: &mut Xlsx<R>, sheet: &str) -> Result<(), String> {
    let mut cells = match book.worksheet_cells_reader(sheet) {
        Ok(cells) => cells,
        // A sheet that is a chart has no cells.
        Err(XlsxError::NotAWorksheet(_)) => return Ok(()),
        Err(error) => return Err(error.to_string()),
    };
    let (mut extent, mut count) = (Extent::default(), 0);
    while let Some(cell) = cells.next_cell_with_formula_metadata().map_err(|error| error.to_string())? {
        let (row, column) = cell.pos;
        count += 1;
        if cell.value != DataRef::Empty {
            extent.take(row, column);
        } else if cell.formula.is_some() {
            return Err(format!(
                "sheet {sheet}, cell {} holds a formula without its value, as programs write it: open the workbook in a spreadsheet \
                 program and save it, or write values",
                cell_name(row, column)
            ));
        }
    }
    // A cell that stands there twice takes its memory twice.
    extent.checked(0).map(drop).and_then(|()| at_most(count))
}

/// The rows of a sheet, each cell at the column that it has in the sheet; or the cell that is an error.
fn rows(range: &Range<Data>) -> Result<Vec<Row>, String> {
    let (first_row, first_column) = range.start().unwrap_or((0, 0));
    let mut rows = Vec::new();
    for (number, cells) in range.rows().enumerate() {
        let row = first_row + u32::try_from(number).unwrap_or(u32::MAX);
        let mut shown = vec![Cell::default(); first_column as usize];
        for (at, cell) in cells.iter().enumerate() {
            let column = first_column + u32::try_from(at).unwrap_or(u32::MAX);
            shown.push(cell_of(cell).ok_or_else(|| cell_name(row, column))?);
        }
        rows.push(Row { line: row as usize + 1, cells: shown });
    }
    Ok(rows)
}

/// What a cell shows; `None` where it is an error of a formula.
fn cell_of(data: &Data) -> Option<Cell> {
    let text = |text: String| Some(Cell { text, is_date: false });
    match data {
        Data::Empty => Some(Cell::default()),
        Data::String(value) => text(value.trim().to_owned()),
        Data::Int(number) => text(number.to_string()),
        // Whole numbers, such as ids, are numbers of a workbook, too.
        Data::Float(number) => text(format!("{number}")),
        Data::Bool(flag) => text(flag.to_string()),
        Data::DateTime(moment) => Some(moment_of(moment)),
        Data::DateTimeIso(iso) => Some(Cell { text: iso_moment(iso), is_date: true }),
        Data::DurationIso(iso) => Some(duration_of(iso).unwrap_or(Cell { text: iso.clone(), is_date: false })),
        Data::Error(_) => None,
    }
}

/// A date, a time of the day or a duration.
fn moment_of(moment: &ExcelDateTime) -> Cell {
    let days = moment.as_f64();
    let seconds = days * 86_400.0;
    if moment.is_duration() {
        return Cell { text: format!("{seconds} s"), is_date: false };
    }
    if (0.0..1.0).contains(&days) {
        let minutes = (seconds / 60.0).round() as u32;
        return Cell { text: format!("{:02}:{:02}", minutes / 60, minutes % 60), is_date: true };
    }
    let first = date::parse(FIRST_DAY).unwrap_or(0.0);
    Cell { text: date::show(first + seconds), is_date: true }
}

/// `2026-03-30T06:00:00` as `2026-03-30 06:00`.
fn iso_moment(iso: &str) -> String {
    date::parse(iso.split('.').next().unwrap_or(iso)).map_or_else(|| iso.to_owned(), date::show)
}

/// `PT06H30M00S` as a time of the day, longer ones as seconds.
fn duration_of(iso: &str) -> Option<Cell> {
    let mut rest = iso.strip_prefix("PT")?;
    let mut seconds = 0.0;
    for (sign, scale) in [('H', 3600.0), ('M', 60.0), ('S', 1.0)] {
        if let Some((number, behind)) = rest.split_once(sign) {
            seconds += number.parse::<f64>().ok()? * scale;
            rest = behind;
        }
    }
    let minutes = (seconds / 60.0).round() as u32;
    Some(if seconds < 86_400.0 {
        Cell { text: format!("{:02}:{:02}", minutes / 60, minutes % 60), is_date: true }
    } else {
        Cell { text: format!("{seconds} s"), is_date: false }
    })
}
