//! Programs as shops write them, in all six languages. What they do was worked out as lists of moves: lengths at a feed,
//! travels of the longest axis at rapid speed, dwells.

use super::{control, sums};
use std::f64::consts::PI;
use toolroom_program::{Control, Dialect};

/// Lengths, mm, with their feeds, mm/min; rapid travels, mm; dwell, s; end.
struct Does<'a> {
    feeds: &'a [(f64, f64)],
    rapids: &'a [f64],
    dwell: f64,
    end: [f64; 3],
}

/// What differs from the moves that are due; empty where nothing does.
fn differs(name: &str, text: &str, control: &Control, due: &Does<'_>) -> Vec<String> {
    let found = match sums(text, control) {
        Ok(found) => found,
        Err(error) => return vec![format!("{name}: {error}")],
    };
    let feed: f64 = due.feeds.iter().map(|(length, feed)| 60.0 * length / feed).sum();
    let rapid: f64 = due.rapids.iter().map(|travel| travel / 500.0).sum();
    let mut all = vec![("feed", found.feed, feed), ("rapid", found.rapid, rapid), ("dwell", found.dwell, due.dwell)];
    all.extend(["X", "Y", "Z"].into_iter().zip(found.end.into_iter().zip(due.end)).map(|(axis, (a, b))| (axis, a, b)));
    let wrong = |(what, found, due): (&str, f64, f64)| {
        let off = (found - due).abs();
        let both_unknown = found.is_nan() && due.is_nan();
        (!both_unknown && (off.is_nan() || off > 1e-4)).then(|| format!("{name}: {what} {found}, due {due}"))
    };
    all.into_iter().filter_map(wrong).collect()
}

fn all(dialect: Dialect, cases: &[(&str, &str, Does<'_>)]) {
    let mut control = control(dialect);
    control.diameters.insert(1, 10.0);
    let list: Vec<String> = cases.iter().flat_map(|(name, text, due)| differs(name, text, &control, due)).collect();
    assert!(list.is_empty(), "{}", list.join("\n"));
}

#[test]
fn fanuc_programs_of_the_shop_floor() {
    all(
        Dialect::Fanuc,
        &[
            (
                "inch drilling, G98 and G99",
                "%\nO0101 (INCH DRILLING)\nG20 G17 G40 G49 G80 G90\nT9 M6\nG54 G0 X0. Y0. S1000 M3\nG43 H9 Z1. M8\n\
                 G99 G81 Z-0.5 R0.1 F5.\nX1.\nX2. Y1.\nG98 X0 Y1.\nG80\nG0 Z2. M9\nM30\n%",
                Does {
                    feeds: &[(4.0 * 15.24, 127.0)],
                    rapids: &[74.6, 22.86, 15.24, 25.4, 15.24, 25.4, 15.24, 50.8, 38.1, 25.4],
                    dwell: 0.0,
                    end: [0.0, 25.4, 50.8],
                },
            ),
            (
                "bolt circle by WHILE",
                "O0102\nG21 G17 G90 G80 G40\nG0 X0 Y0 Z10.\n#101=0\n#102=20.\nWHILE [#101 LT 4] DO1\n\
                 #103=#102*COS[#101*90.]\n#104=#102*SIN[#101*90.]\nG0 X#103 Y#104\nG1 Z-2. F300\nG0 Z10.\n#101=#101+1\nEND1\nM30",
                Does {
                    feeds: &[(48.0, 300.0)],
                    rapids: &[90.0, 20.0, 20.0, 20.0, 20.0, 48.0],
                    dwell: 0.0,
                    end: [0.0, -20.0, 10.0],
                },
            ),
            (
                "contour by G41 with extended corners",
                "G21 G17 G90 G40 T1 M6\nG0 X-20. Y-20. Z0\nG1 G41 D1 X0 Y-10. F600\nG1 Y20.\nX40.\nY0\nX-10.\nG40 X-20. Y-20.\nM30",
                Does {
                    feeds: &[(2.0 * 325.0_f64.sqrt() + 35.0 + 50.0 + 30.0 + 55.0, 600.0)],
                    rapids: &[100.0],
                    dwell: 0.0,
                    end: [-20.0, -20.0, 0.0],
                },
            ),
            (
                "boring cycles",
                "G21 G17 G90 G0 X0 Y0 Z20.\nS1000 M3\nG98 G82 Z-5. R2. P1500 F100.\nG85 X10. Z-5. R2. F100.\nG86 X20. P0\n\
                 G89 X30. P500\nG76 X40. Q0.5 P0\nG80\nM30",
                Does {
                    // G86 and G76 draw out at rapid, G76 shifts by Q and back.
                    feeds: &[(7.0 * 7.0, 100.0)],
                    rapids: &[
                        80.0, 18.0, 25.0, 10.0, 18.0, 18.0, 10.0, 18.0, 25.0, 10.0, 18.0, 18.0, 10.0, 18.0, 0.5, 25.0,
                        0.5,
                    ],
                    dwell: 2.0,
                    end: [40.0, 0.0, 20.0],
                },
            ),
            (
                "nested subprograms",
                "O1\nG21 G17 G90 G0 X0 Y0 Z0\nM98 P100 L2\nG90 G1 X0 Y0 F1000.\nM30\nO100\nM98 P0200\nG91 G1 Y10. F600.\n\
                 G90 M99\nO200\nG91 G1 X10. F600.\nG90\nM99",
                Does {
                    feeds: &[(40.0, 600.0), (800.0_f64.sqrt(), 1000.0)],
                    rapids: &[100.0],
                    dwell: 0.0,
                    end: [0.0, 0.0, 0.0],
                },
            ),
            (
                "arcs in three planes",
                "G21 G17 G90 G0 X0 Y0 Z0\nG2 X10. Y10. R-10. F600\nG3 I-5.\nG19 G3 Y20. Z10. J0 K10.\nG18 G2 X20. Z0 R10.\nM30",
                Does {
                    feeds: &[(15.0 * PI + 10.0 * PI + 5.0 * PI + 5.0 * PI, 600.0)],
                    rapids: &[100.0],
                    dwell: 0.0,
                    end: [20.0, 20.0, 0.0],
                },
            ),
            (
                "conditions and jumps",
                "G21 G90 G0 X0 Y0 Z0\n#1=7\n#2=#1 MOD 3\n#3=FIX[7.9]\n#4=ABS[-3.]\nIF [#2 EQ 1] THEN #5=10.\n\
                 N10 G1 X[#5+#3+#4] F600\n#5=#5+10.\nIF [#5 LE 30.] GOTO 10\nM30",
                Does { feeds: &[(40.0, 600.0)], rapids: &[100.0], dwell: 0.0, end: [40.0, 0.0, 0.0] },
            ),
            (
                "modal macro",
                "G21 G90 G0 X0 Y0 Z5.\nG66 P50 Z-3. F120.\nX10.\nX20. Y10.\nG67\nG0 X0\nM30\nO50\nG1 Z#26 F#9\nG0 Z5.\nM99",
                Does {
                    feeds: &[(16.0, 120.0)],
                    rapids: &[95.0, 10.0, 8.0, 10.0, 8.0, 20.0],
                    dwell: 0.0,
                    end: [0.0, 10.0, 5.0],
                },
            ),
            (
                "tapping with M29 and return by G28",
                "G21 G90 G0 X0 Y0 Z10.\nM29 S500\nG98 G84 Z-10. R2. F500.\nG80\nG91 G28 Z0.\nG90\nM30",
                Does { feeds: &[(24.0, 500.0)], rapids: &[90.0, 8.0, 8.0], dwell: 0.0, end: [0.0, 0.0, f64::NAN] },
            ),
        ],
    );
}

#[test]
fn haas_programs_of_the_shop_floor() {
    all(
        Dialect::Haas,
        &[
            (
                "bolt circle G70 and pecks",
                "%\nO00010\nG00 G17 G21 G40 G49 G80 G90\nT9 M06\nG00 G90 G54 X50. Y0.\nS2000 M03\nG43 H09 Z10. M08\n\
                 G83 G98 Z-6. R2. Q4. F100. L0\nG70 I20. J0. L4\nG80\nG00 Z50. M09\nM30\n%",
                Does {
                    // Down 4 and, begun again 1 mm above, 5 mm a hole.
                    feeds: &[(4.0 * 9.0, 100.0)],
                    rapids: &[
                        50.0, 90.0, 20.0, 8.0, 4.0, 3.0, 16.0, 20.0, 8.0, 4.0, 3.0, 16.0, 20.0, 8.0, 4.0, 3.0, 16.0,
                        20.0, 8.0, 4.0, 3.0, 16.0, 40.0,
                    ],
                    dwell: 0.0,
                    end: [50.0, -20.0, 50.0],
                },
            ),
            (
                "local subprogram in inches",
                "O00011\nG20 G90 G17\nG00 X0 Y0 Z1.\nM97 P1000 L3\nG00 Z1.\nM30\nN1000 G01 Z-0.1 F10.\nG91 X1.\nG90 G00 Z1.\nM99",
                Does {
                    feeds: &[(3.0 * 1.1 * 25.4 + 3.0 * 25.4, 254.0)],
                    rapids: &[74.6, 3.0 * 1.1 * 25.4],
                    dwell: 0.0,
                    end: [76.2, 0.0, 25.4],
                },
            ),
            (
                "dwell and five-digit calls",
                "O00012\nG21 G90 G0 X0 Y0 Z0\nG04 P2.5\nG04 P500\nM98 P00020 L2\nM30\nO00020\nG91 G01 X10. F600.\nG90\nM99",
                Does { feeds: &[(20.0, 600.0)], rapids: &[100.0], dwell: 3.0, end: [20.0, 0.0, 0.0] },
            ),
            (
                "work offsets G154 and smoothness G187",
                "O00013\nG21 G90\nG187 P3 E0.01\nG0 X0 Y0 Z0\nG2 X10. Y0. I5. J0. F600.\nG1 X20.\nM30",
                Does { feeds: &[(5.0 * PI + 10.0, 600.0)], rapids: &[100.0], dwell: 0.0, end: [20.0, 0.0, 0.0] },
            ),
        ],
    );
}

#[test]
fn siemens_programs_of_the_shop_floor() {
    all(
        Dialect::Siemens,
        &[
            (
                "words that only set the control",
                "; POST 840D\nWORKPIECE(,,,\"BOX\",112,0,-20,-80,0,0,100,60)\nN10 G17 G54 G64 G71 G90 G94\nN20 CYCLE832(0.02,1,1)\n\
                 N30 T=\"MILL_10\" D1\nN40 M6\nN50 S3000 M3\nN60 G0 X0 Y0 Z5 M8\nN70 FFWON\nN80 SOFT\nN90 COMPCAD\nN100 G642\nN110 STOPRE\n\
                 N120 MSG(\"ROUGH\")\nN130 G1 Z-2 F200\nN140 X30 F=R1+600\nN150 G0 Z5 M9\nN160 M30",
                Does { feeds: &[(7.0, 200.0), (30.0, 600.0)], rapids: &[95.0, 7.0], dwell: 0.0, end: [30.0, 0.0, 5.0] },
            ),
            (
                "FOR, IF and expressions",
                "G17 G71 G90\nDEF INT I\nDEF REAL STEP=10\nG0 X0 Y0 Z0\nF600\nFOR I=1 TO 3\nIF I==2\nG1 X=IC(STEP*2)\nELSE\nG1 X=IC(STEP)\nENDIF\nENDFOR\nM30",
                Does { feeds: &[(40.0, 600.0)], rapids: &[100.0], dwell: 0.0, end: [40.0, 0.0, 0.0] },
            ),
            (
                "deep drilling on a row of holes",
                "G17 G71 G90\nG0 X0 Y0 Z10\nF100\nMCALL CYCLE81(10,0,2,-8)\nHOLES1(0,0,0,10,20,3)\nMCALL\nM30",
                Does {
                    feeds: &[(30.0, 100.0)],
                    rapids: &[90.0, 10.0, 8.0, 18.0, 20.0, 8.0, 18.0, 20.0, 8.0, 18.0],
                    dwell: 0.0,
                    end: [50.0, 0.0, 10.0],
                },
            ),
            (
                "arcs by CR, AR and a helix by TURN",
                "G17 G71 G90\nG0 X0 Y0 Z0\nF600\nG2 X10 Y10 CR=10\nG3 X20 Y20 CR=-10\nG2 X20 Y20 I10 J0\nG3 X0 Y20 I=AC(10) J=AC(20) Z-4 TURN=1\nM30",
                Does {
                    feeds: &[(5.0 * PI + 15.0 * PI + 20.0 * PI, 600.0), ((30.0 * PI).hypot(4.0), 600.0)],
                    rapids: &[100.0],
                    dwell: 0.0,
                    end: [0.0, 20.0, -4.0],
                },
            ),
            (
                "LOOP, REPEAT and a counter",
                "G17 G71 G90\nG0 X0 Y0 Z0\nR1=0\nREPEAT\nG91 G1 Y5 F300\nG90\nR1=R1+1\nUNTIL R1>=4\nLOOP\nR1=R1-1\nIF R1<2 GOTOF OUT\nG1 X=R1*10\nENDLOOP\nOUT:\nM30",
                Does { feeds: &[(20.0 + 30.0 + 10.0, 300.0)], rapids: &[100.0], dwell: 0.0, end: [20.0, 20.0, 0.0] },
            ),
            (
                "frames one on the other",
                "G17 G71 G90\nG0 X0 Y0 Z0\nTRANS X10 Y5\nG1 X0 Y0 F600\nATRANS X5\nX0\nMIRROR X0\nX5\nTRANS\nX0 Y5\nM30",
                Does {
                    feeds: &[(125.0_f64.sqrt() + 5.0 + 20.0 + 5.0, 600.0)],
                    rapids: &[100.0],
                    dwell: 0.0,
                    end: [0.0, 5.0, 0.0],
                },
            ),
        ],
    );
}

#[test]
fn klartext_programs_of_the_shop_floor() {
    let r5 = 5.0 * PI / 2.0;
    // From the touching point clockwise to 180 degrees, as seen from the centre.
    let turn = PI + f64::atan2(-30.0, 20.0) - (10.0 / 1300.0_f64.sqrt()).acos();
    all(
        Dialect::Heidenhain,
        &[
            (
                "presets, tolerance and delta values",
                "0 BEGIN PGM PLATE MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n2 BLK FORM 0.2 X+100 Y+100 Z+0\n3 CYCL DEF 247 DATUM SETTING ~\n   Q339=+1 ;DATUM NUMBER\n\
                 4 TOOL CALL 9 Z S2500 F500 DL+0.1 DR-0.05\n5 CYCL DEF 32.0 TOLERANCE\n6 CYCL DEF 32.1 T0.02\n7 L X+0 Y+0 R0 FMAX M3\n8 L Z+5 FMAX\n9 L Z-5 F200\n10 L X+50 FAUTO\n11 L Z+100 R0 FMAX M2\n12 END PGM PLATE MM",
                Does {
                    feeds: &[(10.0, 200.0), (50.0, 500.0)],
                    rapids: &[95.0, 105.0],
                    dwell: 0.0,
                    end: [50.0, 0.0, 100.0],
                },
            ),
            (
                "approach and departure on straight lines, without compensation",
                "0 BEGIN PGM A MM\n1 TOOL CALL 9 Z S1000\n2 L X-20 Y-20 Z+0 R0 FMAX\n3 APPR LT X+0 Y+0 LEN15 R0 F300\n4 L X+0 Y+40\n5 L X+30\n6 DEP LT LEN10\n7 END PGM A MM",
                Does {
                    // To X0 Y-15, 15 mm to the contour, 40 and 30 mm along it, 10 mm on.
                    feeds: &[(425.0_f64.sqrt() + 15.0 + 40.0 + 30.0 + 10.0, 300.0)],
                    rapids: &[100.0],
                    dwell: 0.0,
                    end: [40.0, 40.0, 0.0],
                },
            ),
            (
                "approach and departure on arcs beside the contour",
                "0 BEGIN PGM B MM\n1 TOOL CALL 2 Z S1000\n2 TOOL DEF 2 L+0 R+0\n3 L X-30 Y-10 Z+0 R0 FMAX\n4 APPR CT X+0 Y+0 CCA90 R+10 RL F300\n5 L X+0 Y+40\n6 L X+30\n7 DEP CT CCA90 R+5\n8 L X+60 Y+60 R0 FMAX\n9 END PGM B MM",
                Does {
                    // RL at a path up: the arc lies on the left, about X-10 Y0, and begins at X-10 Y-10.
                    feeds: &[(20.0 + 5.0 * PI + 40.0 + 30.0 + r5, 300.0)],
                    rapids: &[100.0, 25.0],
                    dwell: 0.0,
                    end: [60.0, 60.0, 0.0],
                },
            ),
            (
                "approach that touches an arc, departure across",
                "0 BEGIN PGM C MM\n1 TOOL CALL 2 Z S1000\n2 TOOL DEF 2 L+0 R+0\n3 L X+30 Y-30 Z+0 R0 FMAX\n4 APPR LCT X+0 Y+0 R10 RR F300\n5 L X+0 Y+40\n6 DEP LN LEN+20\n7 END PGM C MM",
                Does {
                    // About X10 Y0: the line from X30 Y-30 touches where the way to the centre is a right angle away.
                    feeds: &[
                        ((20.0_f64 * 20.0 + 30.0 * 30.0 - 100.0).sqrt(), 300.0),
                        (10.0 * turn, 300.0),
                        (40.0 + 20.0, 300.0),
                    ],
                    rapids: &[100.0],
                    dwell: 0.0,
                    end: [20.0, 40.0, 0.0],
                },
            ),
            (
                "approach and departure on arcs, whose radii are those of the path of the tool's centre",
                "0 BEGIN PGM B MM\n1 TOOL CALL 2 Z S1000\n2 TOOL DEF 2 L+0 R+4\n3 L X-30 Y-10 Z+0 R0 FMAX\n4 APPR CT X+0 Y+0 CCA90 R+10 RL F300\n5 L X+0 Y+40\n6 L X+30\n7 DEP CT CCA90 R+5\n8 L X+60 Y+60 R0 FMAX\n9 END PGM B MM",
                Does {
                    // The centre comes from X-14 Y-10 about X-14 Y0, and leaves from X30 Y44 to X35 Y49.
                    feeds: &[(16.0 + 5.0 * PI + 40.0 + 2.0 * PI + 30.0 + r5, 300.0)],
                    rapids: &[100.0, 25.0],
                    dwell: 0.0,
                    end: [60.0, 60.0, 0.0],
                },
            ),
            (
                "approach that touches an arc of the tool's centre",
                "0 BEGIN PGM C MM\n1 TOOL CALL 2 Z S1000\n2 TOOL DEF 2 L+0 R+4\n3 L X+30 Y-30 Z+0 R0 FMAX\n4 APPR LCT X+0 Y+0 R10 RR F300\n5 L X+0 Y+40\n6 DEP LN LEN+20\n7 END PGM C MM",
                Does {
                    // About X14 Y0, as the approach above without a cutter.
                    feeds: &[
                        ((16.0_f64 * 16.0 + 30.0 * 30.0 - 100.0).sqrt(), 300.0),
                        (10.0 * (PI + f64::atan2(-30.0, 16.0) - (10.0 / 1156.0_f64.sqrt()).acos()), 300.0),
                        (40.0 + 20.0, 300.0),
                    ],
                    rapids: &[100.0],
                    dwell: 0.0,
                    end: [24.0, 40.0, 0.0],
                },
            ),
            (
                "increments behind a departure count from where the tool stands",
                "0 BEGIN PGM L MM\n1 TOOL DEF 2 L+0 R+10\n2 TOOL CALL 2 Z S4000\n3 L X-10 Y-10 Z-5 R0 F1000\n4 APPR LT X+5 Y+5 LEN10 RL F300\n5 L Y+95\n6 L X+95\n7 DEP LT LEN10\n8 L IX-10\n9 END PGM L MM",
                Does {
                    // From X0 Y0 Z100 to X-10 Y-10 Z-5, to the contour, X-5 Y-5, up, about the corner and along it to X105 Y105.
                    feeds: &[
                        (11225.0_f64.sqrt(), 1000.0),
                        (50.0_f64.sqrt() + 10.0 + 90.0 + 5.0 * PI + 90.0 + 10.0 + 10.0, 300.0),
                    ],
                    rapids: &[],
                    dwell: 0.0,
                    end: [95.0, 105.0, -5.0],
                },
            ),
            (
                "contour with compensation, rounding and chamfer",
                "0 BEGIN PGM D MM\n1 TOOL CALL 1 Z S1000\n2 L X-20 Y-20 Z+0 R0 FMAX\n3 L X+0 Y-10 RL F600\n4 L Y+20\n5 L X+40\n6 L Y+0\n7 L X-10\n8 L X-20 Y-20 R0\n9 END PGM D MM",
                Does {
                    // Corners are arcs of the cutter's radius.
                    feeds: &[(2.0 * 325.0_f64.sqrt() + 30.0 + 40.0 + 20.0 + 50.0 + 3.0 * r5, 600.0)],
                    rapids: &[100.0],
                    dwell: 0.0,
                    end: [-20.0, -20.0, 0.0],
                },
            ),
            (
                "polar bolt circle by labels",
                "0 BEGIN PGM E MM\n1 TOOL CALL 9 Z S1000\n2 L X+0 Y+0 Z+10 R0 FMAX\n3 CYCL DEF 200 DRILLING ~\n Q200=2 ~\n Q201=-10 ~\n Q206=100 ~\n Q202=10 ~\n Q210=0 ~\n Q203=+0 ~\n Q204=10 ~\n Q211=0.5\n\
                 4 CC X+0 Y+0\n5 Q1 = 0\n6 LBL 1\n7 LP PR+20 PA+Q1 R0 FMAX M99\n8 FN 1: Q1 = +Q1 + +90\n9 CALL LBL 1 REP 3\n10 END PGM E MM",
                Does {
                    feeds: &[(48.0, 100.0)],
                    rapids: &[90.0, 20.0, 20.0, 20.0, 20.0, 4.0 * 8.0, 4.0 * 20.0],
                    dwell: 2.0,
                    end: [0.0, -20.0, 10.0],
                },
            ),
        ],
    );
}

#[test]
fn linuxcnc_programs_of_the_shop_floor() {
    all(
        Dialect::LinuxCnc,
        &[
            (
                "subroutine with arguments and a return",
                "o<row> sub\n #<n> = 0\n o1 while [#<n> LT #1]\n  G91 G1 X#2 F600\n  G90\n  #<n> = [#<n> + 1]\n o1 endwhile\no<row> endsub [#<n>]\n\
                 G21 G17 G90\nG0 X0 Y0 Z0\no<row> call [3] [10]\nG1 Y#<_value> F600\nM2",
                Does { feeds: &[(33.0, 600.0)], rapids: &[100.0], dwell: 0.0, end: [30.0, 3.0, 0.0] },
            ),
            (
                "functions in degrees",
                "G21 G17 G90\nG0 X0 Y0 Z0\n#<r> = 10\nG1 X[#<r> * COS[60]] Y[#<r> * SIN[60]] F600\nG1 X[ATAN[1]/[1]] Y[SQRT[16]]\nM2",
                Does {
                    feeds: &[(10.0, 600.0), (40.0_f64.hypot(8.660_254_037_844_386 - 4.0), 600.0)],
                    rapids: &[100.0],
                    dwell: 0.0,
                    end: [45.0, 4.0, 0.0],
                },
            ),
            (
                "holes with L by increments",
                "G20 G17 G90\nG0 X0 Y0 Z1\nF10\nG91 G98 G81 X1 Z-0.6 R-0.5 L3\nG90 G80\nG0 X0\nM2",
                Does {
                    feeds: &[(3.0 * 0.6 * 25.4, 254.0)],
                    rapids: &[74.6, 25.4, 12.7, 27.94, 25.4, 12.7, 27.94, 25.4, 12.7, 27.94, 76.2],
                    dwell: 0.0,
                    end: [0.0, 0.0, 25.4],
                },
            ),
            (
                "offsets, dwell and exact path",
                "G21 G17 G90 G61\nG0 X0 Y0 Z0\nG92 X5\nG1 X15 F600\nG92.1\nG4 P1.25\nG64 P0.01\nG2 X20 Y10 I0 J10\nM2",
                Does { feeds: &[(10.0 + 15.0 * PI, 600.0)], rapids: &[100.0], dwell: 1.25, end: [20.0, 10.0, 0.0] },
            ),
        ],
    );
}

#[test]
fn lathe_programs_of_the_shop_floor() {
    all(
        Dialect::FanucLathe,
        &[
            (
                "turning in diameters by G98",
                "O0200\nG21 G98 G97 S1000 M3\nG0 X50. Z2.\nG1 Z-30. F200.\nX60.\nG0 Z2.\nG0 U-20. W-1.\nM30",
                Does {
                    feeds: &[(32.0, 200.0), (5.0, 200.0)],
                    rapids: &[98.0, 32.0, 10.0],
                    dwell: 0.0,
                    end: [40.0, 0.0, 1.0],
                },
            ),
            (
                "cycles G90 and G94",
                "O0201\nG21 G98 G97 S1000 M3\nG0 X60. Z2.\nG90 X50. Z-30. F200.\nX40.\nG94 X20. Z0 F100.\nG0 X100.\nM30",
                Does {
                    // G90: in at rapid, along, out at feed, back at rapid; G94 the other way round.
                    feeds: &[(32.0 + 5.0 + 32.0 + 10.0, 200.0), (20.0 + 2.0, 100.0)],
                    rapids: &[98.0, 5.0, 32.0, 10.0, 32.0, 2.0, 20.0, 20.0],
                    dwell: 0.0,
                    end: [100.0, 0.0, 2.0],
                },
            ),
            (
                "roughing and finishing of a shoulder",
                "O0202\nG21 G98 G97 S1000 M3\nG0 X60. Z2.\nG71 U2. R1.\nG71 P10 Q20 U1. W0.5 F200.\nN10 G0 X40.\nG1 Z-20. F100.\n\
                 N20 X60.\nG70 P10 Q20\nG0 X100.\nM30",
                Does {
                    // Four passes of 2 mm, the contour 0.5 mm above itself, then the contour.
                    feeds: &[(4.0 * 22.0 + 22.0 + 10.0, 200.0), (22.0 + 10.0, 100.0)],
                    rapids: &[98.0, 0.5, 2.0, 3.0, 3.0, 3.0, 4.0, 84.0, 3.0, 21.5, 10.0, 22.0, 20.0],
                    dwell: 0.0,
                    end: [100.0, 0.0, 2.0],
                },
            ),
            (
                "thread in passes of equal section",
                "O0203\nG21 G98 G97 S500 M3\nG0 X30. Z5.\nG76 P010060 Q100 R0.1\nG76 X26. Z-20. P1200 Q400 F1.5\nM30",
                Does {
                    // Depths 0.4, 0.566, 0.693, 0.8, 0.9, 1.0, 1.1 and at last 1.2 mm.
                    feeds: &[(8.0 * 25.0, 750.0)],
                    rapids: &[
                        95.0,
                        2.0 * (8.0 * 0.8 + 0.4 + 0.565_685_42 + 0.692_820_32 + 0.8 + 0.9 + 1.0 + 1.1 + 1.2),
                        200.0,
                    ],
                    dwell: 0.0,
                    end: [30.0, 0.0, 5.0],
                },
            ),
            (
                "groove in three pecks and three rows",
                "O0204\nG21 G98 G97 S500 M3\nG0 X30. Z-4.\nG75 R0.5\nG75 X20. Z-10. P2000 Q3000 F50.\nM30",
                Does {
                    feeds: &[(3.0 * 6.0, 50.0)],
                    rapids: &[104.0, 3.0 * 6.0, 6.0, 6.0],
                    dwell: 0.0,
                    end: [30.0, 0.0, -4.0],
                },
            ),
        ],
    );
}

#[test]
fn a_siemens_variable_named_like_an_address_is_refused_where_it_may_move_an_axis() {
    let control = control(Dialect::Siemens);
    let message = |text: &str| sums(text, &control).expect_err("it might move the axis or take a value").to_string();
    let assigned = message("G71 G90\nDEF REAL X=5\nG0 X=10 Y0 Z0\nG1 Y=X F100\nM30");
    assert!(assigned.starts_with("3:") && assigned.contains("X is a variable here"), "{assigned}");
    let centre = message("G17 G71 G90\nDEF INT I\nG0 X0 Y0 Z0\nG2 X10 I5 F100\nM30");
    assert!(centre.starts_with("4:") && centre.contains("I is a variable here"), "{centre}");
    // Where it is only read, or counts a loop, and in a subprogram that has none of its own, what is meant is clear.
    let clear = "%_N_A_MPF\nG71 G90 G17\nDEF INT I\nG0 X0 Y0 Z0\nFOR I=1 TO 2\nARC\nENDFOR\nG1 Y=I*0 F600\nM30\n\
                 %_N_ARC_SPF\nG2 X0 Y0 I5 J0 F600\nM17";
    assert!((sums(clear, &control).expect("two circles").feed - 2.0 * 10.0 * PI / 10.0).abs() < 1e-4);
}

#[test]
fn an_inner_arc_of_the_radius_of_the_cutter_is_refused_with_its_radius() {
    let mut control = control(Dialect::Fanuc);
    control.diameters.insert(1, 10.0);
    let text = "G21 G90 G17\nG0 X30 Y20 Z0\nG41 D1 G1 X30 Y0 F500\nG1 X55\nG3 X60 Y5 R5\nG1 Y40\nX30\nG40 Y20\nM30";
    let error = sums(text, &control).expect_err("it has no path").to_string();
    assert!(error.starts_with("5:") && error.contains("the inner arc of 5 mm in line 5"), "{error}");
    assert!(sums(&text.replace("X55", "X54.9").replace("Y5 R5", "Y5.1 R5.1"), &control).is_ok());
}
