//! The side of the worker.

#![allow(unsafe_code)] // file descriptors

use super::group;
use super::message::{Reply, Request, receive, send, write_reply};
use super::progress::Progress;
use crate::instance::{Answer, CallError, Local};
use crate::unit::Library;
use std::collections::BTreeMap;
use std::io::{self, BufReader, Read};
use std::os::fd::AsFd;
use std::os::unix::net::UnixStream;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

unsafe extern "C" {
    fn dup2(from: i32, to: i32) -> i32;
    fn _exit(code: i32) -> !;
    fn signal(number: i32, handler: usize) -> usize;
}

/// `SIGSEGV` and `SIGBUS`, whose numbers are those of the system.
const FAULTS: [i32; 2] = [11, if cfg!(target_os = "macos") { 10 } else { 7 }];

/// What the system does with a signal by itself: `SIG_DFL`.
const DEFAULT: usize = 0;

/// Serves as a worker until the program ends it.
///
/// Standard output is the stream to the program, standard input is open as long as the program lives. What the unit
/// writes to standard output goes to standard error.
///
/// # Errors
/// A stream that breaks.
pub fn serve() -> io::Result<()> {
    let stream = UnixStream::from(io::stdout().as_fd().try_clone_to_owned()?);
    // SAFETY: both descriptors are open; nobody else has begun to use them.
    if unsafe { dup2(2, 1) } < 0 {
        return Err(io::Error::last_os_error());
    }
    for fault in FAULTS {
        // SAFETY: no handler is set. That of the standard library would speak of an overflow of toolroom's own stack.
        unsafe { signal(fault, DEFAULT) };
    }
    let folder = Arc::new(Mutex::new(None));
    watch(Arc::clone(&folder))?;
    let mut worker = Worker { folder, library: None, progress: None, instances: BTreeMap::new() };
    let (mut reader, mut writer) = (BufReader::new(stream.try_clone()?), stream);
    let mut content = Vec::new();
    while receive(&mut reader, &mut content, 0)? {
        let reply = worker.handle(Request::read(&content)?);
        send(&mut writer, &write_reply(&reply))?;
    }
    Ok(())
}

/// Ends this process when the program dies, and removes the folder that the program cannot remove any more.
fn watch(folder: Arc<Mutex<Option<PathBuf>>>) -> io::Result<()> {
    let wait = move || {
        let mut bytes = [0; 64];
        while io::stdin().read(&mut bytes).is_ok_and(|count| count > 0) {}
        if let Some(folder) = folder.lock().unwrap_or_else(PoisonError::into_inner).as_ref() {
            // The program may be removing it as well.
            let _ = std::fs::remove_dir_all(folder);
        }
        group::end_own();
        // SAFETY: ends the process without running what the unit may have registered.
        unsafe { _exit(1) }
    };
    std::thread::Builder::new().name("program".to_owned()).spawn(wait).map(drop)
}

struct Worker {
    folder: Arc<Mutex<Option<PathBuf>>>,
    library: Option<Arc<Library>>,
    progress: Option<Progress>,
    instances: BTreeMap<u32, Local>,
}

impl Worker {
    fn handle(&mut self, request: Request<'_>) -> Reply {
        let mut answer = Answer::default();
        match request {
            Request::Load { plan, folder, progress } => {
                *self.folder.lock().unwrap_or_else(PoisonError::into_inner) = Some(folder.into());
                let failed = |status| CallError { function: "loading".to_owned(), status, messages: Vec::new() };
                self.progress = Some(Progress::open(Path::new(&progress)).map_err(|error| failed(error.to_string()))?);
                self.library = Some(Library::load(&plan).map_err(failed)?);
            }
            Request::New { number, start_values, start } => {
                let library = self.library.as_ref().ok_or_else(|| unknown(number))?;
                let instance = Local::new(library, &start_values, start, &|call| begin(&self.progress, call))?;
                self.instances.insert(number, instance);
            }
            Request::Act { number, actions } => {
                let instance = self.instances.get_mut(&number).ok_or_else(|| unknown(number))?;
                instance.watched(&actions, &mut answer, &|action| begin(&self.progress, action))?;
            }
            Request::Free { number } => drop(self.instances.remove(&number)),
        }
        Ok(answer)
    }
}

fn begin(progress: &Option<Progress>, call: usize) {
    if let Some(progress) = progress {
        progress.begin(call);
    }
}

fn unknown(number: u32) -> CallError {
    CallError { function: "the worker".to_owned(), status: format!("no instance {number}"), messages: Vec::new() }
}
