//! Modal state of a controller.

use super::cycle::Cycle;
use super::motion::{Motion, Vector, center_by_radius};
use super::words::Words;
use super::{Block, ProgramFault};

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
    Rapid,
    Line,
    Arc { left: bool },
    Cycle(Cycle),
}

/// Modal state; an unknown coordinate is NaN.
#[derive(Clone, Debug)]
pub(super) struct State {
    at: Vector,
    scale: f64,
    absolute: bool,
    plane: [usize; 3],
    mode: Mode,
    feed: f64,
    per_revolution: bool,
    spindle_speed: f64,
    exact: bool,
    /// Whether holes are left at the level from which the cycle began.
    initial_level: bool,
    selected: Option<u32>,
    tool: Option<u32>,
    frame: u32,
}

impl Default for State {
    fn default() -> Self {
        Self {
            at: [f64::NAN; 3],
            scale: 1e-3,
            absolute: true,
            plane: [0, 1, 2],
            mode: Mode::Rapid,
            feed: 0.0,
            per_revolution: false,
            spindle_speed: 0.0,
            exact: false,
            initial_level: true,
            selected: None,
            tool: None,
            frame: 540,
        }
    }
}

/// A fault, and where the block's start does not tell it well enough.
pub(super) type Fault = (Option<usize>, ProgramFault);

/// What the G codes of one block ask for once.
#[derive(Default)]
struct Once {
    dwell: bool,
    reference: bool,
    machine_frame: bool,
    shift: bool,
    exact: bool,
    moved: bool,
}

impl State {
    /// The block that `words` ask for.
    pub(super) fn block(&mut self, words: &Words) -> Result<Read, Fault> {
        let mut once = Once::default();
        for (code, place) in &words.general {
            self.general(*code, &mut once).map_err(|fault| (Some(*place), fault))?;
        }
        let mut read = Read::default();
        for (code, place) in &words.auxiliary {
            if matches!(code, 98 | 99) {
                let reason = "subprograms are not followed";
                return Err((Some(*place), ProgramFault::Unsupported { word: format!("M{code}"), reason }));
            }
            read.end |= matches!(code, 2 | 30);
            read.block.auxiliary.push(*code);
        }
        if let Some(speed) = words.number('S') {
            self.spindle_speed = speed;
        }
        if let Some(feed) = words.number('F') {
            self.feed = feed;
        }
        self.selected = words.tool.or(self.selected);
        read.block.tool_change = words.auxiliary.iter().any(|(code, _)| *code == 6);
        if read.block.tool_change {
            self.tool = self.selected;
        }
        read.block.tool = self.tool;
        read.block.exact_stop = once.exact || self.exact;
        if once.dwell {
            read.block.dwell = dwell(words);
        } else if once.reference {
            self.reference(words, &mut read);
        } else if once.shift {
            self.forget(words);
        } else {
            self.motion(words, &once, &mut read).map_err(|fault| (None, fault))?;
        }
        Ok(read)
    }

    fn general(&mut self, code: u32, once: &mut Once) -> Result<(), ProgramFault> {
        let mut mode = |mode: Mode| {
            if std::mem::replace(&mut once.moved, true) {
                return Err(ProgramFault::TwoMotions);
            }
            self.mode = mode;
            Ok(())
        };
        match code {
            0 => mode(Mode::Rapid)?,
            10 => mode(Mode::Line)?,
            20 => mode(Mode::Arc { left: false })?,
            30 => mode(Mode::Arc { left: true })?,
            730 | 810..=860 | 890 if code.is_multiple_of(10) => mode(Mode::Cycle(Cycle::new(code / 10)))?,
            // G80 in the first line of a program does not ask for a motion.
            800 => self.mode = if matches!(self.mode, Mode::Cycle(_)) { Mode::Rapid } else { self.mode },
            40 => once.dwell = true,
            90 => once.exact = true,
            170 => self.plane = [0, 1, 2],
            180 => self.plane = [2, 0, 1],
            190 => self.plane = [1, 2, 0],
            200 => self.scale = 0.0254,
            210 => self.scale = 1e-3,
            280 | 300 => once.reference = true,
            530 => once.machine_frame = true,
            540..=599 => {
                if code != self.frame {
                    // The shift between coordinate systems is set up at the machine.
                    self.at = [f64::NAN; 3];
                    self.frame = code;
                }
            }
            520 | 920..=923 | 100 => once.shift = true,
            610 => self.exact = true,
            640 => self.exact = false,
            900 => self.absolute = true,
            910 => self.absolute = false,
            940 => self.per_revolution = false,
            950 => self.per_revolution = true,
            980 => self.initial_level = true,
            990 => self.initial_level = false,
            // Compensation, smoothing, chord tolerance, block buffering, units of speed.
            50 | 51 | 80 | 81 | 110 | 150 | 400..=402 | 410 | 420 | 430..=435 | 440 | 490 | 500 | 690 | 970 => {}
            _ => {
                let (word, tenth) = (code / 10, code % 10);
                let word = if tenth == 0 { format!("G{word}") } else { format!("G{word}.{tenth}") };
                let reason = match code {
                    650..=670 => "macros are not followed",
                    930 => "feed by inverse time is not known here",
                    870 | 880 => "its time depends on the operator or the machine",
                    _ => "its time is not known here",
                };
                return Err(ProgramFault::Unsupported { word, reason });
            }
        }
        Ok(())
    }

    /// Feed in m/s.
    fn speed(&self) -> Result<f64, ProgramFault> {
        let per_minute = if self.per_revolution { self.feed * self.spindle_speed } else { self.feed };
        let speed = per_minute * self.scale / 60.0;
        if speed > 0.0 { Ok(speed) } else { Err(ProgramFault::NoFeed) }
    }

    /// Where the coordinates of a block lead.
    fn target(&self, words: &Words) -> Vector {
        let mut to = self.at;
        for (axis, letter) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            if let Some(value) = words.number(letter) {
                to[axis] = if self.absolute { value * self.scale } else { self.at[axis] + value * self.scale };
            }
        }
        to
    }

    fn motion(&mut self, words: &Words, once: &Once, read: &mut Read) -> Result<(), ProgramFault> {
        let mode = self.mode;
        if let Mode::Cycle(mut cycle) = mode {
            // Words of the cycle hold until it is cancelled; a block without place bores no hole.
            cycle.take(words, self.scale, self.absolute, self.at[2]);
            self.mode = Mode::Cycle(cycle);
            return if words.any("XYZR") { self.holes(&cycle, words, read) } else { Ok(()) };
        }
        let turns = matches!(mode, Mode::Arc { .. }) && words.any("IJKR");
        if !words.any("XYZ") && !turns {
            return Ok(());
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
            let step = words.number(['X', 'Y', 'Z'][axis]).map(|value| value * self.scale);
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
            Mode::Cycle(_) => None,
        };
        read.block.motions.extend(motion);
        Ok(())
    }

    fn arc(&self, words: &Words, from: Vector, to: Vector, left: bool) -> Result<Motion, ProgramFault> {
        let [u, v, _] = self.plane;
        let offset = |axis: usize| words.number(['I', 'J', 'K'][axis]);
        let fault = |message: String| ProgramFault::Arc { message };
        let feed = self.speed()?;
        let (start, end) = ([from[u], from[v]], [to[u], to[v]]);
        let center = if offset(u).is_some() || offset(v).is_some() {
            let part = |axis: usize| from[axis] + offset(axis).unwrap_or(0.0) * self.scale;
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
            center_by_radius(start, end, radius * self.scale, left)
                .ok_or_else(|| fault("the end of the arc lies farther than twice its radius".to_owned()))?
        };
        Motion::arc(from, to, center, self.plane, left, feed).ok_or_else(|| fault("the arc has no radius".to_owned()))
    }

    fn holes(&mut self, cycle: &Cycle, words: &Words, read: &mut Read) -> Result<(), ProgramFault> {
        let feed = self.speed()?;
        let mut place = self.at;
        for (axis, letter) in ['X', 'Y'].into_iter().enumerate() {
            if let Some(value) = words.number(letter) {
                place[axis] = if self.absolute { value * self.scale } else { self.at[axis] + value * self.scale };
            }
        }
        let initial = self.at[2];
        // In increments L repeats the hole along the line.
        let count = words.number('L').map_or(1, |count| count.clamp(0.0, 1e4) as u32);
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

/// Dwell of G4, s: P in milliseconds, or in seconds with a decimal point; X and U in seconds.
fn dwell(words: &Words) -> f64 {
    let milliseconds = words.number('P').map(|value| if words.pointed { value } else { value * 1e-3 });
    milliseconds.or(words.number('X')).or(words.number('U')).unwrap_or(0.0).max(0.0)
}
