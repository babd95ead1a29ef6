use super::heap::Heap;
use super::{KernelError, SimTime};

/// Order of events within one instant, earliest first.
///
/// The rule: what ends frees a machine before anything moves, moves before arrivals, arrivals
/// before a change of shift; only then machines choose, and observers see the settled instant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub enum Class {
    /// An operation, setup or repair ends, or a machine or tool fails.
    Finish = 0,
    /// A part reaches the next machine or leaves.
    Move = 1,
    /// A job or material enters the shop.
    Arrive = 2,
    /// A shift begins or ends.
    Shift = 3,
    /// A request to look at the queues now.
    Dispatch = 4,
    /// A sample, the end of the warm-up, a log entry: changes nothing.
    Observe = 5,
}

impl Class {
    const ALL: [Self; 6] = [Self::Finish, Self::Move, Self::Arrive, Self::Shift, Self::Dispatch, Self::Observe];
}

/// Names one scheduled event, also after it has happened or was cancelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct EventKey {
    slot: u32,
    serial: u64,
}

/// Pending events, popped in the order (time, [`Class`], order of scheduling).
///
/// `E` is a small `Copy` value; whatever it refers to lives in the world and is named by an id.
/// A clone is a snapshot: both go on independently and identically.
///
/// A heap orders one packed number per event; the event itself waits in a slot.
///
/// | bits | field | size | what happens at the limit |
/// |---|---|---|---|
/// | 127…65 | time, bit pattern without its zero sign | 63 | – |
/// | 64…62 | class | 3 | six are used |
/// | 61…28 | sequence | 34 | after 1.7e10 events the pending ones are renumbered from zero, in order |
/// | 27…0 | slot | 28 | 2.7e8 events pending at once: [`KernelError::Full`] |
///
/// An [`EventKey`] carries the 64-bit serial number of its event, which does not repeat: a key
/// kept for any length of time never names another event. Cancelling marks the slot; the packed
/// number leaves the heap when it comes up, or when dead ones outnumber live ones.
///
/// # Examples
/// ```
/// use toolroom_kernel::{Calendar, Class, SimTime};
/// let mut calendar = Calendar::new();
/// let failure = calendar.schedule(SimTime::from_seconds(50.0)?, Class::Finish, "failure")?;
/// calendar.schedule(SimTime::from_seconds(60.0)?, Class::Finish, "done")?;
/// assert!(calendar.cancel(failure));
/// assert_eq!(calendar.pop().map(|(time, event)| (time.seconds(), event)), Some((60.0, "done")));
/// # Ok::<(), toolroom_kernel::KernelError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Calendar<E: Copy> {
    heap: Heap,
    slots: Vec<Slot<E>>,
    free: Vec<u32>,
    now: SimTime,
    sequence: u64,
    scheduled: u64,
    dead: usize,
}

#[derive(Debug, Clone, Copy)]
struct Slot<E> {
    serial: u64,
    /// `None` once cancelled, popped or vacant.
    event: Option<E>,
}

pub(super) const SLOT_BITS: u32 = 28;
const SEQUENCE_BITS: u32 = 34;
const CLASS_BITS: u32 = 3;
const TIME_SHIFT: u32 = SLOT_BITS + SEQUENCE_BITS + CLASS_BITS;
pub(super) const SEQUENCE_END: u64 = 1 << SEQUENCE_BITS;
/// Below this many dead entries a clean-up costs more than it saves.
const DEAD_TOLERATED: usize = 64;
const _: () = assert!(TIME_SHIFT + 63 == u128::BITS && Class::ALL.len() <= 1 << CLASS_BITS);

#[inline]
pub(super) fn pack(time: SimTime, class: Class, sequence: u64, slot: u32) -> u128 {
    let order = ((class as u64) << SEQUENCE_BITS | sequence) as u128;
    (time.to_bits() as u128) << TIME_SHIFT | order << SLOT_BITS | slot as u128
}

#[inline]
pub(super) fn time_of(packed: u128) -> SimTime {
    SimTime::from_own_bits((packed >> TIME_SHIFT) as u64)
}

#[inline]
pub(super) fn class_of(packed: u128) -> Class {
    Class::ALL[(packed >> (SLOT_BITS + SEQUENCE_BITS)) as usize & ((1 << CLASS_BITS) - 1)]
}

#[inline]
pub(super) fn slot_of(packed: u128) -> usize {
    packed as usize & ((1 << SLOT_BITS) - 1)
}

impl<E: Copy> Default for Calendar<E> {
    fn default() -> Self {
        Self::new()
    }
}

impl<E: Copy> Calendar<E> {
    /// An empty calendar at time zero.
    #[must_use]
    pub fn new() -> Self {
        Self {
            heap: Heap::default(),
            slots: Vec::new(),
            free: Vec::new(),
            now: SimTime::ZERO,
            sequence: 0,
            scheduled: 0,
            dead: 0,
        }
    }

    /// Time of the last popped event.
    #[inline]
    #[must_use]
    pub fn now(&self) -> SimTime {
        self.now
    }

    /// Number of pending events; cancelled ones do not count.
    #[inline]
    #[must_use]
    pub fn len(&self) -> usize {
        self.heap.len() - self.dead
    }

    /// Whether nothing is pending.
    #[inline]
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Number of events scheduled since the calendar was made.
    #[inline]
    #[must_use]
    pub fn scheduled(&self) -> u64 {
        self.scheduled
    }

    /// Adds an event at `at`, which may be [`Calendar::now`].
    ///
    /// # Errors
    /// [`KernelError::InThePast`] if `at` is before [`Calendar::now`], [`KernelError::Full`] if all
    /// 2^28 slots are taken, by pending events or by cancelled ones that still wait in the heap.
    #[inline]
    pub fn schedule(&mut self, time: SimTime, class: Class, event: E) -> Result<EventKey, KernelError> {
        if time < self.now {
            return Err(KernelError::InThePast { at: time, now: self.now });
        }
        if self.sequence == SEQUENCE_END {
            self.renumber();
        }
        let serial = self.scheduled;
        let occupied = Slot { serial, event: Some(event) };
        let slot = match self.free.pop() {
            Some(slot) => {
                self.slots[slot as usize] = occupied;
                slot
            }
            None if self.slots.len() < 1 << SLOT_BITS => {
                self.slots.push(occupied);
                (self.slots.len() - 1) as u32
            }
            None => return Err(KernelError::Full { pending: self.len() }),
        };
        self.heap.push(pack(time, class, self.sequence, slot));
        self.sequence += 1;
        self.scheduled += 1;
        Ok(EventKey { slot, serial })
    }

    /// Removes a pending event; `false` if it has happened or was cancelled before.
    pub fn cancel(&mut self, key: EventKey) -> bool {
        let Some(slot) = self.slots.get_mut(key.slot as usize) else { return false };
        if slot.serial != key.serial || slot.event.take().is_none() {
            return false;
        }
        self.dead += 1;
        if self.dead > DEAD_TOLERATED && self.dead > self.len() {
            self.sweep();
        } else {
            self.drop_dead_top();
        }
        true
    }

    /// The event named by `key`, if it is still pending.
    #[must_use]
    pub fn pending(&self, key: EventKey) -> Option<E> {
        self.slots.get(key.slot as usize).filter(|slot| slot.serial == key.serial)?.event
    }

    /// Time and class of the earliest event.
    #[inline]
    #[must_use]
    pub fn peek(&self) -> Option<(SimTime, Class)> {
        self.heap.peek().map(|packed| (time_of(packed), class_of(packed)))
    }

    /// Time of the earliest event.
    #[inline]
    #[must_use]
    pub fn peek_time(&self) -> Option<SimTime> {
        self.heap.peek().map(time_of)
    }

    /// Removes the earliest event and sets the clock to its time.
    #[inline]
    pub fn pop(&mut self) -> Option<(SimTime, E)> {
        let packed = self.heap.pop()?;
        let slot = slot_of(packed);
        let event = self.slots[slot].event.take()?; // the top is never dead
        self.free.push(slot as u32);
        self.now = time_of(packed);
        if self.dead > 0 {
            self.drop_dead_top();
        }
        Some((self.now, event))
    }

    /// Removes the earliest event if it is due at `at` and of a class before `class`.
    ///
    /// The building block of "settle every event of one instant, then dispatch": an event that a
    /// handler schedules at `at` is returned too, one that it cancels is not.
    ///
    /// # Examples
    /// ```
    /// use toolroom_kernel::{Calendar, Class, SimTime};
    /// let mut calendar = Calendar::new();
    /// let now = SimTime::from_seconds(5.0)?;
    /// calendar.schedule(now, Class::Observe, "sample")?;
    /// calendar.schedule(now, Class::Finish, "finish")?;
    /// assert_eq!(calendar.pop_before(now, Class::Observe), Some("finish"));
    /// assert_eq!(calendar.pop_before(now, Class::Observe), None);
    /// # Ok::<(), toolroom_kernel::KernelError>(())
    /// ```
    #[inline]
    pub fn pop_before(&mut self, time: SimTime, class: Class) -> Option<E> {
        let packed = self.heap.peek()?;
        // Every key of an earlier time or class is below the first one of (at, class).
        if packed >= pack(time, class, 0, 0) || time_of(packed) != time {
            return None;
        }
        self.pop().map(|(_, event)| event)
    }

    /// Restores "the top is live", on which `peek` and `pop` rely.
    fn drop_dead_top(&mut self) {
        while let Some(packed) = self.heap.peek() {
            let slot = slot_of(packed);
            if self.slots[slot].event.is_some() {
                return;
            }
            self.heap.pop();
            self.free.push(slot as u32);
            self.dead -= 1;
        }
    }

    /// Drops every dead entry: repeated re-planning of far events must not fill the memory.
    fn sweep(&mut self) {
        let (slots, free) = (&self.slots, &mut self.free);
        self.heap.retain(|packed| {
            let slot = slot_of(packed);
            let live = slots[slot].event.is_some();
            if !live {
                free.push(slot as u32);
            }
            live
        });
        self.dead = 0;
    }

    /// Numbers the pending events from zero in their order, so that the sequence never wraps.
    fn renumber(&mut self) {
        let packed = self.heap.sorted();
        let renumbered = packed
            .iter()
            .zip(0..)
            .map(|(&packed, sequence)| pack(time_of(packed), class_of(packed), sequence, slot_of(packed) as u32));
        self.heap = Heap::of_sorted(renumbered.collect());
        self.sequence = packed.len() as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: f64) -> SimTime {
        SimTime::from_seconds(seconds).unwrap()
    }

    #[test]
    fn scheduling_in_the_past_is_an_error() {
        let mut calendar = Calendar::new();
        calendar.schedule(at(2.0), Class::Finish, 'a').unwrap();
        calendar.pop();
        let refused = calendar.schedule(at(1.0), Class::Finish, 'b');
        assert_eq!(refused, Err(KernelError::InThePast { at: at(1.0), now: at(2.0) }));
        assert!(calendar.schedule(at(2.0), Class::Finish, 'c').is_ok());
    }

    #[test]
    fn packing_is_lossless_at_the_limits() {
        for time in [SimTime::ZERO, at(1.0 / 3.0), at(f64::MAX)] {
            for class in Class::ALL {
                let packed = pack(time, class, SEQUENCE_END - 1, (1 << SLOT_BITS) - 1);
                assert_eq!((time_of(packed), class_of(packed)), (time, class));
                assert_eq!(slot_of(packed), (1 << SLOT_BITS) - 1);
            }
        }
        assert!(pack(at(1.0), Class::Observe, SEQUENCE_END - 1, u32::MAX >> 4) < pack(at(2.0), Class::Finish, 0, 0));
        assert!(pack(at(1.0), Class::Finish, SEQUENCE_END - 1, u32::MAX >> 4) < pack(at(1.0), Class::Move, 0, 0));
    }

    #[test]
    fn order_survives_the_end_of_the_sequence() {
        let mut calendar = Calendar::new();
        calendar.sequence = SEQUENCE_END - 50;
        // Three instants in turn, so that the heap does not happen to be sorted.
        let instant = |i: u32| i * 7 % 3;
        let mut schedule = |i| calendar.schedule(at(f64::from(instant(i))), Class::Arrive, i).unwrap();
        let keys: Vec<EventKey> = (0..100).map(&mut schedule).collect();
        assert!(calendar.sequence < 200);
        assert!(calendar.cancel(keys[10]) && calendar.cancel(keys[90]));
        let popped: Vec<u32> = std::iter::from_fn(|| calendar.pop()).map(|(_, i)| i).collect();
        let mut expected: Vec<u32> = (0..100).filter(|&i| i != 10 && i != 90).collect();
        expected.sort_by_key(|&i| (instant(i), i));
        assert_eq!(popped, expected);
    }

    #[test]
    fn a_key_never_names_the_next_tenant_of_its_slot() {
        let mut calendar = Calendar::new();
        let first = calendar.schedule(at(1.0), Class::Finish, 1).unwrap();
        calendar.pop();
        let second = calendar.schedule(at(2.0), Class::Finish, 2).unwrap();
        assert_eq!(first.slot, second.slot);
        assert!(!calendar.cancel(first));
        assert_eq!((calendar.pending(first), calendar.pending(second)), (None, Some(2)));
        assert!(calendar.cancel(second) && !calendar.cancel(second));
        assert_eq!((calendar.pop(), calendar.len()), (None, 0));
    }

    #[test]
    fn replanning_far_events_keeps_the_memory_bounded() {
        let mut calendar = Calendar::new();
        calendar.schedule(at(1.0), Class::Observe, 0).unwrap();
        for i in 1..100_000 {
            let key = calendar.schedule(at(1e9), Class::Finish, i).unwrap();
            assert!(calendar.cancel(key));
        }
        assert_eq!(calendar.len(), 1);
        assert!(calendar.slots.len() <= 2 * DEAD_TOLERATED, "{}", calendar.slots.len());
    }
}
