//! Fixtures and pallets.

use toolroom_form::{Form, Key, Kind};

pub(super) static FIXTURE: Form = Form {
    title: "[[fixture]]",
    doc: "A fixture or pallet that operations need beside their machine: one that finds none free waits in its queue",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::default("count", Kind::Count { min: 1, max: 100_000 }, "1", "How many there are"),
    ],
};

/// Which fixture an operation needs.
pub(super) const USES_FIXTURE: Key = Key::optional(
    "fixture",
    Kind::Reference("fixture"),
    "Fixture or pallet that it needs from its setup on; left out: none",
);

/// For how long.
pub(super) const HOLD: Key = Key::default(
    "hold",
    Kind::Name,
    "operation",
    "How long it has it: for this operation, or \"until NAME\", a later one, with which it travels there",
);
