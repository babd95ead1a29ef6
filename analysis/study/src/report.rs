//! The report of a study: what was found, then the pictures that show why.

mod chatter;
mod difference;
mod figures;
mod orders;
mod quality;
mod shop;
mod wear;

use crate::compare::{Comparison, Difference};
use crate::figure::{decimals, factor, label, plain, shown, signed};
use crate::results::RunInfo;
use crate::study::Study;
use crate::terminal::gains;
use toolroom_chart::page::{Provenance, Report, Section, Tile};
use toolroom_scenario::Scenario;
use toolroom_shop::runlog::RunLog;

/// Everything that the sections draw from.
pub(crate) struct Source<'a> {
    pub scenario: &'a Scenario,
    pub study: &'a Study,
    pub comparison: &'a Comparison,
}

impl<'a> Source<'a> {
    /// Policies that get pictures of their own: the baseline, the headline and the rival that the
    /// decision names, in the order of the study.
    fn pictured(&self) -> Vec<usize> {
        let headline = self.headline().map(|difference| difference.policy);
        let mut shown: Vec<usize> = [Some(0), headline, self.comparison.decision.rival].into_iter().flatten().collect();
        shown.sort_unstable();
        shown.dedup();
        shown
    }

    fn headline(&self) -> Option<&'a Difference> {
        self.comparison.headline.map(|index| &self.comparison.differences[index])
    }

    fn name(&self, position: usize) -> &'a str {
        &self.comparison.policies[position].name
    }

    /// Log of the first replication.
    fn log(&self, position: usize) -> Option<&'a RunLog> {
        self.study.first_logs.get(position)
    }
}

/// The report, the same bytes for the same study.
pub fn report(scenario: &Scenario, study: &Study, comparison: &Comparison, info: &RunInfo) -> Report {
    let source = Source { scenario, study, comparison };
    let mut report = Report::new(scenario.title.clone());
    if let Some(reason) = &info.stopped {
        report = report.lead(format!("Complete replications: {}. The next one stopped: {reason}.", study.replications));
    }
    let provenance = Provenance {
        version: info.version.clone(),
        command: info.reproduce.clone(),
        seed: Some(scenario.seed),
        inputs: info.inputs.clone(),
    };
    if study.replications == 0 {
        return report.provenance(provenance);
    }
    if let Some(difference) = source.headline() {
        report = report.lead(sentence(&comparison.decision.line)).lead(sentence(&gains(study, comparison, difference)));
    }
    for tile in tiles(&source) {
        report = report.tile(tile);
    }
    if comparison.policies.len() > 1 {
        report = report.section(difference::section(&source)).section(difference::gain_section(&source));
    }
    if let Some(orders) = orders::section(&source) {
        report = report.section(orders);
    }
    if let Some(quality) = quality::section(&source) {
        report = report.section(quality);
    }
    if let Some(chatter) = chatter::section(&source) {
        report = report.section(chatter);
    }
    report = report
        .section(wear::section(&source))
        .section(shop::schedule_section(&source))
        .section(shop::oee_section(&source))
        .section(figures::section(&source))
        .section(notes(&source));
    report.provenance(provenance)
}

fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
    format!("{first}{}.", letters.as_str())
}

fn tiles(source: &Source<'_>) -> Vec<Tile> {
    let policy = source.headline().map_or(0, |difference| difference.policy);
    let figure = |id: &str| {
        let index = source.study.index(id)?;
        let kpi = &source.study.kpis[index];
        let value = shown(kpi, &source.comparison.policies[policy].kpis[index]);
        let note = match source.headline() {
            Some(difference) => {
                let change = shown(kpi, &difference.kpis[index].difference);
                let digits = decimals(change.mean, change.half_width);
                format!(
                    "{}, {} (95 % CI {} … {}) against {}",
                    source.name(policy),
                    signed(change.mean, digits),
                    signed(change.low(), digits),
                    signed(change.high(), digits),
                    source.name(0)
                )
            }
            None => {
                format!("{}, 95 % CI ±{}", source.name(0), plain(value.half_width, decimals(0.0, value.half_width)))
            }
        };
        let unit = match kpi.definition.display {
            "1" => "",
            "currency" => source.scenario.currency.as_str(),
            unit => unit,
        };
        let number = plain(value.mean, decimals(value.mean, value.half_width));
        Some(Tile::new(kpi.definition.title, format!("{number} {unit}").trim_end(), note))
    };
    let mut tiles: Vec<Tile> =
        ["parts_per_shift", "cost_per_part", "edges_per_100_parts"].into_iter().filter_map(figure).collect();
    if let Some(difference) = source.headline() {
        let value = format!("{} → {}", factor(difference.cell_gain.mean), factor(difference.shop_gain.mean));
        let bottleneck = source.comparison.bottleneck().map_or("–", |station| station.name.as_str());
        tiles.push(Tile::new("cell gain → shop gain", value, format!("the bottleneck is {bottleneck}")));
    }
    tiles
}

fn notes(source: &Source<'_>) -> Section {
    let mut section = Section::new("How to read this");
    if !source.study.complete {
        section = section.warning(format!(
            "The study was stopped early: {} replications are complete under every policy.",
            source.study.replications
        ));
    }
    let definitions = source.study.kpis.iter().filter(|kpi| kpi.machine.is_none());
    section
        .paragraph(
            "All policies see the same arrivals, hardness, edges, breakdowns and sensor noise in a replication, so \
             differences are taken replication by replication. Intervals are 95 % t intervals over the replications; \
             among many comparisons, about one in twenty differences that are none will look certain.",
        )
        .paragraph(
            "The decision compares the adaptive policy of least cost with the constant or scheduled policy of least \
             cost, both picked from the same replications. The oracle knows the true wear; no real controller can.",
        )
        .list(definitions.map(|kpi| format!("{}: {}", label(source.scenario, kpi), kpi.definition.doc)))
}

#[cfg(test)]
mod tests;
