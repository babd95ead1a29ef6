//! Roughing along a contour, G71 along the axis and G72 across it.
//!
//! # Source
//! The operator's manuals of Fanuc, cited from memory (assumption). Type I, whose first block moves across the passes alone:
//! passes start at the allowances from the start, feed up to the contour, escape by R under 45 degrees and return at rapid
//! speed; a last pass feeds along the contour with its allowances. Such a contour may not turn back in either axis. Type II,
//! whose first block names both axes, may: see [`super::pockets`].

use super::blocks::{PASSES, place};
use super::pockets::Pocket;
use crate::error::Fault;
use crate::iso::parse::Code;
use crate::iso::run::Iso;
use crate::kernel::{Kernel, Round, Target};
use crate::motion::{Axes, EventKind, Motion, Path, Purpose};

/// Pieces into which an arc is cut where a pass meets it.
const PIECES: u32 = 200;
/// How far a contour may turn back, mm: ends of arcs are rounded in the program (assumption).
const ROUNDED: f64 = 0.01;

/// A place on a contour: a motion, and the share of it that lies behind.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub motion: usize,
    pub share: f64,
    pub at: Axes,
}

/// A contour behind its first block, as passes along `along` see it.
pub(super) struct Profile {
    pub motions: Vec<Motion>,
    /// Axis across the passes and axis along them.
    pub across: usize,
    pub along: usize,
    /// Direction of depth in the axis across the passes, and of the passes.
    pub inwards: f64,
    pub ahead: f64,
    /// Where the cycle starts, program coordinates in mm.
    pub start: Axes,
    /// Allowances in X and Z, mm.
    pub allowances: [f64; 2],
}

impl Profile {
    /// Depth of a place below the start, mm.
    pub fn depth(&self, axes: &Axes) -> f64 {
        self.inwards * (axes[self.across] - self.start[self.across])
    }

    pub fn allowance(&self, axis: usize) -> f64 {
        self.allowances[usize::from(axis == 2)]
    }

    fn spot(&self, motion: usize, share: f64) -> Spot {
        Spot { motion, share, at: self.motions[motion].position(share) }
    }

    pub fn ends(&self) -> (Spot, Spot) {
        (self.spot(0, 0.0), self.spot(self.motions.len() - 1, 1.0))
    }

    /// Places from one to another, near enough that the depth between two of them rises or falls only.
    pub fn spots(&self, start: Spot, end: Spot) -> Vec<Spot> {
        let mut list = vec![start];
        for motion in start.motion..=end.motion {
            let first = if motion == start.motion { start.share } else { 0.0 };
            let last = if motion == end.motion { end.share } else { 1.0 };
            let pieces = if self.motions[motion].path == Path::Line { 1 } else { PIECES };
            let shares = (0..=pieces).map(|piece| f64::from(piece) / f64::from(pieces));
            list.extend(shares.map(|share| share.clamp(first, last.max(first))).map(|share| self.spot(motion, share)));
        }
        list.push(end);
        list
    }

    /// Parts between two places that lie deeper than `level`, mm.
    pub fn deeper(&self, level: f64, start: Spot, end: Spot) -> Vec<(Spot, Spot)> {
        let inside = |spot: &Spot| self.depth(&spot.at) > level + 1e-9;
        let spots = self.spots(start, end);
        let mut parts: Vec<(Spot, Spot)> = Vec::new();
        let mut begun = inside(&start).then_some(start);
        for pair in spots.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            match (inside(&a), inside(&b)) {
                (false, true) => begun = Some(self.crossing(a, b, inside)),
                (true, false) => parts.extend(begun.take().map(|first| (first, self.crossing(a, b, inside)))),
                (true, true) | (false, false) => {}
            }
        }
        parts.extend(begun.map(|first| (first, end)));
        parts
    }

    /// Where the depth passes the level between two places of one motion.
    fn crossing(&self, a: Spot, b: Spot, inside: impl Fn(&Spot) -> bool) -> Spot {
        if a.motion != b.motion {
            return b;
        }
        let (mut low, mut high) = (a.share, b.share);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if inside(&self.spot(a.motion, middle)) == inside(&b) { high = middle } else { low = middle }
        }
        self.spot(a.motion, high)
    }

    /// Feeds along the contour with its allowances from one place to another.
    pub fn follow(&self, start: Spot, end: Spot, kernel: &mut Kernel) -> Result<(), Fault> {
        for index in start.motion..=end.motion {
            let first = if index == start.motion { start.share } else { 0.0 };
            let last = if index == end.motion { end.share } else { 1.0 };
            if last - first <= 1e-12 {
                continue;
            }
            let motion = Motion { end: self.spot(index, last).at, rapid: false, ..self.motions[index] };
            shifted(&motion, self.allowances, kernel)?;
        }
        Ok(())
    }

    /// The axis along the passes moves one way; in type I the contour only rises towards the start, too.
    fn check(&self, code: u32, pockets: bool) -> Result<(), Fault> {
        let (from, to) = self.ends();
        let (mut farthest, mut least) = (f64::NEG_INFINITY, f64::INFINITY);
        for spot in self.spots(from, to) {
            let (way, depth) = (self.ahead * spot.at[self.along], self.depth(&spot.at));
            if way < farthest - ROUNDED {
                let letter = if code == 71 { 'Z' } else { 'X' };
                return Err(Fault::new(format!(
                    "the contour of G{code} turns back along {letter}, which the cycle does not cut; rough it with G73 or in two contours"
                )));
            }
            if !pockets && depth > least + ROUNDED {
                return Err(Fault::new(format!(
                    "the contour of G{code} has a pocket, which type I does not cut: name X and Z in its first block (type II)"
                )));
            }
            (farthest, least) = (farthest.max(way), least.min(depth));
        }
        Ok(())
    }

    /// The place along the passes where the contour first rises to `level`, mm; `None` where it never does.
    fn meets(&self, level: f64) -> Option<f64> {
        let (from, to) = self.ends();
        let first = self.deeper(level, from, to).into_iter().next();
        match first {
            None => Some(from.at[self.along]),
            Some((begin, _)) if begin.motion > 0 || begin.share > 0.0 => Some(from.at[self.along]),
            Some((_, end)) if end.motion == to.motion && end.share >= 1.0 => None,
            Some((_, end)) => Some(end.at[self.along]),
        }
    }
}

impl Iso {
    /// The motions of a contour, in coordinates of the program; everything stands as before afterwards.
    pub(super) fn motions(&mut self, first: usize, last: usize, kernel: &mut Kernel) -> Result<Vec<Motion>, Fault> {
        let out = std::mem::take(&mut kernel.out);
        let (at, known) = (kernel.at, kernel.referenced);
        let (feed, scale, mode) = (kernel.feed, kernel.feed_scale, kernel.feed_mode);
        let (speed, surface, sense) = (kernel.speed, kernel.surface, kernel.sense);
        let program = kernel.program_at();
        let contour = self.contour(first, last, kernel);
        let events = std::mem::replace(&mut kernel.out, out);
        (kernel.at, kernel.referenced) = (at, known);
        (kernel.feed, kernel.feed_scale, kernel.feed_mode) = (feed, scale, mode);
        (kernel.speed, kernel.surface, kernel.sense) = (speed, surface, sense);
        contour?;
        let shift = [program[0] - at[0], program[2] - at[2]];
        let moved = |mut motion: Motion| {
            for (axis, part) in [(0, shift[0]), (2, shift[1])] {
                motion.start[axis] += part;
                motion.end[axis] += part;
            }
            if let Path::Arc(arc) = &mut motion.path {
                // The plane of a lathe is ZX.
                arc.centre[0] += shift[1];
                arc.centre[1] += shift[0];
            }
            motion
        };
        let list = events.into_iter().filter_map(|event| match event.kind {
            EventKind::Motion(motion) => Some(moved(motion)),
            EventKind::Block
            | EventKind::Dwell(_)
            | EventKind::ToolChange(_)
            | EventKind::Spindle { .. }
            | EventKind::Coolant(_)
            | EventKind::Stop(_)
            | EventKind::Auxiliary(..)
            | EventKind::Hole
            | EventKind::Home(_)
            | EventKind::ExactStop
            | EventKind::Offset(_)
            | EventKind::End => None,
        });
        Ok(list.collect())
    }

    /// Whether a block names both X and Z, as the first of a contour of type II does.
    fn names_both(&mut self, statement: usize) -> Result<bool, Fault> {
        let statement = self.statements.at(statement)?;
        let Some(Code::Block(block)) = statement.as_ref().map(|statement| &statement.code) else { return Ok(false) };
        let names = |letters: [u8; 2]| block.words.iter().any(|word| letters.contains(&word.letter));
        Ok(names([b'X', b'U']) && names([b'Z', b'W']))
    }

    /// G71: passes along Z down to the contour with its allowances in X and Z, mm; G72: passes along X.
    pub(super) fn rough(
        &mut self,
        code: u32,
        first: usize,
        last: usize,
        allowances: [f64; 2],
        kernel: &mut Kernel,
    ) -> Result<(), Fault> {
        let (depth, escape) = (self.two.depth, self.two.escape);
        // Axis across the passes, with its letter and the word of the depth, and the axis along them.
        let (across, letter, word, along) = if code == 71 { (0, 'X', 'U', 2) } else { (2, 'Z', 'W', 0) };
        if depth <= 0.0 {
            return Err(Fault::new(format!("G{code} needs {word} above zero in its first block, the depth of a pass")));
        }
        let pockets = self.names_both(first)?;
        let contour = self.motions(first, last, kernel)?;
        let (Some((entry, rest)), start) = (contour.split_first(), kernel.program_at()) else {
            return Err(Fault::new(format!("the contour of G{code} moves nothing")));
        };
        let Some(end) = rest.last().map(|motion| motion.end) else {
            return Err(Fault::new(format!("the contour of G{code} needs motions behind its first block")));
        };
        if entry.start[along] != entry.end[along] && !pockets {
            return Err(Fault::new(format!(
                "the first block of the contour of G{code} moves {letter} alone, or names both axes (type II)"
            )));
        }
        let ahead = if end[along] < entry.end[along] { -1.0 } else { 1.0 };
        let mut profile = Profile { motions: rest.to_vec(), across, along, inwards: 1.0, ahead, start, allowances };
        let (from, to) = profile.ends();
        let depths = profile.spots(from, to).into_iter().map(|spot| profile.depth(&spot.at));
        let farthest = depths.fold(0.0, |most: f64, depth| if depth.abs() > most.abs() { depth } else { most });
        profile.inwards = if farthest <= 0.0 { -1.0 } else { 1.0 };
        profile.check(code, pockets)?;
        let begin = |axis: usize| start[axis] + profile.allowance(axis);
        let both = |a: f64, b: f64| {
            let mut target = Target::one(across, a);
            target.absolute[along] = Some(b);
            target
        };
        kernel.purpose = Some(Purpose::Cycle);
        let mut cut = || -> Result<(), Fault> {
            kernel.straight(&both(begin(across), begin(along)), true)?;
            if pockets {
                let pocket = Pocket { profile: &profile, code, depth, escape, rapid: entry.rapid };
                pocket.cut(kernel)?;
                kernel.straight(&Target::one(along, entry.end[along] + profile.allowance(along)), true)?;
            } else {
                passes(&profile, code, depth, escape, entry, kernel)?;
            }
            kernel.straight(&Target::one(across, entry.end[across] + profile.allowance(across)), entry.rapid)?;
            follow_shifted(rest, allowances, kernel)?;
            kernel.straight(&place(Some(start[0]), Some(start[2])), true)
        };
        let done = cut();
        kernel.purpose = None;
        done
    }
}

/// Passes of type I.
fn passes(
    profile: &Profile,
    code: u32,
    depth: f64,
    escape: f64,
    entry: &Motion,
    kernel: &mut Kernel,
) -> Result<(), Fault> {
    let Profile { across, along, inwards, ahead, start, .. } = *profile;
    let begin = |axis: usize| start[axis] + profile.allowance(axis);
    let end = profile.ends().1.at[along];
    let deepest = profile.depth(&entry.end);
    for pass in 1..=PASSES {
        let level = depth * f64::from(pass);
        if deepest - level <= 1e-9 {
            return Ok(());
        }
        let place = begin(across) + inwards * level;
        kernel.straight(&Target::one(across, place), entry.rapid)?;
        let stop = profile.meets(level).unwrap_or(end) + profile.allowance(along);
        kernel.straight(&Target::one(along, stop), false)?;
        let mut away = Target::one(across, place - inwards * escape);
        away.absolute[along] = Some(stop - ahead * escape);
        kernel.straight(&away, true)?;
        kernel.straight(&Target::one(along, begin(along)), true)?;
    }
    Err(Fault::new(format!("G{code} takes more than {PASSES} passes; check its depth")))
}

/// The motions of a contour, shifted in X and Z, mm.
pub(super) fn follow_shifted(contour: &[Motion], shift: [f64; 2], kernel: &mut Kernel) -> Result<(), Fault> {
    contour.iter().try_for_each(|motion| shifted(motion, shift, kernel))
}

fn shifted(motion: &Motion, [u, w]: [f64; 2], kernel: &mut Kernel) -> Result<(), Fault> {
    let target = place(Some(motion.end[0] + u), Some(motion.end[2] + w));
    match motion.path {
        Path::Line => kernel.straight(&target, motion.rapid),
        Path::Arc(arc) => {
            // The plane of a lathe is ZX.
            let centre = Round::Centre([arc.centre[0] + w, arc.centre[1] + u]);
            kernel.round(&target, centre, arc.left, 0.0)
        }
    }
}
