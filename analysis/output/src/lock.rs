//! One process at a time writes into a folder.

use crate::error::OutputError;
use crate::signals::{Begun, Tidy, tidy};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Name of the lock in its folder.
pub const LOCK: &str = ".toolroom.lock";

/// A lock of the operating system on a file that holds the number of the process. The system gives it back when
/// the process dies, however it dies: the file of a dead process keeps nobody out.
#[derive(Debug)]
pub struct Lock {
    _file: File,
    path: PathBuf,
    _tidy: Tidy,
}

impl Lock {
    /// Takes the lock of a folder, or refuses with the process that has it.
    pub fn take(folder: &Path) -> Result<Self, OutputError> {
        Self::from_path(folder, |file| match file.try_lock() {
            Err(TryLockError::WouldBlock) => Ok(false),
            Err(TryLockError::Error(error)) => Err(error),
            Ok(()) => Ok(true),
        })?
        .ok_or_else(|| {
            let holder = fs::read_to_string(folder.join(LOCK)).unwrap_or_default();
            let process = holder.trim().parse::<u32>().map_or_else(|_| String::new(), |id| format!(" (process {id})"));
            let message = format!("another toolroom{process} is writing into {}", folder.display());
            OutputError::refused(message, "wait for it, or choose another place; nothing was changed")
        })
    }

    /// Takes the lock of a folder as soon as nobody has it.
    pub fn wait(folder: &Path) -> Result<Self, OutputError> {
        let locked = Self::from_path(folder, |file| file.lock().map(|()| true))?;
        locked.ok_or_else(|| OutputError::Work { message: format!("{} cannot be locked", folder.display()) })
    }

    fn from_path(folder: &Path, lock: impl Fn(&File) -> std::io::Result<bool>) -> Result<Option<Self>, OutputError> {
        let path = folder.join(LOCK);
        let unwritable = |source| OutputError::Unwritable { path: folder.to_owned(), source };
        let process_id = std::process::id().to_string();
        loop {
            let opened = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(&path);
            let mut file = opened.map_err(unwritable)?;
            match lock(&file) {
                Ok(true) => {}
                Ok(false) => return Ok(None),
                // Some network and virtual file systems have no locks; refusing to write there would help nobody.
                Err(error) if error.kind() == ErrorKind::Unsupported => {}
                Err(error) => return Err(unwritable(error)),
            }
            file.set_len(0).and_then(|()| file.write_all(process_id.as_bytes())).map_err(unwritable)?;
            // The holder before may have removed the file between opening and locking: then this lock is on
            // nothing, and the next one would not see it. Where the system lets nobody read or remove a locked
            // file there is nothing to look for.
            if cfg!(not(unix)) || fs::read_to_string(&path).is_ok_and(|there| there == process_id) {
                let tidy = tidy(Begun::File(path.clone()));
                return Ok(Some(Self { _file: file, path, _tidy: tidy }));
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // A file that stays keeps nobody out.
        let _ = fs::remove_file(&self.path);
    }
}
