//! Modes that change along the path of the tool.

use crate::error::{ChatterError, within};
use crate::rows::{Row, check_rows, interpolated, mapped};
use crate::structure::{Mode, check_modes};
use crate::verdict::StabilityVerdict;

/// Change of a natural frequency, of a shape over the square root of its mass and of a damping ratio from one judged place
/// to the next (relative): lobes of ten waves move by a fifth of a lobe, limits by a tenth (assumption; with places four
/// times as close, limits of a wall with three stations change by less than 1 %, a test).
const STEP: [f64; 3] = [0.02, 0.05, 0.1];
/// Greatest number of parts into which the way from one station to the next is divided.
const MOST: f64 = 64.0;

/// The modes of a structure at several stations along the path of the tool, each followed from station to station: a thin
/// wall, or a slender part whose support is far from the cut.
///
/// A cut is as stable as it is at its worst place. The stations are judged, and places between them so close that a natural
/// frequency changes by 2 % at most from one to the next. Between two stations the pole of a mode,
/// `−zeta w + i w sqrt(1 − zeta²)`, and its shape `direction/sqrt(mass)` change linearly along the path. What the cut removes
/// on its way can lighten the modes: at a share s of the path the modal masses are `1 − s mass_loss` times those of the
/// stations, at the same stiffness.
///
/// | symbol | unit | range |
/// |---|---|---|
/// | positions | m | ascending, two at least |
/// | modes | | the same number at each station, in the same order |
/// | mass loss | 1 | 0 … 0.9 |
///
/// # Source
/// The worst place decides because a cut that chatters anywhere leaves its marks there. Mass that goes without stiffness is
/// an assumption: it holds where the stock stands at the free end of a wall; where more is removed, tap at several stages.
///
/// # Not modelled
/// A disturbance that grows at one place and has no time to grow before the tool has left it; modes that appear or vanish
/// along the path.
///
/// # Examples
/// ```
/// use toolroom_chatter::{Mode, PathModes};
/// let wall = |k: f64| Mode { direction: [0.0, 1.0], natural_frequency: 900.0, damping_ratio: 0.01, stiffness: k };
/// let path = PathModes::new(vec![(0.0, vec![wall(2e6)]), (0.1, vec![wall(8e6)])], 0.0).unwrap();
/// // The shape changes linearly: 1/sqrt(k) at equal frequencies.
/// let middle = path.at(0.05).unwrap()[0].stiffness;
/// assert!((1.0 / middle.sqrt() - 0.5 * (1.0 / 2e6f64.sqrt() + 1.0 / 8e6f64.sqrt())).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PathModes {
    /// By ascending position (m).
    stations: Vec<Row>,
    /// Share of the modal masses that has gone at the end of the path.
    mass_loss: f64,
}

impl PathModes {
    /// From the modes at each station (m along the path) and the share of the modal masses that has gone at the end.
    ///
    /// # Errors
    /// Fewer than two stations; positions that do not ascend; another number of modes at one of them; a mode that is none; a
    /// share outside 0 … 0.9.
    pub fn new(stations: Vec<(f64, Vec<Mode>)>, mass_loss: f64) -> Result<Self, ChatterError> {
        check_rows(&stations, ["position", "stations with modes", "number of modes at each station"])?;
        within("mass_loss", mass_loss, 0.0, 0.9)?;
        Ok(Self { stations, mass_loss })
    }

    /// First and last position (m).
    pub fn range(&self) -> (f64, f64) {
        (self.stations[0].0, self.stations[self.stations.len() - 1].0)
    }

    /// The modes at a position (m).
    ///
    /// # Errors
    /// [`ChatterError::OutOfRange`] off the path.
    pub fn at(&self, position: f64) -> Result<Vec<Mode>, ChatterError> {
        let (first, last) = self.range();
        within("position along the path", position, first, last)?;
        Ok(self.modes_at(position))
    }

    /// The modes at a position that lies on the path (m).
    fn modes_at(&self, position: f64) -> Vec<Mode> {
        let (first, last) = self.range();
        let mut modes = interpolated(&self.stations, position);
        if self.mass_loss > 0.0 {
            let left = 1.0 - self.mass_loss * (position - first) / (last - first);
            modes.iter_mut().for_each(|mode| mode.natural_frequency /= left.sqrt());
        }
        modes
    }

    /// The places that are judged (m), ascending, with the modes there; a place whose modes are those of the one before is
    /// left out.
    pub fn places(&self) -> Vec<(f64, Vec<Mode>)> {
        self.divided(1)
    }

    /// The places that are judged and, between each two of them, `finer` − 1 more.
    fn divided(&self, finer: usize) -> Vec<(f64, Vec<Mode>)> {
        let mut positions: Vec<f64> = Vec::new();
        for pair in self.stations.windows(2) {
            let (from, to) = (pair[0].0, pair[1].0);
            let (before, after) = (self.modes_at(from), self.modes_at(to));
            let steps = before.iter().zip(&after).map(|(a, b)| steps_between(a, b)).fold(1.0, f64::max);
            let parts = steps.ceil().min(MOST) as usize * finer;
            positions.extend((0..parts).map(|i| from + (to - from) * i as f64 / parts as f64));
        }
        positions.push(self.range().1);
        let mut places: Vec<(f64, Vec<Mode>)> = Vec::with_capacity(positions.len());
        for position in positions {
            let modes = self.modes_at(position);
            if places.last().is_none_or(|(_, before)| *before != modes) {
                places.push((position, modes));
            }
        }
        places
    }

    /// The same stations with other modes, of the number and the mode at each.
    #[must_use]
    pub fn map(&self, other: impl FnMut(usize, &Mode) -> Mode) -> Self {
        Self { stations: mapped(&self.stations, other), mass_loss: self.mass_loss }
    }

    /// The path with one more mode, which is the same at all stations.
    #[must_use]
    pub fn with(mut self, mode: Mode) -> Self {
        self.stations.iter_mut().for_each(|(_, modes)| modes.push(mode));
        self
    }
}

/// Steps of [`STEP`] by which two modes differ.
fn steps_between(a: &Mode, b: &Mode) -> f64 {
    let shape = |mode: &Mode| mode.unit().map(|component| component / mode.mass().sqrt());
    let ([ax, ay], [bx, by]) = (shape(a), shape(b));
    let length = ax.hypot(ay).max(bx.hypot(by));
    // A mode has no sign.
    let turned = (ax - bx).hypot(ay - by).min((ax + bx).hypot(ay + by)) / length;
    let apart = |of: fn(&Mode) -> f64| (of(a) / of(b)).ln().abs();
    let changes = [apart(|mode| mode.natural_frequency), turned, apart(|mode| mode.damping_ratio)];
    changes.iter().zip(STEP).map(|(change, step)| change / step).fold(0.0, f64::max)
}

/// Every mode of a path is one.
pub(crate) fn check_path(path: Option<&PathModes>) -> Result<(), ChatterError> {
    path.map_or(Ok(()), |path| path.stations.iter().try_for_each(|(_, modes)| check_modes(modes)))
}

/// Refuses modes that change with the speed and along the path as well: nobody said how they do both.
pub(crate) fn one_table(by_speed: bool, along_path: bool) -> Result<(), ChatterError> {
    let both = f64::from(u8::from(by_speed && along_path));
    within("modes along the path beside modes by spindle speed", both, 0.0, 0.0).map(drop)
}

/// The verdict of the place at which a disturbance grows most; of equals the unstable one.
pub(crate) fn worst(verdicts: impl IntoIterator<Item = StabilityVerdict>) -> Option<StabilityVerdict> {
    let order = |a: &StabilityVerdict, b: &StabilityVerdict| {
        a.spectral_radius.total_cmp(&b.spectral_radius).then(b.stable.cmp(&a.stable))
    };
    verdicts.into_iter().max_by(order)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Cutter, Direction, Engagement, Milling, MillingForce, Scatter, Turning};
    use std::f64::consts::TAU;

    /// A tool along the feed, and a wall across it whose middle and free end give way.
    fn modes(wall: f64, frequency: f64) -> Vec<Mode> {
        vec![
            Mode { direction: [1.0, 0.0], natural_frequency: 1400.0, damping_ratio: 0.03, stiffness: 2e7 },
            Mode { direction: [0.0, 1.0], natural_frequency: frequency, damping_ratio: 0.015, stiffness: wall },
        ]
    }

    fn wall() -> PathModes {
        let stations = vec![(0.0, modes(9e6, 1250.0)), (0.04, modes(3e6, 900.0)), (0.1, modes(1.2e6, 700.0))];
        PathModes::new(stations, 0.0).unwrap()
    }

    fn mill(path: Option<PathModes>) -> Milling {
        Milling {
            modes: modes(9e6, 1250.0),
            cutter: Cutter::straight(3, 0.012),
            engagement: Engagement::new(0.1, Direction::Down).unwrap(),
            force: MillingForce::new(8e8, 2.6e8),
            feed_per_tooth: 8e-5,
            by_speed: None,
            along_path: path,
        }
    }

    fn rpm(speed: f64) -> f64 {
        speed / 60.0 * TAU
    }

    #[test]
    fn equal_stations_are_the_cut_without_a_path_to_the_last_bit() {
        let same = PathModes::new([0.0, 0.03, 0.1].map(|x| (x, modes(9e6, 1250.0))).to_vec(), 0.0).unwrap();
        let (plain, along) = (mill(None), mill(Some(same.clone())));
        let axis = Axis { start: rpm(6000.0), end: rpm(12000.0), points: 5 };
        let (speeds, depths) = (axis.values("speed").unwrap(), [0.0, 1e-3, 4e-3]);
        assert_eq!(plain.lobes(&speeds, &depths).unwrap(), along.lobes(&speeds, &depths).unwrap());
        assert_eq!(plain.boundary(&axis, 6e-3).unwrap(), along.boundary(&axis, 6e-3).unwrap());
        assert_eq!(plain.forced(speeds[1], 1e-3).unwrap(), along.forced(speeds[1], 1e-3).unwrap());
        assert_eq!(plain.surface_errors(&speeds, &depths).unwrap(), along.surface_errors(&speeds, &depths).unwrap());
        let turned = Turning { process_damping: 1e5, ..Turning::orthogonal(modes(9e6, 1250.0), 1.2e9, 0.05) };
        let turned_along = Turning { along_path: Some(same), ..turned.clone() };
        for speed in &speeds {
            assert_eq!(turned.limit(*speed).unwrap(), turned_along.limit(*speed).unwrap());
            assert_eq!(turned.verdict(*speed, 2e-3).unwrap(), turned_along.verdict(*speed, 2e-3).unwrap());
            assert_eq!(
                turned.stable_intervals(*speed, 0.02).unwrap(),
                turned_along.stable_intervals(*speed, 0.02).unwrap()
            );
        }
        assert_eq!(turned.lobe_chart(&speeds, &depths).unwrap(), turned_along.lobe_chart(&speeds, &depths).unwrap());
        assert_eq!(turned.absolute_limit().unwrap(), turned_along.absolute_limit().unwrap());
    }

    /// Limit, verdict, chart, intervals and probability are those of the worst of the places, each judged by itself.
    #[test]
    fn a_cut_is_as_stable_as_at_its_worst_place() {
        let along = mill(Some(wall()));
        let places: Vec<Milling> = along.places().into_iter().map(|(_, cut)| cut).collect();
        assert!(places.len() > 25 && places.len() < 50, "{}", places.len());
        for speed in [5200.0, 7000.0, 9100.0].map(rpm) {
            let limits: Vec<f64> =
                places.iter().map(|cut| cut.at_speed(speed).unwrap().limit(0.02).unwrap().depth).collect();
            let least = limits.iter().copied().fold(f64::INFINITY, f64::min);
            let mut at_speed = along.at_speed(speed).unwrap();
            let limit = at_speed.limit(0.02).unwrap();
            assert!((limit.depth / least - 1.0).abs() < 1e-8, "{speed}: {limit:?} {limits:?}");
            let worst = at_speed.worst_position(limit.depth).unwrap().unwrap();
            let number = limits.iter().position(|limit| *limit == least).unwrap();
            assert_eq!(along.places()[number].0, Some(worst));
            for depth in [0.5e-3, 1.5e-3, 4e-3] {
                let radius =
                    places.iter().map(|cut| cut.verdict(speed, depth).unwrap().spectral_radius).fold(0.0, f64::max);
                let verdict = along.verdict(speed, depth).unwrap();
                assert!((verdict.spectral_radius / radius - 1.0).abs() < 1e-7);
                let stable = at_speed.stable_intervals(0.02).unwrap().is_stable(depth);
                assert_eq!(stable, verdict.stable);
                assert_eq!(along.lobes(&[speed], &[depth]).unwrap().verdicts[0].unwrap().stable, verdict.stable);
            }
            // The middle station alone would promise more.
            let middle = Milling { modes: modes(3e6, 900.0), ..mill(None) };
            assert!(middle.at_speed(speed).unwrap().limit(0.05).map_or(true, |limit| limit.depth > 1.02 * least));
        }
        let scatter = Scatter { natural_frequency: 0.0, damping_ratio: 0.0, coefficients: 0.0 };
        let limit = along.at_speed(rpm(7000.0)).unwrap().limit(0.02).unwrap().depth;
        let probable = |depth: f64| along.stability_probability(rpm(7000.0), depth, &scatter, 5, 1).unwrap().value;
        assert_eq!((probable(0.98 * limit), probable(1.02 * limit)), (1.0, 0.0));
    }

    #[test]
    fn places_are_many_enough() {
        let path = wall();
        let of = |modes| Milling { modes, ..mill(None) };
        let least = |finer: usize, speed: f64| {
            let places = path.divided(finer).into_iter();
            places
                .map(|(_, modes)| of(modes).at_speed(speed).unwrap().limit(0.02).unwrap().depth)
                .fold(f64::INFINITY, f64::min)
        };
        for speed in [5200.0, 6100.0, 7000.0, 8300.0, 9100.0].map(rpm) {
            let (few, many) = (least(1, speed), least(4, speed));
            assert!(few >= many * (1.0 - 1e-9) && few < 1.01 * many, "{speed}: {few} {many}");
        }
    }

    #[test]
    fn turning_takes_the_worst_place_and_leaves_it_where_the_part_is_stiff() {
        let bar =
            |k: f64| vec![Mode { direction: [1.0, 0.0], natural_frequency: 400.0, damping_ratio: 0.02, stiffness: k }];
        let path = PathModes::new(vec![(0.0, bar(4e7)), (0.15, bar(5e6)), (0.3, bar(4e7))], 0.0).unwrap();
        let cut = Turning { along_path: Some(path), ..Turning::orthogonal(bar(4e7), 1.5e9, 0.03) };
        let soft = Turning::orthogonal(bar(5e6), 1.5e9, 0.03);
        let speed = rpm(1900.0);
        // One mode of one frequency: the limit goes with the stiffness, and is least in the middle.
        assert!((cut.limit(speed).unwrap().depth / soft.limit(speed).unwrap().depth - 1.0).abs() < 1e-12);
        assert_eq!(cut.worst_position(speed, 1e-3).unwrap(), Some(0.15));
        assert_eq!(cut.verdict(speed, 1e-3).unwrap(), soft.verdict(speed, 1e-3).unwrap());
        assert!(cut.simulate(speed, 0.2e-3, 1e-4, &Default::default()).is_ok());
    }

    /// Mass that goes raises the frequency as `1/sqrt(1 − s mass_loss)` at the same stiffness: at the end of a path of equal
    /// stations the limit is that of the lighter mode.
    #[test]
    fn mass_that_is_removed_raises_the_frequency() {
        let bar = vec![Mode { direction: [1.0, 0.0], natural_frequency: 400.0, damping_ratio: 0.02, stiffness: 5e6 }];
        let path = PathModes::new(vec![(0.0, bar.clone()), (0.2, bar.clone())], 0.36).unwrap();
        // The frequency rises by 25 %, two in each step.
        assert_eq!(path.places().len(), 13);
        assert!((path.at(0.2).unwrap()[0].natural_frequency - 500.0).abs() < 1e-9);
        assert!((path.at(0.1).unwrap()[0].natural_frequency - 400.0 / 0.82f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn paths_that_are_none_are_refused() {
        let row = |x: f64, count: usize| (x, vec![modes(1e6, 900.0)[1]; count]);
        assert!(PathModes::new(vec![row(0.0, 1)], 0.0).is_err());
        assert!(PathModes::new(vec![row(0.1, 1), row(0.0, 1)], 0.0).is_err());
        assert!(PathModes::new(vec![row(0.0, 1), row(0.1, 2)], 0.0).is_err());
        assert!(PathModes::new(vec![row(0.0, 1), row(0.1, 1)], 1.0).is_err());
        let both = crate::SpeedModes::new(vec![(100.0, modes(1e6, 900.0)), (2000.0, modes(1e6, 900.0))]).unwrap();
        let cut = Milling { by_speed: Some(both), ..mill(Some(wall())) };
        assert!(matches!(cut.at_speed(rpm(7000.0)), Err(ChatterError::OutOfRange { .. })));
    }
}
