//! Policies against each other.

use super::Source;
use crate::figure::{decimals, factor, label, plain, shown};
use crate::kpi::Better;
use toolroom_chart::page::{Figure, Section};
use toolroom_chart::{Axis, Cell, Estimate, Intervals, Table};
use toolroom_statistics::Interval;

/// Figures of the relative chart.
const RELATIVE: [&str; 8] = [
    "parts_per_shift",
    "cost_per_part",
    "edges_per_100_parts",
    "oee",
    "tool_life",
    "path_per_edge",
    "mean_cutting_speed",
    "lead_time",
];

pub(super) fn section(source: &Source<'_>) -> Section {
    let mut section = Section::new("Which policy is better");
    for note in &source.comparison.decision.notes {
        section = section.note(super::sentence(note));
    }
    for id in ["cost_per_part", "parts_per_shift"] {
        if let Some(figure) = by_policy(source, id) {
            section = section.figure(figure);
        }
    }
    let further = [("Key figures", relative(source)), ("Other prices", tornado(source))];
    section = section.choice(further.into_iter().filter_map(|(name, figure)| Some((name.to_owned(), figure?))));
    let caption = match source.pictured_alone() {
        Some(names) => format!("Policies; pictured by themselves: {names}"),
        None => "Policies".to_owned(),
    };
    section.table(caption, super::policies::table(source))
}

/// The difference of the decision at half and at twice each price.
fn tornado(source: &Source<'_>) -> Option<Figure> {
    let comparison = source.comparison;
    let decision = &comparison.decision;
    let (adaptive, rival) = (decision.adaptive?, decision.rival?);
    let [name, other] = [adaptive, rival].map(|policy| source.name(policy));
    let axis = Axis::linear("Difference of cost per part", source.scenario.currency.as_str());
    let title = format!("{name} against {other} at other prices");
    let mut chart =
        Intervals::new(title, axis).tornado("half the price", "twice the price").reference(0.0, "no difference");
    for price in comparison.break_even.iter().filter(|price| price.swing.iter().all(|end| end.mean.is_finite())) {
        let [half, twice] = price.swing.map(|end| end.mean);
        // The difference is linear in a price: at the present one it has gone a third of the way.
        chart = chart.row(price.title, Estimate::new(half + (twice - half) / 3.0, half, twice));
    }
    let caption = format!(
        "Cost of a part under {name} less that under {other}. Bars lead from the present difference to that at half and at \
         twice the price, from the same replications; the settings of the policies are held."
    );
    (!comparison.break_even.is_empty()).then(|| Figure::new(&chart, caption))
}

fn estimate(interval: &Interval) -> Estimate {
    if interval.half_width.is_finite() {
        Estimate::new(interval.mean, interval.low(), interval.high())
    } else {
        interval.mean.into()
    }
}

/// Paired difference of one figure, every policy against the baseline.
fn by_policy(source: &Source<'_>, id: &str) -> Option<Figure> {
    let index = source.study.index(id)?;
    let kpi = &source.study.kpis[index];
    let baseline = source.name(0);
    let unit = kpi.definition.shown_unit_in(source.scenario);
    let axis = Axis::linear(format!("Difference of {}", kpi.definition.title), unit);
    let mut chart = Intervals::new(
        format!("{} against {baseline}", super::sentence(kpi.definition.title).trim_end_matches('.')),
        axis,
    )
    .describe(format!("Paired differences of {} to {baseline} with 95 % intervals.", kpi.definition.title))
    .reference(0.0, "no difference");
    for difference in &source.comparison.differences {
        let change = shown(kpi, &difference.kpis[index].difference);
        chart = chart.row(source.name(difference.policy), estimate(&change));
    }
    let better = match kpi.definition.better {
        Better::More => "To the right is better.",
        Better::Less => "To the left is better.",
        Better::Neither => "",
    };
    let value = shown(kpi, &source.comparison.policies[0].kpis[index]);
    let caption = format!(
        "{} of every policy minus {baseline} ({}), paired over {}, 95 % intervals. {better}",
        super::sentence(&label(source.scenario, kpi)).trim_end_matches('.'),
        plain(value.mean, decimals(value.mean, value.half_width)),
        super::replications(source.study.replications),
    );
    Some(Figure::new(&chart, caption).data_in("summary.json"))
}

/// All figures of the headline policy, as percentages of the baseline.
fn relative(source: &Source<'_>) -> Option<Figure> {
    let difference = source.headline()?;
    let (policy, baseline) = (source.name(difference.policy), source.name(0));
    let mut chart =
        Intervals::new(format!("{policy} against {baseline}"), Axis::linear("Difference to the baseline", "%"))
            .describe(format!("Paired differences of {policy} to {baseline} as percentages of the baseline's mean."))
            .reference(0.0, "no difference");
    for id in RELATIVE {
        let Some(index) = source.study.index(id) else { continue };
        let mean = source.comparison.policies[0].kpis[index].mean;
        let change = difference.kpis[index].difference.scaled(100.0 / mean);
        if change.mean.is_finite() {
            chart = chart.row(source.study.kpis[index].definition.title, estimate(&change));
        }
    }
    let caption = format!(
        "Paired differences of {policy} as percentages of the mean of {baseline}, 95 % intervals. Tool life alone \
         says little: going slower is enough to lengthen it."
    );
    Some(Figure::new(&chart, caption).data_in("summary.json"))
}

/// Why the shop gains less than the cell.
pub(super) fn gain_section(source: &Source<'_>) -> Section {
    // Without a lathe the cell is the whole shop.
    let lathes = source.scenario.tools.iter().any(|tool| tool.process.takes_speed_commands());
    let cell = if lathes { "lathes" } else { "machines" };
    let mut section = Section::new("Cell gain and shop gain").paragraph(format!(
        "The cell gain is the ratio of the parts that the {cell} alone would make, with nothing but cutting and tool \
         changes. The shop gain is the ratio of the parts that leave the shop. Amdahl's law limits the shop gain: \
         only the share of time spent in cut and tool change on the {cell} shrinks, and only until another station \
         is the bottleneck or no more parts are offered.",
    ));
    if let Some(station) = source.comparison.bottleneck() {
        let where_ = if station.in_cell {
            format!("of its occupied time {} % is cutting and tool change", plain(100.0 * station.cell_share, 0))
        } else {
            "the policy does not set the speed there, so a faster cell feeds a queue".to_owned()
        };
        section = section.paragraph(format!(
            "Under {} the bottleneck is {}, occupied {} % of the shift: {where_}.",
            source.name(0),
            station.name,
            plain(100.0 * station.load, 0)
        ));
    }
    let mut gains = Table::new(["policy", "cell gain", "shop gain", "95 % CI of the shop gain", "Amdahl limit"]);
    for difference in &source.comparison.differences {
        let shop = &difference.shop_gain;
        gains.push([
            source.name(difference.policy).into(),
            factor(difference.cell_gain.mean).into(),
            factor(shop.mean).into(),
            // A ratio of numbers of parts is nowhere below zero, however few replications tell it.
            format!("{} … {}", factor(shop.low().max(0.0)), factor(shop.high())).into(),
            factor(difference.amdahl_limit).into(),
        ]);
    }
    let mut stations =
        Table::new(["station", "occupied, %", "in cut, %", "cutting and tool change of occupied time, %"]);
    for station in &source.comparison.stations {
        let share = if station.in_cell {
            Cell::from(plain(100.0 * station.cell_share, 1))
        } else {
            "speed not set by the policy".into()
        };
        stations.push([
            station.name.as_str().into(),
            plain(100.0 * station.load, 1).into(),
            plain(100.0 * station.cutting_share, 1).into(),
            share,
        ]);
    }
    section.table("Gains over the baseline", gains).table("Stations under the baseline", stations)
}
