//! A part program through its stock: engagement, air, power and force by tool.

use crate::tables::table;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::fmt::Write;
use toolroom_drives::Drives;
use toolroom_process::table::Cell;
use toolroom_program::{Control, EventKind, Motion, Run, Source};
use toolroom_stock::{Cut, FollowError, Follower, Gouge, Load, Setup};

/// What one tool does.
#[derive(Clone, Debug, Default)]
struct Share {
    /// Time at feed in material, s.
    cutting: f64,
    /// Time at feed in air, s.
    air: f64,
    removed: f64,
    sampled: f64,
    bound: f64,
    load: Option<Load>,
    /// Share of the life of an edge that is used.
    wear: Option<f64>,
}

/// Where something is greatest: its value and the line.
pub(crate) type Peak = (f64, usize);

/// A program that has run through its stock.
#[derive(Clone, Debug)]
pub struct Engagement {
    tools: BTreeMap<u32, Share>,
    bound: Peak,
    sampled: Peak,
    power: Option<Peak>,
    force: Option<Peak>,
    deflection: Option<Peak>,
    /// Lines of rapid motions through material and of plunges, the first of each kind first.
    crashes: Vec<usize>,
    plunges: Vec<usize>,
    /// Those of them by tools whose end does not cut at its centre.
    hollow_plunges: Vec<usize>,
    /// Lines of motions in which the holder meets material.
    holders: Vec<usize>,
    /// Motions that cut into the part, with their lines; `None` where the setup has none.
    gouges: Option<Vec<(usize, Gouge)>>,
    removed: f64,
    stock: f64,
    resolution: f64,
    rows: Option<Vec<Row>>,
}

/// A motion in the table.
#[derive(Clone, Debug)]
struct Row {
    line: usize,
    tool: Option<u32>,
    rapid: bool,
    time: f64,
    cut: Cut,
}

const MM: f64 = 1e3;
/// Lines that are kept of motions through material (assumption).
const LINES: usize = 1000;

/// A gouge for programs.
fn gouge_json((line, gouge): &(usize, Gouge)) -> Value {
    json!({
        "line": line,
        "depth [um]": gouge.depth * 1e6,
        "place [mm]": [gouge.place.x * MM, gouge.place.y * MM],
        "length [mm]": gouge.length * MM,
    })
}

impl Engagement {
    /// Follows a program through the stock of a setup. `motions` keeps a row of each motion, with the rapid speeds of these drives.
    ///
    /// # Errors
    /// [`FollowError`]: the program is refused, or cuts with a tool that the setup does not have.
    pub fn new(
        text: impl Into<Source>,
        control: &Control,
        setup: &Setup,
        motions: Option<&Drives>,
    ) -> Result<Self, FollowError> {
        let mut follower = Follower::new(setup);
        let mut study = Self {
            tools: BTreeMap::new(),
            bound: (0.0, 0),
            sampled: (0.0, 0),
            power: None,
            force: None,
            deflection: None,
            crashes: Vec::new(),
            plunges: Vec::new(),
            hollow_plunges: Vec::new(),
            holders: Vec::new(),
            gouges: setup.part.as_ref().map(|_| Vec::new()),
            removed: 0.0,
            stock: setup.stock.volume(),
            resolution: 0.02 * setup.radius(),
            rows: motions.map(|_| Vec::new()),
        };
        for event in Run::new(text, control)? {
            let event = event?;
            match event.kind {
                EventKind::ToolChange(number) => follower.change(number),
                EventKind::Spindle { speed, sense } => follower.spindle(speed, sense),
                EventKind::Home(axes) => follower.home(axes[2]),
                EventKind::Motion(motion) => {
                    let cut =
                        follower.motion(&motion).map_err(|reason| FollowError::NoTool { line: event.line, reason })?;
                    if let Some(cut) = cut {
                        study.held_against(setup, event.line, (&motion, follower.tool()), &cut);
                        let time = motions.map_or(0.0, |drives| drives.rapid_time(&motion)) + motion.time;
                        study.take(event.line, follower.tool(), motion.rapid, time, cut);
                    }
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
        study.removed = follower.cutting().removed();
        study.resolution = follower.cutting().cell().unwrap_or(study.resolution);
        Ok(study)
    }

    /// Notes where a motion cuts into the part that should be left, and where a tool plunges whose end does not cut at its centre.
    fn held_against(&mut self, setup: &Setup, line: usize, (motion, tool): (&Motion, Option<u32>), cut: &Cut) {
        let Some(number) = tool else { return };
        if cut.plunge && setup.hollow.contains(&number) && self.hollow_plunges.len() < LINES {
            self.hollow_plunges.push(line);
        }
        if let (Some(gouges), Some(part), Some(tool)) = (&mut self.gouges, &setup.part, setup.tools.get(&number))
            && gouges.len() < LINES
        {
            gouges.extend(part.gouge(motion, tool).map(|gouge| (line, gouge)));
        }
    }

    fn take(&mut self, line: usize, tool: Option<u32>, rapid: bool, time: f64, cut: Cut) {
        let keep = |lines: &mut Vec<usize>| {
            if lines.len() < LINES && lines.last() != Some(&line) {
                lines.push(line);
            }
        };
        if cut.crash {
            keep(&mut self.crashes);
        }
        if cut.plunge && !rapid {
            keep(&mut self.plunges);
        }
        if cut.holder {
            keep(&mut self.holders);
        }
        if !rapid {
            let share = self.tools.entry(tool.unwrap_or(0)).or_default();
            share.cutting += time * (1.0 - cut.air);
            share.air += time * cut.air;
            share.removed += cut.removed;
            (share.sampled, share.bound) = (share.sampled.max(cut.sampled), share.bound.max(cut.bound));
            if let Some(load) = cut.load {
                share.load = Some(share.load.map_or(load, |before| before.max(load)));
            }
            if let Some(wear) = cut.wear {
                *share.wear.get_or_insert(0.0) += wear;
            }
            let greater = |peak: &mut Peak, value: f64| {
                if value > peak.0 {
                    *peak = (value, line);
                }
            };
            greater(&mut self.sampled, cut.sampled);
            greater(&mut self.bound, cut.bound);
            if let Some(load) = cut.load {
                greater(self.power.get_or_insert((0.0, line)), load.power);
                greater(self.force.get_or_insert((0.0, line)), load.normal_force);
                greater(self.deflection.get_or_insert((0.0, line)), load.deflection);
            }
        }
        if let Some(rows) = &mut self.rows {
            rows.push(Row { line, tool, rapid, time, cut });
        }
    }

    /// Lines of rapid motions that meet material; the first thousand.
    pub fn crashes(&self) -> &[usize] {
        &self.crashes
    }

    /// Lines of motions in which the holder of the tool meets material; the first thousand.
    pub fn holders(&self) -> &[usize] {
        &self.holders
    }

    /// Lines of plunges into material by tools whose end does not cut at its centre; the first thousand.
    pub fn hollow_plunges(&self) -> &[usize] {
        &self.hollow_plunges
    }

    /// Motions that cut into the part that should be left, with their lines; the first thousand.
    pub fn gouges(&self) -> &[(usize, Gouge)] {
        self.gouges.as_deref().unwrap_or_default()
    }

    /// Time at feed in material and in air, s.
    pub(crate) fn times(&self) -> (f64, f64) {
        (self.sum(|share| share.cutting), self.sum(|share| share.air))
    }

    /// Greatest angle of engagement, rad, and its line.
    pub(crate) fn bound(&self) -> Peak {
        self.bound
    }

    /// Greatest power, W, and its line.
    pub(crate) fn power(&self) -> Option<Peak> {
        self.power
    }

    /// Greatest deflection of the tip, m, and its line.
    pub(crate) fn deflection(&self) -> Option<Peak> {
        self.deflection
    }

    fn sum(&self, of: impl Fn(&Share) -> f64) -> f64 {
        // A sum over nothing is -0.
        self.tools.values().map(of).fold(0.0, |sum, value| sum + value)
    }

    /// The result for programs. Every key names its unit; the peak of the engagement is that of the bound and `sampled` that of
    /// the samples; loads are the greatest at both.
    pub fn json(&self) -> Value {
        let tools: Vec<Value> = (self.tools.iter())
            .map(|(tool, share)| {
                json!({
                    "tool": tool,
                    "cutting_time [min]": share.cutting / 60.0,
                    "air_time [s]": share.air,
                    "removed [cm3]": share.removed * 1e6,
                    "peak_engagement [deg]": share.bound.to_degrees(),
                    "peak_power [kW]": share.load.map(|load| load.power * 1e-3),
                    "peak_normal_force [N]": share.load.map(|load| load.normal_force),
                    "peak_deflection [um]": share.load.map(|load| load.deflection * 1e6),
                    "wear": share.wear,
                    "runs_per_edge": share.wear.filter(|wear| *wear > 0.0).map(|wear| 1.0 / wear),
                })
            })
            .collect();
        json!({
            "air_time [s]": self.sum(|share| share.air),
            "cutting_time [s]": self.sum(|share| share.cutting),
            "peak_engagement [deg]": self.bound.0.to_degrees(),
            "peak_engagement_line": self.bound.1,
            "sampled_engagement [deg]": self.sampled.0.to_degrees(),
            "peak_power [kW]": self.power.map(|(power, _)| power * 1e-3),
            "peak_power_line": self.power.map(|(_, line)| line),
            "peak_normal_force [N]": self.force.map(|(force, _)| force),
            "peak_deflection [um]": self.deflection.map(|(deflection, _)| deflection * 1e6),
            "peak_deflection_line": self.deflection.map(|(_, line)| line),
            "removed [cm3]": self.removed * 1e6,
            "stock [cm3]": self.stock * 1e6,
            "resolution [mm]": self.resolution * MM,
            "rapids_through_material": self.crashes,
            "plunges": self.plunges,
            "plunges_without_centre": self.hollow_plunges,
            "holder_in_material": self.holders,
            "gouges": self.gouges.as_ref().map(|list| list.iter().map(gouge_json).collect::<Vec<_>>()),
            "tools": tools,
        })
    }

    /// The result for a terminal.
    pub fn text(&self) -> String {
        let (cutting, air) = (self.sum(|share| share.cutting), self.sum(|share| share.air));
        let share = 100.0 * air / (cutting + air).max(f64::MIN_POSITIVE);
        let mut text = format!(
            "in material {cutting:.1} s, in air {air:.1} s ({share:.1} % of the time at feed); {:.2} of {:.2} cm3 removed\n\
             greatest engagement {:.1} deg (line {}; bound between samples, {:.1} deg sampled)",
            self.removed * 1e6,
            self.stock * 1e6,
            self.bound.0.to_degrees(),
            self.bound.1,
            self.sampled.0.to_degrees()
        );
        if let (Some((power, line)), Some((force, _)), Some((deflection, _))) =
            (self.power, self.force, self.deflection)
        {
            let _ = write!(
                text,
                "\ngreatest power {:.2} kW (line {line}), greatest normal force {force:.0} N, which bends the tip by {:.0} um",
                power * 1e-3,
                deflection * 1e6
            );
        }
        for (tool, share) in &self.tools {
            if let Some(wear) = share.wear.filter(|wear| *wear > 0.0) {
                let _ = write!(
                    text,
                    "\nT{tool} uses {:.2} % of the life of its edges: {:.0} runs each",
                    100.0 * wear,
                    (1.0 / wear).floor()
                );
            }
        }
        if let [first, ..] = self.crashes[..] {
            let count = self.crashes.len();
            let _ = write!(text, "\n! {count} rapid motions meet material (first: line {first})");
        }
        if let [first, ..] = self.holders[..] {
            let count = self.holders.len();
            let _ = write!(text, "\n! the holder meets material in {count} blocks (first: line {first})");
        }
        if let [first, ..] = self.hollow_plunges[..] {
            let count = self.hollow_plunges.len();
            let _ = write!(
                text,
                "\n! a tool that does not cut at its centre plunges in {count} blocks (first: line {first})"
            );
        }
        if let Some((line, gouge)) = self.gouges().iter().reduce(|a, b| if b.1.depth > a.1.depth { b } else { a }) {
            let Gouge { depth, place, length } = gouge;
            let count = self.gouges().len();
            let cut = if count == 1 { "motion cuts" } else { "motions cut" };
            let _ = write!(
                text,
                "\n! {count} {cut} into the part (deepest: line {line}, {:.1} um at X{:.3} Y{:.3} mm, over {:.3} mm)",
                depth * 1e6,
                place.x * MM,
                place.y * MM,
                length * MM
            );
        }
        text
    }

    /// Every motion as CSV; only the header where no table was requested.
    pub fn table(&self) -> String {
        let columns = [
            "line",
            "tool",
            "rapid",
            "time [s]",
            "engagement [deg]",
            "engagement_bound [deg]",
            "depth [mm]",
            "removed [mm3]",
            "air",
            "power [kW]",
            "normal_force [N]",
            "deflection [um]",
            "wear",
        ];
        let row = |row: &Row| -> [Cell<'_>; 13] {
            let load = |of: fn(&Load) -> f64| row.cut.load.as_ref().map(of);
            [
                row.line.into(),
                row.tool.into(),
                u32::from(row.rapid).into(),
                Cell::Fixed(row.time, 6),
                Cell::Fixed(row.cut.sampled.to_degrees(), 4),
                Cell::Fixed(row.cut.bound.to_degrees(), 4),
                Cell::Fixed(row.cut.depth * MM, 6),
                Cell::Fixed(row.cut.removed * 1e9, 6),
                Cell::Fixed(row.cut.air, 6),
                load(|load| load.power * 1e-3).into(),
                load(|load| load.normal_force).into(),
                load(|load| load.deflection * 1e6).into(),
                row.cut.wear.into(),
            ]
        };
        table(columns, self.rows.iter().flatten().map(row))
    }
}
