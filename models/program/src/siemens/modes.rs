//! Modal codes of SINUMERIK, frames, feed, speed and tool.

use super::Siemens;
use super::block::Values;
use crate::control::Units;
use crate::error::{Fault, unknown};
use crate::frame::Frame;
use crate::kernel::{FeedMode, Kernel};
use crate::motion::{AXES, Axes, EventKind, Offset, PLANES, Sense};
use crate::offset::{Corner, Offsetting};

/// The motion that coordinates make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Move {
    Rapid,
    Line,
    Arc {
        left: bool,
    },
    /// An arc through a point.
    Through,
    /// An arc that goes on from the path before.
    Tangent,
}

/// Modal state of a program beside the kernel's.
#[derive(Clone, Debug)]
pub(super) struct Modes {
    pub motion: Move,
    /// Programmable frame: TRANS, ROT, SCALE, MIRROR.
    frame: Frame,
    /// Number of the code of the work offset.
    work: u32,
    /// Its origin in the coordinates of the first one, mm, where that is known.
    origin: Axes,
    corner: Corner,
    pub next_tool: Option<u32>,
    /// Edge of the tool, D.
    edge: u32,
    /// mm of the unit of feeds, where G70, G71, G700 or G710 has said it.
    feed_unit: Option<f64>,
    /// Direction of the last motion in X Y Z.
    pub direction: [f64; 3],
    /// Pole of polar coordinates, in the plane and program coordinates, mm; an arc of a block may turn about it.
    pub pole: [f64; 2],
    pub about_pole: bool,
}

impl Default for Modes {
    fn default() -> Self {
        Self {
            motion: Move::Rapid,
            frame: Frame::IDENTITY,
            work: 500,
            origin: [0.0; 9],
            corner: Corner::Round,
            next_tool: None,
            edge: 1,
            feed_unit: None,
            direction: [0.0; 3],
            pole: [0.0; 2],
            about_pole: false,
        }
    }
}

impl Modes {
    /// Program coordinates against those of the first work offset.
    pub fn whole_frame(&self) -> Frame {
        Frame::shifted(self.origin).after(&self.frame)
    }

    /// These modes with the tools and offsets of others.
    pub fn with_tools_of(self, other: &Self) -> Self {
        let Self { work, origin, next_tool, edge, direction, pole, .. } = *other;
        Self { work, origin, next_tool, edge, direction, pole, ..self }
    }
}

impl Siemens {
    /// A modal code; whether it chooses a motion.
    pub(super) fn code(&mut self, code: u32, values: &mut Values, kernel: &mut Kernel) -> Result<bool, Fault> {
        match code {
            0 => self.modes.motion = Move::Rapid,
            1 => self.modes.motion = Move::Line,
            2 | 3 => self.modes.motion = Move::Arc { left: code == 3 },
            17..=19 => {
                let plane = PLANES[code as usize - 17];
                if plane != kernel.plane && kernel.offset.is_some() {
                    return Err(Fault::new(
                        "the plane changes while the compensation of the radius is in force; end it before",
                    ));
                }
                kernel.plane = plane;
            }
            40..=42 => self.compensate(code, kernel)?,
            450 => self.modes.corner = Corner::Round,
            451 => self.modes.corner = Corner::Extended,
            60 => kernel.exact = true,
            64 | 641..=645 => {
                kernel.exact = false;
                values.take("ADIS");
                values.take("ADISPOS");
            }
            601..=603 | 62 => {}
            70 | 700 | 71 | 710 => {
                let unit = |is_inch: bool| if is_inch { Units::Inch } else { Units::Millimetre }.scale();
                kernel.scale = Some(unit(matches!(code, 70 | 700)));
                // With G70 and G71 feeds stay in the basic unit of the control.
                self.modes.feed_unit = Some(unit(code == 700));
                if code == 70 {
                    kernel.note("with G70 feeds stay in the basic unit of the control, taken as mm");
                }
            }
            90 => kernel.absolute = true,
            91 => kernel.absolute = false,
            93..=95 => {
                let mode = [FeedMode::Inverse, FeedMode::Minute, FeedMode::Revolution][code as usize - 93];
                if mode != kernel.feed_mode {
                    kernel.feed_mode = mode;
                    kernel.feed = None;
                }
            }
            97 => {}
            96 => {
                return Err(Fault::new(
                    "constant surface speed is one of lathes; SINUMERIK programs are followed for mills",
                ));
            }
            54..=57 | 500 | 505..=599 => self.work_offset(code, kernel),
            _ => {
                let Some(time) = kernel.control.g.get(&(10 * code)).copied() else {
                    return Err(Fault::new(unknown(&format!("G{code}"), "g", &code.to_string())).refusing());
                };
                kernel.dwell(time)?;
            }
        }
        Ok(code <= 3)
    }

    fn compensate(&mut self, code: u32, kernel: &mut Kernel) -> Result<(), Fault> {
        kernel.finish_offset()?;
        if code == 40 {
            return Ok(());
        }
        kernel.side = Some(code == 41);
        let diameters = &kernel.control.diameters;
        let number = kernel.tool.or(self.modes.next_tool);
        let known =
            number.and_then(|number| diameters.get(&number)).or_else(|| diameters.get(&self.modes.edge)).copied();
        let Some(diameter) = known else {
            let edge = number.unwrap_or(self.modes.edge);
            kernel.note(format!(
                "the diameter of the tool is not known, so the contour is timed as programmed: give --tool D{edge}=\"10 mm\""
            ));
            return Ok(());
        };
        kernel.compensate(Offsetting::new(code == 41, 0.5 * diameter, kernel.plane, self.modes.corner));
        Ok(())
    }

    pub(super) fn dwell(&mut self, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        let (seconds, turns) = (values.take("F"), values.take("S"));
        let time = match (seconds, turns) {
            (Some((seconds, ..)), None) => seconds,
            (None, Some((turns, _, column))) => {
                if kernel.speed <= 0.0 {
                    return Err(Fault::at(
                        column,
                        "S of G4 counts turns of the spindle, but no speed stands before it",
                    ));
                }
                60.0 * turns / kernel.speed
            }
            _ => {
                return Err(Fault::new("the length of the dwell is missing: write F (seconds) or S (turns) behind G4"));
            }
        };
        kernel.dwell(time)
    }

    pub(super) fn technology(&mut self, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        if kernel.feed_mode == FeedMode::Inverse && !values.has("F") {
            kernel.feed = None;
        }
        if let Some((feed, _, column)) = values.take("F") {
            let scale = match kernel.feed_mode {
                FeedMode::Inverse => 1.0,
                FeedMode::Minute | FeedMode::Revolution => {
                    if feed != 0.0 {
                        kernel.unit().map_err(|fault| fault.or_at(column))?;
                    }
                    self.modes.feed_unit.or(kernel.scale).unwrap_or(1.0)
                }
            };
            kernel.set_feed(feed, scale).map_err(|fault| fault.or_at(column))?;
        }
        if let Some((speed, _, column)) = values.take("S").or_else(|| values.take("S1")) {
            kernel.set_speed(speed).map_err(|fault| fault.or_at(column))?;
        }
        if let Some((edge, ..)) = values.take("D") {
            kernel.offset_by(Offset::Length(if edge > 0.0 { kernel.tool.or(self.modes.next_tool) } else { None }));
            self.modes.edge = edge.clamp(0.0, 1e6) as u32;
        }
        values.take("H");
        if let Some((tool, _, column)) = values.take("T") {
            if !(0.0..=1e8).contains(&tool) {
                return Err(Fault::at(column, format!("T{tool} is no tool number")));
            }
            self.modes.next_tool = Some(tool as u32);
            if self.turret && tool > 0.0 && kernel.tool != self.modes.next_tool {
                kernel.change_tool(self.modes.next_tool);
            }
        }
        Ok(())
    }

    pub(super) fn function(&mut self, code: u32, kernel: &mut Kernel) {
        match code {
            3 => kernel.spindle(Sense::Clockwise),
            4 => kernel.spindle(Sense::Counterclockwise),
            6 => kernel.change_tool(self.modes.next_tool),
            7 | 8 => kernel.push(EventKind::Coolant(true)),
            19 => kernel.spindle(Sense::Oriented),
            _ => kernel.auxiliary(code),
        }
    }

    /// A frame of the program: TRANS, ROT, SCALE, MIRROR, and with A in front added to the one in force.
    pub(super) fn frame(&mut self, word: &str, values: &mut Values, kernel: &mut Kernel) -> Result<(), Fault> {
        let mut parts: [Option<f64>; 9] = [None; 9];
        for (axis, part) in parts.iter_mut().enumerate() {
            *part = values.take(&AXES[axis].to_string()).map(|(value, ..)| value);
        }
        let (added, kind) = word.strip_prefix('A').map_or((false, word), |kind| (true, kind));
        let base = if added { self.modes.frame } else { Frame::IDENTITY };
        let frame = match kind {
            "TRANS" => {
                let mut shift = [0.0; 9];
                for axis in 0..9 {
                    let value = parts[axis].unwrap_or(0.0);
                    shift[axis] = if (3..6).contains(&axis) { value } else { kernel.length(value)? };
                }
                Frame::shifted(shift)
            }
            "ROT" => {
                let angle = match values.take("RPL") {
                    Some((angle, ..)) => angle,
                    None => {
                        let w = kernel.plane[2];
                        if (0..3).any(|axis| axis != w && parts[axis].is_some_and(|angle| angle != 0.0)) {
                            return Err(Fault::new(
                                "a rotation out of the plane is not followed; post the motions in machine axes",
                            )
                            .refusing());
                        }
                        parts[w].unwrap_or(0.0)
                    }
                };
                Frame::turned(angle, kernel.plane, [0.0; 2])
            }
            "SCALE" => {
                let factors = std::array::from_fn(|axis| parts[axis].unwrap_or(1.0));
                if factors.iter().any(|factor: &f64| !(1e-6..=1e6).contains(factor)) {
                    return Err(Fault::new("factors of SCALE must be above 0"));
                }
                Frame::scaled(factors, [0.0; 3])
            }
            _ => {
                let factors = std::array::from_fn(|axis| if parts[axis].is_some() { -1.0 } else { 1.0 });
                Frame::scaled(factors, [0.0; 3])
            }
        };
        self.modes.frame = base.after(&frame);
        kernel.frame = self.modes.whole_frame();
        Ok(())
    }

    /// Another work offset: G54 to G57, G505 and on, or G500, which is none.
    fn work_offset(&mut self, code: u32, kernel: &mut Kernel) {
        if self.modes.work == code {
            kernel.work_offset_again();
            return;
        }
        // The first offset is the one in which the program counts.
        let first = self.modes.work == 500 && kernel.counts_in_first();
        let origin = kernel.control.origin(code);
        let before = if first { origin.and(Some([0.0; 3])) } else { kernel.control.origin(self.modes.work) };
        if before.zip(origin).is_none() && !first {
            kernel.forget(0..3);
        }
        self.modes.work = code;
        self.modes.origin = [0.0; 9];
        if let Some(origin) = origin {
            self.modes.origin[..3].copy_from_slice(&origin);
        }
        kernel.frame = self.modes.whole_frame();
        let number = match code {
            500 => 99,
            505.. => code - 405,
            _ => code - 54,
        };
        kernel.work_offset(number, [origin.is_some(); 3]);
    }
}
