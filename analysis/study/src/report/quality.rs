//! Size and scrap of what grinders grind and of contours: where policies differ by more than time.

use super::Source;
use crate::figure::plain;
use toolroom_chart::page::{Figure, Section};
use toolroom_chart::{Axis, Cell, Histogram, Plot, Style, Table};
use toolroom_process::unit::convert;
use toolroom_scenario::{Operation, ProcessModel, Work};
use toolroom_shop::runlog::{ChangeReason, JobOutcome, PassRow, RunLog};

/// The section, where the shop has such work.
pub(super) fn section(source: &Source<'_>) -> Option<Section> {
    let mut section = Section::new("Size and scrap").paragraph(
        "Size error of ground parts (what is left above the commanded radius) and form error of milled contours, \
         after the last pass of the operation. A part beyond the tolerance is scrap, and so is a burnt one.",
    );
    let mut pictures: Vec<(String, Figure)> = Vec::new();
    let mut tables: Vec<(String, Table)> = Vec::new();
    for (part, description) in source.scenario.parts.iter().enumerate() {
        for (index, operation) in description.operations.iter().enumerate() {
            if matches!(operation.work, Work::Grinding { .. } | Work::Cycle(_) | Work::Contour(_)) {
                let Some(tool) = operation.tool else { continue };
                let place = Place { part: part as u32, operation: index as u32, tool, description: operation };
                let name = format!("{} / {}", description.name, operation.name);
                tables.push((name.clone(), table(source, &place)));
                if let Some(figure) = distribution(source, &place, &name) {
                    pictures.push((name, figure));
                }
            }
        }
    }
    section = section.choice(pictures);
    let caption =
        "first replication: time in cut of a part, size error (mean, 95 % of the parts below, greatest), scrap";
    match &tables[..] {
        [] => None,
        [(name, own)] => Some(section.table(format!("{name}, {caption}"), own.clone())),
        [(_, first), ..] => {
            let mut all = Table::new(std::iter::once("operation").chain(first.columns().iter().map(String::as_str)));
            for (name, own) in &tables {
                for row in own.rows() {
                    all.push(std::iter::once(name.as_str().into()).chain(row.iter().cloned()));
                }
            }
            Some(section.table(format!("Operations, {caption}"), all))
        }
    }
}

/// An operation and where it stands.
struct Place<'a> {
    part: u32,
    operation: u32,
    tool: usize,
    description: &'a Operation,
}

impl Place<'_> {
    /// Its passes, one after the other as they ended.
    fn passes<'l>(&self, log: &'l RunLog) -> impl Iterator<Item = &'l PassRow> {
        let (part, operation) = (self.part, self.operation);
        log.passes.iter().filter(move |row| row.part == part && row.operation == operation)
    }

    /// Size errors after the last pass, um; what the horizon cut short is left out.
    fn sizes(&self, log: &RunLog) -> Vec<f64> {
        let last = self.description.work.passes() as u32 - 1;
        let whole = self.passes(log).filter(|row| row.pass == last && row.end < log.horizon);
        whole.map(|row| convert(row.size_error, "m", "um")).collect()
    }
}

/// Histograms of the pictured policies on common classes, with the tolerance.
fn distribution(source: &Source<'_>, place: &Place<'_>, name: &str) -> Option<Figure> {
    let pictured = source.pictured();
    let sizes: Vec<Vec<f64>> =
        pictured.iter().map(|&position| source.log(position).map_or_else(Vec::new, |log| place.sizes(log))).collect();
    let classes: Vec<(f64, f64)> =
        Histogram::new(sizes.iter().flatten().copied()).counts().map(|(from, to, _)| (from, to)).collect();
    let (low, high) = (classes.first()?.0, classes.last()?.1);
    let mut chart = Plot::new(
        format!("Size error: {name}"),
        Axis::linear("Size error", "um"),
        Axis::linear("Share of parts", "%").include(0.0),
    )
    .describe(format!("Histogram of the size error of {name}, as staircases on common classes."));
    for (&position, sizes) in pictured.iter().zip(&sizes) {
        let mut counts = vec![0_u32; classes.len()];
        for size in sizes {
            let class = ((size - low) / (high - low) * classes.len() as f64) as usize;
            counts[class.min(classes.len() - 1)] += 1;
        }
        let share = |count: u32| 100.0 * f64::from(count) / sizes.len().max(1) as f64;
        let mut steps = vec![(low, 0.0)];
        steps.extend(classes.iter().zip(&counts).map(|(class, &count)| (class.0, share(count))));
        steps.extend([(high, share(counts[classes.len() - 1])), (high, 0.0)]);
        chart = chart.step(source.name(position), steps, Style::nth(position));
    }
    let tolerance = convert(place.description.size_tolerance, "m", "um");
    if tolerance.is_finite() {
        chart = chart.vertical(tolerance, "tolerance");
    }
    let caption = format!("{name}, first replication. Beyond the tolerance a part is scrap.");
    Some(Figure::new(&chart, caption).data_in("the operations table"))
}

fn table(source: &Source<'_>, place: &Place<'_>) -> Table {
    let grinding =
        source.scenario.tools.get(place.tool).is_some_and(|tool| matches!(tool.process, ProcessModel::Infeed(_)));
    let mut head = vec!["policy", "parts", "cut, s", "mean, um", "95 %, um", "most, um"];
    head.extend(["off size, %", "burnt, %"]);
    head.push(if grinding { "parts / dressing" } else { "parts / edge" });
    let mut table = Table::new(head);
    for (position, policy) in source.comparison.policies.iter().enumerate() {
        let Some(log) = source.log(position) else { continue };
        let mut sizes = place.sizes(log);
        sizes.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let count = sizes.len();
        let time: f64 = place.passes(log).filter(|row| row.end < log.horizon).map(|row| row.cutting_time).sum();
        // Of this operation alone: what an inspection elsewhere finds is no size of it.
        let tolerance = convert(place.description.size_tolerance, "m", "um");
        let off_size = 100.0 * sizes.iter().filter(|size| size.abs() > tolerance).count() as f64 / count.max(1) as f64;
        let jobs = log.jobs.iter().filter(|job| job.part == place.part);
        let finished = jobs.clone().filter(|job| job.outcome != JobOutcome::InProcess).count();
        let burnt = 100.0 * jobs.filter(|job| job.outcome == JobOutcome::Burnt).count() as f64 / finished.max(1) as f64;
        let worn = || {
            let tool = place.tool as u32;
            log.edges.iter().filter(move |edge| edge.tool == tool && edge.reason != ChangeReason::EndOfRun)
        };
        let parts = worn().map(|edge| f64::from(edge.parts)).sum::<f64>() / worn().count() as f64;
        let rank =
            |share: f64| sizes.get((share * count as f64) as usize).or(sizes.last()).copied().unwrap_or(f64::NAN);
        let cells = [
            plain(time / count as f64, 2),
            plain(sizes.iter().sum::<f64>() / count as f64, 3),
            plain(rank(0.95), 3),
            plain(rank(1.0), 3),
            plain(off_size, 2),
            plain(burnt, 2),
            plain(parts, 1),
        ];
        let first = [Cell::from(policy.name.as_str()), count.to_string().into()];
        table.push(first.into_iter().chain(cells.map(Cell::from)));
    }
    table
}
