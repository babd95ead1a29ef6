//! Holes that stay cycles: what was worked out is written as one of the cycles of the control that make the same motions.

use crate::hole::{Hole, LEVEL, Way};
use crate::{Writer, number};
use toolroom_program::{Control, Dialect, Event, EventKind, Motion, Purpose};

/// What has come of a cycle that is not over yet: its motions and dwells as they are to be written, with the axes whose place is known
/// at each.
#[derive(Default)]
struct Pending {
    parts: Vec<(Event, [bool; 9])>,
}

/// Cycles that are kept.
#[derive(Default)]
pub(crate) struct Cycles {
    pending: Pending,
    /// The hole whose cycle is in force.
    modal: Option<Hole>,
    /// The rapid motion in the plane that may lead to its next place, with its line.
    held: Option<(Motion, usize)>,
    /// Whether the hole that ends next was tapped.
    tapped: bool,
    /// Holes that are cycles, and such that were worked out.
    pub count: [usize; 2],
}

impl Writer {
    /// Takes an event that may belong to a cycle; false where it is to be written as any other. `part` is the event with the motion that
    /// is to be written.
    ///
    /// # Errors
    /// The line of what the language has no words for, and why.
    pub(crate) fn keeps(&mut self, part: &Event, known: [bool; 9]) -> Result<bool, (usize, &'static str)> {
        let Some(cycles) = &mut self.cycles else { return Ok(false) };
        let begun = !cycles.pending.parts.is_empty();
        let belongs = match part.kind {
            EventKind::Motion(motion) => motion.purpose == Purpose::Cycle,
            EventKind::Dwell(_) => begun,
            EventKind::Hole if begun => {
                let pending = std::mem::take(&mut cycles.pending);
                let kept = match Hole::of(&pending.parts) {
                    Some(hole) => self.hole(&hole).map_err(|message| (part.line, message))?,
                    None => false,
                };
                if !kept {
                    self.work_out(pending)?;
                }
                self.count(kept);
                return Ok(true);
            }
            EventKind::Hole => {
                // A tap is a cycle in every language, or a block of its own.
                let tapped = std::mem::take(&mut cycles.tapped);
                self.count(tapped);
                return Ok(true);
            }
            EventKind::Block => return Ok(true), // nothing is written for it
            EventKind::Spindle { .. }
            | EventKind::ToolChange(_)
            | EventKind::Coolant(_)
            | EventKind::Stop(_)
            | EventKind::Auxiliary(..)
            | EventKind::ExactStop
            | EventKind::Home(_)
            | EventKind::Offset(_)
            | EventKind::End => false,
        };
        if belongs {
            cycles.pending.parts.push((*part, known));
            return Ok(true);
        }
        let pending = std::mem::take(&mut cycles.pending);
        if begun {
            self.work_out(pending)?;
        }
        if let EventKind::Motion(motion) = part.kind
            && self.holds(&motion, part.line)
        {
            return Ok(true);
        }
        self.end_cycle().map_err(|message| (part.line, message))?;
        Ok(false)
    }

    /// Writes what is not over at the end of the program.
    ///
    /// # Errors
    /// As [`Writer::keeps`].
    pub(crate) fn end_cycles(&mut self, line: usize) -> Result<(), (usize, &'static str)> {
        let pending = self.cycles.as_mut().map(|cycles| std::mem::take(&mut cycles.pending)).unwrap_or_default();
        self.work_out(pending)?;
        self.end_cycle().map_err(|message| (line, message))
    }

    /// Writes a cycle as it came.
    fn work_out(&mut self, pending: Pending) -> Result<(), (usize, &'static str)> {
        self.end_cycle().map_err(|message| (0, message))?;
        for (event, known) in pending.parts {
            self.known = known;
            let EventKind::Motion(motion) = event.kind else {
                self.event(&event);
                continue;
            };
            self.motion(&motion, event.line).map_err(|message| (event.line, message))?;
        }
        Ok(())
    }

    fn count(&mut self, kept: bool) {
        if let Some(cycles) = &mut self.cycles {
            cycles.count[usize::from(!kept)] += 1;
        }
    }

    /// A tap was written as a cycle of its own, which is in force now.
    pub(crate) fn tapped(&mut self) {
        if let Some(cycles) = &mut self.cycles {
            (cycles.tapped, cycles.modal) = (true, None);
        }
    }

    fn iso(&self) -> bool {
        !matches!(self.dialect, Dialect::Siemens | Dialect::Heidenhain)
    }

    fn modal(&self) -> Option<Hole> {
        self.cycles.as_ref().and_then(|cycles| cycles.modal)
    }

    fn set_modal(&mut self, hole: Hole) {
        if let Some(cycles) = &mut self.cycles {
            cycles.modal = Some(hole);
        }
    }

    /// Holds a rapid motion in the plane back while a cycle is in force, since it may lead to its next hole; true where it does.
    fn holds(&mut self, motion: &Motion, line: usize) -> bool {
        let flat = motion.rapid && !motion.unknown && (2..9).all(|axis| motion.start[axis] == motion.end[axis]);
        let iso = self.iso();
        match &mut self.cycles {
            Some(cycles) if iso && flat && cycles.modal.is_some() && cycles.held.is_none() => {
                cycles.held = Some((*motion, line));
                true
            }
            _ => false,
        }
    }

    /// Ends a cycle that is in force and writes what was held back for it.
    fn end_cycle(&mut self) -> Result<(), &'static str> {
        // Klartext keeps a cycle in force until the next is defined, whatever comes between.
        let iso = self.iso();
        let Some(cycles) = self.cycles.as_mut().filter(|_| iso) else { return Ok(()) };
        let (modal, held) = (cycles.modal.take(), cycles.held.take());
        if modal.is_some() {
            self.line("G80");
        }
        held.map_or(Ok(()), |(motion, line)| self.motion(&motion, line))
    }

    /// Writes a hole as a cycle of the control; false where none makes its motions.
    fn hole(&mut self, hole: &Hole) -> Result<bool, &'static str> {
        let written = match self.dialect {
            Dialect::Siemens => self.siemens_cycle(hole),
            Dialect::Heidenhain => self.klartext_cycle(hole),
            Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas | Dialect::LinuxCnc => self.iso_cycle(hole)?,
        };
        if written {
            self.position[2] = Some(Self::round(hole.level));
        }
        Ok(written)
    }

    fn iso_cycle(&mut self, hole: &Hole) -> Result<bool, &'static str> {
        let linuxcnc = self.dialect == Dialect::LinuxCnc;
        let alike = |a: f64, b: f64| (a - b).abs() <= LEVEL;
        let initial = alike(hole.level, hole.from);
        // The same distances that the control has where none is set.
        let clearance = Control::of(self.dialect).clearance(self.dialect);
        let kept = match hole.way {
            Way::Drill => true,
            // LinuxCNC feeds all the way out of G89.
            Way::Bore => !(linuxcnc && hole.dwell > 0.0) || alike(hole.level, hole.reference),
            Way::Pecks { again, .. } => alike(again, clearance) && (!linuxcnc || hole.dwell == 0.0),
            Way::Chips { back, .. } => alike(back, clearance) && (!linuxcnc || hole.dwell == 0.0),
        };
        let milliseconds = 1e3 * hole.dwell;
        if !kept
            || hole.from < hole.reference - LEVEL
            || !(initial || alike(hole.level, hole.reference))
            || (!linuxcnc && !alike(milliseconds, milliseconds.round()))
        {
            return Ok(false);
        }
        let goes_on = self.modal().is_some_and(|before| {
            let same = Hole { from: hole.from, ..before } == *hole;
            same && alike(before.level, hole.from)
        });
        if goes_on && let Some((motion, _)) = self.cycles.as_mut().and_then(|cycles| cycles.held.take()) {
            let words = self.axes(&motion.end, [false; 9]);
            if !words.is_empty() {
                self.line(words.trim_start());
                return Ok(true);
            }
        }
        self.end_cycle()?;
        let code = match (hole.way, hole.dwell > 0.0) {
            (Way::Drill, false) => 81,
            (Way::Drill, true) => 82,
            (Way::Bore, false) => 85,
            (Way::Bore, true) => 89,
            (Way::Pecks { .. }, _) => 83,
            (Way::Chips { .. }, _) => 73,
        };
        let mut text = format!("{} G{code}", if initial { "G98" } else { "G99" });
        // The place stands in the block, so that it says where the hole is.
        let at = self.position;
        for axis in 0..2 {
            if let Some(place) = at[axis] {
                text += &format!(" {}{}", ["X", "Y"][axis], self.value(place));
            }
        }
        text += &format!(" Z{} R{}", self.value(Self::round(hole.bottom)), self.value(Self::round(hole.reference)));
        if let Way::Pecks { depth, .. } | Way::Chips { depth, .. } = hole.way {
            text += &format!(" Q{}", self.value(depth));
        }
        if hole.dwell > 0.0 {
            let dwell = if linuxcnc { number(hole.dwell, 6, false) } else { format!("{milliseconds:.0}") };
            text += &format!(" P{dwell}");
        }
        text += &self.feed_word(hole.feed);
        self.line(&text);
        self.set_modal(*hole);
        Ok(true)
    }

    fn siemens_cycle(&mut self, hole: &Hole) -> bool {
        let [level, reference, bottom] =
            [hole.level, hole.reference, hole.bottom].map(|height| self.value(Self::round(height)));
        let dwell = number(hole.dwell, 6, false);
        match hole.way {
            Way::Drill => {
                let feed = self.feed_word(hole.feed);
                if !feed.is_empty() {
                    self.line(feed.trim_start());
                }
                if hole.dwell > 0.0 {
                    self.line(&format!("CYCLE82({level},{reference},0,{bottom},,{dwell})"));
                } else {
                    self.line(&format!("CYCLE81({level},{reference},0,{bottom})"));
                }
            }
            Way::Bore => {
                let feed = crate::precise(hole.feed);
                self.line(&format!("CYCLE85({level},{reference},0,{bottom},,{dwell},{feed},{feed})"));
            }
            Way::Pecks { .. } | Way::Chips { .. } => return false,
        }
        true
    }

    fn klartext_cycle(&mut self, hole: &Hole) -> bool {
        let (number_of, out) = match hole.way {
            Way::Drill => ("200 DRILLING", String::new()),
            Way::Bore => ("201 REAMING", format!(" ~\n  Q208={}", crate::precise(hole.feed))),
            Way::Pecks { .. } | Way::Chips { .. } => return false,
        };
        if self.modal().is_none_or(|before| (Hole { from: hole.from, ..before }) != *hole) {
            let [depth, above, surface] = [hole.bottom - hole.reference, hole.level - hole.reference, hole.reference]
                .map(|height| self.value(Self::round(height)));
            let feed = crate::precise(hole.feed);
            let dwell = number(hole.dwell, 6, false);
            let peck = if hole.way == Way::Drill {
                format!(" ~\n  Q202={} ~\n  Q210=+0", self.value(Self::round(hole.reference - hole.bottom)))
            } else {
                String::new()
            };
            self.line(&format!(
                "CYCL DEF {number_of} ~\n  Q200=+0 ~\n  Q201={depth} ~\n  Q206={feed}{peck} ~\n  Q203={surface} ~\n  Q204={above} ~\n  Q211={dwell}{out}"
            ));
            self.set_modal(*hole);
        }
        self.line("CYCL CALL");
        true
    }
}
