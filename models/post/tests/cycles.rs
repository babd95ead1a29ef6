//! Holes that stay cycles read back to the motions that they were made of.

use proptest::prelude::*;
use toolroom_post::{Form, Post, post};
use toolroom_program::{Control, Dialect, EventKind, Run, Units};

const TARGETS: [Dialect; 5] = [Dialect::Fanuc, Dialect::Haas, Dialect::Siemens, Dialect::Heidenhain, Dialect::LinuxCnc];

fn control(dialect: Dialect) -> Control {
    let mut control = Control::of(dialect);
    control.start = [Some(0.0); 9];
    control.units = Some(Units::Millimetre);
    control
}

/// Ends and times of motions, and dwells, in their order; with the number of holes.
fn steps(text: &str, control: &Control) -> (Vec<([f64; 3], f64, bool)>, usize) {
    let (mut list, mut holes) = (Vec::new(), 0);
    for event in Run::new(text, control).unwrap_or_else(|error| panic!("{error}\n{text}")) {
        match event.unwrap_or_else(|error| panic!("{error}\n{text}")).kind {
            EventKind::Motion(motion) if motion.length > 0.0 => {
                list.push(([motion.end[0], motion.end[1], motion.end[2]], motion.time, motion.rapid));
            }
            EventKind::Dwell(seconds) => list.push(([0.0; 3], seconds, false)),
            EventKind::Hole => holes += 1,
            _ => {}
        }
    }
    (list, holes)
}

/// Writes a program with its cycles for a control and holds its motions against those of the source.
fn kept(text: &str, source: &Control, dialect: Dialect) -> Post {
    let (original, _) = steps(text, source);
    let written =
        post(text, source, Form { dialect, keep_cycles: true }).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let (read, holes) = steps(&written.text, &control(dialect));
    assert_eq!(holes, written.holes[0], "{}\n{}", dialect.name(), written.text);
    assert_eq!(original.len(), read.len(), "{}\n{text}\n{}", dialect.name(), written.text);
    for (a, b) in original.iter().zip(&read) {
        let near = (0..3).all(|axis| (a.0[axis] - b.0[axis]).abs() < 1.1e-4) && (a.1 - b.1).abs() < 1e-4 * a.1 + 1e-3;
        assert!(near && a.2 == b.2, "{}: {a:?} {b:?}\n{text}\n{}", dialect.name(), written.text);
    }
    written
}

#[test]
fn holes_stay_cycles_of_every_control() {
    let text = "%\nO1\nG21 G90 G94 G98\nT3 M6\nS1200 M3\nG0 X0 Y0 Z20.\nM8\nG81 X10. Y5. Z-12. R2. F120\nX20.\nX30. Y8.\nG80\n\
        G0 X0 Y-10.\nG1 X30. F300\nG0 Z20.\nG99 G82 X40. Y0 Z-3. R1. P500 F90\nX50.\nG80\nG0 Z20.\nG98 G85 X60. Z-8. R2. F200\nG80\n\
        G83 X70. Z-9. R2. Q3. F150\nX80.\nG73 X90. Z-8. R2. Q4.\nG80\nG86 X95. Z-5. R1.\nG80\nM5\nM30\n%";
    let source = control(Dialect::Fanuc);
    for (target, holes) in TARGETS.into_iter().zip([[9, 1], [9, 1], [6, 4], [6, 4], [6, 4]]) {
        let written = kept(text, &source, target);
        assert_eq!(written.holes, holes, "{}\n{}", target.name(), written.text);
    }
    // Holes that go on are their places alone.
    let fanuc = kept(text, &source, Dialect::Fanuc).text;
    assert!(fanuc.contains("G98 G81 X10. Y5. Z-12. R2. F120\nX20.\nX30. Y8.\nG80\n"), "{fanuc}");
    assert!(fanuc.contains("G99 G82 X40. Y0. Z-3. R1. P500 F90\nX50.\nG80\n"), "{fanuc}");
    let klartext = kept(text, &source, Dialect::Heidenhain).text;
    assert_eq!(klartext.matches("CYCL DEF 200").count(), 2, "{klartext}");
    assert!(kept(text, &source, Dialect::Siemens).text.contains("CYCLE82(1,1,0,-3,,0.5)"));
}

#[test]
fn cycles_of_klartext_and_sinumerik_become_those_of_fanuc() {
    let klartext = "0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S500\n2 L X+0 Y+0 Z+5 R0 FMAX M3\n\
        3 CYCL DEF 200 Q200=+2 Q201=-10 Q206=+300 Q202=+10 Q210=+0 Q203=+0 Q204=+5 Q211=+0.5\n4 CYCL CALL\n\
        5 L X+20 FMAX M99\n6 L X+40 FMAX M99\n7 END PGM A MM\n";
    let written = kept(klartext, &control(Dialect::Heidenhain), Dialect::Fanuc);
    assert_eq!(written.holes, [3, 0], "{}", written.text);
    let siemens = "G71 G90 G94\nS500 M3 F100\nG0 X0 Y0 Z10\nMCALL CYCLE81(10,0,2,-8)\nX5 Y5\nX15\nMCALL\nM30\n";
    let written = kept(siemens, &control(Dialect::Siemens), Dialect::LinuxCnc);
    assert_eq!(written.holes, [2, 0], "{}", written.text);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Whatever the cycle, what is written makes the same motions.
    #[test]
    fn random_holes_come_back_from_every_post(
        holes in prop::collection::vec((0..6_usize, -40.0..40.0_f64, 0..4_u32, 1..4_u32, any::<bool>(), 0..4_u32), 1..10),
        linuxcnc in any::<bool>(),
    ) {
        let dialect = if linuxcnc { Dialect::LinuxCnc } else { Dialect::Fanuc };
        let mut text = "G21 G17 G90 G94\nS800 M3\nG0 X1 Y1 Z10\n".to_owned();
        for (kind, x, depth, peck, initial, dwell) in holes {
            let code = [81, 82, 83, 73, 85, 89][kind];
            let (bottom, plane) = (-2.0 - 1.7 * f64::from(depth), if initial { "G98" } else { "G99" });
            let mut words = format!("{plane} G{code} X{x:.3} Z{bottom:.3} R1.");
            if matches!(code, 83 | 73) {
                words += &format!(" Q{:.3}", 1.3 * f64::from(peck));
            }
            if matches!(code, 82 | 89) {
                words += &if linuxcnc { format!(" P{}", 0.25 * f64::from(dwell)) } else { format!(" P{}", 250 * dwell) };
            }
            text += &format!("{words} F150\nY{:.3}\n", 0.5 * x);
            if peck == 2 {
                text += "G80\nG1 X0 F400\nG0 Z10\n";
            }
        }
        text += "G80\nM30\n";
        for target in TARGETS {
            kept(&text, &control(dialect), target);
        }
    }
}
