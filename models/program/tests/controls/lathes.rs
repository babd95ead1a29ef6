//! Holes and pockets on lathes. What they do was worked out as lists of moves, apart from the reader.

use super::{control, does, refused, sums};
use toolroom_program::{Dialect, Dialect::FanucLathe};

/// Time at rapid speed, s: of each travel, mm, along the longest axis, and of turns, degrees.
fn rapid(travels: &[f64], degrees: &[f64]) -> f64 {
    travels.iter().sum::<f64>() / 500.0 + degrees.iter().sum::<f64>() / 150.0
}

#[test]
fn holes_in_face_and_side_of_a_lathe_are_drilled_from_the_plane_that_r_steps_to() {
    // Through the middle in one go: to the plane 3 mm below the start, down to −20, out to the start.
    does(FanucLathe, "G21 G98\nG0 X0 Z5.\nG83 Z-20. R-3. P500 F120.\nG80\nG0 Z10.", {
        (11.0, rapid(&[95.0, 3.0, 25.0, 5.0], &[]), 0.5, [0.0, 0.0, 10.0])
    });
    // Three holes on a circle, each with the depth as a step below the plane; C by place and by step.
    let circle = "G21 G98\nG0 X50. Z5. C0\nG83 W-22. R-3. F120. M31\nC90. M31\nH90. M31\nG80\nM30";
    let due = (33.0, rapid(&[95.0, 3.0, 25.0, 3.0, 25.0, 3.0, 25.0], &[90.0, 90.0]), 0.0, [50.0, 0.0, 5.0]);
    does(FanucLathe, circle, due);
    // Pecks of 8 mm, drawn back by 1 mm: 18 mm and twice the millimetre again.
    let pecks = "G21 G98\nG0 X0 Z5.\nG83 Z-16. R-3. Q8000 F60.\nG80";
    does(FanucLathe, pecks, (20.0, rapid(&[95.0, 3.0, 1.0, 1.0, 21.0], &[]), 0.0, [0.0, 0.0, 5.0]));
    let mut full = control(FanucLathe);
    full.set("pecks", "full").expect("a setting");
    let found = sums(pecks, &full).expect("a program");
    // Out of 8 and 16 mm to the plane, and down again to 1 mm above.
    let due = rapid(&[95.0, 3.0, 8.0, 7.0, 16.0, 15.0, 21.0], &[]);
    assert!((found.feed - 20.0).abs() < 1e-9 && (found.rapid - due).abs() < 1e-9, "{found:?}");
    // From the side: X is a diameter, R a radius; a tap turns back, a boring tool comes out at twice the feed.
    does(FanucLathe, "G21 G98\nG0 X60. Z-10.\nG97 S500 M3\nG88 X40. R-4. F300.\nG80", {
        (2.4, rapid(&[110.0, 4.0, 4.0], &[]), 0.0, [60.0, 0.0, -10.0])
    });
    does(FanucLathe, "G21 G98\nG0 X60. Z-10.\nG89 X40. R-4. P1000 F300. K2\nG80 G0 X70.", {
        (3.6, rapid(&[110.0, 4.0, 4.0, 4.0, 4.0, 5.0], &[]), 2.0, [70.0, 0.0, -10.0])
    });
}

#[test]
fn holes_of_lathes_that_nobody_understands_are_refused() {
    for (text, line, word) in [
        ("G21 G98 G0 X0 Z5.\nG81 Z-9. R-3. F60.", 2, "G83 to G85 along Z"),
        ("G21 G98 G0 X0 Z5.\nG83 R-3. F60. C9.", 2, "the depth of G83 is missing: write Z or W"),
        ("G21 G98 G0 X0 Z5.\nG83 Z-3. R-9. F60.", 2, "beyond its bottom"),
        ("G21 G98 G0 X0 Z5.\nG83 Z-3. R-2.", 2, "no feed"),
        ("G21 G98 G0 X0 C9. H9.", 1, "C is given twice"),
    ] {
        let error = refused(FanucLathe, text);
        assert!(error.line == line && error.message.contains(word), "{text}: {error}");
    }
}

/// Radius 15 with a groove of radius 12 between −10 and −23, up to radius 20 at −30.
const GROOVE: &str = "Z-10.\nX24. Z-13.\nZ-20.\nX30. Z-23.\nZ-30.\nN20 X40.\nG0 Z2.";

#[test]
fn a_contour_with_a_pocket_is_roughed_by_type_two_and_refused_by_type_one() {
    let text = format!("G21 G98 F600\nG0 X40. Z2.\nG71 U2. R1.\nG71 P10 Q20 U0 W0\nN10 G0 X30. Z2.\nG1 {GROOVE}");
    let diagonal = 2f64.sqrt();
    // Passes at radius 18 and 16 up to the shoulder; in the groove down from 16 to 15, the flank to 14, along, and up to 15.
    let passes = 32.0 + 2.0 + 32.0 + 2.0 + 1.0 + diagonal + 11.0 + diagonal;
    let contour = 12.0 + 3.0 * diagonal + 7.0 + 3.0 * diagonal + 7.0 + 5.0;
    let travels = [98.0, 2.0, 1.0, 32.0, 5.0, 1.0, 20.0, 3.0, 2.0, 3.0, 25.0, 5.0, 32.0];
    does(FanucLathe, &text, ((passes + contour) / 10.0, rapid(&travels, &[]), 0.0, [40.0, 0.0, 2.0]));
    // The first block without Z is of type I.
    let error = refused(FanucLathe, &text.replace("N10 G0 X30. Z2.", "N10 G0 X30."));
    assert!(error.line == 4 && error.message.contains("has a pocket"), "{error}");
    // Back along the axis no pass can go.
    let back = text.replace("X30. Z-23.", "X30. Z-15.");
    assert!(refused(FanucLathe, &back).message.contains("turns back along Z"));
}

#[test]
fn a_contour_without_pockets_is_roughed_alike_by_both_types_but_for_the_shoulders() {
    let text = "G21 G98 F600\nG0 X40. Z2.\nG71 U2. R1.\nG71 P10 Q20 U0 W0\nN10 G0 X30. Z2.\nG1 Z-30.\nN20 X40.";
    // Radius 18 and 16 along the whole length, each up the shoulder to the pass before; then the contour.
    does(FanucLathe, text, {
        let feed = 2.0 * (32.0 + 2.0) + 32.0 + 5.0;
        let travels = [98.0, 2.0, 1.0, 32.0, 5.0, 1.0, 1.0, 32.0, 5.0, 32.0];
        (feed / 10.0, rapid(&travels, &[]), 0.0, [40.0, 0.0, 2.0])
    });
    // The depth of a pass as D, in one block.
    let one = text.replace("G71 U2. R1.\n", "").replace("U0 W0", "U0 W0 D2000");
    let (one, two) = (sums(&one, &control(FanucLathe)), sums(&text.replace("R1.", "R0"), &control(FanucLathe)));
    assert_eq!(one.expect("a program").feed, two.expect("a program").feed);
    // Inside a bore the contour lies outwards.
    let bore = "G21 G98 F600\nG0 X20. Z2.\nG71 U2. R1.\nG71 P10 Q20 U0 W0\nN10 G0 X30. Z2.\nG1 Z-30.\nN20 X20.";
    let inside = sums(bore, &control(FanucLathe)).expect("a program");
    assert!((inside.feed - (2.0 * (32.0 + 2.0) + 32.0 + 5.0) / 10.0).abs() < 1e-9, "{inside:?}");
}

#[test]
fn a_lathe_is_known_by_tools_with_their_offset_where_no_word_of_a_mill_stands() {
    let found = |text: &str| Dialect::detect(text, None).expect("a language").0;
    assert_eq!(found("G21 G99\nT0101\nG0 X0 Z5.\nG83 Z-9. R-2. F0.1\nT0303"), FanucLathe);
    assert_eq!(found("G21 G17\nT0101 M6\nG0 X0 Z5."), Dialect::Fanuc);
    assert_eq!(found("G21\nT1200 M6\nG43 H12 Z5."), Dialect::Fanuc);
}
