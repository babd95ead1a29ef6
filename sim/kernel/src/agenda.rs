//! Pending events that are never cancelled.

use super::calendar::{Class, SEQUENCE_END, class_of, pack, slot_of, time_of};
use super::heap::Heap;
use super::{KernelError, SimTime};

/// Pending events that are small numbers and are never cancelled, popped in the order (time, [`Class`], order of
/// scheduling).
///
/// It is a [`Calendar`](super::Calendar) for those who need less: the packed number has the event itself where that of a
/// calendar names the slot in which its event waits, so that nothing is kept beside the heap.
///
/// # Examples
/// ```
/// use toolroom_kernel::{Agenda, Class, SimTime};
/// let mut agenda = Agenda::default();
/// agenda.schedule(SimTime::from_seconds(60.0)?, Class::Arrive, 7)?;
/// agenda.schedule(SimTime::from_seconds(60.0)?, Class::Finish, 8)?;
/// let now = agenda.peek_time().unwrap();
/// assert_eq!([0; 3].map(|_| agenda.pop_before(now, Class::Observe)), [Some(8), Some(7), None]);
/// assert_eq!(agenda.now(), now);
/// # Ok::<(), toolroom_kernel::KernelError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Agenda {
    heap: Heap,
    now: SimTime,
    sequence: u64,
}

impl Agenda {
    /// Events are numbers below this.
    pub const END: u32 = 1 << super::calendar::SLOT_BITS;

    /// Time of the last popped event.
    #[inline]
    #[must_use]
    pub fn now(&self) -> SimTime {
        self.now
    }

    /// Adds an event, a number below [`Agenda::END`], at `time`, which may be [`Agenda::now`].
    ///
    /// # Errors
    /// [`KernelError::InThePast`] if `time` is before [`Agenda::now`].
    #[inline]
    pub fn schedule(&mut self, time: SimTime, class: Class, event: u32) -> Result<(), KernelError> {
        debug_assert!(event < Self::END);
        if time < self.now {
            return Err(KernelError::InThePast { at: time, now: self.now });
        }
        if self.sequence == SEQUENCE_END {
            self.renumber();
        }
        self.heap.push(pack(time, class, self.sequence, event));
        self.sequence += 1;
        Ok(())
    }

    /// Time of the earliest event.
    #[inline]
    #[must_use]
    pub fn peek_time(&self) -> Option<SimTime> {
        self.heap.peek().map(time_of)
    }

    /// Removes the earliest event if it is due at `time` and of a class before `class`, and sets the clock to its time.
    #[inline]
    pub fn pop_before(&mut self, time: SimTime, class: Class) -> Option<u32> {
        let packed = self.heap.peek()?;
        // Every key of an earlier time or class is below the first one of (time, class).
        if packed >= pack(time, class, 0, 0) || time_of(packed) != time {
            return None;
        }
        self.heap.pop();
        self.now = time;
        Some(slot_of(packed) as u32)
    }

    /// Numbers the pending events from zero in their order, so that the sequence never wraps.
    #[cold]
    fn renumber(&mut self) {
        let sorted = self.heap.sorted();
        self.sequence = sorted.len() as u64;
        let again = |(sequence, &packed): (u64, &u128)| {
            pack(time_of(packed), class_of(packed), sequence, slot_of(packed) as u32)
        };
        self.heap = Heap::of_sorted((0..).zip(&sorted).map(again).collect());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Calendar;

    fn at(seconds: f64) -> SimTime {
        SimTime::from_seconds(seconds).unwrap()
    }

    #[test]
    fn events_come_as_out_of_a_calendar_also_beyond_the_end_of_the_sequence() {
        let (mut agenda, mut calendar) =
            (Agenda { sequence: SEQUENCE_END - 300, ..Agenda::default() }, Calendar::new());
        let mut state = 1u64;
        for step in 0..2000u32 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let (kind, delay) = (state >> 60, f64::from((state >> 40) as u32 & 7));
            if kind < 9 {
                let class = if kind % 2 == 0 { Class::Finish } else { Class::Arrive };
                let time = calendar.now().after(delay).unwrap();
                calendar.schedule(time, class, step).unwrap();
                agenda.schedule(time, class, step).unwrap();
            } else if let Some(now) = calendar.peek_time() {
                assert_eq!(agenda.peek_time(), Some(now));
                assert_eq!(agenda.pop_before(now, Class::Arrive), calendar.pop_before(now, Class::Arrive));
                assert_eq!(agenda.pop_before(now, Class::Observe), calendar.pop_before(now, Class::Observe));
                assert_eq!(agenda.now(), calendar.now());
            }
        }
        assert!(agenda.sequence < 2000);
        assert!(agenda.schedule(at(0.0), Class::Finish, 1).is_err());
    }
}
