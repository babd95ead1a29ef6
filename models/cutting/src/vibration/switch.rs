//! The instants at which a cut becomes unstable, and stable again.
//!
//! A verdict jumps, so that an integration that meets it at its stages only steps over a stretch that lies between two of
//! them. Between two instants of one [`Judged::cell`] only the limit itself moves, with the wear of the edge: there the
//! verdict changes once at most. All cells that a cut passes are looked at one by one, so that no stretch is too short.

/// A verdict, and what it was rounded to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Judged<K> {
    /// The rounded quantities on which the limit depends; none out of cut.
    pub cell: Option<K>,
    /// Whether the cut is unstable.
    pub unstable: bool,
}

/// Share of the time that is searched to which an instant is found: some nanoseconds of a pass.
const RESOLUTION: f64 = 1e-11;

/// First instant after `from`, at most `to` (s), at which a cut is no longer what it is at `from`: `unstable` or not. At the
/// instant itself the verdict has changed already. `judge` gives the verdict of an instant; that at `from` counts as
/// `unstable` whatever it gives.
///
/// Quantities of a cell that go back within the time that is searched may hide a cell; over a step of an integration they go
/// one way but for the process damping of an edge that is nearly sharp, which has one flat minimum.
pub(crate) fn first_switch<K: PartialEq>(
    from: f64,
    to: f64,
    unstable: bool,
    judge: impl Fn(f64) -> Judged<K>,
) -> Option<f64> {
    let search = Search { least: RESOLUTION * (to - from), unstable, judge: &judge };
    search.between((from, &judge(from).cell), (to, &judge(to)))
}

struct Search<'a, F> {
    least: f64,
    unstable: bool,
    judge: &'a F,
}

impl<F> Search<'_, F> {
    fn between<K: PartialEq>(&self, (start, cell): (f64, &Option<K>), (end, last): (f64, &Judged<K>)) -> Option<f64>
    where
        F: Fn(f64) -> Judged<K>,
    {
        let switched = last.unstable != self.unstable;
        if !switched && *cell == last.cell {
            return None;
        }
        let middle = 0.5 * (start + end);
        if end - start <= self.least || middle <= start || middle >= end {
            return switched.then_some(end);
        }
        let judged = (self.judge)(middle);
        let before = self.between((start, cell), (middle, &judged));
        before.or_else(|| self.between((middle, &judged.cell), (end, last)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_first_of_any_stretches_is_found_however_short(
            widths in prop::collection::vec(1e-6..1.0f64, 1..60),
            unstable in prop::collection::vec(any::<bool>(), 60),
            begins in any::<bool>(),
        ) {
            let mut ends = Vec::new();
            let whole: f64 = widths.iter().sum();
            widths.iter().fold(0.0, |sum, width| { ends.push((sum + width) / whole); sum + width });
            let cell = |time: f64| ends.iter().position(|end| time < *end).unwrap_or(ends.len() - 1);
            let judge = |time: f64| {
                let cell = cell(time);
                Judged { cell: Some(cell), unstable: if cell == 0 { begins } else { unstable[cell] } }
            };
            let expected = (1..ends.len()).find(|cell| unstable[*cell] != begins).map(|cell| ends[cell - 1]);
            let found = first_switch(0.0, 1.0, begins, judge);
            prop_assert_eq!(found.is_some(), expected.is_some());
            if let (Some(found), Some(expected)) = (found, expected) {
                prop_assert!((found - expected).abs() < 1e-10 && judge(found).unstable != begins);
            }
        }
    }
}
