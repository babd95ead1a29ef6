//! What a post writes reads back to the same motions.

use proptest::prelude::*;
use toolroom_post::post;
use toolroom_program::{Control, Dialect, EventKind, Motion, Run, Units};

const TARGETS: [Dialect; 5] = [Dialect::Fanuc, Dialect::Haas, Dialect::Siemens, Dialect::Heidenhain, Dialect::LinuxCnc];

fn control(dialect: Dialect) -> Control {
    let mut control = Control::of(dialect);
    control.start = [Some(0.0); 9];
    control.units = Some(Units::Millimetre);
    control
}

/// Motions that go anywhere, and the time of all dwells.
fn motions(text: &str, control: &Control) -> (Vec<Motion>, f64) {
    let mut list = Vec::new();
    let mut dwell = 0.0;
    for event in Run::new(text, control).unwrap_or_else(|error| panic!("{error}\n{text}")) {
        match event.unwrap_or_else(|error| panic!("{error}\n{text}")).kind {
            EventKind::Motion(motion) => list.push(motion),
            EventKind::Dwell(seconds) => dwell += seconds,
            _ => {}
        }
    }
    (list, dwell)
}

fn comes_back(text: &str, source: &Control) {
    let (original, dwell) = motions(text, source);
    for target in TARGETS {
        let written = post(text, source, target).unwrap_or_else(|error| panic!("{error}\n{text}")).text;
        let (read, dwelt) = motions(&written, &control(target));
        assert_eq!(original.len(), read.len(), "{}\n{text}\n{written}", target.name());
        assert!((dwell - dwelt).abs() < 1e-5, "{dwell} {dwelt}");
        for (a, b) in original.iter().zip(&read) {
            for axis in 0..6 {
                let gap = (a.end[axis] - b.end[axis]).abs();
                // Half a unit of the fourth decimal; the end of a helix in Klartext follows from its rounded pole.
                let most = if target == Dialect::Heidenhain { 2e-4 } else { 0.6e-4 };
                assert!(gap < most, "{} axis {axis}: {gap}\n{a:?}\n{b:?}\n{written}", target.name());
            }
            assert_eq!(a.rapid, b.rapid);
            // Short motions differ by the rounding of their ends.
            let slack = 1e-4 * a.time + 4e-4 * a.time / a.length.max(1e-9);
            assert!(
                (a.time - b.time).abs() <= slack,
                "{}: {} {}\n{a:?}\n{b:?}\n{written}",
                target.name(),
                a.time,
                b.time
            );
        }
    }
}

#[test]
fn cycles_calls_and_frames_are_worked_out_and_come_back() {
    let text = "%\nO1\nG21 G90 G94 G98\nT3 M6\nS1200 M3\nG0 X0 Y0 Z20.\nM8\nG81 X10. Y5. Z-12. R2. F120\nX20.\nG80\nG68 X0 Y0 R30.\n\
        G0 X0 Y-10.\nG1 X30. F300\nG3 X40. Y0 I0 J10.\nG69\nM98 P2 L2\nG4 X0.5\nM9\nM5\nM30\nO2\nG91 G1 X1.5 F200\nG90\nM99\n%";
    comes_back(text, &control(Dialect::Fanuc));
}

#[derive(Clone, Debug)]
enum Step {
    Rapid([f64; 3]),
    Line([f64; 3]),
    Arc { radius: f64, start: f64, sweep: f64, left: bool, rise: f64, turns: u32 },
    Dwell(f64),
}

fn step() -> impl Strategy<Value = Step> {
    let place = || prop::array::uniform3(-80.0..80.0_f64);
    prop_oneof![
        place().prop_map(Step::Rapid),
        place().prop_map(Step::Line),
        (1.0..40.0_f64, 0.0..6.2_f64, 0.2..6.0_f64, any::<bool>(), -5.0..5.0_f64, 0..3_u32).prop_map(
            |(radius, start, sweep, left, rise, turns)| Step::Arc { radius, start, sweep, left, rise, turns }
        ),
        (0.01..3.0_f64).prop_map(Step::Dwell),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn random_paths_come_back_from_every_post(steps in prop::collection::vec(step(), 1..25), feed in 20.0..5000.0_f64) {
        let mut text = format!("G21 G17 G90 G94\nG0 X1 Y1 Z1\nF{feed:.3}\n");
        let mut position = [1.0, 1.0, 1.0];
        for step in steps {
            match step {
                Step::Rapid(to) => {
                    text += &format!("G0 X{:.6} Y{:.6} Z{:.6}\n", to[0], to[1], to[2]);
                    position = to;
                }
                Step::Line(to) => {
                    text += &format!("G1 X{:.6} Y{:.6} Z{:.6}\n", to[0], to[1], to[2]);
                    position = to;
                }
                Step::Arc { radius, start, sweep, left, rise, turns } => {
                    let (i, j) = (-radius * start.cos(), -radius * start.sin());
                    let angle = start + if left { sweep } else { -sweep };
                    position = [position[0] + i + radius * angle.cos(), position[1] + j + radius * angle.sin(), position[2] + rise];
                    let code = if left { "G3" } else { "G2" };
                    text += &format!("{code} X{:.6} Y{:.6} Z{:.6} I{i:.6} J{j:.6} P{}\n", position[0], position[1], position[2], turns + 1);
                }
                Step::Dwell(seconds) => text += &format!("G4 P{seconds:.4}\n"),
            }
        }
        comes_back(&text, &control(Dialect::LinuxCnc));
    }
}

#[test]
fn an_axis_whose_place_is_not_known_is_sent_nowhere() {
    let text = "G21 G90\nT1 M6\nG54 G0 X10. Y0 S3000 M3\nG43 H1 Z5. M8\nG1 Z-1. F100\nX20.\nG91 G28 Z0.\nG90\nM30\n";
    for dialect in [Dialect::Fanuc, Dialect::Haas, Dialect::Siemens, Dialect::Heidenhain, Dialect::LinuxCnc] {
        let written = post(text, &Control::default(), dialect).expect("a program").text;
        let approach = written.lines().find(|line| line.contains("X10") || line.contains("X+10")).expect("an approach");
        assert!(!approach.contains('Z') && approach.contains('Y'), "{approach}\n{written}");
        for word in match dialect {
            Dialect::Siemens => ["SUPA G0 Z0 D0", "D1", "; TOOL 1"],
            Dialect::Heidenhain => ["L Z+0 R0 FMAX M91", "TOOL CALL 1", "; TOOL 1"],
            Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas => ["G91 G28 Z0.", "G43 H1", "(TOOL 1)"],
            Dialect::LinuxCnc => ["G91 G28 Z0", "G43 H1", "(TOOL 1)"],
        } {
            assert!(written.contains(word), "{word} in\n{written}");
        }
    }
}

#[test]
fn axes_are_named_anew_in_another_work_offset_and_none_is_sent_to_a_place_of_the_one_before() {
    let text = "G21 G90 G54 G0 X-8. Y10.\nZ5.\nG1 X68. F400\nG55 G0 X-8. Y10.\nZ5.\nG1 X68.\nM30\n";
    for (target, words) in [
        (Dialect::Fanuc, "G55\nG0 X-8. Y10.\nG0 Z5.\nG1 X68.\n"),
        (Dialect::Haas, "G55\nG0 X-8. Y10.\nG0 Z5.\nG1 X68.\n"),
        (Dialect::Siemens, "G55\nG0 X-8 Y10\nG0 Z5\nG1 X68\n"),
        (Dialect::LinuxCnc, "G55\nG0 X-8 Y10\nG0 Z5\nG1 X68\n"),
    ] {
        let written = post(text, &Control::default(), target).expect("a program").text;
        assert!(written.contains(words), "{written}");
    }
    // Klartext has no word for it; where both lie to each other it needs none, nor does any other language.
    let error = post(text, &Control::default(), Dialect::Heidenhain).expect_err("no word");
    assert!(error.line == 4 && error.message.contains("control.offset.G55"), "{error}");
    let mut known = Control::default();
    known.set("offset.G55", "100,0,-3 mm").expect("a place");
    for target in TARGETS {
        let written = post(text, &known, target).expect("a program").text;
        assert!(!written.contains("G55"), "{written}");
        let (before, after) = (motions(text, &known).0, motions(&written, &control(target)).0);
        let ends = |list: &[Motion]| list.last().map(|motion| motion.end);
        assert_eq!(ends(&before), ends(&after), "{written}");
        assert_eq!(ends(&before).map(|end| [end[0], end[1], end[2]]), Some([168.0, 10.0, 2.0]));
    }
    // Both set by the program, neither known to the first: places go on counting in the one that was in force.
    let set = "G21 G90 G10 L2 P2 X100. Y0. Z0.\nG10 L2 P3 X200. Y0. Z0.\nG55 G0 X0. Y0.\nZ5.\nG1 Z-1. F100\nG0 Z5.\nG56 X0.\nM30\n";
    let written = post(set, &Control::default(), Dialect::Fanuc).expect("a program").text;
    assert!(written.contains("G55\n") && !written.contains("G56") && written.contains("G0 X100."), "{written}");
    // Words of offsets that not every control has.
    let many = text.replace("G55", "G54.1 P3");
    let fanuc = Control::of(Dialect::Fanuc);
    assert!(post(many.as_str(), &fanuc, Dialect::Haas).expect("a program").text.contains("G54.1 P3\nG0 X-8. Y10."));
    assert!(post(many.as_str(), &fanuc, Dialect::Siemens).expect("a program").text.contains("G507\nG0 X-8 Y10"));
    assert_eq!(post(many.as_str(), &fanuc, Dialect::LinuxCnc).expect_err("no word").line, 4);
    // Of which only some axes are known it is neither one nor the other.
    let partly = text.replacen("G55", "G10 L2 P1 Z0\nG10 L2 P2 Z5.\nG55", 1);
    assert!(post(partly.as_str(), &fanuc, Dialect::Haas).expect_err("only Z").message.contains("only some axes"));
}

#[test]
fn corners_that_are_nearly_straight_on_are_no_full_circles() {
    // The path turns by a ten thousandth of a degree, and by a millionth: the arc about the corner is shorter than a digit.
    for turn in [2e-6_f64, 4e-8, 1e-7] {
        let text = format!("G21 G17 G90\nG1 X-20 Y0 F600\nG41 D1 X0 Y0\nX50 Y0\nX100 Y{}\nG40 X130 Y0", -50.0 * turn);
        let mut source = control(Dialect::LinuxCnc);
        source.diameters.insert(1, 10.0);
        let (motions, _) = motions(&text, &source);
        let length: f64 = motions.iter().map(|motion| motion.length).sum();
        assert!(length < 180.0, "{turn}: {length}");
        comes_back_but_for_the_shortest(&text, &source);
    }
}

/// The post of a program takes the time of the program.
fn comes_back_but_for_the_shortest(text: &str, source: &Control) {
    let time = |list: &[Motion]| list.iter().map(|motion| motion.time).sum::<f64>();
    let (original, _) = motions(text, source);
    for target in TARGETS {
        let written = post(text, source, target).expect("a post").text;
        let (read, _) = motions(&written, &control(target));
        assert!((time(&read) - time(&original)).abs() < 1e-4 * time(&original), "{}\n{written}", target.name());
    }
}

#[test]
fn a_step_from_a_place_that_only_the_machine_knows_is_not_posted() {
    // Behind another work offset, behind a reference point, and at the start of a program without its place.
    for (text, line) in
        [("G21 G90 G54 G0 X0 Y0 Z5\nG55\nG91 G1 X10 F500", 3), ("G21 G90 G54 G0 X0 Y0 Z5\nG91 G28 Z0\nG0 Z-50", 3)]
    {
        let error = post(text, &control(Dialect::Fanuc), Dialect::Siemens).expect_err(text);
        assert!(error.line == line && error.message.contains("name a place before it"), "{error}");
    }
    let mut nowhere = control(Dialect::Fanuc);
    nowhere.start = [None; 9];
    assert_eq!(post("G21 G91 G1 X10 F500", &nowhere, Dialect::Haas).expect_err("a step").line, 1);
    // To the reference point by steps of nothing, and on from a place that is named.
    let text = "G21 G90 G54 G0 X0 Y0 Z5\nG91 G28 Z0\nG90 G0 Z5\nG91 G1 X10 F500";
    assert!(post(text, &control(Dialect::Fanuc), Dialect::Siemens).is_ok());
}

#[test]
fn an_axis_that_comes_back_from_its_reference_point_is_written_before_the_others_go_on() {
    let text = "G21 G90 G54 G0 X0 Y0 Z5\nG91 G28 Z0\nG90\nT2 M6\nG0 X10 Y10\nG43 Z15 H2\nX50\nG1 Z-1 F600\nM30";
    for target in [Dialect::Fanuc, Dialect::Siemens, Dialect::Heidenhain] {
        let written = post(text, &control(Dialect::Fanuc), target).expect("a post").text;
        let lines: Vec<&str> = written.lines().collect();
        let place = |word: &str| {
            lines.iter().position(|line| line.contains(word)).unwrap_or_else(|| panic!("{word}: {written}"))
        };
        let letter = if target == Dialect::Heidenhain { "+" } else { "" };
        let (across, down) = (place(&format!("X{letter}50")), place(&format!("Z{letter}15")));
        let alone = !lines[down].contains(&format!("X{letter}")) && !lines[across].contains('Z');
        assert!(down < across && alone, "{written}");
    }
}

#[test]
fn an_arc_from_a_place_that_only_the_machine_knows_is_not_posted() {
    let unknown = Control { units: Some(Units::Millimetre), ..Control::of(Dialect::Fanuc) };
    // A full circle takes the same time anywhere, but nothing says where it is.
    let text = "G90 G0 X30\nG3 I10 J0 F100\nM30\n";
    for target in TARGETS {
        let error = post(text, &unknown, target).expect_err("no place").to_string();
        assert!(error.contains("2:") && error.contains("--start"), "{error}");
    }
    assert!(post(text, &control(Dialect::Fanuc), Dialect::Siemens).is_ok());
}

#[test]
fn a_path_is_drawn_as_lines_arcs_and_circles_of_its_layers() {
    let text = "G21 G90\nG0 X0 Y0 Z5\nG1 Z-1 F100\nX10\nG3 X10 Y20 J10\nG2 X10 Y20 I-5\nG3 X0 Y30 Z-3 I-10\nM30\n";
    let (list, _) = motions(text, &control(Dialect::Fanuc));
    let mut drawing = toolroom_post::Drawing::default();
    for motion in &list {
        drawing.motion(if motion.rapid { "rapid" } else { "Feed 1" }, motion);
    }
    let text = drawing.text();
    let count = |word: &str| text.lines().filter(|line| *line == word).count();
    // The helix of a quarter turn is a line a degree.
    assert_eq!((count("LINE"), count("ARC"), count("CIRCLE")), (3 + 90, 1, 1), "{text}");
    assert_eq!((count("RAPID"), count("FEED_1")), (2, 95), "{text}");
    // From 270° to 90° around (10, 10), at Z −1.
    assert!(text.contains(" 10\n10.0\n 20\n10.0\n 30\n-1.0\n 40\n10.0\n 50\n270.0\n 51\n90.0\n"), "{text}");
}

/// What keeps a tap in step with the spindle, in the words of each control.
const TAPS: [(Dialect, &str); 5] = [
    (Dialect::Fanuc, "G99 G84 Z-10. R5. F500\nG80"),
    (Dialect::Haas, "G99 G84 Z-10. R5. F500\nG80"),
    (Dialect::Siemens, "CYCLE84(5,5,0,-10,,0,3,,1.25,0,400,400)"),
    (Dialect::Heidenhain, "Q201=-15 ~\n  Q239=+1.25 ~\n  Q203=+5"),
    (Dialect::LinuxCnc, "G33.1 Z-10 K1.25"),
];

#[test]
fn a_tap_stays_in_step_with_the_spindle_and_comes_back() {
    let text = "%\nO1\nG21 G90 G94 G98\nS400 M3\nG0 X0 Y0 Z20.\nG84 X10. Z-10. R5. F500\nX20.\nG80\nM4\nG74 X50. Z-10. R5. F500\n\
                G80\nG0 Z50.\nG1 X60. F300\nM30\n%";
    comes_back(text, &control(Dialect::Fanuc));
    for (target, words) in TAPS {
        let written = post(text, &control(Dialect::Fanuc), target).expect("a program").text;
        // Two of the three have a thread to the right; LinuxCNC takes its hand from the spindle.
        let count = if target == Dialect::LinuxCnc { 3 } else { 2 };
        assert_eq!(written.matches(words).count(), count, "{written}");
        assert!(!written.contains("Z-10 F") && !written.contains("Z-10. F500\nM4"), "by feed alone: {written}");
    }
}

#[test]
fn a_tap_with_a_speed_of_its_own_keeps_its_pitch() {
    let text = "G71 G90 G94\nS800 M3\nG0 X0 Y0 Z20\nCYCLE84(20,0,5,-10,,0,3,,1.5,0,200,200)\nG0 Z50\nM30";
    let written = |target| post(text, &control(Dialect::Siemens), target);
    let fanuc = written(Dialect::Fanuc).expect("a program").text;
    assert!(fanuc.contains("S200\nG99 G84 Z-10. R5. F300\nG80\nS800"), "{fanuc}");
    assert!(written(Dialect::LinuxCnc).expect("a program").text.contains("S200\nG33.1 Z-10 K1.5\nS800"));
    assert!(written(Dialect::Siemens).expect("a program").text.contains("1.5,0,200,200)"));
    assert!(written(Dialect::Heidenhain).expect("a program").text.contains("TOOL CALL Z S200\nCYCL DEF 207"));
}

#[test]
fn a_thread_without_words_is_refused_with_its_line() {
    let text = "G21 G90\nS1200 M3\nG0 X0 Y0 Z5\nG33 Z-10 K1.25\nG0 Z5\nM2";
    let source = control(Dialect::LinuxCnc);
    let written = post(text, &source, Dialect::LinuxCnc).expect("a program").text;
    assert!(written.contains("G33 Z-10 K1.25"), "{written}");
    for target in [Dialect::Fanuc, Dialect::Haas, Dialect::Siemens, Dialect::Heidenhain] {
        let refused = post(text, &source, target).expect_err("no words").to_string();
        assert!(refused.contains("4") && refused.contains("turns of the spindle"), "{refused}");
    }
}

#[test]
fn a_tap_in_steps_is_one_tap_after_the_other() {
    let pecks = "%\nO1\nG21 G90 G94 G98\nS400 M3\nG0 X0 Y0 Z20.\nG84 X10. Z-10. R5. Q4. F500\nG80\nM30\n%";
    comes_back(pecks, &control(Dialect::Fanuc));
}
