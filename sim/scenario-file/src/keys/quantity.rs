//! Quantities that several sections have, and random times.

use crate::choices::FamilyWord;
use crate::fitted;
use toolroom_form::{Form, Key, Kind};
use toolroom_scenario::MachineType;

/// The case of a machine or operation without a process.
pub(crate) const PLAIN: &[&str] = &[MachineType::PLAIN];
/// Ten years, s: longer times are slips of the unit.
pub(crate) const DECADE: f64 = 10.0 * 365.0 * 86400.0;
pub(crate) const TIME: Kind = Kind::quantity("s", "min", 0.0, DECADE, "1.5 min");
pub(crate) const DURATION: Kind = Kind::positive("s", "min", DECADE, "1.5 min");
pub(crate) const LONG_DURATION: Kind = Kind::positive("s", "h", DECADE, "8 h");
pub(crate) const COST: Kind = Kind::quantity("EUR", "EUR", 0.0, 1e9, "12 EUR");
pub(crate) const RATE: Kind = Kind::quantity("EUR/s", "EUR/h", 0.0, 1e6, "60 EUR/h");
/// A factor on a commanded speed.
pub(crate) const FACTOR: Kind = Kind::positive("1", "1", 10.0, "1.1");
pub(crate) const SHARE: Kind = Kind::quantity("1", "1", 0.0, 1.0, "0.5");
pub(crate) const DEVIATION: Kind = Kind::quantity("1", "1", 0.0, 0.5, "2 %");
pub(crate) const BIAS: Kind = Kind::quantity("1", "1", -0.9, 10.0, "0.05");

/// A random time; a plain duration in its place is a constant.
pub(crate) static DISTRIBUTION: Form = Form {
    title: "distribution",
    doc: "A random time, 0 or longer, drawn by inversion of one random number",
    keys: &[
        Key::required("distribution", Kind::Choice(FamilyWord::WORDS), "Family"),
        Key::required("mean", DURATION, "Mean; of `normal` that of the whole distribution, before it is cut off")
            .when("distribution", &["constant", "exponential", "erlang", "gamma", "lognormal", "weibull", "normal"]),
        Key::required("cv", Kind::positive("1", "1", 10.0, "0.3"), "Standard deviation over mean")
            .when("distribution", &["gamma", "lognormal"]),
        Key::required("k", Kind::Count { min: 1, max: 10_000 }, "Number of phases").when("distribution", &["erlang"]),
        Key::required("shape", Kind::quantity("1", "1", 0.2, 50.0, "1.5"), "Weibull shape")
            .when("distribution", &["weibull"]),
        Key::required("sd", DURATION, "Standard deviation of the whole distribution").when("distribution", &["normal"]),
        Key::required("low", TIME, "Least")
            .when("distribution", &["triangular", "beta", "pert", "uniform", "discrete_uniform"]),
        Key::default("low", TIME, "0 min", "Least").when("distribution", &["normal"]),
        Key::required("mode", TIME, "Most likely").when("distribution", &["triangular", "beta", "pert"]),
        Key::required("high", DURATION, "Greatest")
            .when("distribution", &["triangular", "beta", "pert", "uniform", "discrete_uniform"]),
        Key::optional("high", DURATION, "Greatest; left out: as long as it comes").when("distribution", &["normal"]),
        Key::default("step", DURATION, "1 min", "Distance of neighbouring times")
            .when("distribution", &["discrete_uniform"]),
        Key::optional("values", Kind::List(&TIME), "Times, of which no others occur; due unless `file` is given")
            .when("distribution", &["empirical"]),
        Key::optional("weights", Kind::List(&WEIGHT), "How often each of them occurs; left out: all alike")
            .when("distribution", &["empirical"]),
        Key::required("from", Kind::Text, "summary.json of `toolroom life`; its path from this file")
            .when("distribution", &["fitted"]),
        Key::optional(
            "law",
            Kind::Choice(fitted::LAWS),
            "Law of the summary; left out: the first one, which is the most credible",
        )
        .when("distribution", &["fitted"]),
        Key::optional("group", Kind::Name, "Group of the summary; left out: all lives")
            .when("distribution", &["fitted"]),
        Key::optional(
            "file",
            Kind::Text,
            "Observed times in a column of a table, a CSV file beside this one; times between neighbouring ones occur, too",
        )
        .when("distribution", &["empirical"]),
        Key::optional("column", Kind::Text, "Its column; left out: the first")
            .when("distribution", &["empirical"]),
        Key::optional("unit", Kind::Text, "Unit of its numbers, where neither they nor their header say one: \"min\"")
            .when("distribution", &["empirical"]),
    ],
};

/// How often a value occurs against others.
pub(crate) const WEIGHT: Kind = Kind::quantity("1", "1", 0.0, 1e9, "0.3");

pub(crate) const RANDOM_TIME: Kind = Kind::Shorthand { word: &TIME, form: &DISTRIBUTION };
