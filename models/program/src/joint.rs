//! Chamfers and roundings between two straight motions, as blocks name them on SINUMERIK and Fanuc.

use crate::error::Fault;
use crate::kernel::{FeedMode, Kernel};
use crate::lathe::surface_time;
use crate::motion::{Arc, Motion, Path};

/// What stands between a motion and the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Joint {
    /// Radius of a rounding, mm.
    Round(f64),
    /// Length that a chamfer cuts off each motion, mm.
    Legs(f64),
    /// Length of the chamfer itself, mm.
    Chamfer(f64),
}

/// A motion that waits for the next, since a joint stands between them.
#[derive(Clone, Debug)]
pub(crate) struct PendingMotion {
    motion: Motion,
    joint: Joint,
    /// Line of the program and of its caller, and depth of calls.
    place: (usize, usize, usize),
    /// Plane in which the joint lies.
    plane: [usize; 3],
    /// Feed a revolution, surface speed and greatest speed, where the speed follows the diameter.
    surface: Option<[f64; 3]>,
}

fn alone() -> Fault {
    Fault::new("a chamfer or rounding has no motion behind it that it could join; leave it out")
}

/// Length, mm, that is only rounding: a joint may use up a motion beside it.
const ROUNDING: f64 = 1e-9;

fn unlike() -> Fault {
    Fault::new("a chamfer or rounding stands between two straight motions at feed in the plane; write its line or arc")
}

impl PendingMotion {
    /// The motion that waits, the joint, and the motion behind it, shortened.
    fn join(mut self, mut next: Motion) -> Result<[Motion; 3], Fault> {
        let [u, v, _] = self.plane;
        let mut first = self.motion;
        let flat = |motion: &Motion| (0..9).all(|i| i == u || i == v || motion.start[i] == motion.end[i]);
        let fits = |motion: &Motion| !motion.rapid && !motion.unknown && motion.path == Path::Line && flat(motion);
        if !fits(&first) || !fits(&next) || first.length <= 0.0 || next.length <= 0.0 {
            return Err(unlike());
        }
        let corner = first.end;
        let arm = |to: &[f64; 9], length: f64| [(to[u] - corner[u]) / length, (to[v] - corner[v]) / length];
        let (back, ahead) = (arm(&first.start, first.length), arm(&next.end, next.length));
        let half = 0.5 * (back[0] * ahead[0] + back[1] * ahead[1]).clamp(-1.0, 1.0).acos();
        let cut = match self.joint {
            Joint::Legs(leg) => leg,
            Joint::Chamfer(length) => 0.5 * length / half.sin(),
            Joint::Round(radius) => radius / half.tan(),
        };
        if cut.is_nan() || cut > first.length.min(next.length) + 1e-9 {
            return Err(Fault::new("the chamfer or rounding is larger than the motions beside it; take a smaller one"));
        }
        let point = |arm: [f64; 2]| {
            let mut place = corner;
            (place[u], place[v]) = (corner[u] + cut * arm[0], corner[v] + cut * arm[1]);
            place
        };
        let (from, to) = (point(back), point(ahead));
        let rate = first.time / first.length;
        let turn = back[1] * ahead[0] - back[0] * ahead[1];
        let mut middle = Motion { start: from, end: to, ..first };
        match self.joint {
            // Between motions in one direction there is nothing to round.
            Joint::Round(radius) if turn.abs() > 1e-12 => {
                let (angle, reach) = (std::f64::consts::PI - 2.0 * half, cut.hypot(radius));
                let bisector = [back[0] + ahead[0], back[1] + ahead[1]];
                let size = bisector[0].hypot(bisector[1]);
                let centre = [corner[u] + reach * bisector[0] / size, corner[v] + reach * bisector[1] / size];
                middle.path = Path::Arc(Arc { centre, plane: self.plane, left: turn > 0.0, angle, radius });
                middle.length = radius * angle;
            }
            Joint::Round(_) | Joint::Legs(_) | Joint::Chamfer(_) => {
                middle.length = (to[u] - from[u]).hypot(to[v] - from[v]);
            }
        }
        let ahead_rate = next.time / next.length;
        (first.end, next.start) = (from, to);
        (first.length, next.length) = (first.length - cut, next.length - cut);
        match self.surface.take() {
            Some([feed, surface, clamp]) => {
                for motion in [&mut first, &mut middle, &mut next] {
                    let arc = if let Path::Arc(arc) = &motion.path { Some(*arc) } else { None };
                    let (start, end) = (motion.start, motion.end);
                    motion.time = surface_time(&start, &end, arc.as_ref(), motion.length, feed, surface, clamp)?;
                }
            }
            None => {
                (first.time, middle.time) = (rate * first.length, rate * middle.length);
                next.time = ahead_rate * next.length;
            }
        }
        Ok([first, middle, next])
    }
}

impl Kernel {
    /// A chamfer or rounding behind the motion of this block; its size in mm.
    pub fn joint(&mut self, joint: Joint) -> Result<(), Fault> {
        let (Joint::Round(size) | Joint::Legs(size) | Joint::Chamfer(size)) = joint;
        if !(size > 0.0 && size.is_finite()) {
            return Err(Fault::new("the size of a chamfer or rounding must be above 0"));
        }
        if self.feed_mode == FeedMode::Inverse {
            return Err(Fault::new("a chamfer or rounding with feeds in inverse time (G93) is not followed").refusing());
        }
        self.joint = Some(joint);
        Ok(())
    }

    /// Hands on a motion with the joint that waits before it; one with a joint of its own waits.
    pub fn emit(&mut self, mut motion: Motion) -> Result<(), Fault> {
        self.moved = true;
        if let Some(waiting) = self.waiting.take() {
            if self.torn {
                return Err(alone());
            }
            let place = waiting.place;
            let now = (self.line, self.main_line, self.depth);
            let [first, middle, next] = waiting.join(motion)?;
            (self.line, self.main_line, self.depth) = place;
            let done = [first, middle]
                .into_iter()
                .filter(|part| part.length > ROUNDING)
                .try_for_each(|part| self.hand_on(part));
            (self.line, self.main_line, self.depth) = now;
            done?;
            if next.length <= ROUNDING && self.joint.is_none() {
                return Ok(());
            }
            motion = next;
        }
        let Some(joint) = self.joint.take() else { return self.hand_on(motion) };
        let surface = self.surface.filter(|_| self.feed_mode == FeedMode::Revolution);
        let surface = surface.zip(self.feed).map(|(surface, feed)| [feed, surface, self.clamp]);
        let place = (self.line, self.main_line, self.depth);
        self.waiting = Some(PendingMotion { motion, joint, place, plane: self.plane, surface });
        Ok(())
    }

    /// A block without a motion has no corner.
    pub fn spent_joint(&mut self) -> Result<(), Fault> {
        match self.joint.take() {
            Some(_) => Err(Fault::new("a chamfer or rounding stands in a block without a motion; write it behind one")),
            None => Ok(()),
        }
    }

    /// A joint without a motion behind it is a fault of the program.
    pub fn close_joint(&self) -> Result<(), Fault> {
        if self.waiting.is_some() || self.joint.is_some() || self.torn { Err(alone()) } else { Ok(()) }
    }
}
