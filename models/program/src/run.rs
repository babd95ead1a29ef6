//! Runs a program: its blocks one by one, as a stream of events in bounded memory.

use crate::control::Control;
use crate::error::{Fault, ProgramError};
use crate::iso::Iso;
use crate::kernel::{FeedMode, Kernel};
use crate::klartext::Klartext;
use crate::library::Library;
use crate::motion::{Event, Sense, plane_code};
use crate::siemens::Siemens;
use std::ops::Range;
use toolroom_dialect::{Detector, Dialect};
use toolroom_pages::Source;

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

/// Statements of a `text` around `at`, between the nearest of `heads`, which are sorted.
pub(crate) fn between(heads: &[usize], at: usize, text: Range<usize>) -> Range<usize> {
    let before = heads.partition_point(|head| *head < at).checked_sub(1).map(|last| heads[last] + 1);
    let behind = heads.get(heads.partition_point(|head| *head <= at)).copied();
    before.unwrap_or(0).max(text.start)..behind.unwrap_or(usize::MAX).min(text.end)
}

/// What follows the statements of a language.
pub(crate) trait Interpreter {
    /// Runs one statement.
    fn step(&mut self, kernel: &mut Kernel) -> Result<Flow, Fault>;
    fn place(&self) -> Place;
    /// Variables that have a value, as the program writes them.
    fn variables(&self) -> Vec<(String, f64)>;
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
    /// Begins a program. A text in a file ([`Source::open`]) stays there: memory does not grow with its lines.
    ///
    /// # Errors
    /// [`ProgramError`] where the language is not clear, or the file cannot be read.
    pub fn new(text: impl Into<Source>, control: &Control) -> Result<Self, ProgramError> {
        let text = &text.into();
        let unreadable = |dialect: Dialect, fault: Fault| ProgramError::of_line(fault.line, dialect, fault.message);
        let (dialect, reason) = match control.dialect {
            Some(dialect) => (dialect, "as given".to_owned()),
            None => Detector::detect(text, control.extension.as_deref())
                .map_err(|error| unreadable(Dialect::Fanuc, error.into()))?
                .map_err(|conflict| {
                    let (dialect, line, _) = conflict.second;
                    ProgramError::of_line(line, dialect, conflict.to_string())
                })?,
        };
        let library = Library::new(control.library.clone());
        let kernel = Kernel::new(control.clone(), dialect == Dialect::FanucLathe);
        let interpreter: Result<Box<dyn Interpreter + Send>, Fault> = match dialect {
            Dialect::Fanuc | Dialect::FanucLathe | Dialect::Haas | Dialect::LinuxCnc => {
                Iso::new(text, dialect, library).map(|iso| Box::new(iso) as _)
            }
            Dialect::Siemens => Siemens::new(text, library).map(|siemens| Box::new(siemens) as _),
            Dialect::Heidenhain => Klartext::new(text, library).map(|klartext| Box::new(klartext) as _),
        };
        let interpreter = interpreter.map_err(|fault| unreadable(dialect, fault))?;
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
        let factors = self.factors();
        std::array::from_fn(|axis| self.kernel.referenced[axis].then(|| factors[axis] * self.kernel.at[axis]))
    }

    /// Factor from each axis of a motion to what the program writes: 2 of X of a lathe, which is a diameter in programs and a
    /// radius in motions, and 1 of all others.
    pub fn factors(&self) -> [f64; 9] {
        std::array::from_fn(|axis| if self.kernel.lathe && axis == 0 { 2.0 } else { 1.0 })
    }

    /// Line of the first step of an axis from a place that only the machine knows: its end has no coordinates.
    pub fn blind_step(&self) -> Option<usize> {
        self.kernel.blind_step
    }

    /// Line of the first change to a work offset of which only some axes are known to the one before: places in it are neither those of
    /// one nor those of the other.
    pub fn partly_known(&self) -> Option<usize> {
        self.kernel.partly_known
    }

    /// Pitch of the last thread, mm, where its cycle names one; it may have a spindle speed of its own then (CYCLE84).
    pub fn pitch(&self) -> Option<f64> {
        self.kernel.pitch
    }

    /// Variables that have a value up to now, as the program writes them, sorted.
    pub fn variables(&self) -> Vec<(String, f64)> {
        self.interpreter.variables()
    }

    /// What holds until it is changed, up to now.
    pub fn modes(&self) -> ModalState {
        let kernel = &self.kernel;
        let plane = plane_code(kernel.plane);
        let Kernel { absolute, feed, feed_mode, speed, sense, tool, .. } = *kernel;
        ModalState {
            absolute,
            plane,
            feed,
            feed_mode,
            speed,
            sense,
            tool,
            surface: kernel.surface,
            exact_stop: kernel.exact,
        }
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
            others: Vec::new(),
        }
    }

    /// Words behind a fault that are refused whatever it left undone, so that all of them can be mended at once. Faults that
    /// may follow from the first one, such as an arc that misses its end, are not told.
    fn further(&mut self, program_error: &ProgramError) -> Vec<ProgramError> {
        let mut list: Vec<ProgramError> = Vec::new();
        let mut left = FURTHER.min(self.kernel.control.steps.saturating_sub(self.steps));
        while left > 0 && list.len() + 1 < ProgramError::MOST {
            self.steps += 1;
            self.kernel.out.clear();
            match self.interpreter.step(&mut self.kernel) {
                Ok(Flow::Going) => {}
                Ok(Flow::Ended) => break,
                Err(fault) => {
                    if fault.refuses {
                        let error = self.error(fault);
                        let here = (&error.file, error.line);
                        if std::iter::once(program_error).chain(&list).all(|known| (&known.file, known.line) != here) {
                            list.push(error);
                        }
                    }
                }
            }
            left = left.saturating_sub(1 + self.kernel.out.len() as u64);
        }
        self.kernel.out.clear();
        list
    }
}

/// What holds in a program until it is changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModalState {
    /// Whether positions are absolute (G90) instead of steps (G91).
    pub absolute: bool,
    /// Number of the G code of the plane: 17, 18 or 19.
    pub plane: usize,
    /// F as it counts, in mm or degrees; `None` before the first.
    pub feed: Option<f64>,
    /// What F counts.
    pub feed_mode: FeedMode,
    /// Speed of the spindle, rpm.
    pub speed: f64,
    /// How the spindle turns.
    pub sense: Sense,
    /// Tool that was called last.
    pub tool: Option<u32>,
    /// Constant surface speed, mm/min.
    pub surface: Option<f64>,
    /// Whether every motion ends at rest.
    pub exact_stop: bool,
}

/// Blocks that are run behind a fault to find others, with the motions that they make: a bound against loops that have lost their end
/// (assumption). A spline makes hundreds.
const FURTHER: u64 = 100_000;

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
                    let mut error = self.error(fault);
                    error.others = self.further(&error);
                    return Some(Err(error));
                }
            }
        }
    }
}
