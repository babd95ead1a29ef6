//! Work offsets: where they lie to each other is known to the control, to the program, or to nobody.

use toolroom_program::{Control, Dialect, EventKind, Offset, Run};

/// Ends of all motions in X, Y and Z, mm, and the work offsets that are told; or why a program is refused.
fn ends(text: &str, control: &Control) -> Result<(Vec<[f64; 3]>, Vec<u32>), String> {
    let (mut ends, mut offsets) = (Vec::new(), Vec::new());
    for event in Run::new(text, control).map_err(|error| error.to_string())? {
        match event.map_err(|error| error.to_string())?.kind {
            EventKind::Motion(motion) => ends.push([motion.end[0], motion.end[1], motion.end[2]]),
            EventKind::Offset(Offset::Work(number)) => offsets.push(number),
            _ => {}
        }
    }
    Ok((ends, offsets))
}

/// A control on which G55 lies 100 mm beside and 5 mm below G54, and G56 50 mm behind it.
fn known(dialect: Dialect) -> Control {
    let mut control = Control::of(dialect);
    control.set("offset.G54", "10,20,0 mm").expect("a place");
    control.set("offset.G55", "110,20,-5 mm").expect("a place");
    control.set("offset.G56", "10,70,0 mm").expect("a place");
    control
}

const TWO_PARTS: &str =
    "G21 G90 G54 G0 X1. Y2. Z5.\nG1 Z-1. F100\nG0 Z5.\nG55 X1. Y2.\nZ5.\nG1 Z-1.\nG54 G0 X0. Y0. Z5.\nM30\n";

#[test]
fn known_offsets_are_worked_out_in_the_coordinates_of_the_first() {
    for dialect in [Dialect::Fanuc, Dialect::Haas, Dialect::LinuxCnc, Dialect::Siemens] {
        let text = if dialect == Dialect::Siemens { TWO_PARTS.replace("G21", "G71") } else { TWO_PARTS.to_owned() };
        let (places, offsets) = ends(&text, &known(dialect)).expect("a program");
        assert!(offsets.iter().all(|number| *number == 0), "{dialect:?}: {offsets:?}");
        let second = places.iter().position(|place| place[0] == 101.0).expect("a second part");
        // The height is kept, 5 mm above the first part, until the program names that of the second.
        assert_eq!(places[second], [101.0, 2.0, 5.0], "{dialect:?}");
        assert_eq!(places[second + 1], [101.0, 2.0, 0.0], "{dialect:?}");
        assert_eq!(places[second + 2], [101.0, 2.0, -6.0], "{dialect:?}");
        assert_eq!(places.last(), Some(&[0.0, 0.0, 5.0]), "{dialect:?}");
    }
    // What the program writes into the table of the control comes first.
    let text = "G21 G90\nG10 L2 P2 X60. Y20. Z0.\nG54 G0 X0. Y0. Z5.\nG55 X0.\nM30\n";
    let (places, _) = ends(text, &known(Dialect::Fanuc)).expect("a program");
    assert_eq!(places.last(), Some(&[50.0, 0.0, 5.0]));
}

#[test]
fn every_datum_of_klartext_has_a_number_of_its_own() {
    let text = |datums: [u32; 2]| {
        let [one, two] = datums.map(|datum| format!("CYCL DEF 247 DATUM SETTING ~\n Q339=+{datum} ;DATUM NUMBER"));
        format!(
            "BEGIN PGM P MM\nTOOL CALL 1 Z S1000\n{one}\nL X+0 Y+0 Z+5 R0 FMAX\nL Z-1 F100\nL Z+5 FMAX\n{two}\nL X+0 Y+0 Z+5 \
             FMAX\nL Z-1 F100\nEND PGM P MM\n"
        )
    };
    let mut control = Control::of(Dialect::Heidenhain);
    control.one_place = true;
    for datums in [[0, 1], [1, 0], [0, 100], [99, 100], [100, 101]] {
        let refused = ends(&text(datums), &control).expect_err("two places");
        assert!(refused.contains("another work offset"), "{datums:?}: {refused}");
    }
    for datum in [0, 1, 100] {
        assert!(ends(&text([datum; 2]), &control).is_ok(), "{datum}");
    }
}

#[test]
fn an_offset_that_is_not_known_is_told_and_cuts_in_no_other_place() {
    let mut control = Control::of(Dialect::Fanuc);
    let (_, offsets) = ends(TWO_PARTS, &control).expect("a program");
    assert_eq!(offsets, [0, 1, 0]);
    control.one_place = true;
    let refused = ends(TWO_PARTS, &control).expect_err("two places");
    assert!(refused.contains("6:") && refused.contains("offset.G55"), "{refused}");
    // Nothing is cut in the other one, everything is, or it is G56 that is not known of two that are.
    for text in
        ["G21 G90 G54 G0 X1.\nG1 X2. F100\nG55 G0 X0.\nG54 G1 X3.\nM30\n", "G21 G90 G55 G0 X1.\nG1 X2. F100\nM30\n"]
    {
        assert!(ends(text, &control).is_ok(), "{text}");
    }
    control.set("offset.G55", "100,0,0 mm").expect("a place");
    assert!(ends(TWO_PARTS, &control).is_ok());
    let refused = ends(&TWO_PARTS.replace("G55", "G56"), &control).expect_err("two places");
    assert!(refused.contains("6:"), "{refused}");
    for (key, value) in
        [("offset.G60", "0,0,0 mm"), ("offset.G55", "0,0 mm"), ("offset.G55", "0,0,0"), ("offset.55", "0,0,0 mm")]
    {
        assert!(control.set(key, value).is_err(), "{key}={value}");
    }
}
