//! Circular pockets of Haas, G12 with the clock and G13 against it.
//!
//! # Source
//! Words as the mill operator's manual of Haas describes them, cited from memory (assumption): the tool stands in the middle,
//! I is the radius of the first circle, K that of the last, Q the step between them, Z the depth, L the number of depths, D
//! the tool, whose radius the circles are smaller by. Half circles lead to the first circle, from one to the next and back to
//! the middle (assumption).

use super::run::Iso;
use super::words::Words;
use crate::error::Fault;
use crate::kernel::{Kernel, Round, Target};

/// Greatest number of circles: a bound against programs without end (assumption).
const CIRCLES: f64 = 1e4;

impl Iso {
    pub(super) fn pocket(&mut self, left: bool, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let code = if left { 13 } else { 12 };
        let [u, v, w] = kernel.plane;
        if w != 2 {
            return Err(Fault::new(format!("G{code} runs in the plane XY; write G17 before it")));
        }
        if kernel.offset.is_some() {
            return Err(Fault::new(format!("G{code} takes the radius of the tool by itself; write G40 before it")));
        }
        let mut length = |letter: u8| -> Result<Option<f64>, Fault> {
            words.take(letter).map(|value| self.mm(kernel, words, letter, value)).transpose()
        };
        let (first, last, step) = (length(b'I')?, length(b'K')?, length(b'Q')?);
        let first = first.ok_or_else(|| Fault::new(format!("G{code} needs I, the radius of the first circle")))?;
        let loops = words.whole(b'L', 1.0, CIRCLES)?.unwrap_or(1);
        let number = words.whole(b'D', 0.0, 9999.0)?.filter(|number| *number > 0).or(kernel.tool);
        let tool = match number.and_then(|number| kernel.control.diameters.get(&number).copied()) {
            Some(diameter) => 0.5 * diameter,
            None => {
                let which = number.map_or("the tool".to_owned(), |number| format!("D{number}"));
                kernel.note(format!(
                    "the diameter of {which} is not known, so the centre of the tool runs on the circles themselves: give --tool D{}=\"10 mm\"",
                    number.unwrap_or(1)
                ));
                0.0
            }
        };
        let mut radii = vec![first - tool];
        match (last, step) {
            (None, None) => {}
            (Some(last), Some(step)) if step > 0.0 && last > first && (last - first) / step <= CIRCLES => {
                let mut radius = first + step;
                while radius < last - 1e-9 {
                    radii.push(radius - tool);
                    radius += step;
                }
                radii.push(last - tool);
            }
            _ => {
                return Err(Fault::new(format!(
                    "G{code} takes K, the last radius, with Q, the step: K larger than I and Q above 0"
                )));
            }
        }
        if radii[0] <= 0.0 {
            return Err(Fault::new(format!("the first circle of G{code} must be larger than the tool")));
        }
        let depth = words.take(b'Z').map(|value| self.mm(kernel, words, b'Z', value)).transpose()?;
        if loops > 1 && (kernel.absolute || depth.is_none()) {
            return Err(Fault::at(words.column(b'L'), format!("L of G{code} goes with a depth by steps: G91 and Z")));
        }
        let place = kernel.program_at();
        let centre = [place[u], place[v]];
        for _ in 0..loops {
            if let Some(depth) = depth {
                let mut target = Target::default();
                if kernel.absolute {
                    target.absolute[w] = Some(depth)
                } else {
                    target.step[w] = Some(depth)
                }
                kernel.straight(&target, false)?;
            }
            let at = |x: f64| {
                let mut target = Target::default();
                (target.absolute[u], target.absolute[v]) = (Some(x), Some(centre[1]));
                target
            };
            // From the middle, half a circle to each radius and a whole one on it; sides change with every half.
            let (mut x, mut side) = (centre[0], 1.0);
            for radius in &radii {
                let next = centre[0] + side * radius;
                kernel.round(&at(next), Round::Centre([0.5 * (x + next), centre[1]]), left, 0.0)?;
                kernel.round(&at(next), Round::Centre(centre), left, 0.0)?;
                (x, side) = (next, -side);
            }
            kernel.round(&at(centre[0]), Round::Centre([0.5 * (x + centre[0]), centre[1]]), left, 0.0)?;
        }
        Ok(())
    }
}
