//! What each key figure is called, measured in, and wanted to be.

use super::tally::{MachineTally, Tally};
use Better::{Less, More, Neither};
use toolroom_process::unit;
use toolroom_scenario::Scenario;
use toolroom_shop::runlog::MachineState;

/// Unit of amounts of money: what they are in, the scenario says.
pub const CURRENCY: &str = "currency";

/// Which way a figure should go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Better {
    /// More is better.
    More,
    /// Less is better.
    Less,
    /// Neither is better by itself.
    Neither,
}

/// A key figure in words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Definition {
    /// Stable name in files.
    pub id: &'static str,
    /// For people.
    pub title: &'static str,
    /// SI unit of the value; `1` for a number, `currency` for money.
    pub unit: &'static str,
    /// Unit in tables; `%` only for people, files keep the share.
    pub display: &'static str,
    /// Which way is better.
    pub better: Better,
    /// What it is, in one sentence.
    pub doc: &'static str,
}

/// A key figure of the shop or of one machine.
#[derive(Clone, Debug, PartialEq)]
pub struct Kpi {
    /// What it is.
    pub definition: Definition,
    /// The machine; `None` for the shop.
    pub machine: Option<usize>,
}

impl Kpi {
    /// Key in JSON: the id, with its unit where it has one: `tool_life [min]`.
    pub fn key(&self) -> String {
        match self.definition.file_unit() {
            "1" | CURRENCY => self.definition.id.to_owned(),
            unit => format!("{} [{unit}]", self.definition.id),
        }
    }
}

impl Definition {
    /// Unit in files.
    pub fn file_unit(&self) -> &'static str {
        if self.display == "%" { "1" } else { self.display }
    }

    /// Unit in files, with the currency of the scenario for amounts of money.
    pub fn file_unit_in<'a>(&self, scenario: &'a Scenario) -> &'a str {
        if self.unit == CURRENCY { &scenario.currency } else { self.file_unit() }
    }

    /// Unit in tables for people: empty for plain numbers, the currency of the scenario for amounts of money.
    pub fn shown_unit_in<'a>(&self, scenario: &'a Scenario) -> &'a str {
        match self.display {
            "1" => "",
            CURRENCY => &scenario.currency,
            unit => unit,
        }
    }

    /// Factor from the SI value to the unit of files.
    pub fn file_scale(&self) -> f64 {
        if self.unit == self.file_unit() { 1.0 } else { unit::convert(1.0, self.unit, self.file_unit()) }
    }

    /// Factor from the SI value to the unit of tables for people.
    pub fn display_scale(&self) -> f64 {
        if self.unit == self.display { 1.0 } else { unit::convert(1.0, self.unit, self.display) }
    }
}

pub(super) const fn define(
    id: &'static str,
    title: &'static str,
    unit: &'static str,
    display: &'static str,
    better: Better,
    doc: &'static str,
) -> Definition {
    Definition { id, title, unit, display, better, doc }
}

/// Availability · effectiveness · quality ratio, in which production time cancels. Where nothing was
/// earned it is 0 without a quality; where nothing was completed it is not defined.
pub(super) fn oee(earned: f64, planned_busy_time: f64, quality_ratio: f64) -> f64 {
    if earned > 0.0 { earned / planned_busy_time * quality_ratio } else { 0.0 / planned_busy_time }
}

/// A figure of the shop and how it follows from the sums.
pub(super) type ShopFigure = (Definition, fn(&Scenario, &Tally) -> f64);

/// A figure of a machine.
pub(super) type MachineFigure = (Definition, fn(&Tally, &MachineTally) -> f64);

/// Figures of the shop, in the order of reports.
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
    (define("scrap_rate", "scrap", "1", "%", Less, "Scrapped over finished parts."), |_, t| {
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
    (define("lead_time", "lead time", "s", "min", Less, "Mean time from arrival to finish of good parts."), |_, t| {
        t.lead_time / f64::from(t.good_jobs)
    }),
    (define("tardiness", "tardiness", "s", "min", Less, "Mean of max(0, finish − due) of good parts."), |_, t| {
        t.tardiness / f64::from(t.good_jobs)
    }),
    (
        define("tardy_share", "tardy parts", "1", "%", Less, "Share of good parts that finished after they were due."),
        |_, t| f64::from(t.tardy) / f64::from(t.good_jobs),
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
];
