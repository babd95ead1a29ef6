//! What channels such as force read along an edge.

use toolroom_wear::Cut;

/// What was read of one channel at the end of each stretch of an edge, with the cut as it was recorded; empty where nothing was
/// read on the whole edge, as in most tables.
pub type ChannelReadings = Vec<Option<(Cut, f64)>>;

/// Keeps nothing of channels of which nothing was read: a stretch without a reading takes as much memory as one with it.
pub(crate) fn forget_unread(loads: &mut [ChannelReadings]) {
    loads.iter_mut().filter(|loads| loads.iter().all(Option::is_none)).for_each(|loads| *loads = Vec::new());
}
