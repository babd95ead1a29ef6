//! Straight motions and arcs of SINUMERIK.

use super::Siemens;
use super::block::Values;
use super::modes::Move;
use super::parse::Count;
use crate::error::Fault;
use crate::frame::Frame;
use crate::kernel::{Kernel, Round, Target};
use crate::motion::{AXES, circle, tangent};

impl Siemens {
    /// The motion of a block.
    pub(super) fn motion(&mut self, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        let mut target = Target::default();
        let mut column = 0;
        for (axis, letter) in AXES.iter().enumerate() {
            let Some((value, count, place)) = values.take(&letter.to_string()) else { continue };
            column = place;
            let value = if (3..6).contains(&axis) {
                value
            } else {
                kernel.length(value).map_err(|fault| fault.or_at(place))?
            };
            let absolute = match count {
                Count::Modal => kernel.absolute,
                Count::Absolute => true,
                Count::Step => false,
            };
            if absolute { target.absolute[axis] = Some(value) } else { target.step[axis] = Some(value) }
        }
        if values.has("AP") || values.has("RP") {
            self.polar(&mut target, values, kernel)?;
        }
        self.joint(values, kernel)?;
        let centred = ["I", "J", "K", "CR", "AR", "TURN"].iter().any(|word| values.has(word));
        if target.is_empty() && !centred {
            return kernel.spent_joint();
        }
        let start = kernel.at;
        match self.modes.motion {
            Move::Rapid => kernel.straight(&target, true),
            Move::Line => kernel.straight(&target, false),
            Move::Arc { left } => self.arc(left, target, values, kernel),
            Move::Through => self.through(&target, values, kernel),
            Move::Tangent => self.tangent(&target, kernel),
        }
        .map_err(|fault| fault.or_at(column))?;
        if let Some(direction) = kernel.direction() {
            self.modes.direction = direction;
        } else if start != kernel.at {
            self.modes.direction = [0.0; 3];
        }
        Ok(())
    }

    fn arc(&mut self, left: bool, mut target: Target, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        let [u, v, w] = kernel.plane;
        let letters = ["I", "J", "K"];
        let from = kernel.program_at();
        let turns = values.take("TURN").map_or(0.0, |(turns, ..)| turns);
        let mut centre: Option<[f64; 2]> = None;
        for (slot, axis) in [u, v].into_iter().enumerate() {
            if let Some((value, count, _)) = values.take(letters[axis]) {
                let value = kernel.length(value)?;
                let middle = centre.get_or_insert([from[u], from[v]]);
                middle[slot] = if count == Count::Absolute { value } else { from[axis] + value };
            }
        }
        if let Some((value, _, column)) = values.take(letters[w])
            && value != 0.0
        {
            return Err(Fault::at(
                column,
                format!("{} is no part of an arc in this plane; choose the plane before", letters[w]),
            ));
        }
        let radius = values.take("CR");
        let opening = values.take("AR");
        let end = |axis: usize| target.end(axis, &from);
        let (start, stop) = ([from[u], from[v]], [end(u), end(v)]);
        let sign = if left { 1.0 } else { -1.0 };
        let round = match (centre, radius, opening) {
            (Some(centre), None, None) => Round::Centre(centre),
            (None, Some((radius, ..)), None) => Round::Radius(kernel.length(radius)?),
            (Some(centre), None, Some((angle, ..))) => {
                if target.names(u) || target.names(v) {
                    return Err(Fault::new("an arc by its opening angle takes its centre or its end, not both"));
                }
                if !(angle > 0.0 && angle < 360.0) {
                    return Err(Fault::new("AR is an angle above 0 and below 360 degrees"));
                }
                let (sin, cos) = crate::frame::turn(sign * angle);
                let arm = [start[0] - centre[0], start[1] - centre[1]];
                (target.absolute[u], target.step[u]) = (Some(centre[0] + cos * arm[0] - sin * arm[1]), None);
                (target.absolute[v], target.step[v]) = (Some(centre[1] + sin * arm[0] + cos * arm[1]), None);
                Round::Centre(centre)
            }
            (None, None, Some((angle, ..))) => {
                let chord = (stop[0] - start[0]).hypot(stop[1] - start[1]);
                if !(angle > 0.0 && angle < 360.0) || chord == 0.0 {
                    return Err(Fault::new(
                        "AR needs an end apart from the start and an angle between 0 and 360 degrees",
                    ));
                }
                let radius = 0.5 * chord / (0.5 * angle).to_radians().sin();
                Round::Radius(if angle > 180.0 { -radius } else { radius })
            }
            // In polar coordinates the pole is the centre.
            (None, None, None) if self.modes.about_pole => Round::Centre(self.modes.pole),
            (None, None, None) => return Err(Fault::new("an arc needs I, J, K, CR= or AR=")),
            _ => return Err(Fault::new("the arc is given twice, by I J K, CR= or AR=; leave one")),
        };
        kernel.round(&target, round, left, turns)
    }

    /// An arc through the point I1 J1 K1.
    fn through(&mut self, target: &Target, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        let [u, v, w] = kernel.plane;
        let from = kernel.program_at();
        let mut middle = from;
        for (axis, address) in ["I1", "J1", "K1"].into_iter().enumerate() {
            if let Some((value, count, _)) = values.take(address) {
                let value = kernel.length(value)?;
                let absolute = count == Count::Absolute || (count == Count::Modal && kernel.absolute);
                middle[axis] = if absolute { value } else { from[axis] + value };
            }
        }
        let end = |axis: usize| target.end(axis, &from);
        if (end(w) - from[w]).abs() > 1e-9 || (middle[w] - from[w]).abs() > 1e-9 {
            return Err(
                Fault::new("an arc through a point out of the plane is not followed; write it in the plane").refusing()
            );
        }
        let (a, b, c) = ([from[u], from[v]], [middle[u], middle[v]], [end(u), end(v)]);
        let (centre, left) = circle(a, b, c).ok_or_else(|| Fault::new("the three points of the arc lie on a line"))?;
        kernel.round(target, Round::Centre(centre), left, 0.0)
    }

    /// An arc that begins in the direction of the last motion.
    fn tangent(&mut self, target: &Target, kernel: &mut Kernel) -> Result<(), Fault> {
        let [u, v, _] = kernel.plane;
        let from = kernel.program_at();
        let end = |axis: usize| target.end(axis, &from);
        // The last motion ran in the workpiece; the arc is written in the coordinates of the program.
        let mut ahead = [0.0; 9];
        ahead[..3].copy_from_slice(&self.modes.direction);
        let turned = Frame { matrix: kernel.frame.matrix, ..Frame::IDENTITY }.program(ahead);
        let direction = [turned[u], turned[v]];
        match tangent([from[u], from[v]], [end(u), end(v)], direction) {
            Some((centre, left)) => kernel.round(target, Round::Centre(centre), left, 0.0),
            None if direction == [0.0; 2] => {
                Err(Fault::new("CT needs a motion before it in whose direction the arc begins"))
            }
            None => kernel.straight(target, false),
        }
    }
}
