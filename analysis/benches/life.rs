//! Speed of simulated tool lives on one core: lives a second.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use toolroom_analysis::life::study::points::Sampling;
use toolroom_analysis::life::study::policy::{Reading, Rule};
use toolroom_analysis::life::study::run::lives;
use toolroom_analysis::life::study::{Ends, Passes, Study, Tilt, cell};
use toolroom_sim::scenario::SensorSheet;
use toolroom_wear::{Pair, Scatter};

/// Lives a measurement: one block, so one thread.
const LIVES: u64 = 500;

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

fn benches(c: &mut Criterion) {
    let shop = Scatter::shop();
    let even = Scatter { allowance: 0.0, piece_hardness: 0.0, ..shop };
    let cases = [
        ("constant speed", study(Rule::Programmed, Reading::Pass, even, false)),
        ("constant speed, passes that differ", study(Rule::Programmed, Reading::Pass, shop, false)),
        ("constant speed, lagged body and pauses", study(Rule::Programmed, Reading::Pass, shop, true)),
        ("adaptive, one update a pass", study(Rule::MinimumWear, Reading::Pass, shop, false)),
        ("adaptive, updates every 6 s", study(Rule::MinimumWear, Reading::Period, shop, false)),
        ("adaptive, every 6 s, lagged body and pauses", study(Rule::MinimumWear, Reading::Period, shop, true)),
    ];
    let mut group = c.benchmark_group("lives");
    group.throughput(Throughput::Elements(LIVES)).sample_size(20);
    for (name, study) in &cases {
        let mut from = 0;
        group.bench_function(*name, |b| {
            b.iter(|| {
                from += LIVES;
                lives(study, &study.cells[0], from, from + LIVES, false)
            });
        });
    }
    group.finish();
}

criterion_group!(life, benches);
criterion_main!(life);
