//! Polar coordinates of SINUMERIK, and chamfers and roundings behind a motion.
//!
//! # Source
//! G110 to G112, AP, RP, CHF, CHR and RND as the programming guide SINUMERIK 840D, fundamentals, describes them, cited from
//! memory (assumption). A chamfer or rounding has the feed of the block that names it (assumption: the control takes it from
//! the block before or behind by a datum of the machine).

use super::Siemens;
use super::block::Values;
use super::modes::Move;
use super::parse::Count;
use crate::error::Fault;
use crate::joint::Joint;
use crate::kernel::{Kernel, Target};
use crate::motion::AXES;

impl Siemens {
    /// G110, G111 and G112: a pole from the last place, from the origin and from the last pole.
    pub(super) fn pole(&mut self, code: u32, values: &mut Values, kernel: &Kernel) -> Result<(), Fault> {
        let [u, v, _] = kernel.plane;
        let from = kernel.program_at();
        let origin = match code {
            110 => [from[u], from[v]],
            111 => [0.0; 2],
            _ => self.modes.pole,
        };
        let place = if values.has("AP") || values.has("RP") {
            let (radius, angle) = (values.take("RP"), values.take("AP"));
            let (Some((radius, ..)), Some((angle, ..))) = (radius, angle) else {
                return Err(Fault::new(format!("G{code} needs both AP= and RP=, or coordinates")));
            };
            let (sin, cos) = crate::frame::turn(angle);
            let radius = kernel.length(radius)?;
            [radius * cos, radius * sin]
        } else {
            let mut place = [0.0; 2];
            for (slot, axis) in place.iter_mut().zip([u, v]) {
                if let Some((value, ..)) = values.take(&AXES[axis].to_string()) {
                    *slot = kernel.length(value)?;
                }
            }
            place
        };
        self.modes.pole = [origin[0] + place[0], origin[1] + place[1]];
        Ok(())
    }

    /// The end of a motion by its angle and distance from the pole; what a block leaves out stays as it is.
    pub(super) fn polar(&mut self, target: &mut Target, values: &mut Values, kernel: &Kernel) -> Result<(), Fault> {
        let [u, v, _] = kernel.plane;
        if target.names(u) || target.names(v) {
            return Err(Fault::new("AP= and RP= stand beside coordinates of the plane; leave one out"));
        }
        let from = kernel.program_at();
        let arm = [from[u] - self.modes.pole[0], from[v] - self.modes.pole[1]];
        let (mut radius, mut angle) = (arm[0].hypot(arm[1]), arm[1].atan2(arm[0]).to_degrees());
        if let Some((value, count, _)) = values.take("RP") {
            let value = kernel.length(value)?;
            radius = if count == Count::Step { radius + value } else { value };
        }
        if let Some((value, count, _)) = values.take("AP") {
            angle = if count == Count::Step { angle + value } else { value };
        }
        let (sin, cos) = crate::frame::turn(angle);
        target.absolute[u] = Some(self.modes.pole[0] + radius * cos);
        target.absolute[v] = Some(self.modes.pole[1] + radius * sin);
        self.modes.about_pole = true;
        Ok(())
    }

    /// RND, CHF and CHR of a block.
    pub(super) fn joint(&mut self, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        if let Some((value, _, column)) = values.take("RNDM")
            && value != 0.0
        {
            return Err(Fault::at(
                column,
                "roundings of every corner (RNDM) are not followed; write RND in each block",
            )
            .refusing());
        }
        for word in ["RND", "CHF", "CHR"] {
            let Some((value, _, column)) = values.take(word) else { continue };
            if self.modes.motion != Move::Line {
                return Err(Fault::at(column, format!("{word} joins straight motions at feed; write the arc or line")));
            }
            let size = kernel.length(value)?;
            let joint = match word {
                "RND" => Joint::Round(size),
                "CHF" => Joint::Chamfer(size),
                _ => Joint::Legs(size),
            };
            kernel.joint(joint).map_err(|fault| fault.or_at(column))?;
        }
        Ok(())
    }
}
