//! Long work beside the interpreter.
//!
//! The work runs on a thread of its own. The calling thread lets go of the interpreter, so that other threads of
//! Python go on, and looks for Ctrl-C twenty times a second.

use crate::failure::Failure;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;
use toolroom::study::study::Progress;

/// Time between two looks for Ctrl-C: shorter than what people feel (assumption).
const LOOK: Duration = Duration::from_millis(50);

/// How far the work is, and whether it is to stop.
#[derive(Default)]
pub struct Pace {
    /// Raised by Ctrl-C.
    pub stop: AtomicBool,
    /// Steps done in the upper half, all steps in the lower.
    steps: AtomicU64,
}

impl Pace {
    /// Tells how far the work is.
    pub fn at(&self, progress: Progress) {
        self.steps.store(u64::from(progress.done) << 32 | u64::from(progress.total), Ordering::Relaxed);
    }

    fn steps(&self) -> (u64, u64) {
        let steps = self.steps.load(Ordering::Relaxed);
        (steps >> 32, steps & u64::from(u32::MAX))
    }
}

/// Does work that ends soon after its flag is raised. `progress` is called with the steps done and all steps.
pub fn gently<T: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    work: impl FnOnce(&Pace) -> Result<T, Failure> + Send,
) -> Result<T, Failure> {
    let pace = Pace::default();
    thread::scope(|scope| {
        let (send, mut done) = channel();
        let pace = &pace;
        scope.spawn(move || drop(send.send(work(pace))));
        let mut raised = None;
        let mut shown = (0, 0);
        loop {
            if let Some(result) = look(py, &mut done)? {
                return raised.map_or(result, |error| Err(Failure::Python(error)));
            }
            let heard = match &progress {
                Some(progress) if raised.is_none() && shown != pace.steps() => {
                    shown = pace.steps();
                    progress.call1(py, shown).map(drop)
                }
                _ => Ok(()),
            };
            if let Err(error) = py.check_signals().and(heard) {
                pace.stop.store(true, Ordering::Relaxed);
                raised.get_or_insert(error);
            }
        }
    })
}

/// Does work that cannot be ended: after Ctrl-C it goes on unseen, and what it yields is dropped.
pub fn through<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> Result<T, Failure> + Send + 'static,
) -> Result<T, Failure> {
    let (send, mut done) = channel();
    thread::spawn(move || drop(send.send(work())));
    loop {
        if let Some(result) = look(py, &mut done)? {
            return result;
        }
        py.check_signals()?;
    }
}

/// The result, where it is there within a moment.
fn look<T: Send>(
    py: Python<'_>,
    done: &mut Receiver<Result<T, Failure>>,
) -> Result<Option<Result<T, Failure>>, Failure> {
    match py.detach(move || done.recv_timeout(LOOK)) {
        Ok(result) => Ok(Some(result)),
        Err(RecvTimeoutError::Timeout) => Ok(None),
        // The thread ended without a result: a broken invariant, which it has told on standard error.
        Err(RecvTimeoutError::Disconnected) => {
            Err(Failure::work("the work ended by a fault of toolroom; please report it"))
        }
    }
}
