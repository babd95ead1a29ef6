//! All key figures as a table.

use super::Source;
use crate::chart::{Cell, Table};
use crate::figure::{decimals, label, plain, shown};
use crate::page::Section;

pub(super) fn section(source: &Source<'_>) -> Section {
    let names = source.comparison.policies.iter().map(|policy| policy.name.clone());
    let mut table = Table::new(std::iter::once(String::new()).chain(names));
    for (index, kpi) in source.study.kpis.iter().enumerate().filter(|(_, kpi)| kpi.machine.is_none()) {
        let cells = source.comparison.policies.iter().map(|policy| {
            let value = shown(kpi, &policy.kpis[index]);
            let digits = decimals(value.mean, value.half_width);
            let mean = plain(value.mean, digits);
            let interval = value.half_width.is_finite().then(|| format!(" ±{}", plain(value.half_width, digits)));
            Cell::Text(mean + &interval.unwrap_or_default())
        });
        table.push(std::iter::once(Cell::Text(label(source.scenario, kpi))).chain(cells));
    }
    let mut roles = Table::new(["policy", "what it is"]);
    for policy in &source.comparison.policies {
        roles.push([policy.name.as_str().into(), policy.role.describe().into()]);
    }
    Section::new("All key figures")
        .table(format!("Means and 95 % half-widths over {} replications", source.study.replications), table)
        .table("Policies", roles)
}
