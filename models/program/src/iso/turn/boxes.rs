//! Cycles of lathes in G code system A: G90, G92, G94.

use crate::error::Fault;
use crate::iso::run::Iso;
use crate::iso::words::Words;
use crate::kernel::{FeedMode, Kernel, Target};
use crate::motion::Purpose;

/// Values of a cycle of lathes that hold for the next block, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::iso) struct Turned {
    code: u32,
    from: [f64; 2],
    to: [f64; 2],
    taper: f64,
}

impl Iso {
    /// A box of four motions: turning (G90), threading (G92), facing (G94), with R for a taper.
    pub(in crate::iso) fn turning_cycle(
        &mut self,
        code: u32,
        words: &mut Words,
        kernel: &mut Kernel,
    ) -> Result<(), Fault> {
        let named = words.any(b"XZUW");
        let target = self.target(words, kernel)?;
        let taper = match words.take(b'R') {
            Some(value) => Some(self.mm(kernel, words, b'R', value)?),
            None => None,
        };
        if !named {
            return Ok(());
        }
        let from = kernel.program_at();
        // What a block leaves out is that of the block before, as long as the same cycle is in force at the same place.
        let kept = self.turned.filter(|turned| turned.code == code && turned.from == [from[0], from[2]]);
        let place_of = |axis: usize, before: Option<f64>| match before {
            Some(before) if !target.names(axis) => before,
            _ => target.end(axis, &from),
        };
        let (x, z) = (place_of(0, kept.map(|turned| turned.to[0])), place_of(2, kept.map(|turned| turned.to[1])));
        let taper = taper.or(kept.map(|turned| turned.taper)).unwrap_or(0.0);
        self.turned = Some(Turned { code, from: [from[0], from[2]], to: [x, z], taper });
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
