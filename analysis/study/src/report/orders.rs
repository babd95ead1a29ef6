//! Orders: which may be late, and how loaded the machines are week by week.

use super::Source;
use crate::figure::plain;
use crate::planner::{Figures, answers, resource_name};
use toolroom_chart::Table;
use toolroom_chart::page::Section;

/// Late orders and load by week; `None` for a scenario without orders.
pub(super) fn section(source: &Source<'_>) -> Option<Section> {
    let scenario = source.scenario;
    let mut section = Section::new("Orders").paragraph(
        "An order is on time in a replication in which its last piece has left the shop when it is due. The interval is \
         that of Wilson for the share of replications. One that is not finished at the horizon is late.",
    );
    let weeks = Figures::of(scenario).weeks;
    for position in source.pictured() {
        let all = answers(scenario, source.study, position)?;
        let name = source.name(position);
        let mut late = Table::new([
            "order",
            "part",
            "customer",
            "quantity",
            "due",
            "finish, half",
            "80 %",
            "95 %",
            "on time, %",
            "from",
            "to",
        ]);
        for answer in all.orders.iter().filter(|answer| answer.on_time < answer.replications) {
            let order = &scenario.orders[answer.order];
            let [half, most, nearly_all] = answer.quantiles.map(|finish| finish.shown(scenario));
            late.push([
                order.id.as_str().into(),
                scenario.parts[order.part].name.as_str().into(),
                order.customer.as_str().into(),
                order.quantity.to_string().into(),
                crate::planner::shown(scenario, order.due).into(),
                half.into(),
                most.into(),
                nearly_all.into(),
                plain(100.0 * answer.share, 0).into(),
                plain(100.0 * answer.interval[0], 0).into(),
                plain(100.0 * answer.interval[1], 0).into(),
            ]);
        }
        section = if all.orders.iter().all(|answer| answer.on_time == answer.replications) {
            section.paragraph(format!("{name}: all {} orders are on time in every replication.", scenario.orders.len()))
        } else {
            section.table(format!("Orders that may be late: {name}"), late)
        };
        let header = std::iter::once("machine, person").chain(weeks.iter().map(|week| week.name.as_str()));
        let mut loads = Table::new(header);
        for resource in 0..scenario.machines.len() + scenario.operators.len() {
            let weeks = all.loads.iter().filter(|answer| answer.resource == resource);
            let cells = weeks.map(|answer| plain(100.0 * answer.load(), 0).into());
            loads.push(std::iter::once(resource_name(scenario, resource).into()).chain(cells));
        }
        section = section.table(format!("Load by week, % of the planned busy time: {name}"), loads);
        let mut queues = Table::new(["station", "jobs, mean", "most, mean", "most, 95 %", "wait, mean, min", "95 %"]);
        for answer in &all.queues {
            let names = answer.machines.iter().map(|&machine| scenario.machines[machine].name.as_str());
            queues.push([
                toolroom_scenario::station_name(names).into(),
                plain(answer.length, 2).into(),
                plain(answer.longest[0], 1).into(),
                plain(answer.longest[1], 1).into(),
                plain(answer.wait[0] / 60.0, 1).into(),
                plain(answer.wait[1] / 60.0, 1).into(),
            ]);
        }
        section = section.table(format!("Queues: {name}"), queues);
    }
    Some(section)
}
