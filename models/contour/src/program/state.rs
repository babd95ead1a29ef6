//! Modal state of a controller.

use super::codes::{auxiliary, refusal, unsupported};
use super::cycle::Cycle;
use super::dialect::Dialect;
use super::motion::{Motion, Vector, center_by_radius};
use super::words::Words;
use super::{Block, ProgramFault, Units};

/// What a block leaves behind, beside the state.
#[derive(Default)]
pub(super) struct Read {
    pub block: Block,
    /// The program ends here.
    pub end: bool,
    /// Some axis came from an unknown place.
    pub unknown: bool,
}

/// What moves the axes until another code says otherwise.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mode {
    /// Which of them differs by control: at the start, and behind a cycle that followed a motion at feed.
    Open,
    Rapid,
    Line,
    Arc {
        left: bool,
    },
    Cycle(Cycle),
}

/// Modal state; an unknown coordinate is NaN.
#[derive(Clone, Debug)]
pub(super) struct State {
    dialect: Dialect,
    /// Whether the program has a canned cycle anywhere.
    has_cycle: bool,
    at: Vector,
    units: Option<Units>,
    absolute: bool,
    plane: [usize; 3],
    mode: Mode,
    /// The motion that was in force before a cycle.
    before_cycle: Mode,
    feed: f64,
    per_revolution: bool,
    spindle_speed: f64,
    exact: bool,
    /// Whether holes are left at the level from which the cycle began.
    initial_level: bool,
    selected: Option<u32>,
    tool: Option<u32>,
    /// Work offset by code and P.
    frame: (u32, f64),
    /// Compensation of the tool's length by code and register.
    length: (u32, f64),
    /// Whether anything but numbers and comments was read.
    begun: bool,
}

/// A fault, and where the block's start does not tell it well enough.
pub(super) type Fault = (Option<usize>, ProgramFault);

/// What the G codes of one block ask for once.
#[derive(Default)]
struct Once {
    dwell: bool,
    reference: bool,
    machine_frame: bool,
    /// The origin is set or shifted.
    shift: bool,
    exact: bool,
    /// A code of motion stands in the block.
    moved: bool,
    /// Letters that its codes understand beside those of its motion.
    letters: String,
    /// Codes that stand without axes.
    alone: bool,
}

impl State {
    pub(super) fn new(dialect: Dialect, units: Option<Units>, has_cycle: bool) -> Self {
        Self {
            dialect,
            has_cycle,
            at: [f64::NAN; 3],
            units,
            absolute: true,
            plane: [0, 1, 2],
            mode: Mode::Open,
            before_cycle: Mode::Open,
            feed: 0.0,
            per_revolution: false,
            spindle_speed: 0.0,
            exact: false,
            initial_level: true,
            selected: None,
            tool: None,
            frame: (540, 0.0),
            length: (490, 0.0),
            begun: false,
        }
    }

    /// The block that `words` ask for.
    pub(super) fn block(&mut self, words: &Words) -> Result<Read, Fault> {
        let mut once = Once::default();
        for (code, place) in &words.general {
            self.general(*code, words, &mut once).map_err(|fault| (Some(*place), fault))?;
        }
        let mut read = Read::default();
        for (code, place) in &words.auxiliary {
            auxiliary(*code).map_err(|fault| (Some(*place), fault))?;
            read.end |= matches!(code, 2 | 30);
            read.block.auxiliary.push(*code);
        }
        self.refuse_others(words, &once)?;
        self.begun |= !words.is_empty();
        // The time of a dwell may be written with the letters of feed and speed.
        if !once.dwell {
            self.spindle_speed = words.number('S').unwrap_or(self.spindle_speed);
            self.feed = words.number('F').unwrap_or(self.feed);
        }
        self.selected = words.tool.or(self.selected);
        read.block.tool_change = words.auxiliary.iter().any(|(code, _)| *code == 6);
        if read.block.tool_change {
            self.tool = self.selected;
        }
        read.block.tool = self.tool;
        read.block.exact_stop = once.exact || self.exact;
        if once.dwell {
            read.block.dwell = self.dialect.dwell(words, self.spindle_speed).map_err(|fault| (None, fault))?;
        } else if once.reference {
            self.reference(words, &mut read);
        } else if once.shift {
            self.at = [f64::NAN; 3];
        } else {
            self.motion(words, &once, &mut read).map_err(|fault| (None, fault))?;
        }
        Ok(read)
    }

    /// Refuses every word that nothing in the block understands, and coordinates without a unit.
    fn refuse_others(&self, words: &Words, once: &Once) -> Result<(), Fault> {
        let moving = match self.mode {
            _ if once.dwell || once.alone => "",
            _ if once.reference || once.shift => "XYZ",
            Mode::Open | Mode::Rapid | Mode::Line => "XYZ",
            Mode::Arc { .. } => "XYZIJKR",
            Mode::Cycle(cycle) => cycle.letters(),
        };
        for (letter, value, place) in words.letters() {
            let number = letter == 'O' && !self.begun && words.general.is_empty();
            let known = number
                || (matches!(letter, 'F' | 'S') && !once.dwell)
                || moving.contains(letter)
                || once.letters.contains(letter)
                || (letter == 'H' && self.length.0 != 490)
                || (letter == 'D' && self.dialect == Dialect::Siemens);
            if !known {
                let word = format!("{letter}{value}");
                return Err((Some(place), ProgramFault::Unsupported { word, reason: self.unknown(letter) }));
            }
            let scaled = "XYZIJKRQ".contains(letter) && !once.dwell && value != 0.0;
            if scaled && self.units.is_none() {
                return Err((Some(place), ProgramFault::NoUnits));
            }
        }
        Ok(())
    }

    /// Why a word is not understood where it stands.
    fn unknown(&self, letter: char) -> &'static str {
        match (letter, self.mode) {
            ('A' | 'B' | 'C' | 'E' | 'U' | 'V' | 'W', _) => {
                "it moves a rotary or second axis, whose time is not known here; take the word out where that axis stands still"
            }
            ('P' | 'L', Mode::Arc { .. }) => "it may be turns of a helix; write every turn as a block of its own",
            ('K' | 'L' | 'I' | 'J', Mode::Cycle(_)) => {
                "repeats and first depths of a cycle differ by control; write every hole as a block of its own"
            }
            ('P', Mode::Cycle(_)) => {
                "a dwell that not every control makes in this cycle; use G82, or G4 behind the hole"
            }
            ('O', _) => "a second program begins, which is not followed; give the programs one by one",
            ('F' | 'S', _) => "beside G4 it is a time on some controls only; write it in a block of its own",
            _ => "no code of its block makes it known what it does; take it out where it does nothing",
        }
    }

    fn general(&mut self, code: u32, words: &Words, once: &mut Once) -> Result<(), ProgramFault> {
        if let Some(reason) = self.dialect.refuses(code) {
            return Err(unsupported(code, reason));
        }
        let single = |once: &Once| {
            let others = once.moved || once.dwell || once.reference || once.shift || once.machine_frame;
            if others { Err(ProgramFault::TwoMotions) } else { Ok(()) }
        };
        match code {
            0 => self.begin(Mode::Rapid, once)?,
            10 => self.begin(Mode::Line, once)?,
            20 => self.begin(Mode::Arc { left: false }, once)?,
            30 => self.begin(Mode::Arc { left: true }, once)?,
            730 | 810 | 820 | 830 | 840 | 850 | 860 | 890 => {
                if self.plane != [0, 1, 2] {
                    return Err(unsupported(code, "holes are followed along Z only: write G17 before"));
                }
                self.begin(Mode::Cycle(Cycle::new(code / 10)), once)?;
            }
            // G80 in the first line of a program does not ask for a motion. Where a motion at feed was in force before
            // the cycle, controls differ in what is behind it.
            800 => {
                if matches!(self.mode, Mode::Cycle(_)) {
                    self.mode = if self.before_cycle == Mode::Rapid { Mode::Rapid } else { Mode::Open };
                }
            }
            40 => {
                single(once)?;
                once.dwell = true;
                once.letters.push_str(if self.dialect == Dialect::Siemens { "FS" } else { "PXUFS" });
            }
            90 => once.exact = true,
            170 => self.plane = [0, 1, 2],
            180 => self.plane = [2, 0, 1],
            190 => self.plane = [1, 2, 0],
            200 | 7000 => self.set_units(Units::Inch),
            210 | 710 | 7100 => self.set_units(Units::Millimetre),
            280 | 300 => {
                single(once)?;
                once.reference = true;
                once.letters.push_str(if code == 300 { "P" } else { "" });
            }
            530 => once.machine_frame = true,
            540 | 550 | 560 | 570 | 580 | 590..=593 | 5050..=5990 => self.shift_frame((code, 0.0)),
            541 => {
                let number =
                    words.number('P').ok_or_else(|| unsupported(code, "the number P of the offset is missing"))?;
                once.letters.push('P');
                self.shift_frame((code, number));
            }
            920 if words.any("FS") => {
                return Err(unsupported(code, "with S or F it is a code of lathes, whose programs are not followed"));
            }
            520 | 920..=923 => {
                single(once)?;
                once.shift = true;
            }
            100 => {
                single(once)?;
                if !words.number('L').is_some_and(|list| [2.0, 10.0, 11.0, 12.0, 13.0, 20.0].contains(&list)) {
                    return Err(unsupported(code, "only offsets are set here, by L2, L20 and L10 to L13"));
                }
                once.shift = true;
                once.letters.push_str("LPR");
            }
            600 | 610 => self.exact = true,
            640 => {
                self.exact = false;
                once.letters.push_str("PQ");
            }
            900 => self.absolute = true,
            910 => self.absolute = false,
            // Centres of arcs by steps from their start, as everywhere here.
            911 => {}
            940 | 950 => {
                // A feed a minute is none a revolution.
                if std::mem::replace(&mut self.per_revolution, code == 950) != (code == 950) {
                    self.feed = 0.0;
                }
            }
            980 => self.initial_level = true,
            990 if !self.has_cycle => {
                return Err(unsupported(
                    code,
                    "the level behind a hole on a mill, feed a revolution on a lathe, and no canned cycle says which; take it out on a mill",
                ));
            }
            990 => self.initial_level = false,
            400 => once.letters.push('D'),
            430 | 440 => {
                once.letters.push('H');
                self.shift_length((code, words.number('H').unwrap_or(self.length.1)));
            }
            490 => {
                once.letters.push('H');
                self.shift_length((code, 0.0));
            }
            // Look-ahead; with other words G5.1 is a spline.
            51 => {
                once.letters.push('Q');
                once.alone = true;
            }
            80 => {
                once.letters.push('P');
                once.alone = true;
            }
            500 if words.any("S") => {
                return Err(unsupported(
                    code,
                    "with S it limits the spindle of a lathe, whose programs are not followed",
                ));
            }
            // Scaling off; with axes it sets the origin of a lathe.
            500 => once.alone = true,
            // Rotation and polar coordinates off, speed in revolutions.
            150 | 690 | 970 => {}
            _ => return Err(unsupported(code, refusal(code))),
        }
        Ok(())
    }

    /// Another code of motion.
    fn begin(&mut self, mode: Mode, once: &mut Once) -> Result<(), ProgramFault> {
        if std::mem::replace(&mut once.moved, true) || once.dwell || once.reference || once.shift {
            return Err(ProgramFault::TwoMotions);
        }
        if matches!(mode, Mode::Cycle(_)) && !matches!(self.mode, Mode::Cycle(_)) {
            self.before_cycle = self.mode;
        }
        self.mode = mode;
        Ok(())
    }

    fn set_units(&mut self, units: Units) {
        if self.units.is_some_and(|own| own != units) {
            self.feed = 0.0;
        }
        self.units = Some(units);
    }

    /// Another work offset: the shift between the two is set up at the machine.
    fn shift_frame(&mut self, frame: (u32, f64)) {
        if frame != self.frame {
            self.at = [f64::NAN; 3];
            self.frame = frame;
        }
    }

    /// Another length of the tool: its difference is set up at the machine.
    fn shift_length(&mut self, length: (u32, f64)) {
        if length != self.length {
            self.at[2] = f64::NAN;
            self.length = length;
        }
    }

    /// Program units, m. Every word that needs them was refused without.
    fn scale(&self) -> f64 {
        self.units.unwrap_or(Units::Millimetre).length()
    }

    /// Feed in m/s.
    fn speed(&self) -> Result<f64, ProgramFault> {
        let per_minute = if self.per_revolution { self.feed * self.spindle_speed } else { self.feed };
        let units = self.units.ok_or(ProgramFault::NoUnits)?;
        let speed = per_minute * units.length() / 60.0;
        if speed > 0.0 && speed.is_finite() { Ok(speed) } else { Err(ProgramFault::NoFeed) }
    }

    /// Where the coordinates of a block lead.
    fn target(&self, words: &Words) -> Vector {
        let mut to = self.at;
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if let Some(value) = words.number(letter) {
                to[axis] = if self.absolute { value * self.scale() } else { self.at[axis] + value * self.scale() };
            }
        }
        to
    }

    fn motion(&mut self, words: &Words, once: &Once, read: &mut Read) -> Result<(), ProgramFault> {
        let mode = self.mode;
        if let Mode::Cycle(mut cycle) = mode {
            if once.machine_frame {
                return Err(ProgramFault::TwoMotions);
            }
            // P and Q of an offset or of look-ahead are none of the hole's.
            if let Some(letter) =
                ['P', 'Q'].into_iter().find(|own| once.letters.contains(*own) && words.any(&own.to_string()))
            {
                let reason = "a code of the block and the canned cycle that is in force both take it; write G80 before";
                return Err(ProgramFault::Unsupported { word: letter.to_string(), reason });
            }
            // Words of the cycle hold until it is cancelled; a block without place bores no hole.
            let dwell = self.dialect.pause(words)?;
            cycle.take(words, self.scale(), self.absolute, self.at[2], dwell);
            self.mode = Mode::Cycle(cycle);
            return if words.any("XYZR") { self.holes(&cycle, words, read) } else { Ok(()) };
        }
        let turns = matches!(mode, Mode::Arc { .. }) && words.any("IJKR");
        // A new number of the length, without a code beside it.
        if let Some(register) = words.number('H').or(words.number('D'))
            && !words.general.iter().any(|(code, _)| matches!(code, 400 | 430 | 440 | 490))
        {
            self.shift_length((self.length.0, register));
        }
        if once.alone || (!words.any("XYZ") && !turns) {
            return Ok(());
        }
        if mode == Mode::Open {
            return Err(ProgramFault::NoMotion);
        }
        if once.machine_frame {
            self.forget(words);
            read.unknown = true;
            return Ok(());
        }
        let was = self.at;
        self.at = self.target(words);
        let (mut from, mut to) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let step = words.number(['X', 'Y', 'Z'][axis]).map(|value| value * self.scale());
            // An axis that comes from nowhere known counts as standing still, unless it moves by a step.
            let lost = self.absolute && step.is_some() && was[axis].is_nan();
            read.unknown |= lost;
            from[axis] = if was[axis].is_nan() { 0.0 } else { was[axis] };
            to[axis] = match step {
                Some(step) if !self.absolute => from[axis] + step,
                Some(_) if lost => from[axis],
                Some(step) => step,
                None => from[axis],
            };
        }
        let motion = match mode {
            Mode::Rapid => Motion::straight(from, to, None),
            Mode::Line => Motion::straight(from, to, Some(self.speed()?)),
            Mode::Arc { left } => Some(self.arc(words, from, to, left)?),
            Mode::Open | Mode::Cycle(_) => None,
        };
        read.block.motions.extend(motion);
        Ok(())
    }

    fn arc(&self, words: &Words, from: Vector, to: Vector, left: bool) -> Result<Motion, ProgramFault> {
        let [u, v, w] = self.plane;
        let offset = |axis: usize| words.number(['I', 'J', 'K'][axis]);
        let fault = |message: String| ProgramFault::Arc { message };
        let feed = self.speed()?;
        let (start, end) = ([from[u], from[v]], [to[u], to[v]]);
        let centred = offset(u).is_some() || offset(v).is_some();
        if offset(w).is_some_and(|offset| offset != 0.0) {
            let letter = ['I', 'J', 'K'][w];
            return Err(fault(format!("{letter} is no part of an arc in this plane; write G17, G18 or G19 before it")));
        }
        if centred && words.number('R').is_some() {
            return Err(fault("centre and radius stand in one block, and which counts differs by control".to_owned()));
        }
        let center = if centred {
            let part = |axis: usize| from[axis] + offset(axis).unwrap_or(0.0) * self.scale();
            let center = [part(u), part(v)];
            let reach = |point: [f64; 2]| (point[0] - center[0]).hypot(point[1] - center[1]);
            let gap = (reach(start) - reach(end)).abs();
            // Ten times the last digit of an inch program, or a share of a large radius.
            if gap > 2.54e-5 + 2e-3 * reach(start) {
                return Err(fault(format!("the arc misses its end by {:.4} mm; check I, J and K", gap * 1e3)));
            }
            center
        } else {
            let radius = words.number('R').ok_or_else(|| fault("an arc needs I, J, K or R".to_owned()))?;
            center_by_radius(start, end, radius * self.scale(), left)
                .ok_or_else(|| fault("the end of the arc lies farther than twice its radius".to_owned()))?
        };
        Motion::arc(from, to, center, self.plane, left, feed).ok_or_else(|| fault("the arc has no radius".to_owned()))
    }

    fn holes(&mut self, cycle: &Cycle, words: &Words, read: &mut Read) -> Result<(), ProgramFault> {
        let feed = self.speed()?;
        let mut place = self.at;
        for (axis, letter) in ['X', 'Y'].into_iter().enumerate() {
            if let Some(value) = words.number(letter) {
                place[axis] = if self.absolute { value * self.scale() } else { self.at[axis] + value * self.scale() };
            }
        }
        let initial = self.at[2];
        // In increments L repeats the hole along the line.
        let count = words.number('L').unwrap_or(1.0);
        if !((0.0..=1e4).contains(&count) && count.fract() == 0.0) {
            let reason = "holes are repeated up to 10 000 times, a whole number";
            return Err(ProgramFault::Unsupported { word: format!("L{count}"), reason });
        }
        let count = count as u32;
        let step = [place[0] - self.at[0], place[1] - self.at[1]];
        for _ in 0..count {
            let over = if self.absolute { place } else { [self.at[0] + step[0], self.at[1] + step[1], self.at[2]] };
            let (from, to) = (self.at, [over[0], over[1], self.at[2]]);
            read.unknown |= from.iter().chain(&to).any(|part| part.is_nan());
            if !read.unknown {
                read.block.motions.extend(Motion::straight(from, to, None));
            }
            self.at = to;
            let left = cycle.bore(initial, self.initial_level, feed, read)?;
            self.at[2] = left;
        }
        read.block.holes = count;
        Ok(())
    }

    fn reference(&mut self, words: &Words, read: &mut Read) {
        let named = words.any("XYZ");
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if !named || words.number(letter).is_some() {
                self.at[axis] = f64::NAN;
            }
        }
        read.unknown = true;
    }

    /// Axes named in a block are somewhere that only the machine knows.
    fn forget(&mut self, words: &Words) {
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if words.number(letter).is_some() {
                self.at[axis] = f64::NAN;
            }
        }
    }
}
