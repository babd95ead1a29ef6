//! Standard output for data, standard error for narration.

use crate::args::Common;
use crate::failure::Failure;
use serde::Serialize;
use std::fmt::Display;
use std::io::{self, ErrorKind, IsTerminal, Write};

/// What the flags of every verb ask for: how much is said, in which form, and what may be replaced.
#[derive(Clone, Copy, Debug)]
pub struct Voice {
    /// Results as JSON.
    pub json: bool,
    /// Whether data may be coloured.
    pub colour: bool,
    /// Whether files of others are replaced.
    pub force: bool,
    quiet: bool,
    verbose: bool,
}

impl Voice {
    pub fn new(common: &Common) -> Self {
        let colour = io::stdout().is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
        Self { json: common.json, colour, force: common.force, quiet: common.quiet, verbose: common.verbose }
    }

    /// Data to standard output. A reader that has seen enough (`| head`) is no failure.
    pub fn data(&self, text: impl Display) -> Result<(), Failure> {
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
        self.data(serde_json::to_string_pretty(value).map_err(Failure::Json)?)
    }

    /// A line about what happens; silent with `--quiet`.
    pub fn say(&self, text: impl Display) {
        if !self.quiet {
            self.error(text);
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
        // Where even standard error is gone there is nobody left to tell.
        let _ = writeln!(io::stderr().lock(), "{text}");
    }

    /// Whether a progress bar would be seen and is wanted.
    pub fn progress(&self) -> bool {
        !self.quiet && io::stderr().is_terminal()
    }
}
