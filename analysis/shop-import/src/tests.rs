//! Shops from tables: what is made of rows, and where every fault is told.

#[cfg(feature = "xlsx")]
mod workbooks;

use crate::fault::{ShopImportError, letters};
use crate::source::Comparison;
use crate::{Imported, import_shop};
use std::fs;
use tempfile::TempDir;
use toolroom_scenario::{Work, date};

const BASE: &str = r#"schema = 1
[shop]
name = "works"
start = "2026-03-30 00:00"
horizon = "2 week"
replications = 5
[dispatch]
rule = ["priority", "edd"]
"#;

const MAP: &str = r#"schema = 1
base = "base.toml"
[[table]]
kind = "calendars"
file = "shifts.csv"
column = [{ name = "name", from = "Kalender" }, { name = "days", from = "Tage", values = { "Mo-Fr" = "mon-fri" } },
          { name = "from", from = "von" }, { name = "to", from = "bis" }, { name = "holiday", from = "frei", format = "%d.%m.%Y" }]
[[table]]
kind = "machines"
file = "machines.csv"
default = { process = "plain" }
column = [{ name = "name", from = "Platz" }, { name = "calendar", from = "Kalender" }, { name = "rate", from = "Satz [EUR/h]" }]
[[table]]
kind = "operators"
file = "people.csv"
column = [{ name = "name", from = "Name" }, { name = "skills", from = "kann" }, { name = "calendar", from = "Kalender" }]
[[table]]
kind = "routings"
file = "routings.csv"
default = { operator.setup = "setup" }
column = [{ name = "part", from = "Teil" }, { name = "sequence", from = "AVO" }, { name = "machines", from = "Platz" },
          { name = "setup_time", from = "Ruesten", unit = "min" }, { name = "work", from = "Stueck", unit = "min", cv = 0.2 }]
[[table]]
kind = "orders"
file = "erp.csv"
where = "Status != 'fertig' and Menge > 0"
default = { priority = 2 }
column = [{ name = "id", from = "Auftrag" }, { name = "part", from = "Teil" }, { name = "quantity", from = "Menge" },
          { name = "due", from = "Liefertermin", format = "%d.%m.%Y", at = "14:00" }, { name = "priority", from = "Prio" }]
"#;

const TABLES: [(&str, &str); 5] = [
    (
        "shifts.csv",
        "Kalender;Tage;von;bis;frei\nfrueh;Mo-Fr;6:00;14:00;\nspaet;Mo-Fr;14:00;22:00;\nfrueh;;;;03.04.2026\n",
    ),
    ("machines.csv", "Platz;Kalender;Satz [EUR/h]\nT1;frueh;60\nT2;frueh;60,5\nC;spaet;\n"),
    ("people.csv", "Name;kann;Kalender\nAnna;setup|measure;frueh\nBert;setup;spaet\n"),
    (
        "routings.csv",
        "Teil;AVO;Platz;Ruesten;Stueck\nWelle;20;C;15;4,5\nWelle;10;T1,T2;30;8\nRing;10;T1|T2;45;6\nRing;20;C;0;3\n",
    ),
    (
        "erp.csv",
        "Auftrag;Teil;Menge;Liefertermin;Prio;Status\n4711;Welle;40;01.04.2026;1;offen\n4712;Ring;60;31.03.2026;;offen\n\
         4713;Welle;10;31.03.2026;1;fertig\n4714;Ring;0;31.03.2026;1;offen\n",
    ),
];

/// The tables in a folder, with some texts replaced: file, text, text in its place.
fn import(changes: &[(&str, &str, &str)]) -> Result<Imported, ShopImportError> {
    let folder = TempDir::new().unwrap();
    let files = TABLES.into_iter().chain([("base.toml", BASE), ("map.toml", MAP)]);
    for (name, text) in files {
        let mut text = text.to_owned();
        for (_, old, new) in changes.iter().filter(|(file, ..)| *file == name) {
            assert!(text.contains(old), "{name} has {old}");
            text = text.replacen(old, new, 1);
        }
        fs::write(folder.path().join(name), text).unwrap();
    }
    import_shop(&folder.path().join("map.toml"), &folder.path().join("shop.toml"))
}

/// The faults, a line each.
fn refused(changes: &[(&str, &str, &str)]) -> Vec<String> {
    match import(changes) {
        Err(ShopImportError::Cells { faults, .. }) => faults.iter().map(ToString::to_string).collect(),
        Err(other) => vec![other.to_string()],
        Ok(imported) => panic!("admitted:\n{}", imported.text),
    }
}

#[test]
fn tables_become_the_shop_that_they_mean() {
    let imported = import(&[]).unwrap_or_else(|error| panic!("{error}"));
    let shop = &imported.file.scenario;
    assert_eq!(shop.machines.iter().map(|each| each.name.as_str()).collect::<Vec<_>>(), ["T1", "T2", "C"]);
    assert_eq!(shop.parts.iter().map(|each| each.name.as_str()).collect::<Vec<_>>(), ["Welle", "Ring"]);
    // Rows of a routing go by their numbers, whatever their order in the table.
    let shaft = &shop.parts[0].operations;
    assert_eq!(
        (shaft[0].name.as_str(), shaft[0].machines.as_slice(), shaft[0].setup_time),
        ("10", &[0, 1][..], Some(1800.0))
    );
    let Work::Plain(time) = &shaft[1].work else { panic!("plain work") };
    assert!((time.mean() - 270.0).abs() < 1e-9, "{}", time.mean());
    // 14:00 of the day, counted from Monday 0:00; the third and fourth row do not count.
    assert_eq!(shop.orders.len(), 2, "{}", imported.text);
    let hours = |order: usize| shop.orders[order].due / 3600.0;
    assert_eq!((hours(0), hours(1)), (62.0, 38.0));
    assert_eq!((shop.orders[0].priority, shop.orders[1].priority, shop.orders[1].quantity), (1, 2, 60));
    assert_eq!(shop.skills, ["setup", "measure"]);
    // Good Friday is free: eight mornings of two weeks and one more.
    assert_eq!(shop.calendars[0].working_time(0.0, shop.horizon), 9.0 * 8.0 * 3600.0);
    assert!((shop.machines[1].rate - 60.5 / 3600.0).abs() < 1e-12);
    assert!(
        imported.notes.iter().any(|note| note == "orders: 2 rows of erp.csv; 2 left out by `where`"),
        "{:?}",
        imported.notes
    );
    assert!(imported.text.starts_with(BASE.trim_end()));
}

#[test]
fn every_faulty_cell_is_told_at_once_with_the_nearest_name() {
    let told = refused(&[
        ("erp.csv", "4711;Welle;40", "4711;Wele;40"),
        ("erp.csv", "4712;Ring;60;31.03.2026", "4711;Ring;60;31.02.2026"),
        ("routings.csv", "Ring;20;C", "Ring;20;D9"),
        ("people.csv", "Anna;setup|measure;frueh", "Anna;setup|measure;fruh"),
        ("machines.csv", "T2;frueh;60,5", "T2;frueh;sixty"),
    ]);
    let all = told.join("\n");
    for expected in [
        "machines.csv, row 3, cell C3 (Satz [EUR/h]): ",
        "people.csv, row 2, cell C2 (Kalender): there is no calendar \"fruh\"\n    did you mean `frueh`?",
        "routings.csv, row 5, cell C5 (Platz): there is no machine \"D9\"",
        "erp.csv, row 2, cell B2 (Teil): there is no part \"Wele\"\n    did you mean `Welle`?",
        "erp.csv, row 3, cell D3 (Liefertermin): \"31.02.2026\" is no date of the form",
        "erp.csv, row 3, cell A3 (Auftrag): two orders are called \"4711\"",
    ] {
        assert!(all.contains(expected), "{expected}\nis not in\n{all}");
    }
}

#[test]
fn what_no_shop_can_do_is_told_at_its_cell() {
    let one = |changes: &[(&str, &str, &str)]| refused(changes).join("\n");
    let told = one(&[("map.toml", " and Menge > 0", "")]);
    assert!(told.contains("erp.csv, row 5, cell C5 (Menge): `quantity` = 0 is outside"), "{told}");
    let told = one(&[("erp.csv", "4712;Ring;60;", "4712;Ring;6O;")]);
    assert!(told.contains("erp.csv, row 3, cell C3: `where` compares Menge with a number, but it is \"6O\""), "{told}");
    let told = one(&[("erp.csv", "4712;Ring;60;31.03.2026", "4712;Ring;60;28.03.2026")]);
    assert!(told.contains("erp.csv, row 3, cell D3 (Liefertermin): `due`"), "{told}");
    let told = one(&[("people.csv", "setup|measure", "measure"), ("people.csv", "Bert;setup", "Bert;drive")]);
    assert!(told.contains("nobody has the skill \"setup\""), "{told}");
    assert!(told.contains("routings.csv, row 2"), "{told}");
    let told = one(&[("shifts.csv", "spaet;Mo-Fr;14:00;22:00", "spaet;;;")]);
    assert!(told.contains("shifts.csv, row 3"), "{told}");
    let told = one(&[("map.toml", "unit = \"min\", cv", "cv")]);
    assert!(
        told.contains("cell E2 (Stueck): 4.5 has no unit") || told.contains("cell E2 (Stueck): 4,5 has no unit"),
        "{told}"
    );
    let told = one(&[("routings.csv", "Welle;10;", "Welle;20;")]);
    assert!(told.contains("two operations of \"Welle\" have the number 20"), "{told}");
}

#[test]
fn faults_of_the_base_and_of_the_mapping_keep_their_lines() {
    let told = refused(&[("base.toml", "\"edd\"", "\"eddd\"")]).join("\n");
    assert!(told.contains("base.toml:8:") && told.contains("did you mean `edd`?"), "{told}");
    let told = refused(&[("base.toml", "[dispatch]", "[dispatch")]).join("\n");
    assert!(told.contains("base.toml:7:"), "{told}");
    let told = refused(&[("map.toml", "\"Auftrag\"", "\"Auftrg\"")]).join("\n");
    assert!(told.contains("erp.csv, row 1: there is no column \"Auftrg\"\n    did you mean `Auftrag`?"), "{told}");
    let told = refused(&[("map.toml", "name = \"quantity\"", "name = \"quantty\"")]).join("\n");
    assert!(told.contains("map.toml:28:") && told.contains("did you mean `quantity`?"), "{told}");
    let told = refused(&[("map.toml", "Status != 'fertig'", "Status ~ 'fertig'")]).join("\n");
    assert!(told.contains("is no comparison"), "{told}");
}

#[test]
fn titles_above_the_headers_are_passed_over_and_lines_still_count_from_the_top() {
    let title = [
        ("erp.csv", "Auftrag;Teil", "Auftraege, Stand heute\n\nAuftrag;Teil"),
        ("map.toml", "file = \"erp.csv\"", "file = \"erp.csv\"\nheader = 3"),
    ];
    assert_eq!(import(&title).unwrap_or_else(|error| panic!("{error}")).file.scenario.orders.len(), 2);
    let told = refused(&[&title[..], &[("erp.csv", "4711;Welle", "4711;Wele")]].concat()).join("\n");
    assert!(told.starts_with("erp.csv, row 4, cell B4 (Teil): there is no part \"Wele\""), "{told}");
}

#[test]
fn a_cell_that_cannot_be_written_is_told_once() {
    let told = refused(&[(
        "map.toml",
        "name = \"work\", from = \"Stueck\", unit = \"min\"",
        "name = \"work\", from = \"Stueck\"",
    )]);
    assert_eq!(told.len(), 4, "one for every operation: {told:?}");
    let told = refused(&[("map.toml", "from = \"Stueck\"", "from = \"Stuck\"")]);
    assert_eq!(told.len(), 1, "one for the column: {told:?}");
}

#[test]
fn conditions_compare_numbers_as_numbers_and_texts_as_texts() {
    let one = |text: &str| Comparison::parse(text).map(|all| all.len());
    assert_eq!(one("A = 1 and B != 'x and y' and C >= 2.5"), Ok(3));
    assert!(one("A like 'x'").is_err() && one("A > 'x'").is_err() && one("A =").is_err());
    assert_eq!([letters(0), letters(25), letters(26), letters(701), letters(702)], ["A", "Z", "AA", "ZZ", "AAA"]);
    assert!(date::is_format("%d.%m.%Y"));
}

#[test]
fn a_setup_matrix_comes_from_pairs_and_components_from_rows() {
    let more = r#"
[[table]]
kind = "setup_matrix"
file = "setups.csv"
column = [{ name = "from", from = "von" }, { name = "to", from = "nach" }, { name = "time", from = "min", unit = "min" }]
[[table]]
kind = "components"
file = "bom.csv"
column = [{ name = "part", from = "Teil" }, { name = "component", from = "Komponente" }, { name = "quantity", from = "Menge" }]
"#;
    let folder = TempDir::new().unwrap();
    for (name, text) in TABLES.into_iter().chain([("base.toml", BASE)]) {
        fs::write(folder.path().join(name), text).unwrap();
    }
    let setups = "von;nach;min\nWelle;Ring;20\nRing;Welle;45\n;Ring;60\n;Welle;50\n";
    fs::write(folder.path().join("setups.csv"), setups).unwrap();
    fs::write(folder.path().join("bom.csv"), "Teil;Komponente;Menge\nRing;Wele;2\n").unwrap();
    fs::write(folder.path().join("map.toml"), format!("{MAP}{more}")).unwrap();
    let import = || import_shop(&folder.path().join("map.toml"), &folder.path().join("shop.toml"));
    let told = import().expect_err("a component that is no part").to_string();
    assert!(told.contains("bom.csv, row 2, cell B2 (Komponente): there is no part \"Wele\""), "{told}");
    fs::write(folder.path().join("bom.csv"), "Teil;Komponente;Menge\n").unwrap();
    let imported = import().unwrap_or_else(|error| panic!("{error}"));
    let matrix = &imported.file.scenario.setup_matrices[0];
    assert_eq!(matrix.first, Some(vec![3000.0, 3600.0]));
    assert_eq!(matrix.times, [[0.0, 1200.0], [2700.0, 0.0]].map(|row| row.to_vec()));
    fs::write(folder.path().join("setups.csv"), setups.replace("Ring;Welle;45\n", "")).unwrap();
    let told = import().expect_err("a pair is missing").to_string();
    assert!(told.contains("setup matrix \"setup\" has no time from \"Ring\" to \"Welle\""), "{told}");
}
