//! Runs of a shop that are counted while they go on, and that may be given up.

use std::sync::atomic::{AtomicBool, Ordering};
use toolroom_kernel::SimTime;
use toolroom_shop::{Recorder, Shop, ShopError};

/// How far a study is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Runs (a policy in a replication) that are done.
    pub done: u32,
    /// Runs in all.
    pub total: u32,
}

/// Pieces of a run between which it looks whether it is still wanted.
const LOOKS: u32 = 256;

/// Runs a shop to its horizon (s); `None` where `stop` is set on the way. Stopping between events at any time changes
/// nothing of a run that goes on.
///
/// # Errors
/// [`ShopError`]: the shop stopped.
pub fn unless_stopped<R: Recorder>(
    mut shop: Shop<'_, R>,
    horizon: f64,
    stop: &AtomicBool,
) -> Result<Option<R>, ShopError> {
    for look in 1..LOOKS {
        if stop.load(Ordering::Relaxed) {
            return Ok(None);
        }
        shop.run_until(SimTime::from_seconds(horizon * f64::from(look) / f64::from(LOOKS))?)?;
    }
    shop.run().map(Some)
}
