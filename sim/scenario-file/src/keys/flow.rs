//! How jobs flow: machines that take several at once, inspections, components, variants of the shop.

use super::quantity::{DURATION, LONG_DURATION, SHARE, WEIGHT};
use serde_json::json;
use toolroom_form::{Content, Form, Key, Kind};
use toolroom_scenario::{BatchFamily, BatchUnit, OutsideSample};

pub(super) static BATCH: Form = Form {
    title: "batch",
    doc: "A machine that works on several jobs at once: it starts when `min` of one family wait, or one has waited `time_out`",
    keys: &[
        Key::required("max", COUNT, "Most that fit in"),
        Key::optional("min", COUNT, "Number of one family from which it starts at once; left out: 1"),
        Key::optional("time_out", DURATION, "Wait of a job after which it starts with fewer; left out: never"),
        Key::default(
            "same",
            Kind::Choice(BatchFamily::WORDS),
            BatchFamily::SetupGroup.word(),
            "What may go in together",
        ),
        Key::default(
            "by",
            Kind::Choice(BatchUnit::WORDS),
            BatchUnit::Pieces.word(),
            "What `max` and `min` count: pieces, or jobs (a piece, or all that moves together of an order)",
        ),
    ],
};

pub(super) static OUTCOME: Form = Form {
    title: "outcomes",
    doc: "What may happen after the operation beside going on: back to an operation, or to the scrap",
    keys: &[
        Key::required("share", SHARE, "Share to which it happens"),
        Key::optional("go", Kind::Name, "Operation of this part, this one or an earlier one, to which it goes back"),
        Key::default("scrap", Kind::Flag, "false", "Whether it is scrapped"),
    ],
};

pub(super) static SAMPLE: Form = Form {
    title: "sample",
    doc: "Which pieces are judged: of an order, or of a source, the first and every so many after it",
    keys: &[
        Key::required("every", COUNT, "Distance of those that are judged: 5 for one of five"),
        Key::default(
            "others",
            Kind::Choice(OutsideSample::WORDS),
            OutsideSample::Worked.word(),
            "Whether the operation is done on the others, or they pass by it",
        ),
    ],
};

pub(super) static ON_REJECT: Form = Form {
    title: "on_reject",
    doc: "Where parts go that are out of tolerance, rough or burnt",
    keys: &[Key::required(
        "go",
        Kind::Name,
        "Operation of this part, this one or an earlier one, to which they go back",
    )],
};

pub(super) static OVERRUN: Form = Form {
    title: "replenish",
    doc: "More pieces of every order, so that enough are left",
    keys: &[Key::required("overrun", SHARE, "Pieces beyond the quantity, as a share of it, rounded up")],
};

pub(super) static STOCK: Form = Form {
    title: "[[stock]]",
    doc: "A component in stock at the start, and when more of it are made or bought",
    keys: &[
        Key::required("part", Kind::Reference("part"), "Part, which goes into another one"),
        Key::default("quantity", Kind::Count { min: 0, max: 1_000_000 }, "0", "Pieces at the start"),
        Key::optional(
            "reorder",
            Kind::Table(&REORDER),
            "A lot that is ordered when pieces in stock and on order are few; left out: none",
        ),
    ],
};

static REORDER: Form = Form {
    title: "reorder",
    doc: "A lot that is ordered when pieces in stock and on order are few",
    keys: &[
        Key::required("below", COUNT, "Pieces in stock and on order below which a lot is ordered"),
        Key::required("lot", COUNT, "Pieces of a lot"),
        Key::optional("lead", LONG_DURATION, "Time until bought pieces come; left out: the shop makes them"),
        super::order::PRIORITY,
    ],
};

pub(super) static QUANTITY: Form = Form {
    title: "quantity",
    doc: "Pieces of a job: whole numbers between two ends, all alike, or given numbers with weights",
    keys: &[
        Key::optional("low", COUNT, "Least, with `high`"),
        Key::optional("high", COUNT, "Greatest"),
        Key::optional("values", Kind::List(&COUNT), "Numbers, of which no others occur"),
        Key::optional("weights", Kind::List(&WEIGHT), "How often each of them occurs; left out: all alike"),
    ],
};

/// Shares of parts.
pub(super) static PART_MIX: Content = Content {
    expected: "a table of parts and shares",
    example: "{ shaft = 0.3, ring = 0.7 }",
    schema: || {
        json!({
            "type": "object",
            "additionalProperties": { "type": "number", "exclusiveMinimum": 0, "maximum": 1 },
            "description": "Shares of the jobs by the names of parts; together they are 1",
        })
    },
    entry: None,
};

pub(super) static COMPONENT: Form = Form {
    title: "components",
    doc: "A part that goes into this one, from the stock of those that are finished",
    keys: &[
        Key::required("part", Kind::Reference("part"), "Part"),
        Key::default("quantity", COUNT, "1", "Pieces of it in one"),
    ],
};

pub(super) static VARIANT: Form = Form {
    title: "[[variant]]",
    doc: "The shop with some values changed, compared with the shop as it is by `toolroom compare`",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::required("set", Kind::Content(&SET), "Values by their paths, as after `--set`"),
        Key::optional(
            "from",
            Kind::Text,
            "When a shop that runs as it is gets these values, a date or the time since the start; left out: it has them from the start",
        ),
    ],
};

/// Changes of a variant.
static SET: Content = Content {
    expected: "a table of paths and values, as after `--set`",
    example: "{ \"machine.CMM.count\" = 3 }",
    schema: || {
        json!({
            "type": "object",
            "additionalProperties": true,
            "description": "Values by their paths, as after --set: \"machine.CMM.count\", \"dispatch.rule\"",
        })
    },
    entry: None,
};

/// Pieces or jobs.
pub(super) const COUNT: Kind = Kind::Count { min: 1, max: 1_000_000 };
