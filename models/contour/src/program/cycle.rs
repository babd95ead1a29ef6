//! Canned cycles: holes.

use super::ProgramFault;
use super::motion::Motion;
use super::state::Read;
use super::words::Words;

/// A canned cycle with the words that hold until it is cancelled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cycle {
    number: u32,
    bottom: Option<f64>,
    level: Option<f64>,
    peck: Option<f64>,
    dwell: f64,
}

/// Most pecks of a hole: a smaller depth of peck is a slip.
const MOST_PECKS: f64 = 1e4;

impl Cycle {
    pub(super) fn new(number: u32) -> Self {
        Self { number, bottom: None, level: None, peck: None, dwell: 0.0 }
    }

    /// Letters that say something to it.
    pub(super) fn letters(&self) -> &'static str {
        match self.number {
            73 | 83 => "XYZRQL",
            84 => "XYZRQPL",
            82 | 86 | 89 => "XYZRPL",
            _ => "XYZRL",
        }
    }

    /// Takes the words of a block; `at` is the height where the cycle was called, `dwell` what its P means, s.
    pub(super) fn take(&mut self, words: &Words, scale: f64, absolute: bool, at: f64, dwell: Option<f64>) {
        if let Some(level) = words.number('R') {
            self.level = Some(if absolute { level * scale } else { at + level * scale });
        }
        if let Some(bottom) = words.number('Z') {
            let from = if absolute { 0.0 } else { self.level.unwrap_or(at) };
            self.bottom = Some(from + bottom * scale);
        }
        if let Some(peck) = words.number('Q') {
            self.peck = Some(peck.abs() * scale);
        }
        self.dwell = dwell.unwrap_or(self.dwell);
    }

    /// Motions of one hole; the answer is the height at which it is left.
    pub(super) fn bore(&self, initial: f64, to_initial: bool, feed: f64, read: &mut Read) -> Result<f64, ProgramFault> {
        let missing = |word| ProgramFault::Cycle { cycle: self.number, word };
        let bottom = self.bottom.ok_or_else(|| missing("Z, the bottom of the hole"))?;
        let level = self.level.ok_or_else(|| missing("R, the level from which it feeds"))?;
        let peck = match self.peck.filter(|peck| *peck > 0.0) {
            Some(peck) if (level - bottom) / peck > MOST_PECKS => return Err(missing("a greater Q")),
            Some(peck) => Some(peck),
            None if matches!(self.number, 73 | 83) => return Err(missing("Q, the depth of a peck")),
            None => None,
        };
        let mut height = initial;
        let mut go = |to: f64, feed: Option<f64>| {
            if height.is_nan() {
                read.unknown = true;
            } else {
                read.block.motions.extend(Motion::straight([0.0, 0.0, height], [0.0, 0.0, to], feed));
            }
            height = to;
        };
        go(level, None);
        // Tapping and boring feed out as they feed in; tapping in pecks leaves the hole each time.
        let out = matches!(self.number, 84 | 85 | 89).then_some(feed);
        let mut depth = level;
        while let Some(peck) = peck.filter(|_| depth - bottom > 1e-9) {
            let next = (depth - peck).max(bottom);
            match self.number {
                // A chip is broken by a short step back, which takes no time worth counting.
                73 => go(next, Some(feed)),
                84 => {
                    go(next, out);
                    go(level, out);
                }
                _ => {
                    go(depth, None);
                    go(next, Some(feed));
                    go(level, None);
                }
            }
            depth = next;
        }
        if peck.is_none() {
            go(bottom, Some(feed));
        }
        read.block.dwell += if matches!(self.number, 82 | 84 | 86 | 89) { self.dwell } else { 0.0 };
        go(level, out);
        if to_initial && initial > level {
            go(initial, None);
        }
        Ok(height)
    }
}
