//! The end of the library.

unsafe extern "C" {
    fn atexit(run: extern "C" fn()) -> i32;
}

/// Has `run` called when the library is unloaded, or the program ends that holds it; false where that cannot be had.
pub(crate) fn at_unload(run: extern "C" fn()) -> bool {
    // SAFETY: `run` is a function of this library. The C libraries of Linux, macOS and Windows tie what a shared
    // library registers to that library, and run it before its code goes.
    unsafe { atexit(run) == 0 }
}
