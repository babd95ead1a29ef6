//! The table of handles of the FMI units, tried in every order that its threads can take.
//!
//! `cargo test --manifest-path fmu/loom/Cargo.toml`

#![cfg(test)]

#[path = "../../src/abi/table.rs"]
mod table;

/// loom's types in the place of the standard library's.
mod sync {
    pub(super) use loom::cell::UnsafeCell;
    pub(super) use loom::sync::Mutex;
    pub(super) use loom::sync::atomic::AtomicU64;
}

use loom::thread;
use std::ops::DerefMut;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use table::{Free, Held, Place, Refusal, Table};

/// What lies in the table. loom refuses a test in which two threads touch it at once, or one without
/// what another did before.
struct Value {
    touched: sync::UnsafeCell<u32>,
    dropped: Arc<AtomicUsize>,
}

impl Drop for Value {
    fn drop(&mut self) {
        self.dropped.fetch_add(1, Ordering::Relaxed);
    }
}

fn value(dropped: &Arc<AtomicUsize>) -> Box<Value> {
    Box::new(Value { touched: sync::UnsafeCell::new(0), dropped: Arc::clone(dropped) })
}

fn touch(held: &mut Held<'_, Value>) -> u32 {
    held.deref_mut().touched.with_mut(|touched| {
        // SAFETY: loom stops the test where this is not so.
        unsafe {
            *touched += 1;
            *touched
        }
    })
}

/// As many places as the tests need.
type Two = Table<Value, 2>;

fn table() -> Arc<Two> {
    let place = || Place { key: sync::AtomicU64::new(0), value: sync::UnsafeCell::new(None) };
    Arc::new(Table { places: [place(), place()], free: sync::Mutex::new(Free::all()) })
}

/// Runs `one` and `other` in threads of their own in every order, with a table that has one value, and
/// hands `after` what they gave, the value's handle and how many values have been dropped.
fn try_all<R: 'static, S: 'static>(
    one: fn(&Two, usize) -> R,
    other: fn(&Two, usize) -> S,
    after: fn(R, S, &Two, usize, usize),
) {
    loom::model(move || {
        let (table, dropped) = (table(), Arc::default());
        let handle = table.keep(value(&dropped)).expect("a free place");
        let (theirs, mine) = (Arc::clone(&table), Arc::clone(&table));
        let one = thread::spawn(move || one(&theirs, handle));
        let other = other(&mine, handle);
        let one = one.join().expect("no panic");
        after(one, other, &table, handle, dropped.load(Ordering::Relaxed));
    });
}

/// One call.
fn call(table: &Two, handle: usize) -> Result<u32, Refusal> {
    table.hold(handle).map(|mut held| touch(&mut held))
}

/// An instance made, called and freed.
fn live(table: &Two) -> usize {
    let dropped = Arc::default();
    let handle = table.keep(value(&dropped)).expect("a free place");
    assert_eq!(call(table, handle), Ok(1), "a fresh value is refused");
    assert_eq!(call(table, handle), Ok(2), "a fresh value is refused");
    assert!(table.release(handle).is_some(), "a fresh value cannot be freed");
    assert_eq!(dropped.load(Ordering::Relaxed), 1);
    handle
}

#[test]
fn null_and_addresses_never_disturb_a_value_that_is_made_meanwhile() {
    loom::model(|| {
        let table = table();
        let theirs = Arc::clone(&table);
        let null = thread::spawn(move || {
            // Both places while they are free, in use and free again.
            for foreign in [0, 1] {
                assert_eq!(call(&theirs, foreign), Err(Refusal::Unusable));
                assert!(theirs.release(foreign).is_none());
            }
        });
        live(&table);
        null.join().expect("no panic");
        assert_eq!(call(&table, 0), Err(Refusal::Unusable));
    });
}

#[test]
fn a_value_is_called_by_one_thread_at_a_time() {
    try_all(call, call, |one, other, table, handle, dropped| {
        let calls = u32::from(one.is_ok()) + u32::from(other.is_ok());
        assert!(calls >= 1, "one of two is let in");
        assert_eq!((call(table, handle), dropped), (Ok(calls + 1), 0), "and what it did is seen");
    });
}

#[test]
fn a_value_is_freed_once() {
    let free = |table: &Two, handle| table.release(handle).is_some();
    try_all(free, free, |one, other, table, handle, dropped| {
        assert!(one != other, "{one} and {other}");
        assert_eq!((call(table, handle), dropped), (Err(Refusal::Unusable), 1));
    });
}

#[test]
fn a_value_is_not_freed_under_a_call() {
    let free = |table: &Two, handle| table.release(handle).is_some();
    try_all(call, free, |called, freed, table, handle, dropped| {
        assert!(called.is_ok() || freed, "neither did anything");
        assert_eq!(dropped, usize::from(freed));
        assert_eq!(call(table, handle).is_err(), freed);
    });
}

#[test]
fn a_freed_handle_does_not_reach_what_comes_after_it() {
    let use_after_free = |table: &Two, handle| {
        // In the middle of this the place is freed and used again.
        let calls = [call(table, handle), call(table, handle)];
        (calls, table.release(handle).is_some())
    };
    let replace = |table: &Two, handle| {
        let freed = table.release(handle).is_some();
        (freed, live(table))
    };
    try_all(use_after_free, replace, |(calls, freed), (freed_before, next), table, handle, _| {
        assert!(handle != next);
        assert!(!(freed && freed_before));
        assert!(calls[0].is_ok() || calls[1].is_err(), "freed, and alive again");
        assert_eq!(call(table, next), Err(Refusal::Unusable));
    });
}

#[test]
fn a_handle_that_is_guessed_finds_a_whole_value_or_none() {
    loom::model(|| {
        let (table, dropped) = (table(), Arc::default());
        // What the first value of every table gets.
        let guess = (1 << 47) * 2;
        let theirs = Arc::clone(&table);
        let guessing = thread::spawn(move || call(&theirs, guess).is_ok());
        let handle = table.keep(value(&dropped)).expect("a free place");
        let guessed = guessing.join().expect("no panic");
        assert_eq!((handle, call(&table, handle)), (guess, Ok(1 + u32::from(guessed))));
    });
}

#[test]
fn a_stopped_value_stays_stopped_and_can_be_freed() {
    let stop = |table: &Two, handle| table.hold(handle).map(|mut held| held.stop());
    try_all(stop, call, |stopped, called, table, handle, _| {
        assert!(stopped.is_ok() || called.is_ok());
        let expected = if stopped.is_ok() { Err(Refusal::Stopped) } else { Ok(2) };
        assert_eq!(call(table, handle), expected);
        assert!(table.release(handle).is_some());
        assert_eq!(call(table, handle), Err(Refusal::Unusable));
    });
}

#[test]
fn two_threads_that_make_values_get_places_of_their_own_and_a_full_table_gives_none() {
    loom::model(|| {
        let (table, dropped) = (table(), Arc::default());
        let (theirs, drops) = (Arc::clone(&table), Arc::clone(&dropped));
        let thread = thread::spawn(move || theirs.keep(value(&drops)));
        let one = table.keep(value(&dropped)).expect("a free place");
        let other = thread.join().expect("no panic").expect("a free place");
        assert!(one != other && table.keep(value(&dropped)).is_none());
        assert_eq!(call(&table, one), Ok(1));
        assert_eq!(call(&table, other), Ok(1));
        assert!(table.release(one).is_some());
        let next = table.keep(value(&dropped)).expect("the place is free again");
        assert!(next != one && call(&table, next) == Ok(1) && call(&table, one).is_err());
    });
}
