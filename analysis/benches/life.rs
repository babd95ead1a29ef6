//! Speed of simulated tool lives, lives a second: `cargo bench -p toolroom-analysis --bench life`.
//!
//! Each figure is that of the fastest of many runs of a few milliseconds on one thread, which other
//! work on the machine disturbs least. With `-- threads` it compares one and two threads over blocks
//! of lives instead; that needs an idle machine.

#![allow(clippy::print_stdout)]

use std::time::Instant;
use toolroom_analysis::life::study::points::Sampling;
use toolroom_analysis::life::study::policy::{Reading, Rule};
use toolroom_analysis::life::study::run::{BLOCK, lives};
use toolroom_analysis::life::study::{Ends, Passes, Study, Tilt, cell};
use toolroom_sim::scenario::SensorSheet;
use toolroom_wear::{Pair, Scatter};

/// Lives of one run, and runs.
const LIVES: u64 = 20;
const RUNS: u64 = 1000;

fn study(rule: Rule, reading: Reading, scatter: Scatter, lagged: bool) -> Study {
    let mut pair = Pair::default();
    let cut = pair.reference_cut().at_speed(0.5);
    pair.chipping = pair.chipping.for_share(&pair, &cut, 0.1).expect("an edge that wears out");
    let cells = vec![cell(("", cut), ("", rule, reading), &pair, &scatter, SensorSheet::default())];
    Study {
        name: String::new(),
        title: String::new(),
        seed: 1,
        lives: 1 << 40,
        pair,
        scatter,
        fields: Vec::new(),
        copula: None,
        cells,
        ends: Ends::default(),
        passes: Passes { path: 37.7, pause: if lagged { 18.0 } else { 0.0 } },
        lagged,
        sampling: Sampling::Plain,
        tilt: Tilt::default(),
        early: 0.0,
    }
}

/// Seconds that `run` takes.
fn seconds(run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64()
}

/// Lives a second of the fastest run. Every run lives the same edges.
fn fastest(study: &Study) -> f64 {
    let run = |_| seconds(|| drop(lives(study, &study.cells[0], 0, LIVES, false)));
    LIVES as f64 / (0..RUNS).map(run).fold(f64::INFINITY, f64::min)
}

/// How many times as many lives a second two threads simulate.
fn gain_of_two_threads(study: &Study, blocks: u64) -> f64 {
    let best = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let run = |_| seconds(|| drop(pool.install(|| lives(study, &study.cells[0], 0, blocks * BLOCK, false))));
        (0..5).map(run).fold(f64::INFINITY, f64::min)
    };
    best(1) / best(2)
}

fn main() {
    let shop = Scatter::shop();
    let even = Scatter { allowance: 0.0, piece_hardness: 0.0, ..shop };
    let cases = [
        ("constant speed", study(Rule::Programmed, Reading::Pass, even, false), 32),
        ("constant speed, passes that differ", study(Rule::Programmed, Reading::Pass, shop, false), 8),
        ("constant speed, lagged body and pauses", study(Rule::Programmed, Reading::Pass, shop, true), 4),
        ("adaptive, one update a pass", study(Rule::MinimumWear, Reading::Pass, shop, false), 4),
        ("adaptive, updates every 6 s", study(Rule::MinimumWear, Reading::Period, shop, false), 4),
        ("adaptive, every 6 s, lagged body and pauses", study(Rule::MinimumWear, Reading::Period, shop, true), 4),
    ];
    let threads = std::env::args().any(|argument| argument == "threads");
    for (name, study, blocks) in &cases {
        if threads {
            println!("{name}: {:.2} times as fast on two threads", gain_of_two_threads(study, *blocks));
        } else {
            println!("{name}: {:.0} lives a second", fastest(study));
        }
    }
}
