//! Numbers that may count least increments: on controls that can be set to read `X1000` as 1 mm, a program that writes some lengths
//! with a decimal point and long ones without is ambiguous.

use crate::Dialect;
use crate::kernel::Kernel;

/// Least value without a decimal point that is noted, in units of the program: a metre or more is rare, and a thousand least
/// increments are a millimetre (assumption).
const LONG: f64 = 1000.0;

/// What a program has shown of its way to write lengths.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Increments {
    pointed: bool,
    long: Option<(u8, f64, usize)>,
    said: bool,
}

impl Increments {
    /// Takes a word, and notes the first long length without a point beside one that has it.
    pub fn take(&mut self, dialect: Dialect, letter: u8, value: f64, pointed: bool, kernel: &mut Kernel) {
        let settable = matches!(dialect, Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas);
        if self.said || !settable || kernel.control.least_increment || !b"XYZUVWIJKR".contains(&letter) {
            return;
        }
        if pointed {
            self.pointed |= value != 0.0;
        } else if value.abs() >= LONG && self.long.is_none() {
            self.long = Some((letter, value, kernel.line));
        }
        if let Some((letter, value, line)) = self.long.filter(|_| self.pointed) {
            self.said = true;
            let text = format!(
                "{}{value} of line {line} has no decimal point beside lengths that have one: read as {value}, not as {value} least \
                 increments; --set control.decimal=least_increment reads it so",
                char::from(letter)
            );
            kernel.note(text);
        }
    }
}
