//! From text to blocks.

use super::state::State;
use super::words::Words;
use super::{Program, ProgramError, ProgramFault};

impl Program {
    /// Reads a part program of a milling machine: G0 to G3 in any plane, G4, G9, G17 to G21, G28,
    /// G30, G40 to G43, G49, G53 to G59, G61, G64, the canned cycles G73, G81 to G86 and G89 with G80,
    /// G98 and G99, G90, G91, G94, G95, tools (T, M6), spindle, coolant and every other M code but
    /// subprograms. Codes without influence on time are passed over.
    ///
    /// The path is the programmed one: radius and length compensation do not change it.
    ///
    /// # Errors
    /// [`ProgramError`] with line and column of the first fault: subprograms, variables and macros,
    /// a motion at feed without F, an arc that misses its end, a cycle that lacks a word.
    ///
    /// # Source
    /// ISO 6983-1; canned cycles as in the manuals of Fanuc, Haas and LinuxCNC.
    pub fn read(text: &str) -> Result<Self, ProgramError> {
        let syntax = |diagnostics: gcode::Diagnostics| {
            let first = diagnostics.iter().next();
            let at = first.map_or(0, |diagnostic| diagnostic.span.start);
            let message = first.map_or_else(String::new, |diagnostic| diagnostic.kind.to_string());
            ProgramError::at(text, at, ProgramFault::Syntax { message })
        };
        let parsed = gcode::parse(text).map_err(syntax)?;
        let starts: Vec<usize> = parsed.blocks.iter().map(|block| block.span.start).collect();
        let lines = lines(text, &starts);
        let mut state = State::default();
        let mut program = Self::default();
        for (block, line) in parsed.blocks.iter().zip(lines) {
            let place = |(at, fault)| ProgramError::at(text, at, fault);
            let words = Words::of(text, block).map_err(place)?;
            let mut read = state.block(&words).map_err(|(at, fault)| place((at.unwrap_or(block.span.start), fault)))?;
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

/// Lines, from 1, of rising byte offsets.
fn lines(text: &str, offsets: &[usize]) -> Vec<usize> {
    let mut line = 1;
    let mut at = 0;
    let bytes = text.as_bytes();
    offsets
        .iter()
        .map(|offset| {
            let end = (*offset).clamp(at, bytes.len());
            line += bytes[at..end].iter().filter(|byte| **byte == b'\n').count();
            at = end;
            line
        })
        .collect()
}
