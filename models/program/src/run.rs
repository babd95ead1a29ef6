//! Runs a program: its blocks one by one, as a stream of events in bounded memory.

use crate::control::Control;
use crate::dialect::Dialect;
use crate::error::{Fault, ProgramError};
use crate::iso::Iso;
use crate::kernel::Kernel;
use crate::klartext::Klartext;
use crate::library::Library;
use crate::motion::Event;
use crate::siemens::Siemens;
use std::ops::Range;

/// Whether a program goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Flow {
    Going,
    Ended,
}

/// Where an interpreter stands beside its line.
pub(crate) struct Place {
    /// File of a subprogram beside the program; `None` for the program itself.
    pub file: Option<String>,
    /// Calls that led there, the innermost first: line of the call and how often it has run.
    pub calls: Vec<(usize, usize)>,
}

impl Place {
    /// In the file of an index, of which the first is the program itself.
    pub fn new(file: Option<usize>, files: &[String], calls: impl Iterator<Item = (usize, usize)>) -> Self {
        Self { file: file.filter(|file| *file > 0).map(|file| files[file].clone()), calls: calls.collect() }
    }
}

/// Indices around `at` up to the next item at which `ends` holds, on both sides.
pub(crate) fn between<T>(list: &[T], at: usize, ends: impl Fn(&T) -> bool) -> Range<usize> {
    let start = (0..at).rev().find(|i| ends(&list[*i])).map_or(0, |i| i + 1);
    let end = (at + 1..list.len()).find(|i| ends(&list[*i]));
    start..end.unwrap_or(list.len())
}

/// What follows the statements of a language.
pub(crate) trait Interpreter {
    /// Runs one statement.
    fn step(&mut self, kernel: &mut Kernel) -> Result<Flow, Fault>;
    fn place(&self) -> Place;
}

/// A program that runs: an iterator over its events.
///
/// ```
/// use toolroom_program::{Control, EventKind, Run};
/// let run = Run::new("G21 G90 G0 X0 Y0 Z5\nG1 Z-1 F60\nM30\n", &Control::default()).unwrap();
/// let time: f64 = run
///     .filter_map(|event| match event.unwrap().kind {
///         EventKind::Motion(motion) => Some(motion.time),
///         _ => None,
///     })
///     .sum();
/// assert!((time - 6.0).abs() < 1e-12);
/// ```
pub struct Run {
    interpreter: Box<dyn Interpreter + Send>,
    kernel: Kernel,
    dialect: Dialect,
    reason: String,
    steps: u64,
    ended: bool,
}

impl Run {
    /// Begins a program.
    ///
    /// # Errors
    /// [`ProgramError`] where the language is not clear.
    pub fn new(text: &str, control: &Control) -> Result<Self, ProgramError> {
        let (dialect, reason) = match control.dialect {
            Some(dialect) => (dialect, "as given".to_owned()),
            None => Dialect::detect(text, control.extension.as_deref()).map_err(|conflict| {
                let (dialect, line, _) = conflict.second;
                ProgramError::of_line(line, dialect, conflict.to_string())
            })?,
        };
        let library = Library::new(control.library.clone());
        let kernel = Kernel::new(control.clone(), dialect == Dialect::FanucLathe);
        let interpreter: Box<dyn Interpreter + Send> = match dialect {
            Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas | Dialect::LinuxCnc => {
                Box::new(Iso::new(text, dialect, library))
            }
            Dialect::Siemens => Box::new(Siemens::new(text, library)),
            Dialect::Heidenhain => Box::new(Klartext::new(text, library)),
        };
        Ok(Self { interpreter, kernel, dialect, reason, steps: 0, ended: false })
    }

    /// Language and why it was taken.
    pub fn dialect(&self) -> (Dialect, &str) {
        (self.dialect, &self.reason)
    }

    /// Length of a unit of the program, mm: 1 or 25.4. `None` before the program or the control has said it.
    pub fn unit(&self) -> Option<f64> {
        self.kernel.scale
    }

    /// Side of the path on which the last compensation of the radius put the cutter: true is left, as of G41 and RL. `None`
    /// before the first.
    pub fn side(&self) -> Option<bool> {
        self.kernel.side
    }

    /// What was noticed up to now, with its line, from 1; each text once.
    pub fn notes(&self) -> &[(usize, String)] {
        &self.kernel.notes
    }

    /// Position of each axis up to now, mm and degrees; X of a lathe as a diameter. `None` where not known.
    pub fn position(&self) -> [Option<f64>; 9] {
        let diameter = |axis: usize| if self.kernel.lathe && axis == 0 { 2.0 } else { 1.0 };
        std::array::from_fn(|axis| self.kernel.known[axis].then(|| diameter(axis) * self.kernel.at[axis]))
    }

    /// Line of the first step of an axis from a place that only the machine knows: its end has no coordinates.
    pub fn blind_step(&self) -> Option<usize> {
        self.kernel.blind_step
    }

    fn error(&self, fault: Fault) -> ProgramError {
        let place = self.interpreter.place();
        ProgramError {
            file: place.file,
            line: self.kernel.line.max(1),
            column: fault.column.max(1),
            dialect: self.dialect,
            message: fault.message,
            calls: place.calls,
        }
    }
}

impl Iterator for Run {
    type Item = Result<Event, ProgramError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(event) = self.kernel.out.pop_front() {
                return Some(Ok(event));
            }
            if self.ended {
                return None;
            }
            self.steps += 1;
            let step = if self.steps > self.kernel.control.steps {
                let limit = self.kernel.control.steps;
                if self.kernel.loop_line > 0 {
                    self.kernel.line = self.kernel.loop_line;
                }
                Err(Fault::new(format!(
                    "the step limit of {limit} blocks is reached here, perhaps in a loop without end; allow more with --steps"
                )))
            } else {
                self.interpreter.step(&mut self.kernel)
            };
            match step {
                Ok(Flow::Going) => {}
                Ok(Flow::Ended) => self.ended = true,
                Err(fault) => {
                    self.ended = true;
                    self.kernel.out.clear();
                    return Some(Err(self.error(fault)));
                }
            }
        }
    }
}
