//! A heap of packed numbers, the least on top.
//!
//! Each knot has four below it, which stand side by side in memory, so that a number sinks through half as many levels as in
//! a binary heap. The place of the number that was popped last stays open until it is known whether another one comes: whoever
//! handles an event mostly schedules the next one, which then sinks from the top, and nothing is moved twice.

/// Knots below a knot.
const BRANCHES: usize = 4;

/// Numbers of which no two are equal, the least on top.
#[derive(Debug, Clone)]
pub(super) struct Heap {
    /// None before the one above it; the first one means nothing while `open`.
    numbers: Vec<u128>,
    /// Whether the place on top is open.
    open: bool,
    /// The least number, [`NONE`] where there is none.
    least: u128,
}

/// What no number is: those of a calendar have a time before the greatest bits.
const NONE: u128 = u128::MAX;

impl Default for Heap {
    fn default() -> Self {
        Self::of_sorted(Vec::new())
    }
}

impl Heap {
    /// A heap of numbers in ascending order.
    pub fn of_sorted(numbers: Vec<u128>) -> Self {
        Self { least: numbers.first().copied().unwrap_or(NONE), numbers, open: false }
    }

    /// Number of numbers.
    #[inline]
    pub fn len(&self) -> usize {
        self.numbers.len() - usize::from(self.open)
    }

    /// The least number.
    #[inline]
    pub fn peek(&self) -> Option<u128> {
        if self.least == NONE { None } else { Some(self.least) }
    }

    /// Adds a number.
    #[inline]
    pub fn push(&mut self, number: u128) {
        self.least = self.least.min(number);
        if self.open {
            self.open = false;
            self.sink(0, number);
        } else {
            let mut knot = self.numbers.len();
            self.numbers.push(number);
            while knot > 0 {
                let above = (knot - 1) / BRANCHES;
                if self.numbers[above] < number {
                    break;
                }
                self.numbers[knot] = self.numbers[above];
                knot = above;
            }
            self.numbers[knot] = number;
        }
    }

    /// Takes out the least number.
    #[inline]
    pub fn pop(&mut self) -> Option<u128> {
        self.close();
        let least = self.peek()?;
        self.open = true;
        self.least = match self.numbers.as_slice() {
            [_, a, b, c, d, ..] => (*a.min(b)).min(*c.min(d)),
            few => few.iter().skip(1).copied().min().unwrap_or(NONE),
        };
        Some(least)
    }

    /// Fills the place on top.
    #[inline]
    fn close(&mut self) {
        if self.open {
            self.open = false;
            if let Some(last) = self.numbers.pop().filter(|_| !self.numbers.is_empty()) {
                self.sink(0, last);
            }
        }
    }

    /// Puts a number in a place, or where it belongs below it.
    #[inline]
    fn sink(&mut self, mut knot: usize, number: u128) {
        let numbers = self.numbers.as_mut_slice();
        loop {
            let first = BRANCHES * knot + 1;
            let least = if let Some(&[a, b, c, d]) = numbers.get(first..first + BRANCHES) {
                let (left, l) = if b < a { (first + 1, b) } else { (first, a) };
                let (right, r) = if d < c { (first + 3, d) } else { (first + 2, c) };
                if r < l { right } else { left }
            } else {
                let Some(least) = (first..numbers.len()).min_by_key(|below| numbers[*below]) else { break };
                least
            };
            if number < numbers[least] {
                break;
            }
            numbers[knot] = numbers[least];
            knot = least;
        }
        numbers[knot] = number;
    }

    /// Keeps the numbers for which a condition holds.
    pub fn retain(&mut self, mut keeps: impl FnMut(u128) -> bool) {
        self.close();
        self.numbers.retain(|number| keeps(*number));
        for knot in (0..self.numbers.len().div_ceil(BRANCHES)).rev() {
            self.sink(knot, self.numbers[knot]);
        }
        self.least = self.numbers.first().copied().unwrap_or(NONE);
    }

    /// All numbers in ascending order.
    pub fn sorted(&self) -> Vec<u128> {
        let mut numbers = self.numbers[usize::from(self.open)..].to_vec();
        numbers.sort_unstable();
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn numbers_leave_in_order_whatever_comes_between() {
        let (mut heap, mut set, mut state) = (Heap::default(), BTreeSet::new(), 1u64);
        for step in 0..20_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let (number, growing) = (u128::from(state >> 40) << 20 | step, step % 4000 < 2000);
            match state >> 33 & 7 {
                0..=3 => {
                    heap.push(number);
                    set.insert(number);
                }
                4 if !growing => {
                    heap.retain(|number| number % 16 != 0);
                    set.retain(|number| number % 16 != 0);
                }
                _ if growing && state >> 36 & 1 == 0 => {}
                _ => assert_eq!(heap.pop(), set.pop_first()),
            }
            assert_eq!((heap.len(), heap.peek()), (set.len(), set.first().copied()), "step {step}");
        }
        assert_eq!(heap.sorted(), set.into_iter().collect::<Vec<_>>());
    }
}
