//! What all settings that were tried say together: which the guard lets stand, which is best, where to look next.

use super::field::Field;
use super::trial::{Point, Run};
use toolroom_surface::{Count, Estimates, Shares, Trial};

/// Times that the guard and the best settings within it are worked out from each other.
const ROUNDS: usize = 3;

/// Standard deviations on the safe side of the guard at which settings are placed beside those at one: more replications
/// make the deviation smaller, and may move the edge either way.
const SAFETY: [f64; 2] = [0.0, 2.0];

/// What the points of a field say together.
pub(super) struct Outlook {
    pub estimates: Estimates,
    /// The guards, each with the greatest share that it allows.
    guards: Vec<(Shares, f64)>,
    /// Whether the guard lets a point stand.
    pub admissible: Vec<bool>,
}

/// A way to lose an edge, and the share of edges that may be lost so.
type Guard = (fn(&Run) -> u32, f64);

impl Point {
    /// Edges that were lost in a way, and all of them.
    fn counted(&self, lost: fn(&Run) -> u32) -> (u32, u32) {
        (self.runs.iter().map(lost).sum(), self.runs.iter().map(|run| run.edges).sum())
    }

    /// Share of edges lost in a way.
    pub fn share(&self, lost: fn(&Run) -> u32) -> f64 {
        let (lost, edges) = self.counted(lost);
        f64::from(lost) / f64::from(edges.max(1))
    }
}

impl Field<'_> {
    /// What the points say together.
    pub fn outlook(&self) -> Outlook {
        let request = self.search.request;
        let mut guards: Vec<Guard> = vec![(|run| run.collapsed, request.collapse)];
        if let Some(failure) = request.failure {
            guards.push((|run| run.failed, failure));
        }
        let at = |point: &Point| -> Vec<f64> {
            self.axes.iter().zip(&point.values).map(|(axis, value)| axis.position(*value)).collect()
        };
        let tried =
            |point: &Point| Trial { at: at(point), values: point.runs.iter().map(|run| run.objective).collect() };
        let trials: Vec<Trial> = self.points.iter().map(tried).collect();
        // To begin with, every point stands by its own count.
        let alone = |point: &Point| {
            guards.iter().all(|(lost, limit)| {
                let (share, edges) = (point.share(*lost), f64::from(point.counted(*lost).1.max(1)));
                share + (share * (1.0 - share) / edges).sqrt() <= *limit
            })
        };
        let mut admissible: Vec<bool> = self.points.iter().map(alone).collect();
        let mut estimates = Estimates::among(&trials, &admissible);
        let mut shares = Vec::new();
        for _ in 0..ROUNDS {
            let allowed = |place: &usize| admissible[*place] && estimates.means[*place].is_finite();
            let best = (0..self.points.len())
                .filter(allowed)
                .min_by(|a, b| estimates.means[*a].total_cmp(&estimates.means[*b]));
            let Some(best) = best else { break };
            let of = |(lost, limit): &Guard| {
                let count = |point: &Point| {
                    let (lost, edges) = point.counted(*lost);
                    Count { at: at(point), lost, edges }
                };
                (Shares::from_counts(&self.points.iter().map(count).collect::<Vec<_>>(), best), *limit)
            };
            shares = guards.iter().map(of).collect();
            // Where nothing was lost there is nothing to estimate, however few the edges.
            let stands = |place: usize| {
                let lost = |number: usize| self.points[place].counted(guards[number].0).0;
                shares
                    .iter()
                    .enumerate()
                    .all(|(number, (shares, limit))| lost(number) == 0 || shares.of(place, 1.0) <= *limit)
            };
            let before = std::mem::take(&mut admissible);
            admissible = (0..self.points.len()).map(stands).collect();
            estimates = Estimates::among(&trials, &admissible);
            if admissible == before {
                break;
            }
        }
        Outlook { estimates, guards: shares, admissible }
    }

    /// Admissible points with so many replications, the best first.
    pub fn best(&self, count: usize) -> Vec<usize> {
        let Outlook { estimates, admissible, .. } = self.outlook();
        let known = |place: &usize| self.points[*place].runs.len() >= count && admissible[*place];
        let mut points: Vec<usize> = (0..self.points.len()).filter(known).collect();
        points.sort_by(|&a, &b| estimates.means[a].total_cmp(&estimates.means[b]));
        points
    }
}

impl Outlook {
    /// Whether the guard lets a place stand, by the surfaces through the shares, so many standard deviations on the safe side.
    fn allows(&self, at: &[f64], deviations: f64) -> bool {
        self.guards.iter().all(|(shares, limit)| shares.at(at, deviations).is_none_or(|share| share <= *limit))
    }

    /// Settings at the least of the surface that the guard allows; `None` without a surface or such a place.
    pub fn floor(&self, field: &Field<'_>) -> Option<Vec<f64>> {
        let least = self.estimates.least(|at| self.allows(at, 1.0))?;
        Some(field.axes.iter().zip(&least).map(|(axis, place)| axis.value(*place)).collect())
    }

    /// Settings to try next: a grid of this step around the least of the surface, around the point number `best` where there
    /// is none. Where the guard excludes the least of the surface, the best settings lie at its edge, between two points of any
    /// grid: then the best that it allows along lines through the least that it allows. The flag says that they do.
    pub fn next(&self, field: &Field<'_>, best: usize, step: f64) -> (Vec<Vec<f64>>, bool) {
        let settings = |places: &[Vec<f64>]| -> Vec<Vec<f64>> {
            let of = |at: &Vec<f64>| field.axes.iter().zip(at).map(|(axis, place)| axis.value(*place)).collect();
            places.iter().map(of).collect()
        };
        let home = || {
            let at = field.axes.iter().zip(&field.points[best].values);
            at.map(|(axis, value)| axis.position(*value)).collect::<Vec<f64>>()
        };
        let free = self.estimates.least(|_| true).unwrap_or_else(home);
        if !self.allows(&free, 1.0) {
            return (settings(&self.edge(step)), true);
        }
        let steps: &[f64] = if field.axes.len() == 1 { &[-1.0, -0.5, 0.0, 0.5, 1.0] } else { &[-1.0, 0.0, 1.0] };
        let lists = free.iter().map(|centre| steps.iter().map(|share| centre + share * step).collect::<Vec<f64>>());
        let grid = lists.fold(vec![Vec::new()], |combinations, list| {
            let with =
                |before: &Vec<f64>| list.iter().map(|at| [before.as_slice(), &[*at]].concat()).collect::<Vec<_>>();
            combinations.iter().flat_map(with).collect()
        });
        (settings(&grid), false)
    }

    /// The least that the guard allows, with more and with less on the safe side, and the best places that it allows a step to
    /// either side on every axis.
    fn edge(&self, step: f64) -> Vec<Vec<f64>> {
        let heights = self.estimates.heights();
        let least = |deviations: f64, of: &dyn Fn(&[f64]) -> bool| {
            let allowed = heights.iter().filter(|(at, _)| self.allows(at, deviations) && of(at));
            allowed.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(at, _)| at.clone())
        };
        let Some(centre) = least(1.0, &|_| true) else { return Vec::new() };
        let mut places = vec![centre.clone()];
        places.extend(SAFETY.iter().filter_map(|deviations| least(*deviations, &|_| true)));
        for (axis, side) in (0..centre.len()).flat_map(|axis| [(axis, -step), (axis, step)]) {
            // Places are a fraction of a step apart: the nearest of them.
            let apart = |at: &[f64]| (at[axis] - centre[axis] - side).abs();
            let nearest = heights.iter().map(|(at, _)| apart(at)).fold(f64::INFINITY, f64::min);
            places.extend(least(1.0, &|at| apart(at) <= nearest + 1e-9));
        }
        places
    }
}
