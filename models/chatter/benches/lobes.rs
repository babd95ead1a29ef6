//! Speed of verdicts and charts of the standard one-mode case.

use criterion::{Criterion, criterion_group, criterion_main};
use std::f64::consts::TAU;
use std::hint::black_box;
use toolroom_chatter::{Axis, Cutter, Direction, Engagement, Milling, MillingForce, Mode};

fn standard(immersion: f64) -> Option<Milling> {
    Some(Milling {
        modes: vec![Mode::from_mass([1.0, 0.0], 922.0, 0.011, 0.03993)],
        cutter: Cutter::straight(2, 0.02),
        engagement: Engagement::new(immersion, Direction::Down).ok()?,
        force: MillingForce::new(6e8, 2e8),
        feed_per_tooth: 0.1e-3,
        by_speed: None,
        along_path: None,
    })
}

/// 5 000 … 25 000 rpm and 0 … 10 mm.
fn axes(speeds: usize, depths: usize) -> (Axis, Axis) {
    let rpm = TAU / 60.0;
    (Axis { start: 5000.0 * rpm, end: 25000.0 * rpm, points: speeds }, Axis { start: 0.0, end: 10e-3, points: depths })
}

fn charts(c: &mut Criterion) {
    let mut group = c.benchmark_group("chart 400 x 200");
    group.sample_size(10);
    for immersion in [0.05, 1.0] {
        let Some(cut) = standard(immersion) else { continue };
        let (speed, depth) = axes(400, 200);
        let (Ok(speeds), Ok(depths)) = (speed.values("speed"), depth.values("depth")) else { continue };
        group.bench_function(format!("full, a/D = {immersion}"), |b| b.iter(|| black_box(cut.lobes(&speeds, &depths))));
        group.bench_function(format!("boundary, a/D = {immersion}"), |b| {
            b.iter(|| black_box(cut.boundary(&speed, 10e-3)));
        });
    }
}

fn verdicts(c: &mut Criterion) {
    let mut group = c.benchmark_group("verdict");
    for immersion in [0.05, 1.0] {
        let Some(cut) = standard(immersion) else { continue };
        let speed = 12000.0 / 60.0 * TAU;
        group.bench_function(format!("from scratch, a/D = {immersion}"), |b| {
            b.iter(|| black_box(cut.verdict(black_box(speed), 1e-3)));
        });
        let Ok(mut at_speed) = cut.at_speed(speed) else { continue };
        let mut depth = 0.0;
        group.bench_function(format!("at a prepared speed, a/D = {immersion}"), |b| {
            b.iter(|| {
                depth = (depth + 0.1e-3) % 5e-3;
                black_box(at_speed.verdict(depth))
            });
        });
    }
}

criterion_group!(benches, charts, verdicts);
criterion_main!(benches);
