//! Holes on lathes, G code system A: G83 to G85 in the face, along Z, G87 to G89 in the side, along X, with G80.
//!
//! # Source
//! Words: the page "Drilling cycle G83 or G87" of cncprograming.blogspot.com after the manual of Fanuc: X and C, or Z and C,
//! name the place, R is the distance from the initial level to the plane where feed begins, W or U the depth below that
//! plane, K repeats. From memory of the manuals (assumption): R of the side is a radius; the tool returns to the initial
//! level; a tap turns back at the bottom; G85 and G89 draw the tool out to the plane at twice the feed; pecks are drawn back
//! by the clearance (parameter 5101.2 = 0, as the control is delivered), or to the plane.

use crate::Dialect;
use crate::error::Fault;
use crate::hole::{Clearance, Exit, Hole, Pecks, stops};
use crate::iso::run::Iso;
use crate::iso::words::Words;
use crate::kernel::{Kernel, Target};
use crate::motion::PLANES;

/// A cycle with the words that hold until it ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::iso) struct Drilling {
    code: u32,
    /// Axis along which it drills.
    axis: usize,
    /// Level of the tool before the cycle, program coordinates in mm.
    initial: f64,
    /// Bottom, mm, with whether it is a step below the plane.
    bottom: Option<(f64, bool)>,
    /// Step from the initial level to the plane, mm.
    reference: f64,
    peck: Option<f64>,
    dwell: f64,
}

/// Greatest number of repeats of a hole: a bound against programs without end (assumption).
const REPEATS: f64 = 1e5;

impl Iso {
    pub(in crate::iso) fn begin_drilling(&mut self, code: u32, kernel: &Kernel) {
        let axis = if code < 86 { 2 } else { 0 };
        let before = self.drilling.filter(|drilling| drilling.axis == axis);
        let fresh = Drilling {
            code,
            axis,
            initial: kernel.program_at()[axis],
            bottom: None,
            reference: 0.0,
            peck: None,
            dwell: 0.0,
        };
        self.drilling = Some(before.map_or(fresh, |before| Drilling { code, peck: None, dwell: 0.0, ..before }));
    }

    /// A block while such a cycle is in force: takes its words, and drills where the block names a place or a depth.
    pub(in crate::iso) fn drill(&mut self, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        let Some(mut drilling) = self.drilling else {
            return Err(Fault::new("no cycle is in force; write its code with its depth again"));
        };
        let drills = words.any(b"XZCUWHYV");
        if let Some(value) = words.take(b'R') {
            drilling.reference = self.mm(kernel, words, b'R', value)?;
        }
        if let Some(peck) = self.increments(words, b'Q', kernel)? {
            drilling.peck = Some(peck.abs()).filter(|peck| *peck > 0.0);
        }
        if let Some(value) = words.take(b'P') {
            drilling.dwell = if words.is_pointed(b'P') { value } else { 1e-3 * value };
        }
        let count = words.whole(b'K', 0.0, REPEATS)?.unwrap_or(1);
        let mut target = self.target(words, kernel)?;
        let axis = drilling.axis;
        drilling.bottom = match (target.absolute[axis].take(), target.step[axis].take()) {
            (Some(place), _) => Some((place, false)),
            (None, Some(step)) => Some((step, true)),
            (None, None) => drilling.bottom,
        };
        self.drilling = Some(drilling);
        if !drills {
            return Ok(());
        }
        for _ in 0..count {
            hole_at(&target, drilling, kernel)?;
        }
        Ok(())
    }
}

fn hole_at(target: &Target, drilling: Drilling, kernel: &mut Kernel) -> Result<(), Fault> {
    let Drilling { code, axis, initial, peck, dwell, .. } = drilling;
    let reference = initial + drilling.reference;
    let bottom = match drilling.bottom {
        Some((step, true)) => reference + step,
        Some((place, false)) => place,
        None => {
            let letters = if axis == 2 { "Z or W" } else { "X or U" };
            return Err(Fault::new(format!("the depth of G{code} is missing: write {letters}")));
        }
    };
    if (bottom - reference) * drilling.reference < 0.0 {
        return Err(Fault::new(format!(
            "the plane of G{code} lies beyond its bottom: R is the distance from the place of the tool, with its sign"
        )));
    }
    kernel.straight(target, true)?;
    let pecks = match peck {
        Some(peck) => {
            let clearance = kernel.control.clearance(Dialect::FanucLathe);
            let full = kernel.control.full_pecks;
            if !full {
                kernel.note(
                    "pecks of lathes are drawn back by the clearance, as the control is delivered: --set control.pecks=full draws them to the plane R",
                );
            }
            let stops = stops((bottom - reference).abs(), peck, 0.0, peck)?;
            let retract = (!full).then_some(clearance);
            Some(Pecks::new(stops, retract, Clearance::Fixed(clearance)))
        }
        None => None,
    };
    let feed = kernel.feed.ok_or_else(|| kernel.no_feed())?;
    let exit = match code {
        84 | 88 => Exit::Tap,
        85 | 89 => Exit::FeedOf(2.0 * feed),
        _ => Exit::Rapid,
    };
    // The hole runs across the plane in force.
    let plane = std::mem::replace(&mut kernel.plane, if axis == 2 { PLANES[0] } else { PLANES[2] });
    let hole = kernel.hole(&Hole { reference, bottom, level: initial, pecks, dwell, exit, feed: None });
    kernel.plane = plane;
    hole
}
