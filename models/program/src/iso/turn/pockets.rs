//! Type II of G71 and G72: contours with pockets.
//!
//! # Source
//! The operator's manuals of Fanuc and the page of Haas on type II, as far as they say it: each pass feeds to the contour and
//! along it up to the pass before, then escapes by R straight off the contour; one pocket is done before the next. That a
//! pass goes down at feed from the depth of the pass before, and follows the contour on the flanks beside it only, is an
//! assumption: what is left on flat parts between two depths goes with the last pass, as in type I.

use super::blocks::PASSES;
use super::profile::{Profile, Spot};
use crate::error::Fault;
use crate::kernel::{Kernel, Target};

pub(super) struct Pocket<'a> {
    pub profile: &'a Profile,
    pub code: u32,
    /// Depth of a pass and escape, mm.
    pub depth: f64,
    pub escape: f64,
    /// Whether the first block of the contour is at rapid speed, and with it the infeed beside the contour.
    pub rapid: bool,
}

/// A pass that is still due: its number, the places of the contour between which it runs, and the ends of the flanks down and up
/// which it follows the contour.
#[derive(Clone, Copy)]
struct Pass {
    count: u32,
    from: Spot,
    to: Spot,
    down_from: Spot,
    up_to: Spot,
}

impl Pocket<'_> {
    /// Cuts all passes; the tool stands at the start with the allowances before, and as high as that afterwards.
    pub fn cut(&self, kernel: &mut Kernel) -> Result<(), Fault> {
        let (from, to) = self.profile.ends();
        let mut due = self.passes(1, from, to);
        let mut done = 0;
        while let Some(pass) = due.pop() {
            done += 1;
            if done > PASSES {
                return Err(Fault::new(format!("G{} takes more than {PASSES} passes; check its depth", self.code)));
            }
            self.pass(pass, kernel)?;
            due.extend(self.passes(pass.count + 1, pass.from, pass.to));
        }
        // Off the workpiece before the way back.
        let Profile { across, start, .. } = *self.profile;
        kernel.straight(&Target::one(across, start[across] + self.profile.allowance(across)), true)
    }

    /// Passes of one depth between two places, the last one first.
    fn passes(&self, count: u32, start: Spot, end: Spot) -> Vec<Pass> {
        let parts = self.profile.deeper(self.depth * f64::from(count), start, end);
        let pass = |(first, last): &(Spot, Spot)| {
            let mut before = self.profile.spots(start, *first);
            before.reverse();
            let (down_from, up_to) = (self.flank(&before), self.flank(&self.profile.spots(*last, end)));
            Pass { count, from: *first, to: *last, down_from, up_to }
        };
        parts.iter().rev().map(pass).collect()
    }

    /// The end of the flank that rises from the first of some places.
    fn flank(&self, spots: &[Spot]) -> Spot {
        let depth = |spot: &Spot| self.profile.depth(&spot.at);
        let mut end = spots[0];
        for spot in &spots[1..] {
            let same = spot.motion == end.motion && spot.share == end.share || spot.at == end.at;
            if !same && depth(spot) > depth(&end) - 1e-9 {
                break;
            }
            end = *spot;
        }
        end
    }

    fn pass(&self, pass: Pass, kernel: &mut Kernel) -> Result<(), Fault> {
        let Profile { across, along, inwards, start, .. } = *self.profile;
        let (beside, above) = (self.profile.allowance(along), start[across] + self.profile.allowance(across));
        let place = |depth: f64| Target::one(across, above + inwards * depth);
        let (level, cleared) = (self.depth * f64::from(pass.count), self.depth * f64::from(pass.count - 1));
        let start_of_contour = pass.from.motion == 0 && pass.from.share <= 0.0;
        kernel.straight(&Target::one(along, pass.down_from.at[along] + beside), true)?;
        if start_of_contour {
            // Beside the contour there is nothing to follow down.
            kernel.straight(&place(level), self.rapid)?;
        } else {
            kernel.straight(&place(cleared), true)?;
            kernel.straight(&place(self.profile.depth(&pass.down_from.at)), false)?;
            self.profile.follow(pass.down_from, pass.from, kernel)?;
        }
        kernel.straight(&Target::one(along, pass.to.at[along] + beside), false)?;
        self.profile.follow(pass.to, pass.up_to, kernel)?;
        let reached = inwards * (kernel.program_at()[across] - above);
        kernel.straight(&place(reached.min(cleared) - self.escape), true)
    }
}
