//! Patterns of holes: cycle 220 on a circle, cycle 221 on lines. Their definition calls the cycle that was defined before.
//!
//! # Source
//! Parameters and order of the holes as the user's manual of TNC 640, cycles, describes them, cited from memory (assumption).

use super::Klartext;
use super::block::Words;
use super::cycles::Cycle;
use crate::error::Fault;
use crate::frame::Frame;
use crate::hole::PECKS;
use crate::kernel::{Kernel, Target};

/// Q204, the second set-up clearance, and Q241, Q242 and Q243, numbers of holes.
const SECOND_CLEARANCE: u32 = 204;

impl Klartext {
    /// The place of CYCL CALL POS: first in the plane; a cycle from 200 on takes the third axis as a shift of its surface, which
    /// ends with the call.
    pub(super) fn call_place(&mut self, given: &Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let w = kernel.plane[2];
        let mut plane = given.target;
        let across = (plane.absolute[w].take(), plane.step[w].take());
        kernel.straight(&plane, given.fmax)?;
        let old = matches!(self.cycle, Some(Cycle::Old(..)));
        match across {
            (Some(place), None) if !old => {
                let mut shift = [0.0; 9];
                shift[w] = place;
                kernel.frame = kernel.frame.after(&Frame::shifted(shift));
                Ok(())
            }
            (None, None) => Ok(()),
            (absolute, step) => {
                let mut target = Target::default();
                (target.absolute[w], target.step[w]) = (absolute, step);
                kernel.straight(&target, given.fmax)
            }
        }
    }

    pub(super) fn holes(&mut self, number: u32, kernel: &mut Kernel) -> Result<(), Fault> {
        let Some(Cycle::New(cycle)) = self.cycle else {
            return Err(Fault::new(format!(
                "cycle {number} calls the cycle from 200 on that is defined before it, but there is none"
            )));
        };
        let given = |index: u32| self.store.0.get(&index).copied();
        let needed = |index: u32| given(index).ok_or_else(|| Fault::new(format!("cycle {number} needs Q{index}")));
        let length = |index: u32| needed(index).and_then(|value| kernel.length(value));
        let count = |index: u32| {
            needed(index).and_then(|value| {
                if (1.0..=PECKS as f64).contains(&value) && value.fract() == 0.0 {
                    Ok(value as u32)
                } else {
                    Err(Fault::new(format!("Q{index} = {value}: write a whole number of holes from 1 to {PECKS}")))
                }
            })
        };
        if given(365).unwrap_or(0.0) != 0.0 {
            return Err(Fault::new("motions along the circle (Q365 = 1) are not followed; write 0").refusing());
        }
        let low = given(301).unwrap_or(0.0) == 0.0;
        let mut places: Vec<[f64; 2]> = Vec::new();
        if number == 220 {
            let centre = [length(216)?, length(217)?];
            let (radius, first, holes) = (0.5 * length(244)?, given(245).unwrap_or(0.0), count(241)?);
            let whole = given(246).unwrap_or(first + 360.0) - first;
            let gaps = if (whole.abs() - 360.0).abs() < 1e-9 { holes } else { (holes - 1).max(1) };
            let step = given(247).filter(|step| *step != 0.0).unwrap_or(whole / f64::from(gaps));
            for hole in 0..holes {
                let (sin, cos) = crate::frame::turn(first + step * f64::from(hole));
                places.push([centre[0] + radius * cos, centre[1] + radius * sin]);
            }
        } else {
            let (start, spacing) = ([length(225)?, length(226)?], [length(237)?, length(238)?]);
            let (columns, rows) = (count(242)?, count(243)?);
            if f64::from(columns) * f64::from(rows) > PECKS as f64 {
                return Err(Fault::new(format!("cycle 221 with more than {PECKS} holes; check Q242 and Q243")));
            }
            let (sin, cos) = crate::frame::turn(given(224).unwrap_or(0.0));
            for row in 0..rows {
                for column in 0..columns {
                    // Every other row is run through backwards.
                    let column = if row % 2 == 0 { column } else { columns - 1 - column };
                    let [x, y] = [spacing[0] * f64::from(column), spacing[1] * f64::from(row)];
                    places.push([start[0] + cos * x - sin * y, start[1] + sin * x + cos * y]);
                }
            }
        }
        let [u, v, w] = kernel.plane;
        let second = given(SECOND_CLEARANCE);
        let surface = given(203).map_or(Ok(0.0), |value| kernel.length(value))?;
        let setup = kernel.length(needed(200)?.abs())?;
        let above = surface + kernel.length(second.unwrap_or(0.0))?.max(setup);
        // The tool goes to the second set-up clearance first, then to the first place.
        kernel.straight(&Target::one(w, above), true)?;
        let last = places.len() - 1;
        for (index, place) in places.into_iter().enumerate() {
            let mut target = Target::default();
            (target.absolute[u], target.absolute[v]) = (Some(place[0]), Some(place[1]));
            kernel.straight(&target, true)?;
            if low && index < last {
                self.store.0.insert(SECOND_CLEARANCE, 0.0);
            }
            let done = self.bore_new(cycle, kernel);
            match second {
                Some(second) => self.store.0.insert(SECOND_CLEARANCE, second),
                None => self.store.0.remove(&SECOND_CLEARANCE),
            };
            done?;
        }
        Ok(())
    }
}
