//! Lists the files of `scenarios` that the program holds: everything but parameter sets, which have names of their own, schemas,
//! and the examples that `new` writes.
#![allow(clippy::print_stdout)] // this is how cargo is told

use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// Folders of `scenarios` whose files are not shipped under their path.
const APART: [&str; 3] = ["parameters", "schema", "new"];
/// Endings of the files that commands take.
const ENDINGS: [&str; 3] = ["toml", "csv", "nc"];

fn main() -> io::Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenarios").canonicalize()?;
    // Nearly every crate stands on this one: only what is listed may have it compiled again, not a schema or a parameter set.
    // Cargo watches a folder with all that is below it, so the root itself cannot be watched: a test looks for new files there.
    println!("cargo::rerun-if-changed=build.rs");
    for entry in fs::read_dir(&root)? {
        let path = entry?.path();
        let apart = path.is_dir() && path.file_name().is_some_and(|name| APART.iter().any(|known| name == *known));
        if !apart {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    let mut found = Vec::new();
    collect(&root, "", &mut found)?;
    found.sort();
    let rows: Vec<String> = found.iter().map(|(name, path)| format!("({name:?}, include_str!({path:?})),\n")).collect();
    let out = env::var_os("OUT_DIR").ok_or_else(|| io::Error::other("cargo sets OUT_DIR"))?;
    fs::write(PathBuf::from(out).join("shipped.rs"), format!("&[\n{}]\n", rows.concat()))
}

/// Names below `scenarios` and paths of the files of a folder.
fn collect(folder: &Path, below: &str, found: &mut Vec<(String, PathBuf)>) -> io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let Some(file_name) = path.file_name().and_then(|name| name.to_str()) else { continue };
        let name = if below.is_empty() { file_name.to_owned() } else { format!("{below}/{file_name}") };
        if path.is_dir() {
            if !APART.contains(&name.as_str()) {
                collect(&path, &name, found)?;
            }
        } else if path.extension().is_some_and(|ending| ENDINGS.iter().any(|known| ending == *known)) {
            found.push((name, path));
        }
    }
    Ok(())
}
