//! Polar coordinates of Fanuc and Haas (G16).

use super::run::Iso;
use crate::error::Fault;
use crate::kernel::{Kernel, Target};

/// Polar coordinates in force: what a block does not name stays.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Polar {
    /// Origin of the radius, in coordinates of the program.
    pole: [f64; 2],
    /// mm.
    radius: f64,
    /// Degrees from the first axis of the plane.
    angle: f64,
}

impl Iso {
    /// Puts the radius and the angle that a target names, where polar coordinates are in force, into the plane.
    ///
    /// An absolute radius is measured from the origin of the program, one by a step (G91) from where the tool stands, which stays
    /// the pole of the angles behind it; an angle by a step adds to the last one.
    ///
    /// # Source
    /// Operator's manual of FANUC series 16/18, model C, chapter 9.2; that of the NCT 2000M says the same.
    ///
    /// # Errors
    /// A radius by a step from a place that only the machine knows.
    pub(super) fn polar(&mut self, target: &mut Target, kernel: &Kernel) -> Result<(), Fault> {
        let [u, v, _] = kernel.plane;
        let Some(polar) = self.modes.polar.as_mut().filter(|_| target.names(u) || target.names(v)) else {
            return Ok(());
        };
        if let Some(radius) = target.step[u] {
            if !kernel.referenced[u] || !kernel.referenced[v] {
                return Err(Fault::new(
                    "a radius by steps (G16 with G91) begins at a place that only the machine knows: name a place before it, or give --start",
                ));
            }
            let at = kernel.program_at();
            (polar.pole, polar.radius) = ([at[u], at[v]], radius);
        } else if let Some(radius) = target.absolute[u] {
            (polar.pole, polar.radius) = ([0.0; 2], radius);
        }
        // The second word is an angle, whatever the unit of lengths.
        let unit = kernel.scale.unwrap_or(1.0);
        polar.angle = match (target.step[v], target.absolute[v]) {
            (Some(step), _) => polar.angle + step / unit,
            (None, Some(angle)) => angle / unit,
            (None, None) => polar.angle,
        };
        let (sin, cos) = crate::frame::turn(polar.angle);
        let place = [polar.pole[0] + polar.radius * cos, polar.pole[1] + polar.radius * sin];
        for (axis, place) in [u, v].into_iter().zip(place) {
            (target.step[axis], target.absolute[axis]) = (None, Some(place));
        }
        Ok(())
    }
}
