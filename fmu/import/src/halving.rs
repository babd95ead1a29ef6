//! An event located in a step by halving it.
//!
//! The worker runs the tries and the program follows them by what they answered, so that both have to agree on where the next
//! try ends: they share this.

/// Share of a step to which an event is located (about the rounding of its time).
const EVENT_TIME: f64 = 1e-13;

/// Where in a step that holds an event it happens.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Halving {
    length: f64,
    /// Longest try without event, s.
    quiet: f64,
    /// Shortest try with one, s.
    loud: f64,
    last: Option<f64>,
}

impl Halving {
    /// In a step of `length` seconds, which holds an event.
    pub fn of(length: f64) -> Self {
        Self { length, quiet: 0.0, loud: length, last: None }
    }

    /// Length of the next try from the start of the step, s; none where the last one ended at the event.
    pub fn next(&self) -> Option<f64> {
        if self.loud - self.quiet > EVENT_TIME * self.length {
            return Some(0.5 * (self.quiet + self.loud));
        }
        (self.last != Some(self.loud)).then_some(self.loud)
    }

    /// A try of `length` seconds held an event or not.
    pub fn tried(&mut self, length: f64, event: bool) {
        if length != self.loud {
            *(if event { &mut self.loud } else { &mut self.quiet }) = length;
        }
        self.last = Some(length);
    }

    /// When the event happens, s from the start of the step.
    pub fn found(&self) -> f64 {
        self.loud
    }
}

/// The first of the flags, 1 or 0, that is up now and was not before.
pub(crate) fn risen(before: &[u8], now: &[f64]) -> Option<usize> {
    before.iter().zip(now).position(|(before, now)| *before == 0 && *now != 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_try_ends_at_the_event() {
        for event in [1e-9, 0.3, 0.5, 0.75, 7.0 - 1e-9, 7.0] {
            let (mut halving, mut last, mut tries) = (Halving::of(7.0), 0.0, 0);
            while let Some(length) = halving.next() {
                halving.tried(length, length >= event);
                (last, tries) = (length, tries + 1);
            }
            assert_eq!(last, halving.found());
            assert!(last >= event && last - event <= 1e-12 && tries < 50, "{event} {last} {tries}");
        }
    }
}
