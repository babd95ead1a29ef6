//! Speed of simulated tool lives, lives a second: `cargo bench -p toolroom-life --bench life`.
//!
//! Each figure is that of the fastest of many runs of a few milliseconds on one thread, which other
//! work on the machine disturbs least. With `-- threads` it compares one and two threads instead, beside
//! what the machine gives at all: two processes with half of the lives each, which share nothing, at the
//! same time against one after the other. That needs an idle machine.

#![allow(clippy::print_stdout)]

use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;
use toolroom_life::study::policy::Reading;
use toolroom_life::study::run::lives;
use toolroom_life::study::{Passes, Study, cell};
use toolroom_scenario::{SensorSheet, SpeedRule};
use toolroom_wear::{Pair, Scatter};

/// Lives of one run, and runs.
const LIVES: u64 = 200;
const RUNS: u64 = 100;

fn study(rule: SpeedRule, reading: Reading, scatter: Scatter, lagged: bool) -> Study {
    let mut pair = Pair::default();
    let cut = pair.reference_cut().at_speed(0.5);
    pair.chipping = pair.chipping.for_share(&pair, &cut, 0.1).expect("an edge that wears out");
    let passes = Passes { path: 37.7, pause: if lagged { 18.0 } else { 0.0 } };
    let cells =
        vec![cell(("", cut), ("", rule.into(), reading), &pair, &scatter, SensorSheet::default(), (passes, lagged))];
    Study { seed: 1, lives: 1 << 40, ..Study::plain(pair, scatter, cells, (passes, lagged)) }
}

/// Seconds that `run` takes.
fn seconds(run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64()
}

/// Lives a second of the fastest run on one thread. Every run lives the same edges.
fn fastest(study: &Study) -> f64 {
    let pool = pool(1);
    LIVES as f64 / (0..RUNS).map(|_| in_pool(&pool, study, 0, LIVES)).fold(f64::INFINITY, f64::min)
}

/// Ratios of the fastest of this many runs, and how many of them.
const ROUNDS: usize = 7;
const RATIOS: usize = 5;

/// Seconds that lives `from..to` take in a pool.
fn in_pool(pool: &rayon::ThreadPool, study: &Study, start: u64, end: u64) -> f64 {
    pool.install(|| seconds(|| drop(lives(study, &study.cells[0], start, end, false))))
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads")
}

/// A process that lives the same edges whenever it is told.
struct Alone {
    process: Child,
    orders: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Alone {
    fn new(case: usize, start: u64, end: u64) -> Self {
        let words = ["alone".to_owned(), case.to_string(), start.to_string(), end.to_string()];
        let mut process = Command::new(std::env::current_exe().expect("this program"))
            .args(words)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("a process");
        let (orders, answers) = (process.stdin.take().expect("piped"), process.stdout.take().expect("piped"));
        let mut alone = Self { process, orders, answers: BufReader::new(answers) };
        alone.order();
        alone.seconds();
        alone
    }

    fn order(&mut self) {
        writeln!(self.orders).expect("it listens");
    }

    fn seconds(&mut self) -> f64 {
        let mut line = String::new();
        self.answers.read_line(&mut line).expect("it answers");
        line.trim().parse().expect("seconds")
    }

    fn end(mut self) {
        drop(self.orders);
        self.process.wait().expect("it ends");
    }
}

/// What such a process does.
fn obey(study: &Study, start: u64, end: u64) {
    let pool = pool(1);
    for _ in std::io::stdin().lines() {
        println!("{}", in_pool(&pool, study, start, end));
    }
}

/// How many times as fast two threads are, and two processes: ratios of the fastest runs, sorted.
fn gains(case: usize, study: &Study, count: u64) -> [Vec<f64>; 2] {
    let pools = [pool(1), pool(2)];
    let mut halves = [Alone::new(case, 0, count / 2), Alone::new(case, count / 2, count)];
    let mut gains = [Vec::new(), Vec::new()];
    for _ in 0..RATIOS {
        let mut least = [f64::INFINITY; 4];
        for _ in 0..ROUNDS {
            let [one, two] = pools.each_ref().map(|pool| in_pool(pool, study, 0, count));
            let apart = halves.each_mut().map(|half| {
                half.order();
                half.seconds()
            });
            halves.iter_mut().for_each(Alone::order);
            let beside = halves.each_mut().map(Alone::seconds);
            let seen = [one, two, apart[0] + apart[1], beside[0].max(beside[1])];
            least.iter_mut().zip(seen).for_each(|(least, seen)| *least = least.min(seen));
        }
        gains[0].push(least[0] / least[1]);
        gains[1].push(least[2] / least[3]);
    }
    halves.into_iter().for_each(Alone::end);
    gains.iter_mut().for_each(|gains| gains.sort_by(f64::total_cmp));
    gains
}

fn main() {
    let shop = Scatter::shop();
    let even = Scatter { allowance: 0.0, piece_hardness: 0.0, ..shop };
    // With the lives of about 0.12 s.
    let cases = [
        ("constant speed", study(SpeedRule::Programmed, Reading::Pass, even, false), 24_000),
        ("constant speed, passes that differ", study(SpeedRule::Programmed, Reading::Pass, shop, false), 6000),
        ("constant speed, lagged body and pauses", study(SpeedRule::Programmed, Reading::Pass, shop, true), 2000),
        ("adaptive, one update a pass", study(SpeedRule::MinimumWear, Reading::Pass, shop, false), 2500),
        ("adaptive, updates every 6 s", study(SpeedRule::MinimumWear, Reading::Period, shop, false), 850),
        (
            "adaptive, every 6 s, lagged body and pauses",
            study(SpeedRule::MinimumWear, Reading::Period, shop, true),
            600,
        ),
    ];
    let words: Vec<String> = std::env::args().skip(1).collect();
    if let [word, case, from, to] = &words[..]
        && word == "alone"
    {
        let number = |text: &str| text.parse().expect("a number");
        return obey(&cases[number(case) as usize].1, number(from), number(to));
    }
    for (case, (name, study, count)) in cases.iter().enumerate() {
        if words.iter().any(|word| word == "threads") {
            let [threads, processes] = gains(case, study, *count).map(|gains| {
                format!("{:.2} times as fast ({:.2} … {:.2})", gains[RATIOS / 2], gains[0], gains[RATIOS - 1])
            });
            println!("{name}: two threads {threads}, two processes {processes}");
        } else {
            println!("{name}: {:.0} lives a second", fastest(study));
        }
    }
}
