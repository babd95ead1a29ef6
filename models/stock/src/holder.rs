//! The holder of a tool above material.

use crate::cutting::{Cutting, Piece};
use crate::front::{Place, Step};
use crate::swath::Floors;
use std::f64::consts::PI;
use toolroom_contour::Point;

/// The holder of a tool: a cylinder without an upper end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Holder {
    /// m.
    pub radius: f64,
    /// Height of its lower face above the tip, m.
    pub overhang: f64,
}

/// Rings of its lower face.
const RINGS: u32 = 24;
/// Steps along a path are not halved below this share of the holder's radius: what it touches less is not found (assumption).
const SHORTEST: f64 = 0.01;

impl Cutting {
    /// Whether a holder meets what is left of the stock on its way along pieces of a path, or at a place where only the height changes.
    pub(crate) fn holder_meets(&self, holder: &Holder, pieces: &[Piece], place: (Point, f64)) -> bool {
        let (end, tip) = place;
        let lowest = pieces.iter().map(|piece| piece.from.min(piece.to)).fold(tip, f64::min);
        if lowest + holder.overhang >= self.stock().top {
            return false;
        }
        self.face_meets(holder, end, tip) || pieces.iter().any(|piece| self.rim_meets(holder, piece))
    }

    /// Whether the lower face meets material at a place: an island between its middle and its rim.
    fn face_meets(&self, holder: &Holder, centre: Point, tip: f64) -> bool {
        let around = self.index().near(centre, holder.radius);
        self.disc(&around, centre, holder.radius, tip + holder.overhang, RINGS, Floors::Highest).0 > 0.0
    }

    fn rim_meets(&self, holder: &Holder, piece: &Piece) -> bool {
        let path = &piece.path;
        let bottom = piece.from.min(piece.to) + holder.overhang;
        let moves = 1.0 + holder.radius * path.curvature.abs();
        let mut open = vec![(0.0, path.length)];
        while let Some((from, to)) = open.pop() {
            let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
            let around = self.index().near(path.at(middle), holder.radius + half);
            let meets = |way: f64, slack: f64| {
                let heading = path.heading + path.curvature * way;
                [heading, heading + PI].into_iter().any(|heading| {
                    let place = Place { centre: path.at(way), radius: holder.radius, bottom, heading };
                    !self.stock().engaged(&around, None, &Step::at(&place, slack), Floors::Highest).layers.is_empty()
                })
            };
            if !meets(middle, half * moves) {
                continue;
            }
            if [from, middle, to].into_iter().any(|way| meets(way, 0.0)) {
                return true;
            }
            if half > SHORTEST * holder.radius {
                open.extend([(middle, to), (from, middle)]);
            }
        }
        false
    }
}
