//! Speed of the wear model's building blocks.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use toolroom_wear::{Measurement, Objective, Observer, ObserverNoise, Pair, RampLimits, SpeedMode, WearState};

fn benches(c: &mut Criterion) {
    let pair = Pair::default();
    let cut = pair.reference_cut();
    c.bench_function("point", |b| b.iter(|| pair.point(black_box(&cut), 0.2e-3)));
    let state = WearState::mounted(0.2e-3);
    c.bench_function("derivative", |b| b.iter(|| pair.derivative(black_box(&state), &cut)));
    c.bench_function("life by quadrature", |b| b.iter(|| pair.life(black_box(&cut))));
    c.bench_function("life by integration in time, 1e-6", |b| {
        b.iter(|| pair.run(black_box(&WearState::default()), |_, _| cut, 1e5, 1e-7));
    });
    c.bench_function("minimum-wear speed", |b| b.iter(|| pair.minimum_wear_speed(black_box(&cut), 0.2e-3)));
    c.bench_function("best constant speed", |b| b.iter(|| pair.best_constant_speed(black_box(&cut), Objective::Path)));
    c.bench_function("life under mode 1", |b| b.iter(|| pair.minimum_wear_life(black_box(&cut))));
    let ramp = RampLimits::default();
    c.bench_function("pass plan, mode 1", |b| {
        b.iter(|| pair.plan_pass(black_box(&cut), 0.1e-3, 75.4, SpeedMode::MinimumWear, &ramp, None));
    });
    let truth = pair.point(&cut, 0.1e-3);
    let measured =
        Measurement { spindle_power: truth.spindle_power, feed_force: truth.feed_force, thermo_emf: truth.thermo_emf };
    let observer = Observer::new(&pair, ObserverNoise::default());
    c.bench_function("observer, predict and update", |b| {
        b.iter_batched(
            || observer.clone(),
            |mut observer| {
                observer.predict(black_box(&cut), 6.0);
                observer.update(&cut, &measured);
                observer
            },
            criterion::BatchSize::SmallInput,
        );
    });
}

criterion_group!(wear, benches);
criterion_main!(wear);
