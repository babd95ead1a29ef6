//! Runs of a shop that are counted while they go on, and that may be given up.

use std::sync::atomic::{AtomicBool, Ordering};
use toolroom_shop::{Recorder, Shop, ShopError};

/// How far a study is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Runs (a policy in a replication) that are done.
    pub done: u32,
    /// Runs in all.
    pub total: u32,
}

/// Runs a shop to its horizon; `None` where `stop` is set on the way.
///
/// # Errors
/// [`ShopError`]: the shop stopped.
pub fn unless_stopped<R: Recorder>(shop: Shop<'_, R>, stop: &AtomicBool) -> Result<Option<R>, ShopError> {
    shop.run_while(|| !stop.load(Ordering::Relaxed))
}
