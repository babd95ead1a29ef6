//! How jobs flow: machines that take several at once, inspections, components, variants of the shop.

use super::{DURATION, SHARE};
use serde_json::json;
use toolroom_form::{Content, Form, Key, Kind};
use toolroom_scenario::{BatchFamily, BatchUnit};

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
const COUNT: Kind = Kind::Count { min: 1, max: 1_000_000 };
