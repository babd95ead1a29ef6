//! From text to blocks.

use super::dialect::Dialect;
use super::state::State;
use super::words::{At, Words};
use super::{Program, ProgramError, ProgramFault, Units};

impl Program {
    /// Reads a part program of a milling machine that names its unit.
    ///
    /// # Errors
    /// As [`Program::read_in`].
    pub fn read(text: &str) -> Result<Self, ProgramError> {
        Self::read_in(text, None)
    }

    /// Reads a part program of a milling machine; `units` are those of a program that names none.
    ///
    /// Understood are G0 to G3 in any plane, G4, G9, G17 to G21, G28, G30, G40, G43, G44, G49, G52 to G59, G61, G64,
    /// the canned cycles G73, G81 to G86 and G89 with G80, G98 and G99, G90 to G92, G94, G95, G97, G10 L2 and the like,
    /// tools (T, M6) and M codes of program, spindle and coolant; of Siemens programs, known by their header, G0 to G4,
    /// G60, G71, G700 and G710 besides. Everything else is refused: a word that is passed over could move an axis or
    /// take time.
    ///
    /// The path is the programmed one: the compensation of length shifts it as a whole, and where it changes the next
    /// motion along Z counts among [`Program::unknown`]. Words that differ by control are taken only where the program
    /// shows which is meant: P of a dwell with a decimal point, or with a program number `O1234`; F and S of G4 with a
    /// header of Siemens. Coordinates without a decimal point are whole millimetres or inches (assumption: calculator
    /// type). G90, G94 and G17 hold from the start (assumption, ISO 6983-1). G83 goes back to the depth that it has
    /// reached (assumption; controls stay clear of it by a setting).
    ///
    /// # Errors
    /// [`ProgramError`] with line and column of the first fault: a word that is not followed, no unit, a motion at feed
    /// without F, an arc that misses its end, a cycle that lacks a word.
    ///
    /// # Source
    /// ISO 6983-1; canned cycles as in the manuals of Fanuc, Haas and LinuxCNC.
    ///
    /// ```
    /// use toolroom_contour::{Program, Units};
    /// let program = "G0 X0 Y0 Z1\nG1 X50 F60\n";
    /// assert!(Program::read(program).is_err());
    /// let program = Program::read_in(program, Some(Units::Millimetre)).unwrap();
    /// assert!((program.blocks[1].feed_time() - 50.0).abs() < 1e-9);
    /// ```
    pub fn read_in(text: &str, units: Option<Units>) -> Result<Self, ProgramError> {
        let dialect = Dialect::of(text);
        let place = |(at, fault)| ProgramError::at(text, at, fault);
        let blocks = blocks(text, dialect != Dialect::Siemens);
        let bores = |words: &Words| words.general.iter().any(|(code, _)| matches!(code, 730 | 810..=860 | 890));
        let has_cycle = blocks.iter().any(|(_, words)| words.as_ref().is_ok_and(bores));
        let mut state = State::new(dialect, units, has_cycle);
        let mut program = Self::default();
        for (line, words) in blocks {
            let words = words.map_err(place)?;
            let mut read = state.block(&words).map_err(|(at, fault)| place((at.unwrap_or(words.start), fault)))?;
            read.block.line = line;
            if read.unknown {
                program.unknown.push(line);
            }
            program.blocks.push(read.block);
            if read.end {
                break;
            }
        }
        if program.blocks.iter().all(|block| block.motions.is_empty()) {
            return Err(ProgramError::at(text, 0, ProgramFault::Empty));
        }
        Ok(program)
    }
}

/// Lines that are not empty, with their numbers from 1.
fn blocks(text: &str, comments: bool) -> Vec<(usize, At<Words>)> {
    let mut start = 0;
    let mut blocks = Vec::new();
    for (index, line) in text.split_inclusive('\n').enumerate() {
        let mark = if index == 0 { line.len() - line.trim_start_matches('\u{feff}').len() } else { 0 };
        let own = &line[mark..];
        if !own.trim().is_empty() {
            blocks.push((index + 1, Words::of(own, start + mark, comments)));
        }
        start += line.len();
    }
    blocks
}
