//! Parts: their routing, its operations, and the passes and phases of an operation.

use super::flow::{COMPONENT, ON_REJECT, OUTCOME, OVERRUN, SAMPLE};
use super::quantity::{COST, LONG_DURATION, PLAIN, RANDOM_TIME, SHARE};
use super::resource::ATTENDANCE;
use crate::choices::{ProcessKind, RoutingWord};
use serde_json::json;
use toolroom_form::{Content, Form, Key, Kind};
use toolroom_infeed::CycleLimits;
use toolroom_process::Record;
use toolroom_scenario::{
    ContourRule, DrawUnit, InspectedUnit, MachineChoice, MachineType, PATH, Pegging, SPEED, WorkPer,
};

/// Processes with a cutting speed, and plain work, in which an edge may wear by it.
const WITH_SPEED: &[&str] = &{
    let mut words = [MachineType::PLAIN; ProcessKind::CUTTING.len() + 1];
    let mut i = 0;
    while i < ProcessKind::CUTTING.len() {
        words[i] = ProcessKind::CUTTING[i];
        i += 1;
    }
    words
};

const FEED: Kind = Kind::positive("m", "mm", 20e-3, "0.12 mm/rev");
const FEED_PER_TOOTH: Kind = Kind::positive("m", "mm", 5e-3, "0.1 mm/tooth");
const DEPTH: Kind = Kind::positive("m", "mm", 0.1, "0.75 mm");
const LENGTH: Kind = Kind::positive("m", "mm", 1e4, "250 mm");

/// Times on machines.
static TIME_ON: Content = Content {
    expected: "a table of machines and times",
    example: "{ CMM3 = 1.25 }",
    schema: || {
        json!({
            "type": "object",
            "additionalProperties": {
                "anyOf": [{ "type": "number", "exclusiveMinimum": 0 }, { "type": "string" }, { "type": "object" }],
            },
            "description": "By the names of machines a factor on the time, or a duration or distribution of its own",
        })
    },
    entry: None,
};

pub(super) static PART: Form = Form {
    title: "[[part]]",
    doc: "A part and its routing",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::default("material_cost", COST, "0 EUR", "Cost of the blank, lost when the part is scrapped"),
        Key::default("flow_allowance", LONG_DURATION, "8 h", "Time from arrival to due date"),
        Key::default("batch_size", Kind::Count { min: 1, max: 1_000_000 }, "25", "Workpieces of one hardness batch"),
        Key::optional(
            "deviating_lot",
            Kind::Count { min: 1, max: 1_000_000 },
            "Batch from each source, the first being 1, on which the effect `lot_hardness` acts",
        ),
        Key::optional(
            "components",
            Kind::Tables(&COMPONENT),
            "Parts that go into one of it, taken from the stock of finished ones where an operation has `assemble = true`",
        ),
        Key::default(
            "pegging",
            Kind::Choice(Pegging::WORDS),
            Pegging::Stock.word(),
            "Which components it takes: what is in stock, or what orders have made that name its order as their `parent`",
        ),
        Key::default(
            "replenish",
            Kind::Shorthand { word: &Kind::Choice(&["none", "new_order"]), form: &OVERRUN },
            "none",
            "What is done about pieces of an order that are lost: nothing, as many begin anew at once, or more are begun with",
        ),
        Key::optional(
            "replenish_priority",
            Kind::quantity("1", "1", -1e6, 1e6, "-1"),
            "What the priority of pieces that begin anew differs from that of their order, with replenish = \"new_order\"; left out: 0",
        ),
        Key::default(
            "routing",
            Kind::Choice(RoutingWord::WORDS),
            RoutingWord::Fixed.word(),
            "fixed: operations in their order here; random: every job has an order of its own, drawn when it comes",
        ),
        Key::optional("operation", Kind::Tables(&OPERATION), "Operations in order"),
    ],
};

static OPERATION: Form = Form {
    title: "[[part.operation]]",
    doc: "One operation of the routing",
    keys: &[
        Key::required("name", Kind::Name, "Name, unique within the part"),
        Key::required("machines", Kind::List(&Kind::Reference("machine")), "Machines that may do it"),
        Key::optional(
            "work",
            RANDOM_TIME,
            "Time of plain work, of which nothing else is known: no tool and nothing that is cut",
        )
        .when("process", PLAIN),
        Key::optional(
            "time_on",
            Kind::Content(&TIME_ON),
            "Machines on which this time is multiplied by a factor, such as { CMM3 = 1.25 }, or is another one, such as \
             { CMM3 = { distribution = \"exponential\", mean = \"5 min\" } }",
        )
        .when("process", PLAIN),
        Key::optional(
            "machine_choice",
            Kind::Choice(MachineChoice::WORDS),
            "Which of several idle machines takes it; left out: that of [dispatch]",
        ),
        Key::default(
            "work_per",
            Kind::Choice(WorkPer::WORDS),
            WorkPer::Part.word(),
            "What takes this time once: every piece, all that moves together, or all that a machine with `batch` takes",
        )
        .when("process", PLAIN),
        Key::default(
            "draw",
            Kind::Choice(DrawUnit::WORDS),
            DrawUnit::Lot.word(),
            "Whether a random time is drawn once for all pieces of an order, or for every piece",
        )
        .when("process", PLAIN),
        Key::default(
            "preemptible",
            Kind::Flag,
            "true",
            "Whether a job of better priority may interrupt it, where `[dispatch] preempt` lets it",
        )
        .when("process", PLAIN),
        Key::default(
            "assemble",
            Kind::Flag,
            "false",
            "Whether it begins only when all components of its part are in stock, and takes them together",
        )
        .when("process", PLAIN),
        Key::optional(
            "tool",
            Kind::Reference("tool"),
            "Tool; due unless `work` or `program` is given; with `work` one of process = \"life_only\", whose edge wears in it",
        ),
        Key::optional(
            "setup_group",
            Kind::Name,
            "Fixture and program family; a change of it costs a setup; left out: the part's name",
        ),
        Key::optional(
            "setup_time",
            RANDOM_TIME,
            "Setup time, of which rules and choices know the mean where it is random; left out: the machine's",
        ),
        super::shared::USES_FIXTURE,
        super::shared::HOLD,
        Key::optional("operator", Kind::Table(&ATTENDANCE), "Skills that its steps need; left out: none"),
        Key::optional(
            "outcomes",
            Kind::Tables(&OUTCOME),
            "What an inspection finds when it is done: shares that go back to an operation or are scrapped; the rest goes on",
        ),
        Key::default(
            "outcomes_per",
            Kind::Choice(InspectedUnit::WORDS),
            InspectedUnit::Part.word(),
            "Whether pieces of an order are judged one by one or all alike",
        ),
        Key::optional(
            "rework_max",
            Kind::Count { min: 0, max: 1_000_000 },
            "How often a job is sent back before it is scrapped instead; left out: without limit",
        ),
        Key::optional(
            "sample",
            Kind::Table(&SAMPLE),
            "Which pieces the `outcomes` are about; left out: all of them",
        ),
        Key::optional(
            "on_reject",
            Kind::Table(&ON_REJECT),
            "Where parts go that are out of tolerance, rough or burnt; left out: to the scrap",
        )
        .when("process", ProcessKind::WORDS),
        Key::required("size_tolerance", Kind::positive("m", "um", 0.05, "50 um"), "Greatest size error of a good part")
            .when("process", ProcessKind::WORDS),
        Key::optional(
            "roughness_limit",
            Kind::positive("m", "um", 1e-3, "3.2 um"),
            "Greatest roughness Ra of a good part after the last pass; left out: not looked at",
        )
        .when("process", ProcessKind::CUTTING),
        Key::default("scrap_on_tool_failure", SHARE, "0.5", "Share of parts that a broken edge spoils")
            .when("process", ProcessKind::WORDS),
        Key::optional("passes", Kind::Count { min: 1, max: 1000 }, "Number of equal passes; left out: one")
            .when("process", ProcessKind::CUTTING),
        Key::optional(
            "cutting_speed",
            SPEED,
            "Programmed cutting speed; of plain work with a tool whose `life_at` says how edges last at another, left out: that of `life_at`",
        )
        .when("process", WITH_SPEED),
        Key::optional("feed_per_rev", FEED, "Feed per revolution").when("process", &["turning"]),
        Key::optional("feed_per_tooth", FEED_PER_TOOTH, "Feed per tooth").when("process", ProcessKind::PER_TOOTH),
        Key::optional("depth_of_cut", DEPTH, "Depth of cut").when("process", ProcessKind::CUTTING),
        Key::optional("width_of_cut", LENGTH, "Width of cut").when("process", ProcessKind::PER_TOOTH),
        Key::optional("path_length", PATH, "Cutting path of a turning edge, or path of the cutter axis, in one pass")
            .when("process", ProcessKind::CUTTING),
        Key::optional(
            "diameter",
            LENGTH,
            "Work diameter; the path of a turning pass is pi * diameter * length / feed_per_rev",
        )
        .when("process", &["turning"]),
        Key::optional("length", LENGTH, "Length of cut in feed direction").when("process", &["turning"]),
        Key::optional(
            "position",
            LENGTH,
            "Place of the tool from the jaws at the start of a pass, which runs towards them; left out: the structure's",
        )
        .when("process", &["turning"]),
        Key::optional("pass", Kind::Tables(&PASS), "Passes one by one; what a pass leaves out is the operation's")
            .when("process", ProcessKind::CUTTING),
        Key::optional(
            "contour",
            Kind::Text,
            "Instead of passes: path of a contour file, from the folder of this file; its constants are what the plan believes",
        )
        .when("process", ProcessKind::PER_TOOTH),
        Key::optional(
            "program",
            Kind::Text,
            "Instead of tool and passes: path of a part program, from the folder of this file, which a mill runs with the tools of its setup",
        )
        .when("process", ProcessKind::PER_TOOTH),
        Key::optional("setup", Kind::Text, "Setup file of the program: its stock, tools and machine")
            .when("process", ProcessKind::PER_TOOTH),
        Key::optional("contour_passes", Kind::List(&Kind::Name), "Passes of the contour file in order; left out: all")
            .when("process", ProcessKind::PER_TOOTH),
        Key::optional(
            "plan",
            Kind::Choice(ContourRule::WORDS),
            "Regime that is programmed, where the policy has none of its own; left out: handbook_one_feed",
        )
        .when("process", ProcessKind::PER_TOOTH),
        Key::optional("work_rotation_speed", Kind::positive("rad/s", "rpm", 1000.0, "292 rpm"), "Rotation of the work")
            .when("process", &["infeed"]),
        Key::optional("phase", Kind::Tables(&PHASE), "Infeed phases in order; spark-out is a phase of infeed zero")
            .when("process", &["infeed"]),
        Key::optional(
            "cycle",
            Kind::Fields { word: &Kind::Text, fields: CycleLimits::FIELDS },
            "Instead of phases: limits for which the fastest rough, finish and spark-out cycle is designed, or the path of a cycle file",
        )
        .when("process", &["infeed"]),
        Key::optional(
            "wear_compensation",
            SHARE,
            "Share of the wheel's wear that is corrected before each part of a designed cycle; left out: 1",
        )
        .when("process", &["infeed"]),
    ],
};

static PASS: Form = Form {
    title: "[[part.operation.pass]]",
    doc: "One pass; what it leaves out is the operation's",
    keys: &[
        Key::optional("cutting_speed", SPEED, "Programmed cutting speed"),
        Key::optional("feed_per_rev", FEED, "Feed per revolution").when("process", &["turning"]),
        Key::optional("feed_per_tooth", FEED_PER_TOOTH, "Feed per tooth").when("process", ProcessKind::PER_TOOTH),
        Key::optional("depth_of_cut", DEPTH, "Depth of cut"),
        Key::optional("width_of_cut", LENGTH, "Width of cut").when("process", ProcessKind::PER_TOOTH),
        Key::optional("path_length", PATH, "Path of this pass"),
        Key::optional("diameter", LENGTH, "Work diameter").when("process", &["turning"]),
        Key::optional("length", LENGTH, "Length of cut in feed direction").when("process", &["turning"]),
        Key::optional(
            "position",
            LENGTH,
            "Place of the tool from the jaws at the start of a pass, which runs towards them; left out: the structure's",
        )
        .when("process", &["turning"]),
    ],
};

static PHASE: Form = Form {
    title: "[[part.operation.phase]]",
    doc: "Revolutions at one infeed",
    keys: &[
        Key::required(
            "infeed_per_rev",
            Kind::quantity("m", "um", 0.0, 1e-3, "4.4 um/rev"),
            "Infeed per revolution of the work",
        ),
        Key::required("revolutions", Kind::Count { min: 1, max: 100_000 }, "Whole revolutions"),
    ],
};
