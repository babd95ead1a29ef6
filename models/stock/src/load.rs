//! What an engagement asks of spindle and cutter.

use crate::end::End;
use crate::engaged::Engaged;
use crate::holder::Holder;
use std::f64::consts::TAU;
use toolroom_contour::{EdgeForce, MillLife};

/// A cylindrical cutter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tool {
    /// m.
    pub radius: f64,
    /// The form of its end.
    pub end: End,
    /// Teeth.
    pub teeth: f64,
    /// Forces on its edges, how it bends and how long it lasts, where that is known.
    pub force: Option<ToolForce>,
    /// Its holder, where it is known.
    pub holder: Option<Holder>,
}

/// A tool in the work at hand.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolForce {
    /// Coefficients of the forces on its edges.
    pub edge: EdgeForce,
    /// Stiffness of its tip, N/m; 0 where it is not known.
    pub stiffness: f64,
    /// Life of its edges.
    pub life: MillLife,
}

/// Least immersion and depth, m, that count for the life of an edge: thinner chips only rub (assumption).
const RUBS: f64 = 1e-6;

/// Share of the life of an edge that a second of such a cut uses, 1/s: one over the handbook life at the width and the depth
/// that are engaged. `None` where the life is not known or the spindle stands.
pub(crate) fn wear_rate(engaged: &Engaged, tool: &Tool, feed: f64, speed: f64) -> Option<f64> {
    let ToolForce { life, .. } = tool.force?;
    if speed <= 0.0 || feed <= 0.0 {
        return None;
    }
    let depth = engaged.depth();
    if depth < RUBS {
        return Some(0.0);
    }
    let width = (engaged.area() / depth).max(RUBS);
    let feed_per_tooth = feed * TAU / (speed * tool.teeth);
    Some(1.0 / life.tool_life(speed, feed_per_tooth, width, depth, tool.teeth, 2.0 * engaged.radius()))
}

/// Forces on a clockwise cutter along its path, across it, and, at its whole radius, around it, which make the torque, N: the linear
/// edge-force model, integrated over the engaged angles at a feed per tooth, m. On a rounded or conical end the chip is thinner and
/// the edge longer than on a cylinder, by the sine of the angle between axis and normal, and the normal force leans out of the plane
/// by it; the coefficients are taken to hold there, too (an assumption).
///
/// # Source
/// Altintas, "Manufacturing Automation": the mechanics of end mills, and of ball end mills by elements of the edge.
pub(crate) fn forces(engaged: &Engaged, edge: &EdgeForce, tool: &Tool, feed_per_tooth: f64) -> [f64; 3] {
    // Chip thickness is feed·cos θ·slope, the length of the edge height/slope.
    let (mut along, mut across, mut tangential) = (0.0, 0.0, 0.0);
    for layer in &engaged.layers {
        for (from, to) in &layer.angles {
            let whole = to - from;
            let sin = to.sin() - from.sin();
            let cos = to.cos() - from.cos();
            let sin2 = 0.5 * (to.sin().powi(2) - from.sin().powi(2));
            let cos2 = 0.5 * whole + 0.25 * ((2.0 * to).sin() - (2.0 * from).sin());
            let kt = edge.tangential_cutting * feed_per_tooth;
            let kr = edge.radial_cutting * feed_per_tooth * layer.slope;
            let (te, re) = (edge.tangential_edge / layer.slope, edge.radial_edge);
            let height = layer.height;
            tangential += height * (te * whole + kt * sin) * layer.radius / tool.radius;
            // The tangential force on the cutter points a right angle ahead of the rim point, the radial one to the axis.
            along += height * (te * cos - kt * sin2 - re * sin - kr * cos2);
            across += height * (te * sin + kt * cos2 + re * cos - kr * sin2);
        }
    }
    let share = tool.teeth / TAU;
    [along, across, tangential].map(|sum| sum * share)
}

/// Averages over a revolution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Load {
    /// Cutting power, W.
    pub power: f64,
    /// Force across the direction of travel, N, whatever its sign.
    pub normal_force: f64,
    /// Force that bends the cutter, N.
    pub force: f64,
    /// Deflection of its tip across the direction of travel, m; 0 where its stiffness is not known.
    pub deflection: f64,
}

impl Load {
    /// Greater of each.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self {
            power: self.power.max(other.power),
            normal_force: self.normal_force.max(other.normal_force),
            force: self.force.max(other.force),
            deflection: self.deflection.max(other.deflection),
        }
    }

    /// The greatest load of a stretch, at its bound and at its samples: power grows with the engagement, but the force across the path
    /// of a cutter whose chips become thicker falls with it where the tangential force outweighs the radial one.
    pub(crate) fn most(bound: &Engaged, samples: [&Engaged; 3], tool: &Tool, feed: f64, speed: f64) -> Option<Self> {
        samples.into_iter().chain([bound]).filter_map(|engaged| Self::of(engaged, tool, feed, speed)).reduce(Self::max)
    }

    /// The load of a clockwise cutter that feeds `feed` m/s at `speed` rad/s, from its [`forces`]. `None` where the forces of the tool are not known or the spindle stands.
    pub(crate) fn of(engaged: &Engaged, tool: &Tool, feed: f64, speed: f64) -> Option<Self> {
        let ToolForce { edge, stiffness, .. } = tool.force?;
        if speed <= 0.0 || feed <= 0.0 {
            return None;
        }
        let [along, across, tangential] = forces(engaged, &edge, tool, feed * TAU / (speed * tool.teeth));
        Some(Self {
            power: tangential * speed * tool.radius,
            normal_force: across.abs(),
            force: along.hypot(across),
            deflection: if stiffness > 0.0 { across.abs() / stiffness } else { 0.0 },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engaged::Layer;
    use std::f64::consts::FRAC_PI_2;
    use toolroom_contour::Milling;

    #[test]
    fn the_load_of_a_shoulder_is_that_of_the_contour_model() {
        let edge = EdgeForce::default();
        let (radius, depth, teeth, immersion) = (0.016, 0.03, 4.0, 0.003);
        let angle = (1.0f64 - immersion / radius).acos();
        let force = Some(ToolForce { edge, ..ToolForce::default() });
        let tool = Tool { radius, end: End::Flat, teeth, force, holder: None };
        let (feed_per_tooth, speed) = (0.1e-3, 200.0);
        let feed = feed_per_tooth * teeth * speed / TAU;
        for (milling, angles) in [
            // A clockwise cutter mills down with the wall on its right.
            (Milling::Down, (-FRAC_PI_2, -FRAC_PI_2 + angle)),
            (Milling::Up, (FRAC_PI_2 - angle, FRAC_PI_2)),
        ] {
            let layer = Layer { height: depth, radius, slope: 1.0, angles: vec![angles] };
            let engaged = Engaged { layers: vec![layer], sloped: false };
            let load = Load::of(&engaged, &tool, feed, speed).expect("a load");
            let forces = edge.mean(angle, depth, teeth, milling).at(feed_per_tooth);
            assert!((load.power - forces.tangential * speed * radius).abs() < 1e-9 * load.power, "{milling:?}");
            assert!(
                (load.normal_force - forces.normal.abs()).abs() < 1e-9 * load.force,
                "{milling:?}: {load:?} {forces:?}"
            );
            assert!((load.force - forces.resultant()).abs() < 1e-9 * load.force, "{milling:?}");
            // The life of the shoulder is that of the handbook at its depth and immersion.
            let rate = wear_rate(&engaged, &tool, feed, speed).expect("a life");
            let life = MillLife::default().tool_life(speed, feed_per_tooth, immersion, depth, teeth, 2.0 * radius);
            assert!((rate * life - 1.0).abs() < 1e-9, "{milling:?}: {rate} {life}");
        }
    }
}
