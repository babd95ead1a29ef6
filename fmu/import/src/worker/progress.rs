//! How far a worker came, in memory that it shares with the program: what remains when it hangs or dies.

#![allow(unsafe_code)] // memory of two processes

use memmap2::MmapMut;
use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};

/// A counter in a file that both processes map.
pub(super) struct Progress(MmapMut);

impl Progress {
    /// Makes the file.
    pub fn create(path: &Path) -> io::Result<Self> {
        let file = File::options().read(true).write(true).create(true).truncate(true).open(path)?;
        file.set_len(size_of::<u64>() as u64)?;
        Self::map(&file)
    }

    /// Opens the file that the program made.
    pub fn open(path: &Path) -> io::Result<Self> {
        Self::map(&File::options().read(true).write(true).open(path)?)
    }

    fn map(file: &File) -> io::Result<Self> {
        // SAFETY: the file lies in the program's own temporary folder; its bytes are used as an atomic only.
        let memory = unsafe { MmapMut::map_mut(file) }?;
        if memory.len() < size_of::<u64>() { Err(io::ErrorKind::UnexpectedEof.into()) } else { Ok(Self(memory)) }
    }

    fn counter(&self) -> &AtomicU64 {
        // SAFETY: a mapping begins at a page, is at least as long as checked above, and lives as long as `self`.
        unsafe { &*self.0.as_ptr().cast::<AtomicU64>() }
    }

    /// That action `action` of a request begins. Every call changes the counter.
    pub fn begin(&self, action: usize) {
        let count = (self.counter().load(Ordering::Relaxed) >> 32).wrapping_add(1);
        self.counter().store(count << 32 | action as u64, Ordering::Release);
    }

    /// The counter: it has changed where anything was begun since the last look. The lower half is the action.
    pub fn look(&self) -> u64 {
        self.counter().load(Ordering::Acquire)
    }
}
