//! More queues, lines and shops with exact answers: those of longer runs stand beside them.

use std::collections::BTreeMap;
use std::sync::Arc;
use toolroom_process::Claim;
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_scenario_file::parse;
use toolroom_shop::runlog::{EdgeRow, EventRow, JobRow, LogEvent, MachineState, OperationRow, PassRow, StateRow};
use toolroom_shop::{Closing, Recorder, Shop, ShopError};

/// What is measured of a run.
#[derive(Clone, Copy, Debug)]
enum Measure {
    /// Mean time in the shop, of one part or of all, min.
    Stay(Option<u32>),
    /// Mean time from the first start of a part to its end, min.
    FromStart(u32),
    /// Jobs that leave, of one part or of all, 1/min.
    Rate(Option<u32>),
    /// Share of time of a machine in a state.
    Share(u32, MachineState),
    /// Share of time in which machines are not down.
    Up(u32),
    /// Mean time from failures to the beginning of their repair, min.
    CrewWait,
    /// Mean number of jobs that begin together.
    Batch,
    /// Mean time from the card to the end, min.
    WithCard,
    /// Share of time in which vehicles drive, of as many.
    Driving,
    /// Mean stay of a part without its work, min.
    Wait(u32, f64),
    /// End of the last job, min.
    Makespan,
    /// Sum of the times that jobs stay, min.
    Flow,
}

/// A figure of a shop that is known.
struct Case {
    claim: &'static str,
    source: &'static str,
    text: &'static str,
    changes: &'static [&'static str],
    /// Simulated time, h; 0: that of the scenario.
    hours: u32,
    measure: Measure,
    known: f64,
    tolerance: f64,
}

const QUEUE: &str = include_str!("../../../../scenarios/shop/queue.toml");
const LINE: &str = include_str!("../../../../scenarios/shop/line.toml");
const URGENT: &str = include_str!("../../../../scenarios/shop/urgent.toml");
const REWORK: &str = include_str!("../../../../scenarios/shop/rework.toml");
const CARDS: &str = include_str!("../../../../scenarios/shop/cards.toml");
const FT06: &str = include_str!("../../../../scenarios/shop/ft06.toml");
const FT10: &str = include_str!("../../../../scenarios/shop/ft10.toml");
const FT20: &str = include_str!("../../../../scenarios/shop/ft20.toml");

/// A server that breaks down while it works.
const BREAKING: &str = r#"
schema = 1
[shop]
name = "breaking"
horizon = "1 h"
[[machine]]
name = "M"
process = "plain"
[[failure]]
machines = "M"
time_between = { distribution = "exponential", mean = "20 min" }
time_to_repair = { distribution = "exponential", mean = "2 min" }
[[part]]
name = "job"
operation = [{ name = "do", machines = "M", work = { distribution = "exponential", mean = "1 min" } }]
[[arrivals]]
part = "job"
pattern = "poisson"
rate = "36 1/h"
"#;

/// A closed line of three stations.
const CLOSED: &str = r#"
schema = 1
[shop]
name = "closed"
horizon = "1 h"
[[machine]]
name = "A"
process = "plain"
[[machine]]
name = "B"
process = "plain"
[[machine]]
name = "C"
process = "plain"
[[part]]
name = "job"
operation = [
    { name = "1", machines = "A", work = { distribution = "exponential", mean = "1 min" } },
    { name = "2", machines = "B", work = { distribution = "exponential", mean = "0.8 min" } },
    { name = "3", machines = "C", work = { distribution = "exponential", mean = "0.5 min" } },
]
[[arrivals]]
part = "job"
pattern = "constant_work"
jobs = 3
"#;

/// Five stations in a row with work before them that never ends; parts leave after any of them.
const LONG_LINE: &str = r#"
schema = 1
[shop]
name = "long line"
horizon = "1 h"
[[machine]]
name = "A"
process = "plain"
[[machine]]
name = "B"
process = "plain"
input_buffer = 0
[[machine]]
name = "C"
process = "plain"
input_buffer = 0
[[machine]]
name = "D"
process = "plain"
input_buffer = 0
[[machine]]
name = "E"
process = "plain"
input_buffer = 0
[[part]]
name = "job"
operation = [
    { name = "1", machines = "A", work = { distribution = "exponential", mean = "1 min" } },
    { name = "2", machines = "B", work = { distribution = "exponential", mean = "1 min" } },
    { name = "3", machines = "C", work = { distribution = "exponential", mean = "1 min" } },
    { name = "4", machines = "D", work = { distribution = "exponential", mean = "1 min" } },
    { name = "5", machines = "E", work = { distribution = "exponential", mean = "1 min" } },
]
[[arrivals]]
part = "job"
pattern = "constant_work"
jobs = 40
"#;

/// Six machines, all of which every job visits in an order of its own.
const RANDOM_SHOP: &str = r#"
schema = 1
[shop]
name = "random shop"
horizon = "1 h"
warm_up = "100 h"
[[machine]]
name = "M"
count = 6
process = "plain"
[[part]]
name = "job"
routing = "random"
operation = [
    { name = "1", machines = "M1", work = { distribution = "exponential", mean = "1 min" } },
    { name = "2", machines = "M2", work = { distribution = "exponential", mean = "1 min" } },
    { name = "3", machines = "M3", work = { distribution = "exponential", mean = "1 min" } },
    { name = "4", machines = "M4", work = { distribution = "exponential", mean = "1 min" } },
    { name = "5", machines = "M5", work = { distribution = "exponential", mean = "1 min" } },
    { name = "6", machines = "M6", work = { distribution = "exponential", mean = "1 min" } },
]
[[arrivals]]
part = "job"
pattern = "poisson"
rate = "51 1/h"
"#;

/// Two loops of cards that share a station.
const LOOPS: &str = r#"
schema = 1
[shop]
name = "loops"
horizon = "1 h"
[[machine]]
name = "A"
process = "plain"
[[machine]]
name = "S"
process = "plain"
[[machine]]
name = "B"
process = "plain"
[[part]]
name = "X"
operation = [
    { name = "1", machines = "A", work = { distribution = "exponential", mean = "10 min" } },
    { name = "2", machines = "S", work = { distribution = "exponential", mean = "6 min" } },
]
[[part]]
name = "Y"
operation = [
    { name = "1", machines = "S", work = { distribution = "exponential", mean = "6 min" } },
    { name = "2", machines = "B", work = { distribution = "exponential", mean = "15 min" } },
]
[[arrivals]]
part = "X"
pattern = "constant_work"
jobs = 5
[[arrivals]]
part = "Y"
pattern = "constant_work"
jobs = 7
[[loop]]
name = "x"
from = "A"
to = "S"
parts = "X"
cards = 3
[[loop]]
name = "y"
from = "S"
to = "B"
parts = "Y"
cards = 4
"#;

/// Two families, of which the one goes on for which the machine stands ready.
const FAMILIES: &str = r#"
schema = 1
[shop]
name = "families"
horizon = "1 h"
[dispatch]
rule = ["least_setup", "fifo"]
[[machine]]
name = "M"
process = "plain"
[[part]]
name = "a"
operation = [{ name = "do", machines = "M", work = { distribution = "exponential", mean = "8.333333333333334 min" }, setup_time = { distribution = "exponential", mean = "30 min" } }]
[[part]]
name = "b"
operation = [{ name = "do", machines = "M", work = { distribution = "exponential", mean = "10 min" }, setup_time = { distribution = "exponential", mean = "30 min" } }]
[[arrivals]]
part = "a"
pattern = "poisson"
rate = "3 1/h"
[[arrivals]]
part = "b"
pattern = "poisson"
rate = "0.6 1/h"
"#;

const JASIMA: &str = "jasima, testInstances/js06x06.txt (FT06) under the same rule";
const JASIMA_10: &str = "jasima, testInstances, FT10 under the same rule";
const JASIMA_20: &str = "jasima, testInstances, FT20 under the same rule";
const CHAIN: &str = "stationary distribution of its Markov chain";
const CLASSES: [&str; 4] = [
    "part.urgent.operation.do.work.mean=\"1 min\"",
    "part.usual.operation.do.work.mean=\"1 min\"",
    "arrivals.1.rate=\"18 1/h\"",
    "arrivals.2.rate=\"30 1/h\"",
];
const TIMED: [&str; 3] = [
    "machine.server.batch={ max = 6, min = 6, time_out = \"40 min\" }",
    "part.job.operation.serve.work=\"0 min\"",
    "arrivals.1.rate=\"6 1/h\"",
];
const FAST: [&str; 3] =
    ["failure.1.time_between.mean=\"10 min\"", "failure.1.time_to_repair.mean=\"2 min\"", "machine.M.count=10"];

/// Tolerances are relative and were set before the runs at some four standard errors: of queues by the asymptotic variance of
/// their stays, of lines by independent models of as many parts; where neither was to be had they are estimates (assumption).
#[rustfmt::skip]
const CASES: &[Case] = &[
    Case { claim: "mean stay in M/E2/1 at 80 % load, min", source: "Pollaczek and Khinchine: Kleinrock I, eq. 5.64", text: QUEUE, changes: &["part.job.operation.serve.work={ distribution = \"erlang\", mean = \"1 min\", k = 2 }"], hours: 16_667, measure: Measure::Stay(None), known: 4.0, tolerance: 0.05 },
    Case { claim: "mean stay in M/M/3 at 90 % load, min", source: "Erlang C: Kleinrock I, eq. 3.40", text: QUEUE, changes: &["machine.server.count=3", "arrivals.1.rate=\"162 1/h\""], hours: 16_667, measure: Measure::Stay(None), known: 3.723_537, tolerance: 0.07 },
    Case { claim: "mean stay in M/M/5 at 90 % load, min", source: "the same", text: QUEUE, changes: &["machine.server.count=5", "arrivals.1.rate=\"270 1/h\""], hours: 10_000, measure: Measure::Stay(None), known: 2.524_986, tolerance: 0.07 },
    Case { claim: "mean stay in M/M/1 at 85 % load, shortest time first, min", source: "Phipps, Operations Research 4 (1956) 76", text: QUEUE, changes: &["arrivals.1.rate=\"51 1/h\"", "dispatch.rule=\"spt\""], hours: 16_667, measure: Measure::Stay(None), known: 3.363_77, tolerance: 0.04 },
    Case { claim: "mean stay in M/M/1 at 90 % load, shortest time first, min", source: "the same", text: QUEUE, changes: &["arrivals.1.rate=\"54 1/h\"", "dispatch.rule=\"spt\""], hours: 16_667, measure: Measure::Stay(None), known: 4.196_91, tolerance: 0.07 },
    Case { claim: "mean stay of the first of two classes of 0.3 and 0.5 a minute, nobody is interrupted, min", source: "Cobham, Operations Research 2 (1954) 70", text: URGENT, changes: &CLASSES, hours: 16_667, measure: Measure::Stay(Some(0)), known: 2.142_86, tolerance: 0.02 },
    Case { claim: "mean stay of the second class, min", source: "the same", text: URGENT, changes: &CLASSES, hours: 16_667, measure: Measure::Stay(Some(1)), known: 6.714_29, tolerance: 0.08 },
    Case { claim: "mean stay of the first class, which interrupts the other, min", source: "Jaiswal, Priority Queues (1968)", text: URGENT, changes: &[CLASSES[0], CLASSES[1], CLASSES[2], CLASSES[3], "dispatch.preempt=\"resume\""], hours: 16_667, measure: Measure::Stay(Some(0)), known: 1.428_57, tolerance: 0.02 },
    Case { claim: "mean stay of the second class, which is resumed, min", source: "the same", text: URGENT, changes: &[CLASSES[0], CLASSES[1], CLASSES[2], CLASSES[3], "dispatch.preempt=\"resume\""], hours: 16_667, measure: Measure::Stay(Some(1)), known: 7.142_86, tolerance: 0.08 },
    Case { claim: "time from start to end of constant work of 20 min that is repeated when it was interrupted, min", source: "Gaver, Journal of the Royal Statistical Society B 24 (1962) 73", text: URGENT, changes: &["part.urgent.operation.do.work.mean=\"5 min\"", "part.usual.operation.do.work=\"20 min\"", "arrivals.1.rate=\"1.8 1/h\"", "arrivals.2.rate=\"0.6 1/h\"", "dispatch.preempt=\"repeat\""], hours: 41_667, measure: Measure::FromStart(1), known: 32.239_953, tolerance: 0.02 },
    Case { claim: "mean stay at a server that breaks down in work, min", source: "completion times: Gaver 1962, Pollaczek and Khinchine", text: BREAKING, changes: &[], hours: 16_667, measure: Measure::Stay(None), known: 3.588_24, tolerance: 0.05 },
    Case { claim: "availability of ten machines with one repairer, failures after 300 min, repairs of 30", source: "birth and death of failures: Feller I (1968), XVII.7", text: super::CREW, changes: &["machine.M.count=10", "failure.1.time_between.mean=\"300 min\"", "failure.1.time_to_repair.mean=\"30 min\""], hours: 20_000, measure: Measure::Up(10), known: 0.785_42, tolerance: 0.02 },
    Case { claim: "the same of five machines, 10 and 2 min", source: "the same", text: super::CREW, changes: &[FAST[0], FAST[1], "machine.M.count=5"], hours: 4000, measure: Measure::Up(5), known: 0.715_13, tolerance: 0.01 },
    Case { claim: "the same of ten machines with two repairers", source: "the same", text: super::CREW, changes: &[FAST[0], FAST[1], FAST[2], "crew.fitters.count=2"], hours: 4000, measure: Measure::Up(10), known: 0.759_63, tolerance: 0.01 },
    Case { claim: "wait of a breakdown for the one crew of six machines, min", source: "the same", text: super::CREW, changes: &[], hours: 60_000, measure: Measure::CrewWait, known: 49.924_0, tolerance: 0.05 },
    Case { claim: "the same with two crews, min", source: "the same", text: super::CREW, changes: &["crew.fitters.count=2"], hours: 60_000, measure: Measure::CrewWait, known: 3.749_022, tolerance: 0.07 },
    Case { claim: "size of batches of 6 or what came within 40 min after the first", source: "Poisson process: E[min(6, 1 + N)]", text: QUEUE, changes: &TIMED, hours: 12_000, measure: Measure::Batch, known: 4.589_696, tolerance: 0.01 },
    Case { claim: "their wait before they begin, min", source: "the same", text: QUEUE, changes: &TIMED, hours: 12_000, measure: Measure::Stay(None), known: 20.058_307, tolerance: 0.02 },
    Case { claim: "time with a card of a line of four stations and six cards, min", source: "mean value analysis: Reiser and Lavenberg, Journal of the ACM 27 (1980) 313", text: CARDS, changes: &[], hours: 41_667, measure: Measure::WithCard, known: 85.729_247, tolerance: 0.007 },
    Case { claim: "rate of the first of two loops that share a station, 1/min", source: "closed network: Baskett et al., Journal of the ACM 22 (1975) 248", text: LOOPS, changes: &[], hours: 20_000, measure: Measure::Rate(Some(0)), known: 0.077_538_5, tolerance: 0.01 },
    Case { claim: "rate of the second loop, 1/min", source: "the same", text: LOOPS, changes: &[], hours: 20_000, measure: Measure::Rate(Some(1)), known: 0.061_945_9, tolerance: 0.01 },
    Case { claim: "wait of the first of two families with setups between them, min", source: CHAIN, text: FAMILIES, changes: &[], hours: 80_000, measure: Measure::Wait(0, 25.0 / 3.0), known: 44.879_80, tolerance: 0.03 },
    Case { claim: "wait of the second family, min", source: CHAIN, text: FAMILIES, changes: &[], hours: 80_000, measure: Measure::Wait(1, 10.0), known: 73.353_91, tolerance: 0.03 },
    Case { claim: "share of setups", source: CHAIN, text: FAMILIES, changes: &[], hours: 80_000, measure: Measure::Share(0, MachineState::Setup), known: 0.302_553, tolerance: 0.01 },
    Case { claim: "load of the first of three stations with rework", source: "traffic equations: Jackson, Operations Research 5 (1957) 518", text: REWORK, changes: &[], hours: 41_667, measure: Measure::Share(0, MachineState::Working), known: 0.7125, tolerance: 0.02 },
    Case { claim: "load of the second station", source: "the same", text: REWORK, changes: &[], hours: 41_667, measure: Measure::Share(1, MachineState::Working), known: 0.625, tolerance: 0.02 },
    Case { claim: "load of the third station", source: "the same", text: REWORK, changes: &[], hours: 41_667, measure: Measure::Share(2, MachineState::Working), known: 0.25, tolerance: 0.02 },
    Case { claim: "load of a vehicle that drives back empty", source: "16 min a job", text: super::VEHICLE, changes: &[], hours: 41_667, measure: Measure::Driving, known: 0.64, tolerance: 0.014 },
    Case { claim: "mean stay in six machines of which jobs visit all in any order, 85 % load, min", source: "Jackson, Management Science 10 (1963) 131", text: RANDOM_SHOP, changes: &[], hours: 8333, measure: Measure::Stay(None), known: 40.0, tolerance: 0.035 },
    Case { claim: "rate of five stations without buffers, 1/min", source: "Hillier and Boling, Journal of Industrial Engineering 18 (1967) 651", text: LONG_LINE, changes: &[], hours: 6000, measure: Measure::Rate(None), known: 0.485_798, tolerance: 0.009 },
    Case { claim: "rate of four stations without buffers, 1/min", source: "the same", text: LONG_LINE, changes: &["part.job.operation.5.work=\"0 min\"", "machine.E.input_buffer=100000"], hours: 6000, measure: Measure::Rate(None), known: 0.514_775, tolerance: 0.009 },
    Case { claim: "rate of three stations with one place between, 1/min", source: "the same", text: LINE, changes: &["machine.B.input_buffer=1", "machine.C.input_buffer=1"], hours: 6000, measure: Measure::Rate(None), known: 0.670_466, tolerance: 0.009 },
    Case { claim: "rate of three stations with two places between, 1/min", source: "the same", text: LINE, changes: &["machine.B.input_buffer=2", "machine.C.input_buffer=2"], hours: 6000, measure: Measure::Rate(None), known: 0.734_017, tolerance: 0.009 },
    Case { claim: "rate of stations of 1, 1.2 and 0.9 a minute with 2 and 3 places between, 1/min", source: CHAIN, text: LINE, changes: &["part.part.operation.second.work.mean=\"0.833333333333333 min\"", "part.part.operation.third.work.mean=\"1.111111111111111 min\"", "machine.B.input_buffer=2", "machine.C.input_buffer=3"], hours: 6000, measure: Measure::Rate(None), known: 0.768_895, tolerance: 0.009 },
    Case { claim: "rate of two stations without buffer, 1/min", source: CHAIN, text: LINE, changes: &["part.part.operation.third.work=\"0 min\"", "machine.C.input_buffer=100000"], hours: 6000, measure: Measure::Rate(None), known: 2.0 / 3.0, tolerance: 0.009 },
    Case { claim: "rate of two stations with one place between, 1/min", source: CHAIN, text: LINE, changes: &["part.part.operation.third.work=\"0 min\"", "machine.C.input_buffer=100000", "machine.B.input_buffer=1"], hours: 6000, measure: Measure::Rate(None), known: 0.75, tolerance: 0.009 },
    Case { claim: "rate of two stations with five places between, 1/min", source: CHAIN, text: LINE, changes: &["part.part.operation.third.work=\"0 min\"", "machine.C.input_buffer=100000", "machine.B.input_buffer=5"], hours: 6000, measure: Measure::Rate(None), known: 0.875, tolerance: 0.009 },
    Case { claim: "rate of two stations with ten places between, 1/min", source: CHAIN, text: LINE, changes: &["part.part.operation.third.work=\"0 min\"", "machine.C.input_buffer=100000", "machine.B.input_buffer=10", "arrivals.1.jobs=40"], hours: 6000, measure: Measure::Rate(None), known: 0.923_077, tolerance: 0.009 },
    Case { claim: "rate of three stations of 1, 0.8 and 0.5 min with three jobs, 1/min", source: "mean value analysis: Reiser and Lavenberg 1980", text: CLOSED, changes: &[], hours: 6000, measure: Measure::Rate(None), known: 0.756_267, tolerance: 0.008 },
    Case { claim: "the same with ten jobs, 1/min", source: "the same", text: CLOSED, changes: &["arrivals.1.jobs=10"], hours: 6000, measure: Measure::Rate(None), known: 0.967_853, tolerance: 0.008 },
    Case { claim: "FT06, first come: makespan", source: JASIMA, text: FT06, changes: &["dispatch.rule=\"fifo\""], hours: 0, measure: Measure::Makespan, known: 65.0, tolerance: 1e-9 },
    Case { claim: "FT06, first come: sum of flow times", source: JASIMA, text: FT06, changes: &["dispatch.rule=\"fifo\""], hours: 0, measure: Measure::Flow, known: 329.0, tolerance: 1e-9 },
    Case { claim: "FT06, shortest time: makespan", source: JASIMA, text: FT06, changes: &["dispatch.rule=\"spt\""], hours: 0, measure: Measure::Makespan, known: 88.0, tolerance: 1e-9 },
    Case { claim: "FT06, shortest time: sum of flow times", source: JASIMA, text: FT06, changes: &["dispatch.rule=\"spt\""], hours: 0, measure: Measure::Flow, known: 316.0, tolerance: 1e-9 },
    Case { claim: "FT06, longest time: makespan", source: JASIMA, text: FT06, changes: &["dispatch.rule=\"lpt\""], hours: 0, measure: Measure::Makespan, known: 67.0, tolerance: 1e-9 },
    Case { claim: "FT06, longest time: sum of flow times", source: JASIMA, text: FT06, changes: &["dispatch.rule=\"lpt\""], hours: 0, measure: Measure::Flow, known: 347.0, tolerance: 1e-9 },
    Case { claim: "FT06, last come: makespan", source: JASIMA, text: FT06, changes: &["dispatch.rule=\"lifo\""], hours: 0, measure: Measure::Makespan, known: 68.0, tolerance: 1e-9 },
    Case { claim: "FT06, last come: sum of flow times", source: JASIMA, text: FT06, changes: &["dispatch.rule=\"lifo\""], hours: 0, measure: Measure::Flow, known: 325.0, tolerance: 1e-9 },
    Case { claim: "FT06, least slack: makespan", source: JASIMA, text: FT06, changes: &["dispatch.rule=\"slack\""], hours: 0, measure: Measure::Makespan, known: 61.0, tolerance: 1e-9 },
    Case { claim: "FT06, least slack: sum of flow times", source: JASIMA, text: FT06, changes: &["dispatch.rule=\"slack\""], hours: 0, measure: Measure::Flow, known: 335.0, tolerance: 1e-9 },
    Case { claim: "FT10, first come: makespan", source: JASIMA_10, text: FT10, changes: &["dispatch.rule=\"fifo\""], hours: 0, measure: Measure::Makespan, known: 1184.0, tolerance: 1e-9 },
    Case { claim: "FT10, first come: sum of flow times", source: JASIMA_10, text: FT10, changes: &["dispatch.rule=\"fifo\""], hours: 0, measure: Measure::Flow, known: 9782.0, tolerance: 1e-9 },
    Case { claim: "FT10, shortest time: makespan", source: JASIMA_10, text: FT10, changes: &["dispatch.rule=\"spt\""], hours: 0, measure: Measure::Makespan, known: 1074.0, tolerance: 1e-9 },
    Case { claim: "FT10, shortest time: sum of flow times", source: JASIMA_10, text: FT10, changes: &["dispatch.rule=\"spt\""], hours: 0, measure: Measure::Flow, known: 8343.0, tolerance: 1e-9 },
    Case { claim: "FT10, longest time: makespan", source: JASIMA_10, text: FT10, changes: &["dispatch.rule=\"lpt\""], hours: 0, measure: Measure::Makespan, known: 1295.0, tolerance: 1e-9 },
    Case { claim: "FT10, longest time: sum of flow times", source: JASIMA_10, text: FT10, changes: &["dispatch.rule=\"lpt\""], hours: 0, measure: Measure::Flow, known: 11_034.0, tolerance: 1e-9 },
    Case { claim: "FT10, last come: makespan", source: JASIMA_10, text: FT10, changes: &["dispatch.rule=\"lifo\""], hours: 0, measure: Measure::Makespan, known: 1393.0, tolerance: 1e-9 },
    Case { claim: "FT10, last come: sum of flow times", source: JASIMA_10, text: FT10, changes: &["dispatch.rule=\"lifo\""], hours: 0, measure: Measure::Flow, known: 9978.0, tolerance: 1e-9 },
    Case { claim: "FT10, least slack: makespan", source: JASIMA_10, text: FT10, changes: &["dispatch.rule=\"slack\""], hours: 0, measure: Measure::Makespan, known: 1108.0, tolerance: 1e-9 },
    Case { claim: "FT10, least slack: sum of flow times", source: JASIMA_10, text: FT10, changes: &["dispatch.rule=\"slack\""], hours: 0, measure: Measure::Flow, known: 10_105.0, tolerance: 1e-9 },
    Case { claim: "FT20, first come: makespan", source: JASIMA_20, text: FT20, changes: &["dispatch.rule=\"fifo\""], hours: 0, measure: Measure::Makespan, known: 1645.0, tolerance: 1e-9 },
    Case { claim: "FT20, first come: sum of flow times", source: JASIMA_20, text: FT20, changes: &["dispatch.rule=\"fifo\""], hours: 0, measure: Measure::Flow, known: 25_542.0, tolerance: 1e-9 },
    Case { claim: "FT20, shortest time: makespan", source: JASIMA_20, text: FT20, changes: &["dispatch.rule=\"spt\""], hours: 0, measure: Measure::Makespan, known: 1267.0, tolerance: 1e-9 },
    Case { claim: "FT20, shortest time: sum of flow times", source: JASIMA_20, text: FT20, changes: &["dispatch.rule=\"spt\""], hours: 0, measure: Measure::Flow, known: 15_705.0, tolerance: 1e-9 },
    Case { claim: "FT20, longest time: makespan", source: JASIMA_20, text: FT20, changes: &["dispatch.rule=\"lpt\""], hours: 0, measure: Measure::Makespan, known: 1631.0, tolerance: 1e-9 },
    Case { claim: "FT20, longest time: sum of flow times", source: JASIMA_20, text: FT20, changes: &["dispatch.rule=\"lpt\""], hours: 0, measure: Measure::Flow, known: 24_430.0, tolerance: 1e-9 },
    Case { claim: "FT20, last come: makespan", source: JASIMA_20, text: FT20, changes: &["dispatch.rule=\"lifo\""], hours: 0, measure: Measure::Makespan, known: 1365.0, tolerance: 1e-9 },
    Case { claim: "FT20, last come: sum of flow times", source: JASIMA_20, text: FT20, changes: &["dispatch.rule=\"lifo\""], hours: 0, measure: Measure::Flow, known: 16_314.0, tolerance: 1e-9 },
    Case { claim: "FT20, least slack: makespan", source: JASIMA_20, text: FT20, changes: &["dispatch.rule=\"slack\""], hours: 0, measure: Measure::Makespan, known: 1501.0, tolerance: 1e-9 },
    Case { claim: "FT20, least slack: sum of flow times", source: JASIMA_20, text: FT20, changes: &["dispatch.rule=\"slack\""], hours: 0, measure: Measure::Flow, known: 24_258.0, tolerance: 1e-9 },
];

/// Facts of a run as they come.
#[derive(Clone, Debug, Default)]
struct Watch {
    /// Since when they count, s.
    from: f64,
    /// By part: jobs that have left, their times in the shop and from their start, s.
    parts: Vec<[f64; 3]>,
    /// Times by machine and state, s.
    states: BTreeMap<(u32, MachineState), f64>,
    /// Jobs that began, and instants at which any did.
    begun: [f64; 2],
    last_start: f64,
    last_finish: f64,
    /// When machines failed, when jobs took a card or a vehicle set out for them, s.
    pending: BTreeMap<(LogEvent, u32), f64>,
    /// Number and sum, s, of waits for crews, times with a card, times of ways.
    crew: [f64; 2],
    carded: [f64; 2],
    driving: f64,
}

impl Recorder for Watch {
    fn pass(&mut self, _: PassRow) {}
    fn edge(&mut self, _: u32, _: EdgeRow) {}
    fn arrival(&mut self, _: u32, _: JobRow) {}
    fn operation(&mut self, _: OperationRow) {}
    fn close(&mut self, _: Closing) {}

    fn job(&mut self, number: u32, row: JobRow) {
        if row.finish.is_nan() {
            return;
        }
        self.last_finish = self.last_finish.max(row.finish);
        if let Some(time) = self.pending.remove(&(LogEvent::Card, number)).filter(|time| *time >= self.from) {
            self.carded = [self.carded[0] + 1.0, self.carded[1] + row.finish - time];
        }
        if row.arrival < self.from {
            return;
        }
        let part = row.part as usize;
        self.parts.resize(self.parts.len().max(part + 1), [0.0; 3]);
        let parts = &mut self.parts[part];
        *parts = [parts[0] + 1.0, parts[1] + row.finish - row.arrival, parts[2] + row.finish - row.start];
        self.begun[0] += 1.0;
        if row.start != self.last_start {
            self.begun[1] += 1.0;
            self.last_start = row.start;
        }
    }

    fn state(&mut self, row: StateRow) {
        let time = row.end - row.start.max(self.from);
        if time > 0.0 {
            *self.states.entry((row.machine, row.state)).or_default() += time;
        }
    }

    fn event(&mut self, row: EventRow) {
        let (machine, job) = (row.machine.unwrap_or(u32::MAX), row.job.unwrap_or(u32::MAX));
        // Any other event begins and ends nothing that is measured here.
        if row.event == LogEvent::Failure {
            self.pending.insert((LogEvent::Failure, machine), row.time);
        } else if matches!(row.event, LogEvent::Card | LogEvent::Move) {
            self.pending.insert((row.event, job), row.time);
        } else if row.event == LogEvent::RepairStart {
            if let Some(time) = self.pending.remove(&(LogEvent::Failure, machine)) {
                self.crew = [self.crew[0] + 1.0, self.crew[1] + row.time - time];
            }
        } else if row.event == LogEvent::Delivery
            && let Some(time) = self.pending.remove(&(LogEvent::Move, job))
        {
            self.driving += row.time - time;
        }
    }
}

impl Watch {
    /// A measure, `time` s being counted.
    fn value(&self, measure: Measure, time: f64) -> f64 {
        let sums = |part: Option<u32>| {
            let own =
                self.parts.iter().enumerate().filter(|(index, _)| part.is_none_or(|part| part as usize == *index));
            own.fold([0.0; 3], |sum, (_, own)| [sum[0] + own[0], sum[1] + own[1], sum[2] + own[2]])
        };
        let mean = |[count, sum]: [f64; 2]| sum / count / 60.0;
        match measure {
            Measure::Stay(part) => sums(part)[1] / sums(part)[0] / 60.0,
            Measure::Wait(part, work) => sums(Some(part))[1] / sums(Some(part))[0] / 60.0 - work,
            Measure::FromStart(part) => sums(Some(part))[2] / sums(Some(part))[0] / 60.0,
            Measure::Rate(part) => sums(part)[0] / (time / 60.0),
            Measure::Share(machine, state) => self.states.get(&(machine, state)).unwrap_or(&0.0) / time,
            Measure::Up(machines) => {
                let down = self.states.iter().filter(|((_, state), _)| *state == MachineState::Down);
                1.0 - down.map(|(_, time)| time).sum::<f64>() / (f64::from(machines) * time)
            }
            Measure::CrewWait => mean(self.crew),
            Measure::WithCard => mean(self.carded),
            Measure::Batch => self.begun[0] / self.begun[1],
            Measure::Driving => self.driving / time,
            Measure::Makespan => self.last_finish / 60.0,
            Measure::Flow => sums(None)[1] / 60.0,
        }
    }
}

/// Figures of these shops against their exact values, simulated now.
///
/// # Errors
/// [`ShopError`] where a shop stops.
pub(super) fn claims() -> Result<Vec<Claim>, ShopError> {
    std::thread::scope(|scope| {
        let running: Vec<_> = CASES.iter().map(|case| scope.spawn(|| case.checked())).collect();
        running.into_iter().map(|case| case.join().expect("a claim ends")).collect()
    })
}

impl Case {
    fn checked(&self) -> Result<Claim, ShopError> {
        let mut changes: Vec<String> = self.changes.iter().map(|&change| change.to_owned()).collect();
        if self.hours > 0 {
            changes.push(format!("shop.horizon=\"{} h\"", self.hours));
        }
        let file = parse("claim.toml", self.text, &changes).unwrap_or_else(|error| panic!("{}: {error}", self.claim));
        let policy = Arc::new(ResolvedPolicy::from_scenario(&file.scenario, 0)?);
        let watch = Watch { from: file.scenario.warm_up, last_start: f64::NAN, ..Watch::default() };
        let watch = Shop::with_recorder(&file.scenario, policy, 0, watch)?.run()?;
        let computed = watch.value(self.measure, file.scenario.horizon - file.scenario.warm_up);
        let (claim, source) = (self.claim.to_owned(), self.source.to_owned());
        Ok(Claim { claim, source, published: self.known, computed, tolerance: self.tolerance })
    }
}
