//! The calendar against a sorted list under random use.

use proptest::prelude::*;
use toolroom_kernel::{Calendar, Class, EventKey, KernelError, SimTime};

const CLASSES: [Class; 6] = [Class::Finish, Class::Move, Class::Arrive, Class::Shift, Class::Dispatch, Class::Observe];

#[derive(Debug, Clone, Copy)]
enum Action {
    /// Steps of a quarter second: equal times are common.
    Schedule {
        quarters: u8,
        class: usize,
    },
    ScheduleAnywhere {
        seconds: f64,
        class: usize,
    },
    /// Cancels some key that was ever handed out, pending or not.
    Cancel(usize),
    Pop,
    PopBefore(usize),
}

fn action() -> impl Strategy<Value = Action> {
    prop_oneof![
        4 => (0..8u8, 0..6usize).prop_map(|(quarters, class)| Action::Schedule { quarters, class }),
        1 => (0.0..1e6f64, 0..6usize).prop_map(|(seconds, class)| Action::ScheduleAnywhere { seconds, class }),
        2 => any::<prop::sample::Index>().prop_map(|i| Action::Cancel(i.index(1 << 20))),
        2 => Just(Action::Pop),
        1 => (0..6usize).prop_map(Action::PopBefore),
    ]
}

/// A list that is sorted by (time, class, number) whenever it is read.
#[derive(Clone, Default)]
struct Reference {
    pending: Vec<(f64, usize, usize)>,
    now: f64,
    scheduled: usize,
}

impl Reference {
    fn first(&self) -> Option<(f64, usize, usize)> {
        self.pending.iter().copied().min_by(|a, b| a.partial_cmp(b).unwrap())
    }

    fn take(&mut self, entry: (f64, usize, usize)) -> usize {
        self.pending.retain(|&pending| pending != entry);
        self.now = entry.0;
        entry.2
    }
}

#[derive(Clone, Default)]
struct Both {
    calendar: Calendar<usize>,
    reference: Reference,
    keys: Vec<EventKey>,
}

impl Both {
    fn apply(&mut self, action: Action) {
        let Self { calendar, reference, keys } = self;
        match action {
            Action::Schedule { quarters, class } => {
                self.schedule(self.reference.now + f64::from(quarters) / 4.0, class)
            }
            Action::ScheduleAnywhere { seconds, class } => self.schedule(seconds, class),
            Action::Cancel(i) => {
                if let Some(&key) = keys.get(i % keys.len().max(1)) {
                    let number = i % keys.len();
                    let before = reference.pending.len();
                    reference.pending.retain(|&(_, _, pending)| pending != number);
                    let was_pending = reference.pending.len() < before;
                    assert_eq!(calendar.pending(key), was_pending.then_some(number));
                    assert_eq!(calendar.cancel(key), was_pending);
                }
            }
            Action::Pop => {
                let popped = calendar.pop().map(|(time, number)| (time.seconds(), number));
                let expected = reference.first().map(|entry| (entry.0, reference.take(entry)));
                assert_eq!(popped, expected);
            }
            Action::PopBefore(class) => {
                // At the instant of the earliest event, whatever its class.
                let Some(next) = calendar.peek_time() else { return };
                let popped = calendar.pop_before(next, CLASSES[class]);
                let expected = reference.first().filter(|entry| entry.1 < class).map(|entry| reference.take(entry));
                assert_eq!(popped, expected);
            }
        }
        let first = self.reference.first().map(|(time, class, _)| (time, CLASSES[class]));
        assert_eq!(self.calendar.peek().map(|(time, class)| (time.seconds(), class)), first);
        assert_eq!(self.calendar.len(), self.reference.pending.len());
        assert_eq!(self.calendar.now().seconds(), self.reference.now);
    }

    fn schedule(&mut self, seconds: f64, class: usize) {
        let time = SimTime::from_seconds(seconds).unwrap();
        match self.calendar.schedule(time, CLASSES[class], self.reference.scheduled) {
            Ok(key) => {
                self.keys.push(key);
                self.reference.pending.push((seconds, class, self.reference.scheduled));
                self.reference.scheduled += 1;
            }
            Err(error) => {
                assert!(seconds < self.reference.now);
                assert_eq!(error, KernelError::InThePast { at: time, now: self.calendar.now() });
            }
        }
    }

    fn drain(mut self) -> Vec<usize> {
        std::iter::from_fn(|| self.calendar.pop()).map(|(_, number)| number).collect()
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn order_is_that_of_a_sorted_list(actions in prop::collection::vec(action(), 0..400)) {
        let mut both = Both::default();
        actions.into_iter().for_each(|action| both.apply(action));
        let mut expected = both.reference.pending.clone();
        expected.sort_by(|a, b| a.partial_cmp(b).unwrap());
        prop_assert_eq!(both.drain(), expected.into_iter().map(|entry| entry.2).collect::<Vec<_>>());
    }

    #[test]
    fn a_clone_goes_on_like_the_original(
        before in prop::collection::vec(action(), 0..100),
        after in prop::collection::vec(action(), 0..100),
    ) {
        let mut original = Both::default();
        before.into_iter().for_each(|action| original.apply(action));
        let (mut branch, untouched) = (original.clone(), original.clone());
        after.iter().for_each(|&action| original.apply(action));
        let at_branching = untouched.clone().drain();
        after.iter().for_each(|&action| branch.apply(action));
        prop_assert_eq!(original.drain(), branch.drain());
        prop_assert_eq!(untouched.drain(), at_branching);
    }
}

#[test]
fn an_event_of_another_instant_is_not_popped() {
    let instant = |seconds| SimTime::from_seconds(seconds).unwrap();
    let mut calendar = Calendar::new();
    calendar.schedule(instant(1.0), Class::Finish, 'a').unwrap();
    assert_eq!(calendar.pop_before(instant(2.0), Class::Observe), None);
    assert_eq!(calendar.pop_before(instant(0.5), Class::Observe), None);
    assert_eq!(calendar.pop_before(instant(1.0), Class::Observe), Some('a'));
}
