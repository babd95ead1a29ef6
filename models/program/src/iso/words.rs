//! The words of a block with their values.

use crate::error::Fault;

/// Distance from the origin in polar coordinates, `@` of LinuxCNC.
pub(super) const DISTANCE: u8 = b'[';
/// Angle of polar coordinates, `^` of LinuxCNC.
pub(super) const ANGLE: u8 = b'\\';
/// Chamfer behind a motion, `,C`.
pub(super) const CHAMFER: u8 = b']';
/// Rounding behind a motion, `,R`.
pub(super) const ROUNDING: u8 = b'^';
/// Letters, and the four words above behind them.
const SLOTS: usize = 30;

/// A word as it is written.
fn written(slot: usize) -> String {
    match slot {
        26 => "@".to_owned(),
        27 => "^".to_owned(),
        28 => ",C".to_owned(),
        29 => ",R".to_owned(),
        _ => char::from(b'A' + slot as u8).to_string(),
    }
}

/// Words of a block: G and M codes in order, one value a letter else.
#[derive(Clone, Debug, Default)]
pub(super) struct Words {
    value: [f64; SLOTS],
    column: [usize; SLOTS],
    present: u32,
    pointed: u32,
    used: u32,
    /// Ten times the number, with the column.
    pub g: Vec<(u32, usize)>,
    pub m: Vec<(u32, usize)>,
    /// Repeated I, J and K of a macro call, in order.
    pub repeats: Vec<(u8, f64)>,
    /// Words that are ignored because their variable is vacant: letter and text of the variable.
    pub vacant: Vec<(u8, String)>,
}

fn bit(letter: u8) -> u32 {
    1 << (letter - b'A')
}

fn slot(letter: u8) -> usize {
    usize::from(letter - b'A')
}

impl Words {
    pub fn clear(&mut self) {
        (self.present, self.pointed, self.used) = (0, 0, 0);
        self.g.clear();
        self.m.clear();
        self.repeats.clear();
        self.vacant.clear();
    }

    pub fn put(&mut self, letter: u8, value: f64, pointed: bool, column: usize) -> Result<(), Fault> {
        match letter {
            b'G' => {
                let code = 10.0 * value;
                if !(0.0..=99_999.0).contains(&code) || (code - code.round()).abs() > 1e-6 {
                    return Err(Fault::at(column, format!("G{value} is no G code")));
                }
                self.g.push((code.round() as u32, column));
            }
            b'M' => {
                if !(0.0..=9999.0).contains(&value) || (value - value.round()).abs() > 1e-6 {
                    return Err(Fault::at(column, format!("M{value} is no M code")));
                }
                self.m.push((value.round() as u32, column));
            }
            _ => {
                if matches!(letter, b'I' | b'J' | b'K') {
                    self.repeats.push((letter, value));
                }
                if self.present & bit(letter) != 0 {
                    // A macro call may repeat I, J and K; whoever takes the letter otherwise refuses this one.
                    if matches!(letter, b'I' | b'J' | b'K') && self.g.iter().any(|(code, _)| matches!(code, 650 | 660))
                    {
                        return Ok(());
                    }
                    let name = written(slot(letter));
                    return Err(Fault::at(column, format!("{name} stands twice in the block; leave one out")));
                }
                self.present |= bit(letter);
                self.pointed |= if pointed { bit(letter) } else { 0 };
                self.value[slot(letter)] = value;
                self.column[slot(letter)] = column;
            }
        }
        Ok(())
    }

    pub fn has(&self, letter: u8) -> bool {
        self.present & bit(letter) != 0
    }

    pub fn any(&self, letters: &[u8]) -> bool {
        letters.iter().any(|letter| self.has(*letter))
    }

    /// The value, which counts as understood afterwards.
    pub fn take(&mut self, letter: u8) -> Option<f64> {
        self.used |= bit(letter);
        self.see(letter)
    }

    /// The value, which is no word of the block afterwards.
    pub fn remove(&mut self, letter: u8) -> Option<f64> {
        let value = self.see(letter);
        self.present &= !bit(letter);
        value
    }

    pub fn see(&self, letter: u8) -> Option<f64> {
        self.has(letter).then(|| self.value[slot(letter)])
    }

    pub fn is_pointed(&self, letter: u8) -> bool {
        self.pointed & bit(letter) != 0
    }

    pub fn column(&self, letter: u8) -> usize {
        self.column[slot(letter)]
    }

    pub fn spend(&mut self, letters: &[u8]) {
        letters.iter().for_each(|letter| self.used |= bit(*letter));
    }

    /// A word that nothing has understood.
    pub fn rest(&self) -> Option<(String, f64, usize)> {
        let left = self.present & !self.used;
        (left != 0).then(|| {
            let index = left.trailing_zeros() as usize;
            (written(index), self.value[index], self.column[index])
        })
    }

    /// Whole number of a word within a range.
    pub fn whole(&mut self, letter: u8, least: f64, most: f64) -> Result<Option<u32>, Fault> {
        match self.take(letter) {
            None => Ok(None),
            Some(value) if (least..=most).contains(&value.round()) && (value - value.round()).abs() < 1e-6 => {
                Ok(Some(value.round() as u32))
            }
            Some(value) => Err(Fault::at(
                self.column(letter),
                format!("{}{value}: write a whole number from {least} to {most}", written(slot(letter))),
            )),
        }
    }
}
