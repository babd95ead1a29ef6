//! Programs of more lines than are kept: what jumps far reads its blocks again.

use super::{Sums, control, sums};
use toolroom_program::{Control, Dialect, Run, Source};

/// As [`sums`], of a program that stays in its file.
fn sums_of_file(name: &str, text: &str, control: &Control) -> Sums {
    let path = std::env::temp_dir().join(format!("toolroom-long-{}-{name}", std::process::id()));
    std::fs::write(&path, text).expect("a file");
    let mut sums = Sums::default();
    for event in Run::new(Source::open(&path).expect("a file"), control).expect("a language") {
        if let toolroom_program::EventKind::Motion(motion) = event.expect("an event").kind {
            sums.feed += motion.time;
        }
    }
    std::fs::remove_file(path).expect("it goes");
    sums
}

/// So many lines of 1 mm back and forth along Y, two of them a number.
fn filler(count: usize, line: impl Fn(usize) -> String) -> String {
    (0..count).map(|index| line(index) + "\n").collect()
}

fn takes(name: &str, dialect: Dialect, text: &str, seconds: f64) {
    let mut control = control(dialect);
    control.steps = 10_000_000;
    // The way to Y1 at the beginning is one more.
    let seconds = seconds + 1.0;
    let memory = sums(text, &control).unwrap_or_else(|error| panic!("{name}: {error}"));
    let file = sums_of_file(name, text, &control);
    assert!((memory.feed - seconds).abs() < 1e-6 * seconds, "{name}: {} {seconds}", memory.feed);
    assert_eq!(memory.feed.to_bits(), file.feed.to_bits(), "{name}");
}

#[test]
fn jumps_and_loops_reach_over_many_lines() {
    // 1 mm at 60 mm/min is a second.
    let iso = |index: usize| format!("Y{}.", index % 2);
    let text = format!(
        "G21 G90 G1 F60 X0 Y1.\n#1=0\nWHILE[#1LT2]DO1\n#1=#1+1\n{}M98 P7 L3\nEND1\nIF[#2EQ5]GOTO900000\n#2=5\nGOTO10\nM30\n\
         N900000\nM30\nO7\n{}M99\nN10\nY5.\n",
        filler(45_000, iso),
        filler(30_000, iso),
    );
    // The block N10 stands behind the subprogram, and no GOTO leads into another program.
    let refused = sums(&text, &control(Dialect::Fanuc));
    assert!(refused.is_err());
    let text = text.replace("GOTO10\n", "GOTO2\n").replace("#1=0\n", "N2 #1=#1\n").replace("[#1LT2]", "[#1LT2.5]");
    // Loops: #1 is vacant and counts as 0: 1, 2, 3; behind the jump back it is 3 already.
    takes("fanuc", Dialect::Fanuc, &text, 3.0 * (45_000.0 + 90_000.0));

    let text = format!(
        "%_N_LONG_MPF\nG71 G90 G1 F60 X0 Y1\nR1=0\nAGAIN: R1=R1+1\n{}CROSS P=2\nIF R1<3 GOTOB AGAIN\nM30\n%_N_CROSS_SPF\n{}M17\n",
        filler(45_000, |index| format!("Y{}", index % 2)),
        filler(30_000, |index| format!("Y{}", index % 2)),
    );
    takes("siemens", Dialect::Siemens, &text, 3.0 * (45_000.0 + 60_000.0));

    let klartext = |index: usize| format!("{} L Y+{} ~\n F60", index + 10, index % 2);
    let text = format!(
        "0 BEGIN PGM LONG MM\n1 L X+0 Y+1 R0 F60\n2 LBL 1\n{}3 CALL LBL 1 REP 2\n4 CALL LBL 9\n5 M30\n6 LBL 9\n{}7 LBL 0\n8 END PGM LONG MM\n",
        filler(45_000, klartext),
        filler(30_000, klartext),
    );
    takes("heidenhain", Dialect::Heidenhain, &text, 3.0 * 45_000.0 + 30_000.0);

    let text = format!(
        "G21 G90 G1 F60 X0 Y1\no1 sub\n{}o1 endsub\no2 repeat [2]\n{}o3 if [#5 eq 1]\no1 call\no3 else\n#5=1\no3 endif\no2 endrepeat\nM2\n",
        filler(30_000, |index| format!("Y{}", index % 2)),
        filler(45_000, |index| format!("Y{}", index % 2)),
    );
    takes("linuxcnc", Dialect::LinuxCnc, &text, 2.0 * 45_000.0 + 30_000.0);
}
