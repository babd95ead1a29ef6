//! The process group of a worker: itself and what the unit started.

#![allow(unsafe_code)] // calls of the system

unsafe extern "C" {
    fn kill(process: i32, signal: i32) -> i32;
    fn getpid() -> i32;
    fn getpgrp() -> i32;
}

const KILL: i32 = 9;

/// Ends what is left of the group that the worker `leader` led. No other group has its number as long as one of its
/// processes is alive, and a number that has just become free is not given away again at once.
pub(super) fn end(leader: u32) {
    if let Ok(leader) = i32::try_from(leader) {
        // SAFETY: takes numbers only.
        unsafe { kill(-leader, KILL) };
    }
}

/// Ends this process with its group, where it leads one.
pub(super) fn end_own() {
    // SAFETY: takes and gives numbers only; 0 is the group of this process.
    unsafe {
        if getpid() == getpgrp() {
            kill(0, KILL);
        }
    }
}
