//! Ctrl-C: finish the replications in hand, write what is done, say that it is not all.

use crate::failure::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that the first Ctrl-C raises; the second one ends the program at once.
pub fn on_interrupt() -> Result<Arc<AtomicBool>, Failure> {
    let stop = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        if raised.swap(true, Ordering::SeqCst) {
            std::process::exit(1);
        }
    })
    .map_err(|error| Failure::Work { message: format!("Ctrl-C cannot be caught: {error}") })?;
    Ok(stop)
}
