//! Codes that act in their own block: dwell, reference points, offsets, frames, macro calls.

use super::run::Iso;
use super::variables::Locals;
use super::words::Words;
use crate::Dialect;
use crate::error::Fault;
use crate::frame::Frame;
use crate::kernel::Kernel;
use crate::motion::AXES;

/// What a code of the block does once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Once {
    Nothing,
    Dwell,
    Home,
    Machine,
    Data,
    Set,
    Local,
    Rotate,
    Scale,
    Mirror(bool),
    Macro,
    /// A thread down and, with the spindle turning back, up again.
    RigidTap,
    Pattern(u32),
    /// A circular pocket, against the clock or not.
    Pocket(bool),
    TwoBlocks(u32),
    Spline(bool),
    TimeOnly(f64),
}

impl Iso {
    pub(super) fn once(&mut self, once: Once, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        match once {
            Once::Nothing | Once::Machine | Once::Spline(_) => Ok(()),
            Once::TimeOnly(seconds) => {
                words.spend(b"ABCDEFGHIJKLMNOPQRSTUVWXYZ");
                kernel.dwell(seconds)
            }
            Once::Dwell => {
                let time = self.dwell_time(words, kernel)?;
                kernel.dwell(time)
            }
            Once::Home => self.home(words, kernel),
            Once::Data => self.data(words, kernel),
            Once::Set => self.set(words, kernel),
            Once::Local => {
                for axis in 0..9 {
                    let letter = AXES[axis] as u8;
                    if let Some(value) = words.take(letter) {
                        let value = if (3..6).contains(&axis) { value } else { self.mm(kernel, words, letter, value)? };
                        self.modes.local[axis] = value;
                    }
                }
                kernel.frame = self.modes.frame(kernel.plane);
                Ok(())
            }
            Once::Rotate => {
                let angle = words.take(b'R').ok_or_else(|| Fault::new("G68 needs R, the angle in degrees"))?;
                let [u, v, _] = kernel.plane;
                let position = kernel.program_at();
                let mut centre = [position[u], position[v]];
                for (slot, axis) in centre.iter_mut().zip([u, v]) {
                    let letter = AXES[axis] as u8;
                    if let Some(value) = words.take(letter) {
                        *slot = self.mm(kernel, words, letter, value)?;
                    }
                }
                let before = self.modes.rotation.filter(|_| !kernel.absolute).map_or(0.0, |(angle, _)| angle);
                self.modes.rotation = Some((before + angle, centre));
                kernel.frame = self.modes.frame(kernel.plane);
                Ok(())
            }
            Once::Scale => {
                let position = kernel.program_at();
                let mut centre = [position[0], position[1], position[2]];
                for axis in 0..3 {
                    let letter = AXES[axis] as u8;
                    if let Some(value) = words.take(letter) {
                        centre[axis] = self.mm(kernel, words, letter, value)?;
                    }
                }
                // A factor without a point counts thousandths on Fanuc.
                let mut factor = |letter: u8| {
                    let thousandths = self.dialect == Dialect::Fanuc && !words.is_pointed(letter);
                    words.take(letter).map(|value| if thousandths { 1e-3 * value } else { value })
                };
                let factors = match factor(b'P') {
                    Some(factor) => [factor; 3],
                    None => [factor(b'I').unwrap_or(1.0), factor(b'J').unwrap_or(1.0), factor(b'K').unwrap_or(1.0)],
                };
                if factors.iter().any(|factor| factor.abs() < 1e-6 || factor.abs() > 1e6) {
                    return Err(Fault::new("G51 needs P, or I, J and K: factors that are not zero"));
                }
                self.modes.scaling = Some((factors, centre));
                kernel.frame = self.modes.frame(kernel.plane);
                Ok(())
            }
            Once::Mirror(on) => {
                for axis in 0..3 {
                    let letter = AXES[axis] as u8;
                    if let Some(value) = words.take(letter) {
                        self.modes.mirror[axis] = if on { Some(self.mm(kernel, words, letter, value)?) } else { None };
                    }
                }
                kernel.frame = self.modes.frame(kernel.plane);
                Ok(())
            }
            Once::Macro => self.macro_call(words, kernel),
            Once::RigidTap => self.rigid_tap(words, kernel),
            Once::Pocket(left) => self.pocket(left, words, kernel),
            Once::Pattern(code) => self.pattern(code, words, kernel),
            Once::TwoBlocks(code) => self.two_blocks(code, words, kernel),
        }
    }

    /// Dwell of G4, s: P in seconds on LinuxCNC; elsewhere in milliseconds without a point and in seconds with one; X
    /// and U in seconds, or in milliseconds without a point where such numbers count least increments.
    pub(super) fn dwell_time(&self, words: &mut Words, kernel: &Kernel) -> Result<f64, Fault> {
        let mut times = Vec::new();
        let seconds = |words: &mut Words, letter: u8| {
            let counts = kernel.control.least_increment && !words.is_pointed(letter);
            Some(words.take(letter)? * if counts { 1e-3 } else { 1.0 })
        };
        if let Some(value) = words.take(b'P') {
            let milliseconds = self.macros() && !words.is_pointed(b'P');
            times.push(if milliseconds { 1e-3 * value } else { value });
        }
        if self.dialect != Dialect::LinuxCnc {
            times.extend(seconds(words, b'X'));
        }
        if self.is_lathe() {
            times.extend(seconds(words, b'U'));
        }
        match times[..] {
            [time] => Ok(time),
            [] => Err(Fault::new("the length of the dwell is missing: write P (or X) behind G4")),
            _ => Err(Fault::new("the dwell has more than one length; leave one")),
        }
    }

    pub(super) fn home(&mut self, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let target = self.target(words, kernel)?;
        words.spend(b"P");
        let axes: Vec<usize> = if target.is_empty() {
            if matches!(self.dialect, Dialect::LinuxCnc | Dialect::Haas) { (0..3).collect() } else { Vec::new() }
        } else {
            (0..9).filter(|axis| target.names(*axis)).collect()
        };
        if axes.is_empty() {
            kernel.note("a return to the reference point without axes moves nothing");
            return Ok(());
        }
        if !target.is_empty() {
            kernel.straight(&target, true)?;
        }
        kernel.machine_motion(&axes)
    }

    /// G92 or G50 of a lathe: the place where the tool stands gets these coordinates.
    pub(super) fn set(&mut self, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        if self.is_lathe()
            && let Some(speed) = words.take(b'S')
        {
            kernel.clamp = speed;
            if speed <= 0.0 {
                return Err(Fault::at(words.column(b'S'), "the greatest speed must be above 0"));
            }
            if !words.any(b"XZUW") {
                return Ok(());
            }
        }
        if self.modes.turn() != 0.0 {
            return Err(Fault::new(
                "G92 within a turned work offset (G10 L2 R) is not followed; write the offset itself",
            )
            .refusing());
        }
        let target = self.target(words, kernel)?;
        let position = kernel.program_at();
        for axis in 0..9 {
            let wanted = target.absolute[axis].or(target.step[axis]);
            let Some(wanted) = wanted else { continue };
            if kernel.referenced[axis] {
                let mut span = [0.0; 9];
                span[axis] = position[axis] - wanted;
                let linear = Frame { shift: [0.0; 9], ..kernel.frame };
                for (slot, part) in self.modes.set.iter_mut().zip(linear.base(span)) {
                    *slot += part;
                }
            } else {
                kernel.at[axis] = wanted + kernel.frame.shift[axis];
                kernel.referenced[axis] = true;
            }
        }
        kernel.frame = self.modes.frame(kernel.plane);
        Ok(())
    }

    /// Offsets by program: G10 L2 and L20; what they shift is known from the second time on.
    pub(super) fn data(&mut self, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let kind = words.whole(b'L', 0.0, 9999.0)?;
        let system = words.whole(b'P', 0.0, 9999.0)?.unwrap_or(0);
        let system = if system == 0 { self.modes.system } else { system };
        match kind {
            Some(2 | 20) => {}
            Some(1 | 10..=13) if self.dialect != Dialect::FanucLathe => {
                words.spend(b"PRXYZIJQDH");
                kernel.note("G10 changes the table of tools, which the programmed path does not contain");
                return Ok(());
            }
            _ => {
                return Err(Fault::new(
                    "G10 is followed with L2, L20 and the lengths L10 to L13 only; other data of the control are not known",
                ));
            }
        }
        if words.has(b'R') && kind == Some(2) {
            let angle = words.take(b'R').unwrap_or(0.0);
            if angle != 0.0 {
                if self.dialect != Dialect::LinuxCnc {
                    return Err(Fault::at(words.column(b'R'), "a turned work offset (G10 L2 R) is one of LinuxCNC"));
                }
                if self.modes.set != [0.0; 9] {
                    let message = "a work offset is turned (G10 L2 R) while G92 shifts it, which is not followed; write G92.1 before";
                    return Err(Fault::at(words.column(b'R'), message));
                }
            }
            self.modes.turns.insert(system, angle);
            if system == self.modes.system {
                kernel.frame = self.modes.frame(kernel.plane);
            }
        }
        if kind == Some(20) && self.modes.turn() != 0.0 {
            return Err(Fault::new("G10 L20 within a turned work offset is not followed; write L2").refusing());
        }
        let position = kernel.program_at();
        let table = self.modes.offset(system, &kernel.control);
        self.modes.offsets.entry(system).or_insert(table);
        for axis in 0..9 {
            let letter = AXES[axis] as u8;
            let Some(value) = words.take(letter) else { continue };
            let value = if (3..6).contains(&axis) { value } else { self.mm(kernel, words, letter, value)? };
            let before = self.modes.offsets.entry(system).or_default()[axis];
            let active = system == self.modes.system;
            if kind == Some(20) {
                if active {
                    if kernel.referenced[axis] {
                        self.modes.work[axis] += position[axis] - value;
                    } else {
                        kernel.at[axis] = value + kernel.frame.shift[axis];
                        kernel.referenced[axis] = true;
                    }
                }
                self.modes.offsets.entry(system).or_default()[axis] = None;
                continue;
            }
            let stepped = !kernel.absolute && self.macros();
            let now = if stepped { before.map(|before| before + value) } else { Some(value) };
            self.modes.offsets.entry(system).or_default()[axis] = now;
            if active {
                match (before, now) {
                    (Some(before), Some(now)) => self.modes.work[axis] += now - before,
                    _ if stepped => self.modes.work[axis] += value,
                    _ => kernel.forget(std::iter::once(axis)),
                }
            }
        }
        kernel.frame = self.modes.frame(kernel.plane);
        Ok(())
    }

    /// Another work offset: its axes are where only the machine knows, but for those that the program has set.
    pub(super) fn system(&mut self, system: u32, kernel: &mut Kernel) {
        if system == self.modes.system {
            kernel.work_offset_again();
            return;
        }
        let offset_of = |system: u32| self.modes.offset(system, &kernel.control);
        let (first, before, now) = (offset_of(1), offset_of(self.modes.system), offset_of(system));
        for axis in 0..9 {
            match (before[axis], now[axis]) {
                (Some(before), Some(now)) => self.modes.work[axis] += now - before,
                _ if axis < 3 || kernel.referenced[axis] => {
                    kernel.forget(std::iter::once(axis));
                    self.modes.work[axis] = first[axis].zip(now[axis]).map_or(0.0, |(first, now)| now - first);
                }
                _ => {}
            }
        }
        let known: [bool; 3] =
            std::array::from_fn(|axis| system == 1 || (first[axis].is_some() && now[axis].is_some()));
        // Where it is known how the two lie to each other, but not how they lie to the first, places go on counting in the one before.
        let related = (0..3).all(|axis| before[axis].is_some() && now[axis].is_some());
        if !related || known == [true; 3] {
            kernel.work_offset(system - 1, known);
        }
        self.modes.system = system;
        kernel.frame = self.modes.frame(kernel.plane);
    }

    pub(super) fn macro_call(&mut self, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let modal = words.g.iter().any(|(code, _)| *code == 660);
        let number =
            words.whole(b'P', 0.0, 99_999.0)?.ok_or_else(|| Fault::new("a macro call needs P, its program"))?;
        let count = words.whole(b'L', 0.0, 99_999_999.0)?.unwrap_or(1);
        let mut locals = Locals::default();
        const LETTERS: &[u8] = b"ABCDEFHIJKMQRSTUVWXYZ";
        const NUMBERS: [usize; 21] = [1, 2, 3, 7, 8, 9, 11, 4, 5, 6, 13, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26];
        // I, J and K again and again are the second way of passing values: #4 #5 #6, #7 #8 #9 and on.
        let mut set = 0;
        let mut last = 0_u8;
        for (letter, value) in &words.repeats {
            if *letter <= last {
                set += 1;
            }
            last = *letter;
            let index = 4 + 3 * set + usize::from(letter - b'I');
            if index > 33 {
                return Err(Fault::new("a macro call passes at most ten sets of I, J and K"));
            }
            locals.numbered[index] = Some(*value);
        }
        for (letter, index) in LETTERS.iter().copied().zip(NUMBERS) {
            let value = words.take(letter);
            if !matches!(letter, b'I' | b'J' | b'K') && value.is_some() {
                locals.numbered[index] = value;
            }
        }
        if let Some((code, column)) = words.m.first() {
            return Err(Fault::at(*column, format!("M{code} cannot be passed to a macro")));
        }
        let start = self.program(number).map_err(|fault| fault.or_at(words.column(b'P')))?;
        if modal {
            self.modal_macro = Some((start, locals));
            return Ok(());
        }
        let line = kernel.line;
        self.call(start, count, Some(locals), line, false)
    }
}
