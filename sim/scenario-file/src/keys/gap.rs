//! What a gap diagnosis has to know: priors, sensors, and the mark of a file that it wrote.

use crate::choices::GrowthWord;
use toolroom_form::{Form, Key, Kind};

/// Standard deviation of a logarithm, or relative.
const SPREAD: Kind = Kind::quantity("1", "1", 0.0, 10.0, "0.08");

/// Priors and sensors of a gap diagnosis.
pub static GAP: Form = Form {
    title: "[gap]",
    doc: "Priors (standard deviations of logarithms) and sensors of a diagnosis against measured records",
    keys: &[
        Key::optional(
            "process",
            Kind::Choice(&["turning", "milling", "infeed", "empirical", "shop", "program"]),
            "Process that is diagnosed; if left out, that of the first tool that is simulated, of a scenario without one its machines by their log (shop)",
        ),
        Key::default("force", SPREAD, "0.08", "Force coefficients"),
        Key::default("temperature", SPREAD, "0.05", "Temperature coefficients"),
        Key::default("wear_level", SPREAD, "0.15", "Level of the wear rate"),
        Key::default("stiffness", SPREAD, "0.10", "Stiffnesses of grinding"),
        Key::default("edge_wear", SPREAD, "0.25", "Scale of the scatter of wear from edge to edge"),
        Key::default("edge_force", SPREAD, "0.02", "Scatter of force from edge to edge"),
        Key::optional(
            "conditions",
            Kind::List(&Kind::Name),
            "Columns that an empirical model knows, such as cutting_speed or material; the others are suspects",
        ),
        Key::optional(
            "channels",
            Kind::List(&Kind::Name),
            "Channels that an empirical model answers for; all, if left out",
        ),
        Key::default(
            "wear_growth",
            Kind::Choice(GrowthWord::WORDS),
            GrowthWord::Power.word(),
            "How wear grows with the age of an edge in an empirical model",
        ),
        Key::optional("sensor", Kind::Tables(&SENSOR), "Sensors that differ from the usual sheet"),
        Key::optional("applied", Kind::Table(&APPLIED), "Mark of a file that `toolroom gap apply` wrote"),
    ],
};

static APPLIED: Form = Form {
    title: "[gap.applied]",
    doc: "Mark of a file that `toolroom gap apply` wrote: it replaces the file as long as nobody edits it",
    keys: &[
        Key::required("text", Kind::Text, "Hash of the file without this table"),
        Key::optional("data", Kind::List(&Kind::Text), "Hashes of the records that its calibration has seen"),
        Key::optional("from", Kind::Text, "Start of the first of those operations, since the start of the scenario"),
        Key::optional("until", Kind::Text, "Start of the last of them"),
    ],
};

static SENSOR: Form = Form {
    title: "[[gap.sensor]]",
    doc: "Errors of the sensor of one channel",
    keys: &[
        Key::required("channel", Kind::Name, "Column of the records"),
        Key::default("relative", SPREAD, "0", "Standard deviation, relative to the value"),
        Key::optional("absolute", Kind::Text, "Standard deviation with its unit, `3 K`"),
        Key::optional("resolution", Kind::Text, "Least step with its unit, `0.01 mm`"),
    ],
};
