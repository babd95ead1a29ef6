//! What the codes of a function in data set 58 say: its type, its ordinates and its directions.

use crate::frf::Direction;
use crate::unit::Motion;

/// A function type of data set 58: a signal over time.
pub(super) const TIME: i64 = 1;

/// A function type of data set 58: the spectrum of one signal.
pub(super) const AUTO_SPECTRUM: i64 = 2;

/// A function type of data set 58: the spectrum that two signals share.
pub(super) const CROSS_SPECTRUM: i64 = 3;

/// A function type of data set 58.
pub(super) const RESPONSE: i64 = 4;

/// A function type of data set 58.
pub(super) const COHERENCE: i64 = 6;

/// Ordinate types of data set 58.
pub(super) const FORCE: i64 = 13;

/// What an ordinate type of data set 58 says of a motion.
pub(super) fn motion(ordinate: i64) -> Option<Motion> {
    match ordinate {
        8 => Some(Motion::Displacement),
        11 => Some(Motion::Velocity),
        12 => Some(Motion::Acceleration),
        _ => None,
    }
}

/// The axis of a direction code; none where it leaves the plane.
pub(super) fn direction(code: i64) -> Option<Direction> {
    match code.abs() {
        1 => Some(Direction::X),
        2 => Some(Direction::Y),
        _ => None,
    }
}
