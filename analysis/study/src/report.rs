//! The report of a study: what was found, then the pictures that show why.

mod chatter;
mod difference;
mod figures;
mod orders;
mod policies;
mod quality;
mod shop;
mod tuned;
mod wear;

use crate::compare::{Comparison, Difference};
use crate::figure::{decimals, factor, label, plain, shown, signed};
use crate::run_info::RunInfo;
use crate::study::Study;
use crate::terminal::{gains, steady_text};
use crate::variants;
use toolroom_chart::page::{Provenance, Report, Section, Tile};
use toolroom_chart::{Cell, Table};
use toolroom_scenario::Scenario;
use toolroom_shop::runlog::RunLog;

/// Everything that the sections draw from.
pub(crate) struct Source<'a> {
    pub scenario: &'a Scenario,
    pub study: &'a Study,
    pub comparison: &'a Comparison,
}

/// Key figures that the report of a shop that cuts leaves to the files: ratios of times that it lists by themselves, and figures of
/// queues and dates.
const IN_FILES: [&str; 12] = [
    "nee",
    "allocation_ratio",
    "utilisation_efficiency",
    "technical_efficiency",
    "setup_ratio",
    "queue_time",
    "flow_factor",
    "lead_time_p50",
    "lead_time_p80",
    "lead_time_p95",
    "weighted_tardiness",
    "greatest_tardiness",
];

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

    /// Names of the policies with pictures of their own, where others have none.
    fn pictured_alone(&self) -> Option<String> {
        let shown = self.pictured();
        let names: Vec<&str> = shown.iter().map(|position| self.name(*position)).collect();
        (shown.len() < self.comparison.policies.len()).then(|| names.join(", "))
    }

    fn headline(&self) -> Option<&'a Difference> {
        self.comparison.headline.map(|index| &self.comparison.differences[index])
    }

    fn name(&self, position: usize) -> &'a str {
        &self.comparison.policies[position].name
    }

    /// Whether a key figure has a value under some policy, and not 0 under all.
    fn is_told(&self, id: &str) -> bool {
        let some = |index: usize| self.comparison.policies.iter().any(|policy| policy.kpis[index].mean != 0.0);
        self.study.index(id).is_some_and(|index| self.is_defined(index) && some(index))
    }

    /// Whether a report lists a key figure of the shop: a value under some policy, and not another view of what stands there.
    fn is_listed(&self, index: usize) -> bool {
        let left_out = !self.scenario.tools.is_empty() && IN_FILES.contains(&self.study.kpis[index].definition.id);
        self.is_defined(index) && !left_out
    }

    /// Whether a key figure of the shop has a value under some policy.
    fn is_defined(&self, index: usize) -> bool {
        self.comparison.policies.iter().any(|policy| policy.kpis[index].count > 0)
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
    for line in steady_text(scenario, study).lines() {
        report = report.lead(sentence(line));
    }
    for tile in tiles(&source) {
        report = report.tile(tile);
    }
    if comparison.policies.len() > 1 {
        report = report.section(difference::section(&source)).section(difference::gain_section(&source));
    }
    if let Some(variants) = variants_section(&source) {
        report = report.section(variants);
    }
    if let Some(orders) = orders::section(&source) {
        report = report.section(orders);
    }
    if let Some(tuning) = study.tuning.as_deref() {
        report = report.section(tuned::section(tuning, &source));
    }
    if let Some(quality) = quality::section(&source) {
        report = report.section(quality);
    }
    if let Some(chatter) = chatter::section(&source) {
        report = report.section(chatter);
    }
    if let Some(wear) = wear::section(&source) {
        report = report.section(wear);
    }
    report = report.section(shop::section(&source)).section(figures::section(&source)).section(notes(&source));
    report.provenance(provenance)
}

pub(crate) fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first: String = letters.next().into_iter().flat_map(char::to_uppercase).collect();
    format!("{first}{}.", letters.as_str())
}

/// A number of replications in words.
fn replications(count: u32) -> String {
    if count == 1 { "1 replication".to_owned() } else { format!("{count} replications") }
}

/// Key figures at the head of a report, the most wanted first; a shop without costs or edges shows others.
const HEADLINES: [&str; 6] =
    ["parts_per_shift", "cost_per_part", "edges_per_100_parts", "lead_time", "tardy_share", "utilisation"];

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
            None if value.half_width.is_finite() => {
                format!("{}, 95 % CI ±{}", source.name(0), plain(value.half_width, decimals(0.0, value.half_width)))
            }
            None => format!("{}, {}", source.name(0), replications(source.study.replications)),
        };
        let unit = kpi.definition.shown_unit_in(source.scenario);
        let number = plain(value.mean, decimals(value.mean, value.half_width));
        Some(Tile::new(kpi.definition.title, format!("{number} {unit}").trim_end(), note))
    };
    let mut tiles: Vec<Tile> =
        HEADLINES.into_iter().filter(|id| source.is_told(id)).take(3).filter_map(figure).collect();
    if let Some(difference) = source.headline() {
        let value = format!("{} → {}", factor(difference.cell_gain.mean), factor(difference.shop_gain.mean));
        let bottleneck = source.comparison.bottleneck().map_or("–", |station| station.name.as_str());
        tiles.push(Tile::new("cell gain → shop gain", value, format!("the bottleneck is {bottleneck}")));
    }
    tiles
}

/// Variants of the shop against the shop as it is.
fn variants_section(source: &Source<'_>) -> Option<Section> {
    let tables = variants::tables(source.scenario, source.study);
    if tables.is_empty() {
        return None;
    }
    let mut section = Section::new("Variants of the shop").paragraph(variants::MEANING.map(sentence).join(" "));
    for shown in tables {
        let mut table =
            Table::new(shown.head.iter().map(|title| if title.is_empty() { "shop" } else { title.as_str() }));
        shown.rows.into_iter().for_each(|row| table.push(row.into_iter().map(Cell::Text)));
        let title = shown.policy.map_or_else(|| "Variants".to_owned(), |policy| format!("Variants under {policy}"));
        section = section.table(title, table);
    }
    if let Some(selection) = &source.study.selection {
        for line in selection.sentences() {
            section = section.note(sentence(line.trim()));
        }
    }
    Some(section)
}

fn notes(source: &Source<'_>) -> Section {
    let mut section = Section::new("How to read this");
    if !source.study.complete {
        section = section.warning(format!(
            "The study was stopped early: {} replications are complete under every policy.",
            source.study.replications
        ));
    }
    let shop = source.study.kpis.iter().enumerate().filter(|(_, kpi)| kpi.machine.is_none());
    let definitions = shop.filter(|(index, _)| source.is_listed(*index)).map(|(_, kpi)| kpi);
    if source.comparison.policies.len() > 1 {
        section = section.paragraph(
            "All policies see the same arrivals, hardness, edges, breakdowns and sensor noise in a replication, so \
             differences are taken replication by replication. Intervals are 95 % t intervals over the replications; \
             among many comparisons, about one in twenty differences that are none will look certain.",
        );
        section = section.paragraph(
            "The decision compares the adaptive policy of least cost with the constant or scheduled policy of least \
             cost, both picked from the same replications. Rules that were tuned before are compared at their best; \
             otherwise the decision holds for the settings of the file only. An oracle knows the true wear; no real \
             controller can.",
        );
    } else if source.study.replications > 1 {
        section = section.paragraph("Intervals are 95 % t intervals over the replications.");
    }
    if let Some(text) = source.study.sequential_text() {
        section = section.paragraph(format!("These are {text}."));
    }
    section.folded(
        "What every key figure is",
        definitions.map(|kpi| format!("{}: {}", label(source.scenario, kpi), kpi.definition.doc)),
    )
}

#[cfg(test)]
mod tests;
