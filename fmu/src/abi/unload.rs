//! The end of the library.
//!
//! What is registered by `atexit` belongs to a shared library only where the library was linked with the start files of its C compiler:
//! linked by Zig for older Linux systems it is called when the program ends, where the code no longer is. On Linux the library therefore
//! names what is to be run in its own `.fini_array`, which the loader runs before it takes the code away (System V ABI, Initialization and
//! Termination Functions). On macOS and Windows `atexit` of a library is the library's own.

#[cfg(target_os = "linux")]
mod list {
    use std::sync::OnceLock;

    static REGISTERED: OnceLock<extern "C" fn()> = OnceLock::new();

    extern "C" fn end() {
        if let Some(run) = REGISTERED.get() {
            run();
        }
    }

    #[used]
    // SAFETY: an entry of the list is a function without arguments, which may be called once at the end.
    #[unsafe(link_section = ".fini_array")]
    static ENTRY: extern "C" fn() = end;

    pub(crate) fn at_unload(run: extern "C" fn()) -> bool {
        REGISTERED.get_or_init(|| run);
        true
    }
}

#[cfg(not(target_os = "linux"))]
mod list {
    unsafe extern "C" {
        fn atexit(run: extern "C" fn()) -> i32;
    }

    pub(crate) fn at_unload(run: extern "C" fn()) -> bool {
        // SAFETY: `run` is a function of this library. The C libraries of macOS and Windows tie what a shared library registers to that
        // library, and run it before its code goes.
        unsafe { atexit(run) == 0 }
    }
}

/// Has a function run when the library is unloaded, or the program ends that holds it; false where that cannot be had. There is one such
/// function.
pub(crate) use list::at_unload;
