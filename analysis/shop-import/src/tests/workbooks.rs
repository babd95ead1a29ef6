//! Workbooks: dates, merged cells, sheets, and what would not fit into memory.

use super::{BASE, MAP, TABLES};
use crate::import_shop;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use tempfile::TempDir;

/// A workbook of a sheet `Auftraege` whose orders begin in row 4, dates as numbers with a style; `more_rows` follow.
fn xlsx(path: &Path, merged: &str, more_rows: &str) {
    let text = |cell: &str, text: &str| format!("<c r=\"{cell}\" t=\"inlineStr\"><is><t>{text}</t></is></c>");
    let number = |cell: &str, number: &str, style: u8| format!("<c r=\"{cell}\" s=\"{style}\"><v>{number}</v></c>");
    let heads = ["Auftrag", "Teil", "Menge", "Liefertermin", "Prio", "Status"];
    let head: String = heads.iter().zip('B'..).map(|(head, at)| text(&format!("{at}3"), head)).collect();
    // 46113 is 2026-04-01, counted from 1899-12-30.
    let first = [number("B4", "4711", 0), text("C4", "Welle"), number("D4", "40", 0), number("E4", "46113", 1)];
    let second = [text("B5", "4712"), text("C5", "Rng"), number("D5", "60", 0), number("E5", "46112.25", 1)];
    let rows = format!(
        "<row r=\"1\">{}</row><row r=\"3\">{head}</row><row r=\"4\">{}{}</row><row r=\"5\">{}{}</row>",
        text("A1", "Stand heute"),
        first.concat(),
        text("G4", "offen"),
        second.concat(),
        text("G5", "offen"),
    );
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let relations = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    let package = "http://schemas.openxmlformats.org/package/2006";
    let files = [
        (
            "[Content_Types].xml",
            format!(
                "<Types xmlns=\"{package}/content-types\"><Default Extension=\"xml\" ContentType=\"application/xml\"/></Types>"
            ),
        ),
        (
            "_rels/.rels",
            format!(
                "<Relationships xmlns=\"{package}/relationships\"><Relationship Id=\"r1\" Type=\"{relations}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
            ),
        ),
        (
            "xl/workbook.xml",
            format!(
                "<workbook xmlns=\"{main}\" xmlns:r=\"{relations}\"><sheets><sheet name=\"Auftraege\" sheetId=\"1\" r:id=\"r1\"/></sheets></workbook>"
            ),
        ),
        (
            "xl/_rels/workbook.xml.rels",
            format!(
                "<Relationships xmlns=\"{package}/relationships\"><Relationship Id=\"r1\" Type=\"{relations}/worksheet\" Target=\"worksheets/sheet1.xml\"/><Relationship Id=\"r2\" Type=\"{relations}/styles\" Target=\"styles.xml\"/></Relationships>"
            ),
        ),
        (
            "xl/styles.xml",
            format!(
                "<styleSheet xmlns=\"{main}\"><cellXfs count=\"2\"><xf numFmtId=\"0\"/><xf numFmtId=\"22\"/></cellXfs></styleSheet>"
            ),
        ),
        (
            "xl/worksheets/sheet1.xml",
            format!("<worksheet xmlns=\"{main}\"><sheetData>{rows}{more_rows}</sheetData>{merged}</worksheet>"),
        ),
    ];
    let mut archive = zip::ZipWriter::new(fs::File::create(path).unwrap());
    for (name, content) in files {
        archive.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        archive.write_all(content.as_bytes()).unwrap();
    }
    archive.finish().unwrap();
}

fn folder(merged: &str) -> TempDir {
    folder_with(merged, "")
}

fn folder_with(merged: &str, more_rows: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    for (name, text) in TABLES.into_iter().chain([("base.toml", BASE)]) {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let map = MAP.replace("file = \"erp.csv\"", "file = \"erp.xlsx\"\nsheet = \"Auftraege\"\nheader = 3");
    fs::write(folder.path().join("map.toml"), map).unwrap();
    xlsx(&folder.path().join("erp.xlsx"), merged, more_rows);
    folder
}

#[test]
fn a_sheet_is_read_with_its_dates_and_its_cells_are_named() {
    let folder = folder("");
    let import = || import_shop(&folder.path().join("map.toml"), &folder.path().join("shop.toml"));
    let told = import().expect_err("Rng is no part").to_string();
    assert!(told.contains("erp.xlsx, sheet Auftraege, row 5, cell C5 (Teil): there is no part \"Rng\""), "{told}");
    let map = fs::read_to_string(folder.path().join("map.toml")).unwrap();
    let mended = map.replace(
        "from = \"Teil\" }, { name = \"quantity\"",
        "from = \"Teil\", values = { Rng = \"Ring\" } }, { name = \"quantity\"",
    );
    assert_ne!(map, mended);
    fs::write(folder.path().join("map.toml"), mended).unwrap();
    let imported = import().unwrap_or_else(|error| panic!("{error}"));
    let orders = &imported.file.scenario.orders;
    assert_eq!((orders[0].id.as_str(), orders[0].due / 3600.0), ("4711", 62.0), "a date has the time `at`");
    assert_eq!((orders[1].id.as_str(), orders[1].due / 3600.0), ("4712", 30.0), "a time of its own stays");
}

#[test]
fn merged_cells_and_unknown_sheets_are_refused() {
    let merged = folder("<mergeCells count=\"1\"><mergeCell ref=\"C4:C5\"/></mergeCells>");
    let import = |folder: &TempDir| import_shop(&folder.path().join("map.toml"), &folder.path().join("shop.toml"));
    let told = import(&merged).expect_err("merged").to_string();
    assert!(told.contains("merged cells, the first at C4"), "{told}");
    let folder = folder("");
    let map = fs::read_to_string(folder.path().join("map.toml")).unwrap();
    fs::write(folder.path().join("map.toml"), map.replace("\"Auftraege\"", "\"Auftrage\"")).unwrap();
    let told = import(&folder).expect_err("no such sheet").to_string();
    assert!(told.contains("no sheet \"Auftrage\"; is it `Auftraege`?"), "{told}");
}

#[test]
fn an_ods_sheet_is_read_and_its_spanned_cells_are_refused() {
    let folder = folder("");
    let names = "xmlns:office=\"urn:oasis:names:tc:opendocument:xmlns:office:1.0\" xmlns:table=\"urn:oasis:names:tc:opendocument:xmlns:table:1.0\" xmlns:text=\"urn:oasis:names:tc:opendocument:xmlns:text:1.0\"";
    let text = |text: &str, more: &str| {
        format!("<table:table-cell office:value-type=\"string\"{more}><text:p>{text}</text:p></table:table-cell>")
    };
    let write = |span: &str, more: &str| {
        let head: String =
            ["Auftrag", "Teil", "Menge", "Liefertermin", "Prio", "Status"].iter().map(|head| text(head, "")).collect();
        let date = "<table:table-cell office:value-type=\"date\" office:date-value=\"2026-04-01\"><text:p>01.04.26</text:p></table:table-cell>";
        let count =
            "<table:table-cell office:value-type=\"float\" office:value=\"40\"><text:p>40</text:p></table:table-cell>";
        let row = [
            text("4711", ""),
            text("Welle", span),
            count.to_owned(),
            date.to_owned(),
            "<table:table-cell/>".to_owned(),
            text("offen", ""),
        ]
        .concat();
        let content = format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?><office:document-content {names}><office:body><office:spreadsheet><table:table table:name=\"Auftraege\"><table:table-row>{head}</table:table-row><table:table-row>{row}</table:table-row>{more}</table:table></office:spreadsheet></office:body></office:document-content>"
        );
        let mut archive = zip::ZipWriter::new(fs::File::create(folder.path().join("erp.ods")).unwrap());
        let manifest =
            "<manifest:manifest xmlns:manifest=\"urn:oasis:names:tc:opendocument:xmlns:manifest:1.0\"/>".to_owned();
        let kind = "application/vnd.oasis.opendocument.spreadsheet".to_owned();
        let files = [("mimetype", kind), ("META-INF/manifest.xml", manifest), ("content.xml", content)];
        for (name, content) in files {
            let stored = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored);
            archive.start_file(name, stored).unwrap();
            archive.write_all(content.as_bytes()).unwrap();
        }
        archive.finish().unwrap();
    };
    let map = MAP.replace("file = \"erp.csv\"", "file = \"erp.ods\"");
    fs::write(folder.path().join("map.toml"), map).unwrap();
    let import = || import_shop(&folder.path().join("map.toml"), &folder.path().join("shop.toml"));
    write("", "");
    let imported = import().unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(imported.file.scenario.orders[0].due / 3600.0, 62.0);
    write(" table:number-rows-spanned=\"2\"", "");
    let told = import().expect_err("spanned").to_string();
    assert!(told.contains("merged cells, the first at B2"), "{told}");
    // Spreadsheets keep the format of empty rows down to the end of a sheet: they are no cells.
    let empty = "<table:table-row table:number-rows-repeated=\"1048573\"><table:table-cell table:number-columns-repeated=\"16384\"/></table:table-row>";
    write("", empty);
    assert!(import().is_ok());
    let full =
        empty.replace("/></table:table-row>", " office:value-type=\"float\" office:value=\"1\"/></table:table-row>");
    write("", &full);
    let told = import().expect_err("more cells than memory").to_string();
    assert!(told.contains("reach from A1 to XFD1048575, and more than 4000000 cells"), "{told}");
}

#[test]
fn cells_too_far_apart_and_archives_too_large_are_refused_before_memory_is_taken() {
    let import = |folder: &TempDir| import_shop(&folder.path().join("map.toml"), &folder.path().join("shop.toml"));
    let told = |folder: &TempDir| import(folder).expect_err("too large").to_string();
    let far = folder_with("", "<row r=\"1048576\"><c r=\"XFD1048576\"><v>1</v></c></row>");
    assert!(told(&far).contains("reach from A1 to XFD1048576"), "{}", told(&far));
    // A kilobyte of zip, 300 MB unpacked.
    let folder = folder("");
    let file = fs::File::create(folder.path().join("erp.xlsx")).unwrap();
    let mut archive = zip::ZipWriter::new(file);
    archive.start_file("xl/workbook.xml", zip::write::SimpleFileOptions::default()).unwrap();
    let spaces = vec![b' '; 1_000_000];
    (0..300).for_each(|_| archive.write_all(&spaces).unwrap());
    archive.finish().unwrap();
    assert!(told(&folder).contains("larger than 256 MB when it is unpacked"), "{}", told(&folder));
}
