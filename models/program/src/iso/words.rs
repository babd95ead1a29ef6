//! The words of a block with their values.

use crate::error::Fault;

/// Words of a block: G and M codes in order, one value a letter else.
#[derive(Clone, Debug, Default)]
pub(super) struct Words {
    value: [f64; 26],
    column: [usize; 26],
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
                    let name = char::from(letter);
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
    pub fn rest(&self) -> Option<(char, f64, usize)> {
        let left = self.present & !self.used;
        (left != 0).then(|| {
            let index = left.trailing_zeros() as usize;
            (char::from(b'A' + index as u8), self.value[index], self.column[index])
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
                format!("{}{value}: write a whole number from {least} to {most}", char::from(letter)),
            )),
        }
    }
}
