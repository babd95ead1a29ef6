//! Standard output for data, standard error for narration.

use crate::args::Common;
use crate::failure::Failure;
use serde::Serialize;
use std::fmt::Display;
use std::io::{self, ErrorKind, IsTerminal, Write};
use std::sync::atomic::{AtomicBool, Ordering};
use toolroom_output::{bounded, fitted, memory, progress};

/// What the flags of every verb ask for: how much is said, in which form, and what may be replaced.
#[derive(Clone, Copy, Debug)]
pub struct Voice {
    /// Results as JSON.
    pub json: bool,
    /// Whether data may be coloured.
    pub colour: bool,
    /// Whether files of others are replaced.
    pub force: bool,
    /// Columns of the terminal into which tables have to fit; none for files, pipes and `--wide`.
    pub width: Option<usize>,
    /// Memory that the command may have, bytes; none where the system does not tell its own.
    pub max_memory: Option<u64>,
    /// Whether everything is told, however long.
    pub verbose: bool,
    quiet: bool,
}

/// Whether anything was written to standard output.
static SPOKEN: AtomicBool = AtomicBool::new(false);

impl Voice {
    pub fn new(common: &Common) -> Self {
        let colour = io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        let width = if common.wide { None } else { columns() };
        let max_memory = common.max_memory.or_else(memory::default_bound);
        let Common { json, force, quiet, verbose, .. } = *common;
        Self { json, colour, force, width, max_memory, quiet, verbose }
    }

    /// The same, with results for people.
    pub fn for_people(&self) -> Self {
        Self { json: false, ..*self }
    }

    /// Whether data were written.
    pub fn has_spoken(&self) -> bool {
        SPOKEN.load(Ordering::Relaxed)
    }

    /// Data for people to standard output, wrapped to the terminal.
    pub fn data(&self, text: impl Display) -> Result<(), Failure> {
        match self.width {
            Some(width) => self.raw(fitted(&text.to_string(), width)),
            None => self.raw(text),
        }
    }

    /// Data to standard output as they are. A reader that has seen enough (`| head`) is no failure.
    pub fn raw(&self, text: impl Display) -> Result<(), Failure> {
        SPOKEN.store(true, Ordering::Relaxed);
        progress::clear();
        let mut out = io::stdout().lock();
        match writeln!(out, "{text}").and_then(|()| out.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => {
                Err(Failure::Unwritable { path: "standard output".into(), source: error })
            }
            _ => Ok(()),
        }
    }

    /// A result as JSON, indented.
    pub fn json(&self, value: &impl Serialize) -> Result<(), Failure> {
        self.raw(serde_json::to_string_pretty(value).map_err(Failure::Json)?)
    }

    /// A line about what happens; silent with `--quiet`.
    pub fn say(&self, text: impl Display) {
        if !self.quiet {
            match self.width {
                Some(width) => self.error(fitted(&text.to_string(), width)),
                None => self.error(text),
            }
        }
    }

    /// A line that only `--verbose` wants.
    pub fn detail(&self, text: impl Display) {
        if self.verbose {
            self.error(text);
        }
    }

    /// A line that is always said.
    pub fn error(&self, text: impl Display) {
        progress::clear();
        // Where even standard error is gone there is nobody left to tell.
        let _ = writeln!(io::stderr().lock(), "{}", bounded(&text.to_string()));
    }

    /// Whether a progress bar would be seen and is wanted.
    pub fn progress(&self) -> bool {
        !self.quiet && io::stderr().is_terminal()
    }
}

/// Columns of the terminal of standard output, where it is one.
fn columns() -> Option<usize> {
    let (terminal_size::Width(columns), _) = terminal_size::terminal_size_of(io::stdout())?;
    Some(usize::from(columns))
}
