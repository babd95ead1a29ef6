//! Reading what real files hold.

use super::*;

const HEAD: &str = "operation_id,machine,tool_id,sequence,cutting_speed [m/min],feed_per_rev [mm],depth_of_cut [mm],cutting_time [min]";

fn turning(body: &str) -> Result<(Records, ReadReport), RecordError> {
    parse_csv("operations.csv", body.as_bytes(), RecordKind::Turning)
}

#[test]
fn a_mark_beyond_its_range_is_not_told_to_check_its_unit() {
    let csv = "tool_id,life [min],censored,operation_id,sequence\nA,30,2,1,1\nB,20,0,2,1\nC,10,1,3,1\n";
    let (_, report) = parse_csv("lives.csv", csv.as_bytes(), RecordKind::Empirical).unwrap();
    let told = report.notes.join("; ");
    assert!(told.contains("line 2: censored is 2, and 1 is the greatest that it can be"), "{told}");
}

#[test]
fn any_compatible_unit_is_converted() {
    let (records, _) = turning(&format!("{HEAD},temperature [degC],flank_wear [um]\n1,L,T,1,60,0.2,1,2,100,250\n"))
        .expect("a fine table");
    assert_eq!(records.numbers("cutting_speed"), Some(&[1.0][..]));
    assert_eq!(records.numbers("temperature"), Some(&[373.15][..]));
    assert!((records.numbers("flank_wear").expect("a column")[0] - 0.25e-3).abs() < 1e-15);
}

#[test]
fn missing_cells_are_missing_and_useless_rows_are_named() {
    let body = "1,L,T,1,60,0.2,1,2,\n2,L,T,2,,0.2,1,2,900\n3,L,T,3,60,0.2,1,2,UNAVAILABLE\n3,L,T,3,60,0.2,1,2,900\n";
    let (records, report) = turning(&format!("{HEAD},cutting_force [N]\n{body}")).expect("a fine table");
    assert_eq!(records.len(), 2);
    assert!(records.numbers("cutting_force").is_some_and(|force| force.iter().all(|value| value.is_nan())));
    assert_eq!(report.dropped.len(), 2);
    assert!(report.dropped[0].1.contains("cutting_speed"), "{report}");
    assert!(report.dropped[1].1.contains("already"), "{report}");
}

#[test]
fn a_row_at_whose_conditions_nothing_is_cut_is_left_out_with_its_line() {
    let body = "1,L,T,1,60,0.2,1,2\n2,L,T,2,0,0.2,1,2\n3,L,T,3,60,0.2,1,-2\n4,L,T,4,60,-0.2,1,2\n5,L,T,5,60,0.2,1,0\n";
    let (records, report) = turning(&format!("{HEAD}\n{body}")).expect("a fine table");
    // A reading before the first cut has no time in cut, and stays.
    assert_eq!(records.texts("operation_id"), Some(&["1".to_owned(), "5".to_owned()][..]));
    let lines: Vec<usize> = report.dropped.iter().map(|(line, _)| *line).collect();
    assert_eq!(lines, [3, 4, 5], "{report}");
    assert!(report.dropped[1].1.starts_with("cutting_time is -2 min, at which nothing is cut"), "{report}");
    assert_eq!(report.unknown_cuts[1], (4, "a cutting_time of -2 min".to_owned()));
}

#[test]
fn rows_come_in_any_order() {
    let body = "2,L,T,2,61,0.2,1,2\n1,L,T,1,60,0.2,1,2\n";
    let (records, report) = turning(&format!("{HEAD}\n{body}")).expect("a fine table");
    assert_eq!(records.numbers("sequence"), Some(&[1.0, 2.0][..]));
    assert!(report.notes.iter().any(|note| note.contains("order")));
}

#[test]
fn a_missing_column_and_a_wrong_unit_are_refused_with_the_fix() {
    let missing = turning("operation_id,machine\n1,L\n").expect_err("no tool_id");
    assert!(matches!(missing, RecordError::MissingColumn { column: "tool_id", .. }), "{missing}");
    let unit = turning(&format!("{HEAD},cutting_force [mm]\n1,L,T,1,60,0.2,1,2,3\n")).expect_err("no force");
    assert!(unit.to_string().contains("kN"), "{unit}");
}

#[test]
fn lines_are_those_of_the_file_whatever_ends_them_and_stands_above() {
    let body = "1,L,T,1,60,0.2,1,2\n\n# a comment\n2,L,T,2,,0.2,1,2\n3,L,T,3,60,0.2,1,2\n";
    for end in ["\n", "\r\n"] {
        let text = format!("# our log\n{HEAD}\n{body}").replace('\n', end);
        let (_, report) = turning(&text).expect("a fine table");
        assert_eq!((report.dropped[0].0, report.lines.as_slice()), (6, &[3, 7][..]), "{report}");
    }
    // Rows that are put in order keep their lines.
    let (_, report) = turning(&format!("{HEAD}\n2,L,T,2,61,0.2,1,2\n1,L,T,1,60,0.2,1,2\n")).expect("a fine table");
    assert_eq!(report.lines, [3, 2]);
}

#[test]
fn decimal_commas_beside_points_are_read_unless_they_may_stand_between_thousands() {
    let semicolons = HEAD.replace(',', ";");
    let read = |speed: &str| {
        turning(&format!("{semicolons}\n1;L;T;1;{speed};0.2;1;2\n2;L;T;2;60.5;0.2;1;2\n")).expect("a fine table")
    };
    let (records, report) = read("60,5");
    assert_eq!((records.len(), report.unreadable.len()), (2, 0), "{report}");
    assert!(report.notes[0].contains("line 2: `60,5`") && report.notes[0].contains("both are read"), "{report}");
    let (records, report) = read("1,500");
    assert_eq!(records.len(), 1, "{report}");
    assert!(report.notes[0].contains("`1,500` in line 2 may be either"), "{report}");
}

#[test]
fn decimal_commas_are_read_with_points_between_thousands() {
    let semicolons = HEAD.replace(',', ";");
    let read = |speed: &str, feed: &str| {
        let (records, report) =
            turning(&format!("{semicolons}\n1;L;T;1;{speed};{feed};1;2\n2;L;T;2;60,5;0,2;1;2\n3;L;T;3;60;1;1;2\n"))
                .expect("a fine table");
        (records.numbers("cutting_speed").map(|all| 60.0 * all[0]), report)
    };
    let (speed, report) = read("1.113,25", "0,2");
    assert!((speed.expect("speeds") - 1113.25).abs() < 1e-9, "{report}");
    // A point that may be either is not guessed at.
    let (_, report) = read("1.113,25", "1.113");
    assert!(report.notes.iter().any(|note| note.contains("has points between thousands")), "{report}");
    // No groups of three: not numbers that anybody writes.
    for wrong in ["11.13,25", ".555,5", "0.123,5"] {
        assert_eq!(read(wrong, "0,2").1.unreadable.len(), 1, "{wrong}");
    }
}

#[test]
fn an_id_that_stands_for_several_records_of_an_edge_is_told() {
    let (_, report) = turning(&format!("{HEAD}\n1,L,T,1,60,0.2,1,2\n1,L,T,2,61,0.2,1,2\n")).expect("a fine table");
    assert!(report.notes.iter().any(|note| note.contains("first `1` in lines 2 and 3")), "{report}");
    // Two edges share a pass.
    let (_, report) = turning(&format!("{HEAD}\n1,L,T,1,60,0.2,1,2\n1,L,U,1,60,0.2,1,2\n")).expect("a fine table");
    assert!(report.notes.iter().all(|note| !note.contains("of their edge")), "{report}");
}

#[test]
fn rows_that_repeat_earlier_ones_are_told() {
    let row = "1,L,T,1,60,0.2,1,2";
    let (_, report) = turning(&format!("{HEAD}\n{row}\n2,L,T,2,60,0.2,1,2\n{row}\n{row}\n")).expect("a fine table");
    assert!(
        report.notes.iter().any(|note| note.starts_with("2 rows repeat") && note.contains("line 4 that of line 2")),
        "{report}"
    );
    let (_, report) = turning(&format!("{HEAD}\n{row}\n")).expect("a fine table");
    assert!(report.notes.iter().all(|note| !note.contains("repeat")), "{report}");
}

#[test]
fn a_value_beyond_its_range_is_told_in_the_unit_of_the_file_and_an_empty_file_has_no_rows() {
    let head = HEAD.replace("m/min", "m/s");
    let error = turning(&format!("{head}\n1,L,T,1,180,0.2,1,2\n")).expect_err("too fast");
    assert!(error.to_string().contains("line 2, cutting_speed is 180 m/s, beyond 3000 m/min"), "{error}");
    assert!(turning("").expect_err("nothing").to_string().contains("no row of data"));
}

#[test]
fn what_is_written_reads_back() {
    let body = "1,L,T,1,60,0.2,1,2,0.123\n2,L,T,2,70.5,0.2,1,2,\n";
    let (records, _) = turning(&format!("{HEAD},flank_wear [mm]\n{body}")).expect("a fine table");
    let mut bytes = Vec::new();
    write_csv(&records, &mut bytes).expect("memory can be written");
    let (again, _) = parse_csv("again", &bytes, RecordKind::Turning).expect("its own table");
    for name in records.number_columns() {
        let pairs = records.numbers(name).into_iter().flatten().zip(again.numbers(name).into_iter().flatten());
        assert!(pairs.clone().all(|(a, b)| (a.is_nan() && b.is_nan()) || (a - b).abs() <= 1e-8 * a.abs()), "{name}");
    }
}
