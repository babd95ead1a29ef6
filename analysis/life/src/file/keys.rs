//! The sections of a study file.

use super::words::{BodyWord, FailureWord, FamilyWord, KnowsWord, ReadingWord, SamplingWord};
use toolroom_form::{Form, Key, KeyCondition, Kind, Need, joined};
use toolroom_process::{Field, Record};
use toolroom_scenario::SpeedRule;
use toolroom_scenario_file::SENSORS;
use toolroom_wear::{Cut, HANDBOOK, Scatter, ScatterWord};

const TIME: Kind = Kind::positive("s", "min", 1e9, "15 min");
const PATH: Kind = Kind::positive("m", "m", 1e9, "600 m");
const WEAR: Kind = Kind::positive("m", "mm", 5e-3, "0.6 mm");
/// The fields of a cut, which say how far its keys go.
const CUT: &[Field] = Cut::<f64>::FIELDS;
const SPEED: Kind = Kind::positive("m/s", "m/min", CUT[0].max, "30 m/min");
const FEED: Kind = Kind::quantity("m", "mm", CUT[1].min, CUT[1].max, "0.12 mm/rev");
const DEPTH: Kind = Kind::quantity("m", "mm", CUT[2].min, CUT[2].max, "0.75 mm");
const COST: Kind = Kind::positive("EUR", "EUR", 1e9, "12 EUR");
const RATE: Kind = Kind::positive("EUR/s", "EUR/h", 1e6, "60 EUR/h");

/// The whole file.
pub static STUDY: Form = Form {
    title: "the study file",
    doc: "A Monte Carlo tool-life study, for toolroom life",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::required("name", Kind::Name, "Short name, also of the output folder"),
        Key::default("title", Kind::Text, "", "One line for people"),
        Key::default("seed", Kind::Count { min: 0, max: u64::MAX }, "1", "Seed of every random number"),
        Key::default(
            "lives",
            Kind::Count { min: 2, max: 4_000_000_000 },
            "10000",
            "Lives of every condition under every policy",
        ),
        Key::optional(
            "until",
            Kind::positive("1", "%", 0.5, "0.5 %"),
            "Stop when every mean life is known this well (half-width of its interval); `lives` are the most",
        ),
        Key::default(
            "sampling",
            Kind::Choice(SamplingWord::WORDS),
            SamplingWord::Plain.word(),
            "How points of the inputs are chosen",
        ),
        Key::required(
            "parameter_set",
            Kind::Name,
            "Tool and work material: name of a shipped parameter set of turning, or path of a file",
        ),
        Key::optional(
            "parameters_from",
            Kind::Text,
            "Draws of a calibration, a Parquet table beside this file: each edge takes one; policies know the set",
        ),
        Key::optional(
            "parameters",
            Kind::Parameters,
            "Deviations from the parameter set, group by group; the group of another wear law makes that the law",
        ),
        Key::optional(
            "handbook",
            Kind::Table(&HANDBOOK),
            "Constants of a handbook or of tests, which go before those of the parameter set and after `parameters`",
        ),
        Key::default(
            "scatter",
            Scatter::<f64>::KIND,
            ScatterWord::Shop.word(),
            "Scatter of edges, workpieces and wear; a table changes single values of the shop's",
        ),
        Key::default(
            "body",
            Kind::Choice(BodyWord::WORDS),
            BodyWord::Steady.word(),
            "Whether the body of the tool is warm at once, or warms up and cools in pauses",
        ),
        Key::optional("passes", Kind::Table(&PASSES), "Passes and pauses; left out: 37.7 m without pause"),
        Key::optional("condition", Kind::Tables(&CONDITION), "Conditions; left out: the reference cut"),
        Key::optional("policy", Kind::Tables(&POLICY), "Policies; left out: the programmed speed"),
        Key::optional("end", Kind::Table(&END), "What ends an edge besides its wear limit"),
        Key::optional("field", Kind::Tables(&FIELD), "Further numbers of the model that vary from edge to edge"),
        Key::optional("correlation", Kind::Tables(&CORRELATION), "Correlations of what varies, by a Gaussian copula"),
        Key::optional("early", Kind::Table(&EARLY), "Importance sampling of early failures"),
        Key::optional("replacement", Kind::Table(&REPLACEMENT), "Costs of replacing an edge"),
        Key::optional("sensitivity", Kind::Table(&SENSITIVITY), "Which inputs the life depends on"),
        Key::default("write_lives", Kind::Flag, "true", "Write every life to Parquet parts"),
    ],
};

static PASSES: Form = Form {
    title: "[passes]",
    doc: "Passes into which a life is cut",
    keys: &[
        Key::default("path", PATH, "37.7 m", "Path of a pass"),
        Key::default("pause", Kind::quantity("s", "min", 0.0, 1e6, "0.3 min"), "0 min", "Pause after a pass"),
    ],
};

static CONDITION: Form = Form {
    title: "[[condition]]",
    doc: "A cut, or a grid of cuts where values are lists",
    keys: &[
        Key::optional("name", Kind::Name, "Name in tables and pictures"),
        Key::optional("cutting_speed", Kind::List(&SPEED), "Cutting speed; left out: the reference speed"),
        Key::optional("feed_per_rev", Kind::List(&FEED), "Feed; left out: the reference feed"),
        Key::optional("depth_of_cut", Kind::List(&DEPTH), "Depth of cut; left out: the reference depth"),
    ],
};

/// The word of studies of tool lives for productivity at a price that the file states.
pub(super) const PRICE_WORD: &str = "price";
/// Rules at a stated price of edges.
const PRICED: &[&str] = &["productivity", PRICE_WORD];
/// The words of shops, and the one above.
const RULES: [&str; SpeedRule::WORDS.len() + 1] = with_price(SpeedRule::WORDS);
/// Rules that read sensors.
const OBSERVING: [&str; SpeedRule::OBSERVING.len() + 1] = with_price(SpeedRule::OBSERVING);

const fn with_price<const N: usize>(words: &[&'static str]) -> [&'static str; N] {
    let mut all = [PRICE_WORD; N];
    let mut word = 0;
    while word < words.len() {
        all[word] = words[word];
        word += 1;
    }
    assert!(word + 1 == N);
    all
}

/// The numbers of the rules as in shops. A study of lives has no machine from which the rate optimum would follow, so that a
/// price has to be stated.
const NUMBERS: [Key; SpeedRule::KEYS.len()] = {
    let mut keys: [Key; SpeedRule::KEYS.len()] = joined(&[SpeedRule::KEYS]);
    let mut key = 0;
    while key < keys.len() {
        if let Need::Optional = keys[key].need {
            keys[key] = Key {
                need: Need::Required,
                when: Some(KeyCondition { key: "speed", values: PRICED }),
                doc: "Shadow price of edges",
                ..keys[key]
            };
        }
        key += 1;
    }
    keys
};

const RULE: &[Key] =
    &[Key::required("name", Kind::Name, "Unique name"), Key::required("speed", Kind::Choice(&RULES), "Rule")];
const OTHERS: &[Key] = &[
    Key::required("change_time", TIME, "Time to change an edge").when("speed", &["best_rate", "best_cost"]),
    Key::required("edge_cost", COST, "Cost of an edge").when("speed", &["best_cost"]),
    Key::required("machine_rate", RATE, "Cost of an hour of machine and operator").when("speed", &["best_cost"]),
    Key::default(
        "reading",
        Kind::Choice(ReadingWord::WORDS),
        ReadingWord::Period.word(),
        "When the sensors are read: at the end of a pass or every sampling period",
    )
    .when("speed", &OBSERVING),
    Key::optional("sensors", Kind::Table(&SENSORS), "Sensors").when("speed", &OBSERVING),
    Key::default(
        "knows",
        Kind::Choice(KnowsWord::WORDS),
        KnowsWord::Wear.word(),
        "What the oracle knows: the wear of its edge, as in the shop; or also how the edge differs from nominal",
    )
    .when("speed", &["oracle"]),
];
const POLICY_KEYS: [Key; RULE.len() + NUMBERS.len() + OTHERS.len()] = joined(&[RULE, &NUMBERS, OTHERS]);

static POLICY: Form = Form { title: "[[policy]]", doc: "How the speed of an edge is chosen", keys: &POLICY_KEYS };

static END: Form = Form {
    title: "[end]",
    doc: "What ends an edge besides the wear limit of its parameter set, chipping and collapse",
    keys: &[
        Key::optional("flank_wear", WEAR, "Flank wear"),
        Key::optional("cutting_force", Kind::positive("N", "N", 1e7, "900 N"), "Cutting force"),
        Key::optional("path", PATH, "Cutting path; the edge is still good"),
        Key::optional("time", TIME, "Time in cut; the edge is still good"),
        Key::optional("roughness", Kind::Table(&ROUGHNESS), "Roughness that grows with flank wear"),
        Key::default(
            "failure",
            Kind::Choice(FailureWord::WORDS),
            "cut",
            "Ends that cost a failure of [replacement]: chipping and collapse, or reaching a limit as well",
        ),
    ],
};

static ROUGHNESS: Form = Form {
    title: "roughness",
    doc: "Roughness as a straight line over flank wear (assumption)",
    keys: &[
        Key::required("new", Kind::quantity("m", "um", 0.0, 1e-3, "0.8 um"), "Roughness of a new edge"),
        Key::required("per_wear", Kind::positive("1", "um/mm", 1.0, "2 um/mm"), "Growth by flank wear"),
        Key::required("limit", Kind::positive("m", "um", 1e-3, "1.6 um"), "Greatest roughness allowed"),
    ],
};

static FIELD: Form = Form {
    title: "[[field]]",
    doc: "A number of the model that varies from edge to edge; values with the unit of the field, quoted",
    keys: &[
        Key::required("name", Kind::Name, "`group.name` of the parameter set, or `cut.name`"),
        Key::required("distribution", Kind::Choice(FamilyWord::WORDS), "Family"),
        Key::required("mean", Kind::Text, "Mean").when("distribution", &["normal"]),
        Key::required("deviation", Kind::Text, "Standard deviation").when("distribution", &["normal"]),
        Key::required("median", Kind::Text, "Median").when("distribution", &["lognormal"]),
        Key::required("sigma", Kind::positive("1", "1", 10.0, "0.2"), "Standard deviation of the logarithm")
            .when("distribution", &["lognormal"]),
        Key::required("scale", Kind::Text, "Scale").when("distribution", &["weibull", "gamma"]),
        Key::required("shape", Kind::positive("1", "1", 1e4, "2.5"), "Shape")
            .when("distribution", &["weibull", "gamma"]),
        Key::required("low", Kind::Text, "Least").when("distribution", &["triangular", "uniform", "beta"]),
        Key::required("mode", Kind::Text, "Most likely").when("distribution", &["triangular"]),
        Key::required("high", Kind::Text, "Greatest").when("distribution", &["triangular", "uniform", "beta"]),
        Key::required("alpha", Kind::positive("1", "1", 1e4, "2"), "First shape").when("distribution", &["beta"]),
        Key::required("beta", Kind::positive("1", "1", 1e4, "3"), "Second shape").when("distribution", &["beta"]),
        Key::required("file", Kind::Text, "CSV file beside the study, in the display unit of the field")
            .when("distribution", &["empirical"]),
        Key::required("column", Kind::Name, "Its column").when("distribution", &["empirical"]),
        Key::optional("least", Kind::Text, "Values below are cut off"),
        Key::optional("most", Kind::Text, "Values above are cut off"),
    ],
};

static CORRELATION: Form = Form {
    title: "[[correlation]]",
    doc: "Correlation of the normal scores of two inputs",
    keys: &[
        Key::required("first", Kind::Name, "One input: a field, or `common wear`, `batch hardness`, …"),
        Key::required("second", Kind::Name, "The other"),
        Key::required("value", Kind::quantity("1", "1", -0.999, 0.999, "0.5"), "Correlation"),
    ],
};

static EARLY: Form = Form {
    title: "[early]",
    doc: "Importance sampling: draws that fail early come more often and weigh less",
    keys: &[
        Key::required("age", TIME, "Age before which a failure is early"),
        Key::default(
            "wear_shift",
            Kind::quantity("1", "1", 0.0, 6.0, "2"),
            "0",
            "Shift of the common wear, in deviations",
        ),
        Key::default("chipping_rate", Kind::positive("1", "1", 1e3, "5"), "1", "How much oftener weak edges are drawn"),
    ],
};

static REPLACEMENT: Form = Form {
    title: "[replacement]",
    doc: "Costs of replacing an edge",
    keys: &[
        Key::required("planned", COST, "Before it fails"),
        Key::required("failure", COST, "After it has failed in the cut"),
    ],
};

static SENSITIVITY: Form = Form {
    title: "[sensitivity]",
    doc: "Sobol indices and Morris screening of the life under the first condition and policy",
    keys: &[
        Key::default("samples", Kind::Count { min: 64, max: 1_000_000 }, "4096", "Rows behind the Sobol indices"),
        Key::default("trajectories", Kind::Count { min: 4, max: 100_000 }, "50", "Paths of the Morris screening"),
    ],
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::file::parse;
    use std::path::Path;
    use toolroom_form::ReadError;

    #[test]
    fn a_condition_goes_as_far_as_the_cut_of_the_model() {
        for key in CONDITION.keys.iter().filter(|key| key.name != "name") {
            let Kind::List(Kind::Quantity(quantity)) = key.kind else { panic!("{} is a list of quantities", key.name) };
            let field = CUT.iter().find(|field| field.name == key.name).expect("a field of the cut");
            assert_eq!((quantity.unit, quantity.min, quantity.max), (field.unit, field.min, field.max), "{}", key.name);
        }
    }
    #[test]
    fn every_speed_rule_of_shops_has_its_lives() {
        let numbers = |word: &str| {
            let due = |key: &&Key| {
                matches!(key.need, Need::Required) && key.when.is_some_and(|when| when.values.contains(&word))
            };
            let lines = POLICY_KEYS.iter().filter(due);
            lines.map(|key| format!("{} = {}\n", key.name, toolroom_form::example(&key.kind))).collect::<String>()
        };
        for word in RULES {
            let text = format!(
                "schema = 1\nname = \"s\"\nlives = 2\nparameter_set = \"ni_vk6om\"\n[[condition]]\n\
                 cutting_speed = \"40 m/min\"\n[[policy]]\nname = \"p\"\nspeed = \"{word}\"\n{}",
                numbers(word)
            );
            let read =
                parse("study.toml", &text, Path::new("."), &[]).unwrap_or_else(|fault| panic!("{word}: {fault:?}"));
            let study = read.content.study;
            let (tally, _) = crate::study::run::lives(&study, &study.cells[0], 0, 2, true);
            assert!(tally.life.mean() > 0.0, "{word}");
        }
    }

    #[test]
    fn what_only_a_shop_reads_is_refused() {
        let text = include_str!("../../../../scenarios/life/policies.toml").replace(
            "speed = \"minimum_wear\"",
            "speed = \"minimum_wear\"\nsensors = { spindle_power = \"2 %\", reading_time = \"30 s\", read_every = 2 }",
        );
        let refused = parse("policies.toml", &text, Path::new("."), &[]).expect_err("two keys too many");
        let ReadError::Faults(faults) = refused else { panic!("faults of the file") };
        let said: Vec<String> = faults.problems.iter().map(|problem| problem.fault.to_string()).collect();
        let does_not_apply = |key: &str| format!("`{key}` does not apply to a file of this kind");
        assert_eq!(said, [does_not_apply("reading_time"), does_not_apply("read_every")]);
    }
}
