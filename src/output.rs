//! The directory of results: complete or not there.

use crate::failure::Failure;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A directory that is filled under another name and takes its own when it is complete, so that
/// nothing half-written can be taken for a result.
#[derive(Debug)]
pub struct OutputDir {
    target: PathBuf,
    draft: PathBuf,
    published: bool,
}

/// What a directory of results always holds.
const MARK: &str = "run.json";

impl OutputDir {
    /// Makes the draft beside `target`, so that an unwritable place is told before any work.
    pub fn create(target: &Path) -> Result<Self, Failure> {
        let unwritable = |source| Failure::Unwritable { path: target.to_owned(), source };
        if target.is_dir() {
            let empty = fs::read_dir(target).map_err(unwritable)?.next().is_none();
            if !empty && !target.join(MARK).is_file() {
                let message = format!("{} holds files that are no results of toolroom", target.display());
                return Err(Failure::argument(message, "choose another directory with --out DIR; nothing was changed"));
            }
        } else if target.exists() {
            return Err(unwritable(io::Error::new(io::ErrorKind::NotADirectory, "it is a file")));
        }
        let name = target.file_name().ok_or_else(|| unwritable(io::Error::from(io::ErrorKind::InvalidFilename)))?;
        let mut draft_name = name.to_owned();
        draft_name.push(format!(".partial-{}", std::process::id()));
        let draft = target.with_file_name(draft_name);
        fs::create_dir_all(&draft).map_err(unwritable)?;
        Ok(Self { target: target.to_owned(), draft, published: false })
    }

    /// Where to write.
    pub fn draft(&self) -> &Path {
        &self.draft
    }

    /// Leaves the draft as it is, under its own name.
    pub fn keep(mut self) -> PathBuf {
        self.published = true;
        self.draft.clone()
    }

    /// Gives the draft its name; earlier results in its place are removed only then.
    pub fn publish(mut self) -> Result<PathBuf, Failure> {
        let unwritable = |source| Failure::Unwritable { path: self.target.clone(), source };
        let mut aside = self.draft.clone().into_os_string();
        aside.push("-old");
        if self.target.exists() {
            fs::rename(&self.target, &aside).map_err(unwritable)?;
        }
        fs::rename(&self.draft, &self.target).map_err(unwritable)?;
        self.published = true;
        if Path::new(&aside).exists() {
            fs::remove_dir_all(&aside).map_err(unwritable)?;
        }
        Ok(self.target.clone())
    }
}

impl Drop for OutputDir {
    fn drop(&mut self) {
        if !self.published {
            // The failure that brought us here is told already.
            let _ = fs::remove_dir_all(&self.draft);
        }
    }
}
