//! Which tooth cuts when, and whose surface it finds.

use super::Milling;
use super::cutter::square_integrals;
use super::slice::Slice;
use crate::error::ChatterError;
use std::f64::consts::TAU;

/// Angles closer than this are one (rad).
const SAME: f64 = 1e-10;

/// A part of a tooth's way through the work in which it cuts the surface of one earlier tooth.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arc {
    pub from: f64,
    pub to: f64,
    /// Angle by which the earlier tooth is ahead (rad).
    pub delay: f64,
    /// Radius of this tooth over that of the earlier one, by runout (m).
    pub step: f64,
}

/// The cut over one repetition of its geometry, in angles of tooth 0.
#[derive(Clone, Debug)]
pub(crate) struct Geometry {
    /// Angle at which a repetition starts.
    pub origin: f64,
    /// Angle after which everything repeats: a pitch, or a revolution.
    pub span: f64,
    /// Arcs of every tooth with the tooth's angle ahead of tooth 0.
    pub teeth: Vec<(f64, Vec<Arc>)>,
    /// Of a cutter with a corner radius or a taper the slice that each of these teeth is; none of a cylinder.
    pub slices: Vec<Slice>,
    /// Lag angle of the helix over the depth.
    pub lag: f64,
    /// Boundaries between smooth stretches, ascending, from `origin` to `origin + span`.
    pub breaks: Vec<f64>,
}

impl Geometry {
    /// `whole_revolution` keeps a revolution even where a tooth period would do.
    pub fn new(cut: &Milling, depth: f64, whole_revolution: bool) -> Result<Self, ChatterError> {
        if !cut.cutter.is_cylinder() && depth > 0.0 {
            return Ok(Self::sliced(cut, depth, whole_revolution));
        }
        let cutter = &cut.cutter;
        let regular = cutter.is_regular();
        let span = if regular && !whole_revolution { TAU / cutter.teeth as f64 } else { TAU };
        let offsets = cutter.offsets();
        let teeth: Vec<_> = (0..cutter.teeth).map(|j| (offsets[j], arcs(cut, j))).collect();
        if teeth.iter().all(|(_, arcs)| arcs.is_empty()) {
            return Err(ChatterError::NoTeethInCut);
        }
        let lag = cutter.lag_angle(depth);
        let mut geometry =
            Self { origin: cut.engagement.entry, span, teeth, slices: Vec::new(), lag, breaks: Vec::new() };
        geometry.breaks = geometry.find_breaks(!regular);
        Ok(geometry)
    }

    pub(super) fn find_breaks(&self, with_images: bool) -> Vec<f64> {
        let mut breaks = Vec::with_capacity(2 + 4 * self.teeth.len());
        breaks.extend([self.origin, self.origin + self.span]);
        let mut add = |angle: f64| {
            let turned = (angle - self.origin).rem_euclid(self.span);
            breaks.push(self.origin + turned);
        };
        for (offset, arcs) in &self.teeth {
            for arc in arcs {
                for edge in [arc.from, arc.to] {
                    for lag in [0.0, self.lag] {
                        add(edge + lag - offset);
                        if with_images {
                            // The kink that an edge leaves in the surface is met one delay later.
                            for (_, others) in &self.teeth {
                                for other in others {
                                    add(edge + lag - offset + other.delay);
                                }
                            }
                        }
                    }
                }
            }
        }
        breaks.sort_by(f64::total_cmp);
        breaks.dedup_by(|b, a| *b - *a < SAME);
        // The end of the span must survive, not its neighbour.
        let end = breaks.len() - 1;
        breaks[end] = self.origin + self.span;
        breaks
    }

    /// Every (tooth, arc, turns) that cuts somewhere in the stretch `from … to`; `turns` whole
    /// revolutions are to be added to the tooth's angle.
    pub fn cutting(&self, start: f64, end: f64) -> Vec<(usize, usize, f64)> {
        let middle = 0.5 * (start + end);
        let mut found = Vec::new();
        for (j, (offset, arcs)) in self.teeth.iter().enumerate() {
            for (a, arc) in arcs.iter().enumerate() {
                let angle = middle + offset;
                let first = ((arc.from - angle) / TAU).ceil() * TAU;
                let mut turns = first;
                while angle + turns < arc.to + self.lag {
                    found.push((j, a, turns));
                    turns += TAU;
                }
            }
        }
        found
    }

    /// Directional matrix per depth of tooth `j` in arc `a` when tooth 0 stands at `angle`,
    /// averaged over the depth if the tooth is helical.
    pub fn directional(&self, cut: &Milling, (j, a, turns): (usize, usize, f64), angle: f64) -> [f64; 4] {
        let (from, to) = match self.range(j, a, turns, angle) {
            Ok(range) => range,
            Err(phi) => {
                return match self.slices.get(j) {
                    Some(slice) => slice.force(&cut.force).directional(phi).map(|entry| entry * slice.share),
                    None => cut.force.directional(phi),
                };
            }
        };
        cut.force.directional_integral(from, to).map(|sum| sum / self.lag)
    }

    /// The same of the damping by the cut, per `C_i/V`: the dyad of the radius.
    pub fn radial_dyad(&self, (j, a, turns): (usize, usize, f64), angle: f64) -> [f64; 4] {
        let (scale, [ss, sc, cc]) = match self.range(j, a, turns, angle) {
            Ok((from, to)) => (1.0 / self.lag, square_integrals(from, to)),
            Err(phi) => {
                let (s, c) = phi.sin_cos();
                (self.slices.get(j).map_or(1.0, Slice::dyad), [s * s, s * c, c * c])
            }
        };
        [ss * scale, sc * scale, sc * scale, cc * scale]
    }

    /// Force per depth (feed, normal) against a tooth that `tangential` and `radial` (N/m) act on, averaged over the
    /// depth: `[t c + r s, r c − t s]`.
    pub fn against(&self, edge: [f64; 2], (j, a, turns): (usize, usize, f64), angle: f64) -> [f64; 2] {
        let [tangential, radial] = self.slices.get(j).map_or(edge, |slice| slice.edge_force(edge));
        let (cosine, sine) = match self.range(j, a, turns, angle) {
            Ok((from, to)) => ((to.sin() - from.sin()) / self.lag, (from.cos() - to.cos()) / self.lag),
            Err(phi) => (phi.cos(), phi.sin()),
        };
        [tangential * cosine + radial * sine, radial * cosine - tangential * sine]
    }

    /// Angles that the tooth covers over the depth, within its arc; a straight tooth has one
    /// angle instead.
    fn range(&self, j: usize, a: usize, turns: f64, angle: f64) -> Result<(f64, f64), f64> {
        let (offset, arcs) = &self.teeth[j];
        let lead = angle + offset + turns;
        if self.lag == 0.0 {
            return Err(lead);
        }
        let from = (lead - self.lag).max(arcs[a].from);
        Ok((from, lead.min(arcs[a].to).max(from)))
    }
}

/// Sum over the straight teeth in cut of the directional matrices, at the share `start` of a tooth
/// period or averaged over `from … to`. The period starts as tooth 0 enters.
pub(crate) fn tooth_period_gain(cut: &Milling, start: f64, end: f64) -> [f64; 4] {
    let pitch = TAU / cut.cutter.teeth as f64;
    let (entry, exit) = (cut.engagement.entry, cut.engagement.exit);
    let mut sum = [0.0; 4];
    for j in 0..cut.cutter.teeth {
        let (a, b) = (entry + pitch * (start + j as f64), entry + pitch * (end + j as f64));
        let part = if start == end {
            if a <= exit { cut.force.directional(a) } else { [0.0; 4] }
        } else if a < exit {
            cut.force.directional_integral(a, b.min(exit)).map(|entry| entry / (b - a))
        } else {
            [0.0; 4]
        };
        for (total, part) in sum.iter_mut().zip(part) {
            *total += part;
        }
    }
    sum
}

/// Arcs of tooth `j`: the whole engagement behind the tooth before it, or with runout the parts in
/// which each earlier tooth has left the lowest surface.
fn arcs(cut: &Milling, j: usize) -> Vec<Arc> {
    let cutter = &cut.cutter;
    let (entry, exit) = (cut.engagement.entry, cut.engagement.exit);
    if cutter.runout == 0.0 {
        return vec![Arc { from: entry, to: exit, delay: cutter.pitch_before(j), step: 0.0 }];
    }
    // Chip against the surface of the m-th tooth before: feed(m) sin(phi) + step(m).
    let mut delay = 0.0;
    let earlier: Vec<(f64, f64, f64)> = (1..=cutter.teeth)
        .map(|m| {
            delay += cutter.pitch_before((j + cutter.teeth + 1 - m) % cutter.teeth);
            let other = (j + cutter.teeth - m % cutter.teeth) % cutter.teeth;
            let feed = cut.feed_per_tooth * cutter.teeth as f64 * delay / TAU;
            (delay, feed, cutter.extra_radius(j) - cutter.extra_radius(other))
        })
        .collect();
    let mut edges = vec![entry, exit];
    let mut add = |sine: f64| {
        if sine.abs() < 1.0 {
            for turn in [-TAU, 0.0, TAU] {
                for angle in [sine.asin() + turn, std::f64::consts::PI - sine.asin() + turn] {
                    if angle > entry + SAME && angle < exit - SAME {
                        edges.push(angle);
                    }
                }
            }
        }
    };
    for (index, (_, feed, step)) in earlier.iter().enumerate() {
        add(-step / feed);
        for (_, other_feed, other_step) in &earlier[..index] {
            add((other_step - step) / (feed - other_feed));
        }
    }
    edges.sort_by(f64::total_cmp);
    let mut arcs: Vec<Arc> = Vec::new();
    for pair in edges.windows(2).filter(|pair| pair[1] - pair[0] > SAME) {
        let sine = (0.5 * (pair[0] + pair[1])).sin();
        let chip = |(_, feed, step): &&(f64, f64, f64)| feed * sine + step;
        let Some(surface) = earlier.iter().min_by(|a, b| chip(a).total_cmp(&chip(b))) else { continue };
        if chip(&surface) <= 0.0 {
            continue;
        }
        match arcs.last_mut() {
            Some(last) if last.delay == surface.0 && (last.to - pair[0]).abs() < SAME => last.to = pair[1],
            _ => arcs.push(Arc { from: pair[0], to: pair[1], delay: surface.0, step: surface.2 }),
        }
    }
    arcs
}
