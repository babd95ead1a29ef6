//! The instants at which a cut becomes unstable, and stable again.
//!
//! A verdict jumps, so that an integration that meets it at its stages only steps over a stretch that lies between two of
//! them. Between two instants of one [`RoundedVerdict::cell`] only the limit itself moves, with the wear of the edge: there the
//! verdict changes once at most. All cells that a cut passes are looked at one by one, so that no stretch is too short.
//!
//! Where one cell follows the other with nothing between, and neither has its limit among the loads of that time, the verdict
//! stays, and nobody needs to know where the one ends and the other begins. But how far an unstable cut swings, and so how fast
//! it wears its edge, jumps from cell to cell: an integration that is to be as exact as it says ends its steps there.

/// A verdict, and what it was rounded to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct RoundedVerdict<K> {
    /// The rounded quantities on which the limit depends; none out of cut.
    pub cell: Option<K>,
    /// Whether the cut is unstable.
    pub unstable: bool,
    /// What the cut is loaded with: depth times coefficient, in the unit of the limits.
    pub load: f64,
    /// Loads at which the verdict of the cell changes.
    pub limits: [f64; 2],
}

impl<K> RoundedVerdict<K> {
    /// Out of cut, where nothing vibrates.
    pub const QUIET: Self = Self { cell: None, unstable: false, load: 0.0, limits: [f64::INFINITY; 2] };
}

/// Rounded quantities.
pub(crate) trait Cell: PartialEq {
    /// Whether one quantity alone differs, by one step: no cell lies between.
    fn is_beside(&self, other: &Self) -> bool;
}

/// Whether the numbers of steps differ by one altogether.
pub(crate) fn one_step<const N: usize>(these: [i64; N], others: [i64; N]) -> bool {
    these.into_iter().zip(others).map(|(a, b)| a.abs_diff(b)).fold(0, u64::saturating_add) == 1
}

/// Relative distance from a limit within which a load may lie on either side of it by rounding.
const ROUNDING: f64 = 1e-9;

/// Share of the time that is searched to which an instant is found: some nanoseconds of a pass.
const RESOLUTION: f64 = 1e-11;

/// What ends a stretch of a cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ends {
    /// Another verdict than that of its start, which is unstable or not.
    Verdict { unstable: bool },
    /// Of an unstable stretch: another cell than that of its start, or a stable cut.
    UnstableCell,
}

/// First instant after `start`, at most `end` (s), at which a cut is no longer what it is at `start`, as `ends` says. At the
/// instant itself it has changed already. `judge` gives the verdict of an instant; that at `start` counts as
/// unstable or not as `ends` has it, whatever it gives.
///
/// Quantities of a cell that go back within the time that is searched may hide a cell; over a step of an integration they go
/// one way but for the process damping of an edge that is nearly sharp, which has one flat minimum.
pub(crate) fn first_switch<K: Cell>(
    start: f64,
    end: f64,
    ends: Ends,
    judge: impl Fn(f64) -> RoundedVerdict<K>,
) -> Option<f64> {
    let first = judge(start);
    let search = Search { least: RESOLUTION * (end - start), ends, cell: &first.cell, judge: &judge };
    search.between((start, &first), (end, &judge(end)))
}

struct Search<'a, K, F> {
    least: f64,
    ends: Ends,
    /// That of the start.
    cell: &'a Option<K>,
    judge: &'a F,
}

impl<K: Cell, F: Fn(f64) -> RoundedVerdict<K>> Search<'_, K, F> {
    fn between(
        &self,
        (start, first): (f64, &RoundedVerdict<K>),
        (end, last): (f64, &RoundedVerdict<K>),
    ) -> Option<f64> {
        let switched = match self.ends {
            Ends::Verdict { unstable } => last.unstable != unstable,
            Ends::UnstableCell => !last.unstable || last.cell != *self.cell,
        };
        if !switched && (first.cell == last.cell || stays(first, last)) {
            return None;
        }
        let middle = 0.5 * (start + end);
        if end - start <= self.least || middle <= start || middle >= end {
            return switched.then_some(end);
        }
        let judged = (self.judge)(middle);
        let before = self.between((start, first), (middle, &judged));
        before.or_else(|| self.between((middle, &judged), (end, last)))
    }
}

/// Whether the verdicts of two cells that follow each other cannot change on the way from `first` to `last`.
fn stays<K: Cell>(first: &RoundedVerdict<K>, last: &RoundedVerdict<K>) -> bool {
    let (Some(cell), Some(next)) = (&first.cell, &last.cell) else { return false };
    let (least, greatest) = (first.load.min(last.load), first.load.max(last.load));
    let met = |limit: &f64| *limit >= least * (1.0 - ROUNDING) && *limit <= greatest * (1.0 + ROUNDING);
    cell.is_beside(next) && !first.limits.iter().chain(&last.limits).any(met)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::cell::Cell as Counter;

    impl Cell for usize {
        fn is_beside(&self, other: &Self) -> bool {
            self.abs_diff(*other) == 1
        }
    }

    /// Cells of a tenth whose limits rise from one to the next; the load grows with the time.
    fn judged(time: f64, limits: &[f64]) -> RoundedVerdict<usize> {
        let cell = ((10.0 * time) as usize).min(limits.len() - 1);
        RoundedVerdict { cell: Some(cell), unstable: time > limits[cell], load: time, limits: [limits[cell]; 2] }
    }

    #[test]
    fn a_stretch_just_before_a_cell_ends_is_found() {
        // Unstable from 0.2999999 to 0.3, where the next cell has a greater limit.
        let limits = [9.0, 9.0, 0.299_999_9, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0];
        let found = first_switch(0.0, 1.0, Ends::Verdict { unstable: false }, |time| judged(time, &limits)).unwrap();
        assert!((found - 0.299_999_9).abs() < 1e-10, "{found}");
        // And just behind the beginning of a cell, where the load falls.
        let falling = |time: f64| judged(1.0 - time, &[0.0, 0.0, 0.0, 0.0, 0.499_999_9, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let found = first_switch(0.0, 1.0, Ends::Verdict { unstable: true }, falling);
        assert!((found.unwrap() - 0.500_000_1).abs() < 1e-10, "{found:?}");
    }

    #[test]
    fn an_unstable_stretch_ends_where_its_cell_ends_or_before_where_it_becomes_stable() {
        let found = |start, limits: &[f64]| first_switch(start, 1.0, Ends::UnstableCell, |time| judged(time, limits));
        assert!((found(0.23, &[0.0; 10]).unwrap() - 0.3).abs() < 1e-10);
        assert_eq!(found(0.93, &[0.0; 10]), None);
        let falling = |time: f64| judged(1.0 - time, &[0.52; 10]);
        let found = first_switch(0.41, 1.0, Ends::UnstableCell, falling).unwrap();
        assert!((found - 0.48).abs() < 1e-10, "{found}");
    }

    #[test]
    fn ends_of_cells_without_a_switch_are_not_narrowed_down() {
        let asked = Counter::new(0);
        let judge = |time| {
            asked.set(asked.get() + 1);
            judged(time, &[9.0; 10])
        };
        assert_eq!(first_switch(0.0, 1.0, Ends::Verdict { unstable: false }, judge), None);
        assert!(asked.get() < 40, "{}", asked.get());
    }

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
                let unstable = if cell == 0 { begins } else { unstable[cell] };
                RoundedVerdict { cell: Some(cell), unstable, load: 1.0, limits: [if unstable { 0.0 } else { 2.0 }; 2] }
            };
            let expected = (1..ends.len()).find(|cell| unstable[*cell] != begins).map(|cell| ends[cell - 1]);
            let found = first_switch(0.0, 1.0, Ends::Verdict { unstable: begins }, judge);
            prop_assert_eq!(found.is_some(), expected.is_some());
            if let (Some(found), Some(expected)) = (found, expected) {
                prop_assert!((found - expected).abs() < 1e-10 && judge(found).unstable != begins);
            }
        }
    }
}
