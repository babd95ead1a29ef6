//! The base of a shop whose machines, parts and orders stand in tables of an order system.

use crate::checked::{CheckResult, checked};
use std::fs;
use std::path::{Path, PathBuf};
use toolroom_form::{Fault, ReadError};
use toolroom_shop_import::ShopMapping;

/// What is checked of a scenario that was refused only because it names no machine, part or arrivals, where a mapping of
/// tables in its folder takes it as its base: the tables give what is missing. Anything else stays refused.
pub fn of_tables(path: &Path, error: ReadError) -> Result<CheckResult, ReadError> {
    let ReadError::Faults(list) = &error else { return Err(error) };
    if !list.problems.iter().all(|problem| gives(&problem.fault)) {
        return Err(error);
    }
    let Some(map) = mapping(path) else { return Err(error) };
    let summary = format!(
        "the base of a shop, whose machines, parts and orders are those of {map}; `toolroom import shop --map {map} --check` \
         looks at the whole"
    );
    Ok(checked("scenario", None, Vec::new(), &summary))
}

/// Whether tables of an order system can mend a fault.
fn gives(fault: &Fault) -> bool {
    matches!(fault, Fault::Nothing { what: "machine" | "part" | "source of arrivals", .. })
}

/// The mapping in the folder of a file that has the file as its base.
fn mapping(path: &Path) -> Option<String> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let base = fs::canonicalize(path).ok()?;
    let mut names: Vec<PathBuf> = fs::read_dir(folder).ok()?.filter_map(Result::ok).map(|entry| entry.path()).collect();
    names.sort();
    let takes_it = |map: &&PathBuf| {
        map.extension().is_some_and(|ending| ending == "toml")
            && ShopMapping::read(map, &[])
                .is_ok_and(|mapping| fs::canonicalize(folder.join(mapping.base())).is_ok_and(|named| named == base))
    };
    names.iter().find(takes_it).map(|map| map.display().to_string())
}
