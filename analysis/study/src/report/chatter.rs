//! Stability lobes of each machine and tool, and where the policies cut.

use super::Source;
use crate::figure::plain;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use toolroom_chart::page::{Figure, Section};
use toolroom_chart::{Axis, Plot, PointStability, StabilityLobes, Table};
use toolroom_process::unit::convert;
use toolroom_scenario::policies::nominal_limit;
use toolroom_scenario::{Cut, Operation, ProcessModel, Scenario, Work};
use toolroom_shop::runlog::{LogEvent, PassRow, RunLog};

/// Speeds at which the nominal boundary is drawn.
const SPEEDS: usize = 241;
/// Steps of the logarithm of speed within which passes are drawn together.
const TOGETHER: f64 = 0.005;
/// Pairs of machine and tool that get a chart; more would make the file too large to be sent around.
const MOST_PAIRS: usize = 8;

/// The section, where a tool has a structure.
pub(super) fn section(source: &Source<'_>) -> Option<Section> {
    let pairs: Vec<Pair<'_>> = pairs(source.scenario);
    if pairs.is_empty() {
        return None;
    }
    let mut section = Section::new("Stability of the cuts").paragraph(
        "Marks are the passes of the first replication, those of one policy at one spindle speed together at their \
         mean depth. Their colour is the least margin of a pass, 1 − depth/limit, as the run judged it segment by \
         segment with the structure of that machine, the wear of the edge and the place on the work: green stable, \
         orange by less than 10 %, purple unstable. The legend names the worst of each policy. Plus signs are the least \
         limits of these verdicts. Lines are what a controller knows: the nominal structure, with a new edge and with \
         one of median wear.",
    );
    let charts = pairs.iter().take(MOST_PAIRS);
    section = section.choice(charts.filter_map(|pair| Some((pair.name(source.scenario), pair.figure(source)?))));
    if pairs.len() > MOST_PAIRS {
        section =
            section.note(format!("The first {MOST_PAIRS} of {} pairs of machine and tool are drawn.", pairs.len()));
    }
    Some(section.table("Passes of the first replication after the warm-up: mean speed and depth, least margin, share of the time in chatter, times that it set in", table(source, &pairs)))
}

/// A machine and a tool with a structure that it uses.
struct Pair<'a> {
    machine: usize,
    tool: usize,
    /// What they cut: part, number of the operation, operation, its first cut.
    operations: Vec<(u32, u32, &'a Operation, &'a Cut)>,
}

fn pairs(scenario: &Scenario) -> Vec<Pair<'_>> {
    let mut pairs: Vec<Pair<'_>> = Vec::new();
    for (part, description) in (0..).zip(&scenario.parts) {
        for (number, operation) in (0..).zip(&description.operations) {
            let Work::Cutting(cuts) = &operation.work else { continue };
            let Some(cut) = cuts.first() else { continue };
            let Some(tool) = operation.tool else { continue };
            if diameter(scenario, tool, cut).is_none() {
                continue;
            }
            for &machine in &operation.machines {
                let entry = (part, number, operation, cut);
                match pairs.iter_mut().find(|pair| (pair.machine, pair.tool) == (machine, tool)) {
                    Some(pair) => pair.operations.push(entry),
                    None => pairs.push(Pair { machine, tool, operations: vec![entry] }),
                }
            }
        }
    }
    pairs.sort_by_key(|pair| (pair.machine, pair.tool));
    pairs
}

/// Diameter (m) that turns cutting speed into spindle speed, where the stability of a cut is known.
fn diameter(scenario: &Scenario, tool: usize, cut: &Cut) -> Option<f64> {
    let process = &scenario.tools.get(tool)?.process;
    let diameter = match process {
        ProcessModel::Milling(milling) => milling.cutter.diameter,
        ProcessModel::Turning(_) | ProcessModel::Infeed(_) | ProcessModel::Other(_) => cut.diameter,
    };
    (diameter > 0.0 && nominal_limit(process, cut, cut.cutting_speed, 0.0).is_some()).then_some(diameter)
}

/// Spindle speed, rpm, of a cutting speed, m/s.
fn rpm(cutting_speed: f64, diameter: f64) -> f64 {
    60.0 * cutting_speed / (PI * diameter)
}

/// Limit of the depth by which a pass was judged, m; infinite where there is none.
fn limit(row: &PassRow) -> f64 {
    row.depth_of_cut / (1.0 - row.stability_margin)
}

impl Pair<'_> {
    fn name(&self, scenario: &Scenario) -> String {
        format!("{}, {}", scenario.machines[self.machine].name, scenario.tools[self.tool].name)
    }

    /// Judged passes of the pair under a policy, with their diameters.
    fn passes<'l>(&self, source: &Source<'_>, log: &'l RunLog) -> Vec<(&'l PassRow, f64)> {
        let warm = log.warm_up;
        let rows = log.passes.iter().filter(|row| row.machine as usize == self.machine && row.end > warm);
        let judged = rows.filter(|row| row.stability_margin.is_finite());
        let with_diameter = judged.filter_map(|row| {
            let same_operation =
                |entry: &&(u32, u32, &Operation, &Cut)| (entry.0, entry.1) == (row.part, row.operation);
            let (.., cut) = self.operations.iter().find(same_operation)?;
            Some((row, diameter(source.scenario, self.tool, cut)?))
        });
        with_diameter.collect()
    }

    fn names<'a>(&self, source: &Source<'a>) -> (&'a str, &'a str) {
        let scenario = source.scenario;
        (scenario.machines[self.machine].name.as_str(), scenario.tools[self.tool].name.as_str())
    }

    /// The chart; `None` where nothing was cut.
    fn figure(&self, source: &Source<'_>) -> Option<Figure> {
        let millimetres = |depth: f64| convert(depth, "m", "mm");
        let mut marks: BTreeMap<(usize, i64, u8), Vec<(f64, f64)>> = BTreeMap::new();
        let mut limits: BTreeMap<(usize, i64), (f64, f64)> = BTreeMap::new();
        let mut wear = Vec::new();
        for position in 0..source.comparison.policies.len() {
            for (row, diameter) in source.log(position).map_or_else(Vec::new, |log| self.passes(source, log)) {
                let speed = rpm(0.5 * (row.speed_start + row.speed_end), diameter);
                let place = (speed.ln() / TOGETHER).round() as i64;
                let standing = PointStability::from_stable(row.stability_margin >= 0.0, Some(row.stability_margin));
                marks.entry((position, place, standing as u8)).or_default().push((speed, row.depth_of_cut));
                let least = limits.entry((position, place)).or_insert((speed, f64::INFINITY));
                if limit(row) < least.1 {
                    *least = (speed, limit(row));
                }
                wear.push(row.flank_wear_end);
            }
        }
        let (slowest, fastest) = marks
            .values()
            .flatten()
            .fold((f64::INFINITY, 0.0_f64), |(low, high), (speed, _)| (low.min(*speed), high.max(*speed)));
        let deepest = marks.values().flatten().map(|(_, depth)| *depth).fold(0.0, f64::max);
        wear.sort_by(f64::total_cmp);
        let worn = *wear.get(wear.len() / 2)?;
        let (from, to) = (0.8 * slowest, 1.2 * fastest);
        let top = 2.5 * millimetres(deepest);
        let mut lobes = StabilityLobes::default();
        for (_, _, operation, cut) in &self.operations {
            let process = &source.scenario.tools[self.tool].process;
            let Some(diameter) = diameter(source.scenario, self.tool, cut) else { continue };
            let prefix = if self.operations.len() > 1 { format!("{}, ", operation.name) } else { String::new() };
            for (label, wear) in [("new edge", 0.0), ("median wear", worn)] {
                let point = |i: usize| {
                    let speed = from + (to - from) * i as f64 / (SPEEDS - 1) as f64;
                    let cutting_speed = speed / 60.0 * PI * diameter;
                    let depth = nominal_limit(process, cut, cutting_speed, wear).map_or(f64::NAN, millimetres);
                    (speed, if depth <= top { depth } else { f64::NAN })
                };
                lobes = lobes.boundary(format!("nominal limit, {prefix}{label}"), (0..SPEEDS).map(point));
            }
        }
        let limits = limits.into_values().map(|(speed, depth)| (speed, millimetres(depth)));
        lobes = lobes.places("least limit in the run", limits.filter(|(_, depth)| *depth <= top));
        for ((position, _, standing), passes) in marks {
            let count = passes.len() as f64;
            let mean = |of: fn(&(f64, f64)) -> f64| passes.iter().map(of).sum::<f64>() / count;
            let standing = PointStability::ALL[usize::from(standing)];
            lobes =
                lobes.point(source.name(position), (mean(|pass| pass.0), millimetres(mean(|pass| pass.1))), standing);
        }
        let (machine, tool) = self.names(source);
        let speed = Axis::linear("Spindle speed", "rpm").range(from, to);
        let chart = Plot::new(
            format!("Stability lobes: {machine}, {tool}"),
            speed,
            Axis::linear("Depth of cut", "mm").range(0.0, top),
        )
        .height(320.0)
        .describe(format!("Nominal stability limit of {tool} on {machine} and the passes of every policy."))
        .lobes(&lobes);
        let caption =
            format!("{tool} on {machine}. Median wear at the end of a pass: {} mm.", plain(millimetres(worn), 2));
        Some(Figure::new(&chart, caption).data_in("the operations table"))
    }
}

/// Where each policy cut with each pair and how it stood.
fn table(source: &Source<'_>, pairs: &[Pair<'_>]) -> Table {
    let mut table = Table::new([
        "machine and tool",
        "policy",
        "passes",
        "speed, rpm",
        "depth, mm",
        "margin, %",
        "in chatter, %",
        "onsets",
    ]);
    for pair in pairs {
        let (machine, tool) = pair.names(source);
        for (position, policy) in source.comparison.policies.iter().enumerate() {
            let Some(log) = source.log(position) else { continue };
            let passes = pair.passes(source, log);
            if passes.is_empty() {
                continue;
            }
            let count = passes.len() as f64;
            let mean = |of: &dyn Fn(&(&PassRow, f64)) -> f64| passes.iter().map(of).sum::<f64>() / count;
            let speed = mean(&|(row, diameter)| rpm(0.5 * (row.speed_start + row.speed_end), *diameter));
            let share = mean(&|(row, _)| row.chatter_time) / mean(&|(row, _)| row.cutting_time);
            let least = passes.iter().map(|(row, _)| row.stability_margin).fold(f64::INFINITY, f64::min);
            let edges: Vec<u32> = passes.iter().map(|(row, _)| row.edge).collect();
            let onsets = log.events.iter().filter(|event| {
                event.event == LogEvent::ChatterOnset
                    && event.time > log.warm_up
                    && event.machine == Some(pair.machine as u32)
                    && event.edge.is_some_and(|edge| edges.contains(&edge))
            });
            table.push([
                format!("{machine}, {tool}").into(),
                policy.name.as_str().into(),
                passes.len().to_string().into(),
                plain(speed, 0).into(),
                plain(convert(mean(&|(row, _)| row.depth_of_cut), "m", "mm"), 3).into(),
                plain(100.0 * least, 1).into(),
                plain(100.0 * share, 1).into(),
                onsets.count().to_string().into(),
            ]);
        }
    }
    table
}
