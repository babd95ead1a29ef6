//! Files that are written under another name and renamed when they are whole.

use crate::ShardError;
use std::fs::{self, File};
use std::io::Write;
use std::path::Path;
use std::sync::{PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};

/// Read while a part is written or a shard is begun, written by whoever ends the process.
static WRITING: RwLock<()> = RwLock::new(());

/// Waits until parts that are being written have their names, and keeps every thread from writing another part or
/// beginning another shard as long as the answer lives: what ends the process can then remove drafts for good.
pub fn nothing_more() -> RwLockWriteGuard<'static, ()> {
    WRITING.write().unwrap_or_else(PoisonError::into_inner)
}

pub(crate) fn writing() -> RwLockReadGuard<'static, ()> {
    WRITING.read().unwrap_or_else(PoisonError::into_inner)
}

/// Writes a file under another name and renames it when it is whole.
pub(crate) fn atomically(path: &Path, bytes: &[u8]) -> Result<(), ShardError> {
    let _writing = writing();
    let draft = path.with_extension(format!("partial-{}", std::process::id()));
    let written = File::create(&draft).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    written.and_then(|()| fs::rename(&draft, path)).map_err(|source| {
        // Why it failed matters more than whether the remains could be removed.
        let _ = fs::remove_file(&draft);
        ShardError::File { path: path.to_owned(), source }
    })
}
