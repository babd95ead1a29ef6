//! Effects of the shop that a nominal simulation leaves out: catalogue rows beside those of the
//! processes.

use toolroom_effects::{CatalogueEntry, Search, Sign, Touched};
use toolroom_process::{Record, record};

record! {
    /// How a shop deviates from its nominal simulation; every size is neutral at zero.
    ///
    /// Some may be negative: a feed override of 200 % halves the time, times may be shorter than planned, edges changed
    /// sooner, and breakdowns come in bursts.
    pub struct ShopDeviations {
        /// Share by which the programmed time grows: 100 % / override − 1.
        feed_override: Real = 0.0, -0.5..=10.0;
        /// Time per hold.
        feed_hold: Real["s" => "s"] = 0.0, 0.0..=3600.0;
        /// Inverse of the axis acceleration: a block between speeds v0 and v1 runs with trapezoidal speed.
        axis_acceleration: Real["s2/m" => "s2/m"] = 0.0, 0.0..=100.0;
        /// Time per hole.
        canned_cycle_dwell: Real["s" => "s"] = 0.0, 0.0..=60.0;
        /// Stops per running time; each lasts 20 s in the mean (assumption).
        micro_stops: Real["1/s" => "1/h"] = 0.0, 0.0..=1.0;
        /// Time per operation of the shift or operator concerned.
        operator_delay: Real["s" => "s"] = 0.0, -3600.0..=3600.0;
        /// Time per change.
        tool_change_delay: Real["s" => "s"] = 0.0, -3600.0..=3600.0;
        /// Shift of the wear at which an edge is changed.
        tool_change_policy: Real["m" => "mm"] = 0.0, -5e-3..=5e-3;
        /// Weibull shape of the times between breakdowns, less one.
        breakdown_shape: Real = 0.0, -0.9..=10.0;
    }
}

record! {
    /// What a machine adds to the times of part programs, beside the deviations of a shop; every size is neutral at zero.
    pub struct ProgramDeviations {
        /// Time of the spindle from rest to its reference speed, the greatest that the programs command.
        spindle_ramp: Real["s" => "s"] = 0.0, 0.0..=600.0;
        /// Time that the axes need to settle where a stop ends a motion at feed.
        stop_settling: Real["s" => "s"] = 0.0, 0.0..=60.0;
        /// What the inverse acceleration of rapid motions has beside that of the machine file.
        rapid_acceleration: Real["s2/m" => "s2/m"] = 0.0, 0.0..=100.0;
        /// What the time in which an acceleration builds up has beside that of the machine file.
        jerk: Real["s" => "ms"] = 0.0, 0.0..=1.0;
        /// What the inverse of the distance by which corners may be rounded has beside that of the machine file.
        corner_slowing: Real["1/m" => "1/um"] = 0.0, 0.0..=1e9;
        /// What the least time of a motion at feed has beside that of the machine file.
        block_time: Real["s" => "ms"] = 0.0, 0.0..=1.0;
        /// Time of the end of a program, beside waiting for the spindle.
        program_end: Real["s" => "s"] = 0.0, 0.0..=3600.0;
        /// Time of a tool change for each pocket between the old tool and the new one.
        magazine_distance: Real["s" => "s"] = 0.0, 0.0..=60.0;
    }
}

const fn rises(channel: &'static str) -> Touched {
    Touched { channel, sign: Sign::Rises }
}

const fn falls(channel: &'static str) -> Touched {
    Touched { channel, sign: Sign::Falls }
}

/// Every effect of the shop, one row each, in the order of [`ShopDeviations`].
pub const SHOP_EFFECTS: &[CatalogueEntry] = &[
    CatalogueEntry {
        id: "feed_override",
        title: "operators turn the feed override down",
        size: &ShopDeviations::<f64>::FIELDS[0],
        channels: &[rises("cycle_time"), rises("cutting_time")],
        regime: "all feed moves of a shift or operator",
        confounder: "micro_stops",
        separating_test: "log the override beside the cycle",
        source: "NIST smart manufacturing test bed, MTConnect logs of 2017: override not 100 % during a fifth of the active time of one machine",
        processes: &[("shop", Search::Shaped)],
    },
    CatalogueEntry {
        id: "feed_hold",
        title: "operators hold the feed",
        size: &ShopDeviations::<f64>::FIELDS[1],
        channels: &[rises("cycle_time"), rises("feed_hold_time")],
        regime: "operations with holds in the event log",
        confounder: "micro_stops",
        separating_test: "log execution states (INTERRUPTED, FEED_HOLD)",
        source: "MTConnect execution states; constant time per hold is an assumption",
        processes: &[("shop", Search::Shaped)],
    },
    CatalogueEntry {
        id: "axis_acceleration",
        title: "axes need time to accelerate",
        size: &ShopDeviations::<f64>::FIELDS[2],
        channels: &[rises("cycle_time"), rises("cutting_time")],
        regime: "programs of many short blocks",
        confounder: "rapid override",
        separating_test: "time a program of long and one of short blocks",
        source: "trapezoidal speed profile between block ends (assumption: one acceleration for all axes)",
        processes: &[("shop", Search::Shaped)],
    },
    CatalogueEntry {
        id: "canned_cycle_dwell",
        title: "canned cycles dwell at the bottom of the hole",
        size: &ShopDeviations::<f64>::FIELDS[3],
        channels: &[rises("cycle_time")],
        regime: "programs with holes, by their number",
        confounder: "tool_change_delay",
        separating_test: "time a program with twice the holes",
        source: "G-code P word of G82 and G89; constant time is an assumption",
        processes: &[("shop", Search::Shaped)],
    },
    CatalogueEntry {
        id: "micro_stops",
        title: "short stops that nobody books",
        size: &ShopDeviations::<f64>::FIELDS[4],
        channels: &[
            rises("cycle_time"),
            rises("stop_count"),
            rises("stop_time"),
            rises("cutting_tail"),
            rises("cutting_excess"),
            rises("cutting_spread"),
        ],
        regime: "a tail of long cycles, in proportion to their length",
        confounder: "feed_override",
        separating_test: "log every stop for a shift",
        source: "Nakajima, Introduction to TPM (1988): idling and minor stoppages; Poisson stops are an assumption",
        processes: &[("shop", Search::Shaped)],
    },
    CatalogueEntry {
        id: "operator_delay",
        title: "operators come late to the machine",
        size: &ShopDeviations::<f64>::FIELDS[5],
        channels: &[rises("cycle_time"), rises("handling_time")],
        regime: "one shift or operator",
        confounder: "setup time",
        separating_test: "one operator at two shifts",
        source: "assumption: constant time per operation",
        processes: &[("shop", Search::Shaped)],
    },
    CatalogueEntry {
        id: "tool_change_delay",
        title: "a tool change takes longer than planned",
        size: &ShopDeviations::<f64>::FIELDS[6],
        channels: &[rises("cycle_time"), rises("tool_change_time")],
        regime: "the first operation of an edge",
        confounder: "operator_delay",
        separating_test: "time ten changes",
        source: "assumption: constant time per change",
        processes: &[("shop", Search::Shaped)],
    },
    CatalogueEntry {
        id: "tool_change_policy",
        title: "edges are changed at another wear than planned",
        size: &ShopDeviations::<f64>::FIELDS[7],
        channels: &[rises("flank_wear"), rises("edge_life")],
        regime: "the last operation of an edge",
        confounder: "chipping",
        separating_test: "measure every edge that is taken out",
        source: "assumption: constant shift of the limit",
        processes: &[("shop", Search::Shaped)],
    },
    CatalogueEntry {
        id: "breakdown_shape",
        title: "breakdowns come in bursts or after wear",
        size: &ShopDeviations::<f64>::FIELDS[8],
        channels: &[rises("stop_time"), falls("failure_interval")],
        regime: "times between breakdowns",
        confounder: "breakdown rate",
        separating_test: "log breakdowns for a quarter of a year",
        source: "Weibull renewal of repairable machines (Rigdon & Basu 2000), recalled",
        processes: &[("shop", Search::Shaped)],
    },
];

/// Every effect that only part programs show, one row each, in the order of [`ProgramDeviations`].
pub const PROGRAM_EFFECTS: &[CatalogueEntry] = &[
    CatalogueEntry {
        id: "spindle_ramp",
        title: "the spindle needs time to come to speed and to rest",
        size: &ProgramDeviations::<f64>::FIELDS[0],
        channels: &[rises("cycle_time")],
        regime: "tool changes and stops of the spindle, by the square of its speed",
        confounder: "tool_change_delay",
        separating_test: "time changes between tools of three speeds",
        source: "constant torque up to a base speed, constant power above; logs of the NIST smart manufacturing test bed: 7.1 s to 12 000 rpm",
        processes: &[("program", Search::Shaped)],
    },
    CatalogueEntry {
        id: "stop_settling",
        title: "axes settle where a stop ends a motion",
        size: &ProgramDeviations::<f64>::FIELDS[1],
        channels: &[rises("cycle_time")],
        regime: "changes between feed and rapid motions, by their number",
        confounder: "axis_acceleration",
        separating_test: "time a program of many rapid motions and one of few",
        source: "logs of the NIST smart manufacturing test bed: 0.36 s behind feed motions; constant time is an assumption",
        processes: &[("program", Search::Shaped)],
    },
    CatalogueEntry {
        id: "rapid_acceleration",
        title: "rapid motions accelerate more slowly",
        size: &ProgramDeviations::<f64>::FIELDS[2],
        channels: &[rises("cycle_time")],
        regime: "rapid motions, by their number and speed",
        confounder: "stop_settling",
        separating_test: "time short and long rapid motions of one number",
        source: "trapezoidal speed profile of rapid motions (Biagiotti & Melchiorri 2008, recalled)",
        processes: &[("program", Search::Shaped)],
    },
    CatalogueEntry {
        id: "jerk",
        title: "accelerations build up more slowly",
        size: &ProgramDeviations::<f64>::FIELDS[3],
        channels: &[rises("cycle_time")],
        regime: "changes of speed, by their number at every feed and by more at a high one",
        confounder: "stop_settling",
        separating_test: "exact stops at three feeds without rapid motions between them",
        source: "double S speed profile (Biagiotti & Melchiorri 2008, recalled)",
        processes: &[("program", Search::Shaped)],
    },
    CatalogueEntry {
        id: "corner_slowing",
        title: "corners are passed more slowly",
        size: &ProgramDeviations::<f64>::FIELDS[4],
        channels: &[rises("cycle_time")],
        regime: "corners without a stop, by how sharp they are",
        confounder: "axis_acceleration",
        separating_test: "time a polygon and a long line of one length",
        source: "corner speed of Jeon, Improving Grbl: cornering algorithm (2011)",
        processes: &[("program", Search::Shaped)],
    },
    CatalogueEntry {
        id: "block_time",
        title: "the control prepares short blocks more slowly",
        size: &ProgramDeviations::<f64>::FIELDS[5],
        channels: &[rises("cycle_time")],
        regime: "blocks at feed that are shorter than it",
        confounder: "corner_slowing",
        separating_test: "time a straight line in blocks of 0.1 mm and in one block",
        source: "a control reads a number of blocks a second; one time for all of them is an assumption",
        processes: &[("program", Search::Shaped)],
    },
    CatalogueEntry {
        id: "program_end",
        title: "the end of a program takes time",
        size: &ProgramDeviations::<f64>::FIELDS[6],
        channels: &[rises("cycle_time")],
        regime: "the last stretch of a program",
        confounder: "spindle_ramp",
        separating_test: "time an end behind a spindle that stands and one behind a fast spindle",
        source: "logs of the NIST smart manufacturing test bed: 0.2 s behind waiting for the spindle; constant time is an assumption",
        processes: &[("program", Search::Shaped)],
    },
    CatalogueEntry {
        id: "magazine_distance",
        title: "the magazine turns to the next tool",
        size: &ProgramDeviations::<f64>::FIELDS[7],
        channels: &[rises("cycle_time")],
        regime: "tool changes, by the pockets between the old tool and the new one",
        confounder: "tool_change_delay",
        separating_test: "time changes to the next pocket and to the far side of the magazine",
        source: "carousel without an arm that waits; pockets in the order of tool numbers are an assumption",
        processes: &[("program", Search::Shaped)],
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_named_as_its_size_and_neutral_at_zero() {
        assert_eq!(SHOP_EFFECTS.len(), ShopDeviations::<f64>::FIELDS.len());
        assert_eq!(PROGRAM_EFFECTS.len(), ProgramDeviations::<f64>::FIELDS.len());
        for entry in SHOP_EFFECTS.iter().chain(PROGRAM_EFFECTS) {
            assert_eq!((entry.id, entry.size.start), (entry.size.name, 0.0));
            assert!(entry.size.min <= 0.0 && entry.size.max > 0.0, "{}", entry.id);
            assert!(toolroom_process::unit::parse(entry.size.display).is_ok(), "{}", entry.id);
        }
    }
}
