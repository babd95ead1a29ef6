//! What programs in six languages do, worked out independently as lists of moves, and what is refused.

#[path = "controls/cam_posts.rs"]
mod cam_posts;
#[path = "controls/keys.rs"]
mod keys;
#[path = "controls/lathes.rs"]
mod lathes;
#[path = "controls/long_programs.rs"]
mod long_programs;
#[path = "controls/mutations.rs"]
mod mutations;
#[path = "controls/polar.rs"]
mod polar;
#[path = "controls/shop_floor.rs"]
mod shop_floor;
#[path = "controls/whole_programs.rs"]
mod whole_programs;
#[path = "controls/work_offsets.rs"]
mod work_offsets;

use toolroom_program::{Control, Dialect, EventKind, ProgramError, Run};

/// Sums over a program that starts at X0 Y0 Z100.
#[derive(Debug, Default)]
struct Sums {
    feed: f64,
    rapid: f64,
    dwell: f64,
    length: f64,
    holes: usize,
    changes: usize,
    end: [f64; 9],
}

fn control(dialect: Dialect) -> Control {
    let mut control = Control::of(dialect);
    control.start = [Some(0.0); 9];
    control.start[2] = Some(100.0);
    control.steps = 100_000;
    control
}

fn sums(text: &str, control: &Control) -> Result<Sums, ProgramError> {
    let mut sums = Sums::default();
    let mut run = Run::new(text, control)?;
    for event in run.by_ref() {
        match event?.kind {
            EventKind::Motion(motion) => {
                sums.feed += motion.time;
                sums.length += motion.feed_length();
                if motion.rapid {
                    sums.rapid += motion.nominal(0.5);
                }
            }
            EventKind::Dwell(seconds) => sums.dwell += seconds,
            EventKind::Hole => sums.holes += 1,
            EventKind::ToolChange(_) => sums.changes += 1,
            _ => {}
        }
    }
    sums.end = run.position().map(|place| place.unwrap_or(f64::NAN));
    Ok(sums)
}

fn close(name: &str, found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-5, "{name}: {found}, expected {expected}");
}

/// Feed time, rapid time, dwell, end in X Y Z.
fn does(dialect: Dialect, text: &str, expected: (f64, f64, f64, [f64; 3])) {
    let sums = sums(text, &control(dialect)).unwrap_or_else(|error| panic!("{text}\n{error}"));
    let (feed, rapid, dwell, end) = expected;
    close(&format!("{text}\nfeed time"), sums.feed, feed);
    close(&format!("{text}\nrapid time"), sums.rapid, rapid);
    close(&format!("{text}\ndwell"), sums.dwell, dwell);
    for (axis, (reached, place)) in sums.end.iter().zip(end).enumerate() {
        close(&format!("{text}\nend {axis}"), *reached, place);
    }
}

fn refused(dialect: Dialect, text: &str) -> ProgramError {
    match sums(text, &control(dialect)) {
        Err(error) => error,
        Ok(sums) => panic!("{text}\nis not refused: {sums:?}"),
    }
}

/// Lines and words of all refusals.
fn refusals(dialect: Dialect, text: &str) -> Vec<(usize, String)> {
    let error = refused(dialect, text);
    error.all().map(|one| (one.line, one.message.split_whitespace().next().unwrap_or_default().to_owned())).collect()
}

#[test]
fn all_words_that_are_refused_are_told_at_once() {
    let fanuc = "G21 G90 G0 X0 Y0 Z0\nG411 X5.\nG1 X10. F100\nG2 X30. Y0 R10.\nG7.1 C5.\n(open\nM98 P5 L2\nG412\nM30\nO5\nG413\nM99";
    let lines: Vec<usize> = refusals(Dialect::Fanuc, fanuc).iter().map(|(line, _)| *line).collect();
    // A word in a subprogram is told once, whatever the number of its calls.
    assert_eq!(lines, [2, 5, 6, 11, 8]);
    let error = refused(Dialect::Fanuc, fanuc);
    assert_eq!(error.others[2].calls, [(7, 1)]);
    // Words that follow from a fault are no faults of their own: the centre of this arc is missed because of line 2.
    assert_eq!(refusals(Dialect::Fanuc, "G21 G90 G0 X0 Y0\nG411 X5. Y5.\nG3 X5. Y-5. I0 J-5. F100\nM30").len(), 1);
    assert_eq!(
        refusals(Dialect::Siemens, "G71 G90 G0 X0 Y0\nPOCKET3(1)\nCASE R1 OF\nG1 X5 F100\nG477\nM30"),
        [(2, "POCKET3".to_owned()), (3, "CASE".to_owned()), (5, "G477".to_owned())]
    );
    let klartext = "0 BEGIN PGM A MM\n1 L X+0 Y+0 R0 FMAX\n2 PLANE SPATIAL SPA+5\n3 CYCL DEF 251 Q1=1\n4 L X+5 F100 M128\n5 END PGM A MM";
    assert_eq!(refusals(Dialect::Heidenhain, klartext).iter().map(|(line, _)| *line).collect::<Vec<_>>(), [3, 4, 5]);
    // A loop whose end was refused comes to an end, and no more than twenty are told.
    assert_eq!(refusals(Dialect::Fanuc, "G21 G90\nN1 G411\nGOTO 1").len(), 1);
    let many: String = (0..50).map(|code| format!("G{}\n", 400 + code)).collect();
    assert_eq!(refusals(Dialect::Fanuc, &many).len(), ProgramError::MOST);
}

#[test]
fn names_of_a_program_go_before_cycles_of_the_control() {
    let text = "%_N_A_MPF\nG71 G90 G94\nG0 X0 Y0 Z0\nSLOT(20)\nSLOT2(5)\nM30\n%_N_SLOT_SPF\nPROC SLOT(REAL LEN)\nG1 X=LEN F600\nM17\n\
                %_N_SLOT2_SPF\nPROC SLOT2(REAL LEN)\nG1 Y=LEN F600\nM17\n";
    does(Dialect::Siemens, text, (2.5, 0.2, 0.0, [20.0, 5.0, 0.0]));
    assert!(refused(Dialect::Siemens, "G71 G90\nG0 X0\nSLOT2(5)\nM30").message.contains("cycle of the control"));
}

#[test]
fn q_parameters_of_one_cycle_are_none_of_another() {
    let text = "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S500\n2 L X+0 Y+0 Z+5 R0 FMAX M3\n\
                3 CYCL DEF 200 Q200=+5 Q201=-10 Q206=+300 Q202=+10 Q210=+0 Q203=+0 Q204=+5 Q211=+0.5\n4 CYCL CALL\n\
                5 CYCL DEF 207 Q200=+5 Q201=-10 Q239=+1 Q203=+0 Q204=+5\n6 CYCL CALL\n7 END PGM A MM\n";
    // A hole of 15 mm at 300 with a dwell, a thread of 15 mm down and up at 500 without.
    does(Dialect::Heidenhain, text, (3.0 + 3.6, 0.19 + 0.03, 0.5, [0.0, 0.0, 5.0]));
}

#[test]
fn fanuc_programs_do_what_their_words_say() {
    use Dialect::Fanuc;
    does(
        Fanuc,
        "G21 G90\nG0 X0 Y0 Z5.\nM98 P30010\nM30\nO10\nG91 G1 X5. F300\nG90\nM99",
        (3.0, 0.19, 0.0, [15.0, 0.0, 5.0]),
    );
    // A macro with arguments, a jump out of a loop, and a vacant variable.
    let text = "G21 G90\nG0 X0 Y0 Z0\nG65 P20 X10. F600.\nM30\nO20\n#1=0\nN1 #1=#1+1\nG91 G1 X#24 F#9\nX#3\nIF [#1 LT 3] GOTO 1\nG90\nM99";
    does(Fanuc, text, (3.0, 0.2, 0.0, [30.0, 0.0, 0.0]));
    does(Fanuc, "G21 G90 G0 X0 Y0 Z0\nG51.1 X0\nG1 X10. F600\nG50.1 X0\nG1 X10.", (3.0, 0.2, 0.0, [10.0, 0.0, 0.0]));
    does(Fanuc, "G21 G90 G0 X0 Y0 Z0\nG51 X0 Y0 Z0 P2000\nG1 X10. F600\nG50", (2.0, 0.2, 0.0, [20.0, 0.0, 0.0]));
    does(Fanuc, "G21 G90 G0 X0 Y0 Z0\nG16\nG1 X10. Y90. F600\nG15", (1.0, 0.2, 0.0, [0.0, 10.0, 0.0]));
    does(
        Fanuc,
        "G21 G90 G0 X0 Y0 Z0\nG52 X10. Y5.\nG1 X10. Y0 F600\nG52 X0 Y0",
        (60.0 * 20.0_f64.hypot(5.0) / 600.0, 0.2, 0.0, [20.0, 5.0, 0.0]),
    );
    does(
        Fanuc,
        "G21 G90 G0 X0 Y0 Z0\nG92 X100. Y0\nG1 X110. F600\nG4 X1.5\nG4 P250",
        (1.0, 0.2, 1.75, [10.0, 0.0, 0.0]),
    );
    // Down 8 and 9 mm from R with a retraction of 1 mm: 3 + 4 + 3 mm.
    does(
        Fanuc,
        "G21 G90 G0 X0 Y0 Z10.\nG73 Z-6. R2. Q3. F60\nG80",
        (10.0, (90.0 + 8.0 + 2.0 + 16.0) / 500.0, 0.0, [0.0, 0.0, 10.0]),
    );
    does(
        Fanuc,
        "G21 G90 G0 X0 Y0 Z10.\nS100 M3\nG99 G84 Z-6. R2. P500 F100\nG80",
        (9.6, 98.0 / 500.0, 0.5, [0.0, 0.0, 2.0]),
    );
    does(
        Fanuc,
        "G21 G90 G0 X0 Y0 Z10.\nG18 G2 X10. Z0 R10. F600\n",
        (0.5 * std::f64::consts::PI, 0.18, 0.0, [10.0, 0.0, 0.0]),
    );
}

#[test]
fn haas_siemens_and_linuxcnc_programs_do_what_their_words_say() {
    use Dialect::{Haas, LinuxCnc, Siemens};
    let circle =
        sums("G21 G90 G0 X0 Y0 Z5.\nG81 Z-1. R1. F60 L0\nG70 I10. J0 L4\nG80", &control(Haas)).expect("a program");
    assert_eq!(circle.holes, 4);
    close("feed", circle.feed, 8.0);
    let text =
        "G17 G71 G90 G94\nG0 X0 Y0 Z10\nF60\nMCALL CYCLE82(10,0,2,-3,,0.5)\nG0 X10\nX20\nMCALL\nHERE:\nG0 X0\nM30";
    does(Siemens, text, (10.0, (90.0 + 2.0 * (10.0 + 8.0 + 13.0) + 20.0) / 500.0, 1.0, [0.0, 0.0, 10.0]));
    let text = "G17 G71 G90\nG0 X0 Y0 Z0\nAA1: G91 G1 X5 F300\nBB1: Y5\nREPEAT AA1 BB1 P=2\nG90\nIF R1==0 GOTOF ENDE\nG1 X500\nENDE: M30";
    does(Siemens, text, (6.0, 0.2, 0.0, [15.0, 15.0, 0.0]));
    // A variable with the name of an axis and a number is one where DEF says so.
    let text = "DEF REAL A1=5, B1\nG17 G71 G90\nG0 X0 Y0 Z0\nB1=A1*2+SQRT(9)\nG1 X=B1 F300\nM30";
    does(Siemens, text, (2.6, 0.2, 0.0, [13.0, 0.0, 0.0]));
    let text = "%_N_MAIN_MPF\nG17 G71 G90\nG0 X0 Y0 Z0\nTRANS X10\nAROT RPL=90\nSUB1 P2\nTRANS\nM30\n%_N_SUB1_SPF\nG1 G91 X5 F300\nG90\nM17";
    // From X0 of the workpiece, which is -10 before the turn, 5 mm along the turned X twice.
    does(Siemens, text, (2.0, 0.2, 0.0, [0.0, 10.0, 0.0]));
    does(
        Siemens,
        "G17 G71 G90\nG0 X0 Y0 Z0\nG1 X10 F600\nCT X20 Y10\nCIP X30 Y0 I1=27.0710678 J1=7.0710678",
        (1.0 + std::f64::consts::PI, 0.2, 0.0, [30.0, 0.0, 0.0]),
    );
    let text = "G21 G90 G17\nG0 X0 Y0 Z0\n#<a> = 3\no1 repeat [#<a>]\n G91 G1 X1 F60\n o2 if [#<a> GT 5]\n  X100\n o2 else\n  Y1\n o2 endif\no1 endrepeat\nM2";
    does(LinuxCnc, text, (6.0, 0.2, 0.0, [3.0, 3.0, 0.0]));
    let text = "G21 G90 G17\nG0 X0 Y0 Z0\n#1=0\no1 do\n#1=[#1+1]\no2 if [#1 EQ 2]\no1 continue\no2 endif\nG91 G1 X1 F60\no3 if [#1 GE 4]\no1 break\no3 endif\no1 while [#1 LT 10]\nM2";
    does(LinuxCnc, text, (3.0, 0.2, 0.0, [3.0, 0.0, 0.0]));
    // A parabola y = x² from (-1, 1) to (1, 1): length √5 + asinh(2)/2.
    let length = 5.0_f64.sqrt() + 0.5 * 2.0_f64.asinh();
    // Behind a cubic spline the next goes on in its direction where it names no first control point.
    let series = |second: &str| {
        let text = format!("G21 G90 G17 G0 X0 Y0 Z0\nG5 I0 J10 P-10 Q5 X30 Y0 F600\nG5 {second}P-5 Q5 X60 Y0\nM2");
        sums(&text, &control(LinuxCnc)).expect("splines").feed
    };
    close("series", series(""), series("I10 J-5 "));
    assert!(refused(LinuxCnc, "G21 G90 G17 G0 X0 Y0\nG5 P-5 Q5 X60 Y0 F600\nM2").message.contains("first of a series"));
    let again = "G21 G90 G17 G0 X0 Y0\nG5 I0 J10 P-10 Q5 X30 Y0 F600\nG1 X40\nG5 P-5 Q5 X60 Y0\nM2";
    assert_eq!(refused(LinuxCnc, again).line, 4);
    let found = sums("G21 G90 G17 G0 X-1 Y1 Z0\nG5.1 X1 Y1 I1 J-2 F60\nM2", &control(LinuxCnc)).expect("a spline");
    assert!((found.length - length).abs() < 1e-6, "{}", found.length);
}

#[test]
fn klartext_programs_do_what_their_words_say() {
    use Dialect::Heidenhain;
    let program = |body: &str| {
        format!("0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S1000 F600\n2 L X+0 Y+0 Z+0 R0 FMAX M3\n{body}\n99 END PGM A MM")
    };
    let tau = std::f64::consts::TAU;
    let does = |body: &str, feed: f64, rapid: f64, dwell: f64, end: [f64; 3]| {
        does(Heidenhain, &program(body), (feed, rapid, dwell, end))
    };
    does("L X+10 F600\nRND R2\nL Y+10", (16.0 + 0.25 * tau * 2.0) / 10.0, 0.2, 0.0, [10.0, 10.0, 0.0]);
    does("L X+10 F600\nCHF 2\nL Y+10", (16.0 + 8.0_f64.sqrt()) / 10.0, 0.2, 0.0, [10.0, 10.0, 0.0]);
    does("CC X+10 Y+0\nCP IPA+720 IZ-4 DR+ F600", (2.0 * tau * 10.0).hypot(4.0) / 10.0, 0.2, 0.0, [0.0, 0.0, -4.0]);
    does("LBL 1\nL IX+10 F600\nCALL LBL 1 REP 2", 3.0, 0.2, 0.0, [30.0, 0.0, 0.0]);
    // LBL 0 ends a subprogram, not a repeat.
    does("LBL 1\nL IX+10 F600\nLBL 0\nCALL LBL 1 REP 2", 3.0, 0.2, 0.0, [30.0, 0.0, 0.0]);
    does(
        "CALL LBL 5\nL Z+0 FMAX M30\nLBL 5\nLBL 1\nL IX+10 F600\nCALL LBL 1 REP 2\nLBL 0",
        3.0,
        0.2,
        0.0,
        [30.0, 0.0, 0.0],
    );
    does("CALL LBL 5\nCALL LBL 5\nL Z+0 FMAX M30\nLBL 5\nL IY+5 F300\nLBL 0", 2.0, 0.2, 0.0, [0.0, 10.0, 0.0]);
    does(
        "Q1 = 2 * ( 3 + 2 )\nLBL 1\nL IX+Q1 F600\nFN 2: Q1 = +Q1 - +5\nFN 11: IF +Q1 GT +0 GOTO LBL 1",
        1.5,
        0.2,
        0.0,
        [15.0, 0.0, 0.0],
    );
    does(
        "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+5\nCYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 1.5\nL X+5 F600",
        1.0,
        0.2,
        1.5,
        [10.0, 0.0, 0.0],
    );
    // Down 8 mm in pecks of 5 from 2 above: 7 + .2 + 3 mm.
    let cycle = "CYCL DEF 200 DRILLING Q200=2 Q201=-8 Q206=60 Q202=5 Q210=0 Q203=0 Q204=2 Q211=0\nL X+10 FMAX M99";
    does(cycle, 10.2, 0.2 + (10.0 + 2.0 + 7.0 + 6.8 + 10.0) / 500.0, 0.0, [10.0, 0.0, 2.0]);
}

#[test]
fn lathes_turn_diameters_at_constant_surface_speed() {
    let text = "G21 G18 G99\nG50 S3000\nG96 S200 M3\nG0 X60. Z0\nG1 X0 F0.2\nG0 Z5.";
    let found = sums(text, &control(Dialect::FanucLathe)).expect("a program");
    close("facing", found.feed, 4.771667);
    close("length", found.length, 30.0);
    let box_cycle = "G21 G99 G97 S600 M3\nG0 X50. Z2.\nG90 X46. Z-18. F0.2\nG0 X60.";
    // 20 mm at 120 mm/min, and 2 mm out at feed.
    close("box", sums(box_cycle, &control(Dialect::FanucLathe)).expect("a program").feed, 11.0);
}

#[test]
fn a_letter_within_the_name_of_a_function_is_no_word_of_a_lathe() {
    let text = "G21 G90\nG0 X0 Y0\nG1 X[ROUND[2.5]] F100\nX[FUP[3.2]]\nM30";
    let found = sums(text, &Control { dialect: None, ..control(Dialect::Fanuc) }).expect("a program of a mill");
    close("length", found.length, 4.0);
}

#[test]
fn the_comment_of_a_mill_is_no_word_of_another_control() {
    let auto = || Control { dialect: None, ..control(Dialect::Fanuc) };
    for comment in ["T5 M6 (D=20. CR=0. FLAT END MILL)", "N4 (T5 D=20. CR=0.)", "M1 (R1=5)", "M1 (CYCLE81)"] {
        let text = format!("G21 G90\n{comment}\nG0 X0 Y0\nG1 X[ROUND[2.5]] F100\nM30");
        close(comment, sums(&text, &auto()).expect("a program of a mill").length, 3.0);
    }
    // A condition of Siemens has its words outside of the brackets.
    let siemens = "G71 G90\nG0 X0 Y0\nIF (1 == 2) GOTOF END\nG1 X10 F100\nEND: M30";
    close("Siemens", sums(siemens, &auto()).expect("a program").length, 10.0);
}

#[test]
fn a_feed_on_the_axis_at_constant_surface_speed_needs_a_greatest_speed() {
    let text = "G21 G18 G99\nG96 S200 M3\nG0 X0. Z2.\nG1 Z-2. F.1\nM30";
    let error = sums(text, &control(Dialect::FanucLathe)).expect_err("refused").message;
    assert!(error.contains("G50 S"), "{error}");
    let clamped = text.replace("G96", "G50 S3000\nG96");
    close("clamped", sums(&clamped, &control(Dialect::FanucLathe)).expect("a program").feed, 0.8);
}

#[test]
fn a_dwell_counts_milliseconds_where_numbers_count_least_increments() {
    let mut control = control(Dialect::Fanuc);
    let dwell =
        |control: &Control, text: &str| sums(&format!("G21 G90\nG0 X1.\nG4 {text}\nM30"), control).expect("one").dwell;
    assert_eq!((dwell(&control, "X2000"), dwell(&control, "X2.")), (2000.0, 2.0));
    control.least_increment = true;
    assert_eq!((dwell(&control, "X2000"), dwell(&control, "X2."), dwell(&control, "P2000")), (2.0, 2.0, 2.0));
}

#[test]
fn the_centre_of_the_cutter_runs_beside_the_contour() {
    let mut control = control(Dialect::LinuxCnc);
    control.diameters.insert(1, 10.0);
    let square =
        "G21 G90 G17\nG0 X-20 Y-20 Z0\nG1 F600\nG41 D1 X0 Y-20\nX0 Y0\nY40\nX40\nY0\nX-20\nG40 G1 X-20 Y-20\nM2";
    let found = sums(square, &control).expect("a program");
    // In, along five sides at 5 mm from the square, three quarters about its corners, out.
    close("square", found.length, 15.0 + 60.0 + 40.0 + 40.0 + 60.0 + 15.0 + 7.5 * std::f64::consts::PI);
    // Inside a square of 40 mm a cutter of 10 mm runs along one of 30 mm.
    let inside = "G21 G90 G17\nG0 X20 Y20 Z0\nG1 F600\nG41 D1 X20 Y0\nX40\nY40\nX0\nY0\nX20\nG40 X20 Y20\nM2";
    let found = sums(inside, &control).expect("a program");
    close("pocket", found.length, 15.0 + 4.0 * 30.0 + 15.0);
    let tight = "G21 G90 G17\nG0 X20 Y20 Z0\nG1 F600\nG41 D1 X20 Y0\nX40\nG3 X40 Y4 R2\nG1 X0\nG40 X20 Y20\nM2";
    assert!(sums(tight, &control).expect_err("too tight").message.contains("does not fit"));
}

#[test]
fn a_feed_at_the_contour_makes_the_centre_slower_on_arcs_inside_and_faster_outside() {
    let inside =
        "G21 G90 G17\nG0 X20. Y20.\nG41 D1 G1 X20. Y0 F300\nX32.\nG3 X40. Y8. R8.\nG1 Y20.\nG40 G1 X20. Y20.\nM30";
    let outside = inside.replace("G41", "G42");
    let time = |text: &str, at_contour: bool| {
        let mut control = control(Dialect::Fanuc);
        control.diameters.insert(1, 10.0);
        control.feed_at_contour = at_contour;
        sums(text, &control).expect("a program").feed
    };
    // The quarter of a circle of 8 mm at 300 mm/min takes as long at the contour as programmed; its centre runs on 3 mm and on 13 mm.
    let quarter = |radius: f64| 0.5 * std::f64::consts::PI * radius / 5.0;
    close("inside", time(inside, true) - time(inside, false), quarter(8.0) - quarter(3.0));
    close("outside", time(&outside, true) - time(&outside, false), quarter(8.0) - quarter(13.0));
}

#[test]
fn a_mirrored_contour_has_the_cutter_on_its_other_side_and_d_holds_until_another_one() {
    use Dialect::{Fanuc, Siemens};
    let contour = "G41 D1 G1 X0 Y-10. F500\nY40.\nX30.\nG1 X40. Y30.\nG1 Y0\nX-10.\nG40 G1 X-20. Y-20.\n";
    let length = |dialect: Dialect, text: String| {
        let mut control = control(dialect);
        control.diameters.insert(1, 10.0);
        control.diameters.insert(2, 20.0);
        sums(&text, &control).expect("a program").length
    };
    let plain = length(Fanuc, format!("G21 G90 G17\nG0 X-20. Y-20.\n{contour}M30"));
    let mirrored = format!("G21 G90 G17\nG51.1 X0\nG0 X-20. Y-20.\n{contour}G50.1 X0\nM30");
    close("mirrored", length(Fanuc, mirrored), plain);
    let siemens = |mirror: &str| {
        let contour = contour.replace(" D1", "");
        format!("G71 G90 G17\nT1 D1\n{mirror}G0 X-20 Y-20\n{contour}M30")
    };
    close("MIRROR", length(Siemens, siemens("MIRROR X0\n")), length(Siemens, siemens("")));
    let twice = |second: &str| {
        let again = contour.replace(" D1", second);
        format!("G21 G90 G17\nT2 M6\nG0 X-20. Y-20.\n{contour}{again}M30")
    };
    close("D holds", length(Fanuc, twice("")), length(Fanuc, twice(" D1")));
}

#[test]
fn behind_a_contour_a_block_that_names_its_end_leads_the_centre_there() {
    use Dialect::{Fanuc, Heidenhain};
    let g40 = "G21 G90 G17\nG0 X-20. Y-20. Z0\nG41 D1 G1 X0 Y-10. F600\nY40.\nX40.\nG40\nG1 X40. Y40.\nG0 Z100.\nM30";
    let klartext = "0 BEGIN PGM D MM\n1 TOOL CALL 1 Z S1000\n2 L X-40 Y-10 R0 FMAX\n3 L Z+0 FMAX\n4 APPR LT X+0 Y+20 LEN15 RL F600\n\
        5 L X+0 Y+60\n6 L X+60 Y+60\n7 DEP LT LEN15\n8 L X+75 Y+60 R0 F600\n9 L Z+50 FMAX\n10 END PGM D MM";
    for (dialect, text, block) in [(Fanuc, g40, "G1 X40. Y40.\n"), (Heidenhain, klartext, "8 L X+75 Y+60 R0 F600\n")] {
        let mut control = control(dialect);
        control.diameters.insert(1, 10.0);
        let feed = |text: &str| sums(text, &control).expect("a program").feed;
        // The radius of 5 mm at 600 mm/min.
        close("the way back", feed(text) - feed(&text.replace(block, "")), 0.5);
    }
}

#[test]
fn whatever_is_not_understood_is_refused_with_its_place() {
    use Dialect::{Fanuc, Haas, Heidenhain, LinuxCnc, Siemens};
    for (dialect, text, line, word) in [
        (Fanuc, "G21 G90\nG0 X0 Y0\nG411 X1.", 3, "G411"),
        (Fanuc, "G21 G0 X0\nM98 P4711", 2, "P4711: no such program"),
        (Fanuc, "G21\nN1 G0 X1.\nGOTO 1", 3, "step limit"),
        (Fanuc, "G21 G0 X0\nG1 X10. F#5", 2, "#5 is vacant"),
        (Fanuc, "G0 X5.", 1, "--units mm"),
        (Fanuc, "G21 G0 X0\nG1 X1. F9 Q4", 2, "Q4"),
        (Fanuc, "G21 G0 X0\nG1 X1. F9\nX2. X3.", 3, "twice"),
        (Fanuc, "G21 G0 X0\nG2 X9. Y2. I0 J1. F9", 2, "misses its end"),
        (Fanuc, "G21 G0 X0\nTRANS X10", 2, "TRANS"),
        (Haas, "G21 G0 X0\nG150 X1.", 2, "pocket"),
        (Haas, "G21 G0 X0\nM97 P5", 2, "N5"),
        (LinuxCnc, "G21 G0 X0\nG38.2 X1 F9", 2, "touches"),
        (LinuxCnc, "G21 G0 X0\no1 while [1]\no1 endwhile", 3, "step limit"),
        (Siemens, "G71 G0 X0\nPOCKET3(1,2)", 2, "POCKET3"),
        (Siemens, "G71 G0 X0\nCYCLE800(1,\"X\",0,57)", 2, "CYCLE800 with a text"),
        (Siemens, "G71 G0 X0\nG1 X1 F9 FRC=2", 2, "FRC"),
        (Siemens, "G71 G0 X0\nG4 S10", 2, "no speed"),
        (Heidenhain, "BEGIN PGM A MM\nL X+1 FMAX\nFK X+1", 3, "FK"),
        (Heidenhain, "BEGIN PGM A MM\nL X+1 FMAX\nPLANE SPATIAL SPA+1", 3, "tilted"),
        (Heidenhain, "BEGIN PGM A MM\nTOOL CALL 1 Z S9\nL X+1", 3, "no feed"),
    ] {
        let error = refused(dialect, text);
        assert_eq!(error.line, line, "{text}: {error}");
        assert!(error.message.contains(word), "{text}: {error}");
        assert!(error.to_string().contains(&format!(": {}: ", dialect.name())), "{error}");
    }
}

mod shared {
    use super::*;
    use std::path::PathBuf;

    /// Folder of data that are not part of the project.
    #[allow(clippy::print_stdout)] // a skipped test says why
    fn data(name: &str) -> Option<PathBuf> {
        let folder =
            std::env::var_os("TOOLROOM_DATA").map_or_else(|| PathBuf::from("../../../shared/data"), PathBuf::from);
        let path = folder.join(name);
        if !path.exists() {
            println!("skipped: {} is not there; set TOOLROOM_DATA to the folder of the measured data", path.display());
            return None;
        }
        path.canonicalize().ok()
    }

    #[test]
    fn operations_of_the_nist_box_are_read() {
        for operation in [1, 2, 3, 5] {
            let Some(path) = data(&format!("nist-box/box-op{operation}.nc")) else { return };
            let text = std::fs::read_to_string(path).expect("readable");
            let found =
                sums(&text, &Control::default()).unwrap_or_else(|error| panic!("operation {operation}: {error}"));
            assert!(found.feed > 10.0, "{found:?}");
        }
    }
}

mod fuzz {
    use super::*;
    use proptest::prelude::*;

    const WORDS: [&str; 107] = [
        "G0",
        "G1",
        "G2",
        "G3",
        "X10",
        "Y-5",
        "Z3.",
        "I5",
        "J0",
        "R7",
        "F100",
        "G91",
        "G90",
        "G81",
        "G83",
        "Q2",
        "R1",
        "K3",
        "L2",
        "G80",
        "M98",
        "P10",
        "O10",
        "M99",
        "M30",
        "#1=3",
        "#1=#1+1",
        "IF[#1LT3]GOTO1",
        "N1",
        "GOTO1",
        "WHILE[#1LT5]DO1",
        "END1",
        "G41",
        "D1",
        "G40",
        "G68",
        "R30",
        "G69",
        "G16",
        "G15",
        "o1 sub",
        "o1 endsub",
        "o1 call [1]",
        "o2 while [#1 LT 4]",
        "o2 endwhile",
        "o2 if [1]",
        "o2 else",
        "o2 endif",
        "R1=2",
        "FOR R1=1 TO 4",
        "ENDFOR",
        "LOOP",
        "ENDLOOP",
        "TRANS X5",
        "CR=5",
        "CYCLE82(10,0,2,-3,,0.5)",
        "LBL 1",
        "CALL LBL 1 REP 2",
        "L X+1 FMAX",
        "CC X+1 Y+1",
        "C X+2 DR+",
        "RND R1",
        "CYCL DEF 200 Q200=2",
        "M99",
        "Q1 = 3",
        "G71 U2 R1",
        "G71 P1 Q1 U1 W0.5",
        "G70 P1 Q2",
        "G75 R0.5",
        "G75 X4 Z-3 P2000 Q3000",
        "G76 P010060 Q100 R0.1",
        "G76 X6 Z-9 P900 Q400",
        "N2",
        "G71 P1 Q2 U0.5 W0.1 D1000 F0.2",
        "N1 G0 X4 Z2",
        "N2 G1 X9 Z-9",
        "G72 W1 R0.5",
        "G83 Z-5 R-2 Q1000 F9",
        "G87 X4 R-2 F9",
        "G89 W-3 P500 K2",
        "C90",
        "H45",
        "G80",
        "PROC A(REAL B, INT C=2) SAVE",
        "DEF REAL _D=3",
        "A(1,2)",
        "MCALL A(1)",
        "MCALL",
        "M17",
        "X=_D",
        "CYCLE83(10,0,2,-9,,-3,,1,0.5,0.2,0.5,1)",
        "CYCL DEF 203 Q200=2 Q201=-9 Q202=2 Q206=99 Q213=1 Q208= MAX",
        "CYCL DEF 209 Q200=2 Q201=-9 Q239=1 Q257=3 Q256=1",
        "L M140 MB MAX",
        "M140 MB5 F9",
        "PLANE RESET STAY",
        "APPR LCT X+1 Y+2 R3 RL F9",
        "APPR LT X+1 Y+2 LEN3 RR F9",
        "DEP CT CCA90 R+5",
        "DEP LN LEN5",
        "TOOL CALL 1 Z S100 F99",
        "CYCL DEF 247 Q339=1",
        "(",
        ")",
        "~",
        "\n",
        "\n",
    ];

    fn run(dialect: Dialect, text: &str) {
        let mut settings = control(dialect);
        settings.steps = 2000;
        settings.units = Some(toolroom_program::Units::Millimetre);
        settings.diameters.insert(1, 4.0);
        // Names that stand twice are refused before anything runs.
        let Ok(mut run) = Run::new(text, &settings) else { return };
        let mut events = 0_u64;
        for event in run.by_ref() {
            events += 1;
            if let Ok(event) = event
                && let EventKind::Motion(motion) = event.kind
            {
                assert!(
                    motion.time.is_finite() && motion.time >= 0.0 && motion.length.is_finite(),
                    "{text}: {motion:?}"
                );
            }
            if events > 1_000_000 {
                break;
            }
        }
    }

    fn dialect() -> impl Strategy<Value = Dialect> {
        (0..6_usize).prop_map(|index| Dialect::named(Dialect::NAMES[index]).expect("a name"))
    }

    proptest! {
        #[test]
        fn any_text_ends_without_panic(dialect in dialect(), text in "[A-Z0-9#.=\\[\\]()+* \\n<>:,;/%\"~-]{0,120}") {
            run(dialect, &text);
        }

        #[test]
        fn any_words_end_without_panic(
            dialect in dialect(),
            words in prop::collection::vec((0..WORDS.len(), any::<bool>()), 0..40),
        ) {
            let text: String =
                words.into_iter().map(|(index, ends)| format!("{}{}", WORDS[index], if ends { "\n" } else { " " })).collect();
            run(dialect, &text);
        }
    }

    /// Greatest memory that this process has had, MB; `None` where the system does not tell.
    fn peak_memory() -> Option<f64> {
        let status = std::fs::read_to_string("/proc/self/status").ok()?;
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
        line.split_whitespace().next()?.parse::<f64>().ok().map(|kilobytes| kilobytes / 1024.0)
    }

    /// A million inputs a language, some minutes: `cargo test -p toolroom-program --test controls -- --ignored million`. Each ends
    /// within ten seconds, and none takes more than 64 MB.
    #[test]
    #[ignore = "some minutes"]
    fn a_million_inputs_a_language_end_without_panic() {
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        let mut next = |count: usize| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state % count as u64) as usize
        };
        for name in Dialect::NAMES {
            let dialect = Dialect::named(name).expect("a name");
            for _ in 0..1_000_000 {
                let count = next(30);
                let text: String = (0..count)
                    .map(|_| format!("{}{}", WORDS[next(WORDS.len())], if next(2) == 0 { "\n" } else { " " }))
                    .collect();
                let begin = std::time::Instant::now();
                run(dialect, &text);
                assert!(begin.elapsed().as_secs() < 10, "{name}: {text}");
            }
            assert!(peak_memory().is_none_or(|peak| peak < 64.0), "{name}: {:?} MB", peak_memory());
        }
    }
}
