//! Speed of the gap diagnosis.

use criterion::{Criterion, criterion_group, criterion_main};
use std::hint::black_box;
use std::time::Duration;
use toolroom_gap::{Linear, NominalModel, Point, diagnose};
use toolroom_records::{RecordKind, Records, parse_csv};
use toolroom_truth::Case;

const MODEL: &str = include_str!("../../../scenarios/gap/turning.toml");

/// Records of `sets` shops with the same hidden effect, each with edges and noise of its own.
fn recorded(sets: u64) -> Records {
    let of = |seed: u64| {
        let text = Case::one("turning", "wear_force", 1.0, seed).records().replace(",T", &format!(",T{seed}-"));
        parse_csv("bench", text.as_bytes(), RecordKind::Turning).expect("records of the contract").0
    };
    (2..=sets).fold(of(1), |all, seed| all.followed_by(&of(seed)))
}

fn gap(c: &mut Criterion) {
    let model = NominalModel::parse("turning.toml", MODEL, &[]).expect("the shipped nominal model");
    let mut group = c.benchmark_group("gap");
    group.sample_size(10).measurement_time(Duration::from_secs(10));
    for sets in [1, 60] {
        let records = recorded(sets);
        let (forward, _) = model.over(&records, None, |_, _| false);
        let forward = forward.as_ref();
        let operations = records.len();
        let nominal = || Linear::new(forward, Point::nominal(forward));
        let frame = forward.frame();
        let numbers = frame.parameters.len() + frame.candidates.len() + frame.locals.len();
        group.bench_function(format!("{operations} operations, one simulation"), |bencher| {
            bencher.iter(|| forward.simulate(&Point::nominal(forward)));
        });
        group.bench_function(format!("{operations} operations, derivatives by {numbers} numbers"), |bencher| {
            bencher.iter(nominal);
        });
        group.bench_function(format!("{operations} operations, whole catalogue"), |bencher| {
            bencher.iter(|| {
                let (forward, _) = model.over(black_box(&records), None, |_, _| false);
                diagnose(forward.as_ref(), 1).diagnosis
            });
        });
    }
    group.finish();
}

criterion_group!(benches, gap);
criterion_main!(benches);
