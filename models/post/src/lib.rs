//! Programs written for another control, from the motions of one that runs.
//!
//! | item | what it is |
//! |---|---|
//! | [`post()`] | follows a program and writes its motions in the words of another control |
//! | [`post_as()`] | the same with planned motions in place of those of the program |
//! | [`Form`] | the language, and whether holes stay cycles |
//! | [`Post`] | what was written, and the lines of what has no place in it |
//! | [`Drawing`] | paths as a drawing in DXF |
//!
//! # Units
//! As in `toolroom-program`: mm, degrees and s; the programs that are written are metric.
//!
//! # What is not modelled
//! Subprograms and compensation of the target control: they are worked out, as are canned cycles where they are not asked for, but for
//! taps, which only a cycle or a block of its own ties to the spindle. Threads that the language has no such words for are refused. Programs of lathes.

#![deny(clippy::wildcard_enum_match_arm)] // a kind of event that comes has to be thought of here too

mod arc;
mod cycle;
mod drawing;
mod form;
mod hole;
mod thread;

pub use drawing::Drawing;
pub use form::{Form, Post};

use cycle::Cycles;
use std::fmt::Write;
use thread::{Next, Thread};
use toolroom_program::{
    AXES, Axes, Control, Dialect, Event, EventKind, Motion, Offset, PLANES, Path, ProgramError, Run, Sense, Source,
};

/// Decimals of lengths in mm.
const DECIMALS: usize = 4;

/// Follows a program and writes its motions in a [`Form`], such as a language: in millimetres, absolute, with subprograms, loops, cycles,
/// frames and compensation worked out. Read again it makes the same motions: ends within half a unit of the fourth decimal
/// of a millimetre or degree, those of helices in Klartext within two units, since they follow from a rounded pole.
///
/// # Errors
/// [`ProgramError`] where the program is refused, comes from a lathe, steps from a place that only the machine knows, or needs
/// an arc or a thread that the language does not have.
///
/// ```
/// use toolroom_post::post;
/// use toolroom_program::{Control, Dialect};
/// let text = "G21 G90 G0 X0 Y0 Z5.\nG1 Z-1. F60\nG3 X10. Y10. J10.\nM30";
/// let klartext = post(text, &Control::default(), Dialect::Heidenhain).unwrap().text;
/// assert!(klartext.contains("CC X+0 Y+10\nC X+10 Y+10 DR+"), "{klartext}");
/// ```
pub fn post(text: impl Into<Source>, control: &Control, form: impl Into<Form>) -> Result<Post, ProgramError> {
    post_as(text, control, form, |_, motion| vec![*motion], |speed, _| speed)
}

/// [`post()`] with other motions in place of those of the program: `planned` gets each with its place among all motions, from 0, and
/// gives what is written instead, which has to begin and end where the motion does. `speeds` gets the speed of each spindle command,
/// rpm, and its sense, and gives the speed that is written.
///
/// # Errors
/// As [`post()`].
pub fn post_as(
    text: impl Into<Source>,
    control: &Control,
    form: impl Into<Form>,
    mut planned: impl FnMut(usize, &Motion) -> Vec<Motion>,
    mut speeds: impl FnMut(f64, Sense) -> f64,
) -> Result<Post, ProgramError> {
    let mut count = 0;
    let mut run = Run::new(text, control)?;
    let (source, _) = run.dialect();
    let form = form.into();
    let dialect = form.dialect;
    let mut writer = Writer::new(dialect);
    writer.cycles = form.keep_cycles.then(Cycles::default);
    let refused = |line: usize, message: &str| ProgramError::of_line(line, source, message);
    // The spindle as the program has it, and a thread that has begun.
    let (mut turning, mut open) = ((0.0, Sense::Still), None::<Thread>);
    if source == Dialect::FanucLathe || dialect == Dialect::FanucLathe {
        return Err(refused(1, "programs of lathes are not translated"));
    }
    while let Some(event) = run.next() {
        let mut event = event?;
        if let Some(mut thread) = open.take() {
            match thread.take(&event) {
                Next::Open => {
                    open = Some(thread);
                    continue;
                }
                Next::Done => {
                    writer.thread(&thread).map_err(|message| refused(thread.line, message))?;
                    continue;
                }
                Next::Over => writer.thread(&thread).map_err(|message| refused(thread.line, message))?,
            }
        }
        if let EventKind::Spindle { speed, sense } = &mut event.kind {
            turning = (*speed, *sense);
            *speed = speeds(*speed, *sense);
        }
        if let Some(line) = run.blind_step() {
            return Err(refused(
                line,
                "a step from a place that only the machine knows has no absolute end: name a place before it, or give --start",
            ));
        }
        let known = run.position().map(|place| place.is_some());
        writer.known = known;
        let fault = |(line, message): (usize, &str)| refused(line, message);
        if let Some(line) = run.partly_known() {
            return Err(refused(
                line,
                "of this work offset only some axes are known to the one before: give all of them, with G10 or --set control.offset.G55=\"100,0,0 mm\"",
            ));
        }
        if let EventKind::Offset(Offset::Work(number)) = event.kind {
            writer.end_cycles(event.line).map_err(fault)?;
            writer.work(number, event.line).map_err(|message| refused(event.line, &message))?;
            continue;
        }
        let EventKind::Motion(motion) = event.kind else {
            if !writer.keeps(&event, known).map_err(fault)? {
                writer.event(&event);
            }
            continue;
        };
        let parts = planned(count, &motion);
        count += 1;
        if let Some(thread) = Thread::begins(&motion, event.line, turning, run.pitch()) {
            writer.end_cycles(event.line).map_err(fault)?;
            open = Some(thread);
            continue;
        }
        for part in parts {
            if !writer.keeps(&Event { kind: EventKind::Motion(part), ..event }, known).map_err(fault)? {
                writer.known = known;
                writer.motion(&part, event.line).map_err(|message| refused(event.line, message))?;
            }
        }
    }
    if let Some(thread) = open {
        writer.thread(&thread).map_err(|message| refused(thread.line, message))?;
    }
    writer.end_cycles(0).map_err(|(line, message)| refused(line, message))?;
    writer.finish();
    let holes = writer.cycles.map_or([0, 0], |cycles| cycles.count);
    Ok(Post { text: writer.text, left_out: writer.left_out, holes })
}

struct Writer {
    dialect: Dialect,
    text: String,
    /// Position as written, `None` before the first motion of an axis.
    position: [Option<f64>; 9],
    feed: String,
    plane: [usize; 3],
    /// Work offset in which it is written, by its number.
    work: u32,
    speed: f64,
    left_out: Vec<usize>,
    /// Axes whose place the program knows: no other may be sent anywhere.
    known: [bool; 9],
    /// Tools in the order of their calls.
    tools: Vec<u32>,
    /// Where the list of tools stands.
    head: usize,
    /// Cycles, where they are kept.
    cycles: Option<Cycles>,
}

/// The number with at most so many decimals; with a point where it may count least increments otherwise.
fn number(value: f64, decimals: usize, pointed: bool) -> String {
    let text = format!("{value:.decimals$}");
    let short = text.trim_end_matches('0');
    let short = if pointed { short } else { short.trim_end_matches('.') };
    if matches!(short, "-0" | "-0." | "-") {
        if pointed { "0.".to_owned() } else { "0".to_owned() }
    } else {
        short.to_owned()
    }
}

/// A number to seven digits, as far as they are there.
fn precise(value: f64) -> String {
    let digits = (6 - value.abs().max(1e-6).log10().floor() as i32).clamp(0, 9) as usize;
    number(value, digits, false)
}

impl Writer {
    fn new(dialect: Dialect) -> Self {
        let text = match dialect {
            Dialect::Fanuc | Dialect::FanucLathe => "%\nO0001\nG21 G17 G90 G94 G40 G49 G80\nG54\n",
            Dialect::Haas => "%\nO00001\nG21 G17 G90 G94 G40 G49 G80\nG54\n",
            Dialect::Siemens => "%_N_MAIN_MPF\nG71 G17 G90 G94 G40\nG54\n",
            Dialect::Heidenhain => "BEGIN PGM MAIN MM\n",
            Dialect::LinuxCnc => "G21 G17 G90 G94 G40 G49 G80\nG54\n",
        };
        Self {
            dialect,
            text: text.to_owned(),
            position: [None; 9],
            feed: String::new(),
            plane: PLANES[0],
            work: 0,
            speed: 0.0,
            left_out: Vec::new(),
            known: [false; 9],
            tools: Vec::new(),
            head: text.find("\nG").map_or(text.len(), |at| at + 1),
            cycles: None,
        }
    }

    fn klartext(&self) -> bool {
        self.dialect == Dialect::Heidenhain
    }

    fn value(&self, value: f64) -> String {
        let pointed = matches!(self.dialect, Dialect::Fanuc | Dialect::Haas);
        let text = number(value, DECIMALS, pointed);
        if self.klartext() && !text.starts_with('-') { format!("+{text}") } else { text }
    }

    fn line(&mut self, text: &str) {
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn round(value: f64) -> f64 {
        let factor = 10_f64.powi(DECIMALS as i32);
        (value * factor).round() / factor
    }

    /// Writes what is no motion.
    fn event(&mut self, event: &Event) {
        match event.kind {
            EventKind::Dwell(seconds) => {
                let time = number(seconds, 6, true);
                match self.dialect {
                    Dialect::Fanuc | Dialect::FanucLathe => self.line(&format!("G4 X{time}")),
                    Dialect::Haas => self.line(&format!("G4 P{time}")),
                    Dialect::Siemens => self.line(&format!("G4 F{}", number(seconds, 6, false))),
                    Dialect::LinuxCnc => self.line(&format!("G4 P{}", number(seconds, 6, false))),
                    Dialect::Heidenhain => {
                        let time = number(seconds, 6, false);
                        self.line(&format!("CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL {time}"));
                    }
                }
            }
            EventKind::ToolChange(tool) => {
                let tool = tool.unwrap_or(0);
                if !self.tools.contains(&tool) {
                    self.tools.push(tool);
                }
                if self.klartext() {
                    self.line(&format!("TOOL CALL {tool} Z"));
                } else {
                    self.line(&format!("T{tool} M6"));
                }
            }
            EventKind::Spindle { speed, sense } => {
                if !sense.stands() && speed != self.speed {
                    self.speed = speed;
                    let speed = number(speed, 3, false);
                    let text = if self.klartext() { format!("TOOL CALL Z S{speed}") } else { format!("S{speed}") };
                    self.line(&text);
                }
                self.line(match sense {
                    Sense::Clockwise => "M3",
                    Sense::Counterclockwise => "M4",
                    Sense::Still => "M5",
                    Sense::Oriented => "M19",
                });
            }
            EventKind::Coolant(on) => self.line(if on { "M8" } else { "M9" }),
            EventKind::Stop(optional) => self.line(if optional { "M1" } else { "M0" }),
            EventKind::Home(axes) => self.home(axes, event.line),
            EventKind::Offset(Offset::Length(register)) => self.length(register),
            EventKind::ExactStop => self.leave_out(event.line),
            EventKind::Auxiliary(2 | 30, _)
            | EventKind::Motion(_)
            | EventKind::Block
            | EventKind::Hole
            // Written where it can be refused.
            | EventKind::Offset(Offset::Work(_))
            | EventKind::End => {}
            EventKind::Auxiliary(..) => self.leave_out(event.line),
        }
    }

    /// The linear axes return to the machine's own place, in the words of the control; the program knows them no more.
    fn home(&mut self, axes: [bool; 9], line: usize) {
        // What was said of the motion is said in these words.
        if self.left_out.last() == Some(&line) {
            self.left_out.pop();
        }
        if axes[3..].contains(&true) {
            self.leave_out(line);
        }
        let zero =
            if matches!(self.dialect, Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas) { "0." } else { "0" };
        let mut words = String::new();
        for axis in (0..3).filter(|axis| axes[*axis]) {
            let sign = if self.klartext() { "+" } else { "" };
            let _ = write!(words, " {}{sign}{zero}", AXES[axis]);
            self.position[axis] = None;
        }
        if words.is_empty() {
            return;
        }
        match self.dialect {
            Dialect::Siemens => self.line(&format!("SUPA G0{words} D0")),
            Dialect::Heidenhain => self.line(&format!("L{words} R0 FMAX M91")),
            Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas | Dialect::LinuxCnc => {
                self.line(&format!("G91 G28{words}"));
                self.line("G90");
            }
        }
    }

    /// The word of a work offset by its number; `None` where the language has none.
    fn work_word(&self, number: u32) -> Option<String> {
        match (self.dialect, number) {
            (Dialect::Heidenhain, _) => None,
            (_, 0..=3) => Some(format!("G{}", 54 + number)),
            (Dialect::Siemens, 99) => Some("G500".to_owned()),
            (Dialect::Siemens, 100..=194) => Some(format!("G{}", 405 + number)),
            (Dialect::Siemens, _) => None,
            (_, 4..=5) => Some(format!("G{}", 54 + number)),
            (Dialect::LinuxCnc, 6..=8) => Some(format!("G59.{}", number - 5)),
            (Dialect::Fanuc | Dialect::Haas, 100..=198) => Some(format!("G54.1 P{}", number - 99)),
            (Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas | Dialect::LinuxCnc, _) => None,
        }
    }

    /// A work offset of which only the machine knows how it lies to the one before: axes that stood in that one have no place in it until
    /// they move.
    fn work(&mut self, number: u32, line: usize) -> Result<(), String> {
        let changes = number != self.work;
        match self.work_word(number) {
            Some(word) => self.line(&word),
            // A program that has not moved yet counts in it from its begin on.
            None if changes && self.position.iter().all(Option::is_none) => self.leave_out(line),
            None if changes => {
                return Err(format!(
                    "the program goes on in another work offset, for which {} has no word here, and how it lies to the one before is not \
                     known: give --set control.offset.G55=\"100,0,0 mm\" (G54 to G59), then its places are worked out; of a datum of Klartext \
                     or an offset beyond them, divide the program there",
                    self.dialect.name()
                ));
            }
            None => {}
        }
        if changes {
            self.position = [None; 9];
            self.work = number;
        }
        Ok(())
    }

    /// Lengths by a table of the control. Klartext adds the length with the tool.
    fn length(&mut self, register: Option<u32>) {
        match (register, self.dialect) {
            (_, Dialect::Heidenhain) => {}
            (Some(_), Dialect::Siemens) => self.line("D1"),
            (None, Dialect::Siemens) => self.line("D0"),
            (Some(register), _) => self.line(&format!("G43 H{register}")),
            (None, _) => self.line("G49"),
        }
    }

    fn leave_out(&mut self, line: usize) {
        if self.left_out.last() != Some(&line) {
            self.left_out.push(line);
        }
    }

    /// Whether an axis has to be written to get to `end`.
    fn changes(&self, axis: usize, end: &Axes) -> bool {
        let place = Self::round(end[axis]);
        let unset = self.position[axis].is_none() && (!self.known[axis] || (axis > 2 && place == 0.0));
        self.position[axis] != Some(place) && !unset
    }

    /// Words of the axes that change, or all that are known; the position is theirs afterwards.
    fn axes(&mut self, end: &Axes, forced: [bool; 9]) -> String {
        let mut words = String::new();
        for axis in 0..9 {
            let place = Self::round(end[axis]);
            if self.changes(axis, end) || forced[axis] {
                let _ = write!(words, " {}{}", AXES[axis], self.value(place));
                self.position[axis] = Some(place);
            }
        }
        words
    }

    /// F where it changes; its digits keep the time within 1e-6.
    fn feed(&mut self, motion: &Motion) -> String {
        self.feed_word(60.0 * motion.length / motion.time)
    }

    /// F of a feed, mm/min, where it changes.
    fn feed_word(&mut self, feed: f64) -> String {
        let text = precise(feed);
        if text == self.feed {
            return String::new();
        }
        self.feed.clone_from(&text);
        format!(" F{text}")
    }

    fn motion(&mut self, motion: &Motion, line: usize) -> Result<(), &'static str> {
        let moves = motion.start != motion.end || matches!(motion.path, Path::Arc(_));
        // To a place of the machine; from one, the axis that comes from there is written.
        if !moves && motion.unknown && (0..9).all(|axis| !self.changes(axis, &motion.end)) {
            self.leave_out(line);
            return Ok(());
        }
        if motion.rapid {
            let words = self.axes(&motion.end, [false; 9]);
            if !words.is_empty() {
                if self.klartext() {
                    self.line(&format!("L{words} FMAX"));
                } else {
                    self.line(&format!("G0{words}"));
                }
            }
            return Ok(());
        }
        if motion.time <= 0.0 || motion.length <= 0.0 {
            return Ok(());
        }
        if let Path::Arc(arc) = motion.path {
            return self.arc(motion, &arc);
        }
        let words = self.axes(&motion.end, [false; 9]);
        if words.is_empty() {
            return Ok(());
        }
        let feed = self.feed(motion);
        let text = if self.klartext() { format!("L{words}{feed}") } else { format!("G1{words}{feed}") };
        self.line(&text);
        Ok(())
    }

    fn finish(&mut self) {
        let tools: String = (self.tools.iter())
            .map(|tool| match self.dialect {
                Dialect::Siemens | Dialect::Heidenhain => format!("; TOOL {tool}\n"),
                Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas | Dialect::LinuxCnc => format!("(TOOL {tool})\n"),
            })
            .collect();
        self.text.insert_str(self.head, &tools);
        match self.dialect {
            Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas => self.text.push_str("M30\n%\n"),
            Dialect::Siemens | Dialect::LinuxCnc => self.text.push_str("M30\n"),
            Dialect::Heidenhain => self.text.push_str("M30\nEND PGM MAIN MM\n"),
        }
    }
}
