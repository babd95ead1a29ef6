//! SIGINT (Ctrl-C) and SIGTERM: drafts and locks are removed, what is kept is said, the program ends. The same happens where the
//! process has more memory than it may.
//!
//! A watcher looks for a signal twenty times a second. Most verbs have nothing that could be finished in two
//! seconds: for them the watcher tidies up and ends the program. A study of a shop has finished replications to
//! write: it holds a [`Gentle`], whose flag the first signal raises; the second one ends the program all the same.

use crate::error::OutputError;
use crate::memory::{resident, shown};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::register_usize;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Time between two looks at the signal.
const LOOK: Duration = Duration::from_millis(50);

/// In place of the number of a signal: more memory than allowed.
const OVER: usize = usize::MAX;

/// The bound is passed by this factor before work that is still being written is given up.
const PATIENCE: f64 = 1.5;

/// The first signal that came, 0 for none.
static RAISED: AtomicUsize = AtomicUsize::new(0);
/// The bound that was passed, bytes.
static LIMIT: AtomicU64 = AtomicU64::new(0);
static STATE: Mutex<State> = Mutex::new(State { begun: Vec::new(), next: 0, kept: None, gentle: None });
/// Held while files take their names: a signal waits for that.
static PUBLISHING: Mutex<()> = Mutex::new(());

struct State {
    /// What to remove, by number.
    begun: Vec<(u64, Begun)>,
    next: u64,
    /// What is reported, and the way on.
    kept: Option<(String, String)>,
    gentle: Option<Arc<AtomicBool>>,
}

/// Something that must not be left behind.
#[derive(Clone, Debug)]
pub enum Begun {
    /// A folder of drafts with everything in it.
    Draft(PathBuf),
    /// A file.
    File(PathBuf),
    /// A folder, where it is empty.
    Folder(PathBuf),
    /// Drafts of this process in a folder of parts, `part-000001.partial-PID`.
    Partials(PathBuf),
}

/// While it lives, a signal removes what was begun.
#[derive(Debug)]
pub struct Tidy(u64);

/// While it lives, the first signal raises a flag and nothing else.
#[derive(Debug)]
pub struct Gentle(());

fn locked<T>(mutex: &'static Mutex<T>) -> MutexGuard<'static, T> {
    // A thread that panicked leaves lists that can be read.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Starts the watcher; `most` is the memory that the process may have, bytes, where it is bounded.
///
/// # Errors
/// The system lets nobody catch signals.
pub fn watch(most: Option<u64>) -> Result<(), OutputError> {
    let signal = Arc::new(AtomicUsize::new(0));
    for number in [SIGINT, SIGTERM] {
        register_usize(number, Arc::clone(&signal), number as usize)
            .map_err(|error| OutputError::Work { message: format!("signals cannot be caught: {error}") })?;
    }
    let look = move || {
        loop {
            std::thread::sleep(LOOK);
            let number = match signal.swap(0, Ordering::SeqCst) {
                0 => match over(most) {
                    // Work that was told to end writes what it has.
                    Some(times) if RAISED.load(Ordering::SeqCst) != OVER || times > PATIENCE => OVER,
                    _ => continue,
                },
                number => number,
            };
            if number == OVER {
                LIMIT.store(most.unwrap_or(0), Ordering::SeqCst);
            }
            let first = RAISED.compare_exchange(0, number, Ordering::SeqCst, Ordering::SeqCst).is_ok();
            match &locked(&STATE).gentle {
                Some(flag) if first => flag.store(true, Ordering::SeqCst),
                _ => break,
            }
        }
        end()
    };
    std::thread::Builder::new()
        .name("signals".to_owned())
        .spawn(look)
        .map(drop)
        .map_err(|error| OutputError::Work { message: format!("signals cannot be caught: {error}") })
}

/// How many times the bound the process has, where it is more than the bound.
fn over(most: Option<u64>) -> Option<f64> {
    let most = most?;
    let has = resident()?;
    (has > most).then(|| has as f64 / most as f64)
}

/// Why the work was ended, where it was for memory: in words, and the way on.
pub fn out_of_memory() -> Option<(String, &'static str)> {
    (RAISED.load(Ordering::SeqCst) == OVER).then(|| {
        let most = shown(LIMIT.load(Ordering::SeqCst));
        (format!("the work needs more than {most} of memory"), "allow more with --max-memory, or make the work smaller")
    })
}

/// Exit code after an interruption: 130 by SIGINT, 143 by SIGTERM, and 1 where no signal came.
pub fn exit_code() -> u8 {
    match RAISED.load(Ordering::SeqCst) {
        0 | OVER => 1,
        number => 128_u8.saturating_add(u8::try_from(number).unwrap_or(0)),
    }
}

/// Sets what a signal from now on tells of what is kept, and how to go on.
pub fn keeps(message: String, help: String) {
    locked(&STATE).kept = Some((message, help));
}

/// Removes `begun` at a signal, as long as the answer lives.
pub fn tidy(begun: Begun) -> Tidy {
    let mut state = locked(&STATE);
    let number = state.next;
    state.next += 1;
    state.begun.push((number, begun));
    Tidy(number)
}

impl Drop for Tidy {
    fn drop(&mut self) {
        locked(&STATE).begun.retain(|(number, _)| *number != self.0);
    }
}

/// Lets the first signal raise `flag`.
pub fn gently(flag: &Arc<AtomicBool>) -> Gentle {
    locked(&STATE).gentle = Some(Arc::clone(flag));
    Gentle(())
}

impl Drop for Gentle {
    fn drop(&mut self) {
        locked(&STATE).gentle = None;
    }
}

/// Lets a signal wait until files have their names.
pub fn publishing() -> MutexGuard<'static, ()> {
    locked(&PUBLISHING)
}

/// Removes what was begun, last things first, tells, ends.
fn end() -> ! {
    let publishing = publishing();
    // Held to the end: a part that another thread began now would leave its draft.
    let _parts = toolroom_shards::nothing_more();
    let state = locked(&STATE);
    for (_, begun) in state.begun.iter().rev() {
        begun.remove();
    }
    let (message, help) = state.kept.clone().unwrap_or_else(|| {
        ("interrupted: no result was written".to_owned(), "the same command starts anew".to_owned())
    });
    let (message, help) = match out_of_memory() {
        Some((reason, way)) => (format!("{reason}; {message}"), format!("{way}; {help}")),
        None => (message, help),
    };
    crate::progress::clear();
    // Where even standard error is gone there is nobody left to tell.
    let _ = writeln!(io::stderr().lock(), "error: {message}\n  help: {help}");
    drop((state, publishing));
    std::process::exit(i32::from(exit_code()))
}

impl Begun {
    fn remove(&self) {
        match self {
            // The work goes on beside this and may put another file there: hence several times. What cannot be
            // removed is told by nobody: the next run removes drafts of dead ones.
            Self::Draft(path) => {
                for _ in 0..20 {
                    if fs::remove_dir_all(path).is_ok() || !path.exists() {
                        break;
                    }
                    std::thread::sleep(Duration::from_millis(5));
                }
            }
            Self::File(path) => drop(fs::remove_file(path)),
            Self::Folder(path) => drop(fs::remove_dir(path)),
            Self::Partials(path) => {
                let partial_name = format!("partial-{}", std::process::id());
                partials(path).filter(|path| path.extension().is_some_and(|end| *end == *partial_name)).for_each(
                    |path| {
                        let _ = fs::remove_file(path);
                    },
                );
            }
        }
    }
}

/// Drafts in a folder of parts, of any process.
pub fn partials(folder: &Path) -> impl Iterator<Item = PathBuf> {
    fs::read_dir(folder).into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path())).filter(|path| {
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        (name.starts_with("part-") || name.starts_with("plan."))
            && name.rsplit_once(".partial-").is_some_and(|(_, process)| process.parse::<u32>().is_ok())
    })
}
