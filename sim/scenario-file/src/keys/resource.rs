//! People, setup matrices, buffers.

use super::quantity::{RATE, SHARE, TIME};
use toolroom_form::{Form, Key, Kind};
use toolroom_scenario::BatchUnit;

pub(super) static OPERATOR: Form = Form {
    title: "[[operator]]",
    doc: "A person who attends to machines, or several with the same skills",
    keys: &[
        Key::required("name", Kind::Name, "Unique name; with `count` the prefix of S1, S2, …"),
        Key::optional("count", Kind::Count { min: 1, max: 1000 }, "Number of people; left out: one, called as it is"),
        Key::required("skills", Kind::List(&Kind::Name), "What they can do, in words of your own"),
        Key::optional("calendar", Kind::Reference("calendar"), "Working time; always there, if left out"),
        Key::default(
            "rate",
            RATE,
            "0 EUR/h",
            "Cost of an hour of the calendar; the `rate` of machines is theirs alone then",
        ),
        Key::optional("walk", Kind::Table(&WALK), "Times of the ways between machines; left out: no time"),
    ],
};

/// Places of ways.
pub(super) const LOCATIONS: Key = Key::optional(
    "locations",
    Kind::List(&Kind::Name),
    "Places, by `location` of machines or the name of their section; the start is at the first; due unless `file` is given",
);

/// Times of ways.
pub(super) const WAY_TIMES: Key = Key::optional(
    "times",
    Kind::List(&ROW),
    "Times of the ways: a row is the place from, a column the place to; due unless `file` is given",
);

/// Places and times in a file.
pub(super) const WAYS_FILE: Key = Key::optional(
    "file",
    Kind::Text,
    "CSV file beside this one with the times: places in the first line, a row for every place with its name in front",
);

static WALK: Form = Form {
    title: "walk",
    doc: "How long a person walks from one place to another",
    keys: &[LOCATIONS, WAY_TIMES, WAYS_FILE],
};

pub(super) static ATTENDANCE: Form = Form {
    title: "operator",
    doc: "Skills that the steps of an operation need; a step waits until somebody who has the skill is free",
    keys: &[
        Key::optional("setup", Kind::Name, "Skill for changing over"),
        Key::optional("load", Kind::Name, "Skill for loading and unloading"),
        Key::optional(
            "run",
            Kind::Shorthand { word: &Kind::Name, form: &RUN },
            "Skill for all that comes between them, from its beginning to its end",
        ),
    ],
};

static RUN: Form = Form {
    title: "run",
    doc: "A person for a share of the run of an operation, or for the beginning of every piece",
    keys: &[
        Key::required("skill", Kind::Name, "Skill"),
        Key::optional(
            "share",
            SHARE,
            "Share of a person that it takes: one person tends as many operations at once as fit; left out: all of one",
        ),
        Key::optional(
            "first",
            super::crib::FIRST,
            "Time at the beginning of every piece for which somebody is there; left out: all the time",
        ),
    ],
};

pub(super) static SETUP_MATRIX: Form = Form {
    title: "[[setup_matrix]]",
    doc: "Times of changing over: a row is the group before, a column the group after",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::optional(
            "groups",
            Kind::List(&Kind::Name),
            "Setup groups, of rows and columns; due unless `file` is given",
        ),
        Key::optional(
            "times",
            Kind::List(&ROW),
            "A row for every group; one more in front is for a machine that was never set up; due unless `file` is given",
        ),
        Key::optional(
            "file",
            Kind::Text,
            "CSV file beside this one with the times: groups in the first line, a row for every group with its name in front, empty for a machine that was never set up",
        ),
    ],
};

/// Places for jobs.
pub(super) const PLACES: Kind = Kind::Count { min: 0, max: 1_000_000 };

/// What takes a place.
const BUFFER_UNIT: Key = Key::default(
    "unit",
    Kind::Choice(BatchUnit::WORDS),
    BatchUnit::Lots.word(),
    "What takes a place: all that moves together of an order (lots), or each of its pieces",
);

pub(super) static BUFFER: Form = Form {
    title: "[[buffer]]",
    doc: "Places that several machines share, before them",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::required("places", PLACES, "Jobs that may stand in it: parts, or what moves together of an order"),
        BUFFER_UNIT,
        Key::required("before", Kind::List(&Kind::Reference("machine")), "Machines that take their work from it"),
    ],
};

/// Times to every group.
pub(super) const ROW: Kind = Kind::List(&TIME);
