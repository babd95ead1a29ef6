//! Part programs of milling machines: what each block moves, and how long it takes.
//!
//! ```text
//!  G-code ─► Program: Blocks of Motions, dwells, tool changes, holes ─► times(Drives) ─► s per block
//! ```

mod codes;
mod cycle;
mod dialect;
mod error;
mod motion;
mod read;
mod state;
mod stretch;
mod timing;
mod words;

pub use error::{ProgramError, ProgramFault};
pub use motion::Motion;
pub use stretch::{Stretch, StretchKind};
pub use timing::Drives;

/// Unit of the lengths of a program that does not name one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// Millimetres, and millimetres a minute or a revolution.
    Millimetre,
    /// Inches, and inches a minute or a revolution.
    Inch,
}

impl Units {
    /// Words for files and options, in the order of [`Units::named`].
    pub const NAMES: [&'static str; 2] = ["mm", "inch"];

    /// The unit of a name of [`Units::NAMES`].
    pub fn named(name: &str) -> Option<Self> {
        match name {
            "mm" => Some(Self::Millimetre),
            "inch" => Some(Self::Inch),
            _ => None,
        }
    }
}

/// One line of a part program.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Block {
    /// Line of the file, from 1.
    pub line: usize,
    /// Tool in the spindle behind the block, where one was called.
    pub tool: Option<u32>,
    /// Motions in order.
    pub motions: Vec<Motion>,
    /// Programmed dwell, s.
    pub dwell: f64,
    /// Whether the tool is changed.
    pub tool_change: bool,
    /// Holes of a canned cycle.
    pub holes: u32,
    /// Auxiliary functions, by number.
    pub auxiliary: Vec<u32>,
    /// Whether the axes come to rest behind it though the path goes on.
    pub exact_stop: bool,
}

impl Block {
    /// Time of its motions at programmed feeds and `rapid_speed` of each axis, and of its dwell, s:
    /// no axis needs time to accelerate.
    pub fn nominal(&self, rapid_speed: f64) -> f64 {
        self.dwell + self.motions.iter().map(|motion| motion.nominal(rapid_speed)).sum::<f64>()
    }

    /// The part of [`nominal`](Self::nominal) that follows the feed override, s.
    pub fn feed_time(&self) -> f64 {
        self.motions.iter().filter_map(|motion| motion.feed.map(|feed| motion.length / feed)).sum()
    }
}

impl Motion {
    fn nominal(&self, rapid_speed: f64) -> f64 {
        self.feed.map_or(self.longest / rapid_speed, |feed| self.length / feed)
    }
}

/// A part program.
///
/// ```
/// use toolroom_contour::{Drives, Program};
/// let program = Program::read("T1 M6\nG21 G90 G0 X0 Y0 Z5\nG1 Z-1 F60\nX120 F1200\nG4 P0.5\nM30").unwrap();
/// let drives = Drives { tool_change_time: 4.0, ..Drives::default() };
/// let times = program.times(&drives);
/// assert_eq!((times[0], times[2], times[3], times[4]), (4.0, 6.0, 6.0, 0.5));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// Blocks in the order of the file, one a line; empty lines are none.
    pub blocks: Vec<Block>,
    /// Motions whose length is not known because they come from a reference point or another
    /// coordinate system: they count with the axes that are known. Lines.
    pub unknown: Vec<usize>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Programs of tests are in millimetres where they do not say.
    fn read(text: &str) -> Program {
        Program::read_in(text, Some(Units::Millimetre)).unwrap_or_else(|error| panic!("{error}"))
    }

    fn total(text: &str) -> f64 {
        read(text).times(&Drives::default()).iter().sum()
    }

    fn fault(text: &str) -> (usize, ProgramFault) {
        let error = Program::read_in(text, Some(Units::Millimetre)).expect_err("a fault");
        (error.line, error.fault)
    }

    /// Line, word and reason of a word that is not followed.
    fn refused(text: &str) -> (usize, String, &'static str) {
        match fault(text) {
            (line, ProgramFault::Unsupported { word, reason }) => (line, word, reason),
            (line, other) => panic!("line {line}: {other}"),
        }
    }

    #[test]
    fn a_program_of_a_cam_system_is_read() {
        let text = "%\nO0000(BOX OP1)\n(T1| 3/4 FLAT ENDMILL|H0)\nN100G20\nN110G0G17G40G49G80G90\nN120T1M6\n\
            N130G0G90G54X1.Y-1.S12000M3\nN140Z1.M8\nN150Z.1\nN160G1Z0.F30.\nN170X2.\nN180G3X2.Y0.I0.J.5\n\
            N190G0Z1.\nN200M5\nN210G91G28Z0.M9\nN220M01\nN230T21M6\nN240G0G90G54X0.Y0.S3000M3\nN250Z1.M8\n\
            N260G98G81Z-.1R.05F10.\nN270X1.\nN280G80\nN290M5\nN300G91G28Z0.M9\nN310G90G58X12.Y20.\nN320M30\n%\n";
        let program = read(text);
        let block = |line: usize| program.blocks.iter().find(|block| block.line == line).expect("a block of the line");
        assert_eq!((block(6).tool, block(6).tool_change, block(16).tool), (Some(1), true, Some(1)));
        assert_eq!(block(17).tool, Some(21));
        assert!((block(11).feed_time() - 2.0).abs() < 1e-6, "an inch at 30 in/min");
        assert!((block(12).feed_time() - std::f64::consts::PI).abs() < 1e-3);
        // From 1 in down to .05, at feed to −.1, and back.
        let hole = block(20);
        let (feed, rapid) = (0.15 / 10.0 * 60.0, 0.0254 * (0.95 + 0.15 + 0.95) / 0.5);
        assert_eq!(hole.holes, 1);
        assert!((hole.nominal(0.5) - feed - rapid).abs() < 1e-6, "{}", hole.nominal(0.5));
        assert_eq!(program.blocks.iter().map(|block| block.holes).sum::<u32>(), 2);
        assert_eq!(program.blocks.last().map(|block| block.line), Some(26));
        let kinds: Vec<StretchKind> = program.stretches(10.0, 0.5).iter().map(|stretch| stretch.kind).collect();
        use StretchKind::*;
        assert_eq!(kinds, [Change, Motion, Change, Holes, Auxiliary]);
    }

    #[test]
    fn pecks_leave_the_hole_as_their_cycle_says() {
        let hole = |cycle: &str| {
            let program = read(&format!("G90 G0 X0 Y0 Z10\nG99 {cycle} F60"));
            program.blocks[1].feed_time()
        };
        assert!((hole("G81 Z-5 R1") - 6.0).abs() < 1e-9);
        assert!((hole("G83 Z-5 R1 Q2") - 6.0).abs() < 1e-9);
        assert!((hole("G84 Z-5 R1") - 12.0).abs() < 1e-9);
        // Down to −1, −3, −5 and out each time.
        assert!((hole("G84 Z-5 R1 Q2") - 24.0).abs() < 1e-9);
        assert!((hole("G85 Z-5 R1") - 12.0).abs() < 1e-9);
    }

    #[test]
    fn dwells_are_taken_where_the_program_shows_their_unit() {
        let dwell = |header: &str, word: &str| {
            let program = read(&format!("{header}\nG0 X0 Y0 Z0 S600 M3\nG1 X1 F60\nG4 {word}\nX2"));
            // The feed behind it is that before it.
            assert_eq!(program.blocks[4].feed_time(), 1.0);
            program.blocks[3].dwell
        };
        let numbered = |word| dwell("O7 (NUMBERED)", word);
        assert_eq!((numbered("P500"), numbered("P0.5"), numbered("X2"), numbered("P2.")), (0.5, 0.5, 2.0, 2.0));
        assert_eq!((dwell("(NONE)", "P0.5"), dwell("(NONE)", "X2."), dwell("(NONE)", "P0")), (0.5, 2.0, 0.0));
        for header in ["%_N_PART_MPF", ";$PATH=/_N_MPF_DIR"] {
            assert_eq!((dwell(header, "F2"), dwell(header, "S10")), (2.0, 1.0));
        }
        let unknown = |header: &str, word: &str| {
            let text = format!("{header}\nG0 X0 Y0 Z0\nG4 {word}");
            assert!(matches!(fault(&text), (3, ProgramFault::Dwell { .. })), "{text}");
        };
        for word in ["P500", "F2", "S10", "", "P0.5 X1", "X-1."] {
            unknown("(NONE)", word);
        }
        for word in ["F2", "S10", "X1. U1.", "P-1"] {
            unknown("O7", word);
        }
        unknown("%_N_PART_MPF", "S10"); // no speed stands before it
        let hole = "G0 X0 Y0 Z5\nG82 X1.5 Z-1. R1. F60";
        assert_eq!(read(&format!("O7\n{hole} P300")).blocks[2].dwell, 0.3);
        assert!(matches!(fault(&format!("{hole} P300")), (2, ProgramFault::Dwell { .. })));
    }

    #[test]
    fn a_unit_has_to_be_named() {
        let error = |text: &str| Program::read(text).expect_err("no unit");
        for (text, line) in [("G0 X0 Y0\nG1 X1 F9", 2), ("G90\nG0 X5", 2), ("G0 X1\nG21\nX2", 1)] {
            let error = error(text);
            assert_eq!((error.line, &error.fault), (line, &ProgramFault::NoUnits));
            assert!(error.to_string().contains("G21 or G20") && error.to_string().contains("--units mm"));
        }
        // Zero is the same in either unit.
        assert!(Program::read("G91 G28 Z0\nG90 G0 X0 Y0\nG20 G1 X1 F9").is_ok());
        assert!(Program::read("%_N_P_MPF\nG0 G71 X0 Y0 Z0\nG1 X1 F9").is_ok());
        assert!(Program::read("%_N_P_MPF\nG700 G0 X0 Y0 Z0\nG1 X1 F9").is_ok());
        // Cycles of other controls, and feeds in a unit of the machine.
        assert_eq!(refused("G71 G0 X1").0, 1);
        assert_eq!(refused("%_N_P_MPF\nG70 G0 X1").0, 2);
        let inch = Program::read_in("G0 X0 Y0 Z0\nG1 X1 F60", Some(Units::Inch)).expect("a program");
        assert!((inch.blocks[1].feed_time() - 1.0).abs() < 1e-12);
        assert_eq!(Units::NAMES.map(Units::named), [Some(Units::Millimetre), Some(Units::Inch)]);
    }

    #[test]
    fn whatever_is_not_known_to_take_no_time_is_refused_with_its_line() {
        let start = "G0 X0 Y0 Z5\nG1 X9 F60\n";
        let words = [
            ("M97 P100", "M97"),
            ("M98 P100", "M98"),
            ("M99", "M99"),
            ("M10", "M10"),
            ("M60", "M60"),
            ("G5 P1 Q1 I1 J1 X9", "G5"),
            ("G5.1 X9", "X9"),
            ("G5.2", "G5.2"),
            ("G41 D1 X1", "G41"),
            ("G43.4 H1", "G43.4"),
            ("G60", "G60"),
            ("G65 P9", "G65"),
            ("G68 X0 Y0 R90", "G68"),
            ("G90.1", "G90.1"),
            ("G93", "G93"),
            ("G96 S200", "G96"),
            ("G99 X8", "G99"),
            ("G50 S3000", "G50"),
            ("G50 X100", "X100"),
            ("G92 S2000", "G92"),
            ("G81 Z-1 R1 X1\nG54.1 P2 X5", "P"),
            ("G83 Z-1 R1 Q1 X1\nG5.1 Q1", "Q"),
            ("G411", "G411"),
            ("G10 L50", "G10"),
            ("G33 Z1 K1", "G33"),
            ("G1 A90", "A90"),
            ("X8 B1", "B1"),
            ("U8", "U8"),
            ("X8 R1", "R1"),
            ("X8 I1", "I1"),
            ("X8 K5", "K5"),
            ("X8 L2", "L2"),
            ("X8 P2", "P2"),
            ("G2 X9 Y0 I1 J0 P3", "P3"),
            ("G2 X9 Y0 I1 J0 L2", "L2"),
            ("G81 Z-1 R1 K5", "K5"),
            ("G81 Z-1 R1 P100", "P100"),
            ("G81 Z-1 R1 L1.5", "L1.5"),
            ("G83 Z-1 R1 I1", "I1"),
            ("H3", "H3"),
            ("D3", "D3"),
            ("O2", "O2"),
            ("X8 X9", "X9"),
            ("T1 T2", "T2"),
            ("/X30", "/"),
            ("GOTO 1", "GOTO1"),
            ("o100 call", "CALL"),
            ("TRANS X10", "TRANS"),
            ("G1 X1 RND2", "RND2"),
            ("L X+10 FMAX", "LX"),
        ];
        for (block, word) in words {
            let found = match fault(&format!("{start}{block}")) {
                (3 | 4, ProgramFault::Unsupported { word, .. }) => word.to_uppercase(),
                // A label of LinuxCNC is no number.
                (3, ProgramFault::Syntax { message }) if message.contains('`') => "CALL".to_owned(),
                other => panic!("{block}: {other:?}"),
            };
            // The reader drops blanks, so that what follows a word may stand with it.
            assert!(found.starts_with(word), "{block}: {found}");
        }
        for block in
            ["X#1", "X[1+2]", "X=R1", "R1=30", "X-#1", "F#5", "#1=3", "G#1", "T=\"MILL\"", "X8,R2", "X=AC(9)", "M3=5"]
        {
            let (line, fault) = fault(&format!("{start}{block}"));
            assert_eq!(line, 3, "{block}");
            assert!(matches!(fault, ProgramFault::Variable { .. } | ProgramFault::Syntax { .. }), "{block}: {fault}");
        }
        for block in ["G2 X9 Y2 R1 I0 J1", "G2 X9 Y2 I0 J1 K3"] {
            assert!(matches!(fault(&format!("{start}{block}")), (3, ProgramFault::Arc { .. })), "{block}");
        }
        assert!(matches!(fault(&format!("{start}(OPEN")), (3, ProgramFault::Syntax { .. })));
        // In a program for a Siemens control parentheses hold no comment, and no hole is bored by G81.
        assert_eq!(fault(&format!("%_N_P_MPF\n{start}MSG(\"HI\")")).0, 4);
        assert_eq!(refused(&format!("%_N_P_MPF\n{start}G81 Z-1 R1")).0, 4);
    }

    #[test]
    fn what_takes_no_time_is_passed_over() {
        let plain = total("G90 G17 G0 X0 Y0 Z5\nG1 X50 F600\nY40\nG0 Z9");
        let dressed = total(
            "%\nO0007 (PART)\n(PLAIN; AND OTHERWISE)\n\nN1 G90 G17 G40 G49 G80 G94 G97 G98 G64 G15 G69 G50\n\
             T3 M6\nS1200 M3 M8\nG54\nN2 G0 X0 Y0 Z5 ; HOME\nM29\nG5.1 Q1\nG8 P1\nG1 X50 F600 S1300 (FEED)\n\
             M01\nN3 Y40\nG0 Z9 M9\nM5 M19\nM30\n%\nTHE REST IS NOT READ ]",
        );
        assert_eq!(plain, dressed);
    }

    #[test]
    fn a_motion_that_differs_by_control_has_to_be_written() {
        for (text, line) in [("X5", 1), ("G0 X0 Y0 Z5\nG1 Z1 F9\nG81 Z-1 R1 X1\nG80\nX9", 5)] {
            assert!(matches!(fault(text), (at, ProgramFault::NoMotion) if at == line), "{text}");
        }
        // A rapid motion before the cycle is one behind it, on every control that goes on.
        assert!(read("G0 X0 Y0 Z5\nG81 Z-1 R1 X1 F9\nG80\nX9").blocks[3].feed_time() == 0.0);
        // A feed a minute is none a revolution.
        assert!(matches!(fault("G0 X0 Y0 Z0 S100\nG1 X1 F60\nG95 X2"), (3, ProgramFault::NoFeed)));
        // Another length of the tool shifts Z by what the machine knows.
        let program = read("G0 X0 Y0 Z5\nG43 H1 Z4\nG43 H1 Z3\nH2 Z2\nG49 X1");
        assert_eq!(program.unknown, [1, 2, 4]);
    }

    #[test]
    fn inches_and_increments_take_the_same_time() {
        let metric = total("G21 G90 G0 X0 Y0 Z0\nG1 X25.4 F254\nG2 X50.8 I12.7 J0");
        let inch = total("G20 G91 G0 X0 Y0 Z0\nG1 X1 F10\nG2 X1 I0.5 J0");
        assert!((metric - inch).abs() < 1e-9 * metric);
        let planes = total("G18 G0 X0 Y0 Z0\nG2 X10 Z10 R10 F100");
        assert!((planes - total("G17 G0 X0 Y0 Z0\nG2 X10 Y10 R10 F100")).abs() < 1e-9);
    }

    #[test]
    fn ways_from_unknown_places_are_said() {
        let program = read("G21 G54 G0 X0 Y0 Z5\nG91 G28 Z0\nG90 G0 Z5\nG55 X1\nG1 X2 F100");
        assert_eq!(program.unknown, [1, 2, 3, 4]);
    }

    #[test]
    fn faults_name_their_line_and_fix() {
        assert!(matches!(fault("G0 X0\nG1 X1"), (2, ProgramFault::NoFeed)));
        assert!(matches!(fault("G0 X0 Y0\nG1 X1 F1\nM98 P100"), (3, ProgramFault::Unsupported { .. })));
        assert!(matches!(fault("G0 X0\nG65 P1"), (2, ProgramFault::Unsupported { .. })));
        assert!(matches!(fault("G0 X0 Y0 Z0\nG83 X1 Z-1 R1 F10"), (2, ProgramFault::Cycle { cycle: 83, .. })));
        assert!(matches!(fault("G0 X0 Y0 Z0\nG1 F10 X1\nG2 X5 Y5 I1 J0"), (3, ProgramFault::Arc { .. })));
        assert!(matches!(fault("M3 S1000"), (1, ProgramFault::Empty)));
        assert!(matches!(
            fault("G0 X0\nG4 X1. G1 X2 F9"),
            (2, ProgramFault::TwoMotions | ProgramFault::Unsupported { .. })
        ));
    }

    proptest! {
        #[test]
        fn any_text_is_answered_without_panic(text in "[GXYZIJRMTFSPQL0-9. \\n(;%/#-]{0,80}") {
            answered(&text)?;
        }

        /// Signs of a real program go astray.
        #[test]
        fn a_mutated_program_is_answered_without_panic(
            which in 0..PROGRAMS.len(),
            changes in prop::collection::vec((any::<prop::sample::Index>(), 0..3_u8, any::<char>(), "[A-Z0-9.+#=/%()\\n-]"), 1..12),
        ) {
            let mut signs: Vec<char> = PROGRAMS[which].chars().collect();
            for (at, change, any, likely) in changes {
                let at = at.index(signs.len());
                let sign = if change == 0 { any } else { likely.chars().next().unwrap_or('G') };
                match change {
                    0 | 1 => signs[at] = sign,
                    _ => signs.insert(at, sign),
                }
                if signs.len() > 2 && sign == '.' {
                    signs.remove(at);
                }
            }
            answered(&signs.into_iter().collect::<String>())?;
        }
    }

    const PROGRAMS: [&str; 3] = [
        "%\nO1(PART)\nT1 M6\nN1G21 G90 G54 G0 X0 Y0 Z5. S3000 M3\nG1 Z-1. F300.\nX60. F600.\nG3X70.Y10.I0.J10.\nG2 X80 Y10 R5\n\
         G0 Z50.\nT2 M6\nG0 G43 H2 X10. Y10. Z5.\nG98 G83 Z-5. R2. Q1. F60.\nX20.\nG80\nG4 P500\nG91 G28 Z0\nM30\n%\n",
        "%_N_S01_MPF\nG17 G71 G90 G94 G54 S600 M3\nG0 X0 Y0 Z2\nG1 Z-1 F600\nX40 D1\nG4 F2\nG4 S10 ; WAIT\nG0 Z90\nM30\n",
        "(INCH)\nG20 G91 G0 X1 Y1 Z1\nG18 G2 X1 Z1 R1 F9\nG95 G1 X1 F.01 S100\nG82 Z-1 R-.5 P.5 L3 X1\nG52 X1\nG10 L2 P1 X3\nM2\n",
    ];

    /// It is refused with a place in it, or its times are numbers.
    fn answered(text: &str) -> Result<(), TestCaseError> {
        match Program::read_in(text, Some(Units::Millimetre)) {
            Ok(program) => {
                let times = program.times(&Drives { inverse_acceleration: 0.5, ..Drives::default() });
                prop_assert!(times.iter().all(|time| *time >= 0.0), "{times:?}");
            }
            Err(error) => prop_assert!(error.line >= 1 && error.line <= text.lines().count().max(1), "{error}"),
        }
        Ok(())
    }
}
