//! Cycles of lathes in G code system A: G90, G92, G94.

use super::run::Iso;
use super::words::Words;
use crate::error::Fault;
use crate::kernel::{FeedMode, Kernel, Target};
use crate::motion::Purpose;

impl Iso {
    /// A box of four motions: turning (G90), threading (G92), facing (G94), with R for a taper.
    pub(super) fn turning_cycle(&mut self, code: u32, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let named = words.any(b"XZUW");
        let target = self.target(words, kernel)?;
        let taper = match words.take(b'R') {
            Some(value) => self.mm(kernel, words, b'R', value)?,
            None => 0.0,
        };
        if !named {
            return Ok(());
        }
        let from = kernel.program_at();
        let (x, z) = (target.end(0, &from), target.end(2, &from));
        let place = |x: Option<f64>, z: Option<f64>| {
            let mut target = Target::default();
            (target.absolute[0], target.absolute[2]) = (x, z);
            target
        };
        kernel.purpose = Some(if code == 92 { Purpose::Thread } else { Purpose::Cycle });
        let mode = kernel.feed_mode;
        let path: [(Target, bool); 4] = match code {
            90 | 92 => [
                (place(Some(x + taper), None), true),
                (place(Some(x), Some(z)), false),
                (place(Some(from[0]), None), code == 92),
                (place(None, Some(from[2])), true),
            ],
            _ => [
                (place(None, Some(z + taper)), true),
                (place(Some(x), Some(z)), false),
                (place(None, Some(from[2])), false),
                (place(Some(from[0]), None), true),
            ],
        };
        if code == 92 {
            kernel.feed_mode = FeedMode::Revolution;
        }
        let done = path.iter().try_for_each(|(target, rapid)| kernel.straight(target, *rapid));
        kernel.purpose = None;
        kernel.feed_mode = mode;
        done
    }
}
