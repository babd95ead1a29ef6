//! Whether a job begins to wait or waits no longer.

/// Whether a job begins to wait or waits no longer.
#[derive(Clone, Copy, Debug)]
pub(super) enum QueueChange {
    Comes,
    Leaves,
}
