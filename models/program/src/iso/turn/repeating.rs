//! G73 of lathes: the contour again and again, nearer to the workpiece with every pass, as castings and forgings need it.
//!
//! # Source
//! Words and order of the motions as the manuals of Fanuc describe them, cited from memory (assumption): the first pass is
//! shifted by the whole relief and the allowances, the last by the allowances alone, those between in equal steps; the tool
//! goes to the start, shifted alike, before each pass.

use super::blocks::place;
use super::profile::follow_shifted;
use crate::error::Fault;
use crate::iso::run::Iso;
use crate::iso::words::Words;
use crate::kernel::Kernel;
use crate::motion::Purpose;

/// Greatest number of passes: a bound against programs without end (assumption).
const PASSES: f64 = 10_000.0;

impl Iso {
    /// The first block: relief U as a radius, W, and the number of passes R.
    pub(in crate::iso) fn relief(&mut self, words: &mut Words, kernel: &Kernel) -> Result<(), Fault> {
        for (slot, letter) in [(0, b'U'), (1, b'W')] {
            if let Some(value) = words.take(letter) {
                self.two.relief[slot] = self.mm(kernel, words, letter, value)?;
            }
        }
        if let Some(passes) = words.whole(b'R', 1.0, PASSES)? {
            self.two.divisions = passes;
        }
        Ok(())
    }

    pub(in crate::iso) fn repeat(
        &mut self,
        first: usize,
        last: usize,
        allowances: [f64; 2],
        kernel: &mut Kernel,
    ) -> Result<(), Fault> {
        let (relief, passes) = (self.two.relief, self.two.divisions);
        if passes == 0 {
            return Err(Fault::new("G73 needs R in its first block, the number of passes"));
        }
        let contour = self.motions(first, last, kernel)?;
        if contour.is_empty() {
            return Err(Fault::new("the contour of G73 moves nothing"));
        }
        let start = kernel.program_at();
        kernel.purpose = Some(Purpose::Cycle);
        let mut cut = || -> Result<(), Fault> {
            for pass in 0..passes {
                let left = if passes == 1 { 0.0 } else { 1.0 - f64::from(pass) / f64::from(passes - 1) };
                let shift = [0, 1].map(|slot| allowances[slot] + left * relief[slot]);
                kernel.straight(&place(Some(start[0] + shift[0]), Some(start[2] + shift[1])), true)?;
                follow_shifted(&contour, shift, kernel)?;
            }
            kernel.straight(&place(Some(start[0]), Some(start[2])), true)
        };
        let done = cut();
        kernel.purpose = None;
        done
    }
}
