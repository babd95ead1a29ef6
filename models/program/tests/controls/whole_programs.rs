//! Whole programs as shops and CAM posts write them, each written without a look at the reader. Times, lengths and ends were
//! worked out by a list of moves (lengths over feeds, longest axis over 30 m/min, integrals over the diameter at constant
//! surface speed), from what the manuals of the controls say of each word.

use super::{control, sums};
use std::path::Path;
use toolroom_program::{Control, Dialect, Run};

/// File, its language, feed s, rapid s where it was worked out, dwell s, length at feed mm, end X and Y mm.
type Case = (&'static str, Dialect, f64, Option<f64>, f64, f64, [f64; 2]);

const NOWHERE: [f64; 2] = [f64::NAN; 2];

const CASES: [Case; 38] = {
    use Dialect::{Fanuc, FanucLathe, Haas, Heidenhain, LinuxCnc, Siemens};
    [
        ("fanuc-contour-and-drill.nc", Fanuc, 24.768034, Some(0.422), 0.0, 238.361698, NOWHERE),
        ("fanuc-macros.nc", Fanuc, 20.0, Some(0.664843), 0.0, 65.0, [20.0, -1.0]),
        ("fanuc-frames.nc", Fanuc, 96.133854, Some(0.714641), 2.0, 332.446180, [-40.0, -50.0]),
        ("fanuc-holes.nc", Fanuc, 90.16, Some(1.528), 1.5, 219.0, [0.0, 50.0]),
        ("fanuc-inch.nc", Fanuc, 86.808204, Some(0.30922), 5.0, 395.886127, [0.0, 0.0]),
        ("fanuc-arcs.nc", Fanuc, 11.324951, Some(0.2), 0.0, 188.749183, [0.0, 0.0]),
        ("fanuc-calls.nc", Fanuc, 2.2, Some(0.2), 0.0, 22.0, [10.0, 12.0]),
        ("fanuc-corners.nc", Fanuc, 5.668241, Some(0.2), 0.0, 56.682409, [0.0, 20.0]),
        ("fanuc-shifted-contour.nc", Fanuc, 19.712389, Some(1.086), 0.0, 152.123890, [0.0, 0.0]),
        ("fanuc-polar-holes.nc", Fanuc, 11.070796, Some(0.746558), 0.0, 47.707963, [0.0, 0.0]),
        ("haas-patterns.nc", Haas, 24.5, None, 0.0, 103.0, NOWHERE),
        ("haas-pockets.nc", Haas, 121.239282, None, 0.0, 1005.327352, [0.0, 0.0]),
        ("haas-inch-mirror.nc", Haas, 73.048668, None, 2.25, 340.989360, [-25.4, 25.4]),
        ("lathe-rough-and-thread.nc", FanucLathe, 87.562185, None, 0.0, 653.546383, NOWHERE),
        ("lathe-facing-and-forging.nc", FanucLathe, 120.775906, None, 0.0, 244.054601, [100.0, 0.0]),
        ("lathe-old-cycles.nc", FanucLathe, 121.206603, Some(0.8122), 2.25, 244.579872, [70.0, 0.0]),
        ("lathe-surface-speed.nc", FanucLathe, 12.307595, Some(0.326), 0.0, 67.491944, [52.0, 0.0]),
        ("lathe-speeds.nc", FanucLathe, 8.482300, Some(0.196), 0.0, 40.0, [60.0, 0.0]),
        ("lathe-corners.nc", FanucLathe, 11.437981, Some(0.2), 0.0, 38.126603, [40.0, 0.0]),
        ("siemens-flange.mpf", Siemens, 32.840148, None, 8.5, 327.002474, [30.0, 32.679492]),
        ("siemens-polar.mpf", Siemens, 36.006848, None, 3.5, 240.045652, [67.071068, 57.071068]),
        ("siemens-cycles.mpf", Siemens, 92.716564, Some(0.3088), 1.0, 436.011623, [40.0, 0.0]),
        ("siemens-jumps.mpf", Siemens, 12.983480, Some(0.2), 12.0, 52.834776, [10.0, -5.0]),
        ("siemens-repeat.mpf", Siemens, 18.141593, Some(0.604), 0.0, 115.415927, [95.0, 45.0]),
        ("siemens-circle-of-holes.mpf", Siemens, 23.283185, Some(0.767205), 8.0, 139.831853, [-34.641016, 20.0]),
        ("klartext-patterns.h", Heidenhain, 84.12, Some(2.5964), 1.75, 381.8, [50.0, 20.0]),
        ("klartext-transforms.h", Heidenhain, 69.903744, Some(0.338), 0.0, 676.754252, [80.0, 20.0]),
        ("klartext-approach.h", Heidenhain, 100.312287, Some(0.378), 1.5, 471.561436, [4.0, 50.0]),
        ("klartext-inch.h", Heidenhain, 41.777953, None, 1.0, 183.68, [50.8, 25.4]),
        ("klartext-polar.h", Heidenhain, 23.506310, Some(0.2), 0.0, 195.885919, [4.5, 0.0]),
        ("klartext-deep-holes.h", Heidenhain, 40.22, None, 1.0, 90.7, [60.0, 0.0]),
        ("klartext-ring.h", Heidenhain, 12.541593, Some(0.871923), 1.5, 97.415927, [-20.0, 0.0]),
        ("linuxcnc-o-words.ngc", LinuxCnc, 53.474334, Some(0.414), 2.5, 411.743339, [8.0, 45.0]),
        ("linuxcnc-polar.ngc", LinuxCnc, 41.091254, None, 0.0, 122.808271, [40.0, 0.0]),
        ("linuxcnc-inch.ngc", LinuxCnc, 169.441106, None, 0.0, 722.382178, NOWHERE),
        ("linuxcnc-splines.ngc", LinuxCnc, 33.843605, Some(0.21), 0.75, 128.436045, [20.0, 15.0]),
        ("linuxcnc-variables.ngc", LinuxCnc, 9.773386, Some(0.2), 0.0, 97.733860, [0.0, 0.0]),
        ("linuxcnc-values.ngc", LinuxCnc, 18.966371, Some(0.314284), 0.0, 93.831853, [14.142136, 14.142136]),
    ]
};

#[test]
fn whole_programs_of_six_controls_take_the_time_of_their_moves() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/controls/programs");
    let mut wrong = Vec::new();
    for (file, dialect, feed, rapid, dwell, length, end) in CASES {
        let text = std::fs::read_to_string(folder.join(file)).expect("a program");
        let mut control = control(dialect);
        // The language is found from the text and the ending of the file, but for lathes without a word of their own.
        control.dialect = (dialect == Dialect::Fanuc).then_some(dialect);
        let mut control = control.for_file(&folder.join(file), None);
        if file == "haas-pockets.nc" {
            control.diameters.insert(3, 10.0);
        }
        let found = match sums(&text, &control) {
            Ok(found) => found,
            Err(error) => {
                wrong.push(format!("{file}: {error}"));
                continue;
            }
        };
        let mut pairs =
            vec![("feed", found.feed, feed), ("dwell", found.dwell, dwell), ("length", found.length, length)];
        pairs.extend(rapid.map(|rapid| ("rapid", found.rapid, rapid)));
        pairs.extend(["X", "Y"].into_iter().zip(found.end).zip(end).map(|((axis, a), b)| (axis, a, b)));
        let off =
            pairs.into_iter().filter(|(_, found, due)| !due.is_nan() && (found.is_nan() || (found - due).abs() > 2e-5));
        wrong.extend(off.map(|(what, found, due)| format!("{file}: {what} {found}, due {due}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What was silently wrong, or refused without need, before these programs were tried.
#[test]
fn words_that_act_on_what_comes_later_are_not_lost() {
    use super::does;
    use Dialect::{Fanuc, FanucLathe, Haas, Heidenhain, LinuxCnc, Siemens};
    // G28 alone takes all axes of a Haas to their reference point: the next motion comes from nowhere known.
    does(Haas, "G21 G90\nG0 X10. Y0. Z100.\nG28\nG0 X50. Y50. Z5.", (0.0, 0.02, 0.0, [50.0, 50.0, 5.0]));
    // A cycle called at a place: the plane first, then down to its clearance, above Z as its surface.
    let called = "BEGIN PGM A MM\nTOOL CALL 1 Z S9\nCYCL DEF 201 REIBEN ~\n Q200=2 ~\n Q201=-8 ~\n Q206=100 ~\n Q208=0 ~\n Q203=0 ~\n \
                  Q204=20\nL X+0 Y+0 Z+50 R0 FMAX\nCYCL CALL POS X+30 Y+0 Z-10 FMAX";
    does(Heidenhain, called, (12.0, 0.1 + 0.06 + 0.116 + 0.036, 0.0, [30.0, 0.0, 10.0]));
    // Lines of a pattern, every other one backwards, between holes at the first clearance.
    let rows = "BEGIN PGM A MM\nTOOL CALL 1 Z S9\nL X+0 Y+0 Z+20 R0 FMAX\nCYCL DEF 200 BOHREN ~\n Q200=2 ~\n Q201=-8 ~\n Q206=60 ~\n \
                Q202=8 ~\n Q210=0 ~\n Q203=0 ~\n Q204=20 ~\n Q211=0\nCYCL DEF 221 MUSTER ~\n Q225=10 ~\n Q226=0 ~\n Q237=10 ~\n Q238=5 ~\n \
                Q242=2 ~\n Q243=2 ~\n Q224=0 ~\n Q200=2 ~\n Q203=0 ~\n Q204=20 ~\n Q301=0";
    let travel = 80.0 + 10.0 + 18.0 + 10.0 + 5.0 + 10.0 + 4.0 * 10.0 + 18.0;
    does(Heidenhain, rows, (40.0, travel / 500.0, 0.0, [10.0, 5.0, 20.0]));
    // A turned work offset.
    does(LinuxCnc, "G21 G90\nG10 L2 P1 R90\nG1 X10 F600\nY5\nG10 L2 P1 R0\nX0 Y0", {
        ((10.0 + 5.0 + 125f64.sqrt()) / 10.0, 0.0, 0.0, [0.0, 0.0, 100.0])
    });
    // Chamfers and roundings lie between motions; one behind which nothing comes is refused.
    does(Siemens, "G71 G90\nG1 X10 F600 CHR=2\nY10", (1.6 + 0.2 * 2f64.sqrt(), 0.0, 0.0, [10.0, 10.0, 100.0]));
    does(Fanuc, "G21 G90\nG1 X10. ,C2. F600\nY10.", (1.6 + 0.2 * 2f64.sqrt(), 0.0, 0.0, [10.0, 10.0, 100.0]));
    // What moves nothing may stand between.
    does(Fanuc, "G21 G90\nG1 X10. ,C2. F600\nM8\nY10.", (1.6 + 0.2 * 2f64.sqrt(), 0.0, 0.0, [10.0, 10.0, 100.0]));
    for (dialect, text, line, word) in [
        (Siemens, "G71 G0 X0\nG1 RND=2 F9\nX1", 2, "without a motion"),
        (Siemens, "G71 G0 X0\nG1 X1 F9 RND=0.2", 2, "no motion behind it"),
        (Siemens, "G71 G0 X0\nG1 X1 F9 RND=0.2\nM0\nY1", 4, "no motion behind it"),
        (Siemens, "G71 G0 X0\nG1 X1 F9 RND=2\nY1", 3, "larger than the motions"),
        (Siemens, "G71 G0 X0\nG1 X9 F9 RNDM=2", 2, "RNDM"),
        (Fanuc, "G21 G0 X0\nG1 X9. ,A30. F9", 2, "only ,C and ,R"),
        (Haas, "G21 G0 X0\nG13 I9. Q2. F9", 2, "with Q"),
        (Haas, "G21 G0 X0\nG12 D1 F9", 2, "needs I"),
        (LinuxCnc, "G21 G0 X0\nG1 ^45 F9", 2, "at the origin"),
        (FanucLathe, "G21 G50 S900 S9\n", 1, "twice"),
        (FanucLathe, "G21 G0 X30. Z1. G97 S9\nG76 P010060 Q100 R50\nG76 X20. Z-9. P1227 Q400 F2.", 3, "R0.05"),
        (
            FanucLathe,
            "G21 G0 X30. Z1. G97 S9\nG73 U2. W2.\nG73 P1 Q2\nN1 G0 X1.\nN2 G1 Z-1. F.1",
            3,
            "number of passes",
        ),
        (Heidenhain, "BEGIN PGM A MM\nTOOL CALL 1 Z S9\nCYCL DEF 220 KREIS ~\n Q216=0", 3, "defined before"),
    ] {
        let error = sums(text, &control(dialect)).expect_err(text);
        assert!(error.line == line && error.message.contains(word), "{text}: {error}");
    }
}

#[test]
fn long_lengths_without_a_point_beside_others_with_one_are_noted_once() {
    let notes = |text: &str| {
        let mut run = Run::new(text, &Control::default()).expect("a program");
        run.by_ref().for_each(|event| assert!(event.is_ok(), "it runs"));
        run.notes().iter().filter(|(_, text)| text.contains("no decimal point")).cloned().collect::<Vec<_>>()
    };
    let mixed = notes("%\nO1\nG21 G90 G94\nG0 X5.5 Y0. Z5.\nG1 X1000 F100\nG1 Y2000\nM30\n%");
    assert_eq!(mixed.len(), 1, "{mixed:?}");
    assert!(mixed[0].1.contains("X1000 of line 5"), "{mixed:?}");
    let later = notes("%\nO1\nG21 G90 G94\nG0 X1500 Y0 Z5\nG1 X3.5 F100\nM30\n%");
    assert!(later.len() == 1 && later[0].1.contains("X1500 of line 4"), "{later:?}");
    for plain in
        ["G0 X1000 Y0 Z5\nG1 X20 F1500", "G0 X1000. Y0. Z5.\nG1 X20. F1500", "G0 X5.5 Y0 Z5\nG1 X20 F1500 S2000 M3"]
    {
        assert!(notes(&format!("%\nO1\nG21 G90 G94\n{plain}\nM30\n%")).is_empty(), "{plain}");
    }
}
