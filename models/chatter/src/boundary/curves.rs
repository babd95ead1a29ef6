//! The boundary of a chart as curves: the ends of stable intervals joined from speed to speed.

use super::{Boundary, BoundaryColumn, Crossing};
use crate::verdict::ChatterKind;

/// A connected piece of the boundary.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BoundaryCurve {
    /// How the cut becomes unstable along most of it.
    pub kind: ChatterKind,
    /// Whether it encloses an island of instability or a stable pocket; otherwise it leaves the chart.
    pub closed: bool,
    /// Speed (rad/s), depth (m) and frequency of the vibration (Hz) along the curve.
    pub points: Vec<[f64; 3]>,
}

/// Neighbours of an end: the one at lower speed and the one at higher speed, where the curve folds the other end of
/// the same column.
type Links = [Option<usize>; 2];

const LEFT: usize = 0;
const RIGHT: usize = 1;

impl Boundary {
    /// The curves of the boundary. Ends of one column are joined with those of the next in their order, at least change
    /// of depth; two neighbouring ends that the next column lacks are joined with each other, where the curve folds.
    pub fn curves(&self) -> Vec<BoundaryCurve> {
        let mut first = Vec::with_capacity(self.columns.len());
        let mut nodes = Vec::new();
        for (column, BoundaryColumn { crossings, .. }) in self.columns.iter().enumerate() {
            first.push(nodes.len());
            nodes.extend(crossings.iter().map(|end| (column, end)));
        }
        let mut links: Vec<Links> = vec![[None; 2]; nodes.len()];
        for (i, pair) in self.columns.windows(2).enumerate() {
            if self.holes.iter().any(|hole| hole.speed > pair[0].speed && hole.speed < pair[1].speed) {
                continue;
            }
            let (a, b) = (first[i], first[i + 1]);
            for joint in joints(&pair[0].crossings, &pair[1].crossings, self.greatest) {
                let (from, to) = match joint {
                    Joint::Across(j, k) => ((a + j, RIGHT), (b + k, LEFT)),
                    Joint::FoldBefore(j) => ((a + j, RIGHT), (a + j + 1, RIGHT)),
                    Joint::FoldAfter(k) => ((b + k, LEFT), (b + k + 1, LEFT)),
                };
                links[from.0][from.1] = Some(to.0);
                links[to.0][to.1] = Some(from.0);
            }
        }
        let point = |node: usize| {
            let (column, end): (usize, &Crossing) = nodes[node];
            [self.columns[column].speed, end.limit.depth, end.limit.chatter_frequency]
        };
        let mut visited = vec![false; nodes.len()];
        let mut curves = Vec::new();
        // Open curves begin where a link is missing; what is left then is closed.
        let open = (0..nodes.len()).filter(|node| links[*node].contains(&None));
        for start in open.chain(0..nodes.len()) {
            if visited[start] {
                continue;
            }
            let mut path = vec![start];
            visited[start] = true;
            let mut node = start;
            while let Some(next) = links[node].into_iter().flatten().find(|next| !visited[*next]) {
                visited[next] = true;
                path.push(next);
                node = next;
            }
            let closed = path.len() > 1 && links[node].contains(&Some(start)) && !links[start].contains(&None);
            let flips = path.iter().filter(|node| nodes[**node].1.limit.kind == ChatterKind::Flip).count();
            let kind = if 2 * flips > path.len() { ChatterKind::Flip } else { ChatterKind::Hopf };
            let mut points: Vec<[f64; 3]> = path.into_iter().map(point).collect();
            if closed {
                points.push(points[0]);
            }
            curves.push(BoundaryCurve { kind, closed, points });
        }
        curves
    }
}

/// How ends of two neighbouring columns belong together.
#[derive(Clone, Copy)]
enum Joint {
    /// End j of the first column continues in end k of the second.
    Across(usize, usize),
    /// Ends j and j + 1 of the first column meet before the second.
    FoldBefore(usize),
    /// Ends k and k + 1 of the second column part after the first.
    FoldAfter(usize),
}

/// The joints of least cost: the change of depth across, the distance of two ends that meet, and for the uppermost end
/// that leaves the chart its distance from the greatest depth.
fn joints(a: &[Crossing], b: &[Crossing], greatest: f64) -> Vec<Joint> {
    let depth = |ends: &[Crossing], i: usize| ends[i].limit.depth;
    let width = b.len() + 1;
    let place = |i: usize, j: usize| i * width + j;
    // From the uppermost ends down: least cost of the ends from i and j on, and the step that it takes.
    let mut cost = vec![f64::INFINITY; (a.len() + 1) * width];
    let mut step: Vec<Option<(Option<Joint>, usize, usize)>> = vec![None; cost.len()];
    cost[place(a.len(), b.len())] = 0.0;
    for i in (0..=a.len()).rev() {
        for j in (0..=b.len()).rev() {
            let mut consider = |price: f64, joint: Option<Joint>, to: (usize, usize)| {
                let total = price + cost[place(to.0, to.1)];
                if total < cost[place(i, j)] {
                    cost[place(i, j)] = total;
                    step[place(i, j)] = Some((joint, to.0, to.1));
                }
            };
            if i < a.len() && j < b.len() && a[i].becomes_unstable == b[j].becomes_unstable {
                consider((depth(a, i) - depth(b, j)).abs(), Some(Joint::Across(i, j)), (i + 1, j + 1));
            }
            if i + 1 < a.len() {
                consider(depth(a, i + 1) - depth(a, i), Some(Joint::FoldBefore(i)), (i + 2, j));
            }
            if j + 1 < b.len() {
                consider(depth(b, j + 1) - depth(b, j), Some(Joint::FoldAfter(j)), (i, j + 2));
            }
            if i + 1 == a.len() {
                consider(greatest - depth(a, i), None, (i + 1, j));
            }
            if j + 1 == b.len() {
                consider(greatest - depth(b, j), None, (i, j + 1));
            }
        }
    }
    let mut found = Vec::new();
    let (mut i, mut j) = (0, 0);
    while let Some((joint, to_i, to_j)) = step[place(i, j)] {
        found.extend(joint);
        (i, j) = (to_i, to_j);
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Axis, Cutter, Direction, Engagement, Milling, MillingForce, Mode, Turning};
    use std::f64::consts::TAU;

    fn axis(start: f64, end: f64, points: usize) -> Axis {
        Axis { start: start / 60.0 * TAU, end: end / 60.0 * TAU, points }
    }

    #[test]
    fn islands_of_a_helical_cutter_are_closed() {
        let cut = Milling {
            modes: vec![Mode {
                direction: [1.0, 0.0],
                natural_frequency: 922.0,
                damping_ratio: 0.011,
                stiffness: 1.34e6,
            }],
            cutter: Cutter { helix_angle: TAU / 8.0, ..Cutter::straight(2, 8e-3) },
            engagement: Engagement::new(0.05, Direction::Down).unwrap(),
            force: MillingForce::new(6e8, 2e8),
            feed_per_tooth: 0.1e-3,
            by_speed: None,
            along_path: None,
        };
        let curves = cut.boundary(&axis(17000.0, 18400.0, 29), 4.5e-3).unwrap().curves();
        let islands: Vec<_> = curves.iter().filter(|curve| curve.closed).collect();
        assert_eq!(islands.len(), 1, "{curves:?}");
        assert_eq!(islands[0].kind, ChatterKind::Flip);
        let extent = |axis: usize, unit: f64| {
            let values = || islands[0].points.iter().map(|point| point[axis] * unit);
            (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max))
        };
        let (slowest, fastest) = extent(0, 60.0 / TAU);
        assert!(
            slowest > 17450.0 && slowest < 17600.0 && fastest > 18150.0 && fastest < 18300.0,
            "{slowest} {fastest}"
        );
        let (least, greatest) = extent(1, 1e3);
        assert!(least > 1.0 && least < 1.4 && greatest > 3.4 && greatest < 4.0, "{least} {greatest}");
    }

    #[test]
    fn every_end_stands_on_one_curve() {
        let mode =
            Mode { direction: [0.81398, 0.5809], natural_frequency: 968.5, damping_ratio: 0.0347, stiffness: 4.917e6 };
        let cut = Turning {
            force_angle: 34.2f64.to_radians(),
            process_damping: 7.69e5,
            ..Turning::orthogonal(vec![mode], 756.2e6, 0.04)
        };
        let boundary = cut.boundary(&axis(3000.0, 9000.0, 121), 8e-3).unwrap();
        let ends: usize = boundary.columns.iter().map(|column| column.crossings.len()).sum();
        let curves = boundary.curves();
        let points: usize = curves.iter().map(|curve| curve.points.len() - usize::from(curve.closed)).sum();
        assert_eq!(ends, points);
        assert!(curves.len() < 20, "{}", curves.len());
        for curve in &curves {
            for pair in curve.points.windows(2) {
                assert!((pair[0][1] - pair[1][1]).abs() < 2e-3, "{pair:?}");
            }
        }
    }
}
