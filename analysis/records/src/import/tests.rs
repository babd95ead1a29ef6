//! Tables as they come from shops.

use super::*;
use proptest::prelude::*;
use toolroom_form::ReadError;

const SERIES: &str = "schema = 1\nprocess = \"empirical\"\nrows_per_operation = 2\n\
    [[column]]\nname = \"tool_id\"\nfrom = \"tool\"\n\
    [[column]]\nname = \"cutting_force\"\nfrom = \"Fc\"\nunit = \"N\"\n\
    [[column]]\nname = \"flank_wear\"\nfrom = \"VB\"\n\
    [[column]]\nname = \"cutting_time\"\nconstant = \"1 s\"\n";

fn mapping(text: &str) -> Mapping {
    Mapping::parse("map.toml", text, &[]).unwrap_or_else(|error| panic!("{error:?}"))
}

fn faults(text: &str) -> Vec<String> {
    match Mapping::parse("map.toml", text, &[]) {
        Err(ReadError::Faults(list)) => list.problems.iter().map(|problem| problem.fault.to_string()).collect(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn samples_become_operations() {
    let csv = "tool,Fc,VB [um]\nA,100,10\nA,200,20\nB,300,5\nA,400,30\nB,,6\n";
    let (records, report) = import_csv("log.csv", csv.as_bytes(), &mapping(SERIES)).expect("a fine table");
    assert_eq!(
        records.texts("operation_id").map(<[String]>::to_vec),
        Some(vec!["A-1".into(), "A-2".into(), "B-1".into()])
    );
    assert_eq!(records.numbers("cutting_force"), Some(&[150.0, 400.0, 300.0][..]));
    let wear = records.numbers("flank_wear").expect("a column");
    assert!(wear.iter().zip([20e-6, 30e-6, 6e-6]).all(|(read, due)| (read - due).abs() < 1e-15), "{wear:?}");
    assert_eq!(records.numbers("cutting_time"), Some(&[2.0, 1.0, 2.0][..]));
    assert!(report.notes.iter().any(|note| note == "5 rows make 3 operations of up to 2"), "{report}");
}

#[test]
fn a_byte_order_mark_semicolons_and_decimal_commas_are_read() {
    let csv = "\u{FEFF}tool;Fc;VB [mm]\nA;1,5;0,1\n";
    let (records, report) = import_csv("log.csv", csv.as_bytes(), &mapping(SERIES)).expect("a fine table");
    assert_eq!(records.numbers("cutting_force"), Some(&[1.5][..]));
    assert!(report.notes.iter().any(|note| note.contains("decimal comma")), "{report}");
}

#[test]
fn a_row_with_more_cells_than_headers_is_no_row_since_they_may_stand_under_the_wrong_ones() {
    let csv = "tool,Fc,VB [mm]\nA,1,5,0,1\nA,1,7,0,2\n";
    let error = import_csv("log.csv", csv.as_bytes(), &mapping(SERIES)).expect_err("decimal commas between commas");
    assert!(error.to_string().contains("line 2, 5 cells stand under 3 headers"), "{error}");
    // Commas at the end of a row, as spreadsheets write them, do no harm.
    let csv = "tool,Fc,VB [mm]\nA,100,0.1,,\n";
    assert_eq!(import_csv("log.csv", csv.as_bytes(), &mapping(SERIES)).expect("a fine table").0.len(), 1);
}

#[test]
fn running_totals_count_by_their_differences_in_any_order_of_rows() {
    let map = "schema = 1\nprocess = \"empirical\"\n[[column]]\nname = \"tool_id\"\nfrom = \"case\"\n\
        [[column]]\nname = \"sequence\"\nfrom = \"run\"\n\
        [[column]]\nname = \"cutting_time\"\nfrom = \"time\"\nunit = \"min\"\nrunning = true\n\
        [[column]]\nname = \"material\"\nfrom = \"material\"\nvalues = { 1 = \"cast iron\" }\n\
        [[column]]\nname = \"flank_wear\"\nfrom = \"VB\"\nunit = \"mm\"\n";
    let csv = "case,run,time,material,VB\n1,2,5,1,0.2\n1,1,2,1,\n1,1,2,1,\n1,3,4,2,0.3\n";
    let (records, report) = import_csv("mill.csv", csv.as_bytes(), &mapping(map)).expect("a fine table");
    let times = records.numbers("cutting_time").expect("a column");
    assert_eq!((times[0], times[1]), (120.0, 180.0));
    assert!(times[2].is_nan(), "the clock went back");
    assert_eq!(records.texts("material").map(|texts| (texts[0].as_str(), texts[2].as_str())), Some(("cast iron", "2")));
    assert_eq!(report.dropped.len(), 1, "{report}");
    assert!(report.dropped[0].1.contains("line 3"), "{report}");
}

#[test]
fn rows_outside_the_conditions_and_impossible_values_are_said() {
    let map = format!("{SERIES}[[keep]]\nfrom = \"state\"\nis = \"cut\"\n");
    let csv = "tool,Fc,VB [mm],state\nA,100,0.1,cut\nA,100,0.1,air\nA,100,250,cut\n";
    let (records, report) = import_csv("log.csv", csv.as_bytes(), &mapping(&map)).expect("a fine table");
    assert_eq!(records.len(), 1);
    assert_eq!(report.dropped, [(3, "state is air".to_owned())]);
    assert!(report.notes.iter().any(|note| note.contains("flank_wear") && note.contains("unit")), "{report}");
}

#[test]
fn every_fault_of_a_mapping_is_told_with_the_likely_fix() {
    let text = "schema = 1\nprocess = \"turning\"\n[[column]]\nname = \"cuting_force\"\nfrom = \"F\"\n\
        [[column]]\nname = \"feed_force\"\nfrom = \"F\"\nunit = \"mm\"\n\
        [[column]]\nname = \"tool_id\"\n[[column]]\nname = \"lot\"\nfrom = \"l\"\nunit = \"N\"\n";
    let found = faults(text);
    assert_eq!(found.len(), 5, "{found:?}");
    assert!(found[0].contains("need machine, cutting_speed") && found[2].contains("kN"), "{found:?}");
}

#[test]
fn a_column_that_the_file_lacks_is_named_with_its_nearest() {
    let error = import_csv("log.csv", b"tool,Fcc,VB\nA,1,2\n", &mapping(SERIES)).expect_err("no Fc");
    assert!(error.to_string().contains("is it `Fcc`?"), "{error}");
    let error = import_csv("log.csv", b"tool,Fc,VB\n", &mapping(SERIES)).expect_err("no rows");
    assert!(error.to_string().contains("no row of data"), "{error}");
}

proptest! {
    #[test]
    fn no_bytes_make_the_import_panic(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let mut csv = b"tool,Fc,VB\n".to_vec();
        csv.extend(&bytes);
        let _ = import_csv("fuzz", &csv, &mapping(SERIES));
        let _ = import_csv("fuzz", &bytes, &mapping(SERIES));
    }

    #[test]
    fn no_text_makes_a_mapping_panic(text in "\\PC{0,200}") {
        let _ = Mapping::parse("fuzz", &text, &[]);
        let _ = Mapping::parse("fuzz", &format!("{SERIES}[[column]]\nname = \"lot\"\nfrom = {text}"), &[]);
    }

    #[test]
    fn what_is_imported_reads_back_as_records(rows in prop::collection::vec((0..4_u8, 1.0..1e4_f64, 0.0..1.0_f64), 1..40)) {
        let csv: String = rows.iter().map(|(tool, force, wear)| format!("{tool};{force};{wear}\n")).collect();
        let (records, _) = import_csv("log", format!("tool;Fc;VB\n{csv}").as_bytes(), &mapping(SERIES)).expect("a fine table");
        let mut bytes = Vec::new();
        super::super::write_csv(&records, &mut bytes).expect("memory can be written");
        let (again, report) = super::super::parse_csv("again", &bytes, RecordKind::Empirical).expect("its own table");
        prop_assert_eq!(again.len(), records.len());
        prop_assert!(report.dropped.is_empty());
    }
}
