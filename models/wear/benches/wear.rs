//! Speed of the wear model's building blocks.
use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use toolroom_wear::Pair;

fn benches(c: &mut Criterion) {
    let pair = Pair::default();
    let cut = pair.reference_cut();
    c.bench_function("point", |b| b.iter(|| pair.point(black_box(&cut), 0.2e-3)));
}

criterion_group!(wear, benches);
criterion_main!(wear);
