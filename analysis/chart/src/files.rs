//! The files of a result, before anybody has written them.

use std::path::Path;
use std::{fs, io};

/// Named contents, in the order in which they were pushed: tables, JSON, pictures, part programs, the report.
///
/// A study hands them out; whoever runs the study writes them into a folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ResultFiles(Vec<(String, Vec<u8>)>);

impl ResultFiles {
    /// Adds a file. `name` is a plain file name; `contents` are text or bytes.
    pub fn push(&mut self, name: impl Into<String>, contents: impl Into<Vec<u8>>) {
        self.0.push((name.into(), contents.into()));
    }

    /// Every file: its name and its contents.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.0.iter().map(|(name, contents)| (name.as_str(), contents.as_slice()))
    }

    /// Writes every file into `folder`, which has to exist; a file of the same name is replaced.
    ///
    /// # Errors
    /// The first file that cannot be written.
    pub fn write(&self, folder: &Path) -> io::Result<()> {
        self.iter().try_for_each(|(name, contents)| fs::write(folder.join(name), contents))
    }
}
