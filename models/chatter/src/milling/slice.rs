//! Parts of the depth in which a cutter whose edge bends counts as straight.

use super::cutter::MillingForce;

/// Sine of the angle below which a wall is the one that the cutter itself leaves.
const OWN_WALL: f64 = 1e-9;

/// A part of the depth in which the cutter counts as straight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slice {
    /// Share of the depth.
    pub share: f64,
    /// Radius (m), at the middle.
    pub radius: f64,
    /// Height of its middle above the tip (m).
    pub height: f64,
    /// Means over the height of sine and cosine of the axial angle kappa, and length of the edge over the height.
    pub sine: f64,
    pub cosine: f64,
    pub edge: f64,
}

impl Slice {
    /// The force coefficients of the slice in the plane, per height: a chip `h = h_plane sin(kappa)` on an edge of the
    /// length `dz/sin(kappa)` leaves the tangential force as it is and turns the radial and the axial one.
    pub fn force(&self, force: &MillingForce) -> MillingForce {
        MillingForce { radial: force.radial * self.sine + force.axial * self.cosine, ..*force }
    }

    /// The dyad of the radius, over that of a straight cutter: of the damping by the cut.
    pub fn dyad(&self) -> f64 {
        self.share * self.sine
    }

    /// Edge forces of the slice in the plane, over the whole depth, from those per length of edge.
    pub fn edge_force(&self, [tangential, radial]: [f64; 2]) -> [f64; 2] {
        [tangential * self.share * self.edge, radial * self.share]
    }

    /// Angles of entry and exit: where the slice is in the work that the full diameter meets from `entry` to `exit`, whose
    /// walls stand at `−R cos(angle)` from the axis. At 0 and pi the wall is the one that the cutter leaves, as wide as it is.
    pub fn engagement(&self, full_radius: f64, entry: f64, exit: f64) -> (f64, f64) {
        let at = |angle: f64| {
            let own = angle.sin().abs() < OWN_WALL;
            let across = if own { angle.cos().signum() } else { angle.cos() * full_radius / self.radius };
            across.clamp(-1.0, 1.0).acos()
        };
        (at(entry), at(exit))
    }
}
