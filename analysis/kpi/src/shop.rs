//! Key figures of the shop.

use super::definition::Better::{Less, More, Neither};
use super::definition::{CURRENCY, ShopFigure, define, net, oee};
use super::delivery_figures::{QUEUE_TIME, queue_time};
use super::machine_tally::MachineTally;
use toolroom_shop::runlog::MachineState;

/// Figures of the shop, in the order of reports; those of [deliveries](super::delivery_figures::DELIVERIES) follow.
pub(super) const SHOP: &[ShopFigure] = &[
    (
        define(
            "parts_per_shift",
            "parts / shift",
            "1",
            "1",
            More,
            "Good parts per shift length of working time (that of the machine longest in shift).",
        ),
        |s, t| f64::from(t.good) / t.shifts(s),
    ),
    (
        define(
            "cost_per_part",
            "cost / part",
            CURRENCY,
            CURRENCY,
            Less,
            "Paid machine time at its rate, edges, dressings and the blanks of scrapped parts, per good part.",
        ),
        |_, t| (t.machine_cost + t.people_cost + t.edge_cost + t.scrap_cost) / f64::from(t.good),
    ),
    (
        define(
            "machine_cost_per_part",
            "machine cost / part",
            CURRENCY,
            CURRENCY,
            Less,
            "Time in shift at the machine's rate, per good part.",
        ),
        |_, t| t.machine_cost / f64::from(t.good),
    ),
    (
        define(
            "edge_cost_per_part",
            "edge cost / part",
            CURRENCY,
            CURRENCY,
            Less,
            "Cutting edges and dressings, counted as they wear, per good part.",
        ),
        |_, t| t.edge_cost / f64::from(t.good),
    ),
    (
        define(
            "scrap_cost_per_part",
            "scrap cost / part",
            CURRENCY,
            CURRENCY,
            Less,
            "Blanks of scrapped parts, per good part.",
        ),
        |_, t| t.scrap_cost / f64::from(t.good),
    ),
    (
        define(
            "edges_per_100_parts",
            "edges / 100 parts",
            "1",
            "1",
            Less,
            "Cutting edges, counted as they wear, per 100 good parts.",
        ),
        |_, t| 100.0 * t.edges / f64::from(t.good),
    ),
    (
        define(
            "dressings_per_100_parts",
            "dressings / 100 parts",
            "1",
            "1",
            Less,
            "Dressing cycles, counted as they wear, per 100 good parts.",
        ),
        |_, t| 100.0 * t.dressings / f64::from(t.good),
    ),
    (define("scrap_rate", "scrap", "1", "%", Less, "Scrapped over finished parts, components included."), |_, t| {
        f64::from(t.scrapped) / t.finished()
    }),
    (
        define(
            "scrap_from_tool_failure",
            "scrap from tool failure",
            "1",
            "%",
            Less,
            "Parts spoiled by a broken edge over finished parts.",
        ),
        |_, t| f64::from(t.scrapped_by_tool) / t.finished(),
    ),
    (
        define(
            "scrap_out_of_tolerance",
            "scrap out of tolerance",
            "1",
            "%",
            Less,
            "Parts whose size error passed the tolerance over finished parts.",
        ),
        |_, t| f64::from(t.out_of_tolerance) / t.finished(),
    ),
    (
        define("scrap_burnt", "burnt parts", "1", "%", Less, "Parts with a burnt surface over finished parts."),
        |_, t| f64::from(t.burnt) / t.finished(),
    ),
    (
        define(
            "scrap_from_chatter",
            "scrap from chatter",
            "1",
            "%",
            Less,
            "Parts too rough by chatter over finished parts; not defined where no structure is given.",
        ),
        |_, t| if t.judged_time > 0.0 { f64::from(t.scrapped_by_chatter) / t.finished() } else { f64::NAN },
    ),
    (
        define(
            "chatter_share",
            "time in chatter",
            "1",
            "%",
            Less,
            "Time in an unstable cut over time in cuts whose stability is judged.",
        ),
        |_, t| t.chatter_time / t.judged_time,
    ),
    (
        define(
            "chatter_onsets_per_shift",
            "chatter onsets / shift",
            "1",
            "1",
            Less,
            "Times that chatter has grown to its limit cycle, per shift length of working time; not defined where no structure is given.",
        ),
        |s, t| if t.judged_time > 0.0 { f64::from(t.chatter_onsets) / t.shifts(s) } else { f64::NAN },
    ),
    (
        define(
            "oee",
            "OEE",
            "1",
            "1",
            More,
            "Overall equipment effectiveness: availability · effectiveness · quality ratio over all machines.",
        ),
        |_, t| {
            let quality = t.sum(|m| m.planned_good) / t.sum(|m| m.planned_produced);
            oee(t.sum(|m| m.earned), t.sum(MachineTally::planned_busy_time), quality)
        },
    ),
    (
        define(
            "availability",
            "availability",
            "1",
            "1",
            More,
            "Production time (cutting and handling) over planned busy time (the calendar's, and overtime).",
        ),
        |_, t| t.sum(MachineTally::production_time) / t.sum(MachineTally::planned_busy_time),
    ),
    (
        define(
            "effectiveness",
            "effectiveness",
            "1",
            "1",
            More,
            "Programmed time of the operations, by the share of each that lies in the window, over production time.",
        ),
        |_, t| t.sum(|m| m.earned) / t.sum(MachineTally::production_time),
    ),
    (
        define(
            "quality_ratio",
            "quality ratio",
            "1",
            "1",
            More,
            "Programmed time of the good over that of all operations completed.",
        ),
        |_, t| t.sum(|m| m.planned_good) / t.sum(|m| m.planned_produced),
    ),
    (
        define(
            "utilisation",
            "utilisation",
            "1",
            "%",
            Neither,
            "Mean over the machines of the share of the shift in which they work on something (also setup, tool change, dressing).",
        ),
        |_, t| t.mean_utilisation(),
    ),
    (
        define("cutting_share", "cutting share", "1", "%", Neither, "Time in cut over time in shift, all machines."),
        |_, t| t.sum(|m| m.state(MachineState::Cutting)) / t.sum(MachineTally::planned_busy_time),
    ),
    (
        define(
            "lead_time",
            "lead time",
            "s",
            "min",
            Less,
            "Mean time from arrival to finish of good jobs: parts, or parts of an order that move together.",
        ),
        |_, t| t.delivery.lead_time / f64::from(t.delivery.jobs),
    ),
    (define("tardiness", "tardiness", "s", "min", Less, "Mean of max(0, finish − due) of good jobs."), |_, t| {
        t.delivery.tardiness / f64::from(t.delivery.jobs)
    }),
    (
        define("tardy_share", "tardy parts", "1", "%", Less, "Share of good jobs that finished after they were due."),
        |_, t| f64::from(t.delivery.tardy) / f64::from(t.delivery.jobs),
    ),
    (define("wip", "work in process", "1", "1", Less, "Time average of the number of jobs in the shop."), |_, t| {
        t.job_time / t.window
    }),
    (
        define(
            "tool_life",
            "tool life",
            "s",
            "min",
            More,
            "Cutting time per edge used on the lathes; the time at work of edges of which only the life is known.",
        ),
        |_, t| t.cell_edge_time / t.cell_edges,
    ),
    (
        define(
            "path_per_edge",
            "path / edge",
            "m",
            "m",
            More,
            "Cutting path per edge used on the lathes; nothing where no path is known.",
        ),
        |_, t| if t.cell_path > 0.0 { t.cell_path / t.cell_edges } else { f64::NAN },
    ),
    (
        define(
            "grinding_time",
            "grinding time / part",
            "s",
            "s",
            Less,
            "Time in cut of the wheels per operation that they did; one that is not whole in the window counts in part.",
        ),
        |_, t| t.wheel_time / t.wheel_parts(),
    ),
    (
        define(
            "edge_failure_share",
            "edges lost to failure",
            "1",
            "%",
            Less,
            "Edges that chipped or collapsed over edges used.",
        ),
        |_, t| t.failed_edges / t.edges,
    ),
    (
        define(
            "mean_cutting_speed",
            "mean cutting speed",
            "m/s",
            "m/min",
            Neither,
            "Cutting speed, averaged over the time in engagement on the lathes; in a shop without one on the mills.",
        ),
        |_, t| t.cell_speed.mean(),
    ),
    (
        define(
            "mean_cutting_speed_turning",
            "mean cutting speed, turning",
            "m/s",
            "m/min",
            Neither,
            "Cutting speed, averaged over the time in engagement, of all turning.",
        ),
        |_, t| t.turning_speed.mean(),
    ),
    (
        define(
            "mean_cutting_speed_milling",
            "mean cutting speed, milling",
            "m/s",
            "m/min",
            Neither,
            "Speed of the cutter's circumference, averaged over the time in engagement, of all milling.",
        ),
        |_, t| t.milling_speed.mean(),
    ),
    (
        define(
            "mean_feed_speed",
            "mean feed speed, milling",
            "m/s",
            "mm/min",
            Neither,
            "Path of the cutters along the feed over their time in engagement.",
        ),
        |_, t| t.milling_path / t.milling_speed.time,
    ),
    (
        define(
            "energy_per_part",
            "energy / part",
            "J",
            "kW h",
            Less,
            "Energy of the cuts and of the idling spindles in shift, per good part.",
        ),
        |_, t| t.energy / f64::from(t.good),
    ),
    (
        define(
            "cell_time_ratio",
            "cell time / programmed time",
            "1",
            "1",
            Less,
            "Cutting and tool change time of the lathes over the programmed cutting time of their good operations; one that is not whole in the window counts in part.",
        ),
        |s, t| t.cell_time_ratio(s),
    ),
    (
        define(
            "parts_offered_per_shift",
            "parts offered / shift",
            "1",
            "1",
            Neither,
            "Jobs in the shop at the start of the statistics and arrived since: the most that could be finished; not defined where arrivals follow departures.",
        ),
        |s, t| t.offered / t.shifts(s),
    ),
    (
        define(
            "nee",
            "NEE",
            "1",
            "1",
            More,
            "Net equipment effectiveness: production and setup over planned busy time, times effectiveness and quality ratio, over all machines.",
        ),
        |_, t| {
            let quality = t.sum(|m| m.planned_good) / t.sum(|m| m.planned_produced);
            let [production, setup] = [MachineTally::production_time, MachineTally::setup_time].map(|of| t.sum(of));
            net(production, setup, oee(t.sum(|m| m.earned), t.sum(MachineTally::planned_busy_time), quality))
        },
    ),
    (
        define(
            "allocation_ratio",
            "allocation",
            "1",
            "%",
            Neither,
            "Busy time (production, setup and delay) over planned busy time, all machines.",
        ),
        |_, t| t.sum(MachineTally::busy_time) / t.sum(MachineTally::planned_busy_time),
    ),
    (
        define(
            "utilisation_efficiency",
            "utilisation efficiency",
            "1",
            "%",
            More,
            "Production time over busy time (production, setup and delay), all machines.",
        ),
        |_, t| t.sum(MachineTally::production_time) / t.sum(MachineTally::busy_time),
    ),
    (
        define(
            "technical_efficiency",
            "technical efficiency",
            "1",
            "%",
            More,
            "Production time over production and delay, all machines.",
        ),
        |_, t| {
            let production = t.sum(MachineTally::production_time);
            production / (production + t.sum(MachineTally::delay_time))
        },
    ),
    (define("setup_ratio", "setup ratio", "1", "%", Less, "Setup over production and setup, all machines."), |_, t| {
        let setup = t.sum(MachineTally::setup_time);
        setup / (t.sum(MachineTally::production_time) + setup)
    }),
    (QUEUE_TIME, |_, t| queue_time(t.delivery.lead_time, t.delivery.in_process, t.delivery.jobs)),
];
