//! What the words of a block do.

use super::codes::{CodeKind, written};
use super::modes::Move;
use super::once::Once;
use super::run::Iso;
use super::words::{ANGLE, DISTANCE, Words};
use crate::Dialect;
use crate::error::Fault;
use crate::kernel::{FeedMode, Kernel, Target};
use crate::motion::{AXES, EventKind, Sense};
use crate::run::Flow;

impl Iso {
    pub(super) fn macros(&self) -> bool {
        self.dialect.has_macros()
    }

    pub(super) fn is_lathe(&self) -> bool {
        self.dialect == Dialect::FanucLathe
    }

    /// A length of the block in mm.
    pub(super) fn mm(&self, kernel: &Kernel, words: &Words, letter: u8, value: f64) -> Result<f64, Fault> {
        let least = kernel.control.least_increment && !words.is_pointed(letter);
        let column = words.column(letter);
        if least {
            let unit = kernel.unit().map_err(|fault| fault.or_at(column))?;
            return Ok(value * if unit > 1.0 { 1e-4 * unit } else { 1e-3 });
        }
        kernel.length(value).map_err(|fault| fault.or_at(column))
    }

    pub(super) fn angle(&self, kernel: &Kernel, words: &Words, letter: u8, value: f64) -> f64 {
        if kernel.control.least_increment && !words.is_pointed(letter) { 1e-3 * value } else { value }
    }

    /// Axes of the block.
    pub(super) fn target(&mut self, words: &mut Words, kernel: &Kernel) -> Result<Target, Fault> {
        let mut target = Target::default();
        for (index, letter) in AXES.iter().enumerate() {
            let letter = *letter as u8;
            if self.is_lathe() && index >= 6 {
                continue;
            }
            let Some(value) = words.take(letter) else { continue };
            let value = if (3..6).contains(&index) {
                self.angle(kernel, words, letter, value)
            } else {
                self.mm(kernel, words, letter, value)?
            };
            let value = if self.is_lathe() && index == 0 { 0.5 * value } else { value };
            if kernel.absolute { target.absolute[index] = Some(value) } else { target.step[index] = Some(value) }
        }
        if self.is_lathe() {
            for (letter, index) in [(b'U', 0), (b'W', 2), (b'V', 1)] {
                let Some(value) = words.take(letter) else { continue };
                if target.names(index) {
                    return Err(Fault::at(words.column(letter), "an axis is given twice, absolute and by a step"));
                }
                let value = self.mm(kernel, words, letter, value)?;
                target.step[index] = Some(if index == 0 { 0.5 * value } else { value });
            }
            // H turns the spindle axis C by steps.
            if let Some(value) = words.take(b'H') {
                if target.names(5) {
                    return Err(Fault::at(words.column(b'H'), "C is given twice, absolute and by a step"));
                }
                target.step[5] = Some(self.angle(kernel, words, b'H', value));
            }
        }
        self.by_angle(&mut target, words, kernel)?;
        self.polar(&mut target, kernel)?;
        Ok(target)
    }

    pub(super) fn execute(&mut self, words: &mut Words, kernel: &mut Kernel) -> Result<Flow, Fault> {
        kernel.moved = false;
        kernel.vacant_feed = words
            .vacant
            .iter()
            .find(|(letter, _)| *letter == b'F')
            .map(|(_, variable)| format!("no feed: {variable} is vacant, so the word F is ignored"));
        words.spend(b"NO");
        let (mut once, mut moves, mut stop_here, mut after) = (Once::Nothing, 0, false, Vec::new());
        let codes = std::mem::take(&mut words.g);
        // The unit and the kind of coordinates hold for the whole block, wherever their codes stand in it.
        for (code, column) in &codes {
            let found = self.modal(*code, words, kernel).map_err(|fault| fault.or_at(*column))?;
            match found {
                CodeKind::Modal => {}
                CodeKind::Motion(motion) => {
                    moves += 1;
                    if motion != Move::Cycle {
                        self.cycle = None;
                    }
                    if motion != Move::Drilling {
                        self.drilling = None;
                    }
                    self.modes.motion = motion;
                }
                CodeKind::Once(own) => {
                    if once != Once::Nothing {
                        let message = format!("G{} cannot stand in a block with the code before it", written(*code));
                        return Err(Fault::at(*column, message));
                    }
                    once = own;
                }
                CodeKind::ExactStop => stop_here = true,
            }
            if moves > 1 {
                return Err(Fault::at(*column, "two motions stand in one block; give each a block of its own"));
            }
        }
        let first = codes.first().map_or(0, |(_, column)| *column);
        words.g = codes;
        self.values(words, kernel, once)?;
        let flow = self.auxiliary(words, kernel, &mut after)?;
        self.once(once, words, kernel).map_err(|fault| fault.or_at(first))?;
        if matches!(once, Once::Nothing | Once::Machine | Once::Spline(_)) {
            self.motion(once, words, kernel)?;
        }
        if let Some((letter, value, column)) = words.rest() {
            let message = format!(
                "{letter}{value} has no meaning for {} in this block; it might move axes or take time: mend the block",
                self.dialect.name()
            );
            return Err(Fault::at(column, message));
        }
        if kernel.moved && (stop_here || kernel.exact) {
            kernel.push(EventKind::ExactStop);
        }
        let line = kernel.line;
        for (code, column) in after {
            if self.after(code, words, kernel).map_err(|fault| fault.or_at(column))? == Flow::Ended {
                kernel.end()?;
                return Ok(Flow::Ended);
            }
        }
        if kernel.moved && once == Once::Nothing {
            self.modal_call(line)?;
        }
        Ok(flow)
    }

    /// F, S, T, D and H.
    fn values(&mut self, words: &mut Words, kernel: &mut Kernel, once: Once) -> Result<(), Fault> {
        if matches!(once, Once::Macro) || (once == Once::Dwell && self.macros() && words.any(b"FS")) {
            if once == Once::Dwell {
                return Err(Fault::at(
                    words.column(b'F').max(words.column(b'S')),
                    "F and S of G4 are a time and turns of a Siemens control; write P or X here",
                ));
            }
            return Ok(());
        }
        if kernel.feed_mode == FeedMode::Inverse && !words.has(b'F') {
            // G93 asks for F in every block with a motion at feed.
            kernel.feed = None;
        }
        if let Some(value) = words.take(b'F') {
            let scale = match kernel.feed_mode {
                FeedMode::Inverse => 1.0,
                FeedMode::Minute | FeedMode::Revolution if value == 0.0 => kernel.scale.unwrap_or(1.0),
                FeedMode::Minute | FeedMode::Revolution => {
                    kernel.unit().map_err(|fault| fault.or_at(words.column(b'F')))?
                }
            };
            kernel.set_feed(value, scale).map_err(|fault| fault.or_at(words.column(b'F')))?;
        }
        if !words.any(b"S") || matches!(once, Once::Set) && self.is_lathe() {
            // S of G50 is the greatest speed.
        } else if let Some(value) = words.take(b'S') {
            let column = words.column(b'S');
            if kernel.surface.is_some() {
                kernel.surface = Some(value * if kernel.scale.unwrap_or(1.0) > 1.0 { 304.8 } else { 1000.0 });
            } else {
                kernel.set_speed(value).map_err(|fault| fault.or_at(column))?;
            }
        }
        if !matches!(once, Once::Data) {
            words.spend(b"D");
            if !self.is_lathe() {
                // Another length of the tool shifts its axis by what the machine knows; the programmed path stays the same.
                words.whole(b'H', 0.0, 9999.0)?;
            }
        }
        Ok(())
    }

    fn auxiliary(
        &mut self,
        words: &mut Words,
        kernel: &mut Kernel,
        after: &mut Vec<(u32, usize)>,
    ) -> Result<Flow, Fault> {
        let codes = std::mem::take(&mut words.m);
        let macros = self.macros();
        if let Some(value) = words.take(b'T') {
            if !(0.0..=1e8).contains(&value) || value.fract() != 0.0 {
                return Err(Fault::at(words.column(b'T'), format!("T{value} is no tool number")));
            }
            let number = value as u32;
            if self.is_lathe() {
                // Two digits of the turret's place and two of its offset.
                let tool = if number > 99 { number / 100 } else { number };
                if number > 0 && kernel.tool != Some(tool) {
                    kernel.change_tool(Some(tool));
                }
            } else {
                self.modes.next_tool = Some(number);
            }
        }
        for (code, column) in &codes {
            match code {
                3 | 4 => {
                    let sense = if *code == 3 { Sense::Clockwise } else { Sense::Counterclockwise };
                    if kernel.speed == 0.0 && kernel.surface.is_none() {
                        kernel.note("the spindle is switched on without a speed");
                    }
                    kernel.spindle(sense);
                }
                6 => {
                    let number = self.modes.next_tool.or(kernel.tool);
                    if number.is_none() {
                        kernel.note("a tool change without T");
                    }
                    kernel.change_tool(number);
                }
                7 | 8 | 88 if *code != 88 || self.dialect == Dialect::Haas => kernel.push(EventKind::Coolant(true)),
                61 if self.dialect == Dialect::LinuxCnc => {
                    let number = words.whole(b'Q', 0.0, 99_999.0)?;
                    kernel.tool = number.or(kernel.tool);
                }
                // Switches of overrides move nothing and take no time.
                48..=53 if self.dialect == Dialect::LinuxCnc => words.spend(b"P"),
                48 | 49 if macros => {}
                66 if self.dialect == Dialect::LinuxCnc => {
                    return Err(Fault::at(*column, "M66 waits for an input, which a program alone does not know"));
                }
                62..=65 | 67 | 68 if self.dialect == Dialect::LinuxCnc => words.spend(b"PEQ"),
                70..=73 if self.dialect == Dialect::LinuxCnc => {
                    return Err(Fault::at(
                        *column,
                        format!("M{code} stores or restores modes; write the codes themselves"),
                    ));
                }
                19 => {
                    words.spend(b"RPQ");
                    kernel.spindle(Sense::Oriented);
                }
                // Rigid tapping is a mode of the next cycle; it comes with the speed.
                29 if self.dialect == Dialect::Fanuc && !kernel.control.m.contains_key(&29) => {}
                97..=99 if macros => after.push((*code, *column)),
                98 | 99 if self.dialect == Dialect::LinuxCnc => after.push((*code, *column)),
                0 | 1 | 2 | 5 | 9 | 30 | 60 => after.push((*code, *column)),
                89 if self.dialect == Dialect::Haas => kernel.push(EventKind::Coolant(false)),
                _ => kernel.auxiliary(*code),
            }
        }
        if after.iter().any(|(code, _)| matches!(code, 97 | 98)) {
            words.spend(b"PLQ");
        }
        if after.iter().any(|(code, _)| *code == 99) {
            words.spend(b"PL");
        }
        words.m = codes;
        Ok(Flow::Going)
    }

    /// Functions that act behind the motion of their block.
    fn after(&mut self, code: u32, words: &mut Words, kernel: &mut Kernel) -> Result<Flow, Fault> {
        match code {
            0 | 60 => kernel.push(EventKind::Stop(false)),
            1 => kernel.push(EventKind::Stop(true)),
            5 => kernel.spindle(Sense::Still),
            9 => kernel.push(EventKind::Coolant(false)),
            2 | 30 => {
                kernel.push(EventKind::Auxiliary(code, 0.0));
                return Ok(Flow::Ended);
            }
            97 | 98 => {
                let column = words.column(b'P');
                let number = words
                    .see(b'P')
                    .ok_or_else(|| Fault::new(format!("M{code} needs P, the number of the subprogram")))?;
                if !(0.0..=99_999_999.0).contains(&number) || number.fract() != 0.0 {
                    return Err(Fault::at(column, format!("P{number}: no such program")));
                }
                if words.has(b'Q') {
                    return Err(Fault::at(
                        words.column(b'Q'),
                        "a call that begins at block Q is not followed; call a program of its own",
                    )
                    .refusing());
                }
                let (mut number, mut count) = (number as u32, words.whole(b'L', 0.0, 99_999_999.0)?);
                // Four digits of the number behind those of the count, where no L stands.
                if self.dialect != Dialect::Haas && number > 9999 {
                    if count.is_some() {
                        return Err(Fault::at(column, "the count stands twice, in P and in L"));
                    }
                    (count, number) = (Some(number / 10_000), number % 10_000);
                }
                let line = kernel.line;
                let start = if code == 97 {
                    self.block_number(number, self.pc - 1).map_err(|_| {
                        Fault::at(column, format!("P{number}: there is no block N{number} in this program"))
                    })?
                } else {
                    self.program(number).map_err(|fault| fault.or_at(column))?
                };
                self.call(start, count.unwrap_or(1), None, line, false)?;
            }
            99 => {
                let to = words.whole(b'P', 0.0, 99_999_999.0)?;
                if words.has(b'L') {
                    return Err(Fault::at(words.column(b'L'), "L of M99 is not followed; leave it out").refusing());
                }
                if !self.back(to)? {
                    if self.calls.is_empty() && to.is_some() {
                        kernel.note("M99 P in the main program begins again at its block; one turn is counted");
                    } else {
                        kernel.note("M99 ends the main program and begins it again; one turn is counted");
                    }
                    return Ok(Flow::Ended);
                }
            }
            _ => {}
        }
        Ok(Flow::Going)
    }

    fn motion(&mut self, once: Once, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let place = |words: &Words| {
            AXES.iter()
                .map(|letter| *letter as u8)
                .find(|letter| words.has(*letter))
                .map_or(0, |letter| words.column(letter))
        };
        let column = place(words);
        if let Once::Spline(cubic) = once {
            return self.spline(cubic, words, kernel).map_err(|fault| fault.or_at(column));
        }
        if once == Once::Machine {
            let axes: Vec<usize> =
                AXES.iter().enumerate().filter(|(_, l)| words.has(**l as u8)).map(|(i, _)| i).collect();
            words.spend(b"XYZABCUVW");
            return kernel.machine_motion(&axes);
        }
        let turns = self.is_lathe() && words.has(b'H');
        let has_axis = turns || words.any(b"XYZABCUVW") || words.any(&[DISTANCE, ANGLE]);
        match self.modes.motion {
            Move::Cycle => self.canned(words, kernel).map_err(|fault| fault.or_at(column)),
            Move::Drilling => self.drill(words, kernel).map_err(|fault| fault.or_at(column)),
            Move::Lathe(code) => self.turning_cycle(code, words, kernel).map_err(|fault| fault.or_at(column)),
            Move::Open if has_axis => Err(Fault::at(
                column,
                "no motion is chosen: write G0, G1, G2 or G3 before the first coordinates and behind a cycle",
            )),
            Move::Open => Ok(()),
            Move::Rapid | Move::Line | Move::Thread => {
                if self.modes.motion == Move::Line {
                    self.joint(words, kernel)?;
                }
                let target = self.target(words, kernel)?;
                if target.is_empty() {
                    return kernel.spent_joint();
                }
                if self.modes.motion == Move::Thread {
                    return self.thread(&target, words, kernel).map_err(|fault| fault.or_at(column));
                }
                let rapid = self.modes.motion == Move::Rapid;
                kernel.straight(&target, rapid).map_err(|fault| fault.or_at(column))
            }
            Move::Arc { left } => {
                let centred = words.any(if self.is_lathe() { b"IKR" } else { b"IJKR" });
                if !has_axis && !centred {
                    return Ok(());
                }
                self.arc(left, words, kernel).map_err(|fault| fault.or_at(column))
            }
        }
    }
}
