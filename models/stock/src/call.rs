//! A program as a sequence of tool calls: how long each takes, and under what conditions its tool cuts meanwhile.

use crate::cutting::Cut;
use crate::follow::{Follower, NoTool};
use crate::load::Tool;
use crate::setup::Setup;
use std::f64::consts::TAU;
use std::ops::Range;
use std::path::Path;
use toolroom_drives::{Drives, Machine, Part, Timer};
use toolroom_form::ReadError;
use toolroom_program::{Control, Program, ProgramError};

/// Why a program has no sequence of tool calls.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CallError {
    /// The program itself.
    #[error("{0}")]
    Program(#[from] ProgramError),
    /// The file of the program cannot be read.
    #[error(" {0}")]
    Unreadable(#[from] std::io::Error),
    /// The machine file that the setup names.
    #[error(" its machine: {0}")]
    Machine(#[from] ReadError),
    /// A tool that the setup does not have.
    #[error("{line}:1: {reason}")]
    NoTool {
        /// Line of the program.
        line: usize,
        /// Which one.
        reason: NoTool,
    },
}

/// Conditions under which a tool cuts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditions {
    /// Cutting speed, m/s.
    pub cutting_speed: f64,
    /// Feed of a tooth, m.
    pub feed_per_tooth: f64,
    /// Axial depth of cut, m.
    pub depth_of_cut: f64,
    /// Radial width of cut, m.
    pub width_of_cut: f64,
    /// Whether it mills down.
    pub down: bool,
}

/// Some time under the same conditions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// s.
    pub time: f64,
    /// `None` out of cut.
    pub cut: Option<Conditions>,
}

/// Everything between two tool changes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Call {
    /// The tool, where one was called.
    pub tool: Option<u32>,
    /// All of its time, s, with the change before it: the sum of its spans.
    pub time: f64,
    /// Way of the tool in material, m.
    pub path: f64,
    /// What its tool does, in order.
    pub spans: Vec<Span>,
}

/// Some blocks that can be timed by themselves, as a log of a machine shows them.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedStretch {
    /// Lines of the first and the last block, from 1.
    pub lines: (usize, usize),
    /// Tool in the spindle behind it.
    pub tool: Option<u32>,
    /// s.
    pub time: f64,
    /// Number of tool changes.
    pub changes: usize,
}

/// A program that has run.
#[derive(Clone, Debug, PartialEq)]
pub struct Calls {
    /// Tool calls in order.
    pub calls: Vec<Call>,
    /// Stretches in order.
    pub stretches: Vec<TimedStretch>,
}

/// Spans of a call beyond which conditions are joined more freely (assumption: as many as take a shop a millisecond).
const SPANS: usize = 200;
/// Share by which conditions that are joined may differ at first, and at most (assumption).
const ALIKE: (f64, f64) = (0.02, 0.64);
/// Stretches of motions last at least this long, s, where there is so much: as long as the import of logs makes them.
const STRETCH: f64 = 8.0;
/// Least feed, depth and width, m, of a cut: below them an edge only rubs (assumption).
const LEAST: f64 = 1e-6;

impl Calls {
    /// Runs a program through the stock of a setup on a machine.
    ///
    /// The time of a block is that of the machine, shared out among its motions at feed by their programmed times; what a
    /// motion spends in air and everything that is no motion at feed is out of cut. Motions straight down wear no edge.
    ///
    /// # Errors
    /// [`CallError`]: the program is refused, or cuts with a tool that the setup does not have.
    ///
    /// ```
    /// use toolroom_drives::Drives;
    /// use toolroom_program::Control;
    /// use toolroom_stock::{Calls, Setup};
    /// let setup = "schema = 1\n[stock]\nbox = [[\"0 mm\", \"0 mm\", \"-20 mm\"], [\"100 mm\", \"50 mm\", \"0 mm\"]]\n\
    ///     [[tool]]\nnumber = 1\ndiameter = \"10 mm\"\nteeth = 4\n";
    /// let setup = Setup::parse("setup.toml", setup, &[]).unwrap().content;
    /// let text = "G21 G90 T1 M6\nG0 X-10 Y-4 Z-5\nS3000 M3\nG1 X110 F600\nM30"; // a shoulder of 1 mm
    /// let run = Calls::new(text, &Control::default(), &Drives::default(), &setup).unwrap();
    /// let [call] = &run.calls[..] else { panic!() };
    /// let cut: Vec<_> = call.spans.iter().filter(|span| span.cut.is_some()).collect();
    /// let [span] = cut[..] else { panic!("{:?}", call.spans) };
    /// // Its rim touches the stock 3 mm before the edge, and leaves it at the other edge: 103 mm at 10 mm/s.
    /// assert!((span.time - 10.3).abs() < 0.1 && (span.cut.unwrap().feed_per_tooth - 0.05e-3).abs() < 1e-9);
    /// ```
    pub fn new(text: &str, control: &Control, drives: &Drives, setup: &Setup) -> Result<Self, CallError> {
        let program = Program::read(text, control)?;
        let spent = spent(&program, drives);
        let mut follower = Follower::new(setup);
        let mut calls: Vec<Call> = Vec::new();
        for (block, (feed, other)) in program.blocks.iter().zip(&spent) {
            // Blocks before the first tool go with it.
            if calls.last().is_none_or(|call| call.tool.is_some() && block.tool_change) {
                calls.push(Call::default());
            }
            let call = calls.last_mut().expect("a call was begun");
            let mut actions = block.actions.iter().peekable();
            let programmed = block.feed_time();
            let mut idle = *other;
            for (count, motion) in block.motions.iter().enumerate() {
                while let Some((_, action)) = actions.next_if(|(before, _)| *before <= count) {
                    follower.act(*action);
                }
                let cut = follower.motion(motion).map_err(|reason| CallError::NoTool { line: block.line, reason })?;
                let time = if programmed > 0.0 { feed * motion.time / programmed } else { 0.0 };
                if time == 0.0 {
                    continue;
                }
                let tool = follower.tool().and_then(|number| setup.tools.get(&number));
                let conditions = cut
                    .zip(tool)
                    .and_then(|(cut, tool)| conditions(&cut, motion.length / time, follower.speed(), tool));
                let air = cut.map_or(1.0, |cut| cut.air);
                match conditions {
                    Some(conditions) => {
                        idle += time * air;
                        call.path += 1e-3 * motion.length * (1.0 - air);
                        call.push(Span { time: std::mem::take(&mut idle), cut: None });
                        call.push(Span { time: time * (1.0 - air), cut: Some(conditions) });
                    }
                    None => idle += time,
                }
            }
            for (_, action) in actions {
                follower.act(*action);
            }
            call.push(Span { time: idle, cut: None });
            call.tool = call.tool.or(follower.tool().filter(|_| block.tool.is_some() || !block.motions.is_empty()));
        }
        calls.iter_mut().for_each(Call::join);
        Ok(Self { stretches: stretches(&program, &spent, drives.rapid_speed), calls })
    }

    /// As [`Calls::new`], for the files of a program and its setup, on the machine that the setup names; without one at
    /// programmed feeds. The message of an error follows the name of the program's file.
    ///
    /// # Errors
    /// [`CallError`].
    pub fn of_files(program: &Path, setup_file: &Path, setup: &Setup) -> Result<Self, CallError> {
        let bytes = toolroom_form::bytes(program)?;
        let machine = match setup.machine_file(setup_file) {
            Some(path) => Machine::read(&path, &[])?.content,
            None => Machine::default(),
        };
        let mut control = machine.control.for_file(program, None);
        setup.tell(&mut control);
        Self::new(&String::from_utf8_lossy(&bytes), &control, &machine.drives, setup)
    }

    /// Time of the whole program, s.
    pub fn time(&self) -> f64 {
        self.calls.iter().map(|call| call.time).sum()
    }
}

/// Time of every block at feed and on anything else, s.
fn spent(program: &Program, drives: &Drives) -> Vec<(f64, f64)> {
    let mut spent = vec![(0.0, 0.0); program.blocks.len()];
    let (mut timer, mut done) = (Timer::new(drives), Vec::new());
    for (index, block) in program.blocks.iter().enumerate() {
        timer.block(index, block, &mut done);
    }
    timer.finish(program.blocks.len().saturating_sub(1), &mut done);
    for piece in done {
        match piece.part {
            Part::Feed => spent[piece.key].0 += piece.seconds,
            Part::Rapid | Part::Settling | Part::Dwell | Part::Auxiliary | Part::Change | Part::Spindle => {
                spent[piece.key].1 += piece.seconds;
            }
        }
    }
    spent
}

/// Stretches of a program with their times, joined where a log could not tell them apart: blocks of a subprogram have the
/// line of its call.
fn stretches(program: &Program, spent: &[(f64, f64)], rapid_speed: f64) -> Vec<TimedStretch> {
    let mut list: Vec<TimedStretch> = Vec::new();
    for stretch in program.stretches(STRETCH, rapid_speed) {
        let blocks = &program.blocks[Range::clone(&stretch.blocks)];
        let (Some(first), Some(last)) = (blocks.first(), blocks.last()) else { continue };
        let time: f64 = spent[stretch.blocks.clone()].iter().map(|(feed, other)| feed + other).sum();
        let changes = blocks.iter().filter(|block| block.tool_change).count();
        match list.last_mut().filter(|before| before.lines.1 >= first.line) {
            Some(before) => {
                before.lines.1 = before.lines.1.max(last.line);
                (before.tool, before.time, before.changes) = (last.tool, before.time + time, before.changes + changes);
            }
            None => list.push(TimedStretch { lines: (first.line, last.line), tool: last.tool, time, changes }),
        }
    }
    list
}

/// Conditions of a cut at a feed, mm/s, and a spindle speed, rad/s; `None` where nothing is cut.
fn conditions(cut: &Cut, feed: f64, speed: f64, tool: &Tool) -> Option<Conditions> {
    if speed <= 0.0 {
        return None;
    }
    let feed_per_tooth = 1e-3 * feed * TAU / (speed * tool.teeth);
    let (depth_of_cut, width_of_cut) = (cut.mean.depth, cut.mean.width);
    let cuts = cut.air < 1.0 && feed_per_tooth.min(depth_of_cut).min(width_of_cut) >= LEAST;
    let cutting_speed = speed * cut.mean.radius;
    cuts.then_some(Conditions { cutting_speed, feed_per_tooth, depth_of_cut, width_of_cut, down: cut.mean.side <= 0.0 })
}

impl Conditions {
    /// Whether both may be joined: the same speed and side, and nothing that differs by more than `share`.
    fn is_like(&self, other: &Self, share: f64) -> bool {
        let like = |a: f64, b: f64| (a - b).abs() <= share * a.max(b);
        self.cutting_speed == other.cutting_speed
            && self.down == other.down
            && like(self.feed_per_tooth, other.feed_per_tooth)
            && like(self.depth_of_cut, other.depth_of_cut)
            && like(self.width_of_cut, other.width_of_cut)
    }

    /// The mean of both by their times; the width is that which removes the same volume.
    fn mean(&self, time: f64, other: &Self, other_time: f64) -> Self {
        let both = time + other_time;
        let mean = |of: fn(&Self) -> f64| (time * of(self) + other_time * of(other)) / both;
        let feed_per_tooth = mean(|each| each.feed_per_tooth);
        let depth_of_cut = mean(|each| each.depth_of_cut);
        let section = mean(|each| each.feed_per_tooth * each.depth_of_cut * each.width_of_cut);
        Self { feed_per_tooth, depth_of_cut, width_of_cut: section / (feed_per_tooth * depth_of_cut), ..*self }
    }
}

impl Call {
    fn push(&mut self, span: Span) {
        if span.time > 0.0 {
            self.time += span.time;
            self.spans.push(span);
        }
    }

    /// Joins spans whose conditions are alike, and more freely until there are not too many.
    fn join(&mut self) {
        let mut share = ALIKE.0;
        loop {
            let mut joined: Vec<Span> = Vec::new();
            for span in self.spans.drain(..) {
                let last = joined.last_mut().and_then(|last| {
                    let cut = match (last.cut, span.cut) {
                        (None, None) => None,
                        (Some(a), Some(b)) if a.is_like(&b, share) => Some(a.mean(last.time, &b, span.time)),
                        (Some(_), Some(_)) | (None, Some(_)) | (Some(_), None) => return None,
                    };
                    Some((last, cut))
                });
                match last {
                    Some((last, cut)) => *last = Span { time: last.time + span.time, cut },
                    None => joined.push(span),
                }
            }
            self.spans = joined;
            if self.spans.len() <= SPANS || share >= ALIKE.1 {
                return;
            }
            share *= 2.0;
        }
    }
}
