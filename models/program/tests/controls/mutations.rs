//! Programs with faults: each is refused or runs, in any of the languages.

use proptest::prelude::*;
use toolroom_program::{Blocks, Control, Dialect, EventKind, Run};

/// Programs to spoil, with their language.
const PROGRAMS: [(Dialect, &str); 9] = [
    (Dialect::Fanuc, include_str!("programs/fanuc-macros.nc")),
    (Dialect::Fanuc, include_str!("programs/fanuc-corners.nc")),
    (Dialect::Haas, include_str!("programs/haas-patterns.nc")),
    (Dialect::FanucLathe, include_str!("programs/lathe-rough-and-thread.nc")),
    (Dialect::Siemens, include_str!("programs/siemens-cycles.mpf")),
    (Dialect::Siemens, include_str!("programs/siemens-polar.mpf")),
    (Dialect::Heidenhain, include_str!("programs/klartext-patterns.h")),
    (Dialect::Heidenhain, include_str!("programs/klartext-approach.h")),
    (Dialect::LinuxCnc, include_str!("programs/linuxcnc-o-words.ngc")),
];
/// What is put in the place of a number.
const NUMBERS: [&str; 12] =
    ["0", "-1", ".", "-", "1e9", "999999999999999999999", "4294967296", "0.0000001", "360", "#0", "[", "="];

/// A fault: what kind, where as a share of the text, and which.
type Edit = (u8, f64, usize);

/// A text with a fault more.
fn spoil(text: &mut Vec<u8>, (kind, place, which): Edit) {
    let at = (place * text.len() as f64) as usize;
    if at >= text.len() {
        return;
    }
    match kind {
        0 => text[at] = which as u8,
        1 => drop(text.drain(at..(at + which % 12).min(text.len()))),
        2 => drop(text.splice(at..at, NUMBERS[which % NUMBERS.len()].bytes())),
        3 => {
            let number = |byte: &u8| byte.is_ascii_digit() || *byte == b'.';
            let Some(from) = text[at..].iter().position(number).map(|gap| at + gap) else { return };
            let to = text[from..].iter().position(|byte| !number(byte)).map_or(text.len(), |gap| from + gap);
            drop(text.splice(from..to, NUMBERS[which % NUMBERS.len()].bytes()));
        }
        4 => {
            let mut lines: Vec<Vec<u8>> = text.split(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
            let count = lines.len();
            lines.swap((place * count as f64) as usize % count, which % count);
            *text = lines.join(&b'\n');
        }
        _ => text.truncate(at),
    }
}

proptest! {
    #[test]
    fn spoiled_programs_are_refused_or_take_a_time(
        which in 0..PROGRAMS.len(),
        edits in prop::collection::vec((0..6_u8, 0.0..1.0_f64, any::<usize>()), 1..6),
    ) {
        let (dialect, text) = PROGRAMS[which];
        let mut text = text.as_bytes().to_vec();
        edits.into_iter().for_each(|edit| spoil(&mut text, edit));
        let text = String::from_utf8_lossy(&text);
        let control = Control { steps: 5000, ..Control::of(dialect) };
        for block in Blocks::new(text.as_ref(), &control).expect("the language is given").take(20_000) {
            let Ok(block) = block else { break };
            let time = block.nominal(0.5);
            prop_assert!(time.is_finite() && time >= 0.0, "{time} s\n{text}");
        }
    }
}

#[test]
fn an_arc_that_begins_at_an_unknown_place_has_no_length_and_is_refused() {
    let first = |text: &str| {
        Run::new(text, &Control::of(Dialect::Fanuc)).expect("a program").find_map(|event| match event {
            Ok(event) => matches!(event.kind, EventKind::Motion(motion) if !motion.rapid && motion.length > 1.0)
                .then_some(Ok(())),
            Err(error) => Some(Err(error.to_string())),
        })
    };
    // Where Y is, nothing says: the arc was timed as if it began at Y0.
    let refused = first("G21 G90 G0 X30.\nG3 X40. Y10. R10. F100\nM30\n").expect("a refusal").expect_err("no length");
    assert!(refused.contains("2:") && refused.contains("a place of Y") && refused.contains("--start"), "{refused}");
    // A full circle and an arc by steps are the same wherever they begin.
    assert_eq!(first("G21 G90 G0 X30.\nG3 I10. J0. F100\nM30\n"), Some(Ok(())));
    assert_eq!(first("G21 G91\nG3 X10. Y10. R10. F100\nM30\n"), Some(Ok(())));
}
