//! People, setup matrices, buffers.

use super::TIME;
use toolroom_form::{Form, Key, Kind};

pub(super) static OPERATOR: Form = Form {
    title: "[[operator]]",
    doc: "A person who attends to machines, or several with the same skills",
    keys: &[
        Key::required("name", Kind::Name, "Unique name; with `count` the prefix of S1, S2, …"),
        Key::optional("count", Kind::Count { min: 1, max: 1000 }, "Number of people; left out: one, called as it is"),
        Key::required("skills", Kind::List(&Kind::Name), "What they can do, in words of your own"),
        Key::optional("calendar", Kind::Reference("calendar"), "Working time; always there, if left out"),
    ],
};

pub(super) static ATTENDANCE: Form = Form {
    title: "operator",
    doc: "Skills that the steps of an operation need; a step waits until somebody who has the skill is free",
    keys: &[
        Key::optional("setup", Kind::Name, "Skill for changing over"),
        Key::optional("load", Kind::Name, "Skill for loading and unloading"),
        Key::optional("run", Kind::Name, "Skill for all that comes between them"),
    ],
};

pub(super) static SETUP_MATRIX: Form = Form {
    title: "[[setup_matrix]]",
    doc: "Times of changing over: a row is the group before, a column the group after",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::required("groups", Kind::List(&Kind::Name), "Setup groups, of rows and columns"),
        Key::required(
            "times",
            Kind::List(&ROW),
            "A row for every group; one more in front is for a machine that was never set up",
        ),
    ],
};

/// Places for jobs.
pub(super) const PLACES: Kind = Kind::Count { min: 0, max: 1_000_000 };

pub(super) static BUFFER: Form = Form {
    title: "[[buffer]]",
    doc: "Places that several machines share, before them",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::required("places", PLACES, "Jobs that may stand in it: parts, or what moves together of an order"),
        Key::required("before", Kind::List(&Kind::Reference("machine")), "Machines that take their work from it"),
    ],
};

/// Times to every group.
pub(super) const ROW: Kind = Kind::List(&TIME);
