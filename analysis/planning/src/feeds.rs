//! Feeds of a part program inside the limits of its tools: what it gains, and how much of every limit it uses.

use serde_json::{Value, json};
use std::fmt::Write;
use toolroom_chart::Table;
use toolroom_drives::{Drives, Timer};
use toolroom_post::{Form, Post, post_as};
use toolroom_program::{Action, Block, Blocks, Control, ProgramError, Sense, Source};
pub use toolroom_stock::{FeedLimit, FeedObjective};
use toolroom_stock::{FeedPlan, FollowError, LimitUse, Setup};

/// What is asked of the feeds of a program in a setup.
#[derive(Clone, Debug)]
pub struct FeedRequest {
    /// What planned feeds are to reach; `None` only holds those of the program against the limits.
    pub objective: Option<FeedObjective>,
    /// Whether spindle speeds are planned as well.
    pub speeds: bool,
    /// Motions of a plan over those of the program, at most (from 1).
    pub blocks_factor: f64,
    /// The limits that count; none are all of the setup.
    pub limits: Vec<FeedLimit>,
}

/// A program with the use of its limits and, where an objective is given, its planned feeds.
#[derive(Clone, Debug)]
pub struct Feeds {
    plan: FeedPlan,
    objective: Option<FeedObjective>,
    /// Time of the program on the machine, s, as programmed and as planned.
    times: (f64, f64),
}

impl Feeds {
    /// Plans a program as `asked`.
    ///
    /// # Errors
    /// [`FollowError`]: the program is refused, or cuts with a tool that the setup does not have.
    pub fn new(
        source: &Source,
        control: &Control,
        drives: &Drives,
        setup: &Setup,
        asked: &FeedRequest,
    ) -> Result<Self, FollowError> {
        let objective = asked.objective;
        let how = (objective, asked.speeds, asked.blocks_factor);
        let plan = FeedPlan::divided(source.clone(), control, setup, how, &asked.limits)?;
        let before = time(source, control, drives, &FeedPlan::default())?;
        let after = if objective.is_some() { time(source, control, drives, &plan)? } else { before };
        Ok(Self { plan, objective, times: (before, after) })
    }

    /// The planned program in the words of a control.
    ///
    /// # Errors
    /// As [`toolroom_post::post()`].
    pub fn post(&self, source: Source, control: &Control, form: Form) -> Result<Post, ProgramError> {
        let mut commands = 0;
        let speed = |speed: f64, sense: Sense| match self.plan.action(&mut commands, Action::Spindle(speed, sense)) {
            Action::Spindle(speed, _) => speed,
            Action::Change(_) | Action::Home(_) | Action::Coolant(_) | Action::Stop | Action::End => speed,
        };
        post_as(source, control, form, |index, motion| self.plan.motion(index, motion), speed)
    }

    /// The plan; empty without an objective.
    pub(crate) fn plan(&self) -> &FeedPlan {
        &self.plan
    }

    /// Time of the program on the machine as programmed and as planned, s; `None` without an objective.
    pub(crate) fn planned_times(&self) -> Option<(f64, f64)> {
        self.objective.map(|_| self.times)
    }

    /// Use of every limit.
    pub(crate) fn limits_table(&self) -> Table {
        let planned: &[&str] = if self.objective.is_some() { &["planned", "its line", "binds [s]"] } else { &[] };
        let mut table = Table::new(["limit", "programmed", "line"].iter().chain(planned).copied());
        for (limit, used) in &self.plan.limits {
            let line = |(_, line): (f64, usize)| line.to_string().into();
            let cells = [limit.word().into(), used.programmed.0.into(), line(used.programmed)];
            table.push(cells.into_iter().chain([used.planned.0.into(), line(used.planned), used.binds.into()]));
        }
        table
    }

    /// Limits that are broken, with the use of each that stays in the end, and its line.
    pub fn broken(&self) -> Vec<(FeedLimit, f64, usize)> {
        let used = |used: &LimitUse| if self.objective.is_some() { used.planned } else { used.programmed };
        (self.plan.limits.iter())
            .map(|(limit, each)| (*limit, used(each)))
            .filter(|(_, (ratio, _))| *ratio > KEPT)
            .map(|(limit, (ratio, line))| (limit, ratio, line))
            .collect()
    }

    /// The result for programs: `limits` at the programmed feeds, and `planned`, null without an objective.
    pub fn json(&self) -> Value {
        let limits: Vec<Value> = (self.plan.limits.iter())
            .map(
                |(limit, used)| json!({ "limit": limit.word(), "ratio": used.programmed.0, "line": used.programmed.1 }),
            )
            .collect();
        let planned = self.objective.map(|objective| {
            let limits: Vec<Value> = (self.plan.limits.iter())
                .map(|(limit, used)| {
                    json!({
                        "limit": limit.word(), "ratio": used.planned.0, "line": used.planned.1, "binds [s]": used.binds,
                    })
                })
                .collect();
            let kept: Vec<Value> = (self.plan.kept.iter())
                .map(|(why, motions)| json!({ "motions": motions, "reason": why.reason() }))
                .collect();
            let speeds: Vec<Value> = (self.plan.speeds.iter())
                .map(|change| {
                    json!({
                        "line": change.line, "tool": change.tool,
                        "programmed [rpm]": rpm(change.programmed), "planned [rpm]": rpm(change.planned),
                    })
                })
                .collect();
            json!({
                "objective": objective.word(),
                "time [s]": self.times.1,
                "time_as_programmed [s]": self.times.0,
                "blocks": self.plan.motions_planned + self.plan.motions_before,
                "blocks_as_programmed": self.plan.motions_before,
                "limit_ratio": self.plan.limits.values().map(|used| used.planned.0).fold(0.0, f64::max),
                "limits": limits,
                "loss_by_blocks [s]": self.plan.stepped - self.plan.continuous,
                "thin_chips [mm]": self.plan.thin * 1e3,
                "spindle_speeds": speeds,
                "as_programmed": kept,
            })
        });
        json!({ "limits": limits, "planned": planned })
    }

    /// The result for a terminal.
    pub fn text(&self) -> String {
        let (before, after) = self.times;
        let mut text = match self.objective {
            None => "use of the limits at the programmed feeds:".to_owned(),
            Some(_) => format!(
                "planned feeds: {after:.1} s instead of {before:.1} s ({:+.1} %); {} motions at feed for {}, which costs {:.1} s \
                 against a feed that changes with the engagement",
                100.0 * (after / before - 1.0),
                self.plan.motions_planned + self.plan.motions_before,
                self.plan.motions_before,
                self.plan.stepped - self.plan.continuous,
            ),
        };
        if self.plan.limits.is_empty() {
            text += "\nno limit is known: the tools of the setup have neither a parameter set nor limits";
        }
        let _ = write!(text, "\n{:>16} {:>12} {:>7}", "limit", "programmed", "line");
        if self.objective.is_some() {
            let _ = write!(text, " {:>10} {:>7} {:>10}", "planned", "line", "binds [s]");
        }
        for (limit, used) in &self.plan.limits {
            let (programmed, line) = used.programmed;
            let _ = write!(text, "\n{:>16} {programmed:>12.3} {line:>7}", limit.word());
            if self.objective.is_some() {
                let (planned, line) = used.planned;
                let _ = write!(text, " {planned:>10.3} {line:>7} {:>10.1}", used.binds);
            }
        }
        if self.objective.is_some() {
            for (why, motions) in &self.plan.kept {
                let _ = write!(text, "\n{motions} motions at feed as programmed: {}", why.reason());
            }
        }
        for change in &self.plan.speeds {
            let (tool, from, to) = (change.tool, rpm(change.programmed), rpm(change.planned));
            let _ = write!(text, "\nT{tool} turns at {to:.0} rpm instead of {from:.0} (line {})", change.line);
        }
        if self.plan.thin > 0.0 {
            let _ = write!(text, "\nchips are thinner than the least on {:.1} mm", self.plan.thin * 1e3);
        }
        for (limit, ratio, line) in self.broken() {
            let _ = write!(text, "\n! {} is {ratio:.2} times what is allowed (line {line})", limit.word());
            if self.objective.is_some() {
                text += ": no feed that the plan may command keeps it";
            }
        }
        text
    }
}

/// A speed, rad/s, in rpm.
fn rpm(speed: f64) -> f64 {
    speed * 60.0 / std::f64::consts::TAU
}

/// Ratio up to which a limit counts as kept: rounding of feeds.
const KEPT: f64 = 1.001;

/// Time of a program on a machine, s, with planned motions.
fn time(source: &Source, control: &Control, drives: &Drives, plan: &FeedPlan) -> Result<f64, ProgramError> {
    let (mut timer, mut done) = (Timer::new(drives), Vec::new());
    let (mut places, mut total) = (Places::default(), 0.0);
    for (key, block) in Blocks::new(source.clone(), control)?.enumerate() {
        let block = planned(block?, plan, &mut places);
        timer.block(key, &block, &mut done);
        total += done.drain(..).map(|spent| spent.seconds).sum::<f64>();
    }
    timer.finish(0, &mut done);
    Ok(total + done.iter().map(|spent| spent.seconds).sum::<f64>())
}

/// Places of the next motion and of the next spindle command among all of a program.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Places {
    motion: usize,
    command: usize,
}

/// A block with its planned motions and spindle speeds.
pub(crate) fn planned(block: Block, plan: &FeedPlan, places: &mut Places) -> Block {
    let mut motions = Vec::with_capacity(block.motions.len());
    // Number of planned motions before each.
    let mut before = vec![0];
    for motion in &block.motions {
        motions.extend(plan.motion(places.motion, motion));
        before.push(motions.len());
        places.motion += 1;
    }
    let mut action = |action: Action| plan.action(&mut places.command, action);
    let actions = block.actions.iter().map(|(count, each)| (before[*count], action(*each))).collect();
    Block { motions, actions, ..block }
}
