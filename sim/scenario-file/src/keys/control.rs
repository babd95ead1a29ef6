//! How work is chosen and let in: dispatching, loops of cards, release, due dates of sources.

use super::quantity::{LONG_DURATION, RANDOM_TIME, TIME};
use crate::choices::{DueWord, ReleaseWord};
use toolroom_form::{Form, Key, Kind};
use toolroom_scenario::{
    Assignment, Blocking, Deadlock, DispatchRule, KeyTime, MachineChoice, NextQueue, Preemption, QueueChoice, SlackBy,
};

pub(super) const DISPATCH_RULE: Kind = Kind::Choice(DispatchRule::NAMES);

pub(super) static DISPATCH: Form = Form {
    title: "[dispatch]",
    doc: "Which waiting job a free machine takes, and which machine a waiting job",
    keys: &[
        Key::default(
            "rule",
            Kind::List(&DISPATCH_RULE),
            DispatchRule::Fifo.word(),
            "Rule, or up to three, each deciding where the ones before are equal; then arrival at the queue, then job number",
        ),
        Key::default(
            "machine_choice",
            Kind::Choice(MachineChoice::WORDS),
            MachineChoice::LeastSetup.word(),
            "Which of several idle machines takes a job; ties go to the first of the file",
        ),
        Key::default(
            "blocking",
            Kind::Choice(Blocking::WORDS),
            Blocking::AfterService.word(),
            "Where buffers are limited: a part that is done keeps its machine until there is a place, or a machine begins only when a place is reserved",
        ),
        Key::default(
            "deadlock",
            Kind::Choice(Deadlock::WORDS),
            Deadlock::Stop.word(),
            "Parts that wait for each other's places in a circle: the run stops and names them, or they change places",
        ),
        Key::default(
            "preempt",
            Kind::Choice(Preemption::WORDS),
            Preemption::None.word(),
            "What becomes of plain work in a machine when a waiting job of strictly better priority needs that machine",
        ),
        Key::default(
            "assign",
            Kind::Choice(Assignment::WORDS),
            Assignment::AtStart.word(),
            "Whether the machines of an operation have one queue, or a job joins the queue of one of them when it comes",
        ),
        Key::default(
            "queue_choice",
            Kind::Choice(QueueChoice::WORDS),
            QueueChoice::ShortestQueue.word(),
            "Which queue a job joins with assign = \"at_arrival\"",
        ),
        Key::default(
            "time_in_key",
            Kind::Choice(KeyTime::WORDS),
            KeyTime::Drawn.word(),
            "Times of plain work that rules know: those that were drawn, or the means",
        ),
        Key::default(
            "setup_in_key",
            Kind::Flag,
            "false",
            "Whether the setup that the machine would need is part of the time of an operation for the rules",
        ),
        Key::default(
            "slack_by",
            Kind::Choice(SlackBy::WORDS),
            SlackBy::Job.word(),
            "Slack in `atc`, `atcs` and `covert`: of the job, or of the operation by its own due date and time",
        ),
        Key::default(
            "next_queue",
            Kind::Choice(NextQueue::WORDS),
            NextQueue::Waiting.word(),
            "Work in the next queue for `winq` and its kin: of the jobs that wait, or with what is left of those in work",
        ),
        Key::default("atc_k", LOOK_AHEAD, "3", "Look-ahead of `atc`, in mean times of the queue"),
        Key::default("atcs_k1", LOOK_AHEAD, "3", "Look-ahead of `atcs` for slack, in mean times of the queue"),
        Key::default("atcs_k2", LOOK_AHEAD, "1", "Look-ahead of `atcs` for setups, in mean setups of the queue"),
        Key::default("covert_k", LOOK_AHEAD, "2", "Expected wait of `covert`, in the work left"),
        Key::default("covert_b", LOOK_AHEAD, "2", "Look-ahead of `covert`, in expected waits"),
    ],
};

/// A constant of a rule, in what it looks ahead of.
const LOOK_AHEAD: Kind = Kind::positive("1", "1", 1000.0, "2");

pub(super) static LOOP: Form = Form {
    title: "[[loop]]",
    doc: "A limited number of jobs between two stations: each takes a card before its first operation there and returns it \
          when it has left the last one",
    keys: &[
        Key::required("name", Kind::Name, "Unique name"),
        Key::required("from", Kind::Reference("machine"), "Machines of the first operation in it"),
        Key::optional(
            "to",
            Kind::Reference("machine"),
            "Machines of the last operation in it; left out: those of the first, which is kanban",
        ),
        Key::optional(
            "parts",
            Kind::List(&Kind::Reference("part")),
            "Parts that take its cards; left out: all that are made on these machines",
        ),
        Key::required("cards", Kind::Count { min: 1, max: 1_000_000 }, "Jobs, or whole orders, that may be in it"),
        Key::optional(
            "rule",
            Kind::List(&DISPATCH_RULE),
            "Rule, or up to three, by which those that wait for a card get it; left out: the shop's",
        ),
    ],
};

pub(super) static RELEASE: Form = Form {
    title: "[release]",
    doc: "When jobs that have come are let into the shop",
    keys: &[
        Key::required("rule", Kind::Choice(ReleaseWord::WORDS), "Rule"),
        Key::required("lead", TIME, "Time from the release of a job to when it is due").when("rule", &["at_date"]),
        Key::required(
            "norm",
            LONG_DURATION,
            "Greatest corrected aggregate load of a station, for each of its machines",
        )
        .when("rule", &["workload"]),
        Key::required("every", LONG_DURATION, "Time between decisions, the first at time zero")
            .when("rule", &["workload"]),
        Key::default(
            "sequence",
            Kind::List(&DISPATCH_RULE),
            DispatchRule::EarliestDueDate.word(),
            "Rule, or up to three, in whose order the jobs outside are looked at",
        )
        .when("rule", &["workload"]),
    ],
};

pub(super) static DUE: Form = Form {
    title: "due",
    doc: "When jobs of a source are due",
    keys: &[
        Key::required("rule", Kind::Choice(DueWord::WORDS), "Rule"),
        Key::required("k", Kind::positive("1", "1", 1e4, "4"), "Multiple of the total work of the job")
            .when("rule", &["TWK"]),
        Key::required("slack", TIME, "Time beyond the total work of the job").when("rule", &["slack"]),
        Key::required("allowance", RANDOM_TIME, "Time from arrival to due date, drawn for each job")
            .when("rule", &["random"]),
        Key::optional(
            "allowance",
            Kind::positive("s", "h", super::DECADE, "8 h"),
            "Time from arrival to due date, the same for all; left out: the part's flow_allowance",
        )
        .when("rule", &["constant"]),
    ],
};
