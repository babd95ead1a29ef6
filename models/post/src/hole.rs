//! Holes, recognised from the motions that a cycle was worked out to.

use toolroom_program::{Event, EventKind, Motion, Path};

/// Distance, mm, and shares of feeds that count as none: the reader rounds nothing.
pub(crate) const LEVEL: f64 = 1e-6;

/// How the tool goes down and comes out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Way {
    /// Down at feed, out at rapid speed.
    Drill,
    /// Down and out at feed.
    Bore,
    /// Down in pecks of this depth, mm, out to the plane where feed begins between them, and again down to so far above the last.
    Pecks { depth: f64, again: f64 },
    /// Down in pecks of this depth, mm, drawn back by so much between them.
    Chips { depth: f64, back: f64 },
}

/// A hole along Z, mm and s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Hole {
    pub way: Way,
    /// Where the tool comes from.
    pub from: f64,
    /// Where feed begins.
    pub reference: f64,
    pub bottom: f64,
    /// Where the tool goes at the end.
    pub level: f64,
    pub dwell: f64,
    /// mm/min.
    pub feed: f64,
}

impl Hole {
    /// The hole that motions and dwells of a cycle make, where it is one of these ways.
    pub fn of(parts: &[(Event, [bool; 9])]) -> Option<Self> {
        let mut motions: Vec<Motion> = Vec::new();
        let mut dwells = Vec::new();
        for (event, _) in parts {
            if let EventKind::Motion(motion) = event.kind {
                motions.push(motion);
            } else if let EventKind::Dwell(seconds) = event.kind {
                dwells.push((motions.len(), seconds));
            } else {
                return None;
            }
        }
        let along = |motion: &Motion| {
            !motion.unknown
                && matches!(motion.path, Path::Line)
                && (0..9).all(|axis| axis == 2 || motion.start[axis] == motion.end[axis])
        };
        if !motions.iter().all(along) {
            return None;
        }
        let (first, last) = (motions.first()?, motions.last()?);
        let (from, level) = (first.start[2], last.end[2]);
        let mut rest = motions.as_slice();
        let mut reference = from;
        if first.rapid {
            (reference, rest) = (first.end[2], &rest[1..]);
        }
        // The last motion down at feed ends at the bottom; a dwell may follow it and nothing else may dwell.
        let deepest = rest.iter().rposition(|motion| !motion.rapid && motion.end[2] < motion.start[2])?;
        let bottom = rest[deepest].end[2];
        let offset = motions.len() - rest.len();
        let dwell = match dwells[..] {
            [] => 0.0,
            [(count, seconds)] if count == offset + deepest + 1 => seconds,
            _ => return None,
        };
        let feed_of = |motion: &Motion| 60.0 * motion.length / motion.time;
        let feed = feed_of(&rest[deepest]);
        let alike = |a: f64, b: f64| (a - b).abs() <= LEVEL;
        let fed = rest.iter().filter(|motion| !motion.rapid);
        if !(reference > bottom && level >= reference - LEVEL && feed > 0.0)
            || fed.clone().any(|motion| (feed_of(motion) / feed - 1.0).abs() > LEVEL)
        {
            return None;
        }
        let (down, out) = rest.split_at(deepest + 1);
        let way = if let [only] = down {
            if !alike(only.start[2], reference) {
                return None;
            }
            match out {
                [up] if up.rapid => Way::Drill,
                [up] if alike(level, reference) && alike(up.end[2], reference) => Way::Bore,
                [up, away] if !up.rapid && away.rapid && alike(up.end[2], reference) => Way::Bore,
                _ => return None,
            }
        } else {
            let [up] = out else { return None };
            if !up.rapid {
                return None;
            }
            pecks(down, reference, bottom)?
        };
        Some(Hole { way, from, reference, bottom, level, dwell, feed })
    }
}

/// Pecks of one depth, where motions down and up between the plane and the bottom are those.
fn pecks(down: &[Motion], reference: f64, bottom: f64) -> Option<Way> {
    let alike = |a: f64, b: f64| (a - b).abs() <= LEVEL;
    let depth = reference - down[0].end[2];
    // Out to the plane and down again in three motions a peck, or back in two.
    let out = alike(down.get(1)?.end[2], reference) && down.get(2)?.rapid;
    let period = if out { 3 } else { 2 };
    let between = if out { down[2].end[2] - down[0].end[2] } else { down[1].end[2] - down[0].end[2] };
    if depth <= LEVEL || between < -LEVEL || down.len() % period != 1 {
        return None;
    }
    for (index, motion) in down.iter().enumerate() {
        let peck = (index / period + 1) as f64;
        let stop = (reference - peck * depth).max(bottom);
        let (rapid, due) = match index % period {
            0 => (false, stop),
            1 if out => (true, reference),
            _ => (true, (stop + between).min(reference)),
        };
        if motion.rapid != rapid || !alike(motion.end[2], due) {
            return None;
        }
    }
    alike(down[down.len() - 1].end[2], bottom).then_some(if out {
        Way::Pecks { depth, again: between }
    } else {
        Way::Chips { depth, back: between }
    })
}
