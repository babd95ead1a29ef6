//! Arcs, splines and threads.

use super::run::Iso;
use super::words::Words;
use crate::Dialect;
use crate::error::Fault;
use crate::kernel::{FeedMode, Kernel, Round, Target};
use crate::motion::{PLANES, Purpose};

impl Iso {
    pub(super) fn arc(&mut self, left: bool, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        if self.modes.polar.is_some() {
            return Err(Fault::new("an arc in polar coordinates (G16) is not followed; write G15 before it").refusing());
        }
        let target = self.target(words, kernel)?;
        let [u, v, w] = kernel.plane;
        let letters = [b'I', b'J', b'K'];
        if let Some(value) = words.see(letters[w]).filter(|value| *value != 0.0) {
            let letter = char::from(letters[w]);
            let message =
                format!("{letter}{value} is no part of an arc in this plane; write G17, G18 or G19 before it");
            return Err(Fault::at(words.column(letters[w]), message));
        }
        words.spend(&[letters[w]]);
        let from = kernel.program_at();
        let centred = words.has(letters[u]) || words.has(letters[v]);
        let round = match (centred, words.take(b'R')) {
            (true, Some(_)) => {
                return Err(Fault::at(
                    words.column(b'R'),
                    "centre and radius stand in one block, and which counts differs by control; leave one out",
                ));
            }
            (false, None) => return Err(Fault::new("an arc needs I, J, K or R")),
            (false, Some(radius)) => Round::Radius(self.mm(kernel, words, b'R', radius)?),
            (true, None) => {
                let mut centre = [from[u], from[v]];
                for (slot, axis) in centre.iter_mut().zip([u, v]) {
                    let value = words.take(letters[axis]);
                    if self.modes.arc_absolute {
                        let Some(value) = value else {
                            return Err(Fault::new("absolute centres (G90.1) need both words of the plane"));
                        };
                        *slot = self.mm(kernel, words, letters[axis], value)?;
                    } else if let Some(value) = value {
                        *slot += self.mm(kernel, words, letters[axis], value)?;
                    }
                }
                Round::Centre(centre)
            }
        };
        let turns = match self.dialect {
            Dialect::LinuxCnc | Dialect::Haas => words.whole(b'P', 1.0, 1e5)?,
            Dialect::Fanuc => words.whole(kernel.control.turns, 1.0, 1e5)?,
            Dialect::FanucLathe | Dialect::Siemens | Dialect::Heidenhain => None,
        };
        kernel.round(&target, round, left, f64::from(turns.unwrap_or(1) - 1))
    }

    /// LinuxCNC's splines in X and Y.
    pub(super) fn spline(&mut self, cubic: bool, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        if kernel.plane != PLANES[0] {
            return Err(Fault::new("splines run in the plane XY; write G17 before"));
        }
        let from = kernel.program_at();
        let target = self.target(words, kernel)?;
        let mut to = from;
        for axis in 0..2 {
            to[axis] = target.end(axis, &from);
        }
        if (2..9).any(|axis| target.names(axis)) {
            return Err(Fault::new("splines take X and Y only"));
        }
        let mut offset = |letter: u8| -> Result<Option<f64>, Fault> {
            words.take(letter).map(|value| self.mm(kernel, words, letter, value)).transpose()
        };
        let (i, j, p, q) = (offset(b'I')?, offset(b'J')?, offset(b'P')?, offset(b'Q')?);
        let points = if cubic {
            // Behind another it goes on in its direction where it does not say where to.
            let here = [from[0], from[1]];
            let goes_on = self.spline_end.filter(|(end, _)| *end == here).map(|(_, [p, q])| [-p, -q]);
            let first = i.zip(j).map(|(i, j)| [i, j]).or(goes_on.filter(|_| i.is_none() && j.is_none()));
            let (Some([i, j]), Some(p), Some(q)) = (first, p, q) else {
                return Err(Fault::new("a cubic spline needs P and Q, and the first of a series I and J"));
            };
            self.spline_end = Some(([to[0], to[1]], [p, q]));
            vec![[from[0], from[1]], [from[0] + i, from[1] + j], [to[0] + p, to[1] + q], [to[0], to[1]]]
        } else {
            if i.is_none() && j.is_none() {
                return Err(Fault::new("a quadratic spline needs I and J"));
            }
            let middle = [from[0] + i.unwrap_or(0.0), from[1] + j.unwrap_or(0.0)];
            vec![[from[0], from[1]], middle, [to[0], to[1]]]
        };
        /// Lines of a spline, which LinuxCNC follows by arcs: their length is right to a millionth and better (a test).
        const PIECES: usize = 2000;
        for piece in 1..=PIECES {
            let point = bezier(&points, piece as f64 / PIECES as f64);
            let mut target = Target::default();
            (target.absolute[0], target.absolute[1]) = (Some(point[0]), Some(point[1]));
            kernel.straight(&target, false)?;
        }
        Ok(())
    }

    /// G33.1 of LinuxCNC: a thread of the pitch K to a place, and back to where it began.
    pub(super) fn rigid_tap(&mut self, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        if !words.has(b'K') {
            return Err(Fault::new("G33.1 needs K, the pitch"));
        }
        let start = kernel.program_at();
        let target = self.target(words, kernel)?;
        self.thread(&target, words, kernel)?;
        let sense = kernel.sense;
        if sense.stands() {
            return Err(Fault::new("G33.1 needs a spindle that turns"));
        }
        kernel.spindle(sense.reversed());
        let mut back = Target::default();
        for axis in (0..9).filter(|axis| target.names(*axis)) {
            back.absolute[axis] = Some(start[axis]);
        }
        self.thread(&back, words, kernel)?;
        kernel.spindle(sense);
        Ok(())
    }

    /// A straight motion with the spindle's turns: K (LinuxCNC) or F (lathe) a revolution.
    pub(super) fn thread(&mut self, target: &Target, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let (feed, scale, mode) = (kernel.feed, kernel.feed_scale, kernel.feed_mode);
        if let Some(pitch) = words.take(b'K') {
            kernel.feed = Some(kernel.length(pitch)?);
            kernel.feed_scale = kernel.scale.unwrap_or(1.0);
        }
        kernel.feed_mode = FeedMode::Revolution;
        kernel.purpose = Some(Purpose::Thread);
        let done = kernel.straight(target, false);
        kernel.purpose = None;
        kernel.feed_mode = mode;
        if self.dialect == Dialect::LinuxCnc {
            (kernel.feed, kernel.feed_scale) = (feed, scale);
        }
        done
    }
}

/// A point of a Bézier curve by de Casteljau.
fn bezier(points: &[[f64; 2]], share: f64) -> [f64; 2] {
    let mut control = points.to_vec();
    while control.len() > 1 {
        control = control
            .windows(2)
            .map(|pair| std::array::from_fn(|i| pair[0][i] + share * (pair[1][i] - pair[0][i])))
            .collect();
    }
    control[0]
}
