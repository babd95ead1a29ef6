//! Modal state of a program beside the kernel's.

use super::polar::Polar;
use crate::control::Control;
use crate::frame::Frame;
use crate::kernel::{FeedMode, Kernel};
use crate::motion::{Axes, PLANES, plane_code};
use std::collections::BTreeMap;

/// The motion that coordinates without a code make.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Move {
    Open,
    Rapid,
    Line,
    Arc {
        left: bool,
    },
    Cycle,
    /// A lathe's box cycle or thread.
    Lathe(u32),
    /// Holes of a lathe.
    Drilling,
    Thread,
}

/// Modal state beside the kernel's.
#[derive(Clone, Debug)]
pub(super) struct Modes {
    pub motion: Move,
    pub arc_absolute: bool,
    /// G98: to the initial level.
    pub initial_return: bool,
    pub polar: Option<Polar>,
    /// Number of the last D, which holds until another one.
    pub register: Option<u32>,
    pub rotation: Option<(f64, [f64; 2])>,
    pub scaling: Option<([f64; 3], [f64; 3])>,
    pub mirror: [Option<f64>; 3],
    /// Shifts by G92, by G52 and by a change of known offsets.
    pub set: Axes,
    pub local: Axes,
    pub work: Axes,
    pub offsets: BTreeMap<u32, [Option<f64>; 9]>,
    /// Turns of the work offsets of LinuxCNC, degrees.
    pub turns: BTreeMap<u32, f64>,
    pub system: u32,
    pub next_tool: Option<u32>,
    /// Surface speed of the last G96, mm/min, which the next one takes up.
    pub surface: Option<f64>,
}

impl Modes {
    /// Modes at the start; LinuxCNC returns to the plane R where neither G98 nor G99 stands (so its interpreter rs274).
    pub fn new(initial_return: bool) -> Self {
        Self {
            motion: Move::Open,
            arc_absolute: false,
            initial_return,
            polar: None,
            register: None,
            rotation: None,
            scaling: None,
            mirror: [None; 3],
            set: [0.0; 9],
            local: [0.0; 9],
            work: [0.0; 9],
            offsets: BTreeMap::new(),
            turns: BTreeMap::new(),
            system: 1,
            next_tool: None,
            surface: None,
        }
    }

    /// Modal values for #4001 and on.
    pub fn publish(&self, kernel: &Kernel, modal: &mut BTreeMap<u32, f64>) {
        let motion = match self.motion {
            Move::Open => None,
            Move::Rapid => Some(0.0),
            Move::Line => Some(1.0),
            Move::Arc { left } => Some(if left { 3.0 } else { 2.0 }),
            Move::Cycle | Move::Lathe(_) | Move::Drilling | Move::Thread => None,
        };
        let feed = match kernel.feed_mode {
            FeedMode::Minute => 94.0,
            FeedMode::Revolution => 95.0,
            FeedMode::Inverse => 93.0,
        };
        let inch = kernel.scale.map(|scale| if scale > 1.0 { 20.0 } else { 21.0 });
        let values = [
            (1, motion),
            (2, Some(plane_code(kernel.plane) as f64)),
            (3, Some(if kernel.absolute { 90.0 } else { 91.0 })),
            (5, Some(feed)),
            (6, inch),
            (10, Some(if self.initial_return { 98.0 } else { 99.0 })),
            (14, (self.system <= 6).then(|| 53.0 + f64::from(self.system))),
            (109, kernel.feed.map(|feed| feed / kernel.feed_scale)),
            (119, Some(kernel.speed)),
            (120, kernel.tool.map(f64::from)),
        ];
        for (group, value) in values {
            match value {
                Some(value) => modal.insert(group, value),
                None => modal.remove(&group),
            };
        }
    }

    /// Turn of the work offset in force, degrees.
    pub fn turn(&self) -> f64 {
        self.turns.get(&self.system).copied().unwrap_or(0.0)
    }

    /// What a work offset adds to each axis, mm and degrees: as the program has set it, else as the control knows it.
    pub fn offset(&self, system: u32, control: &Control) -> [Option<f64>; 9] {
        self.offsets.get(&system).copied().unwrap_or_else(|| {
            let origin = if system <= 6 { control.given_origin(53 + system) } else { None };
            std::array::from_fn(|axis| origin.map(|origin| origin.get(axis).copied().unwrap_or(0.0)))
        })
    }

    /// Program coordinates against those of the workpiece.
    pub fn frame(&self, plane: [usize; 3]) -> Frame {
        let mut frame = Frame::shifted(std::array::from_fn(|i| self.set[i] + self.local[i] + self.work[i]));
        if self.turn() != 0.0 {
            frame = frame.after(&Frame::turned(self.turn(), PLANES[0], [0.0; 2]));
        }
        if let Some((angle, centre)) = self.rotation {
            frame = frame.after(&Frame::turned(angle, plane, centre));
        }
        if let Some((factors, centre)) = self.scaling {
            frame = frame.after(&Frame::scaled(factors, centre));
        }
        if self.mirror.iter().any(Option::is_some) {
            let factors = self.mirror.map(|at| if at.is_some() { -1.0 } else { 1.0 });
            frame = frame.after(&Frame::scaled(factors, self.mirror.map(|at| at.unwrap_or(0.0))));
        }
        frame
    }
}
