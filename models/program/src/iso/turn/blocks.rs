//! Cycles of lathes in two blocks, G code system A: finishing G70, pecking along the axis and across it G74 and G75, threading
//! G76. Roughing G71 and G72 stands with the contours, G73 by itself.
//!
//! # Source
//! Sequences of motions as the manuals of Fanuc describe them, cited from memory (assumption). G76 feeds straight in; its
//! angle and the pull-out at its end take no time of their own. G71 to G73 in one block give the depth of a pass as D, as
//! older controls and those of Haas have it.

use crate::error::Fault;
use crate::iso::run::Iso;
use crate::iso::words::Words;
use crate::kernel::{FeedMode, Kernel, Target};
use crate::motion::Purpose;
use crate::run::Flow;

/// Values of the first of two blocks, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::iso) struct TwoBlocks {
    /// Depth of a roughing pass.
    pub(super) depth: f64,
    /// Escape or retraction.
    pub(super) escape: f64,
    /// Relief of G73 in X, as a radius, and in Z, and its number of passes.
    pub(in crate::iso) relief: [f64; 2],
    pub(in crate::iso) divisions: u32,
    /// Finishing passes of a thread.
    finishing: u32,
    /// Least depth of a pass of a thread.
    least: f64,
    /// Finishing allowance of a thread.
    allowance: f64,
    /// Whether the contour of a cycle runs.
    within: bool,
}

/// Greatest number of passes of a cycle: a bound against programs without end (assumption).
pub(super) const PASSES: u32 = 10_000;

pub(in crate::iso) fn place(x: Option<f64>, z: Option<f64>) -> Target {
    let mut target = Target::default();
    (target.absolute[0], target.absolute[2]) = (x, z);
    target
}

impl Iso {
    /// A length that is a number of least increments without a decimal point, mm.
    pub(super) fn increments(&self, words: &mut Words, letter: u8, kernel: &Kernel) -> Result<Option<f64>, Fault> {
        let Some(value) = words.take(letter) else { return Ok(None) };
        let unit = kernel.unit()?;
        let least = if unit > 1.0 { 1e-4 } else { 1e-3 };
        Ok(Some((if words.is_pointed(letter) { value } else { value * least }) * unit))
    }

    pub(in crate::iso) fn two_blocks(
        &mut self,
        code: u32,
        words: &mut Words,
        kernel: &mut Kernel,
    ) -> Result<(), Fault> {
        let due = |what: &str| Fault::new(format!("G{code} needs {what}"));
        match code {
            70..=73 => {
                if code == 73 && !words.has(b'P') {
                    return self.relief(words, kernel);
                }
                if matches!(code, 71 | 72) && words.has(b'P') && words.has(b'D') {
                    self.two.depth = self.increments(words, b'D', kernel)?.unwrap_or(0.0);
                }
                if code != 70 && !words.has(b'P') {
                    let letter = if code == 71 { b'U' } else { b'W' };
                    let depth = words.take(letter).map(|value| self.mm(kernel, words, letter, value)).transpose()?;
                    let escape = words.take(b'R').map(|value| self.mm(kernel, words, b'R', value)).transpose()?;
                    self.two.depth = depth.unwrap_or(self.two.depth);
                    self.two.escape = escape.unwrap_or(self.two.escape);
                    return Ok(());
                }
                let (first, last) = self.profile_blocks(words)?;
                let current = self.pc.saturating_sub(1);
                if code == 70 {
                    self.finish(first, last, kernel)?;
                } else {
                    let u = words.take(b'U').map(|value| self.mm(kernel, words, b'U', value)).transpose()?;
                    let w = words.take(b'W').map(|value| self.mm(kernel, words, b'W', value)).transpose()?;
                    let allowance = [0.5 * u.unwrap_or(0.0), w.unwrap_or(0.0)];
                    match code {
                        73 => self.repeat(first, last, allowance, kernel)?,
                        _ => self.rough(code, first, last, allowance, kernel)?,
                    }
                    // The contour behind the cycle is not run again.
                    if last >= current {
                        self.pc = self.pc.max(last + 1);
                    }
                }
                Ok(())
            }
            74 | 75 => {
                if !words.any(b"XZUW") {
                    let escape = words.take(b'R').map(|value| self.mm(kernel, words, b'R', value)).transpose()?;
                    self.two.escape = escape.unwrap_or(self.two.escape);
                    return Ok(());
                }
                let target = self.target(words, kernel)?;
                let steps = [self.increments(words, b'P', kernel)?, self.increments(words, b'Q', kernel)?];
                let relief = words.take(b'R').map(|value| self.mm(kernel, words, b'R', value)).transpose()?;
                self.peck(code, &target, steps, relief.unwrap_or(0.0), kernel)
            }
            76 => {
                if !words.any(b"XZUW") {
                    // Two digits each: finishing passes, pull-out, angle.
                    if let Some(number) = words.whole(b'P', 0.0, 999_999.0)? {
                        self.two.finishing = number / 10_000;
                    }
                    self.two.least = self.increments(words, b'Q', kernel)?.unwrap_or(self.two.least);
                    let allowance = words.take(b'R').map(|value| self.mm(kernel, words, b'R', value)).transpose()?;
                    self.two.allowance = allowance.unwrap_or(self.two.allowance);
                    return Ok(());
                }
                let target = self.target(words, kernel)?;
                let height = self.increments(words, b'P', kernel)?.ok_or_else(|| due("P, the height of the thread"))?;
                let first =
                    self.increments(words, b'Q', kernel)?.ok_or_else(|| due("Q, the depth of the first pass"))?;
                let taper = words.take(b'R').map(|value| self.mm(kernel, words, b'R', value)).transpose()?;
                self.thread_cycle(&target, height, first, taper.unwrap_or(0.0), kernel)
            }
            _ => Err(Fault::new(format!(
                "G{code} is a cycle of turning that is not followed; post it as motions, or as G71, G90, G92 and G94"
            ))
            .refusing()),
        }
    }

    /// First and last statement of the contour between blocks P and Q.
    fn profile_blocks(&mut self, words: &mut Words) -> Result<(usize, usize), Fault> {
        let mut number = |letter: u8| {
            let due = || Fault::new(format!("{} is missing: the number of a block of the contour", char::from(letter)));
            words.whole(letter, 0.0, 99_999_999.0)?.ok_or_else(due)
        };
        let (first, last) = (number(b'P')?, number(b'Q')?);
        let current = self.pc.saturating_sub(1);
        let (first, last) = (self.block_number(first, current)?, self.block_number(last, current)?);
        if first > last || (first..=last).contains(&current) {
            return Err(Fault::new("the contour of the cycle begins behind its end: check P and Q"));
        }
        Ok((first, last))
    }

    /// Runs the blocks of a contour.
    pub(super) fn contour(&mut self, first: usize, last: usize, kernel: &mut Kernel) -> Result<(), Fault> {
        if std::mem::replace(&mut self.two.within, true) {
            return Err(Fault::new("a cycle stands within the contour of another"));
        }
        let done = self.follow(first, last, kernel);
        self.two.within = false;
        // The corner behind the last block of a contour would be that of the way back.
        done.and_then(|()| kernel.close_joint())
    }

    fn follow(&mut self, first: usize, last: usize, kernel: &mut Kernel) -> Result<(), Fault> {
        let (pc, line, motion) = (self.pc, kernel.line, self.modes.motion);
        for index in first..=last {
            let Some(statement) = self.statements.at(index)? else { break };
            kernel.line = statement.line;
            let flow = self.run(&statement.code, index, kernel);
            if flow? != Flow::Going || self.pc != pc {
                return Err(Fault::new("the contour of a cycle holds no calls, jumps or ends"));
            }
        }
        (kernel.line, self.modes.motion) = (line, motion);
        Ok(())
    }

    /// G70: the contour at its own feeds, and back to the start.
    fn finish(&mut self, first: usize, last: usize, kernel: &mut Kernel) -> Result<(), Fault> {
        let start = kernel.program_at();
        self.contour(first, last, kernel)?;
        kernel.straight(&place(Some(start[0]), Some(start[2])), true)
    }

    /// G74 pecks along Z and steps across, G75 pecks along X and steps along Z.
    fn peck(
        &mut self,
        code: u32,
        target: &Target,
        steps: [Option<f64>; 2],
        relief: f64,
        kernel: &mut Kernel,
    ) -> Result<(), Fault> {
        let escape = self.two.escape;
        let from = kernel.program_at();
        // Axis of the pecks and axis across, with their steps.
        let (axis, side, step, aside) =
            if code == 74 { (2, 0, steps[1], steps[0]) } else { (0, 2, steps[0], steps[1]) };
        let (bottom, last) = (target.end(axis, &from), target.end(side, &from));
        let depth = (bottom - from[axis]).abs();
        let step = step.filter(|step| *step > 0.0).unwrap_or(depth);
        let down = if bottom < from[axis] { -1.0 } else { 1.0 };
        let across = if last < from[side] { -1.0 } else { 1.0 };
        let width = (last - from[side]).abs();
        let aside = aside.filter(|aside| *aside > 0.0).unwrap_or(width);
        let rows = if width > 1e-9 { (width / aside - 1e-9).ceil() as u32 } else { 0 };
        let pecks = if depth > 1e-9 { (depth / step - 1e-9).ceil().max(1.0) } else { 0.0 };
        if (f64::from(rows) + 1.0) * pecks.max(1.0) > f64::from(PASSES) {
            return Err(Fault::new(format!("G{code} takes more than {PASSES} pecks; check their depth")));
        }
        kernel.purpose = Some(Purpose::Cycle);
        let mut bore = || -> Result<(), Fault> {
            for row in 0..=rows {
                let at = from[side] + across * (aside * f64::from(row)).min(width);
                kernel.straight(&Target::one(side, at), true)?;
                for peck in 1..=pecks as u32 {
                    let reached = (step * f64::from(peck)).min(depth);
                    kernel.straight(&Target::one(axis, from[axis] + down * reached), false)?;
                    if f64::from(peck) < pecks {
                        kernel.straight(&Target::one(axis, from[axis] + down * (reached - escape)), true)?;
                    }
                }
                // The tool goes aside at the bottom, but not into the wall of the first row.
                if relief > 0.0 && row > 0 {
                    kernel.straight(&Target::one(side, at - across * relief), true)?;
                }
                kernel.straight(&Target::one(axis, from[axis]), true)?;
            }
            kernel.straight(&Target::one(side, from[side]), true)
        };
        let done = bore();
        kernel.purpose = None;
        done
    }

    /// G76: passes of a thread whose sections are equal, then the finishing ones.
    fn thread_cycle(
        &mut self,
        target: &Target,
        height: f64,
        first: f64,
        taper: f64,
        kernel: &mut Kernel,
    ) -> Result<(), Fault> {
        let from = kernel.program_at();
        let (root, end) = (target.end(0, &from), target.end(2, &from));
        if first <= 0.0 || height <= 0.0 {
            return Err(Fault::new("G76 needs a height P and a first depth Q above zero"));
        }
        let TwoBlocks { finishing, least, allowance, .. } = self.two;
        if allowance >= height {
            return Err(Fault::new(format!(
                "the finishing allowance of G76, R of its first block, is {allowance} mm, no less than the height of the thread: \
                 write it with a decimal point, R0.05, or read lengths without one as least increments with --set \
                 control.decimal=least_increment"
            )));
        }
        let rough = height - allowance;
        let (mut depths, mut reached): (Vec<f64>, f64) = (Vec::new(), 0.0);
        while rough - reached > 1e-9 {
            if depths.len() >= PASSES as usize {
                return Err(Fault::new(format!("G76 takes more than {PASSES} passes; check the depth of the first")));
            }
            let next = first * ((depths.len() + 1) as f64).sqrt();
            reached = next.max(reached + least).min(rough);
            depths.push(reached);
        }
        // Without finishing passes the allowance still has to go.
        let finishing = if allowance > 0.0 { finishing.max(1) } else { finishing };
        depths.extend((0..finishing).map(|_| height));
        let inwards = if root <= from[0] { -1.0 } else { 1.0 };
        let mode = kernel.feed_mode;
        let cut = || -> Result<(), Fault> {
            for depth in depths {
                let x = root - inwards * (height - depth);
                kernel.purpose = Some(Purpose::Cycle);
                kernel.straight(&place(Some(x + taper), None), true)?;
                kernel.purpose = Some(Purpose::Thread);
                kernel.feed_mode = FeedMode::Revolution;
                kernel.straight(&place(Some(x), Some(end)), false)?;
                kernel.feed_mode = mode;
                kernel.purpose = Some(Purpose::Cycle);
                kernel.straight(&place(Some(from[0]), None), true)?;
                kernel.straight(&place(None, Some(from[2])), true)?;
            }
            Ok(())
        };
        let done = cut();
        (kernel.purpose, kernel.feed_mode) = (None, mode);
        done
    }
}
