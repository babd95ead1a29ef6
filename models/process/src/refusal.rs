//! Refusals of equations, which give numbers and no results.
//!
//! Equations are written once over any number type and hand out plain numbers. Where one of them meets a value with which no
//! model may go on, it notes the refusal here ([`refuse`]), and whoever drives the model asks whether one was noted while it
//! did so ([`watched`]). Notes belong to the thread on which the equation is evaluated, so work that is watched may not
//! spread over several threads.

use crate::ModelError;
use std::cell::RefCell;

/// What is noted on a thread.
struct Notes {
    /// Watches that are open, one within the other.
    open: u32,
    /// The first refusal since the innermost one was opened.
    first: Option<ModelError>,
}

thread_local! {
    static NOTES: RefCell<Notes> = const { RefCell::new(Notes { open: 0, first: None }) };
}

/// A watch, closed when it goes out of scope, even by a panic.
struct Watch {
    /// The first refusal that the watch around it had noted before.
    earlier: Option<ModelError>,
}

impl Watch {
    fn open() -> Self {
        NOTES.with_borrow_mut(|notes| {
            notes.open += 1;
            Self { earlier: notes.first.take() }
        })
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        NOTES.with_borrow_mut(|notes| {
            notes.open -= 1;
            let within = notes.first.take();
            notes.first = self.earlier.take().or(within).filter(|_| notes.open > 0);
        });
    }
}

/// Notes that an equation has met a value with which no model may go on. The first refusal counts; where nobody watches,
/// none is noted.
pub fn refuse(refusal: impl FnOnce() -> ModelError) {
    let is_first = NOTES.with_borrow(|notes| notes.open > 0 && notes.first.is_none());
    if is_first {
        let refusal = refusal();
        NOTES.with_borrow_mut(|notes| notes.first = Some(refusal));
    }
}

/// Does `work` and hands out its value, or the first refusal that an equation has noted on the way. A watch around this one
/// learns of the refusal as well, whatever becomes of the result.
///
/// # Errors
/// What an equation has refused.
///
/// ```
/// use toolroom_process::{ModelError, refuse, watched};
/// let root = |x: f64| {
///     if x < 0.0 {
///         refuse(|| ModelError::NoSolution { quantity: "root", reason: "the number is negative" });
///     }
///     x.sqrt()
/// };
/// assert_eq!(watched(|| root(4.0)), Ok(2.0));
/// assert!(watched(|| root(-4.0)).is_err());
/// assert_eq!(watched(|| root(9.0)), Ok(3.0));
/// ```
pub fn watched<T>(work: impl FnOnce() -> T) -> Result<T, ModelError> {
    let watch = Watch::open();
    let value = work();
    let refusal = NOTES.with_borrow(|notes| notes.first.clone());
    drop(watch);
    refusal.map_or(Ok(value), Err)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noted(reason: &'static str) {
        refuse(|| ModelError::NoSolution { quantity: "test", reason });
    }

    fn reason(found: Result<(), ModelError>) -> &'static str {
        match found {
            Err(ModelError::NoSolution { reason, .. }) => reason,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_first_refusal_counts_and_a_watch_around_learns_of_it() {
        assert_eq!(reason(watched(|| ["first", "second"].into_iter().for_each(noted))), "first");
        let around = watched(|| {
            // Whoever drops the result does not hide it from the watch around.
            let _ = watched(|| noted("within"));
            assert_eq!(watched(|| 1), Ok(1));
            noted("later");
        });
        assert_eq!(reason(around), "within");
    }

    #[test]
    fn nothing_is_noted_where_nobody_watches_or_where_work_has_panicked() {
        noted("unwatched");
        assert_eq!(watched(|| ()), Ok(()));
        let panicked = std::panic::catch_unwind(|| {
            watched(|| {
                noted("before the panic");
                panic!("on purpose");
            })
        });
        assert!(panicked.is_err());
        assert_eq!(watched(|| ()), Ok(()));
        noted("unwatched");
        assert_eq!(watched(|| ()), Ok(()));
    }
}
