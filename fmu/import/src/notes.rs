//! What went otherwise than asked without changing a result, and ought to be told.

use crate::keeping::KeepingError;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What is told of a unit.
#[derive(Debug, Default)]
pub(crate) struct Notes {
    /// How often values were read again, and why at first.
    replays: Mutex<Option<(u64, String)>>,
    /// By how much a unit of fixed steps was away from the clock of the shop at most, s.
    left_over: Mutex<f64>,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Notes {
    /// Counts values that were read again after `error`.
    pub fn read_again(&self, error: &KeepingError) {
        locked(&self.replays).get_or_insert_with(|| (0, error.to_string())).0 += 1;
    }

    /// Keeps what a pass left over, s.
    pub fn left_over(&self, seconds: f64) {
        let mut most = locked(&self.left_over);
        *most = most.max(seconds.abs());
    }

    /// The same in words, of the unit at `path`, which takes steps of `grid` seconds only.
    pub fn told(&self, path: &Path, grid: Option<f64>) -> Vec<String> {
        let mut notes = Vec::new();
        if let Some((count, first)) = locked(&self.replays).as_ref() {
            let values = if *count == 1 { "a value".to_owned() } else { format!("{count} values") };
            notes.push(format!(
                "unit {}: {values} between two steps had to be read again, by a new instance at the same state: {first}",
                path.display()
            ));
        }
        if let (Some(grid), most) = (grid, *locked(&self.left_over))
            && most > 0.0
        {
            notes.push(format!(
                "unit {}: it takes steps of {grid} s only; passes ended up to {} s away from the clock of the shop, which the \
                 next ones made up for",
                path.display(),
                (most * 1e6).round() / 1e6
            ));
        }
        notes
    }
}
