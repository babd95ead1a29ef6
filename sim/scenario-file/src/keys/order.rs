//! Orders, tables, and the calendars by which they are worked off.

use super::quantity::{DECADE, LONG_DURATION, TIME};
use serde_json::json;
use toolroom_form::{Content, Encoding, Form, Key, Kind};
use toolroom_scenario::{Interruption, WEAR};

pub(super) static CALENDAR: Form = Form {
    title: "[[calendar]]",
    doc: "Working time, that repeats (`period`, `shift`) or of dates (`week`); a machine without calendar always works",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::optional("period", LONG_DURATION, "Period of repetition of `shift`; left out: a day"),
        Key::optional(
            "shift",
            Kind::Tables(&SHIFT),
            "Working intervals inside one period, in order; due unless `week` is given",
        ),
        Key::optional("week", Kind::Content(&WEEK), "Shifts by weekday; the scenario has a start"),
        Key::optional(
            "weeks",
            Kind::Count { min: 1, max: 52 },
            "Number of weeks that follow each other, again and again: `week` is a list of as many; left out: as many as it has",
        ),
        Key::optional(
            "first_week",
            Kind::Text,
            "A day of a week that is the first of these: \"2026-03-30\"; left out: that in which the run starts",
        ),
        Key::optional("breaks", Kind::List(&CLOCK), "Breaks of every day, out of `week`"),
        Key::optional(
            "holidays",
            Kind::List(&Kind::Text),
            "Days, or first and last day, on which no shift of `week` starts: \"2026-04-03\", \"2026-08-03..2026-08-14\"",
        ),
        Key::optional(
            "overtime",
            Kind::List(&Kind::Text),
            "Working time beside `week`, on holidays and in breaks too: \"2026-04-04 06:00-10:00\"",
        ),
        Key::optional(
            "at_end",
            Kind::Choice(Interruption::WORDS),
            "What happens to the part in the machine when a shift ends; left out: finish with `shift`, resume with `week`",
        ),
        Key::default("finish_within", TIME, "0 min", "A step that needs no more than this is finished first"),
        Key::default(
            "start_only_if_fits",
            Kind::Flag,
            "false",
            "Whether a machine begins an operation only where it will be over before the shift is",
        ),
    ],
};

static SHIFT: Form = Form {
    title: "[[calendar.shift]]",
    doc: "One working interval, counted from the start of the period",
    keys: &[
        Key::required("start", TIME, "Start"),
        Key::required("end", Kind::positive("s", "min", DECADE, "8 h"), "End"),
        Key::default(
            "factor",
            Kind::positive("1", "1", 10.0, "0.8"),
            "1",
            "How fast setups, handling and plain work go in it; passes of a tool take their time",
        ),
    ],
};

/// Two times of the day.
const CLOCK: Kind = Kind::Text;

/// Shifts by weekday.
static WEEK: Content = Content {
    expected: "a table of weekdays with their shifts",
    example: "{ mon-fri = [\"06:00-14:00\"], sat = [] }",
    schema: || {
        let shift = json!({ "anyOf": [
            { "type": "string" },
            {
                "type": "object",
                "additionalProperties": false,
                "required": ["time"],
                "properties": {
                    "time": { "type": "string", "description": "06:00-14:00" },
                    "factor": { "type": "number", "exclusiveMinimum": 0, "description": "How fast work goes in it" },
                },
            },
        ] });
        let week = json!({
            "type": "object",
            "additionalProperties": { "type": "array", "items": shift },
            "description": "Days such as mon or mon-fri, each with its shifts: 06:00-14:00, or 22:00-06:00 over midnight",
        });
        let several = json!({ "type": "array", "items": week, "description": "Weeks that follow each other" });
        json!({ "anyOf": [week, several] })
    },
    entry: None,
};

/// How urgent jobs are.
pub(super) const PRIORITY: Key = Key::default(
    "priority",
    Kind::Count { min: 0, max: 1_000_000 },
    "0",
    "The smaller, the more urgent (rule `priority`)",
);

/// What their lateness weighs.
pub(super) const WEIGHT: Key = Key::default(
    "weight",
    Kind::quantity("1", "1", 1e-6, 1e6, "2"),
    "1",
    "Weight in the rules `wspt`, `atc` and `covert`",
);

pub(super) static ORDER: Form = Form {
    title: "[[order]]",
    doc: "A quantity of one part that is released and due together",
    keys: &[
        Key::required("id", Kind::Name, "Unique name"),
        Key::required("part", Kind::Reference("part"), "Part"),
        Key::default("quantity", Kind::Count { min: 1, max: 1_000_000 }, "1", "Pieces"),
        Key::default("release", Kind::Text, "0 h", "When it enters the shop: a date, or the time since the start"),
        Key::optional(
            "due",
            Kind::Text,
            "When it is due: a date, or the time since the start; left out: the part's flow_allowance after its release",
        ),
        PRIORITY,
        WEIGHT,
        Key::default("customer", Kind::Text, "", "Who ordered it"),
        Key::optional(
            "transfer",
            Kind::Count { min: 1, max: 1_000_000 },
            "Pieces that move on together, while the others are still worked on; left out: all",
        ),
        Key::optional(
            "split",
            Kind::Or { words: &["all"], other: &Kind::Count { min: 1, max: 1_000 } },
            "Most machines over which an operation is divided, of those that are free when it begins; left out: one",
        ),
        Key::default(
            "setup_ahead",
            Kind::Flag,
            "false",
            "Whether a free machine is set up for its next operation as soon as the one before has begun",
        ),
        Key::optional(
            "parent",
            Kind::Name,
            "The order into which its pieces go, of a part with pegging = \"order\"; left out: the stock",
        ),
    ],
};

pub(super) static WIP: Form = Form {
    title: "[[wip]]",
    doc: "An order that is in the shop when the run begins: where it is and how far",
    keys: &[
        Key::required("order", Kind::Name, "The order, which may be released before the start"),
        Key::required("operation", Kind::Name, "Operation for which it waits or in which it is; those before are done"),
        Key::optional(
            "machine",
            Kind::Reference("machine"),
            "The machine that works on it, set up and loaded; left out: it waits",
        ),
        Key::default("done", Kind::quantity("1", "1", 0.0, 1.0, "40 %"), "0 %", "Share of the operation that is done"),
        Key::optional(
            "pieces",
            Kind::Count { min: 0, max: 1_000_000 },
            "The same in pieces that have passed the operation, in the place of `done`",
        ),
        Key::default("setup_left", TIME, "0 min", "Setup that the machine still needs for it; nothing is done then"),
        Key::default(
            "since",
            Kind::Text,
            "0 h",
            "When it came there, a date or a time before the start: who came first stands in front",
        ),
    ],
};

pub(super) static SCHEDULE: Form = Form {
    title: "[[schedule]]",
    doc: "An operation of an order in the sequence of a machine, which follows it in the place of its rules",
    keys: &[
        Key::required("order", Kind::Name, "The order"),
        Key::required("operation", Kind::Name, "Operation of its part"),
        Key::required("machine", Kind::Reference("machine"), "The machine that does it"),
        Key::optional(
            "position",
            Kind::Count { min: 0, max: 1_000_000_000 },
            "Its place in the sequence of the machine; left out: after the rows before it",
        ),
        Key::optional(
            "not_before",
            Kind::Text,
            "Earliest start, a date or the time since the start; left out: at once",
        ),
        Key::optional("start", Kind::Text, "Start as planned, with which that of the run is compared"),
        Key::optional("end", Kind::Text, "End as planned, for people"),
    ],
};

pub(super) static EDGE_AT_START: Form = Form {
    title: "edge_at_start",
    doc: "A worn edge that is in the machine when the run begins",
    keys: &[
        Key::required("tool", Kind::Reference("tool"), "Its tool"),
        Key::required("flank_wear", WEAR, "Its flank wear"),
    ],
};

pub(super) static TABLES: Form = Form {
    title: "[tables]",
    doc: "Tables in files beside this one: comma-separated, the first line names the columns",
    keys: &[
        Key::optional(
            "orders",
            Kind::Text,
            "Orders, a row each: id, part, quantity, release, due, priority, weight, customer, transfer as in [[order]]",
        ),
        Key::optional(
            "wip",
            Kind::Text,
            "Orders in the shop at the start, a row each: order, operation, machine, done, pieces, setup_left, since as in [[wip]]",
        ),
        Key::optional(
            "schedule",
            Kind::Text,
            "Sequences of machines, a row each: order, operation, machine, position, not_before, start, end as in [[schedule]]",
        ),
        Key::default(
            "encoding",
            Kind::Choice(Encoding::WORDS),
            "utf-8",
            "How the letters of these files are written; UTF-16 with its byte order mark is known without it",
        ),
        Key::optional(
            "column",
            Kind::Tables(&COLUMN),
            "What the columns of a table of orders with other names are; columns that are not listed are passed over",
        ),
    ],
};

static COLUMN: Form = Form {
    title: "[[tables.column]]",
    doc: "A column of the table of orders under its own name",
    keys: &[
        Key::required("name", Kind::Name, "What it is: a key of [[order]]"),
        Key::required("from", Kind::Text, "Its name in the first line of the table"),
        Key::optional(
            "format",
            Kind::Text,
            "Form of its dates: \"%d.%m.%Y\" or \"%m/%d/%Y %H:%M\"; left out: 2026-03-30",
        ),
        Key::optional("at", Kind::Text, "Time of the day of dates without one: \"14:00\"; left out: midnight"),
    ],
};
