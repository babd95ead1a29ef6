//! Open-loop speed schedules.

use crate::{Cut, Pair};

/// Cutting speed against the path that the edge has cut, tabulated on the nominal model: what
/// a controller without sensors can do.
#[derive(Clone, Debug, PartialEq)]
pub struct SpeedSchedule {
    /// Path since the edge was new, m, rising from 0.
    path: Vec<f64>,
    /// Speed there, m/s.
    cutting_speed: Vec<f64>,
}

impl SpeedSchedule {
    /// Tabulates a policy v(h) at `points` (at least 2) states of wear up to the wear limit.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Pair, SpeedSchedule};
    /// let pair = Pair::default();
    /// let cut = pair.reference_cut();
    /// let policy = |h: f64| pair.limits.clip(pair.minimum_wear_speed(&cut, h));
    /// let schedule = SpeedSchedule::tabulate(&pair, policy, &cut, 60);
    /// assert!((schedule.speed_at(0.0) * 60.0 - 80.0).abs() < 1e-9);
    /// assert!(schedule.speed_at(900.0) < schedule.speed_at(300.0));
    /// ```
    pub fn tabulate(pair: &Pair, speed_of_wear: impl Fn(f64) -> f64, cut: &Cut, points: usize) -> Self {
        let points = points.max(2);
        // Finer where the edge is new and the speed falls fast.
        let wear = |i: usize| pair.limits.wear_limit * (i as f64 / (points - 1) as f64).powi(2);
        let mut total = 0.0;
        let mut schedule = Self { path: vec![0.0], cutting_speed: vec![speed_of_wear(0.0)] };
        for i in 1..points {
            let cut_at = |flank_wear: f64| cut.at_speed(speed_of_wear(flank_wear));
            total += pair.life_between(wear(i - 1), wear(i), cut_at).path;
            schedule.path.push(total);
            schedule.cutting_speed.push(speed_of_wear(wear(i)));
        }
        schedule
    }

    /// Starts at a speed and passes through entries (path m, speed m/s) in order of path.
    pub fn through(start_speed: f64, entries: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let (path, cutting_speed) = std::iter::once((0.0, start_speed)).chain(entries).unzip();
        Self { path, cutting_speed }
    }

    /// Speed after `path` metres, m/s; linear between entries, constant beyond them.
    pub fn speed_at(&self, path: f64) -> f64 {
        let above = self.path.partition_point(|each| *each <= path);
        let last = self.path.len() - 1;
        if above == 0 {
            return self.cutting_speed[0];
        }
        if above > last {
            return self.cutting_speed[last];
        }
        let share = (path - self.path[above - 1]) / (self.path[above] - self.path[above - 1]);
        self.cutting_speed[above - 1] + share * (self.cutting_speed[above] - self.cutting_speed[above - 1])
    }

    /// Entries (path m, speed m/s), in order of path.
    pub fn entries(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.path.iter().copied().zip(self.cutting_speed.iter().copied())
    }
}
