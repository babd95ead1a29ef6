//! The shop of an order system: its tables (CSV, XLSX, ODS), by a mapping, as one scenario file.
//!
//! ```text
//!  map.toml ─► tables, columns, conditions ─► cells ─► values as scenarios write them ─┐
//!  base.toml (what no table has: [shop], calendars, rules, variants) ──────────────────┴─► shop.toml
//!                                        every value remembers its cell ◄─ faults of the scenario reader
//! ```
//! The scenario that is made is read by the reader of scenarios before anything is written. Each of its faults is told at the
//! cell that the faulty value comes from, so that an order of an unknown part or a skill that nobody has is found by the
//! same rules as in a file written by hand, and all faults are told together.
//!
//! | module | what it is |
//! |---|---|
//! | `mapping` | what a mapping file says |
//! | `source` | tables of cells, and which of their rows count |
//! | `workbook` | sheets of XLSX and ODS, with the feature `xlsx` |
//! | `value` | a cell as the value of a key |
//! | `draft` | the text of the scenario, with the cell of every value |
//! | `shop` | rows to sections |
//! | `fault` | what is wrong, and in which cell |
//!
//! # What is not modelled
//! Formulas (a workbook holds their last results), the old XLS format, sequences of a finished schedule, cutting data.

#![cfg_attr(not(test), deny(clippy::wildcard_enum_match_arm))]

#[cfg(feature = "xlsx")]
mod bounds;
mod draft;
mod fault;
mod mapping;
#[cfg(feature = "xlsx")]
mod ods;
mod shop;
mod source;
#[cfg(test)]
mod tests;
mod value;
#[cfg(feature = "xlsx")]
mod workbook;

/// Codes of errors of this crate for `toolroom explain`, each with a longer text.
pub const CODES: &[(&str, &str)] = &[(
    "where",
    "`where` of a table says which of its rows count: comparisons of a column with a 'text' in quotes or with a number, joined by `and`, such as \"Status != 'closed' and Menge > 0\". Signs: = (or ==), !=, <, <=, >, >=. Texts are only equal or not; an empty cell is neither greater nor less than a number, and a text there is a fault. There is no `or` and no bracket: map the table twice, or prepare it in the order system.",
)];

pub use fault::{ShopImportError, TableFault};
pub use mapping::{SHOP_MAPPING, ShopMapping};

use draft::Draft;
use fault::UnplacedFault;
use std::path::{Path, PathBuf};
use toolroom_form::{Outline, ReadError};
use toolroom_scenario_file::ScenarioFile;

/// A scenario made of tables.
#[derive(Debug)]
pub struct Imported {
    /// The text of the scenario.
    pub text: String,
    /// What it says.
    pub file: ScenarioFile,
    /// A line for every table: rows used, and what was done to read them.
    pub notes: Vec<String>,
    /// The files that were read: base and tables.
    pub inputs: Vec<PathBuf>,
}

/// Reads the tables that a mapping names. `out` is where the scenario is meant to be: files that its base names are found from
/// there.
///
/// # Errors
/// [`ShopImportError`]: faults of the mapping, a table that cannot be read, or every faulty cell.
pub fn import_shop(map: &Path, out: &Path) -> Result<Imported, ShopImportError> {
    let mapping = ShopMapping::read(map, &[])?;
    let folder = map.parent().unwrap_or(Path::new(""));
    let base = folder.join(&mapping.base);
    let base_text = toolroom_form::text(&base)?;
    if Outline::of(&base_text).is_broken() {
        // What stands behind a text that is not TOML has no meaning.
        toolroom_scenario_file::parse(&base.display().to_string(), &base_text, &[])?;
    }
    let mut inputs = vec![base.clone()];
    let mut tables = Vec::with_capacity(mapping.tables.len());
    let mut faults = Vec::new();
    let mut notes = Vec::new();
    for table in &mapping.tables {
        let path = folder.join(&table.file);
        let read = source::read(&path, table, &mut faults)?;
        notes.push(read.note(table));
        if !inputs.contains(&path) {
            inputs.push(path);
        }
        tables.push(read);
    }
    let place = fault::Places { mapping: &mapping, tables: &tables, base: &base };
    if !faults.is_empty() {
        // Without its columns nothing can be said of the rows of a table.
        return Err(ShopImportError::tables(faults, &place));
    }
    let mut draft = Draft::new(&base_text, &map.display().to_string());
    shop::write(&mut draft, &mapping.tables, &tables, &mut faults);
    match toolroom_scenario_file::parse(&out.display().to_string(), &draft.text, &[]) {
        Ok(file) if faults.is_empty() => Ok(Imported { text: draft.text, file, notes, inputs }),
        Ok(_) => Err(ShopImportError::tables(faults, &place)),
        Err(ReadError::Faults(list)) => {
            let told: Vec<_> = faults.iter().filter_map(UnplacedFault::row).collect();
            // A value that could not be written is missing, which is no fault of its own.
            let follows =
                |found: &UnplacedFault| found.is_whole_row() && found.row().is_some_and(|row| told.contains(&row));
            let found = list.problems.iter().map(|problem| place.translated(problem, &draft));
            let found: Vec<UnplacedFault> = found.filter(|found| !follows(found)).collect();
            faults.extend(found);
            Err(ShopImportError::tables(faults, &place))
        }
        Err(error) => Err(error.into()),
    }
}
