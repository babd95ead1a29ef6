//! Key figures of deliveries.

use super::definition::Better::{Less, More};
use super::definition::{Definition, ShopFigure, define};

/// How long jobs take over what they would without waiting.
pub(super) const FLOW_FACTOR: Definition = define(
    "flow_factor",
    "flow factor",
    "1",
    "1",
    Less,
    "Lead time over the programmed time of the good jobs on the first machine of each operation, without setup.",
);

/// How long nearly all jobs take.
pub(super) const LEAD_TIME_P95: Definition = define(
    "lead_time_p95",
    "lead time, 95 %",
    "s",
    "min",
    Less,
    "Lead time that 95 % of the good jobs do not exceed, within 0.4 %.",
);

/// How long jobs wait.
pub(super) const QUEUE_TIME: Definition = define(
    "queue_time",
    "queue time",
    "s",
    "min",
    Less,
    "Lead time of the good jobs less the time of their operations in process. Of jobs that are in the shop at the start, what was done before counts as waiting.",
);

/// Mean time in a queue (s) of jobs whose lead times and times in process have these sums, s; NaN without a job.
pub(super) fn queue_time(lead_time: f64, in_process: f64, jobs: u32) -> f64 {
    // Jobs that are in work in several places at once would have less than none.
    (lead_time - in_process).max(0.0) / f64::from(jobs)
}

/// Figures of deliveries and of what they wait for, behind the others of the shop.
pub(super) const DELIVERIES: &[ShopFigure] = &[
    (FLOW_FACTOR, |_, t| t.delivery.lead_time / t.delivery.raw_time),
    (
        define(
            "lead_time_p50",
            "lead time, median",
            "s",
            "min",
            Less,
            "Lead time that half of the good jobs do not exceed, within 0.4 %.",
        ),
        |_, t| t.delivery.lead_times.quantile(0.5),
    ),
    (
        define(
            "lead_time_p80",
            "lead time, 80 %",
            "s",
            "min",
            Less,
            "Lead time that 80 % of the good jobs do not exceed, within 0.4 %.",
        ),
        |_, t| t.delivery.lead_times.quantile(0.8),
    ),
    (LEAD_TIME_P95, |_, t| t.delivery.lead_times.quantile(0.95)),
    (
        define(
            "weighted_tardiness",
            "weighted tardiness",
            "s",
            "min",
            Less,
            "Mean of weight times max(0, finish − due) of good jobs, the weight of their order or source; not defined where sources of one part differ in it.",
        ),
        |_, t| t.delivery.weighted_tardiness / f64::from(t.delivery.jobs),
    ),
    (
        define(
            "greatest_tardiness",
            "greatest tardiness",
            "s",
            "min",
            Less,
            "Greatest max(0, finish − due) of good jobs.",
        ),
        |_, t| if t.delivery.jobs > 0 { t.delivery.greatest_tardiness } else { f64::NAN },
    ),
    (
        define(
            "crew_wait",
            "wait for a repair crew",
            "s",
            "min",
            Less,
            "Mean time from a breakdown to the beginning of its repair, by the clock, on machines all of whose breakdowns have a crew; of shops with crews.",
        ),
        |_, t| t.sum(|machine| machine.crew_wait) / t.sum(|machine| machine.repairs_begun),
    ),
    (
        define(
            "on_time",
            "orders on time",
            "1",
            "%",
            More,
            "Share of the orders due by the horizon that had left the shop when they were due, with anything good of them; of shops with orders.",
        ),
        |s, t| t.delivery.on_time(s, s.warm_up + t.window),
    ),
];
