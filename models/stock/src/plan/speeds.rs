//! Spindle speeds of a program inside the limits of its tools.

use super::{FeedObjective, FeedPlan, Open};
use crate::limits::{AtWork, FeedLimit, FeedLimits};
use crate::load::Tool;
use crate::setup::Setup;
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// A spindle command whose speed was planned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpeedChange {
    /// Line of the command.
    pub line: usize,
    /// Tool in the spindle.
    pub tool: u32,
    /// rad/s.
    pub programmed: f64,
    /// rad/s.
    pub planned: f64,
}

/// Spindle commands of a program, by their place among all of them.
#[derive(Clone, Debug, Default)]
pub(super) struct Commands {
    /// Line of each.
    pub lines: Vec<usize>,
    /// Whether something moves at feed under each that has to go as programmed: holes, threads, tools without a parameter set.
    pub fixed: Vec<bool>,
}

impl Commands {
    /// A command comes.
    pub fn push(&mut self, line: usize) {
        self.lines.push(line);
        self.fixed.push(false);
    }

    /// What moves now has to go as programmed.
    pub fn fix(&mut self) {
        if let Some(last) = self.fixed.last_mut() {
            *last = true;
        }
    }

    /// Place of the command in force.
    pub fn current(&self) -> Option<usize> {
        self.lines.len().checked_sub(1)
    }
}

/// Uses of limits that are one: rounding of feeds.
const KEPT: f64 = 1.001;
/// Share by which another speed has to be better than the programmed one.
const BETTER: f64 = 1e-3;

impl FeedPlan {
    /// Chooses a speed for every spindle command under which only planned motions move, and gives it to them: of the speeds of the
    /// machine of the tool's set the one with the least time or cost of its motions at the greatest feeds inside the limits. Where no
    /// speed keeps every limit it is the one that breaks them least.
    pub(super) fn choose_speeds(
        &mut self,
        open: &mut [Open],
        commands: &Commands,
        setup: &Setup,
        limits: &BTreeMap<u32, FeedLimits>,
        objective: FeedObjective,
    ) {
        let mut under: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
        for (place, motion) in open.iter().enumerate() {
            if let Some(command) = motion.command.filter(|command| !commands.fixed[*command]) {
                under.entry(command).or_default().push(place);
            }
        }
        self.commands = vec![None; commands.lines.len()];
        for (command, places) in under {
            let Some(first) = places.first().map(|place| &open[*place]) else { continue };
            let (number, programmed) = (first.tool, first.speed);
            let cuts = places.iter().any(|place| open[*place].cuts().next().is_some());
            // One speed for two tools without a command between them stays.
            if !cuts || places.iter().any(|place| open[*place].tool != number) {
                continue;
            }
            let (tool, limits) = (&setup.tools[&number], &limits[&number]);
            let motions: Vec<&Open> = places.iter().map(|place| &open[*place]).collect();
            let value = |speed: f64| value(&motions, tool, limits, speed, objective);
            let worth = |(broken, value): (f64, f64)| if broken > KEPT { (broken, value) } else { (1.0, value) };
            let better = |a: (f64, f64), b: (f64, f64)| a.0 < b.0 || (a.0 == b.0 && a.1 < b.1 * (1.0 - BETTER));
            let mut best = (programmed, worth(value(programmed)));
            for speed in setup.speeds.get(&number).into_iter().flatten() {
                let trial = worth(value(*speed));
                if better(trial, best.1) {
                    best = (*speed, trial);
                }
            }
            let planned = best.0;
            if planned == programmed {
                continue;
            }
            self.commands[command] = Some(planned);
            self.speeds.push(SpeedChange { line: commands.lines[command], tool: number, programmed, planned });
            for place in places {
                open[place].speed = planned;
            }
        }
    }
}

/// Greatest use of a limit by motions at a speed, rad/s, and their time, s, or cost at the greatest feeds inside the limits.
fn value(motions: &[&Open], tool: &Tool, limits: &FeedLimits, speed: f64, objective: FeedObjective) -> (f64, f64) {
    let at_work = AtWork { tool, limits, speed };
    let (mut broken, mut sum) = (0.0_f64, 0.0);
    for motion in motions {
        let feeds = motion.feeds(&at_work, Some(objective));
        for (step, (feed, _)) in motion.steps.iter().zip(feeds) {
            let time = motion.length * (step.to - step.from) / feed;
            let demands = step.demands();
            for demand in demands {
                let uses = FeedLimit::ALL.into_iter().filter_map(|limit| at_work.ratio(limit, demand, feed));
                broken = uses.fold(broken, f64::max);
            }
            let edges = demands.first().map_or(0.0, |demand| at_work.edge_rate(demand, feed));
            sum += match (objective, limits.economics) {
                (FeedObjective::Time, _) | (FeedObjective::Cost, None) => time,
                (FeedObjective::Cost, Some((rate, price))) => time * (rate + price * edges),
            };
        }
    }
    (broken, sum)
}

/// rpm.
pub(super) fn rpm(speed: f64) -> f64 {
    speed * 60.0 / TAU
}
