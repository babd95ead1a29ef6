//! All depths at which a cut is stable, at one spindle speed.

use crate::verdict::StabilityLimit;

/// One crossing of the boundary with growing depth.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Crossing {
    /// Depth, kind and frequency.
    pub limit: StabilityLimit,
    /// Whether the cut becomes unstable here rather than stable again.
    pub becomes_unstable: bool,
}

/// How it is known that no end of a stable interval is missing.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Certificate {
    /// Every neutral vibration was isolated by bounds on the derivatives of the characteristic function.
    Proved,
    /// The spindle is so slow that the envelope under all lobes answers, which is at most the limit.
    Envelope,
    /// The spectral radius was sampled; an interval narrower than this depth (m) can be missing if the radius does
    /// not approach one on either side of it.
    Resolution(f64),
}

/// The depths up to a greatest one at which a cut is stable, at one spindle speed.
///
/// A cut can become stable again above its limit and unstable once more, so that limit, verdict, margin, charts and
/// the shop all follow from this one list.
///
/// # Examples
/// ```
/// use toolroom_chatter::{Mode, Turning};
/// let mode = Mode { direction: [0.81398, 0.5809], natural_frequency: 968.5, damping_ratio: 0.0347, stiffness: 4.917e6 };
/// let cut = Turning {
///     force_angle: 34.2f64.to_radians(),
///     process_damping: 7.69e5,
///     ..Turning::orthogonal(vec![mode], 756.2e6, 0.04)
/// };
/// let speed = 4320.58 / 60.0 * std::f64::consts::TAU;
/// let found = cut.stable_intervals(speed, 8e-3).unwrap();
/// // Stable up to 3.408 mm, from 4.361 to 4.760 mm and above 5.796 mm.
/// assert_eq!(found.intervals().len(), 3);
/// assert!(found.is_stable(4.5e-3) && !found.is_stable(5e-3));
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct StableIntervals {
    /// Depths at which stability is lost (first, third …) and regained (second, fourth …), ascending.
    pub ends: Vec<Crossing>,
    /// Greatest depth that was searched (m).
    pub greatest: f64,
    /// Whether ends can be missing.
    pub certificate: Certificate,
}

impl StableIntervals {
    /// The depths at which the cuts of all `lists` are stable.
    pub(crate) fn common(lists: &[Self], greatest: f64) -> Self {
        let mut all: Vec<Crossing> = lists.iter().flat_map(|list| list.ends.iter().copied()).collect();
        all.sort_by(|a, b| a.limit.depth.total_cmp(&b.limit.depth));
        let mut unstable = 0i32;
        let mut ends = Vec::new();
        for end in all {
            let before = unstable;
            unstable += if end.becomes_unstable { 1 } else { -1 };
            if (before > 0) != (unstable > 0) {
                ends.push(end);
            }
        }
        // Each list is as sure as its own certificate; that of the first that is not proved speaks for all.
        let certificate = lists.iter().map(|list| list.certificate).find(|kind| *kind != Certificate::Proved);
        Self { ends, greatest, certificate: certificate.unwrap_or(Certificate::Proved) }
    }

    /// The stable intervals (m), ascending, the first from depth zero, the last up to the greatest depth if the cut
    /// is stable there.
    pub fn intervals(&self) -> Vec<[f64; 2]> {
        let depths = self.ends.iter().map(|end| end.limit.depth);
        let mut bounds: Vec<f64> = std::iter::once(0.0).chain(depths).collect();
        if bounds.len() % 2 == 1 {
            bounds.push(self.greatest);
        }
        bounds.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect()
    }

    /// Whether the cut is stable at `depth` (m), which must not exceed the greatest depth searched.
    pub fn is_stable(&self, depth: f64) -> bool {
        self.ends.partition_point(|end| end.limit.depth <= depth) % 2 == 0
    }

    /// The least unstable depth: the first end.
    pub fn limit(&self) -> Option<StabilityLimit> {
        self.ends.first().map(|end| end.limit)
    }
}
