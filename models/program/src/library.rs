//! Subprograms in files of their own.

use crate::error::Fault;
use std::path::PathBuf;
use toolroom_pages::Source;

/// Greatest size of a file of a subprogram, bytes (assumption).
const LARGEST: u64 = 50_000_000;
/// Greatest number of files that one program reads: a bound against programs without end (assumption).
const FILES: usize = 1000;

/// A name that two places of a text begin, with their lines.
pub(crate) struct Twice(pub String, pub usize, pub usize);

impl Twice {
    /// Fails where there is one: which place a call means differs by control.
    pub fn refuse(twice: Option<Self>, file: &str) -> Result<(), Fault> {
        let Some(Self(name, first, second)) = twice else { return Ok(()) };
        let within = if file.is_empty() { String::new() } else { format!(" of {file}") };
        let message = format!(
            "{name} stands in line {first} and again in line {second}{within}: controls keep one of a name; rename one of them"
        );
        Err(if file.is_empty() { Fault::new(message).in_line(second) } else { Fault::new(message) })
    }
}

/// The folder beside a program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Library {
    folder: Option<PathBuf>,
    read: usize,
}

impl Library {
    pub fn new(folder: Option<PathBuf>) -> Self {
        Self { folder, read: 0 }
    }

    /// The first file of the names with one of the endings, as a text.
    pub fn find(&mut self, names: &[String], endings: &[&str]) -> Option<(String, Source)> {
        let folder = self.folder.as_ref()?;
        if self.read >= FILES {
            return None;
        }
        for name in names {
            // A name leads to no other folder.
            if name.is_empty() || name.contains(['/', '\\']) || name.contains("..") {
                continue;
            }
            for ending in endings {
                let file = format!("{name}{ending}");
                let path = folder.join(&file);
                let fits = std::fs::metadata(&path).is_ok_and(|data| data.is_file() && data.len() <= LARGEST);
                if let Some(text) = fits.then(|| Source::open(&path).ok()).flatten() {
                    self.read += 1;
                    return Some((file, text));
                }
            }
        }
        None
    }
}
