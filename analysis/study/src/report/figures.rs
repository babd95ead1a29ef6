//! Key figures as a table.

use super::{Source, replications};
use crate::figure::{decimals, is_noise, label, plain, shown};
use toolroom_chart::page::Section;
use toolroom_chart::{Cell, Table};

/// Policies side by side in one table; more do not fit a page of paper.
const COLUMNS: usize = 11;

pub(super) fn section(source: &Source<'_>) -> Section {
    let mut section = Section::new("Key figures");
    let policies = &source.comparison.policies;
    for together in policies.chunks(COLUMNS) {
        let names = together.iter().map(|policy| policy.name.clone());
        let mut table = Table::new(std::iter::once(String::new()).chain(names));
        for (index, kpi) in source
            .study
            .kpis
            .iter()
            .enumerate()
            .filter(|(index, kpi)| kpi.machine.is_none() && source.is_listed(*index))
        {
            let cells = together.iter().map(|policy| {
                let value = shown(kpi, &policy.kpis[index]);
                let digits = decimals(value.mean, value.half_width);
                let mean = plain(value.mean, digits);
                let varies = value.half_width.is_finite() && !is_noise(value.mean, value.half_width);
                let interval = varies.then(|| format!(" ±{}", plain(value.half_width, digits)));
                Cell::Text(mean + &interval.unwrap_or_default())
            });
            table.push(std::iter::once(Cell::Text(label(source.scenario, kpi))).chain(cells));
        }
        let over = replications(source.study.replications);
        let sequential = if source.study.until.is_empty() { "" } else { " (sequential)" };
        section = section.table(format!("Means and 95 % half-widths over {over}{sequential}"), table);
    }
    section
}
