//! Feeds of a program inside the limits of its tools.

use crate::cutting::Encounter;
use crate::follow::{FollowError, Follower};
use crate::limits::{AtWork, Demand, FeedLimit, FeedLimits};
use crate::setup::Setup;
use speeds::{Commands, rpm};
use std::collections::BTreeMap;
use toolroom_program::{Action, Arc, Control, EventKind, Motion, Path, Purpose, Run, Source};

mod kept;
mod speeds;

pub use kept::AsProgrammed;
pub use speeds::SpeedChange;

toolroom_form::vocabulary! {
    /// What planned feeds make least.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum FeedObjective {
        /// Time.
        Time = "time",
        /// Cost of the machine and of the edges.
        Cost = "cost",
    }
}

/// A part of a motion with a feed of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FeedPiece {
    /// Share of the motion at which it ends, 0 to 1.
    pub to: f64,
    /// m/s.
    pub feed: f64,
    /// What keeps it from being faster; `None` in air and where the objective or the program itself does.
    pub limit: Option<FeedLimit>,
}

/// How much of a limit is used, at most.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LimitUse {
    /// At the programmed feeds, over what is allowed, and the line.
    pub programmed: (f64, usize),
    /// At the planned feeds, and the line.
    pub planned: (f64, usize),
    /// Time for which it binds, s, without accelerations.
    pub binds: f64,
}

/// Feeds of a program inside limits.
#[derive(Clone, Debug, Default)]
pub struct FeedPlan {
    /// Parts of every motion of the program, in order; none where it goes as programmed.
    motions: Vec<Vec<FeedPiece>>,
    /// How much of each limit is used.
    pub limits: BTreeMap<FeedLimit, LimitUse>,
    /// Motions that keep the programmed feed, and why.
    pub kept: BTreeMap<AsProgrammed, usize>,
    /// Motions at feed.
    pub motions_before: usize,
    /// The same with those that were divided.
    pub motions_planned: usize,
    /// Time of planned motions at feeds that change wherever the engagement does, and at those of the plan, s, without accelerations.
    pub continuous: f64,
    /// See [`continuous`](Self::continuous).
    pub stepped: f64,
    /// Way with chips thinner than the tools allow, m, at the planned feeds.
    pub thin: f64,
    /// Spindle commands with another speed than the programmed one, in order.
    pub speeds: Vec<SpeedChange>,
    /// Planned speed of every spindle command, rad/s; none where it stays as programmed.
    commands: Vec<Option<f64>>,
}

/// A stretch of a motion between two samples.
#[derive(Clone, Copy, Debug)]
struct Step {
    /// Shares of the motion.
    from: f64,
    to: f64,
    kind: Way,
}

#[derive(Clone, Copy, Debug)]
enum Way {
    /// No material near.
    Air,
    /// None engaged, but some within the margin.
    Near,
    /// At the bound, and at the sample that bends the cutter most.
    Cut([Demand; 2]),
}

/// A motion whose feed may change.
struct Open {
    /// Its place among all motions.
    index: usize,
    line: usize,
    tool: u32,
    /// Place of its spindle command among all of them.
    command: Option<usize>,
    /// rad/s, as programmed and as planned.
    programmed: f64,
    speed: f64,
    /// m.
    length: f64,
    /// Feed of the program, m/s.
    feed: f64,
    /// Whether it may be faster in material than the program has it.
    faster: bool,
    /// Whether it may be divided.
    divisible: bool,
    steps: Vec<Step>,
}

/// A part of a motion is no shorter than this way, m, and this time, s (assumptions: what controls and their axes can follow).
const LEAST_BLOCK: (f64, f64) = (0.5e-3, 0.02);
/// A division of a motion has to save this time, s (assumption).
const SAVES: f64 = 0.01;
/// Feed in air where nothing limits it, m/s: 5 m/min (assumption).
const AIR: f64 = 5.0 / 60.0;

impl FeedPlan {
    /// Motions with those that were divided over motions, at most, where nothing else is said.
    pub const BLOCKS: f64 = 3.0;

    /// Plans the feeds of a program through the stock of a setup, and with `speeds` the spindle speeds as well. Without an objective
    /// nothing is planned, and only the use of the limits at the programmed feeds is worked out. `names` are the limits that count, all
    /// where there is none.
    ///
    /// Every part of a motion gets the greatest feed at which all limits hold at the bound of the engagement on it and at the sample
    /// with the greatest force. A tool whose chip thickness is not limited cuts no thicker chips than it does as programmed,
    /// unless `names` has other limits only.
    /// Motions that go down through material are not made faster: what the end of the cutter meets is not modelled. A limit
    /// that not even the slowest feed keeps is left out, and its use reported.
    ///
    /// # Errors
    /// [`FollowError`]: the program is refused, or cuts with a tool that the setup does not have.
    pub fn new(
        text: impl Into<Source>,
        control: &Control,
        setup: &Setup,
        (objective, speeds): (Option<FeedObjective>, bool),
        names: &[FeedLimit],
    ) -> Result<Self, FollowError> {
        Self::divided(text, control, setup, (objective, speeds, Self::BLOCKS), names)
    }

    /// [`new`](Self::new), with at most `blocks` times as many motions as the program has, of at least 1.
    ///
    /// # Errors
    /// As there.
    pub fn divided(
        text: impl Into<Source>,
        control: &Control,
        setup: &Setup,
        (objective, speeds, blocks): (Option<FeedObjective>, bool, f64),
        names: &[FeedLimit],
    ) -> Result<Self, FollowError> {
        let mut limits: BTreeMap<u32, FeedLimits> =
            setup.limits.iter().map(|(number, limits)| (*number, limits.only(names))).collect();
        let mut plan = Self::default();
        let (mut open, commands) = plan.follow(text, control, setup)?;
        // A tool without a limit of its chips keeps to those that the program cuts, unless other limits are chosen.
        let keeps_chips = names.is_empty() || names.contains(&FeedLimit::ChipThickness);
        let mut thickest: BTreeMap<u32, f64> = BTreeMap::new();
        for motion in &open {
            let teeth = setup.tools[&motion.tool].teeth;
            let feed_per_tooth = motion.feed * std::f64::consts::TAU / (motion.speed * teeth);
            let most = thickest.entry(motion.tool).or_default();
            *most = motion.demands().fold(*most, |most, (demand, _)| most.max(feed_per_tooth * demand.chip));
        }
        for (number, limits) in limits.iter_mut().filter(|_| keeps_chips) {
            limits.chip_thickness = limits.chip_thickness.or(thickest.get(number).copied().filter(|most| *most > 0.0));
        }
        if let Some(objective) = objective.filter(|_| speeds) {
            plan.choose_speeds(&mut open, &commands, setup, &limits, objective);
        }
        let mut saves = SAVES;
        loop {
            let mut trial = plan.clone();
            for motion in &open {
                let at_work =
                    AtWork { tool: &setup.tools[&motion.tool], limits: &limits[&motion.tool], speed: motion.speed };
                trial.take(motion, &at_work, objective, saves);
            }
            let most = blocks.max(1.0) * trial.motions_before as f64;
            if trial.motions_planned as f64 <= most || saves > 1e6 {
                return Ok(trial);
            }
            saves *= 2.0;
        }
    }

    /// Follows the program and gathers what every motion meets.
    fn follow(
        &mut self,
        text: impl Into<Source>,
        control: &Control,
        setup: &Setup,
    ) -> Result<(Vec<Open>, Commands), FollowError> {
        let mut follower = Follower::new(setup);
        let mut commands = Commands::default();
        let mut list = Vec::new();
        for event in Run::new(text, control)? {
            let event = event?;
            match event.kind {
                EventKind::ToolChange(number) => follower.change(number),
                EventKind::Spindle { speed, sense } => {
                    commands.push(event.line);
                    follower.spindle(speed, sense);
                }
                EventKind::Home(axes) => follower.home(axes[2]),
                EventKind::Motion(motion) => {
                    let mut steps = Vec::new();
                    let mut see =
                        |from: f64, to: f64, seen: Encounter<'_>| steps.push(Step { from, to, kind: way(seen) });
                    follower
                        .motion_seen(&motion, Some(&mut see))
                        .map_err(|reason| FollowError::NoTool { line: event.line, reason })?;
                    let index = self.motions.len();
                    self.motions.push(Vec::new());
                    if motion.rapid || motion.time <= 0.0 || motion.length <= 0.0 {
                        continue;
                    }
                    self.motions_before += 1;
                    let Some((number, tool)) =
                        follower.tool().and_then(|number| Some((number, setup.tools.get(&number)?)))
                    else {
                        commands.fix();
                        continue;
                    };
                    let cuts = steps.iter().any(|step| matches!(step.kind, Way::Cut(_)));
                    let reason = if !plannable(&motion) || steps.is_empty() {
                        Some(AsProgrammed::Motion)
                    } else if follower.speed() <= 0.0 {
                        Some(AsProgrammed::Spindle)
                    } else {
                        None
                    };
                    if let Some(reason) = reason {
                        *self.kept.entry(reason).or_default() += 1;
                        commands.fix();
                        continue;
                    }
                    if cuts && tool.force.is_none() {
                        commands.fix();
                        *self.kept.entry(AsProgrammed::Tool).or_default() += 1;
                    }
                    let in_plane = match motion.path {
                        Path::Line => true,
                        Path::Arc(arc) => arc.plane == [0, 1, 2],
                    };
                    list.push(Open {
                        index,
                        line: event.line,
                        tool: number,
                        command: commands.current(),
                        programmed: follower.speed(),
                        speed: follower.speed(),
                        length: 1e-3 * motion.length,
                        feed: 1e-3 * motion.length / motion.time,
                        faster: tool.force.is_some() && motion.end[2] >= motion.start[2],
                        divisible: in_plane,
                        steps,
                    });
                }
                EventKind::Block
                | EventKind::Dwell(_)
                | EventKind::Coolant(_)
                | EventKind::Stop(_)
                | EventKind::Auxiliary(..)
                | EventKind::Hole
                | EventKind::ExactStop
                | EventKind::Offset(_)
                | EventKind::End => {}
            }
        }
        Ok((list, commands))
    }

    /// Plans one motion.
    fn take(&mut self, motion: &Open, at_work: &AtWork<'_>, objective: Option<FeedObjective>, saves: f64) {
        let feeds = motion.feeds(at_work, objective);
        let pieces = if objective.is_some() { divide(motion, &feeds, saves) } else { Vec::new() };
        for (demand, share) in motion.demands() {
            for limit in FeedLimit::ALL {
                let ratio = |feed: f64| at_work.ratio(limit, demand, feed);
                let before = AtWork { speed: motion.programmed, ..*at_work };
                let Some(programmed) = before.ratio(limit, demand, motion.feed) else { continue };
                let entry = self.limits.entry(limit).or_default();
                if programmed > entry.programmed.0 {
                    entry.programmed = (programmed, motion.line);
                }
                let feed = pieces.iter().find(|piece| share < piece.to).map_or(motion.feed, |piece| piece.feed);
                if let Some(planned) = ratio(feed).filter(|planned| *planned > entry.planned.0) {
                    entry.planned = (planned, motion.line);
                }
            }
        }
        let time = |from: f64, to: f64, feed: f64| motion.length * (to - from) / feed;
        let mut from = 0.0;
        for piece in &pieces {
            let lasts = time(from, piece.to, piece.feed);
            self.stepped += lasts;
            if let Some(limit) = piece.limit {
                self.limits.entry(limit).or_default().binds += lasts;
            }
            from = piece.to;
        }
        if objective.is_some() {
            self.continuous +=
                feeds.iter().zip(&motion.steps).map(|((feed, _), step)| time(step.from, step.to, *feed)).sum::<f64>();
        }
        let fewest = std::f64::consts::TAU / (at_work.speed * at_work.tool.teeth);
        for (step, demand) in motion.cuts() {
            let feed = pieces.iter().find(|piece| step.from < piece.to).map_or(motion.feed, |piece| piece.feed);
            if feed * fewest * demand.chip < at_work.limits.least_chip_thickness {
                self.thin += motion.length * (step.to - step.from);
            }
        }
        self.motions_planned += pieces.len().saturating_sub(1);
        self.motions[motion.index] = pieces;
    }

    /// The motion with this place among all motions of the program, as it is planned: in parts where its feed changes.
    pub fn motion(&self, index: usize, motion: &Motion) -> Vec<Motion> {
        match self.motions.get(index).map(Vec::as_slice) {
            None | Some([]) => vec![*motion],
            Some(pieces) => {
                let mut from = 0.0;
                let part = |piece: &FeedPiece| {
                    let part = part(motion, from, piece.to, piece.feed);
                    from = piece.to;
                    part
                };
                pieces.iter().map(part).collect()
            }
        }
    }

    /// An action of the program as it is planned; `commands` is the place of the next spindle command among all of them.
    pub fn action(&self, commands: &mut usize, action: Action) -> Action {
        let Action::Spindle(speed, sense) = action else { return action };
        let planned = self.commands.get(*commands).copied().flatten();
        *commands += 1;
        Action::Spindle(planned.map_or(speed, rpm), sense)
    }

    /// Parts of the motion with this place; none where it goes as programmed.
    pub fn pieces(&self, index: usize) -> &[FeedPiece] {
        self.motions.get(index).map_or(&[], Vec::as_slice)
    }
}

/// What a step meets.
fn way(seen: Encounter<'_>) -> Way {
    match seen {
        Encounter::Air => Way::Air,
        Encounter::Near => Way::Near,
        Encounter::Cut(bound, samples, tool) => {
            let samples = samples.map(|engaged| Demand::from_engaged(engaged, tool));
            Way::Cut([Demand::from_engaged(bound, tool), Demand::heaviest(&samples)])
        }
    }
}

/// Whether the forces of a motion are those of the rim of a cutter that moves across its axis.
fn plannable(motion: &Motion) -> bool {
    let level = matches!(motion.purpose, Purpose::Cut | Purpose::Retract | Purpose::Approach);
    let rotary = (3..9).any(|axis| motion.start[axis] != motion.end[axis]);
    level && !rotary && !motion.unknown
}

/// The part of a motion between two shares of it, with this feed, m/s.
fn part(motion: &Motion, start: f64, end: f64, feed: f64) -> Motion {
    let path = match motion.path {
        Path::Line => Path::Line,
        Path::Arc(arc) => Path::Arc(Arc { angle: arc.angle * (end - start), ..arc }),
    };
    let length = motion.length * (end - start);
    Motion {
        path,
        start: if start > 0.0 { motion.position(start) } else { motion.start },
        end: if end < 1.0 { motion.position(end) } else { motion.end },
        time: 1e-3 * length / feed,
        length,
        ..*motion
    }
}

impl Step {
    /// At the bound, and at the sample that bends the cutter most; nothing in air.
    fn demands(&self) -> &[Demand] {
        match &self.kind {
            Way::Cut(demands) => demands,
            Way::Air | Way::Near => &[],
        }
    }
}

impl Open {
    fn cuts(&self) -> impl Iterator<Item = (&Step, &Demand)> {
        self.steps.iter().filter_map(|step| match &step.kind {
            Way::Cut([bound, _]) => Some((step, bound)),
            Way::Air | Way::Near => None,
        })
    }

    /// What it meets, with the share of the motion where that is.
    fn demands(&self) -> impl Iterator<Item = (&Demand, f64)> {
        self.steps.iter().flat_map(|step| step.demands().iter().map(|demand| (demand, 0.5 * (step.from + step.to))))
    }

    /// The feed of every step, m/s, in steps that a program can name, and what binds it.
    fn feeds(&self, at_work: &AtWork<'_>, objective: Option<FeedObjective>) -> Vec<(f64, Option<FeedLimit>)> {
        let limits = at_work.limits;
        let highest = limits.highest_feed.unwrap_or(self.feed.max(AIR));
        let lowest = limits.lowest_feed.min(self.feed);
        let feed = |step: &Step| match &step.kind {
            Way::Air => Some((limits.air_feed.unwrap_or(highest).min(highest), None)),
            Way::Near => None,
            Way::Cut(demands) => {
                let top = if self.faster { highest } else { self.feed.min(highest) };
                let cheapest = match objective {
                    Some(FeedObjective::Cost) => at_work.cheapest(&demands[0]),
                    Some(FeedObjective::Time) | None => None,
                };
                let top = cheapest.map_or(top, |cheapest| cheapest.min(top));
                let (feed, limit) = at_work.greatest(demands, top, self.feed);
                let limit = limit.or((feed >= highest).then_some(FeedLimit::HighestFeed));
                Some((named(feed).max(lowest), limit))
            }
        };
        // Near material the feed is that of the cut beside it.
        let known: Vec<Option<(f64, Option<FeedLimit>)>> = self.steps.iter().map(feed).collect();
        let cuts = |step: &Step| matches!(step.kind, Way::Cut(_));
        let mut ahead = None;
        let mut feeds: Vec<(f64, Option<FeedLimit>)> = Vec::with_capacity(known.len());
        for i in (0..known.len()).rev() {
            ahead = known[i].filter(|_| cuts(&self.steps[i])).or(ahead.filter(|_| known[i].is_none()));
            feeds.push(known[i].or(ahead).unwrap_or((self.feed.min(highest), None)));
        }
        feeds.reverse();
        for i in 1..feeds.len() {
            let beside = cuts(&self.steps[i - 1]) || known[i - 1].is_none();
            if known[i].is_none() && beside && feeds[i] == (self.feed.min(highest), None) {
                feeds[i] = feeds[i - 1];
            }
        }
        feeds
    }
}

/// The greatest feed that a program names in whole mm/min, or tenths of it, and that is no faster, m/s.
fn named(feed: f64) -> f64 {
    let rate = 60e3 * feed * (1.0 + 1e-12);
    let digits = if rate < 20.0 { 10.0 } else { 1.0 };
    (rate * digits).floor() / digits / 60e3
}

/// Parts of a motion: neighbouring steps are joined at the lesser feed of both until every division saves enough time and no part
/// is too short.
fn divide(motion: &Open, feeds: &[(f64, Option<FeedLimit>)], saves: f64) -> Vec<FeedPiece> {
    let mut pieces: Vec<FeedPiece> = Vec::new();
    for (step, (feed, limit)) in motion.steps.iter().zip(feeds) {
        match pieces.last_mut() {
            Some(last) if last.feed == *feed => last.to = step.to,
            _ => pieces.push(FeedPiece { to: step.to, feed: *feed, limit: *limit }),
        }
    }
    if let Some(last) = pieces.last_mut() {
        last.to = 1.0;
    }
    while pieces.len() > 1 {
        let start = |i: usize| if i == 0 { 0.0 } else { pieces[i - 1].to };
        let way = |i: usize| motion.length * (pieces[i].to - start(i));
        let short = |i: usize| way(i) < LEAST_BLOCK.0 || way(i) / pieces[i].feed < LEAST_BLOCK.1;
        let costs = |i: usize| {
            let slow = pieces[i].feed.min(pieces[i + 1].feed);
            way(i) * (1.0 / slow - 1.0 / pieces[i].feed) + way(i + 1) * (1.0 / slow - 1.0 / pieces[i + 1].feed)
        };
        let due = |i: usize| !motion.divisible || short(i) || short(i + 1);
        let cheapest =
            |list: &mut dyn Iterator<Item = usize>| list.map(|i| (costs(i), i)).min_by(|a, b| a.0.total_cmp(&b.0));
        let joined = cheapest(&mut (0..pieces.len() - 1).filter(|i| due(*i)))
            .or_else(|| cheapest(&mut (0..pieces.len() - 1)).filter(|(cost, _)| *cost < saves));
        let Some((_, i)) = joined else { break };
        let next = pieces.remove(i + 1);
        if next.feed < pieces[i].feed {
            (pieces[i].feed, pieces[i].limit) = (next.feed, next.limit);
        }
        pieces[i].to = next.to;
    }
    pieces
}

#[cfg(test)]
mod tests;
