//! Hot paths of turning: one pass of the shop, one life by the state equations.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use toolroom_cutting::{LifeModel, Turning, TurningInput};
use toolroom_process::Process;

fn turning(c: &mut Criterion) {
    let process = Turning::default();
    let input = TurningInput::default();
    c.bench_function("turning/output", |b| {
        let x = process.initial();
        b.iter(|| process.output(black_box(&x), black_box(&input)));
    });
    c.bench_function("turning/pass of one minute", |b| {
        b.iter(|| {
            let mut x = process.initial();
            process.advance(&mut x, black_box(&input), 60.0)
        });
    });
    c.bench_function("turning/life by state equations", |b| {
        b.iter(|| process.life(black_box(&input), LifeModel::Ode));
    });
}

criterion_group!(benches, turning);
criterion_main!(benches);
