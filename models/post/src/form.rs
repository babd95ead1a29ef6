//! What is written, and in which form.

use toolroom_program::Dialect;

/// A program in the words of another control.
#[derive(Clone, Debug, PartialEq)]
pub struct Post {
    /// The program.
    pub text: String,
    /// Lines, from 1, of what has no place in it: motions to reference points and in machine coordinates, functions of the
    /// machine, exact stops where the language has none in a block.
    pub left_out: Vec<usize>,
    /// Holes that stayed cycles, and holes of cycles that were worked out.
    pub holes: [usize; 2],
}

/// How a program is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// The language.
    pub dialect: Dialect,
    /// Whether holes of canned cycles are written as cycles of the control, where it has one that makes the same motions.
    pub keep_cycles: bool,
}

impl From<Dialect> for Form {
    fn from(dialect: Dialect) -> Self {
        Self { dialect, keep_cycles: false }
    }
}

impl Post {
    /// What was not written as it stood in the program, in words; empty where nothing is to be said.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        if let [first, ..] = self.left_out[..] {
            notes.push(format!(
                "{} blocks have no place in it: motions in machine coordinates, functions of the machine, exact stops (first: line {first})",
                self.left_out.len()
            ));
        }
        let [kept, worked_out] = self.holes;
        if worked_out > 0 {
            notes.push(format!(
                "{kept} holes stay cycles, {worked_out} are worked out: the control has no cycle that makes the same motions"
            ));
        }
        notes
    }
}
