//! How edges were when their records began.

use crate::edge::Stretch;

/// Share of the wear limit at a first reading beyond which an edge was probably not new when its record began (assumption).
const WORN_ALREADY: f64 = 0.5;

/// Land beyond that of the run-in (mm) that a new edge would have had at time zero at the rate from the first to the second
/// reading (assumption: the run-in of a new edge is over within a tenth of a millimetre).
const RUN_IN: f64 = 0.1;

/// Fall from one reading to the next beyond which another edge was read (mm; assumption: three standard deviations of a reading).
const FALL: f64 = 0.033;

/// How edges were when their records began.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EdgeStart {
    /// New, but for those whose first reading is far above zero: these are unknown.
    #[default]
    Auto,
    /// New.
    New,
    /// Unknown: their first reading is where they start, and nothing is supposed of the wear and the time before.
    Unknown,
}

impl EdgeStart {
    /// Whether nothing is supposed of an edge with these stretches before its first reading; `limit` in mm.
    pub(crate) fn is_unknown(self, stretches: &[Stretch], limit: f64) -> bool {
        match self {
            Self::New => false,
            Self::Unknown => true,
            Self::Auto => worn_already(stretches, limit).is_some(),
        }
    }
}

/// First reading (mm) of an edge that was probably not new when its record began: more than half of the limit (mm), and at the
/// rate from there to the second reading it had a land already when the record began.
pub(crate) fn worn_already(stretches: &[Stretch], limit: f64) -> Option<f64> {
    let (begin, rest) = stretches.split_first()?;
    let first = begin.wear.filter(|first| *first > WORN_ALREADY * limit)?;
    let next = rest.iter().position(|stretch| stretch.wear.is_some())?;
    let (second, time) = (rest[next].wear?, rest[..=next].iter().map(|stretch| stretch.time).sum::<f64>());
    if second < first - FALL {
        return None;
    }
    let rate = if time > 0.0 { ((second - first) / time).max(0.0) } else { 0.0 };
    (first - rate * begin.time > RUN_IN).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edge(readings: &[(f64, f64)]) -> Vec<Stretch> {
        let stretch = |&(time, wear): &(f64, f64)| Stretch { condition: 0, time, wear: Some(wear), block: None };
        readings.iter().map(stretch).collect()
    }

    #[test]
    fn an_edge_that_wears_evenly_is_new_however_late_it_is_read() {
        assert_eq!(worn_already(&edge(&[(10.0, 0.18), (3.0, 0.225)]), 0.3), None);
        assert_eq!(worn_already(&edge(&[(10.0, 0.14), (3.0, 0.15)]), 0.3), None, "below half of the limit");
        assert_eq!(worn_already(&edge(&[(11.2, 0.1615), (11.2, 0.1929)]), 0.3), Some(0.1615));
        assert_eq!(worn_already(&edge(&[(0.0, 0.2), (5.0, 0.25)]), 0.3), Some(0.2), "read before anything was cut");
        assert_eq!(worn_already(&edge(&[(5.0, 0.25)]), 0.3), None, "one reading tells nothing");
        assert_eq!(worn_already(&edge(&[(4.0, 0.2), (4.0, 0.1)]), 0.3), None, "another edge was read");
    }
}
