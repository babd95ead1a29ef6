//! What happens to the edges: wear and speed over the time in cut, and how long edges last.

use super::Source;
use crate::figure::plain;
use crate::kpi;
use std::collections::BTreeMap;
use toolroom_chart::page::{Figure, Section};
use toolroom_chart::{Axis, Colour, Histogram, Marker, Plot, Style};
use toolroom_process::unit::convert;
use toolroom_scenario::{Scenario, ToolChangeRule};
use toolroom_shop::runlog::{ChangeReason, PassRow, RunLog};

/// Edges drawn in one fan.
const MOST_EDGES: usize = 60;

/// Policies that get a fan; more would make the file too large to be sent around.
const MOST_FANS: usize = 12;

/// Nothing where no tool has a speed that a policy sets.
pub(super) fn section(source: &Source<'_>) -> Option<Section> {
    if !source.scenario.tools.iter().any(|tool| tool.process.takes_speed_commands()) {
        return None;
    }
    let mut section = Section::new("Speed and wear of the edges");
    for figure in [same_edge(source, Quantity::Speed), same_edge(source, Quantity::Wear)].into_iter().flatten() {
        section = section.figure(figure);
    }
    let policies = 0..source.comparison.policies.len().min(MOST_FANS);
    // All fans on the same axes, so that they can be compared.
    let ends = policies.clone().filter_map(|position| source.log(position)).flat_map(|log| {
        let edges = by_edge(source.scenario, log).into_values().take(MOST_EDGES);
        edges.filter_map(|passes| Quantity::Wear.line(&passes).last().copied()).collect::<Vec<_>>()
    });
    let limits = limits(source, &policies.clone().collect::<Vec<_>>()).into_iter().map(|(_, limit)| (0.0, limit));
    let (longest, deepest) =
        ends.chain(limits).fold((0.0, 0.0), |most: (f64, f64), end| (most.0.max(end.0), most.1.max(end.1)));
    let fans = policies
        .filter_map(|position| Some((source.name(position).to_owned(), fan(source, position, longest, deepest)?)));
    section = section.choice(fans);
    Some(match lives(source) {
        Some(figure) => section.figure(figure),
        None => section,
    })
}

/// Passes of each edge of the lathes, by edge.
fn by_edge<'a>(scenario: &Scenario, log: &'a RunLog) -> BTreeMap<u32, Vec<&'a PassRow>> {
    let lathes = kpi::cell(scenario);
    let mut edges: BTreeMap<u32, Vec<&PassRow>> = BTreeMap::new();
    for row in log.passes.iter().filter(|row| lathes.contains(&(row.machine as usize))) {
        edges.entry(row.edge).or_default().push(row);
    }
    edges
}

#[derive(Clone, Copy, PartialEq)]
enum Quantity {
    Speed,
    Wear,
}

impl Quantity {
    fn axis(self) -> Axis {
        match self {
            Self::Speed => Axis::linear("Cutting speed v", "m/min"),
            Self::Wear => Axis::linear("Flank wear VB", "mm").include(0.0),
        }
    }

    /// Start and end of every pass over the time in cut, min. Wear goes on from pass to pass, speed
    /// may jump.
    fn line(self, passes: &[&PassRow]) -> Vec<(f64, f64)> {
        let minutes = |seconds: f64| convert(seconds, "s", "min");
        let ends = |row: &&PassRow| {
            let (start, end) = match self {
                Self::Speed => (convert(row.speed_start, "m/s", "m/min"), convert(row.speed_end, "m/s", "m/min")),
                Self::Wear => (convert(row.flank_wear_start, "m", "mm"), convert(row.flank_wear_end, "m", "mm")),
            };
            [(minutes(row.edge_time), start), (minutes(row.edge_time + row.cutting_time), end)]
        };
        passes.iter().flat_map(ends).collect()
    }
}

fn time_axis() -> Axis {
    Axis::linear("Cutting time on the edge", "min").include(0.0)
}

/// The first edge of the first lathe under every policy: by common random numbers it is the same
/// piece of carbide.
fn same_edge(source: &Source<'_>, quantity: Quantity) -> Option<Figure> {
    let lathe = *kpi::cell(source.scenario).first()?;
    let title = match quantity {
        Quantity::Speed => "Cutting speed over the life of one edge",
        Quantity::Wear => "Flank wear over the life of one edge",
    };
    let mut chart = Plot::new(title, time_axis(), quantity.axis())
        .describe("One line for each policy, first edge of the first lathe, first replication.");
    let mut any = false;
    for (position, policy) in source.comparison.policies.iter().enumerate() {
        let edges = by_edge(source.scenario, source.log(position)?);
        let Some(passes) = edges.values().find(|passes| passes[0].machine as usize == lathe) else { continue };
        chart = chart.line(policy.name.as_str(), quantity.line(passes), Style::nth(position));
        any = true;
    }
    if quantity == Quantity::Wear {
        for (label, limit) in limits(source, &(0..source.comparison.policies.len()).collect::<Vec<_>>()) {
            chart = chart.horizontal(limit, label);
        }
    }
    let caption = format!(
        "The first edge of {} in the first replication. Under every policy it has the same scatter of wear and the \
         same resistance to chipping; the workpieces are those that reached the machine.",
        source.scenario.machines[lathe].name
    );
    any.then(|| Figure::new(&chart, caption).data_in("the operations table"))
}

/// Wear limits, mm, of the tools that the lathes use and of the policies.
fn limits(source: &Source<'_>, positions: &[usize]) -> Vec<(String, f64)> {
    let mut limits: Vec<(String, f64)> = Vec::new();
    let mut add = |label: String, limit: f64| {
        let limit = convert(limit, "m", "mm");
        if !limits.iter().any(|(_, other)| (other - limit).abs() < 1e-9) {
            limits.push((label, limit));
        }
    };
    for tool in &source.scenario.tools {
        if tool.process.takes_speed_commands() && tool.process.wear_limit().is_finite() {
            add(format!("wear limit of {}", tool.name), tool.process.wear_limit());
        }
    }
    for &position in positions {
        let policy = &source.scenario.policies[source.comparison.policies[position].policy];
        if let ToolChangeRule::WearLimit { limit: Some(limit) } | ToolChangeRule::Predicted { limit: Some(limit) } =
            policy.tool_change
        {
            add("change limit".to_owned(), limit);
        }
    }
    limits
}

/// All edges of a policy with the marks of their ends.
fn fan(source: &Source<'_>, position: usize, longest: f64, deepest: f64) -> Option<Figure> {
    let log = source.log(position)?;
    let edges = by_edge(source.scenario, log);
    let name = source.name(position);
    let (time, wear) = (time_axis().range(0.0, 1.02 * longest), Quantity::Wear.axis().range(0.0, 1.05 * deepest));
    let mut chart = Plot::new(format!("Wear of every edge: {name}"), time, wear)
        .describe(format!("Flank wear against cutting time of each edge of the lathes under {name}."))
        .height(220.0);
    let mut ends: [Vec<(f64, f64)>; 3] = Default::default();
    for (drawn, (&edge, passes)) in edges.iter().take(MOST_EDGES).enumerate() {
        let line = Quantity::Wear.line(passes);
        if let Some(&end) = line.last() {
            match log.edges.get(edge as usize).map(|row| row.reason) {
                Some(ChangeReason::Chipping | ChangeReason::ThermalCollapse) => ends[2].push(end),
                Some(ChangeReason::WearLimit) => ends[1].push(end),
                Some(ChangeReason::EndOfRun) | None => {}
                Some(_) => ends[0].push(end),
            }
        }
        chart = chart.line(if drawn == 0 { "edge" } else { "" }, line, Style::nth(0).colour(Colour::Grey));
    }
    let marks = [
        ("changed by rule", Style::nth(2).marker(Marker::Circle)),
        ("wear limit passed in a pass", Style::nth(4).marker(Marker::Triangle)),
        ("chipped or collapsed", Style::nth(1).marker(Marker::Cross)),
    ];
    let counts: Vec<usize> = ends.iter().map(Vec::len).collect();
    for (points, (label, style)) in ends.into_iter().zip(marks) {
        if !points.is_empty() {
            chart = chart.scatter(label, points, style);
        }
    }
    for (label, limit) in limits(source, &[position]) {
        chart = chart.horizontal(limit, label);
    }
    let which = if edges.len() > MOST_EDGES {
        format!("the first {MOST_EDGES} of {} edges", edges.len())
    } else {
        format!("{} edges", edges.len())
    };
    let caption = format!(
        "{name}, first replication, {which}: {} changed by rule, {} past the wear limit within a pass, {} lost to \
         chipping or collapse{}.",
        counts[0],
        counts[1],
        counts[2],
        if edges.len().min(MOST_EDGES) > counts.iter().sum() {
            "; the others were still in use at the end"
        } else {
            ""
        }
    );
    (!edges.is_empty()).then(|| Figure::new(&chart, caption).data_in("the operations table"))
}

/// Lives of worn-out edges of the pictured policies, on common classes.
fn lives(source: &Source<'_>) -> Option<Figure> {
    let pictured = source.pictured();
    let worn = |position: usize| -> Vec<f64> {
        let lives = source.study.edge_lives(position);
        lives
            .filter(|life| !matches!(life.reason, ChangeReason::Chipping | ChangeReason::ThermalCollapse))
            .map(|life| convert(life.cutting_time, "s", "min"))
            .collect()
    };
    let all: Vec<f64> = pictured.iter().flat_map(|&position| worn(position)).collect();
    let classes: Vec<(f64, f64)> = Histogram::new(all).counts().map(|(from, to, _)| (from, to)).collect();
    let (low, high) = (classes.first()?.0, classes.last()?.1);
    let mut chart = Plot::new(
        "Tool life",
        Axis::linear("Cutting time of an edge", "min"),
        Axis::linear("Share of edges", "%").include(0.0),
    )
    .describe("Histogram of the cutting time of edges that wore out, as staircases on common classes.");
    let mut words = Vec::new();
    for position in pictured {
        let lives = worn(position);
        let failed = source.study.edge_lives(position).count() - lives.len();
        let mut counts = vec![0_u32; classes.len()];
        for life in &lives {
            let class = ((life - low) / (high - low) * classes.len() as f64) as usize;
            counts[class.min(classes.len() - 1)] += 1;
        }
        let share = |count: u32| 100.0 * f64::from(count) / lives.len() as f64;
        let mut steps = vec![(low, 0.0)];
        steps.extend(classes.iter().zip(&counts).map(|(class, &count)| (class.0, share(count))));
        steps.push((high, share(counts[classes.len() - 1])));
        steps.push((high, 0.0));
        chart = chart.step(source.name(position), steps, Style::nth(position));
        words.push(format!(
            "{}: {} edges worn out, {failed} chipped or collapsed ({} %)",
            source.name(position),
            lives.len(),
            plain(100.0 * failed as f64 / (lives.len() + failed) as f64, 0)
        ));
    }
    let caption = format!(
        "Cutting time of the edges that wore out, all replications. {}. Edges still in use at the end are left out.",
        words.join("; ")
    );
    Some(Figure::new(&chart, caption).data_in("the tools table"))
}
