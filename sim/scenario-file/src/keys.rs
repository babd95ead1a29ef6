//! The sections of a scenario file.

mod control;
mod crib;
mod flow;
mod gap;
mod order;
mod part;
mod policy;
pub(super) mod quantity;
mod resource;
mod shared;
mod tool;
mod transport;

use control::{DISPATCH, DISPATCH_RULE, DUE, LOOP, RELEASE};
use crib::{CRIB, MAINTENANCE};
use flow::{BATCH, VARIANT};
pub use gap::GAP;
use order::{CALENDAR, EDGE_AT_START, ORDER, SCHEDULE, TABLES, WIP};
use part::PART;
pub use policy::SENSORS;
use resource::{BUFFER, OPERATOR, PLACES, SETUP_MATRIX};
use shared::FIXTURE;
use tool::TOOL;
use toolroom_effects::USER_EFFECT;
use toolroom_form::{CURRENCIES, Form, Key, Kind};

use super::choices::{FormatWord, PatternWord, ProcessKind};
use super::measured::{CALIBRATION, SHOP_DEVIATION};
use super::tune::TUNE;
use policy::POLICY;
use quantity::{DECADE, LONG_DURATION, PLAIN, RANDOM_TIME, RATE, TIME};
use toolroom_scenario::{BatchUnit, FailureClock, Interruption};
use transport::{CREW, TRANSPORT};

/// What a spindle is able to; above 6000 m/min nothing is cut.
const SPINDLE: Kind = Kind::positive("m/s", "m/min", 100.0, "60 m/min");
/// What may become of a part in a machine that breaks down: nobody can finish it first.
const AFTER_FAILURE: &[&str] = &[Interruption::Resume.word(), Interruption::Repeat.word(), Interruption::Scrap.word()];

static SHOP: Form = Form {
    title: "[shop]",
    doc: "The study: seed, replications, simulated time",
    keys: &[
        Key::required("name", Kind::Name, "Short name, also of the output folder"),
        Key::default("title", Kind::Text, "", "One line for people"),
        Key::default("seed", Kind::Count { min: 0, max: u64::MAX }, "1", "Seed of every random stream"),
        Key::default(
            "replications",
            Kind::Count { min: 1, max: 1_000_000 },
            "20",
            "Independent repetitions of the horizon",
        ),
        Key::optional(
            "start",
            Kind::Text,
            "Date of second 0, such as \"2026-03-30 00:00\"; due where anything has a date",
        ),
        Key::required(
            "horizon",
            Kind::Dated(&LONG_DURATION),
            "Simulated time of one replication, warm-up included; where `start` is given also the date at which it ends",
        ),
        Key::default(
            "warm_up",
            Kind::Or { words: &["mser5"], other: &TIME },
            "0 h",
            "Time at the start that no statistic counts; mser5: as long as lead times still rise, found from runs before",
        ),
        Key::default(
            "shift_length",
            LONG_DURATION,
            "8 h",
            "Length of the shift to which rates refer (parts per shift)",
        ),
        Key::default(
            "move_time",
            RANDOM_TIME,
            "0 min",
            "Time of a move from the `location` of a machine to another one, where no [[transport]] knows both",
        ),
        Key::default("currency", Kind::Choice(CURRENCIES), "EUR", "Currency of every amount"),
    ],
};

static MACHINE: Form = Form {
    title: "[[machine]]",
    doc: "A machine tool, or several of one kind",
    keys: &[
        Key::required(
            "name",
            Kind::Name,
            "Unique name; with `count` the prefix of L1, L2, …, and the name of them all",
        ),
        Key::optional(
            "count",
            Kind::Count { min: 1, max: 1000 },
            "Number of machines of this kind; left out: one, called as it is",
        ),
        Key::required(
            "process",
            Kind::Choice(ProcessKind::OF_MACHINES),
            "Process that it can run beside plain work; plain: none",
        ),
        Key::required("rate", RATE, "Cost of an hour of machine and operator").when("process", ProcessKind::WORDS),
        Key::default("rate", RATE, "0 EUR/h", "Cost of an hour of machine and operator").when("process", PLAIN),
        Key::required("load_time", RANDOM_TIME, "Fastening a part").when("process", ProcessKind::WORDS),
        Key::default("load_time", RANDOM_TIME, "0 min", "Fastening a part").when("process", PLAIN),
        Key::required("unload_time", RANDOM_TIME, "Taking it off").when("process", ProcessKind::WORDS),
        Key::default("unload_time", RANDOM_TIME, "0 min", "Taking it off").when("process", PLAIN),
        Key::default("tool_change_time", TIME, "0 min", "Changing a worn edge for a new one"),
        Key::default(
            "setup_time",
            TIME,
            "0 min",
            "Change over when the setup group changes, unless the operation gives its own; the first one costs nothing without `setup_at_start`",
        ),
        Key::optional(
            "setup_matrix",
            Kind::Reference("setup_matrix"),
            "Setup times by the groups before and after; goes before those of machine and operation",
        ),
        Key::optional(
            "setup_at_start",
            Kind::Text,
            "Setup group for which it stands ready at the start, \"\" for none; left out: for whatever comes first",
        ),
        Key::optional(
            "edge_at_start",
            Kind::Tables(&EDGE_AT_START),
            "Worn edges that are in it at the start; left out: new ones",
        ),
        Key::default(
            "magazine",
            Kind::Count { min: 1, max: 100_000 },
            "100000",
            "Edges in the magazine before an operator has to refill it",
        ),
        Key::default("refill_time", TIME, "0 min", "Refilling the magazine"),
        Key::required("speed_range", Kind::List(&SPINDLE), "Least and greatest cutting speed of spindle and program")
            .when("process", ProcessKind::CUTTING),
        Key::default(
            "idle_power",
            Kind::quantity("W", "kW", 0.0, 1e6, "1.5 kW"),
            "0 kW",
            "Power of the spindle without cut",
        ),
        Key::optional(
            "coolant_change",
            TIME,
            "When another coolant is filled in: fresh from then on, and the effect `coolant_change` acts",
        ),
        Key::optional("calendar", Kind::Reference("calendar"), "Working time; always, if left out"),
        Key::optional(
            "buffer_unit",
            Kind::Choice(BatchUnit::WORDS),
            "What takes a place of its buffers: all that moves together (lots), or each piece; left out: lots",
        ),
        Key::optional(
            "input_buffer",
            PLACES,
            "Places before the machines of this section, together; left out: as many as are needed",
        ),
        Key::optional(
            "output_buffer",
            PLACES,
            "Places behind them for parts that cannot move on; left out: none, such a part stays on its machine",
        ),
        Key::optional("location", Kind::Name, "Where it stands, for [[transport]]; left out: the name of this section"),
        Key::optional(
            "batch",
            Kind::Table(&BATCH),
            "How it works on several jobs at once; left out: one after the other",
        )
        .when("process", PLAIN),
        Key::optional("rule", Kind::List(&DISPATCH_RULE), "Rule of its queue, or up to three; left out: the shop's"),
    ],
};

static ARRIVALS: Form = Form {
    title: "[[arrivals]]",
    doc: "A source of jobs",
    keys: &[
        Key::optional(
            "name",
            Kind::Name,
            "Unique name: what it draws stays the same whatever other sources there are; left out: it is called by its part",
        ),
        Key::optional("part", Kind::Reference("part"), "Part; due unless `part_mix` is given"),
        Key::optional(
            "part_mix",
            Kind::Content(&flow::PART_MIX),
            "Parts with their shares of the jobs, each drawn when it comes: { shaft = 0.3, ring = 0.7 }",
        ),
        Key::default(
            "quantity",
            Kind::Shorthand { word: &flow::COUNT, form: &flow::QUANTITY },
            "1",
            "Pieces of a job, which move together; a table draws them for each job",
        ),
        Key::required("pattern", Kind::Choice(PatternWord::WORDS), "When jobs come"),
        order::PRIORITY,
        order::WEIGHT,
        Key::optional(
            "due",
            Kind::Table(&DUE),
            "When jobs are due; left out: the part's flow_allowance after they came",
        ),
        Key::required("rate", Kind::positive("1/s", "1/h", 100.0, "5 1/h"), "Jobs per time")
            .when("pattern", &["poisson"]),
        Key::required("time_between", RANDOM_TIME, "Time between jobs, and to the first of them")
            .when("pattern", &["renewal"]),
        Key::required("interval", LONG_DURATION, "Time between lots, the first at time zero")
            .when("pattern", &["batch"]),
        Key::required("size", Kind::Count { min: 1, max: 1_000_000 }, "Jobs in a lot").when("pattern", &["batch"]),
        Key::required("lot", Kind::Tables(&LOT), "Lots in order").when("pattern", &["schedule"]),
        Key::required("jobs", Kind::Count { min: 1, max: 1_000_000 }, "Jobs kept in the shop")
            .when("pattern", &["constant_work"]),
    ],
};

static LOT: Form = Form {
    title: "[[arrivals.lot]]",
    doc: "Jobs that come together",
    keys: &[
        Key::required("time", Kind::quantity("s", "h", 0.0, DECADE, "6 h"), "When"),
        Key::default("size", Kind::Count { min: 1, max: 1_000_000 }, "1", "How many"),
    ],
};

static FAILURE: Form = Form {
    title: "[[failure]]",
    doc: "A way for machines to break down",
    keys: &[
        Key::optional(
            "name",
            Kind::Name,
            "Unique name: what it draws stays the same whatever other breakdowns there are; left out: it draws by its mean times",
        ),
        Key::required("machines", Kind::List(&Kind::Reference("machine")), "Machines; each breaks down by itself"),
        Key::required("time_between", RANDOM_TIME, "Time to failure on its clock"),
        Key::required("time_to_repair", RANDOM_TIME, "Time to repair"),
        Key::default(
            "clock",
            Kind::Choice(FailureClock::WORDS),
            FailureClock::Busy.word(),
            "Whether only working time counts towards the failure, or all",
        ),
        Key::optional(
            "crew",
            Kind::Reference("crew"),
            "Who repairs it, when they are free; left out: somebody at once",
        ),
        Key::default(
            "part",
            Kind::Choice(AFTER_FAILURE),
            Interruption::Resume.word(),
            "What becomes of the part in the machine",
        ),
    ],
};

static STATISTICS: Form = Form {
    title: "[statistics]",
    doc: "What is to be known and how well; the options of the command line go before it",
    keys: &[
        Key::optional(
            "primary",
            Kind::Name,
            "Figure that matters most: schedule.html and schedule.csv show the replication with its median; left out: the first",
        ),
        Key::optional(
            "until",
            Kind::Texts,
            "Figures and how well they have to be known: { lead_time = \"half-width 2 %\" }; as --until",
        ),
        Key::optional(
            "max_replications",
            Kind::Count { min: 1, max: 1_000_000 },
            "Most replications until figures are known so well, unless --replications says it; left out: `replications` of [shop]",
        ),
        Key::optional(
            "select",
            Kind::Table(&SELECT),
            "By what `toolroom compare` selects the best of the shop and its variants; as --select",
        ),
    ],
};

static SELECT: Form = Form {
    title: "select",
    doc: "The best of the shop and its variants by the procedure of Kim and Nelson",
    keys: &[
        Key::required("kpi", Kind::Name, "Figure of the shop, or late_orders"),
        Key::required(
            "indifference",
            Kind::Text,
            "Least difference that matters: with the unit of the figure, or in % of the shop as it is",
        ),
        Key::default(
            "confidence",
            Kind::quantity("1", "1", 0.5, 0.9999, "95 %"),
            "95 %",
            "Probability with which the best is selected, where it is better by that much",
        ),
    ],
};

static OUTPUT: Form = Form {
    title: "[output]",
    doc: "What is written",
    keys: &[
        Key::default("format", Kind::Choice(FormatWord::WORDS), FormatWord::Parquet.word(), "Format of the log tables"),
        Key::default("logs", Kind::Flag, "true", "Whether the log tables are written at all"),
    ],
};

/// The whole file.
pub static SCENARIO: Form = Form {
    title: "the scenario",
    doc: "One shop under one or more policies, for toolroom",
    keys: &[
        Key::required("schema", Kind::Count { min: 1, max: u64::MAX }, "Version of the format, 1"),
        Key::required("shop", Kind::Table(&SHOP), "The study"),
        Key::optional("calendar", Kind::Tables(&CALENDAR), "Working time"),
        Key::optional("machine", Kind::Tables(&MACHINE), "Machines"),
        Key::optional("setup_matrix", Kind::Tables(&SETUP_MATRIX), "Setup times between setup groups"),
        Key::optional("buffer", Kind::Tables(&BUFFER), "Places before machines, where several share them"),
        Key::optional("operator", Kind::Tables(&OPERATOR), "People"),
        Key::optional("crew", Kind::Tables(&CREW), "People who repair machines"),
        Key::optional("fixture", Kind::Tables(&FIXTURE), "Fixtures and pallets"),
        Key::optional("crib", Kind::Tables(&CRIB), "Tool cribs: edges that are limited"),
        Key::optional("transport", Kind::Tables(&TRANSPORT), "Vehicles between places"),
        Key::optional("tool", Kind::Tables(&TOOL), "Tools"),
        Key::optional("part", Kind::Tables(&PART), "Parts with their routings"),
        Key::optional("arrivals", Kind::Tables(&ARRIVALS), "Where jobs come from"),
        Key::optional("order", Kind::Tables(&ORDER), "Orders: quantities of parts with dates"),
        Key::optional("stock", Kind::Tables(&flow::STOCK), "Components in stock, and their reorders"),
        Key::optional("wip", Kind::Tables(&WIP), "Orders that are in the shop when the run begins"),
        Key::optional("schedule", Kind::Tables(&SCHEDULE), "Sequences that machines follow in the place of rules"),
        Key::optional("tables", Kind::Table(&TABLES), "Tables in files beside this one"),
        Key::optional("dispatch", Kind::Table(&DISPATCH), "Which waiting job a free machine takes"),
        Key::optional("loop", Kind::Tables(&LOOP), "Limited numbers of jobs between stations: CONWIP and kanban"),
        Key::optional("release", Kind::Table(&RELEASE), "When jobs that have come are let into the shop"),
        Key::optional("failure", Kind::Tables(&FAILURE), "Breakdowns"),
        Key::optional("maintenance", Kind::Tables(&MAINTENANCE), "Planned maintenance"),
        Key::optional(
            "policy",
            Kind::Tables(&POLICY),
            "The comparison axis; left out: one policy, everything as programmed",
        ),
        Key::optional("deviation", Kind::Tables(&SHOP_DEVIATION), "What the true shop does otherwise than planned"),
        Key::optional(
            "variant",
            Kind::Tables(&VARIANT),
            "The shop with some values changed, compared with the shop as it is",
        ),
        Key::optional("calibration", Kind::Tables(&CALIBRATION), "Constants that measurements have moved"),
        Key::optional("effect", Kind::Tables(&USER_EFFECT), "Effects of your own, beside those of the catalogue"),
        Key::optional("tune", Kind::Table(&TUNE), "Tunes the policies before `toolroom compare` judges them"),
        Key::optional("statistics", Kind::Table(&STATISTICS), "What is to be known and how well"),
        Key::optional("output", Kind::Table(&OUTPUT), "What is written"),
        Key::optional("gap", Kind::Table(&GAP), "Priors and sensors of a diagnosis against measured records"),
    ],
};

#[cfg(test)]
mod tests {
    use super::*;
    use toolroom_cutting::{MillingInput, TurningInput};
    use toolroom_process::Record as _;

    #[test]
    fn speeds_of_a_cut_have_the_range_of_the_models() {
        let Kind::Quantity(speed) = toolroom_scenario::SPEED else { panic!("a quantity") };
        for fields in [TurningInput::<f64>::FIELDS, MillingInput::<f64>::FIELDS] {
            let field = fields.iter().find(|field| field.name == "cutting_speed").expect("a speed");
            assert_eq!((field.unit, field.max), (speed.unit, speed.max));
        }
    }
}
