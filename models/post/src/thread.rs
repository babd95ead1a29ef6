//! Threads: motions with the spindle's turns, which feed alone would not keep in step.

use crate::{Writer, number, precise};
use toolroom_program::{Dialect, Event, EventKind, Motion, Purpose, Sense};

/// A thread that is cut: a motion with the spindle's turns and, of a tap, the way back.
pub(crate) struct Thread {
    /// Line of the program.
    pub line: usize,
    down: Motion,
    up: Option<Motion>,
    /// Dwell at the bottom, s.
    dwell: f64,
    /// The spindle as it turns on the way down, and its speed, rpm.
    sense: Sense,
    speed: f64,
    /// mm; `None` where the spindle stands.
    pitch: Option<f64>,
    /// What came after the way down, to be written if no way back follows.
    between: Vec<Event>,
}

/// What an event is to a thread that has begun.
pub(crate) enum Next {
    /// More may follow.
    Open,
    /// The last of it.
    Done,
    /// No part of it.
    Over,
}

impl Thread {
    /// The thread that a motion begins, if it is one. `turning` is the spindle, rpm; `pitch` that of a cycle which names one, mm.
    pub fn begins(motion: &Motion, line: usize, turning: (f64, Sense), pitch: Option<f64>) -> Option<Self> {
        if motion.purpose != Purpose::Thread || motion.rapid || motion.time <= 0.0 || motion.length <= 0.0 {
            return None;
        }
        let feed = 60.0 * motion.length / motion.time;
        let (speed, sense) = turning;
        // A cycle may have a speed of its own.
        let speed = pitch.map_or(speed, |pitch| feed / pitch);
        let pitch = pitch.or((speed > 0.0).then(|| feed / speed));
        Some(Self { line, down: *motion, up: None, dwell: 0.0, sense, speed, pitch, between: Vec::new() })
    }

    /// Takes an event that belongs to it.
    pub fn take(&mut self, event: &Event) -> Next {
        let back = |motion: &Motion| {
            let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
            let closes = (0..9).all(|axis| near(motion.end[axis], self.down.start[axis]));
            motion.purpose == Purpose::Thread && !motion.rapid && closes
        };
        match event.kind {
            EventKind::Block | EventKind::Hole => Next::Open,
            EventKind::Dwell(seconds) if self.up.is_none() => {
                self.dwell += seconds;
                self.between.push(*event);
                Next::Open
            }
            EventKind::Spindle { sense, .. } if self.up.is_none() && sense == self.sense.reversed() => {
                self.between.push(*event);
                Next::Open
            }
            EventKind::Motion(motion) if self.up.is_none() && back(&motion) => {
                self.up = Some(motion);
                if self.sense.stands() { Next::Done } else { Next::Open }
            }
            EventKind::Spindle { sense, .. } if self.up.is_some() && sense == self.sense => Next::Done,
            EventKind::Motion(_)
            | EventKind::Dwell(_)
            | EventKind::Spindle { .. }
            | EventKind::ToolChange(_)
            | EventKind::Coolant(_)
            | EventKind::Stop(_)
            | EventKind::Auxiliary(..)
            | EventKind::ExactStop
            | EventKind::Home(_)
            | EventKind::Offset(_)
            | EventKind::End => Next::Over,
        }
    }

    /// Feed on the way back over that on the way down.
    fn quicker(&self) -> f64 {
        self.up.map_or(1.0, |up| self.down.time / up.time)
    }
}

impl Writer {
    /// Writes a thread in words that keep it in step with the spindle: a tap as a cycle at one place (as G33.1 for LinuxCNC), any
    /// other as G33, which of the languages only LinuxCNC has for mills.
    pub(crate) fn thread(&mut self, thread: &Thread) -> Result<(), &'static str> {
        const NO_WORDS: &str = "this thread follows the turns of the spindle, and the language has no words for it but cycles of its own: \
                                take the block over by hand";
        const STANDS: &str = "a thread needs a spindle that turns: command it before";
        let linuxcnc = self.dialect == Dialect::LinuxCnc;
        let Some(up) = thread.up.filter(|_| thread.dwell == 0.0 || !linuxcnc) else {
            if !linuxcnc {
                return Err(NO_WORDS);
            }
            self.at_pitch("G33", thread.down, thread.pitch.ok_or(STANDS)?);
            for event in &thread.between {
                let mut event = *event;
                if let EventKind::Spindle { speed, .. } = &mut event.kind {
                    *speed = self.speed;
                }
                self.event(&event);
            }
            if let Some(up) = thread.up {
                self.at_pitch("G33", up, thread.pitch.ok_or(STANDS)?);
                self.event(&Event {
                    kind: EventKind::Spindle { speed: self.speed, sense: thread.sense },
                    line: thread.line,
                    main_line: thread.line,
                    depth: 0,
                });
            }
            return Ok(());
        };
        let (start, end) = (thread.down.start, thread.down.end);
        let quicker = (thread.quicker() - 1.0).abs() > 1e-6;
        if (0..9).any(|axis| axis != 2 && start[axis] != end[axis]) || (quicker && self.dialect != Dialect::Siemens) {
            return Err(NO_WORDS);
        }
        let (top, bottom) = (Self::round(start[2]), Self::round(end[2]));
        let feed = precise(60.0 * thread.down.length / thread.down.time);
        let left = thread.sense == Sense::Counterclockwise;
        let sign = if left { "-" } else { "" };
        // A cycle of SINUMERIK names its speed; others tap at that of the spindle.
        let programmed = self.speed;
        let own = self.dialect != Dialect::Siemens
            && thread.pitch.is_some()
            && (thread.speed / programmed - 1.0).abs() > 1e-6;
        if own {
            self.turn(thread.speed);
        }
        match self.dialect {
            Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas => {
                let code = if left { 74 } else { 84 };
                let dwell = if thread.dwell > 0.0 { format!(" P{:.0}", 1e3 * thread.dwell) } else { String::new() };
                self.line(&format!("G99 G{code} Z{} R{}{dwell} F{feed}", self.value(bottom), self.value(top)));
                self.line("G80");
            }
            Dialect::Siemens => {
                let pitch = precise(thread.pitch.ok_or(STANDS)?);
                let dwell = number(thread.dwell, 6, false);
                let [top, bottom] = [top, bottom].map(|height| self.value(height));
                let speed = precise(thread.speed);
                let back = precise(thread.speed * thread.quicker());
                let after = if left { 4 } else { 3 };
                self.line(&format!("CYCLE84({top},{top},0,{bottom},,{dwell},{after},,{sign}{pitch},0,{speed},{back})"));
            }
            Dialect::Heidenhain => {
                if thread.dwell > 0.0 {
                    return Err(NO_WORDS);
                }
                let pitch = precise(thread.pitch.ok_or(STANDS)?);
                let sign = if left { "-" } else { "+" };
                let (depth, surface) = (self.value(bottom - top), self.value(top));
                self.line(&format!(
                    "CYCL DEF 207 RIGID TAPPING ~\n  Q200=+0 ~\n  Q201={depth} ~\n  Q239={sign}{pitch} ~\n  Q203={surface} ~\n  Q204=+0\nCYCL CALL"
                ));
            }
            Dialect::LinuxCnc => self.at_pitch("G33.1", thread.down, thread.pitch.ok_or(STANDS)?),
        }
        if own {
            self.turn(programmed);
        }
        self.tapped();
        // A cycle has a feed of its own, and ends where it began.
        self.feed.clear();
        self.position[2] = Some(Self::round(up.end[2]));
        Ok(())
    }

    /// The speed of the spindle, rpm, which turns as before.
    fn turn(&mut self, speed: f64) {
        let speed = number(speed, 3, false);
        let call = if self.dialect == Dialect::Heidenhain { "TOOL CALL Z " } else { "" };
        self.line(&format!("{call}S{speed}"));
    }

    fn at_pitch(&mut self, code: &str, motion: Motion, pitch: f64) {
        let words = self.axes(&motion.end, [false; 9]);
        self.line(&format!("{code}{words} K{}", precise(pitch)));
    }
}
