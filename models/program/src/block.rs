//! All blocks of a program.

use crate::control::Control;
use crate::error::ProgramError;
use crate::motion::{Event, EventKind, Motion, Sense};
use crate::run::Run;
use toolroom_pages::Source;

/// What a block does beside its motions, where it can take time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// The spindle is commanded: speed, rpm, and how it turns.
    Spindle(f64, Sense),
    /// Coolant is switched on or off.
    Coolant(bool),
    /// A stop.
    Stop,
    /// The tool changes to this number, where one was called.
    Change(Option<u32>),
    /// Axes are at their reference point; whether Z is among them.
    Home(bool),
    /// The program ends.
    End,
}

/// One block that has run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Block {
    /// Line of the file, from 1; of the call in the main program, for blocks of a subprogram.
    pub line: usize,
    /// Line of the file that runs, from 1: of the subprogram, for its blocks.
    pub own_line: usize,
    /// Tool in the spindle behind the block, where one was called.
    pub tool: Option<u32>,
    /// Motions in order.
    pub motions: Vec<Motion>,
    /// What it does beside them, in order, each with the number of motions that stand before it.
    pub actions: Vec<(usize, Action)>,
    /// Programmed dwell, s.
    pub dwell: f64,
    /// Time of auxiliary functions, s.
    pub auxiliary_time: f64,
    /// Whether the tool is changed.
    pub tool_change: bool,
    /// Number of holes of a canned cycle.
    pub holes: u32,
    /// Whether it has auxiliary functions: spindle, coolant, stops, functions of the machine.
    pub auxiliary: bool,
    /// Whether the axes come to rest behind it though the path goes on.
    pub exact_stop: bool,
    /// Line of its first motion from or to a place that only the machine knows.
    pub unknown: Option<usize>,
}

/// Rapid speed of rotary axes, degrees a second: 25 turns a minute (assumption).
pub(crate) const ROTARY_RAPID: f64 = 150.0;

impl Motion {
    /// Time at the programmed feed, or at `rapid_speed` (m/s) of each axis, s: no axis needs time to accelerate.
    pub fn nominal(&self, rapid_speed: f64) -> f64 {
        if self.rapid {
            let (linear, rotary) = self.longest();
            (1e-3 * linear / rapid_speed).max(rotary / ROTARY_RAPID)
        } else {
            self.time
        }
    }
}

impl Block {
    /// Time of its motions at programmed feeds and `rapid_speed` (m/s) of each axis, and of its dwell, s.
    pub fn nominal(&self, rapid_speed: f64) -> f64 {
        self.dwell + self.auxiliary_time + self.motions.iter().map(|motion| motion.nominal(rapid_speed)).sum::<f64>()
    }

    /// The part of [`nominal`](Self::nominal) at feed, s.
    pub fn feed_time(&self) -> f64 {
        self.motions.iter().map(|motion| motion.time).sum()
    }
}

/// A part program that has run.
///
/// ```
/// use toolroom_program::{Control, Program};
/// let text = "T1 M6\nG21 G90 G0 X0 Y0 Z5\nG1 Z-1 F60\nX120 F1200\nG4 P500\nM30";
/// let program = Program::read(text, &Control::default()).unwrap();
/// assert_eq!(program.blocks.iter().map(|block| block.feed_time()).sum::<f64>(), 12.0);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// Blocks in the order in which they ran.
    pub blocks: Vec<Block>,
    /// Lines, from 1, of motions whose length is not known because they come from a reference point or another coordinate
    /// system: they count with the axes that are known.
    pub unknown: Vec<usize>,
}

/// Blocks of a program one after the other, in bounded memory.
pub struct Blocks {
    run: Run,
    tool: Option<u32>,
    next: Option<Block>,
    /// Whether the last event of the program has come.
    ended: bool,
}

impl Blocks {
    /// Begins a program.
    ///
    /// # Errors
    /// As [`Run::new`].
    pub fn new(text: impl Into<Source>, control: &Control) -> Result<Self, ProgramError> {
        Ok(Self { run: Run::new(text, control)?, tool: None, next: None, ended: false })
    }

    /// The program that runs.
    pub fn run(&self) -> &Run {
        &self.run
    }
}

impl Block {
    fn take(&mut self, event: &Event) {
        let mut act = |action| self.actions.push((self.motions.len(), action));
        match event.kind {
            EventKind::Block | EventKind::Offset(_) => {}
            EventKind::Home(axes) => act(Action::Home(axes[2])),
            EventKind::End => act(Action::End),
            EventKind::Motion(motion) => {
                if motion.unknown && self.unknown.is_none() {
                    self.unknown = Some(event.line);
                }
                self.motions.push(motion);
            }
            EventKind::Dwell(seconds) => self.dwell += seconds,
            EventKind::ToolChange(number) => {
                act(Action::Change(number));
                (self.tool_change, self.tool) = (true, number);
            }
            EventKind::Auxiliary(_, seconds) => {
                self.auxiliary = true;
                self.auxiliary_time += seconds;
            }
            EventKind::Spindle { speed, sense } => {
                act(Action::Spindle(speed, sense));
                self.auxiliary = true;
            }
            EventKind::Coolant(on) => {
                act(Action::Coolant(on));
                self.auxiliary = true;
            }
            EventKind::Stop(_) => {
                act(Action::Stop);
                self.auxiliary = true;
            }
            EventKind::Hole => self.holes += 1,
            EventKind::ExactStop => self.exact_stop = true,
        }
    }
}

impl Iterator for Blocks {
    type Item = Result<Block, ProgramError>;

    fn next(&mut self) -> Option<Self::Item> {
        while !self.ended {
            match self.run.next() {
                None => self.ended = true,
                Some(Err(error)) => {
                    self.ended = true;
                    self.next = None;
                    return Some(Err(error));
                }
                Some(Ok(event)) => {
                    let begins = matches!(event.kind, EventKind::Block) || self.next.is_none();
                    // A long canned pattern or spline is handed on in parts.
                    let full = self.next.as_ref().is_some_and(|block| block.motions.len() >= PART);
                    let before = if begins || full {
                        let (line, own_line) = (event.main_line, event.line);
                        let fresh = Block { line, own_line, tool: self.tool, ..Block::default() };
                        self.next.replace(fresh)
                    } else {
                        None
                    };
                    if let Some(block) = &mut self.next {
                        block.take(&event);
                        self.tool = block.tool;
                    }
                    if before.is_some() {
                        return before.map(Ok);
                    }
                }
            }
        }
        self.next.take().map(Ok)
    }
}

/// Greatest number of motions of a block that is handed on whole: some ten megabytes (assumption).
const PART: usize = 100_000;

impl Program {
    /// Runs a program and keeps all of its blocks.
    ///
    /// # Errors
    /// [`ProgramError`] with the first place that is not understood, or where nothing moves.
    pub fn read(text: impl Into<Source>, control: &Control) -> Result<Self, ProgramError> {
        let blocks = Blocks::new(text, control)?;
        let (dialect, _) = blocks.run().dialect();
        let mut program = Self::default();
        for block in blocks {
            let block = block?;
            program.unknown.extend(block.unknown.filter(|line| program.unknown.last() != Some(line)));
            program.blocks.push(block);
        }
        if program.blocks.iter().all(|block| block.motions.is_empty() && block.dwell == 0.0) {
            return Err(ProgramError::still(dialect));
        }
        Ok(program)
    }
}
