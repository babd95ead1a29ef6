//! Tool cribs and planned maintenance.

use super::quantity::{COST, DURATION, LONG_DURATION, RANDOM_TIME, TIME};
use crate::choices::LIFE_ONLY;
use toolroom_form::{Form, Key, Kind};
use toolroom_scenario::{FailureClock, SPEED};

/// Edges.
const EDGES: Kind = Kind::Count { min: 1, max: 1_000_000 };

pub(super) static CRIB: Form = Form {
    title: "[[crib]]",
    doc: "Edges of a tool that are limited: machines take them from here, worn ones are ground anew, new ones are bought",
    keys: &[
        Key::required("tool", Kind::Reference("tool"), "Tool; without a crib it has as many edges as are needed"),
        Key::required("edges", EDGES, "Edges at the start, those included that machines mount first"),
        Key::default("fetch", TIME, "0 min", "Bringing an edge to a machine, beside the machine's tool_change_time"),
        Key::optional(
            "regrind",
            Kind::Table(&REGRIND),
            "What becomes of worn and broken edges; left out: they are thrown away",
        ),
        Key::optional("buy", Kind::Table(&BUY), "When new edges are bought; left out: never"),
    ],
};

static REGRIND: Form = Form {
    title: "regrind",
    doc: "How worn edges are ground anew",
    keys: &[
        Key::optional(
            "station",
            Kind::List(&Kind::Reference("machine")),
            "Machines of the shop that do it, as jobs in their queues; left out: done elsewhere, any number at once",
        ),
        Key::required("time", RANDOM_TIME, "Time of an edge at the station, or until edges sent away come back"),
        Key::optional(
            "times",
            Kind::Count { min: 0, max: 1_000_000 },
            "How often an edge is ground before it is thrown away; left out: without limit",
        ),
        Key::default(
            "life_factor",
            Kind::positive("1", "1", 2.0, "0.9"),
            "1",
            "Life after a regrinding over the life before",
        ),
        Key::default("cost", COST, "0 EUR", "Grinding one edge, in the place of the cost of a new one"),
        Key::default("batch", EDGES, "1", "Edges that are sent together"),
        Key::optional(
            "setup_group",
            Kind::Name,
            "Setup group of this work at the station; left out: one of its own for this tool",
        ),
    ],
};

static BUY: Form = Form {
    title: "buy",
    doc: "How new edges are bought",
    keys: &[
        Key::required("below", EDGES, "They are ordered when fewer than this are in the crib or on order"),
        Key::required("lot", EDGES, "Edges of an order"),
        Key::required("lead", LONG_DURATION, "Time until they come"),
    ],
};

pub(super) static MAINTENANCE: Form = Form {
    title: "[[maintenance]]",
    doc: "Planned work on machines: when it is due it waits for the end of the operation, and its time is none of production's",
    keys: &[
        Key::required("machines", Kind::List(&Kind::Reference("machine")), "Machines; each has its own clock"),
        Key::required("every", LONG_DURATION, "Time on its clock until it is due again"),
        Key::default(
            "clock",
            Kind::Choice(FailureClock::WORDS),
            FailureClock::Busy.word(),
            "busy: time in which the machine worked since the last one; calendar: multiples of all time",
        ),
        Key::required("duration", RANDOM_TIME, "How long it takes"),
        Key::optional(
            "window",
            Kind::Reference("calendar"),
            "Calendar in whose shifts it may begin, in the machine's own shift or out of it; left out: in the machine's shift",
        ),
    ],
};

/// Life of the edges of a tool of which nothing else is known.
pub(super) const LIFE: Key =
    Key::required("life", RANDOM_TIME, "Working time of an edge until it is changed").when("process", &[LIFE_ONLY]);

/// At which speed edges last so long.
pub(super) const LIFE_AT: Key = Key::optional(
    "life_at",
    Kind::Table(&LIFE_SPEED),
    "Cutting speed of that life; operations with another `cutting_speed` use it up faster or slower",
)
.when("process", &[LIFE_ONLY]);

static LIFE_SPEED: Form = Form {
    title: "life_at",
    doc: "How the life of an edge falls with the cutting speed",
    keys: &[
        Key::required("cutting_speed", SPEED, "Cutting speed at which edges last as long as `life` says"),
        Key::required(
            "speed_exponent",
            Kind::positive("1", "1", 20.0, "4.0"),
            "Exponent n of the life over the speed: at twice the speed an edge lasts 2^-n times as long",
        ),
    ],
};

/// Time at the beginning of a piece.
pub(super) const FIRST: Kind = DURATION;
