//! Canned cycles G73 to G89 and the hole patterns of Haas.
//!
//! # Source
//! Sequences of motions as the manuals of Fanuc, Haas and LinuxCNC describe them, cited from memory (assumption).

use super::run::Iso;
use super::words::Words;
use crate::Dialect;
use crate::error::Fault;
use crate::hole::{Clearance, Exit, Hole, Pecks, stops};
use crate::kernel::{Kernel, Target};
use crate::motion::AXES;

/// A cycle with the words that hold until it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cycle {
    code: u32,
    /// Level of the tool before the cycle, program coordinates in mm.
    initial: f64,
    /// Values as written, mm, with whether they are steps.
    bottom: Option<(f64, bool)>,
    reference: Option<(f64, bool)>,
    peck: Option<f64>,
    first: Option<f64>,
    decrement: f64,
    least: f64,
    dwell: f64,
    shift: [f64; 2],
    /// Feed out of a thread over the feed into it.
    back: f64,
}

/// Greatest number of repeats of a hole: a bound against programs without end (assumption).
const REPEATS: f64 = 1e5;

impl Iso {
    pub(super) fn begin_cycle(&mut self, code: u32, kernel: &Kernel) -> Result<(), Fault> {
        if self.dialect == Dialect::LinuxCnc && matches!(code, 76 | 87) {
            let what = if code == 76 { "a threading cycle of lathes" } else { "not implemented by the control" };
            return Err(Fault::new(format!("G{code} is {what} on LinuxCNC, and is not followed")).refusing());
        }
        let initial = self.cycle.map_or(kernel.program_at()[kernel.plane[2]], |cycle| cycle.initial);
        let before = self.cycle;
        // Depth and plane go on from cycle to cycle until G80 or a motion code.
        let kept = before;
        self.cycle = Some(Cycle {
            code,
            initial,
            bottom: kept.and_then(|cycle| cycle.bottom),
            reference: kept.and_then(|cycle| cycle.reference),
            peck: None,
            first: None,
            decrement: 0.0,
            least: 0.0,
            dwell: 0.0,
            shift: [0.0; 2],
            back: 1.0,
        });
        Ok(())
    }

    /// A block while a cycle is in force: takes its words, and bores where the block names a place.
    pub(super) fn canned(&mut self, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let Some(mut cycle) = self.cycle else {
            return Err(Fault::new("no cycle is in force; write its code with Z and R again"));
        };
        let [u, v, _] = kernel.plane;
        // Rotary axes turn to the next hole as the plane's axes move; LinuxCNC refuses them in a cycle.
        let turns = self.macros() && words.any(b"ABC");
        let bores = words.any(b"XYZR") || turns;
        let stepped = !kernel.absolute;
        let take = |own: &Self, words: &mut Words, letter: u8| -> Result<Option<f64>, Fault> {
            words.take(letter).map(|value| own.mm(kernel, words, letter, value)).transpose()
        };
        self.cycle_words(&mut cycle, words, kernel)?;
        let shifts = matches!(cycle.code, 76 | 87);
        if matches!(cycle.code, 73 | 83) && self.dialect == Dialect::Haas {
            // I, J and K of Haas: first depth, decrement and least depth of the pecks.
            let (first, decrement, least) =
                (take(self, words, b'I')?, take(self, words, b'J')?, take(self, words, b'K')?);
            cycle.first = first.or(cycle.first);
            cycle.decrement = decrement.unwrap_or(cycle.decrement);
            cycle.least = least.unwrap_or(cycle.least);
        } else if shifts {
            if let Some(value) = take(self, words, b'I')? {
                cycle.shift[0] = value;
            }
            if let Some(value) = take(self, words, b'J')? {
                cycle.shift[1] = value;
            }
        }
        if matches!(cycle.code, 74 | 84)
            && self.dialect == Dialect::Haas
            && let Some(value) = words.take(b'J')
        {
            if !(0.1..=10.0).contains(&value) {
                return Err(Fault::at(
                    words.column(b'J'),
                    "J of a tapping cycle is a multiple of its speed; write 1 to 9",
                ));
            }
            cycle.back = value;
        }
        if self.dialect == Dialect::Haas {
            words.spend(b"E");
        }
        self.cycle = Some(cycle);
        let letter = if self.dialect == Dialect::Fanuc { b'K' } else { b'L' };
        let count = words.whole(letter, 0.0, REPEATS)?.unwrap_or(1);
        if self.dialect == Dialect::Fanuc && words.has(b'L') {
            return Err(Fault::at(
                words.column(b'L'),
                "holes are repeated by K on Fanuc, by L on Haas and LinuxCNC; name the control with --dialect",
            ));
        }
        let mut target = Target::default();
        for axis in [u, v] {
            let letter = AXES[axis] as u8;
            if let Some(value) = take(self, words, letter)? {
                if stepped { target.step[axis] = Some(value) } else { target.absolute[axis] = Some(value) }
            }
        }
        for axis in (3..6).filter(|_| turns) {
            let letter = AXES[axis] as u8;
            if let Some(value) = words.take(letter) {
                let value = self.angle(kernel, words, letter, value);
                if stepped { target.step[axis] = Some(value) } else { target.absolute[axis] = Some(value) }
            }
        }
        if !bores || count == 0 {
            return Ok(());
        }
        for _ in 0..count {
            // Polar steps go on from hole to hole.
            let mut place = target;
            self.polar(&mut place, kernel)?;
            self.hole_at(&place, cycle, kernel)?;
        }
        Ok(())
    }

    /// Depth, plane R, peck and dwell of a cycle, where the block has them.
    fn cycle_words(&self, cycle: &mut Cycle, words: &mut Words, kernel: &Kernel) -> Result<(), Fault> {
        let stepped = !kernel.absolute;
        let mut take = |letter: u8| -> Result<Option<f64>, Fault> {
            words.take(letter).map(|value| self.mm(kernel, words, letter, value)).transpose()
        };
        if let Some(value) = take(AXES[kernel.plane[2]] as u8)? {
            cycle.bottom = Some((value, stepped));
        }
        if let Some(value) = take(b'R')? {
            cycle.reference = Some((value, stepped));
        }
        if let Some(value) = take(b'Q')? {
            cycle.peck = Some(value.abs());
        }
        if let Some(value) = words.take(b'P') {
            let milliseconds = self.dialect != Dialect::LinuxCnc && !words.is_pointed(b'P');
            cycle.dwell = if milliseconds { 1e-3 * value } else { value };
        }
        Ok(())
    }

    /// A hole of the cycle at a place of the plane.
    fn hole_at(&mut self, target: &Target, cycle: Cycle, kernel: &mut Kernel) -> Result<(), Fault> {
        let w = kernel.plane[2];
        let (Some(bottom), reference) = (cycle.bottom, cycle.reference) else {
            return Err(Fault::new(format!(
                "the depth of G{} is missing: write Z (or the axis across the plane)",
                cycle.code
            )));
        };
        let linuxcnc = self.dialect == Dialect::LinuxCnc;
        let initial = cycle.initial;
        let reference = match reference {
            Some((value, true)) => initial + value,
            Some((value, false)) => value,
            None if linuxcnc => return Err(Fault::new("the reference plane R of the cycle is missing")),
            None => initial,
        };
        let bottom = match bottom {
            (value, true) => reference + value,
            (value, false) => value,
        };
        if linuxcnc && bottom > reference {
            return Err(Fault::new("the depth of the cycle lies above its plane R"));
        }
        // LinuxCNC rises to the plane R first where the tool stands below it.
        if linuxcnc && kernel.program_at()[w] < reference {
            kernel.straight(&Target::one(w, reference), true)?;
        }
        let level = if self.modes.initial_return { initial } else { reference };
        let level = if linuxcnc { level.max(reference) } else { level };
        kernel.straight(target, true)?;
        let clearance = kernel.control.clearance(self.dialect);
        let pecks = |retract: Option<f64>| -> Result<Option<Pecks>, Fault> {
            let depth = cycle.first.or(cycle.peck).unwrap_or(0.0);
            if depth <= 0.0 {
                return Err(Fault::new(format!("the depth of a peck is missing: G{} needs Q above zero", cycle.code)));
            }
            let least = if cycle.least > 0.0 { cycle.least } else { depth };
            let decrement = if cycle.first.is_some() { cycle.decrement } else { 0.0 };
            let least = if decrement > 0.0 { least.min(depth) } else { depth };
            if decrement > 0.0 && cycle.least <= 0.0 {
                return Err(Fault::new("the least depth of a peck (K) is missing beside the decrement J"));
            }
            let stops = stops((bottom - reference).abs(), depth, decrement, least)?;
            Ok(Some(Pecks::new(stops, retract, Clearance::Fixed(clearance))))
        };
        let shift = if cycle.shift == [0.0; 2] { [cycle.peck.unwrap_or(0.0), 0.0] } else { cycle.shift };
        let plain = Hole { reference, bottom, level, pecks: None, dwell: 0.0, exit: Exit::Rapid, feed: None };
        let dwell = cycle.dwell;
        // Out of G89 LinuxCNC feeds up to where the cycle ends, others to the plane R (its interpreter rs274 shows it).
        let fed = if linuxcnc { Exit::FeedAllTheWay } else { Exit::Feed };
        let taps = || if cycle.peck.is_some() { pecks(None) } else { Ok(None) };
        let hole = match cycle.code {
            73 => Hole { pecks: pecks(Some(clearance))?, dwell, ..plain },
            81 => plain,
            82 => Hole { dwell, ..plain },
            83 => Hole { pecks: pecks(None)?, dwell, ..plain },
            74 | 84 => {
                let feed = kernel.feed.filter(|_| cycle.back != 1.0);
                let exit = feed.map_or(Exit::Tap, |feed| Exit::TapAt(cycle.back * feed));
                Hole { pecks: taps()?, dwell, exit, ..plain }
            }
            85 => Hole { exit: Exit::Feed, ..plain },
            86 => Hole { dwell, exit: Exit::Stopped, ..plain },
            88 => Hole { dwell, exit: Exit::Operator, ..plain },
            89 => Hole { dwell, exit: fed, ..plain },
            76 => Hole { dwell, exit: Exit::Shifted(shift), ..plain },
            87 => return kernel.back_bore(reference, bottom, initial, shift, dwell),
            code => return Err(Fault::new(format!("G{code} is no cycle that is followed"))),
        };
        kernel.hole(&hole)
    }

    /// Hole patterns of Haas: a circle (G70), an arc (G71), a line (G72).
    pub(super) fn pattern(&mut self, code: u32, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let Some(cycle) = self.cycle else {
            return Err(Fault::new(format!("G{code} repeats the holes of a cycle, but none is in force")));
        };
        // A cycle that begins in the same block takes its own words; I, J, K and L are those of the pattern.
        let mut cycle = cycle;
        self.cycle_words(&mut cycle, words, kernel)?;
        self.cycle = Some(cycle);
        words.remove(AXES[kernel.plane[2]] as u8);
        let centre = self.target(words, kernel)?;
        if !centre.is_empty() {
            kernel.straight(&centre, true)?;
        }
        let position = kernel.program_at();
        let size =
            words.take(b'I').ok_or_else(|| Fault::new(format!("G{code} needs I, the radius or the distance")))?;
        let size = self.mm(kernel, words, b'I', size)?;
        let start = words.take(b'J').unwrap_or(0.0);
        let count = words
            .whole(b'L', 1.0, REPEATS)?
            .ok_or_else(|| Fault::new(format!("G{code} needs L, the number of holes")))?;
        let step = if code == 71 { words.take(b'K').unwrap_or(0.0) } else { 360.0 / f64::from(count) };
        for index in 0..count {
            let (angle, reach) = match code {
                72 => (start, size * f64::from(index)),
                _ => (start + step * f64::from(index), size),
            };
            let (sin, cos) = crate::frame::turn(angle);
            let mut target = Target::default();
            (target.absolute[0], target.absolute[1]) =
                (Some(position[0] + reach * cos), Some(position[1] + reach * sin));
            self.hole_at(&target, cycle, kernel)?;
        }
        Ok(())
    }
}
