//! Queues, lines, batches, priorities, rework and assembly with exact answers, through the scenario files that are shipped.

mod further;

use std::sync::Arc;
use toolroom_process::Claim;
use toolroom_scenario::policies::ResolvedPolicy;
use toolroom_scenario_file::parse;
use toolroom_shop::runlog::{EdgeRow, EventRow, JobRow, MachineState, OperationRow, PassRow, StateRow};
use toolroom_shop::{Closing, Recorder, Shop, ShopError};

/// One server, random arrivals.
const QUEUE: &str = include_str!("../../../scenarios/shop/queue.toml");
/// Simulated time of a claim: two million jobs.
const LENGTH: &str = "shop.horizon=\"41667 h\"";

/// Three stations in a row.
const LINE: &str = include_str!("../../../scenarios/shop/line.toml");
/// Two classes of jobs.
const URGENT: &str = include_str!("../../../scenarios/shop/urgent.toml");
/// Three stations and an inspection that sends parts back.
const REWORK: &str = include_str!("../../../scenarios/shop/rework.toml");
/// Two feeders and a bench.
const ASSEMBLY: &str = include_str!("../../../scenarios/shop/assembly.toml");
/// Four stations and six cards.
const CARDS: &str = include_str!("../../../scenarios/shop/cards.toml");
/// A machine, its grinder, and the edges between them.
const CRIB: &str = include_str!("../../../scenarios/shop/crib.toml");
/// Six machines that break down, and a crew; they have no work.
const CREW: &str = r#"
schema = 1
[shop]
name = "crew"
horizon = "1 h"
[[machine]]
name = "M"
count = 6
process = "plain"
[[crew]]
name = "fitters"
[[failure]]
machines = "M"
clock = "calendar"
crew = "fitters"
time_between = { distribution = "exponential", mean = "480 min" }
time_to_repair = { distribution = "exponential", mean = "60 min" }
[[part]]
name = "job"
operation = [{ name = "do", machines = "M", work = "1 min" }]
[[arrivals]]
part = "job"
pattern = "schedule"
lot = [{ time = "0 min" }]
"#;
/// Moves one way by a vehicle, 8 min in each direction.
const VEHICLE: &str = r#"
schema = 1
[shop]
name = "vehicle"
horizon = "1 h"
[[machine]]
name = "P"
process = "plain"
[[machine]]
name = "Q"
process = "plain"
[[transport]]
name = "AGV"
locations = ["P", "Q"]
times = [["0 min", "8 min"], ["8 min", "0 min"]]
[[part]]
name = "job"
operation = [
    { name = "first", machines = "P", work = "0 min" },
    { name = "second", machines = "Q", work = "0 min" },
]
[[arrivals]]
part = "job"
pattern = "poisson"
rate = "2.4 1/h"
"#;
/// Work of a batch, 18 jobs an hour.
const BATCH: [&str; 3] = [
    "part.job.operation.serve.work_per=\"batch\"",
    "part.job.operation.serve.work={ distribution = \"exponential\", mean = \"10 min\" }",
    "arrivals.1.rate=\"18 1/h\"",
];
/// Rates and buffers of a line whose stations differ.
const UNEQUAL: [&str; 4] = [
    "part.part.operation.second.work.mean=\"1.25 min\"",
    "part.part.operation.third.work.mean=\"0.909090909090909 min\"",
    "machine.B.input_buffer=1",
    "machine.C.input_buffer=2",
];

/// A figure of a shop that is known.
struct Case {
    claim: &'static str,
    source: &'static str,
    changes: &'static [&'static str],
    figure: Figure,
    tolerance: f64,
}

/// What is known.
enum Figure {
    /// Mean time in the shop of the queue, min.
    Stay(f64),
    /// Parts of the line a minute.
    Rate(f64),
    /// Mean time in the shop of a part of the scenario with two classes, min.
    StayOf(u32, f64),
    /// Mean time in the shop with rework, min.
    Reworked(f64),
    /// Assemblies a minute.
    Assembled(f64),
    /// Jobs of the line with cards a minute.
    Carded(f64),
    /// Share of a machine of the crib in plain work, 1.
    Edged(u32, f64),
    /// Share of the machines with a crew that is not down, 1.
    Repaired(f64),
    /// Time from the call of a vehicle to the delivery, min.
    Delivered(f64),
}

/// The shipped queue at 80 % load and queues that differ from it by a word. The tolerances are some four
/// standard errors of the mean of two million correlated stays, and of the number of a million parts and more.
const CASES: &[Case] = &[
    Case {
        claim: "mean stay in M/M/1 at 80 % load, min",
        source: "Kleinrock, Queueing Systems I (1975), eq. 3.26",
        changes: &[],
        figure: Figure::Stay(5.0),
        tolerance: 0.025,
    },
    Case {
        claim: "mean stay in M/D/1 at 80 % load, min",
        source: "Pollaczek and Khinchine: Kleinrock I, eq. 5.64",
        changes: &["part.job.operation.serve.work=\"1 min\""],
        figure: Figure::Stay(3.0),
        tolerance: 0.015,
    },
    Case {
        claim: "mean stay in M/E4/1 at 80 % load, min",
        source: "Pollaczek and Khinchine: Kleinrock I, eq. 5.64",
        changes: &["part.job.operation.serve.work={ distribution = \"erlang\", mean = \"1 min\", k = 4 }"],
        figure: Figure::Stay(3.5),
        tolerance: 0.015,
    },
    Case {
        claim: "mean stay in M/G/1 at 80 % load, gamma times of cv 2, min",
        source: "Pollaczek and Khinchine: Kleinrock I, eq. 5.64",
        changes: &["part.job.operation.serve.work={ distribution = \"gamma\", mean = \"1 min\", cv = 2.0 }"],
        figure: Figure::Stay(11.0),
        tolerance: 0.05,
    },
    Case {
        claim: "mean stay in M/M/2 at 80 % load, min",
        source: "Erlang C: Kleinrock I, eq. 3.40",
        changes: &["machine.server.count=2", "arrivals.1.rate=\"96 1/h\""],
        figure: Figure::Stay(2.777_778),
        tolerance: 0.025,
    },
    Case {
        claim: "mean stay in M/M/4 at 80 % load, min",
        source: "Erlang C: Kleinrock I, eq. 3.40",
        changes: &["machine.server.count=4", "arrivals.1.rate=\"192 1/h\""],
        figure: Figure::Stay(1.745_541),
        tolerance: 0.025,
    },
    Case {
        claim: "mean stay in M/M/1 at 80 % load, shortest time first, min",
        source: "Phipps, Operations Research 4 (1956) 76",
        changes: &["dispatch.rule=\"spt\""],
        figure: Figure::Stay(2.882_219),
        tolerance: 0.02,
    },
    Case {
        claim: "mean stay in M/E2/1 at 80 % load, shortest time first, min",
        source: "Phipps, Operations Research 4 (1956) 76",
        changes: &[
            "part.job.operation.serve.work={ distribution = \"erlang\", mean = \"1 min\", k = 2 }",
            "dispatch.rule=\"spt\"",
        ],
        figure: Figure::Stay(2.699_907),
        tolerance: 0.02,
    },
    Case {
        claim: "mean stay of jobs of 5 min (70 %) and 30 min, 3.6 an hour, shortest time first, min",
        source: "Phipps, Operations Research 4 (1956) 76",
        changes: &[
            "part.job.operation.serve.work={ distribution = \"empirical\", values = [\"5 min\", \"30 min\"], weights = [7, 3] }",
            "arrivals.1.rate=\"3.6 1/h\"",
            "dispatch.rule=\"spt\"",
        ],
        figure: Figure::Stay(33.243_671),
        tolerance: 0.03,
    },
    Case {
        claim: "rate of three stations without buffers, blocking after service, 1/min",
        source: "Hillier and Boling, Journal of Industrial Engineering 18 (1967) 651",
        changes: &[],
        figure: Figure::Rate(0.564_103),
        tolerance: 0.002,
    },
    Case {
        claim: "rate of three stations without buffers, blocking before service, 1/min",
        source: "stationary distribution of its Markov chain: 2/5",
        changes: &["dispatch.blocking=\"before_service\""],
        figure: Figure::Rate(0.4),
        tolerance: 0.002,
    },
    Case {
        claim: "rate of stations of 1, 0.8 and 1.1 a minute with 1 and 2 places between, after service, 1/min",
        source: "stationary distribution of its Markov chain",
        changes: &UNEQUAL,
        figure: Figure::Rate(0.640_381),
        tolerance: 0.002,
    },
    Case {
        claim: "the same, blocking before service, 1/min",
        source: "stationary distribution of its Markov chain",
        changes: &[UNEQUAL[0], UNEQUAL[1], UNEQUAL[2], UNEQUAL[3], "dispatch.blocking=\"before_service\""],
        figure: Figure::Rate(0.567_612),
        tolerance: 0.002,
    },
    Case {
        claim: "mean stay where up to 4 are worked on together, begun with what is there, min",
        source: "stationary distribution of its Markov chain: Neuts, Annals of Mathematical Statistics 38 (1967) 759",
        changes: &[BATCH[0], BATCH[1], BATCH[2], "machine.server.batch={ max = 4, min = 1 }"],
        figure: Figure::Stay(35.524_987),
        tolerance: 0.9,
    },
    Case {
        claim: "the same, begun with 4 only, min",
        source: "the same",
        changes: &[BATCH[0], BATCH[1], BATCH[2], "machine.server.batch={ max = 4, min = 4 }"],
        figure: Figure::Stay(31.476_391),
        tolerance: 0.9,
    },
    Case {
        claim: "the same with a constant time, min",
        source: "Bailey, Journal of the Royal Statistical Society B 16 (1954) 80",
        changes: &[
            BATCH[0],
            "part.job.operation.serve.work=\"10 min\"",
            BATCH[2],
            "machine.server.batch={ max = 4, min = 4 }",
        ],
        figure: Figure::Stay(17.669_612),
        tolerance: 0.15,
    },
    Case {
        claim: "mean stay of urgent jobs that interrupt nobody, min",
        source: "Cobham, Operations Research 2 (1954) 70",
        changes: &[],
        figure: Figure::StayOf(0, 14.473_684),
        tolerance: 0.4,
    },
    Case {
        claim: "mean stay of the other jobs, min",
        source: "the same",
        changes: &[],
        figure: Figure::StayOf(1, 42.591_093),
        tolerance: 2.5,
    },
    Case {
        claim: "mean stay of urgent jobs that interrupt others, min",
        source: "Jaiswal, Priority Queues (1968)",
        changes: &["dispatch.preempt=\"resume\""],
        figure: Figure::StayOf(0, 7.894_737),
        tolerance: 0.2,
    },
    Case {
        claim: "mean stay of the other jobs, which are resumed, min",
        source: "the same",
        changes: &["dispatch.preempt=\"resume\""],
        figure: Figure::StayOf(1, 45.748_988),
        tolerance: 2.5,
    },
    Case {
        claim: "mean stay in three stations with rework, min",
        source: "Jackson, Operations Research 5 (1957) 518",
        changes: &[],
        figure: Figure::Reworked(89.565_217),
        tolerance: 3.0,
    },
    Case {
        claim: "rate of two feeders and their assembly, 1/min",
        source: "stationary distribution of its Markov chain",
        changes: &[],
        figure: Figure::Assembled(0.771_654),
        tolerance: 0.002,
    },
    Case {
        claim: "rate of four stations with six cards, 1/min",
        source: "mean value analysis: Reiser and Lavenberg, Journal of the ACM 27 (1980) 313",
        changes: &[],
        figure: Figure::Carded(0.069_987_8),
        tolerance: 0.007, // four standard errors of 0.17 %, by batches of an independent model of as many jobs
    },
    Case {
        claim: "the same with twelve cards, 1/min",
        source: "the same",
        changes: &["loop.line.cards=12"],
        figure: Figure::Carded(0.079_686),
        tolerance: 0.007, // four standard errors of 0.17 %, by batches of an independent model of as many jobs
    },
    Case {
        claim: "share in work of a machine with three edges that are ground anew",
        source: "closed line of two exponential servers: 148/175 (Gordon and Newell, Operations Research 15 (1967) 254)",
        changes: &[],
        figure: Figure::Edged(0, 148.0 / 175.0),
        tolerance: 0.014, // four standard errors of 0.0035, by twelve runs of an independent model as long
    },
    Case {
        claim: "share in work of the grinder of its edges",
        source: "the same: 111/175",
        changes: &[],
        figure: Figure::Edged(1, 111.0 / 175.0),
        tolerance: 0.018, // the same of 0.0045
    },
    Case {
        claim: "availability of six machines with one crew",
        source: "birth and death of failures: Feller, An Introduction to Probability Theory I (1968), XVII.7",
        changes: &[],
        figure: Figure::Repaired(0.813_664),
        tolerance: 0.0126, // four standard errors of 0.0031, by twelve runs of an independent model as long
    },
    Case {
        claim: "the same with two crews",
        source: "the same",
        changes: &["crew.fitters.count=2"],
        figure: Figure::Repaired(0.882_760),
        tolerance: 0.0052, // the same of 0.0013
    },
    Case {
        claim: "time from order to delivery by a vehicle that drives back empty, min",
        source: "Pollaczek and Khinchine with 16 min of service: 8 back to the job and 8 with it",
        changes: &[],
        figure: Figure::Delivered(30.222_222),
        tolerance: 0.97, // four standard errors of 0.24, by twelve runs of an independent model as long
    },
];

/// Time that jobs stay in the shop.
#[derive(Clone, Debug, Default)]
struct Stays {
    /// Since when they count, s.
    from: f64,
    /// Part that counts; `None`: all.
    part: Option<u32>,
    total: f64,
    count: f64,
    /// Time of every machine in plain work and broken down, s.
    working: Vec<f64>,
    down: f64,
}

impl Recorder for Stays {
    fn job(&mut self, _: u32, row: JobRow) {
        if row.arrival >= self.from && self.part.is_none_or(|part| part == row.part) && row.finish.is_finite() {
            self.total += row.finish - row.arrival;
            self.count += 1.0;
        }
    }
    fn arrival(&mut self, _: u32, _: JobRow) {}
    fn pass(&mut self, _: PassRow) {}
    fn edge(&mut self, _: u32, _: EdgeRow) {}
    fn operation(&mut self, _: OperationRow) {}
    fn state(&mut self, row: StateRow) {
        let time = row.end - row.start.max(self.from);
        if time <= 0.0 {
            return;
        }
        if row.state == MachineState::Working {
            let machine = row.machine as usize;
            self.working.resize(self.working.len().max(machine + 1), 0.0);
            self.working[machine] += time;
        }
        self.down += if row.state == MachineState::Down { time } else { 0.0 };
    }
    fn event(&mut self, _: EventRow) {}
    fn close(&mut self, _: Closing) {}
}

/// Mean stays in queues and rates of lines against their exact values, simulated now.
///
/// # Errors
/// [`ShopError`] where the shop stops.
///
/// # Panics
/// Where the shipped scenario is no scenario.
pub(crate) fn claims() -> Result<Vec<Claim>, ShopError> {
    let mut claims = std::thread::scope(|scope| {
        let running: Vec<_> = CASES.iter().map(|case| scope.spawn(|| case.checked())).collect();
        running.into_iter().map(|case| case.join().expect("a claim ends")).collect::<Result<Vec<_>, _>>()
    })?;
    claims.extend(further::claims()?);
    Ok(claims)
}

impl Case {
    fn checked(&self) -> Result<Claim, ShopError> {
        let changes: Vec<String> = self.changes.iter().chain([&LENGTH]).map(|&change| change.to_owned()).collect();
        let (name, text) = match self.figure {
            Figure::Stay(_) => ("queue.toml", QUEUE),
            Figure::Rate(_) => ("line.toml", LINE),
            Figure::StayOf(..) => ("urgent.toml", URGENT),
            Figure::Reworked(_) => ("rework.toml", REWORK),
            Figure::Assembled(_) => ("assembly.toml", ASSEMBLY),
            Figure::Carded(_) => ("cards.toml", CARDS),
            Figure::Edged(..) => ("crib.toml", CRIB),
            Figure::Repaired(_) => ("crew.toml", CREW),
            Figure::Delivered(_) => ("vehicle.toml", VEHICLE),
        };
        let file = parse(name, text, &changes).unwrap_or_else(|error| panic!("{}: {error}", self.claim));
        let policy = Arc::new(ResolvedPolicy::from_scenario(&file.scenario, 0)?);
        let part = match self.figure {
            Figure::StayOf(part, _) => Some(part),
            Figure::Assembled(_) => Some(2), // after its two components
            Figure::Stay(_)
            | Figure::Rate(_)
            | Figure::Reworked(_)
            | Figure::Carded(_)
            | Figure::Edged(..)
            | Figure::Repaired(_)
            | Figure::Delivered(_) => None,
        };
        let stays = Stays { from: file.scenario.warm_up, part, ..Stays::default() };
        let stays = Shop::with_recorder(&file.scenario, policy, 0, stays)?.run()?;
        let minutes = (file.scenario.horizon - stays.from) / 60.0;
        let (published, computed) = match self.figure {
            Figure::Stay(stay) | Figure::StayOf(_, stay) | Figure::Reworked(stay) | Figure::Delivered(stay) => {
                (stay, stays.total / stays.count / 60.0)
            }
            Figure::Rate(rate) | Figure::Assembled(rate) | Figure::Carded(rate) => (rate, stays.count / minutes),
            Figure::Edged(machine, share) => (share, stays.working[machine as usize] / (60.0 * minutes)),
            Figure::Repaired(share) => (share, 1.0 - stays.down / (6.0 * 60.0 * minutes)),
        };
        Ok(Claim {
            claim: self.claim.to_owned(),
            source: self.source.to_owned(),
            published,
            computed,
            tolerance: self.tolerance,
        })
    }
}
