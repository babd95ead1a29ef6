//! What a program's events mean for the stock: tool, spindle and height as the program goes on.

use crate::cutting::{Cut, Cutting, Encounter, Look};
use crate::load::Load;
use crate::setup::Setup;
use std::f64::consts::TAU;
use toolroom_program::{Action, Motion, ProgramError, Sense};

/// A program cuts with a tool that the setup does not have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}; add it as [[tool]] to the setup", match tool { Some(tool) => format!("the setup has no tool {tool}"), None => "no tool is called before the first cut, and the setup has more than one".to_owned() })]
pub struct NoTool {
    /// Its number.
    pub tool: Option<u32>,
}

/// Why a program was not followed through its stock.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FollowError {
    /// The program itself.
    #[error("{0}")]
    Program(#[from] ProgramError),
    /// A tool that the setup does not have.
    #[error("{line}:1: {reason}")]
    NoTool {
        /// Line of the program.
        line: usize,
        /// Which one.
        reason: NoTool,
    },
}

/// Follows a program through the stock of a setup, event by event.
#[derive(Clone, Debug)]
pub struct Follower<'a> {
    setup: &'a Setup,
    cutting: Cutting,
    /// A setup of one tool needs no call of it.
    only: Option<u32>,
    tool: Option<u32>,
    /// rad/s; 0 where the cutter does not turn clockwise.
    speed: f64,
    /// Until the program says where Z is, the tool is above everything.
    lifted: bool,
}

impl<'a> Follower<'a> {
    /// Begins with whole stock, and a tool only where the setup has a single one.
    pub fn new(setup: &'a Setup) -> Self {
        let only = if setup.tools.len() == 1 { setup.tools.keys().next().copied() } else { None };
        let cutting = match setup.cell() {
            Some(cell) => Cutting::mapped(setup.stock.clone(), cell),
            None => Cutting::new(setup.stock.clone(), setup.radius()),
        };
        Self { setup, cutting, only, tool: only, speed: 0.0, lifted: true }
    }

    /// The tool in the spindle.
    pub fn tool(&self) -> Option<u32> {
        self.tool
    }

    /// Speed of the spindle, rad/s; 0 where it stands or turns counterclockwise.
    pub fn speed(&self) -> f64 {
        self.speed
    }

    /// The stock as it is.
    pub fn cutting(&self) -> &Cutting {
        &self.cutting
    }

    /// The tool changes.
    pub fn change(&mut self, number: Option<u32>) {
        self.tool = number.or(self.only);
    }

    /// The spindle is commanded, rpm.
    pub fn spindle(&mut self, rpm: f64, sense: Sense) {
        self.speed = if sense == Sense::Clockwise { rpm * TAU / 60.0 } else { 0.0 };
    }

    /// Axes go to their reference point, Z among them or not.
    pub fn home(&mut self, z: bool) {
        self.lifted |= z;
    }

    /// What a block does beside its motions.
    pub fn act(&mut self, action: Action) {
        match action {
            Action::Spindle(speed, sense) => self.spindle(speed, sense),
            Action::Change(number) => self.change(number),
            Action::Home(z) => self.home(z),
            Action::Coolant(_) | Action::Stop | Action::End => {}
        }
    }

    /// The tool moves; `None` where the motion is above everything.
    ///
    /// # Errors
    /// [`NoTool`] for a cut with a tool that the setup does not have.
    pub fn motion(&mut self, motion: &Motion) -> Result<Option<Cut>, NoTool> {
        self.motion_seen(motion, None)
    }

    /// [`motion`](Self::motion), told stretch by stretch: the shares of the motion between which each lies, the engagement angle that
    /// is exceeded nowhere on it, rad, and the greatest load there and at the samples.
    ///
    /// # Errors
    /// As there.
    pub fn motion_traced(
        &mut self,
        motion: &Motion,
        trace: &mut dyn FnMut(f64, f64, f64, Option<Load>),
    ) -> Result<Option<Cut>, NoTool> {
        let feed = if motion.rapid || motion.time <= 0.0 { 0.0 } else { 1e-3 * motion.length / motion.time };
        let speed = self.speed;
        let mut look = |from: f64, to: f64, seen: Encounter<'_>| match seen {
            Encounter::Air | Encounter::Near => trace(from, to, 0.0, None),
            Encounter::Cut(bound, samples, tool) => {
                trace(from, to, bound.angle(), Load::most(bound, samples, tool, feed, speed));
            }
        };
        self.motion_seen(motion, Some(&mut look))
    }

    /// [`motion`](Self::motion), looked at stretch by stretch.
    pub(crate) fn motion_seen(&mut self, motion: &Motion, look: Option<&mut Look<'_>>) -> Result<Option<Cut>, NoTool> {
        if self.lifted && motion.rapid && !motion.unknown && motion.start[2] == motion.end[2] {
            return Ok(None);
        }
        self.lifted = false;
        match self.tool.and_then(|number| self.setup.tools.get(&number)) {
            Some(tool) => Ok(Some(self.cutting.motion_seen(motion, tool, self.speed, look))),
            None if motion.rapid => Ok(None),
            None => Err(NoTool { tool: self.tool }),
        }
    }
}
