//! The course of a part program over time: where the tool is, how fast it goes and what it bears.

use crate::feeds::{Places, planned};
use toolroom_drives::{Drives, Part, Timer};
use toolroom_program::{Block, Blocks, Control, Motion, Path, Source};
use toolroom_stock::{FeedLimit, FeedPlan, FollowError, Follower, Load, Setup};

/// A part of the way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    /// When it begins, and how long it lasts on the machine, s.
    pub start: f64,
    pub time: f64,
    /// Its ends, mm; not numbers where only the machine knows them.
    pub from: [f64; 3],
    pub to: [f64; 3],
    /// Way, mm, and its time at the commanded feed, s.
    pub length: f64,
    pub commanded: f64,
    pub tool: Option<u32>,
    pub rapid: bool,
    /// Engagement angle at the bound, rad.
    pub angle: f64,
    pub load: Option<Load>,
    /// What keeps a planned feed from being faster.
    pub limit: Option<FeedLimit>,
}

/// Time by tool, s, in the order of [`Part::ALL`].
pub(super) type ToolTime = (Option<u32>, [f64; 7]);

/// A program on its machine, leg by leg.
#[derive(Clone, Debug, Default)]
pub(super) struct Course {
    pub legs: Vec<Leg>,
    pub tools: Vec<ToolTime>,
    /// s.
    pub total: f64,
    /// Whether neighbouring legs were joined, so that only the greatest value of several is known.
    pub joined: bool,
}

/// Legs that pictures are drawn from, at most twice as many (assumption: more than a page has pixels).
const LEGS: usize = 20_000;
/// Greatest angle of an arc that is drawn as a straight line, rad.
const CHORD: f64 = 0.1;
/// Parts of an arc between two samples at most: those of very many turns are drawn coarser (assumption).
const PARTS: f64 = 1000.0;
/// Neighbours whose engagement differs by less, rad, and whose loads differ by a lesser share are one leg.
const ALIKE: (f64, f64) = (0.01, 0.02);

/// Time of a block on motions and on anything else, s.
type Times = (f64, f64);

impl Course {
    /// Runs a program on a machine; through the stock of a setup where there is one, with planned feeds where there is a plan. The
    /// time of a block is shared out among its motions by their commanded times.
    ///
    /// # Errors
    /// [`FollowError`]: the program is refused, or cuts with a tool that the setup does not have.
    pub fn new(
        source: &Source,
        control: &Control,
        drives: &Drives,
        setup: Option<&Setup>,
        plan: &FeedPlan,
    ) -> Result<Self, FollowError> {
        let mut course = Self::default();
        let times = course.times(source, control, drives, plan)?;
        let mut follower = setup.map(Follower::new);
        let (mut index, mut commands) = (0, 0);
        for (block, (moving, other)) in Blocks::new(source.clone(), control)?.zip(times) {
            let block = block?;
            let commanded: f64 = (block.motions.iter().enumerate())
                .flat_map(|(i, motion)| plan.motion(index + i, motion))
                .map(|motion| commanded(&motion, drives))
                .sum();
            // Ways that only the machine knows, as those to the reference point, have no length here.
            let (share, rest) = if commanded > 0.0 { (moving / commanded, 0.0) } else { (0.0, moving) };
            course.total += other + rest;
            let mut actions = block.actions.iter().peekable();
            for (count, motion) in block.motions.iter().enumerate() {
                while let Some((_, action)) = actions.next_if(|(before, _)| *before <= count) {
                    let action = plan.action(&mut commands, *action);
                    follower.iter_mut().for_each(|follower| follower.act(action));
                }
                let limits: Vec<Option<FeedLimit>> = plan.pieces(index).iter().map(|piece| piece.limit).collect();
                for (part, motion) in plan.motion(index, motion).iter().enumerate() {
                    let limit = limits.get(part).copied().flatten();
                    let tool = follower.as_ref().map_or(block.tool, Follower::tool);
                    let whole = Leg {
                        start: course.total,
                        time: share * self::commanded(motion, drives),
                        from: place(motion, 0.0),
                        to: place(motion, 1.0),
                        length: motion.length,
                        commanded: self::commanded(motion, drives),
                        tool,
                        rapid: motion.rapid,
                        angle: 0.0,
                        load: None,
                        limit,
                    };
                    course.motion(motion, &whole, follower.as_mut(), block.line)?;
                    course.total += whole.time;
                }
                index += 1;
            }
            for (_, action) in actions {
                let action = plan.action(&mut commands, *action);
                follower.iter_mut().for_each(|follower| follower.act(action));
            }
        }
        Ok(course)
    }

    /// Time of every block, and of every tool by part.
    fn times(
        &mut self,
        source: &Source,
        control: &Control,
        drives: &Drives,
        plan: &FeedPlan,
    ) -> Result<Vec<Times>, FollowError> {
        let (mut timer, mut done) = (Timer::new(drives), Vec::new());
        let (mut times, mut tools): (Vec<Times>, Vec<usize>) = (Vec::new(), Vec::new());
        let mut places = Places::default();
        for (key, block) in Blocks::new(source.clone(), control)?.enumerate() {
            let block: Block = planned(block?, plan, &mut places);
            tools.push(self.tool(block.tool));
            times.push((0.0, 0.0));
            timer.block(key, &block, &mut done);
            self.spend(&mut done, &mut times, &tools);
        }
        timer.finish(times.len().saturating_sub(1), &mut done);
        self.spend(&mut done, &mut times, &tools);
        Ok(times)
    }

    /// Place of a tool among the times; blocks before the first tool go with it.
    fn tool(&mut self, number: Option<u32>) -> usize {
        if let Some(place) = self.tools.iter().position(|(tool, _)| *tool == number) {
            return place;
        }
        match &mut self.tools[..] {
            [(first @ None, _)] => *first = number,
            _ => self.tools.push((number, [0.0; 7])),
        }
        self.tools.len() - 1
    }

    fn spend(&mut self, done: &mut Vec<toolroom_drives::Spent>, times: &mut [Times], tools: &[usize]) {
        for spent in done.drain(..) {
            let (moving, other) = &mut times[spent.key];
            match spent.part {
                Part::Feed | Part::Rapid | Part::Settling => *moving += spent.seconds,
                Part::Dwell | Part::Auxiliary | Part::Change | Part::Spindle => *other += spent.seconds,
            }
            self.tools[tools[spent.key]].1[spent.part as usize] += spent.seconds;
        }
    }

    /// Adds a motion in as many legs as its path and its load need.
    fn motion(
        &mut self,
        motion: &Motion,
        whole: &Leg,
        follower: Option<&mut Follower<'_>>,
        line: usize,
    ) -> Result<(), FollowError> {
        let mut stretches: Vec<(f64, f64, f64, Option<Load>)> = Vec::new();
        if let Some(follower) = follower {
            let mut note = |from: f64, to: f64, angle: f64, load: Option<Load>| stretches.push((from, to, angle, load));
            follower.motion_traced(motion, &mut note).map_err(|reason| FollowError::NoTool { line, reason })?;
        }
        if stretches.is_empty() {
            stretches.push((0.0, 1.0, 0.0, None));
        }
        let turns = match motion.path {
            Path::Line => 0.0,
            Path::Arc(arc) => arc.angle,
        };
        let mut joined: Option<Leg> = None;
        for (from, to, angle, load) in stretches {
            let parts = ((to - from) * turns / CHORD).ceil().clamp(1.0, PARTS) as u32;
            for part in 0..parts {
                let at = |i: u32| from + (to - from) * f64::from(i) / f64::from(parts);
                let (from, to) = (at(part), at(part + 1));
                let leg = Leg {
                    start: whole.start + whole.time * from,
                    time: whole.time * (to - from),
                    from: place(motion, from),
                    to: place(motion, to),
                    length: whole.length * (to - from),
                    commanded: whole.commanded * (to - from),
                    angle,
                    load,
                    ..*whole
                };
                match &mut joined {
                    Some(last) if turns == 0.0 && last.is_like(&leg) => *last = last.with(&leg),
                    last => self.legs.extend(last.replace(leg)),
                }
            }
        }
        self.legs.extend(joined);
        if self.legs.len() > 2 * LEGS {
            self.thin();
        }
        Ok(())
    }

    /// Joins every two neighbours of one kind; where that is not enough, of any kind.
    fn thin(&mut self) {
        self.joined = true;
        for any in [false, true] {
            let mut thinned: Vec<Leg> = Vec::with_capacity(LEGS);
            let mut open: Option<Leg> = None;
            for leg in self.legs.drain(..) {
                open = match open {
                    Some(last) if any || last.is_kin(&leg) => {
                        thinned.push(last.with(&leg));
                        None
                    }
                    last => {
                        thinned.extend(last);
                        Some(leg)
                    }
                };
            }
            thinned.extend(open);
            self.legs = thinned;
            if self.legs.len() <= LEGS + LEGS / 2 {
                return;
            }
        }
    }
}

impl Leg {
    fn is_kin(&self, other: &Self) -> bool {
        (self.rapid, self.tool, self.limit) == (other.rapid, other.tool, other.limit)
    }

    fn is_like(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() <= ALIKE.1 * a.max(b);
        let loads = match (self.load, other.load) {
            (None, None) => true,
            (Some(a), Some(b)) => near(a.power, b.power) && near(a.normal_force, b.normal_force),
            (None, Some(_)) | (Some(_), None) => false,
        };
        loads && (self.angle - other.angle).abs() < ALIKE.0 && (self.angle > 0.0) == (other.angle > 0.0)
    }

    /// Both as one, with the greater load.
    fn with(&self, next: &Self) -> Self {
        let load = match (self.load, next.load) {
            (Some(a), Some(b)) => Some(a.max(b)),
            (load, None) | (None, load) => load,
        };
        Self {
            time: self.time + next.time,
            to: next.to,
            length: self.length + next.length,
            commanded: self.commanded + next.commanded,
            rapid: self.rapid && next.rapid,
            angle: self.angle.max(next.angle),
            load,
            ..*self
        }
    }
}

/// A place along a motion, mm.
fn place(motion: &Motion, share: f64) -> [f64; 3] {
    if motion.unknown {
        return [f64::NAN; 3];
    }
    let axes = if share <= 0.0 {
        motion.start
    } else if share >= 1.0 {
        motion.end
    } else {
        motion.position(share)
    };
    [axes[0], axes[1], axes[2]]
}

/// Time of a motion as commanded, s.
fn commanded(motion: &Motion, drives: &Drives) -> f64 {
    if motion.rapid { drives.rapid_time(motion) } else { motion.time }
}
