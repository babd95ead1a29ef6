//! Crews and vehicles.

use super::quantity::RATE;
use super::resource::{LOCATIONS, WAY_TIMES, WAYS_FILE};
use toolroom_form::{Form, Key, Kind};
use toolroom_scenario::{Parking, TransportRule};

pub(super) static CREW: Form = Form {
    title: "[[crew]]",
    doc: "People who repair machines: a breakdown that names them waits until one of them is free",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::default("count", Kind::Count { min: 1, max: 1000 }, "1", "Repairs at once"),
        Key::optional(
            "calendar",
            Kind::Reference("calendar"),
            "When they begin repairs, which they finish; left out: always",
        ),
        Key::default("rate", RATE, "0 EUR/h", "Cost of an hour of the calendar for each of them"),
    ],
};

pub(super) static TRANSPORT: Form = Form {
    title: "[[transport]]",
    doc: "Vehicles that carry jobs between places: they drive to where a job waits, empty, and then to where it goes",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::default("count", Kind::Count { min: 1, max: 1000 }, "1", "Number of vehicles"),
        LOCATIONS,
        WAY_TIMES,
        WAYS_FILE,
        Key::default("park", Kind::Choice(Parking::WORDS), Parking::Stay.word(), "Where a vehicle waits without a job"),
        Key::default(
            "rule",
            Kind::Choice(TransportRule::WORDS),
            TransportRule::Fifo.word(),
            "Which of several jobs a free vehicle takes: that which has waited for longest, or the nearest",
        ),
        Key::default(
            "capacity",
            Kind::Count { min: 1, max: 1000 },
            "1",
            "Most jobs that a vehicle carries: what waits for the same way when it comes goes with it",
        ),
    ],
};
