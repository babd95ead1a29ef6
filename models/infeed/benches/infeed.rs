//! What people wait for: identification with resampling, the fastest cycle, a part with profile.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use toolroom_infeed::{
    CycleFile, CycleLimits, IdentifyOptions, Infeed, InfeedProfile, Input, State, Trial, fastest_cycle, identify,
    paper_trials,
};
use toolroom_process::Process;

fn benches(criterion: &mut Criterion) {
    let five = paper_trials();
    let forty: Vec<Trial> = (0..8).flat_map(|_| paper_trials()).collect();
    let options = IdentifyOptions::default();
    criterion
        .bench_function("identify five trials, all resamples", |b| b.iter(|| identify(black_box(&five), &options)));
    criterion.bench_function("identify forty trials, 10 000 resamples", |b| {
        b.iter(|| identify(black_box(&forty), &options))
    });
    let (grinding, wheel, limits) = (Infeed::default(), State::default(), CycleLimits::default());
    for coolant_factor in [1.0, 1.5] {
        let input = Input { coolant_factor, ..Input::default() };
        let name = format!("fastest cycle, process stiffness x {coolant_factor}");
        criterion.bench_function(&name, |b| b.iter(|| fastest_cycle(black_box(&grinding), &wheel, &input, &limits)));
    }
    let file = include_str!("../../../scenarios/grinding/cycle.toml");
    let file = CycleFile::parse("cycle.toml", file, &[]).expect("a good file").content;
    criterion.bench_function("dressing interval of 160 exact cycles", |b| b.iter(|| file.dressing_intervals()));
    let delay = InfeedProfile::default();
    criterion.bench_function("16 revolutions with profile", |b| {
        b.iter(|| {
            let mut part = delay.initial();
            delay.advance(&mut part, &Input::default(), black_box(16.0 * 60.0 / 292.0))
        });
    });
}

criterion_group!(infeed, benches);
criterion_main!(infeed);
