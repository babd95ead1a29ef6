//! The sections of a policy: speed, chatter, tool change, grinding, dressing, sensors.

use super::quantity::{BIAS, DEVIATION, DURATION, TIME};
use crate::choices::{ChatterWord, DressingWord, GrindingWord, ToolChangeWord};
use crate::{speed, tune};
use toolroom_form::{Form, Key, Kind, joined};
use toolroom_scenario::{ContourRule, WEAR};

/// Rules of tool change that need no number of their own.
const TOOL_CHANGES_BY_WORD: &[&str] = &[ToolChangeWord::WearLimit.word(), ToolChangeWord::Predicted.word()];
/// Rules of dressing that need no number of their own.
const DRESSINGS_BY_WORD: &[&str] = &[DressingWord::Limit.word()];

const NAME: &[Key] = &[Key::required("name", Kind::Name, "Unique name")];
/// What a policy does beside choosing the speed.
const OTHERS: &[Key] = &[
    Key::default(
        "chatter",
        Kind::Shorthand { word: &Kind::Choice(ChatterWord::WORDS), form: &CHATTER },
        ChatterWord::Ignore.word(),
        "What is done about chatter, where tools have a structure",
    ),
    Key::default(
        "tool_change",
        Kind::Shorthand { word: &Kind::Choice(TOOL_CHANGES_BY_WORD), form: &TOOL_CHANGE },
        ToolChangeWord::WearLimit.word(),
        "When an edge is changed",
    ),
    Key::default(
        "grinding",
        Kind::Shorthand { word: &Kind::Choice(GrindingWord::WORDS), form: &GRINDING },
        GrindingWord::Fixed.word(),
        "How designed grinding cycles are run",
    ),
    Key::default(
        "dressing",
        Kind::Shorthand { word: &Kind::Choice(DRESSINGS_BY_WORD), form: &DRESSING },
        DressingWord::Limit.word(),
        "When a wheel is dressed",
    ),
    Key::optional(
        "contour",
        Kind::Choice(ContourRule::WORDS),
        "How contours are planned; left out: as each operation says",
    ),
    Key::optional(
        "believed_model",
        Kind::Name,
        "Parameter set that the controller believes in, where it is not the tool's own",
    ),
    Key::optional("sensors", Kind::Table(&SENSORS), "Sensors of adaptive rules"),
    Key::optional(
        "tune",
        Kind::Shorthand { word: &Kind::Flag, form: &tune::RANGES },
        "Whether the policy is tuned by `compare --tune`, or the ranges within which; left out: true",
    ),
];
const KEYS: [Key; NAME.len() + speed::KEYS.len() + OTHERS.len()] = joined(&[NAME, speed::KEYS, OTHERS]);

pub(super) static POLICY: Form =
    Form { title: "[[policy]]", doc: "One policy; the first is the baseline of every difference", keys: &KEYS };

/// What is done about chatter.
static CHATTER: Form = Form {
    title: "chatter",
    doc: "What is done about chatter; only `reactive` listens to the true structure",
    keys: &[
        Key::required("rule", Kind::Choice(ChatterWord::WORDS), "Rule"),
        Key::default(
            "reaction_time",
            Kind::quantity("s", "s", 0.0, 3600.0, "2 s"),
            "2 s",
            "From chatter to the new speed, a whole fraction of its frequency",
        )
        .when("rule", &["reactive"]),
        Key::default(
            "amplitude",
            Kind::positive("1", "1", 0.5, "0.2"),
            "0.2",
            "Amplitude of the speed over its mean (RVA)",
        )
        .when("rule", &["speed_variation"]),
        Key::default(
            "revolutions",
            Kind::Count { min: 2, max: 200 },
            "5",
            "Mean revolutions in a period of the variation (1/RVF)",
        )
        .when("rule", &["speed_variation"]),
        Key::default(
            "share",
            Kind::positive("1", "1", 1.0, "0.9"),
            "0.9",
            "Greatest depth of a layer over the nominal limit",
        )
        .when("rule", &["depth_reduction"]),
        Key::default("natural_frequency", DEVIATION, "2 %", "Uncertainty of natural frequencies")
            .when("rule", &["robust_lobe"]),
        Key::default("damping_ratio", DEVIATION, "20 %", "Uncertainty of damping ratios")
            .when("rule", &["robust_lobe"]),
        Key::default("coefficients", DEVIATION, "10 %", "Uncertainty of cutting coefficients")
            .when("rule", &["robust_lobe"]),
        Key::default("margin", Kind::quantity("1", "1", 0.0, 0.9, "0.1"), "0.1", "Margin to be kept, 1 - depth/limit")
            .when("rule", &["constraint"]),
    ],
};

/// When an edge is changed.
static TOOL_CHANGE: Form = Form {
    title: "tool_change",
    doc: "When an edge is changed; decided between passes",
    keys: &[
        Key::required("rule", Kind::Choice(ToolChangeWord::WORDS), "Rule"),
        Key::optional("limit", WEAR, "Flank wear; left out: the tool's wear limit")
            .when("rule", &["wear_limit", "predicted"]),
        Key::required("parts", Kind::Count { min: 1, max: 1_000_000 }, "Parts per edge").when("rule", &["part_count"]),
        Key::required("time", DURATION, "Cutting time per edge").when("rule", &["cutting_time"]),
    ],
};

static GRINDING: Form = Form {
    title: "grinding",
    doc: "How designed cycles are run",
    keys: &[
        Key::required("rule", Kind::Choice(GrindingWord::WORDS), "Rule"),
        Key::default(
            "dulling",
            Kind::quantity("1", "1", 0.2, 10.0, "1.3"),
            "1",
            "Process stiffness, over that of a dressed wheel, for which the cycle is designed",
        ),
        Key::optional(
            "rough_force",
            Kind::positive("N", "N", 1e6, "180 N"),
            "Normal force above which the rough infeed is left; left out: that of a dressed wheel at the rough temperature limit",
        )
        .when("rule", &["force_adaptive"]),
        Key::optional("redesign", Kind::Flag, "Whether infeeds too follow the dulling that the last parts showed; left out: false")
            .when("rule", &["time_constant_adaptive"]),
    ],
};

static DRESSING: Form = Form {
    title: "dressing",
    doc: "When a wheel is dressed; decided after each part",
    keys: &[
        Key::required("rule", Kind::Choice(DressingWord::WORDS), "Rule"),
        Key::required("parts", Kind::Count { min: 1, max: 1_000_000 }, "Parts per dressing; 1 dresses for every part")
            .when("rule", &["part_count"]),
        Key::required(
            "ratio",
            Kind::quantity("1", "1", 1.0, 20.0, "1.4"),
            "Measured process stiffness over that of a dressed wheel",
        )
        .when("rule", &["dulling"]),
    ],
};

const NOISE: Kind = Kind::quantity("1", "1", 0.0, 1.0, "1.5 %");

/// Sensors; the defaults are those of the observer's derivation.
/// Sensors of an adaptive controller.
pub static SENSORS: Form = Form {
    title: "sensors",
    doc: "What an adaptive controller measures, and how well",
    keys: &[
        Key::default("sampling_period", Kind::positive("s", "s", 3600.0, "6 s"), "6 s", "Time between samples"),
        Key::default("spindle_power", NOISE, "1.5 %", "Relative standard deviation of spindle power"),
        Key::default("feed_force", NOISE, "3 %", "Relative standard deviation of feed force"),
        Key::default("thermo_emf", NOISE, "1.5 %", "Relative standard deviation of thermo-EMF"),
        Key::default("thermo_emf_bias", BIAS, "0", "Systematic relative error of thermo-EMF"),
        Key::default("feed_force_bias", BIAS, "0", "Systematic relative error of feed force"),
        Key::default("spindle_power_bias", BIAS, "0", "Systematic relative error of spindle power"),
        Key::default(
            "flank_wear",
            Kind::quantity("m", "mm", 0.0, 1e-3, "0.01 mm"),
            "0.01 mm",
            "Standard deviation of a flank wear reading",
        ),
        Key::default("reading_time", TIME, "0 s", "Time that a flank wear reading takes on the machine"),
        Key::default("read_every", Kind::Count { min: 1, max: 10_000 }, "1", "Passes from one reading to the next"),
        Key::default(
            "feed_force_gain",
            NOISE,
            "5 %",
            "Systematic error of the feed force that the observer reckons with where wear is read",
        ),
        Key::default("thermo_emf_gain", NOISE, "2 %", "The same of the thermo-EMF"),
        Key::default(
            "dominant_frequency",
            NOISE,
            "0.5 %",
            "Relative standard deviation of a measured chatter frequency",
        ),
        Key::default(
            "normal_force",
            Kind::quantity("N", "N", 0.0, 1e5, "2 N"),
            "2 N",
            "Standard deviation of the normal force in grinding",
        ),
        Key::default("normal_force_bias", BIAS, "0", "Systematic relative error of that force"),
    ],
};
