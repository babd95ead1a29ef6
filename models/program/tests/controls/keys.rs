//! Settings of controls, and words that depend on them.

use super::control;
use toolroom_program::{Control, Dialect, Program};

fn refused(text: &str, settings: &Control) -> String {
    Program::read(text, settings).expect_err(text).to_string()
}

/// Feed time of a program, s.
fn feed_time(text: &str, settings: &Control) -> f64 {
    let program = Program::read(text, settings).unwrap_or_else(|error| panic!("{error}\n{text}"));
    program.blocks.iter().map(toolroom_program::Block::feed_time).sum()
}

#[test]
fn names_that_stand_twice_are_refused_with_both_lines() {
    let fanuc = "%\nO1000\nG21 G90\nM98 P2000\nM30\nO2000\nG0 X1\nM99\nO2000\nG0 X2\nM99\n%\n";
    let told = refused(fanuc, &control(Dialect::Fanuc));
    assert!(told.starts_with("9:1:") && told.contains("O2000 stands in line 6 and again in line 9"), "{told}");
    let klartext = "BEGIN PGM A MM\nLBL 1\nL X+0 FMAX\nLBL 0\nLBL 1\nL X+1 FMAX\nLBL 0\nEND PGM A MM\n";
    let told = refused(klartext, &control(Dialect::Heidenhain));
    assert!(told.starts_with("5:1:") && told.contains("LBL 1 stands in line 2 and again in line 5"), "{told}");
}

#[test]
fn the_letter_of_the_turns_of_a_helix_is_a_setting() {
    let helix = |letter: char| format!("G21 G90 G17\nG0 X0 Y0 Z5\nG2 X0 Y0 Z-4 I5 J0 {letter}3 F100\nM30\n");
    let mut settings = control(Dialect::Fanuc);
    // Three turns of radius 5 and 9 mm down at 100 mm/min.
    let time = 0.6 * (3.0 * std::f64::consts::TAU * 5.0_f64).hypot(9.0);
    assert!((feed_time(&helix('L'), &settings) - time).abs() < 1e-9);
    settings.set("turns", "P").expect("a letter");
    assert!((feed_time(&helix('P'), &settings) - time).abs() < 1e-9);
    assert!(refused(&helix('L'), &settings).contains('L'));
}

#[test]
fn an_arc_goes_on_in_the_direction_of_the_last_motion_in_a_mirror_too() {
    let arc = "G0 X0 Y0 Z5\nG1 X10 Y0 F100\nCT X20 Y10\n";
    let time = feed_time(&format!("G71 G90 G17\n{arc}M30\n"), &control(Dialect::Siemens));
    // A line of 10 mm and a quarter of radius 10.
    assert!((time - 0.6 * (10.0 + 2.5 * std::f64::consts::TAU)).abs() < 1e-9);
    for frame in ["MIRROR X0", "ROT Z30", "MIRROR Y0\nAROT Z-20"] {
        let turned = feed_time(&format!("G71 G90 G17\n{frame}\n{arc}M30\n"), &control(Dialect::Siemens));
        assert!((turned - time).abs() < 1e-9, "{frame}: {turned}");
    }
}

#[test]
fn constant_surface_speed_of_linuxcnc_is_the_integral_over_the_radius() {
    let text = "G21 G90 G18 G95\nG96 D2000 S100 M3\nG0 X10 Z0\nG1 X20 F0.1\nM2\n";
    // X is a radius: 100 m/min at 10 mm are 1592 rpm, below 2000. t = π(20² − 10²)/(f·v).
    let time = 60.0 * std::f64::consts::PI * 300.0 / (0.1 * 1e5);
    assert!((feed_time(text, &control(Dialect::LinuxCnc)) - time).abs() < 1e-9);
    // Below 2000 rpm's radius the greatest speed acts.
    let inner = "G21 G90 G18 G95\nG96 D2000 S100 M3\nG0 X2 Z0\nG1 X4 F0.1\nM2\n";
    assert!((feed_time(inner, &control(Dialect::LinuxCnc)) - 60.0 * 2.0 / (0.1 * 2000.0)).abs() < 1e-9);
}

#[test]
fn a_pattern_of_haas_may_stand_in_the_block_of_its_cycle() {
    let apart = "G21 G90 G17\nG0 X0 Y0 Z5\nG83 Z-5 R1 Q2 F100 L0\nG70 I20 J0 L4\nG80\nM30\n";
    let together = "G21 G90 G17\nG0 X0 Y0 Z5\nG83 G70 I20 J0 L4 Z-5 R1 Q2 F100\nG80\nM30\n";
    let read = |text: &str| Program::read(text, &control(Dialect::Haas)).unwrap_or_else(|error| panic!("{error}"));
    let (one, two) = (read(apart), read(together));
    let motions = |program: &Program| program.blocks.iter().flat_map(|block| block.motions.clone()).collect::<Vec<_>>();
    assert!(motions(&one) == motions(&two));
    assert_eq!(two.blocks.iter().map(|block| block.holes).sum::<u32>(), 4);
}

#[test]
fn a_program_of_dwells_alone_has_its_time() {
    for (dialect, text) in [
        (Dialect::Fanuc, "G4 P1000\nG4 X2.\nM30\n"),
        (Dialect::Siemens, "G4 F1\nG4 F2\nM30\n"),
        (Dialect::LinuxCnc, "G4 P3\nM2\n"),
    ] {
        let program = Program::read(text, &control(dialect)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(program.blocks.iter().map(|block| block.dwell).sum::<f64>(), 3.0, "{text}");
    }
    assert!(refused("M3 S100\nM30\n", &control(Dialect::Fanuc)).contains("moves no axis"));
}

#[test]
fn values_that_the_program_decides_are_read_by_fn_18() {
    let text = "BEGIN PGM A MM\nTOOL CALL 7 Z S1500\nL X+12 Y+3 Z+5 R0 FMAX M3\nFN 18: SYSREAD Q1 = ID20 NR1\n\
                FN 18: SYSREAD Q2 = ID20 NR4\nFN 18: SYSREAD Q3 = ID270 NR1 IDX1\nQ4 = Q1 + Q2 / 100 + Q3\nL X+Q4 F600\nEND PGM A MM\n";
    // 7 + 15 + 12 = 34: 22 mm at 10 mm/s.
    assert!((feed_time(text, &control(Dialect::Heidenhain)) - 2.2).abs() < 1e-9);
    let other = text.replace("ID20 NR4", "ID502 NR4");
    assert!(refused(&other, &control(Dialect::Heidenhain)).contains("ID502 NR4 is not known"));
}

#[test]
fn compensation_by_type_b_goes_around_an_outer_corner() {
    let text = "G21 G90 G17\nG0 X0 Y0 Z0\nG41 D1 G1 X20 Y0 F600\nX20 Y-30\nG40 X0 Y-30\nM30\n";
    let mut settings = control(Dialect::Haas);
    settings.diameters.insert(1, 10.0);
    // Straight to (25, 0) and back from (25, -30).
    let a = (2.0 * 25.0 + 30.0) / 10.0;
    assert!((feed_time(text, &settings) - a).abs() < 1e-9, "{}", feed_time(text, &settings));
    settings.set("startup", "B").expect("a type");
    // To (20, 5), a quarter of radius 5, along, a quarter, and from (20, -35).
    let b = (2.0 * 20.0_f64.hypot(5.0) + 30.0 + 2.0 * 2.5 * std::f64::consts::PI) / 10.0;
    assert!((feed_time(text, &settings) - b).abs() < 1e-9, "{} {b}", feed_time(text, &settings));
}

#[test]
fn a_mirrored_contour_scaled_by_axis_has_the_cutter_on_its_other_side() {
    // Mirrored in X and doubled in Y: the side of the cutter is the other one.
    let scaled =
        "G21 G90 G17\nG0 X0 Y0 Z0\nG51 X0 Y0 Z0 I-1. J2. K1.\nG41 D1 G1 X10 Y0 F600\nX10 Y20\nX30\nG40 X30 Y40\nM30\n";
    let plain = "G21 G90 G17\nG0 X0 Y0 Z0\nG42 D1 G1 X-10 Y0 F600\nX-10 Y40\nX-30\nG40 X-30 Y80\nM30\n";
    let mut settings = control(Dialect::Fanuc);
    settings.diameters.insert(1, 6.0);
    let ends = |text: &str| -> Vec<[f64; 2]> {
        let program = Program::read(text, &settings).unwrap_or_else(|error| panic!("{error}\n{text}"));
        program.blocks.iter().flat_map(|block| &block.motions).map(|motion| [motion.end[0], motion.end[1]]).collect()
    };
    let (one, two) = (ends(scaled), ends(plain));
    assert_eq!(one.len(), two.len());
    for (a, b) in one.iter().zip(&two) {
        assert!((a[0] - b[0]).abs() < 1e-9 && (a[1] - b[1]).abs() < 1e-9, "{one:?} {two:?}");
    }
}
