//! Chamfers and roundings behind a motion, and ends by distance and angle.
//!
//! # Source
//! `,C` and `,R` of Fanuc and Haas, C and R of lathes: the operator's manuals, cited from memory (assumption); `@` and `^`:
//! the documentation of LinuxCNC, polar coordinates.

use super::run::Iso;
use super::words::{ANGLE, CHAMFER, DISTANCE, ROUNDING, Words};
use crate::error::Fault;
use crate::joint::Joint;
use crate::kernel::{Kernel, Target};

impl Iso {
    /// The chamfer or rounding of a straight motion at feed.
    pub(super) fn joint(&mut self, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let mut joints: Vec<(Joint, usize)> = Vec::new();
        let letters: &[u8] =
            if self.is_lathe() && words.any(b"XZUW") { &[CHAMFER, ROUNDING, b'C', b'R'] } else { &[CHAMFER, ROUNDING] };
        for letter in letters {
            let Some(value) = words.take(*letter) else { continue };
            // The sign of C and R is the direction of the next motion, which that motion has itself.
            let size = self.mm(kernel, words, *letter, value.abs())?;
            words.remove(*letter);
            if *letter == b'C' {
                kernel.note("C beside X or Z of a lathe at feed is taken as a chamfer, not as an axis");
            }
            let joint = if matches!(*letter, CHAMFER | b'C') { Joint::Legs(size) } else { Joint::Round(size) };
            joints.push((joint, words.column(*letter)));
        }
        match joints[..] {
            [] => Ok(()),
            [(joint, column)] => kernel.joint(joint).map_err(|fault| fault.or_at(column)),
            [_, (_, column), ..] => {
                Err(Fault::at(column, "a chamfer and a rounding stand in one block; leave one out"))
            }
        }
    }

    /// Ends by distance from the origin and angle.
    pub(super) fn by_angle(&self, target: &mut Target, words: &mut Words, kernel: &Kernel) -> Result<(), Fault> {
        if !words.any(&[DISTANCE, ANGLE]) {
            return Ok(());
        }
        let [u, v, _] = kernel.plane;
        if target.names(u) || target.names(v) {
            return Err(Fault::new("@ and ^ stand beside coordinates of the plane; leave one out"));
        }
        let from = kernel.program_at();
        let (mut distance, mut angle) = (from[u].hypot(from[v]), from[v].atan2(from[u]).to_degrees());
        if let Some(value) = words.take(DISTANCE) {
            let value = self.mm(kernel, words, DISTANCE, value)?;
            distance = if kernel.absolute { value } else { distance + value };
        } else if distance == 0.0 {
            return Err(Fault::new("^ at the origin needs @, the distance"));
        }
        if let Some(value) = words.take(ANGLE) {
            angle = if kernel.absolute { value } else { angle + value };
        }
        let (sin, cos) = crate::frame::turn(angle);
        (target.absolute[u], target.absolute[v]) = (Some(distance * cos), Some(distance * sin));
        Ok(())
    }
}
