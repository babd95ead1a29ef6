//! Drilling cycles CYCLE81 to CYCLE86, CYCLE840 and the hole patterns HOLES1 and HOLES2.
//!
//! # Source
//! Order and meaning of the parameters and sequences of motions as the programming guide SINUMERIK 840D/840Di/810D, cycles,
//! describes them, cited from memory (assumption).

use super::Siemens;
use crate::error::Fault;
use crate::hole::{Clearance, Exit, Hole, PECKS, Pecks, stops};
use crate::kernel::{FeedMode, Kernel, Target};

/// Drilling cycles that are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cycle {
    Drill,
    Counterbore,
    DeepHole,
    RigidTap,
    CompensatedTap,
    Ream,
    Bore,
}

impl Cycle {
    const NAMES: [(&'static str, Self); 7] = [
        ("CYCLE81", Self::Drill),
        ("CYCLE82", Self::Counterbore),
        ("CYCLE83", Self::DeepHole),
        ("CYCLE84", Self::RigidTap),
        ("CYCLE840", Self::CompensatedTap),
        ("CYCLE85", Self::Ream),
        ("CYCLE86", Self::Bore),
    ];

    fn named(name: &str) -> Option<(&'static str, Self)> {
        Self::NAMES.into_iter().find(|(known, _)| *known == name)
    }
}

/// What every motion calls, with its values.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Modal {
    Cycle { name: &'static str, cycle: Cycle, values: Vec<Option<f64>> },
    Subprogram(String, Vec<Option<f64>>),
}

/// Metric coarse threads: nominal diameter and pitch, mm (ISO 261, first and second choice).
const SIZES: [f64; 22] = [
    3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 22.0, 24.0, 27.0, 30.0, 33.0, 36.0, 39.0, 42.0, 45.0,
    48.0, 52.0,
];
const PITCHES: [f64; 22] =
    [0.5, 0.7, 0.8, 1.0, 1.25, 1.5, 1.75, 2.0, 2.0, 2.5, 2.5, 2.5, 3.0, 3.0, 3.5, 3.5, 4.0, 4.0, 4.5, 4.5, 5.0, 5.0];

/// Greatest number of holes of a pattern: a bound against programs without end (assumption).
const HOLES: f64 = 1e5;

/// Whether a name is that of a cycle of the control.
fn is_cycle(name: &str) -> bool {
    let numbered = |kind: &str| {
        name.strip_prefix(kind).is_some_and(|rest| !rest.is_empty() && rest.bytes().all(|b| b.is_ascii_digit()))
    };
    numbered("CYCLE") || numbered("POCKET") || numbered("SLOT") || name == "LONGHOLE"
}

impl Siemens {
    /// A cycle of the block, or, `modal`, one that following motions call.
    pub(super) fn cycle(
        &mut self,
        name: &str,
        list: &[Option<f64>],
        modal: bool,
        kernel: &mut Kernel,
    ) -> Result<(), Fault> {
        if let Some((name, cycle)) = Cycle::named(name) {
            let repeated = Modal::Cycle { name, cycle, values: list.to_vec() };
            if modal {
                self.modal = Some(repeated);
                return Ok(());
            }
            return self.bore(&repeated, kernel);
        }
        match name {
            // Tolerance and look-ahead of the control, and the end of a tilted plane: no motion.
            "CYCLE832" => Ok(()),
            "CYCLE800" if list.is_empty() => Ok(()),
            "HOLES1" | "HOLES2" => self.pattern(name, list, kernel),
            // What the program defines by itself goes before a cycle of the control.
            _ if is_cycle(name) && !self.sections.contains_key(name) => {
                Err(Fault::new(format!("{name} is a cycle of the control that is not followed; post its motions"))
                    .refusing())
            }
            _ if modal => {
                self.modal = Some(Modal::Subprogram(name.to_owned(), list.to_vec()));
                Ok(())
            }
            _ => self.call(name, 1, list.to_vec(), false, kernel.line),
        }
    }

    /// Runs what every motion calls, behind a motion.
    pub(super) fn repeat(&mut self, modal: &Modal, kernel: &mut Kernel) -> Result<(), Fault> {
        match modal {
            Modal::Cycle { .. } => self.bore(modal, kernel),
            // Motions of the subprogram do not call it again.
            Modal::Subprogram(..) if self.calls.iter().any(|call| call.modal) => Ok(()),
            Modal::Subprogram(name, list) => self.call(name, 1, list.clone(), true, kernel.line),
        }
    }

    pub(super) fn bore(&mut self, modal: &Modal, kernel: &mut Kernel) -> Result<(), Fault> {
        let Modal::Cycle { name, cycle, values: list } = modal else { return Ok(()) };
        let given = |index: usize| list.get(index).copied().flatten();
        let length = |index: usize| given(index).map(|value| kernel.length(value)).transpose();
        let needed =
            |index: usize, word: &str| length(index)?.ok_or_else(|| Fault::new(format!("{name} needs {word}")));
        let (retract, surface) = (needed(0, "RTP, the plane of retraction")?, needed(1, "RFP, the reference plane")?);
        let clearance = length(2)?.unwrap_or(0.0).abs();
        let bottom = match (length(3)?, length(4)?) {
            (_, Some(depth)) if depth != 0.0 => surface - depth.abs(),
            (Some(bottom), _) => bottom,
            (None, _) => return Err(Fault::new(format!("{name} needs DP or DPR, the depth"))),
        };
        if bottom > surface || retract < surface {
            return Err(Fault::new(format!(
                "{name}: the depth lies above the reference plane, or the retraction below it"
            )));
        }
        let reference = surface + clearance;
        let mut hole =
            Hole { reference, bottom, level: retract, pecks: None, dwell: 0.0, exit: Exit::Rapid, feed: None };
        // A dwell below zero counts turns of the spindle.
        let speed = kernel.speed;
        let seconds = |index: usize| match given(index).unwrap_or(0.0) {
            turns if turns < 0.0 && speed > 0.0 => Ok(-60.0 * turns / speed),
            turns if turns < 0.0 => Err(Fault::new(format!("{name}: a dwell of {} turns needs S before it", -turns))),
            time => Ok(time),
        };
        match cycle {
            Cycle::Drill => {}
            Cycle::Counterbore => hole.dwell = seconds(5)?,
            Cycle::DeepHole => {
                let first = match (length(5)?, length(6)?) {
                    (_, Some(depth)) if depth != 0.0 => depth.abs(),
                    (Some(depth), _) => surface - depth,
                    (None, _) => return Err(Fault::new("CYCLE83 needs FDEP or FDPR, the first depth")),
                };
                // FRF: feed of the first depth.
                let factor = given(10).filter(|factor| *factor != 0.0).unwrap_or(1.0);
                if !(0.001..=1.0).contains(&factor) {
                    return Err(Fault::new(format!(
                        "CYCLE83: {factor} is no factor of the feed (FRF) from 0.001 to 1"
                    )));
                }
                let amount = length(7)?.unwrap_or(0.0);
                let least = length(13)?.unwrap_or(0.0);
                let deep = given(11).unwrap_or(0.0) != 0.0;
                let mut list = depths(bottom, surface, first, amount.max(0.0), least)?;
                // The control counts depths from the reference plane, the hole from where feed begins.
                list.iter_mut().for_each(|stop| *stop += clearance);
                let breaking = length(14)?.filter(|value| *value > 0.0).unwrap_or(1.0);
                let again = length(16)?.filter(|value| *value > 0.0).map_or(Clearance::Depth, Clearance::Fixed);
                // DTD, the dwell at the bottom, is that between the depths where it is left out.
                hole.dwell = if given(15).is_some_and(|time| time != 0.0) { seconds(15)? } else { seconds(8)? };
                let retract = (!deep).then_some(breaking);
                // Between chips it is drawn up by G1.
                let pecks = Pecks { slow_within: true, first: factor, ..Pecks::new(list, retract, again) };
                hole.pecks = Some(Pecks { outside: seconds(9)?, inside: seconds(8)?, ..pecks });
            }
            Cycle::RigidTap | Cycle::CompensatedTap => {
                hole.dwell = seconds(5)?;
                return self.tap(modal, hole, kernel);
            }
            Cycle::Ream => {
                hole.dwell = seconds(5)?;
                hole.feed = Some(needed(6, "FFR, the feed")?);
                hole.exit = Exit::FeedOf(needed(7, "RFF, the feed of retraction")?);
                if kernel.feed_mode != FeedMode::Minute {
                    return Err(Fault::new("CYCLE85 is followed with feeds a minute (G94)"));
                }
            }
            Cycle::Bore => {
                hole.dwell = seconds(5)?;
                let (x, y) = (length(7)?.unwrap_or(0.0), length(8)?.unwrap_or(0.0));
                hole.exit = if x == 0.0 && y == 0.0 { Exit::Stopped } else { Exit::Shifted([x, y]) };
            }
        }
        kernel.hole(&hole)
    }

    fn tap(&mut self, modal: &Modal, mut hole: Hole, kernel: &mut Kernel) -> Result<(), Fault> {
        let Modal::Cycle { name, cycle, values: list } = modal else { return Ok(()) };
        let given = |index: usize| list.get(index).copied().flatten();
        let rigid = *cycle == Cycle::RigidTap;
        let (size, pitch) = if rigid { (given(7), given(8)) } else { (given(9), given(10)) };
        let by_size = |size: f64| {
            let found = SIZES.iter().position(|diameter| *diameter == size.abs()).map(|index| PITCHES[index]);
            found.ok_or_else(|| Fault::new(format!("{name}: M{size} is no thread of the table; give PIT, the pitch")))
        };
        let pitch = match (pitch.filter(|pitch| *pitch != 0.0), size.filter(|size| *size != 0.0)) {
            (Some(pitch), _) => Some(kernel.length(pitch.abs())?),
            (None, Some(size)) => Some(by_size(size)?),
            (None, None) => None,
        };
        kernel.pitch = pitch;
        hole.exit = Exit::Tap;
        let speed = given(10).filter(|speed| rigid && *speed > 0.0).unwrap_or(kernel.speed);
        let Some(pitch) = pitch else {
            if rigid {
                return Err(Fault::new("CYCLE84 needs MPIT or PIT, the pitch"));
            }
            // Without a pitch the programmed feed holds.
            return kernel.hole(&hole);
        };
        if speed <= 0.0 {
            return Err(Fault::new(format!("{name} needs a speed of the spindle: SST, or S before")));
        }
        let back = given(11).filter(|speed| rigid && *speed > 0.0).unwrap_or(speed);
        let mode = kernel.feed_mode;
        kernel.feed_mode = FeedMode::Minute;
        hole.feed = Some(pitch * speed);
        if back != speed {
            hole.exit = Exit::TapAt(pitch * back);
        }
        let done = kernel.hole(&hole);
        kernel.feed_mode = mode;
        done
    }

    fn pattern(&mut self, name: &str, list: &[Option<f64>], kernel: &mut Kernel) -> Result<(), Fault> {
        let Some(modal) = self.modal.clone().filter(|modal| matches!(modal, Modal::Cycle { .. })) else {
            return Err(Fault::new(format!("{name} calls a cycle at each place, but no MCALL of a cycle is in force")));
        };
        let given = |index: usize| list.get(index).copied().flatten().unwrap_or(0.0);
        let length = |index: usize| kernel.length(given(index));
        let number = given(5);
        if !(1.0..=HOLES).contains(&number) || number.fract() != 0.0 {
            return Err(Fault::new(format!("{name}: {number} holes; write a whole number from 1")));
        }
        let (x, y, third, distance) = (length(0)?, length(1)?, length(2)?, length(3)?);
        let angles = (given(2), given(3), given(4));
        let step = length(4)?;
        for index in 0..number as u32 {
            let index = f64::from(index);
            let place = if name == "HOLES1" {
                // A row: start, angle, distance of the first from the start and between holes.
                let (sin, cos) = crate::frame::turn(angles.0);
                let reach = distance + index * step;
                [x + reach * cos, y + reach * sin]
            } else {
                // A circle: centre, radius, first angle and step; without a step all around.
                let between = if angles.2 == 0.0 { 360.0 / number } else { angles.2 };
                let (sin, cos) = crate::frame::turn(angles.1 + index * between);
                [x + third * cos, y + third * sin]
            };
            let mut target = Target::default();
            (target.absolute[kernel.plane[0]], target.absolute[kernel.plane[1]]) = (Some(place[0]), Some(place[1]));
            kernel.straight(&target, true)?;
            self.bore(&modal, kernel)?;
        }
        Ok(())
    }
}

/// Depths of CYCLE83 below the reference plane: each less than the one before by `amount` until it would be smaller than
/// that; the last two are cut alike.
fn depths(bottom: f64, surface: f64, first: f64, amount: f64, least: f64) -> Result<Vec<f64>, Fault> {
    let depth = surface - bottom;
    if first <= 0.0 {
        return Err(Fault::new("the first depth of CYCLE83 lies above the reference plane"));
    }
    if amount == 0.0 {
        return stops(depth, first, 0.0, first);
    }
    let least = if least > 0.0 { least } else { amount };
    let (mut list, mut step, mut reached) = (vec![first.min(depth)], first, first.min(depth));
    while depth - reached > 1e-9 {
        if list.len() > PECKS {
            return Err(Fault::new("CYCLE83 with too many depths; check DAM"));
        }
        step = (step - amount).max(least);
        let rest = depth - reached;
        if rest > step && rest < 2.0 * step {
            step = 0.5 * rest;
            list.push(reached + step);
            list.push(depth);
            break;
        }
        reached = (reached + step).min(depth);
        list.push(reached);
    }
    Ok(list)
}
