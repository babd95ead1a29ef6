//! Elements of a contour, with roundings and chamfers between straight ones.

use super::Klartext;
use crate::error::Fault;
use crate::kernel::{Kernel, Round, Target};
use crate::motion::Axes;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Element {
    Line,
    Arc(Round, bool, f64),
}

/// What stands between two elements.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Joint {
    /// Radius, mm, with a feed of its own, mm/min.
    Round(f64, Option<f64>),
    /// Length cut off each side, mm.
    Chamfer(f64),
}

/// An element that waits for the next, since a corner joins them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub target: Target,
    pub element: Element,
    pub rapid: bool,
    pub joint: Option<Joint>,
}

impl Klartext {
    /// Position behind everything that is programmed, with what waits.
    pub(super) fn at(&self, kernel: &Kernel) -> Axes {
        let mut position = kernel.program_at();
        if let Some(approach) = &self.approach {
            position = approach.end(&position);
        }
        if let Some(corner) = &self.corner {
            position = std::array::from_fn(|axis| corner.target.end(axis, &position));
        }
        position
    }

    /// Runs an element, or lets it wait for the corner behind it.
    pub(super) fn follow(&mut self, mut corner: Corner, joins: bool, kernel: &mut Kernel) -> Result<(), Fault> {
        let from = self.at(kernel);
        self.run_approach(&corner, kernel)?;
        if let Some(before) = self.corner.take() {
            corner = self.join(before, corner, from, kernel)?;
        }
        if joins {
            if corner.rapid {
                return Err(Fault::new("a corner joins two motions at feed, not FMAX"));
            }
            self.corner = Some(corner);
            return Ok(());
        }
        self.run_element(&corner, kernel)
    }

    /// Gives the element that waits.
    pub(super) fn flush(&mut self, kernel: &mut Kernel) -> Result<(), Fault> {
        if self.approach.is_some() {
            return Err(Fault::new("APPR has no element of a contour behind it, whose direction it could take"));
        }
        match self.corner.take() {
            Some(own) if own.joint.is_some() => {
                Err(Fault::new("RND or CHF has no motion behind it that it could join"))
            }
            Some(own) => self.run_element(&own, kernel),
            None => Ok(()),
        }
    }

    fn run_element(&mut self, corner: &Corner, kernel: &mut Kernel) -> Result<(), Fault> {
        let from = kernel.program_at();
        match corner.element {
            Element::Line => kernel.straight(&corner.target, corner.rapid)?,
            Element::Arc(round, left, turns) => kernel.round(&corner.target, round, left, turns)?,
        }
        self.turn_to(corner, &from, kernel);
        Ok(())
    }

    /// Runs the element before a corner and the corner; gives the element behind it.
    fn join(&mut self, before: Corner, after: Corner, corner: Axes, kernel: &mut Kernel) -> Result<Corner, Fault> {
        let Some(joint) = before.joint else {
            self.run_element(&before, kernel)?;
            return Ok(after);
        };
        if before.element != Element::Line || after.element != Element::Line || after.rapid {
            return Err(Fault::new(
                "a rounding or chamfer beside an arc or FMAX is not followed; write its arc or line",
            )
            .refusing());
        }
        let [u, v, _] = kernel.plane;
        let start = kernel.program_at();
        let end = |axis: usize| after.target.end(axis, &corner);
        let unit = |d: [f64; 2]| {
            let size = d[0].hypot(d[1]);
            (size > 0.0).then(|| ([d[0] / size, d[1] / size], size))
        };
        let straight = || Fault::new("a rounding or chamfer needs a motion in the plane on both sides");
        let (back, room) = unit([start[u] - corner[u], start[v] - corner[v]]).ok_or_else(straight)?;
        let (ahead, space) = unit([end(u) - corner[u], end(v) - corner[v]]).ok_or_else(straight)?;
        let cosine = (back[0] * ahead[0] + back[1] * ahead[1]).clamp(-1.0, 1.0);
        let half = 0.5 * cosine.acos();
        let cut = match joint {
            Joint::Chamfer(size) => size,
            Joint::Round(radius, _) => radius / half.tan(),
        };
        if cut.is_nan() || cut > room.min(space) + 1e-9 {
            return Err(Fault::new("the rounding or chamfer is larger than the motions beside it; take a smaller one"));
        }
        let mut first = before.target;
        let place = |target: &mut Target, arm: [f64; 2]| {
            for (axis, part) in [(u, arm[0]), (v, arm[1])] {
                (target.absolute[axis], target.step[axis]) = (Some(corner[axis] + cut * part), None);
            }
        };
        place(&mut first, back);
        let mut second = Target::default();
        place(&mut second, ahead);
        self.run_element(&Corner { target: first, joint: None, ..before }, kernel)?;
        let turn = back[1] * ahead[0] - back[0] * ahead[1];
        match joint {
            Joint::Chamfer(_) => kernel.straight(&second, false)?,
            Joint::Round(radius, feed) if turn.abs() > 1e-12 => {
                let (before, scale) = (kernel.feed, kernel.feed_scale);
                if let Some(feed) = feed {
                    kernel.set_feed(feed, 1.0)?;
                }
                // The way in turns by the outer angle of the corner: left where the path turns left.
                kernel.round(&second, Round::Radius(radius), turn > 0.0, 0.0)?;
                (kernel.feed, kernel.feed_scale) = (before, scale);
            }
            Joint::Round(..) => kernel.straight(&second, false)?,
        }
        let mut rest = after;
        // Steps count from the corner, not from where its joint ends.
        for axis in 0..9 {
            if let Some(step) = rest.target.step[axis].take() {
                rest.target.absolute[axis] = Some(corner[axis] + step);
            }
        }
        Ok(rest)
    }
}
