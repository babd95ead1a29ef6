//! Packages made for the tests.

use std::io::Write;
use std::path::PathBuf;
use tempfile::TempDir;

/// A package with this structure and other entries.
pub fn with_units(structure: &str, entries: &[(&str, Vec<u8>)]) -> (TempDir, PathBuf) {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("cell.ssp");
    let mut zip = zip::ZipWriter::new(std::fs::File::create(&path).expect("writable"));
    // The namespaces of the standard, which prefixes need.
    let spaces = "xmlns:ssd=\"http://ssp-standard.org/SSP1/SystemStructureDescription\" \
                  xmlns:ssc=\"http://ssp-standard.org/SSP1/SystemStructureCommon\" \
                  xmlns:ssv=\"http://ssp-standard.org/SSP1/SystemStructureParameterValues\" ";
    let spaced = |text: &str| {
        let text =
            text.replace("<ssd:SystemStructureDescription ", &format!("<ssd:SystemStructureDescription {spaces}"));
        if text.starts_with("<ssv:") { text.replacen(' ', &format!(" {spaces}"), 1) } else { text }
    };
    let structure = spaced(structure);
    zip.start_file("SystemStructure.ssd", zip::write::SimpleFileOptions::default()).expect("an entry");
    zip.write_all(structure.as_bytes()).expect("an entry");
    for (name, bytes) in entries {
        zip.start_file(*name, zip::write::SimpleFileOptions::default()).expect("an entry");
        match std::str::from_utf8(bytes) {
            Ok(text) => zip.write_all(spaced(text).as_bytes()),
            Err(_) => zip.write_all(bytes),
        }
        .expect("an entry");
    }
    zip.finish().expect("a zip file");
    (folder, path)
}
