//! Part programs of milling machines: what each block moves, and how long it takes.
//!
//! ```text
//!  G-code ─► Program: Blocks of Motions, dwells, tool changes, holes ─► times(Drives) ─► s per block
//! ```

mod cycle;
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
/// let program = Program::read("T1 M6\nG21 G90 G0 X0 Y0 Z5\nG1 Z-1 F60\nX120 F1200\nG4 P500\nM30").unwrap();
/// let drives = Drives { tool_change_time: 4.0, ..Drives::default() };
/// let times = program.times(&drives);
/// assert_eq!((times[0], times[2], times[3], times[4]), (4.0, 6.0, 6.0, 0.5));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// Blocks in the order of the file: empty lines, comments and `%` are none.
    pub blocks: Vec<Block>,
    /// Motions whose length is not known because they come from a reference point or another
    /// coordinate system: they count with the axes that are known. Lines.
    pub unknown: Vec<usize>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(text: &str) -> Program {
        Program::read(text).unwrap_or_else(|error| panic!("{error}"))
    }

    fn total(text: &str) -> f64 {
        read(text).times(&Drives::default()).iter().sum()
    }

    fn fault(text: &str) -> (usize, ProgramFault) {
        let error = Program::read(text).expect_err("a fault");
        (error.line, error.fault)
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
    fn dwells_are_milliseconds_unless_a_point_says_seconds() {
        let move_first = "G0 X0 Y0 Z0\nG0 X1\n";
        let dwell = |word: &str| read(&format!("{move_first}G4 {word}")).blocks[2].dwell;
        assert_eq!((dwell("P500"), dwell("P0.5"), dwell("X2"), dwell("P2.")), (0.5, 0.5, 2.0, 2.0));
        assert_eq!(read("G0 X0 Y0 Z5\nG82 X1.5 Z-1. R1. P300 F60").blocks[1].dwell, 0.3);
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
    }

    proptest! {
        #[test]
        fn any_text_is_answered_without_panic(text in "[GXYZIJRMTFSPQL0-9. \\n(;%/#-]{0,80}") {
            if let Ok(program) = Program::read(&text) {
                let times = program.times(&Drives { inverse_acceleration: 0.5, ..Drives::default() });
                prop_assert!(times.iter().all(|time| *time >= 0.0), "{times:?}");
            }
        }
    }
}
