//! The life of a nominal edge under mode 1, from which schedules are taken.

use super::passes::Machining;
use super::{COORDINATES, Draws, Edge};
use crate::study::policy::{Policy, Reading};
use crate::study::{Passes, Study};
use toolroom_scenario::{SensorSheet, SpeedRule};
use toolroom_wear::{Cut, Pair, Scatter, SpeedSchedule};

/// Speed against path as mode 1 chooses it for a nominal edge in these passes and pauses: what a
/// controller without sensors can know. Beyond the nominal life the last speed holds.
///
/// # Examples
/// ```
/// use toolroom_life::study::{Passes, edge::rehearsed};
/// use toolroom_wear::Pair;
/// let pair = Pair::default();
/// let passes = Passes { path: 37.7, pause: 18.0 };
/// let schedule = rehearsed(&pair, &pair.reference_cut(), passes, true);
/// let whole = schedule.entries().last().map(|(path, _)| path).unwrap();
/// assert_eq!((whole / 37.7).round(), 27.0); // 992 m, the last pass begun
/// ```
pub fn rehearsed(pair: &Pair, cut: &Cut, passes: Passes, lagged: bool) -> SpeedSchedule {
    let mut pair = pair.clone();
    pair.chipping.rate = 0.0;
    let sheet = (SensorSheet::default(), Reading::Pass);
    let policy = Policy::new(SpeedRule::Oracle.into(), (&pair, cut), (passes, lagged), 0.0, sheet);
    let study = Study::plain(pair, Scatter::none(), Vec::new(), (passes, lagged));
    let mut draws = Draws::of(0, 0);
    let edge = Edge::of(&study, cut, &[0.5; COORDINATES.len()], &mut draws.wear);
    let mut ramps = Vec::new();
    Machining::new(&study, &study.pair, &edge, &policy, &mut draws, 1).run(|path, ramp| ramps.push((path, *ramp)));
    let (first, last) = (ramps[0].1, ramps[ramps.len() - 1]);
    let starts = ramps.iter().skip(1).map(|(path, ramp)| (*path, ramp.start));
    SpeedSchedule::through(first.start, starts.chain([(last.0 + passes.path, last.1.end)]))
}
