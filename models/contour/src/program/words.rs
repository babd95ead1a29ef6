//! Words of one block, as numbers.

use super::ProgramFault;
use gcode::{Argument, Code, Value};

/// Words with a number that stand at most once in a block.
const LETTERS: &str = "XYZIJKRPQFSLUVWABCDEH";

/// What a block says.
#[derive(Clone, Debug, Default)]
pub(super) struct Words {
    /// G codes with tenths (`G54.1` is 541) and their place.
    pub general: Vec<(u32, usize)>,
    /// M codes and their place.
    pub auxiliary: Vec<(u32, usize)>,
    /// Tool that is called.
    pub tool: Option<u32>,
    numbers: [Option<f64>; LETTERS.len()],
    /// Whether P was written with a decimal point: seconds instead of milliseconds.
    pub pointed: bool,
}

impl Words {
    /// The words of `block` of `text`.
    pub(super) fn of(text: &str, block: &gcode::Block) -> Result<Self, (usize, ProgramFault)> {
        let mut words = Self::default();
        for code in &block.codes {
            let (arguments, number, place) = match code {
                Code::General(code) => (&code.args, &code.number, code.span.start),
                Code::Miscellaneous(code) => (&code.args, &code.number, code.span.start),
                Code::ToolChange(code) => (&code.args, &code.number, code.span.start),
                _ => continue,
            };
            let minor = number.minor().map_or(0, std::num::NonZeroU32::get);
            match code {
                Code::General(_) if minor > 9 => {
                    let word = format!("G{}.{minor}", number.major());
                    return Err((place, ProgramFault::Unsupported { word, reason: "no such code is known" }));
                }
                Code::General(_) => words.general.push((number.major().saturating_mul(10) + minor, place)),
                Code::Miscellaneous(_) => words.auxiliary.push((number.major(), place)),
                _ => words.tool = Some(number.major()),
            }
            for Argument { letter, value, span, .. } in arguments {
                words.take(text, *letter, value, span.start)?;
            }
        }
        for word in &block.word_addresses {
            words.take(text, word.letter, &word.value, word.span.start)?;
        }
        Ok(words)
    }

    fn take(&mut self, text: &str, letter: char, value: &Value, at: usize) -> Result<(), (usize, ProgramFault)> {
        let letter = letter.to_ascii_uppercase();
        let Some(place) = LETTERS.find(letter) else { return Ok(()) };
        let Value::Literal(number) = value else { return Err((at, ProgramFault::Variable { letter })) };
        if letter == 'P' {
            let rest = text.get(at + 1..).unwrap_or_default().trim_start();
            let written = rest.split(|sign: char| sign.is_ascii_alphabetic() || sign.is_whitespace()).next();
            self.pointed = written.is_some_and(|written| written.contains('.'));
        }
        // The parser keeps single precision; the shortest decimal of that is what was written, up
        // to seven digits.
        self.numbers[place] = number.to_string().parse().ok();
        Ok(())
    }

    /// The number behind `letter`.
    pub(super) fn number(&self, letter: char) -> Option<f64> {
        LETTERS.find(letter).and_then(|place| self.numbers[place])
    }

    /// Whether any of `letters` is there.
    pub(super) fn any(&self, letters: &str) -> bool {
        letters.chars().any(|letter| self.number(letter).is_some())
    }
}
