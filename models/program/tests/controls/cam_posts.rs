//! Words that posts of CAM systems write and subprograms of shops use, in the languages of Heidenhain and Siemens. What they do
//! was worked out as lists of moves.

use super::{control, does, refused, sums};
use toolroom_program::Dialect::{Fanuc, Heidenhain, LinuxCnc, Siemens};

#[test]
fn cycles_and_returns_as_cam_systems_post_them_for_heidenhain() {
    let around =
        |body: &str| format!("0 BEGIN PGM A MM\n1 TOOL CALL 1 Z S100\n2 L X+0 Y+0 R0 F MAX M3\n{body}\n9 END PGM A MM");
    // Two strokes before each withdrawal: the first retracts by Q256, the second goes out at Q208 and back to 0.2 mm above.
    let deep = "3 L Z+50 FMAX\n4 CYCL DEF 203 UNIVERSAL DRILLING ~\n Q200=+2 ~\n Q201=-12 ~\n Q206=+60 ~\n Q202=+3 ~\n Q210=+0 ~\n \
                Q203=+0 ~\n Q204=+20 ~\n Q212=+0 ~\n Q213=+1 ;BREAKS ~\n Q205=+3 ~\n Q211=+0 ~\n Q208= 120 ~\n Q256=+0.5\n5 L FMAX M99";
    let feed = (5.0 + 3.5 + 3.2 + 3.5) + (8.0 + 14.0) / 2.0;
    let travels = 50.0 + 48.0 + 0.5 + 7.8 + 0.5 + 18.0;
    does(Heidenhain, &around(deep), (feed, travels / 500.0, 0.0, [0.0, 0.0, 20.0]));
    let rapid = around(&deep.replace("Q208= 120", "Q208= MAX"));
    does(Heidenhain, &rapid, (15.2, (travels + 8.0 + 14.0) / 500.0, 0.0, [0.0, 0.0, 20.0]));
    let centring = "3 L Z+20 FMAX\n4 CYCL DEF 240 CENTRING ~\n Q200=+2 ~\n Q343=+0 ~\n Q201=-3 ~\n Q344=-6 ~\n Q206=+60 ~\n Q211=+0.5 ~\n \
                    Q203=+0 ~\n Q204=+20\n5 L X+10 FMAX M99";
    does(Heidenhain, &around(centring), (5.0, (80.0 + 10.0 + 18.0 + 23.0) / 500.0, 0.5, [10.0, 0.0, 20.0]));
    let tap = "3 L Z+20 FMAX\n4 CYCL DEF 209 TAPPING W/ CHIP BRKG ~\n Q200=+2 ~\n Q201=-6 ~\n Q239=+1 ~\n Q203=+0 ~\n Q204=+20 ~\n \
               Q257=+3 ~\n Q256=+1 ~\n Q336=+0 ~\n Q403=+2\n5 CYCL CALL";
    does(Heidenhain, &around(tap), (8.4, (80.0 + 18.0 + 18.0) / 500.0, 0.0, [0.0, 0.0, 20.0]));
    // Off the workpiece by a way, at rapid speed and at feed, and as far as the axis goes.
    let back =
        "3 PLANE RESET STAY\n4 FUNCTION RESET TCPM\n5 L Z+0 FMAX\n6 L M140 MB40\n7 M140 MB10 F600\n8 L X+10 FMAX M107";
    does(Heidenhain, &around(back), (1.0, (100.0 + 40.0 + 10.0) / 500.0, 0.0, [10.0, 0.0, 50.0]));
    let away = sums(&around("3 L Z+0 FMAX\n4 L M140 MB MAX"), &control(Heidenhain)).expect("a program");
    assert!(away.end[2].is_nan() && away.end[0] == 0.0, "{away:?}");
    // An oversize of the radius in the call of the tool.
    let contour =
        "3 TOOL CALL 1 Z S100 DR-1 DL+0.5\n4 L Z+0 FMAX\n5 L X+10 Y+0 RL F600\n6 L X+30\n7 L Y+20\n8 L R0 X+50";
    let mut tools = control(Heidenhain);
    tools.diameters.insert(1, 10.0);
    let found = sums(&around(contour), &tools).expect("a program");
    // On the left of an inner corner the centre runs at 4 mm from both walls.
    let length = 10f64.hypot(4.0) + 16.0 + 16.0 + 24.0;
    assert!((found.length - length).abs() < 1e-6, "{} {length}", found.length);
    for (body, word) in [
        ("3 L M140", "needs MB"),
        ("3 L X+1 M140 MB MAX", "block of their own"),
        ("3 CYCL DEF 240 A ~\n Q200=2 ~\n Q343=1 ~\n Q201=-3 ~\n Q206=9\n4 CYCL CALL", "point angle"),
        ("3 PLANE SPATIAL SPA+90 SPB+0 SPC+0 STAY", "tilted planes"),
        ("3 FUNCTION TCPM F TCP AXIS POS", "FUNCTION is not understood"),
    ] {
        let error = refused(Heidenhain, &around(body));
        assert!(error.message.contains(word), "{body}: {error}");
    }
}

#[test]
fn subprograms_of_siemens_take_values_and_give_back_what_they_hide() {
    let hole = "%_N_HOLE_SPF\nPROC HOLE(REAL _D, INT _N, REAL _F=120) SAVE\nDEF INT _I\nG91\nFOR _I=1 TO _N\nG1 Z=-_D F=_F\nG0 Z=_D\n\
                ENDFOR\nM17";
    let text = |body: &str| format!("%_N_MAIN_MPF\nG71 G90 G94 G17\nDEF INT _I=30\nG0 X0 Y0 Z10\n{body}\nM30\n{hole}");
    // 20 mm twice at 120; steps end with the subprogram, and so does its own _I.
    does(Siemens, &text("HOLE(20,2)\nG1 X=_I F600"), (20.0 + 3.0, (90.0 + 40.0) / 500.0, 0.0, [30.0, 0.0, 10.0]));
    // Behind each motion, with another feed; its own motions do not call it again.
    does(Siemens, &text("MCALL HOLE(5,1,60)\nX10\nX20\nMCALL\nX0"), {
        (10.0, (90.0 + 10.0 + 5.0 + 10.0 + 5.0 + 20.0) / 500.0, 0.0, [0.0, 0.0, 10.0])
    });
    // Words that are no motions of a mill in three axes.
    does(
        Siemens,
        "G71 G90\nTRAFOOF\nCYCLE800()\nCYCLE832(0.01,_ROUGH,1)\nIF $P_SEARCH GOTOF END\nG1 X10 F600\nEND: M30",
        (1.0, 0.0, 0.0, [10.0, 0.0, 100.0]),
    );
    for (body, line, word) in [
        ("HOLE(20,2,60,1)", 8, "the call gives 4 values"),
        ("HOLE(20,_X)", 5, "_X has no value"),
        ("G1 X=$AA_IM[X] F9", 5, "$AA_IM"),
        ("R1=$TC_DP6", 5, "no function or variable"),
        ("R1=$P_TOOLNO", 5, "belongs to the control"),
        ("CYCLE800(4)", 5, "CYCLE800 is a cycle"),
    ] {
        let error = refused(Siemens, &text(body));
        assert!(error.line == line && error.message.contains(word), "{body}: {error}");
    }
    let plain = "%_N_MAIN_MPF\nG71\nSUB(5)\nM30\n%_N_SUB_SPF\nG0 X1\nM17";
    assert!(refused(Siemens, plain).message.contains("SUB takes no values"));
}

#[test]
fn deep_holes_of_siemens_slow_down_at_first_and_dwell_for_turns() {
    // 6 mm at half the feed and 4 mm more; 0.5 s at the first depth, 60 turns at the bottom, 0.2 s outside.
    let text = "G71 G90 G94 S600 M3 F60\nG0 X0 Y0 Z10\nCYCLE83(10,0,0,-10,,-6,,0,0.5,0.2,0.5,1,,,,-60,1)";
    // Out 6 mm, back to 1 mm above the depth, and on from there.
    does(Siemens, text, (12.0 + 5.0, (90.0 + 10.0 + 6.0 + 5.0 + 20.0) / 500.0, 0.5 + 6.0 + 0.2, [0.0, 0.0, 10.0]));
    assert!(refused(Siemens, &text.replace("0.5,1,,", "1.5,1,,")).message.contains("FRF"));
}

#[test]
fn words_of_fanuc_and_linuxcnc_that_change_no_path_are_followed() {
    does(Fanuc, "G21 G90\nG5 P10000\nG1 X10. F600\nG5 P0\nG5.1 Q1\nX20.", (2.0, 0.0, 0.0, [20.0, 0.0, 100.0]));
    assert!(refused(Fanuc, "G21 G90\nG5 P12").message.contains("P10000"));
    // Holes around a fourth axis: it turns to each of them at rapid speed, 45 degrees in 0.3 s.
    let around = "G21 G90\nG0 X0 Y0 Z10. A0\nG98 G81 Z-4. R1. F60\nA45.\nA90.\nG80";
    does(Fanuc, around, (15.0, (90.0 + 3.0 * (9.0 + 14.0)) / 500.0 + 0.6, 0.0, [0.0, 0.0, 10.0]));
    assert!(refused(LinuxCnc, around).message.contains("A45"));
    // Another offset of the table: the axes come from where only the machine knows.
    let found =
        sums("G21 G90 G54 G0 X5. Y5. Z5.\nG54 P12\nG1 X10. Y10. Z5. F600\nX20.", &control(Fanuc)).expect("a program");
    assert!((found.feed - 1.0).abs() < 1e-9, "{found:?}");
    // Without G98 or G99 the tool returns to the plane R, and behind a contour the first motion of all leads back to it.
    does(LinuxCnc, "G21 G90\nG0 Z20\nG81 X10 Y0 Z-8 R5 F60\nX20\nG80\nG0 Z20", {
        (26.0, (80.0 + 10.0 + 15.0 + 13.0 + 10.0 + 13.0 + 15.0) / 500.0, 0.0, [20.0, 0.0, 20.0])
    });
    let bored = "G21 G90\nG0 Z20\nG98 G89 X10 Y0 Z-8 R5 P0.5 F60\nG80";
    does(LinuxCnc, bored, (13.0 + 28.0, (80.0 + 10.0 + 15.0) / 500.0, 0.5, [10.0, 0.0, 20.0]));
    let contour = "G21 G17 G90 G64\nG0 X-40 Y0 Z0\nG41.1 D10 G1 X0 F600\nX50\nG40 G0 Z30\nX0";
    does(LinuxCnc, contour, (40.0_f64.hypot(5.0) / 10.0 + 5.0, (100.0 + 30.0 + 50.0) / 500.0, 0.0, [0.0, 0.0, 30.0]));
    does(LinuxCnc, "G21 G90\nG52 X10 Y0\nG1 X10 F600\nG52 X0\nG43.2 H2\nX0", (4.0, 0.0, 0.0, [0.0, 0.0, 100.0]));
}
