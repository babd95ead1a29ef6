//! Orders: which may be late, how loaded the machines are week by week, where work waits and how much there is of it.

use super::Source;
use super::replications;
use crate::figure::plain;
use crate::planner::{Answers, Figures, LongestWait, WipAnswer, answers, resource_name, station, ticks};
use toolroom_chart::page::{Figure, Section};
use toolroom_chart::{Axis, Plot, Style, Table};

/// Late orders and load by week; `None` for a scenario without orders.
pub(super) fn section(source: &Source<'_>) -> Option<Section> {
    let scenario = source.scenario;
    let mut section = Section::new("Orders").paragraph(
        "An order is on time in a replication in which its last piece has left the shop when it is due. The interval is \
         that of Wilson for the share of replications. One that is not finished at the horizon is late. Waiting is all time \
         between two operations, or between release and the first one: in a queue, out of shift, for a card, on the way.",
    );
    let (mut orders, mut work) = (Vec::new(), Vec::new());
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
            "waits longest at",
            "there, h",
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
                longest_at(source, &all, answer.longest).into(),
                answer.longest.map_or(String::new(), |longest| plain(longest.wait / 3600.0, 1)).into(),
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
        section = section.table(format!("Queues, most waiting first: {name}"), queues(source, &all));
        let caption = |what: &str| {
            let runs = replications(source.study.replications);
            format!("{name}: {what} Mean over {runs}, and what lies between 10 and 90 % of them.")
        };
        let counted = chart(source, "Orders in the shop", Axis::linear("Orders", ""), &all.wip, |own| own.orders);
        let counted = Figure::new(&counted, caption("orders that are released and not finished.")).data_in("wip.csv");
        let hours = |own: &WipAnswer| own.work.map(|seconds| seconds / 3600.0);
        let asked = chart(source, "Work in the shop", Axis::linear("Work", "h"), &all.wip, hours);
        let what = "mean times of the operations of these orders that have not ended, without setups.";
        orders.push((name.to_owned(), counted));
        work.push((name.to_owned(), Figure::new(&asked, caption(what)).data_in("wip.csv")));
    }
    Some(section.choice(orders).choice(work))
}

/// Name of the station where an order waits longest, with the share of replications where that is not all.
fn longest_at(source: &Source<'_>, all: &Answers, longest: Option<LongestWait>) -> String {
    let Some(longest) = longest else { return String::new() };
    let name = station(source.scenario, &all.queues[longest.station].machines);
    let share = 100.0 * longest.replications as f64 / f64::from(source.study.replications);
    if share < 100.0 { format!("{name} ({share:.0} %)") } else { name }
}

/// Stations, those first at which most time is waited.
fn queues(source: &Source<'_>, all: &Answers) -> Table {
    let mut queues = Table::new([
        "station",
        "wait of all, h",
        "jobs, mean",
        "95 % of the time",
        "most, mean",
        "most, 95 %",
        "wait, mean, min",
        "95 % of the jobs",
    ]);
    let mut stations: Vec<_> = all.queues.iter().collect();
    stations.sort_by(|a, b| b.total.total_cmp(&a.total)); // of equal ones the first by the order of stations
    for answer in stations {
        queues.push([
            station(source.scenario, &answer.machines).into(),
            plain(answer.total / 3600.0, 1).into(),
            plain(answer.length, 2).into(),
            plain(answer.upper_length, 1).into(),
            plain(answer.longest[0], 1).into(),
            plain(answer.longest[1], 1).into(),
            plain(answer.wait[0] / 60.0, 1).into(),
            plain(answer.wait[1] / 60.0, 1).into(),
        ]);
    }
    queues
}

/// A stock over time with its band.
fn chart(source: &Source<'_>, title: &str, y: Axis, wip: &[WipAnswer], of: impl Fn(&WipAnswer) -> [f64; 3]) -> Plot {
    let (horizon, hours) = (source.scenario.horizon, |seconds: f64| seconds / 3600.0);
    let time = match source.scenario.start {
        None => Axis::linear("Time", "h"),
        Some(start) => {
            let ticks = ticks(start, 0.0, horizon).into_iter().map(|(time, date)| (hours(time), date));
            Axis::linear("Midnight of the day", "").ticks(ticks)
        }
    };
    let mut plot = Plot::new(title, time.range(0.0, hours(horizon)), y)
        .describe(format!("{title} over time, with the spread of the replications."));
    if source.study.replications > 1 {
        let band = wip.iter().map(|own| (hours(own.time), of(own)[1], of(own)[2]));
        plot = plot.band("10 to 90 % of the replications", band, Style::nth(2));
    }
    plot.line("mean", wip.iter().map(|own| (hours(own.time), of(own)[0])), Style::nth(0))
}
